//! The figures, as text.

use std::io::{self, Write};

use fsot::files::BoundEstimate;
use fsot::kernel::TemporalKernel;
use fsot::metrics::{Marginal, Ratios};
use fsot::{Extent, SampleTable};

use super::evenness::Evenness;
use super::figures::{BINS, GroupFigures, LOW};
use super::{Beside, Inspection};

pub fn header(out: &mut dyn Write, inspection: &Inspection) -> io::Result<()> {
    writeln!(out, "{}: {}", inspection.name, shape(&inspection.table))?;
    writeln!(
        out,
        "filter: {}; {} test integrands per family, seed {}",
        filter(inspection),
        inspection.effort.integrands,
        inspection.seed
    )?;
    Ok(())
}

/// `1 frame of 64 x 64 pixels, 1 sample per pixel, 2 dimensions`.
pub fn shape(table: &SampleTable) -> String {
    let Extent { frames, height, width, spp } = table.extent();
    let many = |count: usize, noun: &str| format!("{count} {noun}{}", if count == 1 { "" } else { "s" });
    format!(
        "{} of {width} x {height} pixels, {} per pixel, {}",
        many(frames, "frame"),
        many(spp, "sample"),
        many(table.dims(), "dimension")
    )
}

/// The filter in words that every terminal can show.
pub fn filter(inspection: &Inspection) -> String {
    let space = format!("exp(-r^2/{}^2) in pixels", inspection.sigma());
    match (&inspection.kernel.temporal, temporal_flag(&inspection.kernel.temporal)) {
        (TemporalKernel::None, _) => space,
        (_, Some(flag)) => format!("{space}, {flag} in frames"),
        (other, None) => format!("{space}, {} taps in frames", other.taps().map_or(0, |taps| taps.len())),
    }
}

/// A temporal kernel as it is written on a command line, if it isn't long.
pub fn temporal_flag(temporal: &TemporalKernel) -> Option<String> {
    Some(match temporal {
        TemporalKernel::None => "none".into(),
        TemporalKernel::Gaussian { sigma_frames } => format!("gaussian:{sigma_frames}"),
        TemporalKernel::Ema { alpha } => format!("ema:{alpha}"),
        TemporalKernel::Box { frames } => format!("box:{frames}"),
        TemporalKernel::Binomial { frames } => format!("binomial:{frames}"),
        TemporalKernel::Perceptual { fps } => format!("perceptual:{fps}"),
        _ => return None,
    })
}

/// What lies beside the table: nothing, its metadata or another table's, or something damaged.
pub fn metadata(out: &mut dyn Write, beside: &Beside) -> io::Result<()> {
    match beside {
        Beside::Nothing => writeln!(out, "metadata: none beside the table")?,
        Beside::Unusable(error) => writeln!(out, "metadata: unusable: {error}")?,
        Beside::Foreign(problem) => {
            writeln!(out, "metadata: NOT OF THIS TABLE, which is inspected alone: {problem}")?;
        }
        Beside::Own(metadata) => {
            writeln!(
                out,
                "metadata: fsot {}, seed {}, {} sweeps of a frame, {} slices per pixel and {} sweeps \
                 in {} steps, {:.2} s",
                metadata.crate_version,
                metadata.seed,
                metadata.run.frame_sweeps,
                metadata.run.slices_per_class,
                metadata.run.sweeps,
                metadata.run.steps,
                metadata.run.seconds
            )?;
            if metadata.sha256.is_none() {
                writeln!(out, "{:10}it does not say of which values it is, as since 2026-11-27", "")?;
            }
            if let Some(bound) = metadata.bound {
                let [before, after] = [bound.before, bound.after].map(|bound| bound.ratio_to_white_noise);
                writeln!(
                    out,
                    "{:10}it says: bound {before:.3} -> {after:.3} of white noise, under its own objective",
                    ""
                )?;
            }
        }
    }
    Ok(())
}

/// How to read what follows.
pub fn key(out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "\nall as ratios to white noise of the same shape: 1 = independent random numbers, 0 = no error"
    )
}

/// All figures of a dimension group.
pub fn group(out: &mut dyn Write, figures: &GroupFigures) -> io::Result<()> {
    let GroupFigures { dims, errors, bias, evenness, marginals, discrepancy, spectra, low, .. } = figures;
    let title = match dims.as_slice() {
        [one] => format!("dimension {one}"),
        [a, b] => format!("dimensions {a}, {b}"),
        all => format!("all {} dimensions", all.len()),
    };
    write!(out, "\n{title:22}")?;
    errors.unfiltered.families.iter().try_for_each(|family| write!(out, "{:>11}", &*family.name))?;
    writeln!(out, "{:>11}", "mean")?;
    write_ratios(out, "error, not filtered", &errors.unfiltered)?;
    write_ratios(out, "filtered in space", &errors.spatial)?;
    if figures.animated {
        write_ratios(out, "in space and time", &errors.spatio_temporal)?;
    }
    write_ratios(out, "bias of the table", &bias.table)?;
    if figures.animated {
        write_ratios(out, "bias of a frame", &bias.frame)?;
    }
    write_ratios(out, "bias of a pixel", &bias.pixel)?;

    if dims.len() <= 2 {
        write_evenness(out, evenness)?;
    }
    if dims.len() <= 2 {
        dims.iter().zip(marginals).try_for_each(|(dim, marginal)| write_marginal(out, *dim, marginal))?;
    }
    match discrepancy {
        Some(ratio) => writeln!(out, "  squared L2 discrepancy of a frame {ratio:.4}")?,
        None => writeln!(
            out,
            "  squared L2 discrepancy of a frame: left out, {} samples take too long",
            figures.samples_per_frame
        )?,
    }
    match low {
        Some(low) => writeln!(out, "  power at low frequencies (to {LOW} cycles per pixel) {low:.4}")?,
        None => writeln!(out, "  power at low frequencies: none so low in a tile of this size")?,
    }
    let rings = spectra.anisotropy();
    if rings.iter().all(|ring| ring.along_y_over_along_x.is_finite()) {
        write!(out, "  power along y over along x:")?;
        for ring in rings {
            write!(out, " {:.2} ({}-{})", ring.along_y_over_along_x, ring.from, ring.to)?;
        }
        writeln!(out, " cycles per pixel")?;
    }
    Ok(())
}

/// A line on a single dimension: its faces, and its bins.
fn write_marginal(out: &mut dyn Write, dim: usize, marginal: &Marginal) -> io::Result<()> {
    write!(out, "  dimension {dim}: density")?;
    for face in marginal.faces {
        let error = face.standard_error;
        write!(out, " {:.2} (random 1 ± {error:.2}) within {}", face.density, face.within)?;
        write!(out, "{}", if face.within < 0.02 { "," } else { " of a face" })?;
    }
    let [emptiest, fullest] = marginal.extremes();
    write!(out, "; {BINS} bins {emptiest:.2} to {fullest:.2}, outermost {:.2}", marginal.ends())?;
    if marginal.zeros > 0 {
        write!(out, "; {} values are 0", marginal.zeros)?;
    }
    writeln!(out)
}

fn write_ratios(out: &mut dyn Write, label: &str, ratios: &Ratios) -> io::Result<()> {
    write!(out, "  {label:20}")?;
    ratios.families.iter().try_for_each(|family| write!(out, "{:11.4}", family.ratio.mean))?;
    let mean = ratios.mean;
    if mean.standard_error.is_nan() {
        writeln!(out, "{:11.4}", mean.mean)?;
    } else {
        writeln!(out, "{:11.4} ± {:.4}", mean.mean, mean.standard_error)?;
    }
    Ok(())
}

fn write_evenness(out: &mut dyn Write, evenness: &Evenness) -> io::Result<()> {
    if evenness.per_side == 1 {
        writeln!(out, "  histogram: too few samples")?;
        return Ok(());
    }
    let [emptiest, fullest] = evenness.extremes();
    let names: &[&str] =
        if evenness.dims == 2 { &["low-low", "high-low", "low-high", "high-high"] } else { &["low", "high"] };
    let corners: Vec<String> =
        names.iter().zip(&evenness.corners).map(|(name, count)| format!("{name} {count:.2}")).collect();
    writeln!(
        out,
        "  histogram of {} cells: spread {:.3}, emptiest cell {emptiest:.2}, fullest {fullest:.2}; {}: {}",
        evenness.cells(),
        evenness.spread,
        if evenness.dims == 2 { "corners" } else { "ends" },
        corners.join(", ")
    )?;
    Ok(())
}

/// The bound of the whole table.
pub fn bound(out: &mut dyn Write, total: &BoundEstimate) -> io::Result<()> {
    writeln!(
        out,
        "\nbound {:.5} ± {:.5}, {:.4} ± {:.4} of white noise",
        total.value, total.standard_error, total.ratio_to_white_noise, total.ratio_standard_error
    )
}
