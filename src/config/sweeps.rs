//! How sweeps move the samples.

use serde::{Deserialize, Serialize};

use super::descent::Schedule;
use super::until::Work;
use crate::error::RangeError;

/// How sweeps move the samples: `x ← x + rate · pull`.
///
/// The pull is the negative gradient of [`crate::Objective::cramer`], brought to the scale where the natural
/// step is 1: around a sample that sits well among its `n` neighbours there is room of a radius `r` with `V_d
/// r^d n = 1` in the unit cube of `d` dimensions, and the curvature there is one sample's share of the
/// gradient, per `r`.
///
/// A step moves a sixteenth of the neighbours together, or less where there are many (one in `4 n r`, at the
/// least one in 64); what they do to each other's pull grows with their number. Rates beyond half a step's
/// inverse share over `n r` don't settle, and are taken as that: 2.7 in a still picture of two dimensions.
///
/// ```
/// use fsot::config::{Schedule, Sweeps};
/// use fsot::{Config, Extent};
///
/// let gentle = Sweeps { rate: Schedule::geometric(1.0, 0.05), ..Sweeps::default() };
/// let config = Config::new(Extent::still(32, 32), 2).with_sweeps(gentle);
/// # let _ = config;
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweeps {
    /// Step size of a run of sweeps alone. One of `n` sweeps begins no higher than at `√n`, and ends no lower
    /// than at its beginning divided by `n`: few sweeps can neither mend what large steps break nor settle.
    pub rate: Schedule,
    /// Step size of sweeps that follow slices, or a frame of their own, in a run. Larger ones would undo what
    /// was arranged.
    pub polish: Schedule,
    /// Pairs held together less than this share of the strongest are left out; in `[0, 1)`.
    pub truncation: f64,
    /// While a run goes along `rate`, distances up to this times the step size, in units of `r`, count as
    /// longer than they are: samples pass each other early in a run, and feel every neighbour at its end.
    /// From 0 to 1e6; 0 is the exact gradient all along.
    #[serde(default)]
    pub softening: f64,
}

impl Default for Sweeps {
    fn default() -> Self {
        let (rate, polish) = (Schedule::geometric(2.2, 0.2), Schedule::geometric(1.5, 0.25));
        Self { rate, polish, truncation: 0.007, softening: 0.7 }
    }
}

impl Sweeps {
    /// Step size and softening over the sweeps of a run.
    pub(crate) fn of_a_run(&self, work: Work) -> (Schedule, f64) {
        if work.slices_per_class > 0 || work.frame_sweeps > 0 {
            return (self.polish, 0.0);
        }
        let [first, last] = self.rate.ends();
        let sweeps = work.sweeps.max(1) as f64;
        let first = first.min(sweeps.sqrt());
        (self.rate.between([first, last.max(first / sweeps)]), self.softening)
    }

    /// Refuses settings that no sweep could follow.
    ///
    /// # Errors
    /// The first number that lies outside its range.
    pub fn validate(&self) -> Result<(), RangeError> {
        self.rate.validate()?;
        self.polish.validate()?;
        let softening = self.softening;
        let is_good = (0.0..=1e6).contains(&softening);
        RangeError::check(is_good, "the softening of sweeps", softening, "from 0 to 1e6")?;
        let truncation = self.truncation;
        let is_good = (0.0..1.0).contains(&truncation);
        RangeError::check(is_good, "the truncation of sweeps", truncation, "in [0, 1)")
    }
}
