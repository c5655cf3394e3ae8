//! Errors after each kind of smoothing, as ratios to white noise.

use fsot::kernel::TemporalKernel;
use fsot_lab::render::{Denoiser, Film, Guides, ImageFilter, Reference, Scene, relative_mean};

use crate::scale::Scale;
use crate::{Failure, scene, shelf};

/// What is rendered.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Trial {
    pub scene: &'static str,
    /// Several frames (of a scene that may stand still) rather than one.
    pub animated: bool,
}

/// After what the error is looked at.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// The eye's spatial filter, in one picture.
    Still,
    /// The eye's filter in space and time.
    Eye,
    /// Temporal antialiasing, then the eye's spatial filter.
    Taa,
    /// The denoiser, in one picture.
    Denoised,
}

impl Stage {
    pub const ALL: [Self; 4] = [Stage::Still, Stage::Eye, Stage::Taa, Stage::Denoised];

    pub fn name(self) -> &'static str {
        match self {
            Stage::Still => "one picture",
            Stage::Eye => "space + eye's time",
            Stage::Taa => "TAA",
            Stage::Denoised => "denoised",
        }
    }
}

/// The history of temporal antialiasing: an exponential moving average that takes a fifth of every new frame.
/// 16 frames of it, after which 3 % are left.
pub fn taa() -> TemporalKernel {
    TemporalKernel::Taps((0..16).map(|back| 0.8_f64.powi(back)).collect())
}

enum Smoother {
    Filter(ImageFilter),
    Denoiser(Denoiser, Vec<Guides>),
}

impl Smoother {
    fn apply(&self, film: &Film) -> Result<Film, Failure> {
        Ok(match self {
            Smoother::Filter(filter) => filter.apply(film)?,
            Smoother::Denoiser(denoiser, guides) => denoiser.apply(film, guides)?,
        })
    }

    fn apply_to_variance(&self, film: &Film) -> Result<Film, Failure> {
        Ok(match self {
            Smoother::Filter(filter) => filter.apply_to_variance(film)?,
            Smoother::Denoiser(denoiser, guides) => denoiser.apply_to_variance(film, guides)?,
        })
    }
}

/// A scene with its truth, and what white noise is expected to do to it.
pub struct Setting {
    pub scene: Scene,
    pub resolution: [usize; 2],
    pub reference: Reference,
    stages: Vec<Smoothed>,
}

/// A stage: what smooths, the smoothed truth, what white noise of one sample per pixel leaves, and what the
/// reference's own error does.
struct Smoothed {
    stage: Stage,
    smoother: Smoother,
    truth: Film,
    white: f64,
    floor: f64,
}

impl Setting {
    pub fn new(trial: &Trial, scale: &Scale) -> Result<Self, Failure> {
        let mut scene = scene(trial.scene)?;
        let moves = scene.frames > 1;
        scene.frames = if trial.animated { scale.frames } else { 1 };
        let resolution = [if trial.animated { scale.animated } else { scale.still }; 2];
        // A scene that stands still is rendered once.
        let once = Scene { frames: if moves { scene.frames } else { 1 }, ..scene.clone() };
        let one = Reference::render(&once, resolution, scale.reference_spp)?;
        let repeated = |film: &Film| {
            let values = film.values().repeat(scene.frames / once.frames);
            Film::new([scene.frames, resolution[0], resolution[1]], values)
        };
        let reference = Reference {
            mean: repeated(&one.mean)?,
            standard_error: repeated(&one.standard_error)?,
            variance: repeated(&one.variance)?,
        };
        let gaussian = ImageFilter::gaussian(2.1)?;
        let smoothers = if trial.animated {
            vec![
                (Stage::Eye, Smoother::Filter(gaussian.clone().with_temporal(&shelf::eye())?)),
                (Stage::Taa, Smoother::Filter(gaussian.with_temporal(&taa())?)),
            ]
        } else {
            let guides = vec![Guides::render(&scene, 0, resolution)?];
            vec![
                (Stage::Still, Smoother::Filter(gaussian)),
                (Stage::Denoised, Smoother::Denoiser(Denoiser::default(), guides)),
            ]
        };
        let squared = reference.standard_error.values().iter().map(|error| error * error).collect();
        let squared = Film::new(reference.standard_error.shape(), squared)?;
        let mut stages = Vec::new();
        for (stage, smoother) in smoothers {
            let truth = smoother.apply(&reference.mean)?;
            let white = smoother.apply_to_variance(&reference.variance)?;
            let white = relative_mean(&white, &truth, |variance| variance);
            // A reference that is repeated errs alike in all frames: no average over time lessens that.
            let floor = match trial.animated && !moves {
                true => Smoother::Filter(ImageFilter::gaussian(2.1)?).apply_to_variance(&squared)?,
                false => smoother.apply_to_variance(&squared)?,
            };
            let floor = relative_mean(&floor, &truth, |variance| variance);
            stages.push(Smoothed { stage, smoother, truth, white, floor });
        }
        Ok(Self { scene, resolution, reference, stages })
    }

    /// Mean over pixels and frames of the smoothed error, squared and relative to the smoothed truth, over
    /// that of white noise. The smoothers are linear, so their own blur does not count; what the reference's
    /// own error is expected to add is taken off.
    pub fn ratios(&self, film: &Film, spp: u32) -> Result<Vec<(Stage, f64)>, Failure> {
        let error = film.minus(&self.reference.mean)?;
        let ratio = |Smoothed { stage, smoother, truth, white, floor }: &Smoothed| {
            let smoothed = smoother.apply(&error)?;
            let value = relative_mean(&smoothed, truth, |error| error * error) - floor;
            Ok((*stage, value * f64::from(spp) / white))
        };
        self.stages.iter().map(ratio).collect()
    }
}
