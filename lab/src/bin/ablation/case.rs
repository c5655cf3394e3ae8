//! What is measured, and what comes of it.

use fsot::Extent;
use fsot_lab::judge::Quality;
pub use fsot_lab::program::Failure;

/// A table shape, and the work that the defaults do on it.
#[derive(Clone, Debug)]
pub struct Case {
    pub name: &'static str,
    pub extent: Extent,
    pub slices_per_class: u64,
    pub seeds: u64,
    pub integrands: usize,
    pub bound_slices: usize,
}

/// What became of a variant on a case: means over seeds.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    pub slices_per_class: f64,
    pub seconds: f64,
    pub quality: Quality,
}

/// The outcomes of a variant, one per case.
#[derive(Clone, Debug)]
pub struct Row {
    pub name: String,
    pub outcomes: Vec<Outcome>,
}

/// The two cases of the engine, and that of the plain loop.
pub fn full() -> ([Case; 2], Case) {
    let extent = |frames, side| Extent { frames, height: side, width: side, spp: 1 };
    let case = |name, extent, slices_per_class, seeds, integrands| Case {
        name,
        extent,
        slices_per_class,
        seeds,
        integrands,
        bound_slices: 1 << 15,
    };
    let engine = [
        case("static 64×64×1", extent(1, 64), 512, 4, 128),
        case("animated 64×64×10", extent(10, 64), 128, 1, 64),
    ];
    (engine, case("static 32×32×1", extent(1, 32), 256, 4, 128))
}

/// The same on small tables, in no time.
pub fn tiny() -> ([Case; 2], Case) {
    let (mut engine, mut plain) = full();
    for case in engine.iter_mut().chain([&mut plain]) {
        case.extent = Extent { frames: case.extent.frames.min(3), height: 12, width: 12, spp: 1 };
        case.slices_per_class = 16;
        case.seeds = 1;
        case.integrands = 4;
        case.bound_slices = 512;
    }
    (engine, plain)
}

impl Outcome {
    /// The mean over seeds.
    pub fn mean(outcomes: &[Self]) -> Self {
        let mean =
            |figure: fn(&Outcome) -> f64| outcomes.iter().map(figure).sum::<f64>() / outcomes.len() as f64;
        Self {
            slices_per_class: mean(|outcome| outcome.slices_per_class),
            seconds: mean(|outcome| outcome.seconds),
            quality: Quality {
                filtered: mean(|outcome| outcome.quality.filtered),
                bound: mean(|outcome| outcome.quality.bound),
                bias: mean(|outcome| outcome.quality.bias),
            },
        }
    }
}

impl Row {
    /// Whether the variant makes something better than white noise of every case.
    pub fn check(&self) -> Result<(), Failure> {
        for Outcome { quality, .. } in &self.outcomes {
            let better = quality.bound < 1.0 && quality.filtered < 1.0;
            if !better {
                return Err(format!("{} is no better than white noise: {quality:?}", self.name).into());
            }
        }
        Ok(())
    }
}
