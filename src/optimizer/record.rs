//! What is written down of a run: the metadata of its table.

use super::{Optimizer, RunReport};
use crate::config::{EndReason, Work};
use crate::files::{KernelTaps, Metadata, RunRecord};

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
        let configuration = serde_json::to_value(&self.config).expect("a configuration is plain data");
        let taps = |term| {
            let taps = self.objective.taps(term).filter(|taps| taps.len() <= MOST_TAPS)?;
            Some(KernelTaps { term, taps: taps.to_vec() })
        };
        Metadata {
            kernels: (0..self.objective.terms.len()).filter_map(taps).collect(),
            run: RunRecord { next_step: Some(self.steps), next_sweep: Some(self.swept), ..report.into() },
            ..Metadata::new(self.config.extent, self.config.dims, self.config.seed, configuration)
        }
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
