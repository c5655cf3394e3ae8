//! Where an animation begins: with one frame that is good by itself, displaced from frame to frame.

use super::Optimizer;
use crate::classes::Classes;
use crate::config::{Config, Role, Term};
use crate::error::ConfigError;
use crate::kernel::TemporalKernel;
use crate::sweeps;
use crate::table::extent::Extent;

/// In smaller frames there are too few displacements: frames would be the same.
const FEWEST_PIXELS: usize = 16;

impl Optimizer {
    /// An optimiser for one frame of this animation; `None` if it is none, if a part of it is not demanded,
    /// or if its terms say nothing of a single frame.
    pub(super) fn of_a_frame(&self) -> Result<Option<Optimizer>, ConfigError> {
        let is_swept_whole = self.objective.is_whole(&self.config) && sweeps::check(&self.objective).is_ok();
        let Extent { frames, height, width, .. } = self.config.extent;
        if frames == 1 || height * width < FEWEST_PIXELS || !is_swept_whole {
            return Ok(None);
        }
        self.config.of_a_frame().map(Optimizer::new).transpose()
    }
}

impl Config {
    /// The same for a single frame, without what is about time.
    fn of_a_frame(&self) -> Option<Self> {
        let extent = Extent { frames: 1, ..self.extent };
        let mut terms: Vec<Term> = Vec::new();
        for term in &self.terms {
            let mut term = term.clone();
            match &mut term.classes {
                Classes::Lattice { kernel, .. } => {
                    kernel.temporal = TemporalKernel::None;
                    // What held one pixel over time holds nothing but single samples now.
                    if extent.spp == 1 && kernel.taps(&extent).is_ok_and(|taps| taps.len() == 1) {
                        continue;
                    }
                }
                Classes::WholeTable | Classes::PerPixel => {}
                Classes::PerFrame => continue,
                _ => return None,
            }
            let is_same = |other: &Term| {
                (&other.classes, &other.dims, other.role) == (&term.classes, &term.dims, term.role)
            };
            if !terms.iter().any(is_same) {
                terms.push(term);
            }
        }
        let descends = terms.iter().any(|term| term.role == Role::Descend);
        descends.then(|| Self { extent, terms, ..self.clone() })
    }
}

/// A table whose frames are all the same one, each [displaced](Extent::displacement): frames near each other
/// see parts far from each other of the same pattern.
pub(super) fn displaced(extent: Extent, frame: &[f32]) -> Vec<f32> {
    let Extent { frames, height, width, .. } = extent;
    let row = frame.len() / height;
    let mut points = Vec::with_capacity(frames * frame.len());
    for index in 0..frames {
        let by = extent.displacement(index as u64);
        for y in 0..height {
            let row = &frame[(y + by.y) % height * row..][..row];
            let (left, right) = row.split_at(by.x * (row.len() / width));
            points.extend_from_slice(right);
            points.extend_from_slice(left);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Kernel;

    #[test]
    fn frames_are_the_same_one_displaced() {
        let extent = Extent { frames: 3, height: 4, width: 5, spp: 2 };
        let frame: Vec<f32> = (0..40).map(|i| i as f32).collect();
        let points = displaced(extent, &frame);
        let at = |t: usize, y: usize, x: usize, s: usize| points[((t * 4 + y) * 5 + x) * 2 + s];
        assert_eq!(&points[..40], &frame[..]);
        // The fractions of 1 and 2 steps: .57 and .14 of 4 rows, .75 and .51 of 5 columns.
        for (t, dy, dx) in [(1, 2, 3), (2, 0, 2)] {
            for (y, x, s) in [(0, 0, 0), (3, 4, 1), (1, 3, 0)] {
                assert_eq!(at(t, y, x, s), frame[((y + dy) % 4 * 5 + (x + dx) % 5) * 2 + s]);
            }
        }
    }

    #[test]
    fn a_frame_has_the_spatial_half_of_what_an_animation_has() {
        let config = Config::new(Extent::animation(8, 16, 16), 2);
        let frame = config.of_a_frame().unwrap();
        assert_eq!(frame.extent, Extent::still(16, 16));
        assert_eq!(frame.kernels(), [Kernel::gaussian(2.1)]);
        // A pixel by itself over time says nothing of a frame.
        let alone = Kernel::separate(Kernel::gaussian(2.1).spatial, TemporalKernel::Ema { alpha: 0.2 });
        assert!(config.with_companions(false).with_kernel(alone[1].clone()).of_a_frame().is_none());
    }
}
