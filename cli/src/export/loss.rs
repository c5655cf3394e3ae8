//! What the numbers of a file cost: figures of the table before and after.

use std::io::{self, Write};
use std::path::Path;

use fsot::classes::Classes;
use fsot::files::{Depth, ExportOptions, Metadata, Rounding};
use fsot::kernel::SpatialKernel;
use fsot::metrics::{Bias, FilteredError, Integrands, Marginal, MeasureError};
use fsot::{Config, Kernel, SampleTable};
use serde::Serialize;

use crate::{Failure, temporal};

/// Samples times integrands of a family: a second's work,
const MOST_WORK: usize = 1 << 22;
/// but no fewer integrands than tell one table from another, and no more than tell it well.
const INTEGRANDS: [usize; 2] = [16, 256];

/// Dimensions that are measured at most: two pairs.
const MOST_DIMS: usize = 4;

/// Samples of a table whose frames are all filtered, at once; of more, so many frames are.
const MOST_OF_ALL_FRAMES: usize = 1 << 18;
const FEW: usize = 4;

/// More than this share of the filtered error is worth a word.
const MUCH: f64 = 0.02;

/// The kernel of the eye, as everywhere where none is known.
const SIGMA_PX: f64 = 2.1;

/// Figures of the table and of what is read from the files.
#[derive(Debug, Serialize)]
pub(super) struct Loss {
    depth: Depth,
    rounding: Rounding,
    /// Whether the kernel is the table's own.
    own_kernel: bool,
    /// Dimensions that were measured, the first of the table.
    dims: usize,
    /// Whether there are more.
    is_part: bool,
    /// Frames of the filtered error, at equal distances.
    frames: usize,
    all_frames: usize,
    before: Figures,
    after: Figures,
}

/// Ratios to white noise, but the last.
#[derive(Clone, Debug, Serialize)]
struct Figures {
    /// Test integrands per family.
    integrands: usize,
    /// Mean over families and pairs of dimensions.
    filtered_error: f64,
    /// The same of each family.
    families: Vec<(String, f64)>,
    bias: f64,
    /// Counts of the emptiest and of the fullest level, relative to the mean.
    evenness: [f64; 2],
    /// How many levels were counted.
    bins: usize,
}

impl Loss {
    /// Of the table in this file.
    pub(super) fn measure(path: &Path, table: SampleTable, options: &ExportOptions) -> Result<Self, Failure> {
        let (depth, rounding) = (options.depth(), options.rounding);
        let own = own_kernel(path, &table);
        let own_kernel = own.is_some();
        let kernel = own.unwrap_or_else(|| {
            let temporal = temporal::or_default(None, table.extent().frames);
            Kernel::product(SpatialKernel::Gaussian { sigma_px: SIGMA_PX }, temporal)
        });
        let all_frames = table.extent().frames;
        let frames =
            if table.extent().samples() > MOST_OF_ALL_FRAMES { all_frames.min(FEW) } else { all_frames };
        let dims = table.dims().min(MOST_DIMS);
        let is_part = dims < table.dims();
        // One after the other, and in the same place: there may be no room for two tables.
        let before = Figures::measure(&table, &kernel, depth, frames)?;
        let after = Figures::measure(&table.into_quantized(depth, rounding), &kernel, depth, frames)?;
        Ok(Self { depth, rounding, own_kernel, dims, is_part, frames, all_frames, before, after })
    }

    /// One line for each figure.
    pub(super) fn words(&self, to: &mut dyn Write) -> io::Result<()> {
        let Self { depth, own_kernel, dims, is_part, frames, all_frames, before, after, .. } = self;
        if *is_part {
            writeln!(to, "of the first {dims} dimensions:")?;
        }
        let change = |before: f64, after: f64| 100.0 * (after / before - 1.0);
        let worst = before
            .families
            .iter()
            .zip(&after.families)
            .map(|((name, before), (_, after))| (name, change(*before, *after)));
        let worst = worst.max_by(|(_, first), (_, second)| first.total_cmp(second));
        let kernel = if *own_kernel { "its own kernel" } else { "the eye's kernel" };
        let share = change(before.filtered_error, after.filtered_error);
        let [was, is] = [before.filtered_error, after.filtered_error];
        let part = match frames < all_frames {
            true => format!(", of {frames} of {all_frames} frames"),
            false => String::new(),
        };
        write!(
            to,
            "filtered error under {kernel}{part}: {was:.4} in the table, {is:.4} in the files ({share:+.1} %"
        )?;
        match worst {
            Some((name, share)) => writeln!(to, "; {name} {share:+.1} %)")?,
            None => writeln!(to, ")")?,
        }
        writeln!(
            to,
            "bias: {:.4} in the table, {:.4} in the files; both over {} integrands per family",
            before.bias, after.bias, before.integrands
        )?;
        let [least, most] = after.evenness;
        let [least_before, most_before] = before.evenness;
        writeln!(
            to,
            "evenness: the emptiest and the fullest of {} levels have {least:.3} and {most:.3} of the mean \
             (in the table {least_before:.3} and {most_before:.3})",
            after.bins
        )?;
        if *depth == Depth::U8 && share > 100.0 * MUCH {
            writeln!(to, "8 bits cost this table more than 2 %: where that matters, give --bits 16")?;
        }
        Ok(())
    }
}

/// The kernel of the first term of the table's configuration, if that is known.
fn own_kernel(path: &Path, table: &SampleTable) -> Option<Kernel> {
    let metadata = Metadata::load(path).ok()?;
    metadata.check(table).ok()?;
    let config: Config = serde_json::from_value(metadata.configuration).ok()?;
    config.terms.into_iter().find_map(|term| match term.classes {
        Classes::Lattice { kernel, .. } => Some(kernel),
        _ => None,
    })
}

impl Figures {
    fn measure(
        table: &SampleTable,
        kernel: &Kernel,
        depth: Depth,
        frames: usize,
    ) -> Result<Self, MeasureError> {
        let samples = table.extent().samples();
        let per_family = (MOST_WORK / samples).clamp(INTEGRANDS[0], INTEGRANDS[1]);
        let dims: Vec<usize> = (0..table.dims().min(MOST_DIMS)).collect();
        let pairs: Vec<&[usize]> = dims.chunks(2).collect();
        let (mut filtered_error, mut bias) = (0.0, 0.0);
        let mut families: Vec<(String, f64)> = Vec::new();
        for pair in &pairs {
            let integrands = Integrands::random(pair.len(), per_family, 0)?;
            let share = 1.0 / pairs.len() as f64;
            let error = match frames < table.extent().frames {
                true => FilteredError::measure_frames(table, pair, &integrands, kernel, frames)?,
                false => FilteredError::measure(table, pair, &integrands, kernel)?,
            };
            let error = error.spatio_temporal;
            filtered_error += share * error.mean.mean;
            bias += share * Bias::measure(table, pair, &integrands)?.table.mean.mean;
            for (at, family) in error.families.iter().enumerate() {
                match families.get_mut(at) {
                    Some((_, ratio)) => *ratio += share * family.ratio.mean,
                    None => families.push((family.name.to_string(), share * family.ratio.mean)),
                }
            }
        }
        // Levels, or as many of them together as leave a sample each.
        let most = depth.levels().unwrap_or(1 << 8) as usize;
        let bins = most.min(1 << samples.max(2).ilog2().min(16));
        let mut evenness = [f64::INFINITY, 0.0_f64];
        for &dim in &dims {
            let [least, greatest] = Marginal::measure(table, dim, bins)?.extremes();
            evenness = [evenness[0].min(least), evenness[1].max(greatest)];
        }
        Ok(Self { integrands: per_family, filtered_error, families, bias, evenness, bins })
    }
}
