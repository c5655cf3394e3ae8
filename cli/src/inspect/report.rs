//! The figures, as text.

use std::io::Write;

use fsot::config::DimensionGroup;
use fsot::files::{Metadata, TableError};
use fsot::kernel::TemporalKernel;
use fsot::metrics::{Bias, Bound, Discrepancy, Family, FilteredError, Integrands, Ratios, Spectra};
use fsot::{Config, Extent, Objective, SampleTable};

use super::Inspection;
use super::evenness::Evenness;
use crate::Failure;

/// Cycles per pixel below which a frequency counts as low; the default filter halves the power at 0.09.
const LOW: f64 = 0.1;

/// Pairs of samples whose comparison takes some ten seconds.
const MOST_PAIRS: u64 = 10_000_000_000;

/// What the page shows of the first dimension group.
pub struct Shown {
    pub dims: Vec<usize>,
    pub errors: FilteredError,
    pub spectra: Spectra,
    pub evenness: Evenness,
}

pub fn header(out: &mut dyn Write, inspection: &Inspection) -> Result<(), Failure> {
    writeln!(out, "{}: {}", inspection.name, shape(&inspection.table))?;
    writeln!(
        out,
        "filter: {}; {} test integrands per family, seed {}",
        filter(inspection),
        inspection.integrands,
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

/// The filter in words that a command line and a bitmap font can show.
pub fn filter(inspection: &Inspection) -> String {
    let space = format!("exp(-r^2/{}^2) in pixels", inspection.sigma());
    match &inspection.kernel.temporal {
        TemporalKernel::None => space,
        TemporalKernel::Gaussian { sigma_frames } => format!("{space}, gaussian:{sigma_frames} in frames"),
        TemporalKernel::Ema { alpha } => format!("{space}, ema:{alpha} in frames"),
        TemporalKernel::Box { frames } => format!("{space}, box:{frames} in frames"),
        TemporalKernel::Binomial { frames } => format!("{space}, binomial:{frames} in frames"),
        TemporalKernel::Perceptual { fps } => format!("{space}, perceptual:{fps} in frames"),
        TemporalKernel::Taps(taps) => format!("{space}, {} taps in frames", taps.len()),
    }
}

/// What lies beside the table: nothing, its metadata, or something damaged.
pub fn metadata(
    out: &mut dyn Write,
    beside: Option<Result<(SampleTable, Metadata), TableError>>,
) -> Result<(), Failure> {
    match beside {
        None => writeln!(out, "metadata: none beside the table")?,
        Some(Err(error)) => writeln!(out, "metadata: unusable: {error}")?,
        Some(Ok((_, metadata))) => {
            writeln!(
                out,
                "metadata: fsot {}, seed {}, {} slices per pixel and {} sweeps in {} steps, {:.2} s",
                metadata.crate_version,
                metadata.seed,
                metadata.run.slices_per_class,
                metadata.run.sweeps,
                metadata.run.steps,
                metadata.run.seconds
            )?;
            if let Some(bound) = metadata.bound {
                let [before, after] = [bound.before, bound.after].map(|bound| bound.ratio_to_white_noise);
                writeln!(
                    out,
                    "          it says: bound {before:.3} -> {after:.3} of white noise, under its own objective"
                )?;
            }
        }
    }
    Ok(())
}

/// Measures and prints every dimension group, then the bound.
pub fn measure(out: &mut dyn Write, inspection: &Inspection) -> Result<Shown, Failure> {
    writeln!(
        out,
        "\nall as ratios to white noise of the same shape: 1 = independent random numbers, 0 = no error"
    )?;
    let groups = DimensionGroup::pairs_and_whole(inspection.table.dims());
    let mut shown = None;
    for group in &groups {
        let measured = measure_group(out, inspection, group.dims.clone())?;
        shown.get_or_insert(measured);
    }
    write_bound(out, inspection, &groups)?;
    shown.ok_or_else(|| "the table has no dimensions".into())
}

fn measure_group(out: &mut dyn Write, inspection: &Inspection, dims: Vec<usize>) -> Result<Shown, Failure> {
    let Inspection { table, kernel, .. } = inspection;
    let extent = table.extent();
    let integrands = Integrands::random(dims.len(), inspection.integrands, inspection.seed)?;
    let title = match dims.as_slice() {
        [one] => format!("dimension {one}"),
        [a, b] => format!("dimensions {a}, {b}"),
        all => format!("all {} dimensions", all.len()),
    };
    write!(out, "\n{title:22}")?;
    integrands.families().iter().map(Family::name).try_for_each(|name| write!(out, "{name:>11}"))?;
    writeln!(out, "{:>11}", "mean")?;

    let errors = FilteredError::measure(table, &dims, &integrands, kernel)?;
    write_ratios(out, "error, not filtered", &errors.unfiltered)?;
    write_ratios(out, "filtered in space", &errors.spatial)?;
    if extent.frames > 1 {
        write_ratios(out, "in space and time", &errors.spatio_temporal)?;
    }
    let bias = Bias::measure(table, &dims, &integrands)?;
    write_ratios(out, "bias of the table", &bias.table)?;
    if extent.frames > 1 {
        write_ratios(out, "bias of a frame", &bias.frame)?;
    }
    write_ratios(out, "bias of a pixel", &bias.pixel)?;

    let evenness = Evenness::new(table, &dims[..dims.len().min(2)])?;
    if dims.len() <= 2 {
        write_evenness(out, &evenness)?;
    }
    let per_frame = (extent.samples() / extent.frames) as u64;
    let pairs = per_frame.saturating_mul(per_frame).saturating_mul((extent.frames * dims.len()) as u64);
    if pairs <= MOST_PAIRS {
        let discrepancy = Discrepancy::measure(table, &dims)?.ratio_to_white_noise;
        writeln!(out, "  squared L2 discrepancy of a frame {discrepancy:.4}")?;
    } else {
        writeln!(out, "  squared L2 discrepancy of a frame: left out, {per_frame} samples take too long")?;
    }
    let spectra = Spectra::measure(table, &dims, &integrands)?;
    let low = spectra.low_frequency_share(LOW);
    if low.is_finite() {
        writeln!(out, "  power at low frequencies (to {LOW} cycles per pixel) {low:.4}")?;
    } else {
        writeln!(out, "  power at low frequencies: none so low in a tile of this size")?;
    }
    Ok(Shown { dims, errors, spectra, evenness })
}

fn write_ratios(out: &mut dyn Write, label: &str, ratios: &Ratios) -> Result<(), Failure> {
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

fn write_evenness(out: &mut dyn Write, evenness: &Evenness) -> Result<(), Failure> {
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

/// The objective of `Term::blue_noise` for this shape and filter, at the table.
fn write_bound(
    out: &mut dyn Write,
    inspection: &Inspection,
    groups: &[DimensionGroup],
) -> Result<(), Failure> {
    let Inspection { table, kernel, bound_slices, seed, .. } = inspection;
    let config = Config::new(table.extent(), table.dims()).with_groups(groups).with_kernel(kernel.clone());
    let objective = Objective::new(&config)?;
    let total = Bound::measure(table, &objective, *seed, *bound_slices)?.total;
    writeln!(
        out,
        "\nbound {:.5} ± {:.5}, {:.4} ± {:.4} of white noise",
        total.value, total.standard_error, total.ratio_to_white_noise, total.ratio_standard_error
    )?;
    Ok(())
}
