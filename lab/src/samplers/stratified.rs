//! Jittered sampling: every stratum of a pixel holds one sample[^cook].
//!
//! [^cook]: Cook 1986, "Stochastic sampling in computer graphics", ACM TOG 5(1).

use fsot::{Extent, SampleTable};
use rand::RngExt;
use rand::seq::SliceRandom;

use crate::random::{self, Purpose};
use crate::samplers::SamplerError;

/// Jittered samples, independent from pixel to pixel.
///
/// Each pair of dimensions of a pixel has its samples in the cells of a grid, as square as `spp` allows, one
/// in each; a last odd dimension is stratified alone. Pairs are combined at random. The number of samples is
/// part of the strata: fewer than all of them are not stratified.
///
/// # Errors
/// An empty or oversized extent.
pub fn stratified(extent: Extent, dims: usize, seed: u64) -> Result<SampleTable, SamplerError> {
    extent.validate(dims)?;
    let spp = extent.spp;
    let rows = (1..=spp.isqrt()).rev().find(|rows| spp.is_multiple_of(*rows)).unwrap_or(1);
    let mut values = vec![0.0; extent.samples() * dims];
    let mut cells: Vec<usize> = (0..spp).collect();
    for (pixel, samples) in values.chunks_exact_mut(spp * dims).enumerate() {
        let mut generator = random::generator(seed, Purpose::Start, 1, pixel as u64);
        for first in (0..dims).step_by(2) {
            cells.shuffle(&mut generator);
            let grid = if first + 1 < dims { [spp / rows, rows] } else { [spp, 1] };
            for (sample, cell) in samples.chunks_exact_mut(dims).zip(&cells) {
                let place = [cell % grid[0], cell / grid[0]];
                for (axis, value) in sample[first..dims.min(first + 2)].iter_mut().enumerate() {
                    let jitter: f32 = generator.random();
                    let at = (place[axis] as f32 + jitter) / grid[axis] as f32;
                    *value = at.min(fsot::config::BELOW_ONE);
                }
            }
        }
    }
    Ok(super::table_of(extent, dims, values))
}

#[cfg(test)]
mod tests {
    use fsot::Site;
    use fsot::config::ExtentError;

    use super::*;

    #[test]
    fn every_cell_holds_one_sample() {
        let extent = Extent { frames: 1, height: 2, width: 3, spp: 12 };
        let table = stratified(extent, 3, 4).unwrap();
        for x in 0..3 {
            let (mut pairs, mut line) = ([0; 12], [0; 12]);
            for sample in 0..12 {
                let s = table.sample(Site { frame: 0, y: 1, x }, sample);
                pairs[(s[1] * 3.0) as usize * 4 + (s[0] * 4.0) as usize] += 1;
                line[(s[2] * 12.0) as usize] += 1;
            }
            assert_eq!((pairs, line), ([1; 12], [1; 12]));
        }
    }

    #[test]
    fn an_empty_axis_is_named() {
        let extent = Extent { frames: 1, height: 0, width: 3, spp: 1 };
        assert_eq!(stratified(extent, 2, 0), Err(ExtentError::EmptyAxis { axis: "height" }.into()));
    }
}
