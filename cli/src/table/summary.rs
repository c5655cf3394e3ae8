//! What is printed of a table that was made.

use std::io::{self, Write};
use std::path::Path;

use fsot::files::{BoundRecord, Metadata, RunRecord};
use serde::Serialize;

/// Files, work and bound.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    out: String,
    metadata: String,
    /// `[frame, y, x, sample, dim]`.
    shape: [usize; 5],
    seed: u64,
    #[serde(flatten)]
    run: RunRecord,
    bound: Option<BoundRecord>,
    /// Whether a signal came before the bound was measured.
    #[serde(skip)]
    bound_left_out: bool,
}

impl Summary {
    /// Of the table in this file.
    pub fn new(out: &Path, metadata: &Metadata, bound_left_out: bool) -> Self {
        Self {
            out: out.display().to_string(),
            metadata: Metadata::path_beside(out).display().to_string(),
            shape: metadata.shape,
            seed: metadata.seed,
            run: metadata.run,
            bound: metadata.bound,
            bound_left_out,
        }
    }

    /// For people.
    pub fn words(&self, to: &mut dyn Write) -> io::Result<()> {
        let Self { out, metadata, run, bound, bound_left_out, .. } = self;
        let RunRecord { seconds, steps, frame_sweeps, slices_per_class, sweeps, ended_early, .. } = run;
        let ended = if *ended_early { format!("stopped after {steps} steps of ") } else { String::new() };
        let frame = if *frame_sweeps > 0 { format!("--frame-sweeps {frame_sweeps} ") } else { String::new() };
        writeln!(
            to,
            "{seconds:.2} s, {ended}{frame}--slices-per-class {slices_per_class} --sweeps {sweeps}"
        )?;
        if let Some(BoundRecord { before, after }) = bound {
            writeln!(
                to,
                "bound {:.5} ± {:.5} → {:.5} ± {:.5}, {:.3} ± {:.3} of white noise",
                before.value,
                before.standard_error,
                after.value,
                after.standard_error,
                after.ratio_to_white_noise,
                after.ratio_standard_error,
            )?;
        }
        if *bound_left_out {
            writeln!(to, "bound not measured, since a signal came")?;
        }
        writeln!(to, "{out}, {metadata}")
    }
}
