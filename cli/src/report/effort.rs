//! How much a page can afford to measure.

use std::collections::BTreeSet;

use fsot::config::DimensionGroup;
use fsot::{Extent, Kernel, SampleTable};

use crate::Failure;
use crate::inspect::Effort;

/// Values of integrands and terms of transforms that some seconds of a core are enough for.
const AFFORDABLE: usize = 2_000_000_000;

/// Test integrands per family of a table that is small enough.
const USUAL: usize = 256;
/// Fewer would be a matter of luck, even over all families.
const FEWEST: usize = 4;

/// Frames over which filtered errors are averaged where there are many.
const FEW: usize = 2;

/// Frames and rows over which spectra are averaged.
const SLABS: [usize; 2] = [8, 32];
/// Integrands per family of the spectra of animations, which have slabs.
const OF_SLABS: usize = 32;

/// Pairs of samples whose comparison takes about a second.
const MOST_PAIRS: u64 = 1_000_000_000;

/// Samples of a table whose bound is measured with its terms of balance. Of more, these are a few
/// thousandths of it, less than its standard error.
const MOST_BALANCED: usize = 1 << 16;

/// As much as a page of this table can afford, or as was `asked` for. It depends on nothing else, so that a
/// page is the same on every machine.
pub fn of(
    table: &SampleTable,
    kernel: &Kernel,
    asked: Option<usize>,
    bound_slices: usize,
) -> Result<Effort, Failure> {
    let extent = table.extent();
    let Extent { frames, height, width, spp } = extent;
    let seen: BTreeSet<i32> = kernel.taps(&extent)?.iter().map(|tap| tap.dt).collect();
    // A filter that sees most of the frames is no cheaper for a few of them.
    let some = Some(FEW).filter(|few| few * seen.len() <= frames / 2);
    let filtered = some.map_or(frames, |few| few * seen.len());
    let families = 4;
    // Per pixel and integrand: values at its samples, and a transform or two.
    let per_pixel = |dims: usize| 3 * spp * (1 + dims) + 12;
    let groups = DimensionGroup::pairs_and_whole(table.dims());
    let of_pixels = groups.iter().map(|group| families * per_pixel(group.dims.len())).sum::<usize>();
    let affordable = |frames: usize| AFFORDABLE / (frames * height * width).saturating_mul(of_pixels).max(1);
    let slabs = SLABS[0].min(frames) + frames * SLABS[1].min(height) / height;
    let usual = |frames: usize| affordable(frames).clamp(FEWEST, USUAL);
    // Of a still, error and spectrum see the same frame.
    let still = usize::from(frames == 1);
    let integrands = asked.unwrap_or_else(|| usual(filtered + still));
    let most_of_spectra = if frames == 1 { USUAL } else { usual(slabs).min(OF_SLABS) };
    Ok(Effort {
        integrands,
        of_spectra: integrands.min(most_of_spectra),
        of_bias: asked.unwrap_or(USUAL).min(usual(frames)),
        frames: some,
        slabs: SLABS,
        most_pairs: MOST_PAIRS,
        bound_slices,
        balance: extent.samples() <= MOST_BALANCED,
    })
}
