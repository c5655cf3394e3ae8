//! What is measured, and for how long.

use fsot::Extent;
use fsot::kernel::TemporalKernel;
use fsot_lab::published::{Levels, Parameters};

#[derive(Clone, Debug)]
pub struct Case {
    pub name: &'static str,
    pub extent: Extent,
    /// Slices per pixel and frame of the shortest of our runs.
    pub least_effort: u64,
    /// Of one of our runs, about.
    pub longest_seconds: f64,
    pub published: Parameters,
    /// First look at the published loop.
    pub published_first_seconds: f64,
    pub published_seconds: f64,
    /// What the published program takes per slice on a machine of this type, on two threads, where it was
    /// measured.
    pub published_program_us: Option<f64>,
    /// Test integrands per family.
    pub integrands: usize,
    /// Slices that measure the bound.
    pub bound_slices: usize,
}

/// The cases of the README.
pub fn full(published_seconds: f64) -> Vec<Case> {
    vec![
        Case { published_seconds, published_program_us: Some(16.0), ..still("static 64x64x1", 64, 1) },
        Case {
            least_effort: 2,
            longest_seconds: 12.0,
            published_seconds: 2.0 * published_seconds,
            published_program_us: Some(175.0),
            ..animated("animated 64x64x10", 64, 10)
        },
        Case { least_effort: 8, published_seconds, ..still("static 64x64x1 4spp", 64, 4) },
    ]
}

/// The same on small tables, in no time.
pub fn tiny() -> Vec<Case> {
    let mut cases = vec![
        still("static 16x16x1", 16, 1),
        animated("animated 12x12x6", 12, 6),
        still("static 12x12x1 4spp", 12, 4),
    ];
    for case in &mut cases {
        case.least_effort = 8;
        case.longest_seconds = 0.02;
        case.published_first_seconds = 0.02;
        case.published_seconds = 0.3;
        case.published.batch = 256;
        case.integrands = 16;
        case.bound_slices = 1024;
    }
    cases
}

fn still(name: &'static str, side: usize, spp: usize) -> Case {
    let extent = Extent { frames: 1, height: side, width: side, spp };
    Case {
        name,
        extent,
        least_effort: 16,
        longest_seconds: 10.0,
        published: Parameters {
            extent,
            sigma_px: 2.1,
            temporal: vec![1.0],
            levels: Levels::CurrentFrame,
            batch: 2048,
            gain: STATIC_GAIN,
            seed: 0,
        },
        published_first_seconds: 1.0,
        published_seconds: 100.0,
        published_program_us: None,
        integrands: 128,
        bound_slices: 1 << 16,
    }
}

fn animated(name: &'static str, side: usize, frames: usize) -> Case {
    let case = still(name, side, 1);
    let extent = Extent { frames, ..case.extent };
    let taps = TemporalKernel::Perceptual { fps: 60.0 }.taps().expect("the frame rate is valid");
    let temporal = taps.into_iter().map(|tap| tap as f32).collect();
    let published = Parameters { extent, temporal, batch: 3000, gain: ANIMATED_GAIN, ..case.published };
    Case { extent, published, ..case }
}

// The published programs' own constants are not known in our units. With these, the filtered error by
// iteration is within 18 % of theirs, below it early and at most 4 % above it late. Static, after 64, 1024,
// 4096 iterations: 0.68, 0.29, 0.25 (theirs 0.82, 0.33, 0.24; a gain of 4 gives 0.77, 0.33, 0.26). Animated,
// after 120 and 1000: 0.59, 0.34 (theirs 0.59, 0.38).
const STATIC_GAIN: f32 = 7.0;
const ANIMATED_GAIN: f32 = 15.0;
