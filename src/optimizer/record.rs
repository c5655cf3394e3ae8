//! What is written down of a run: the metadata of its table.

use super::{Optimizer, RunReport};
use crate::config::{EndReason, Work};
use crate::files::{KernelTaps, Metadata, RunRecord, RunStart};
use serde::{Deserialize, Serialize};

impl Optimizer {
    /// The metadata of the table as it is now, after a run: configuration, kernels, and how much work was
    /// done.
    ///
    /// The bound is left out; who has measured it assigns it.
    ///
    /// ```no_run
    /// use fsot::{Config, Extent, Optimizer, Until};
    ///
    /// let mut optimizer = Optimizer::new(Config::new(Extent::still(64, 64), 2))?;
    /// let report = optimizer.run(Until::Seconds(1.0))?;
    /// optimizer.table().save_with("table.npy", &optimizer.metadata(&report))?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn metadata(&self, report: &RunReport) -> Metadata {
        self.metadata_of(self.start(), report.into())
    }

    /// The metadata of the table as it is now, where no report says how it came about: after steps and sweeps
    /// of one's own, from another table, or in the middle of a run that was
    /// [resumed](Optimizer::resume). No configuration makes such a table again, and its run record says so.
    ///
    /// ```
    /// use fsot::files::RunStart;
    /// use fsot::{Config, Extent, Optimizer, Until};
    ///
    /// let config = Config::new(Extent::still(16, 16), 2);
    /// let mut optimizer = Optimizer::new(config.clone())?;
    /// assert_eq!(optimizer.metadata_without_run().run.beginning(), RunStart::WhiteNoise);
    /// optimizer.step(1.0, 1.0)?;
    /// assert_eq!(optimizer.metadata_without_run().run.beginning(), RunStart::Elsewhere);
    ///
    /// let mut first = Optimizer::new(config)?;
    /// first.run(Until::Sweeps(2))?;
    /// optimizer.resume(first.checkpoint())?;
    /// assert_eq!(optimizer.metadata_without_run().run.beginning(), RunStart::Elsewhere);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn metadata_without_run(&self) -> Metadata {
        let start = match self.start() {
            // A run of which the record would say nothing.
            RunStart::WhiteNoise if self.past == Past::Run => RunStart::Elsewhere,
            start => start,
        };
        self.metadata_of(start, RunRecord::default())
    }

    fn metadata_of(&self, start: RunStart, run: RunRecord) -> Metadata {
        let configuration = serde_json::to_value(&self.config).expect("a configuration is plain data");
        let taps = |term| {
            let taps = self.objective.taps(term).filter(|taps| taps.len() <= MOST_TAPS)?;
            Some(KernelTaps { term, taps: taps.to_vec() })
        };
        Metadata {
            kernels: (0..self.objective.terms.len()).filter_map(taps).collect(),
            run: RunRecord {
                next_step: Some(self.steps),
                next_sweep: Some(self.swept),
                start: Some(start),
                ..run
            },
            ..Metadata::new(self.config.extent, self.config.dims, self.config.seed, configuration)
        }
    }

    fn start(&self) -> RunStart {
        match self.past {
            _ if self.partial => RunStart::Demand,
            Past::Nothing | Past::Run => RunStart::WhiteNoise,
            Past::Other => RunStart::Elsewhere,
        }
    }
}

/// What has moved the points so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Past {
    /// Nothing: they are the white noise of their seed.
    Nothing,
    /// One run from there.
    Run,
    /// Anything else. Checkpoints of before 2026-11-28 don't know it.
    #[default]
    Other,
}

impl Past {
    /// With one run more.
    pub(super) fn and_a_run(self) -> Self {
        if self == Self::Nothing { Self::Run } else { Self::Other }
    }
}

/// Longer lists would make metadata larger than their tables.
const MOST_TAPS: usize = 128;

impl From<&RunReport> for RunRecord {
    fn from(report: &RunReport) -> Self {
        let Work { frame_sweeps, slices_per_class, sweeps } = report.work;
        Self {
            frame_sweeps,
            slices_per_class,
            sweeps,
            ended_early: report.ended != EndReason::Finished,
            steps: report.steps,
            seconds: report.elapsed.as_secs_f64(),
            ..Self::default()
        }
    }
}
