//! The progress bar of a run, on standard error.

use fsot::optimizer::StepReport;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::Shared;

const PLANNING: &str = "{prefix}{elapsed_precise} {wide_bar} planned {percent} %";
const STYLE: &str = "{prefix}{elapsed_precise} {wide_bar} {pos}/{len} steps, {per_sec}, {eta} left{msg}";

/// A bar; clones are the same bar. Nothing is shown with `--quiet`, or where standard error is no terminal.
#[derive(Clone, Debug)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// A bar that is not seen before its first step.
    pub fn new(flags: &Shared) -> Self {
        let target = if flags.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        Self { bar: ProgressBar::with_draw_target(Some(0), target).with_style(style(STYLE)) }
    }

    /// Starts anew for a run of this name; a single run needs none.
    pub fn begin(&self, name: &str) {
        self.bar.reset();
        self.bar.set_prefix(if name.is_empty() { String::new() } else { format!("{name} ") });
    }

    /// Shows how far a run is.
    pub fn show(&self, step: &StepReport) {
        if !self.bar.is_hidden() {
            self.bar.set_length(step.steps);
            self.bar.set_position(step.step);
            self.bar.set_message(format!(", displacement {:.4}", step.displacement));
        }
    }

    /// Shows how much of the planning is done, from 0 to 1.
    pub fn show_planning(&self, share: f64) {
        if !self.bar.is_hidden() {
            self.bar.set_style(style(PLANNING));
            self.bar.set_length(100);
            self.bar.set_position((100.0 * share) as u64);
        }
    }

    /// Starts anew for the run that was planned.
    pub fn end_planning(&self) {
        self.bar.set_style(style(STYLE));
        self.bar.reset();
    }

    /// Takes the bar away, before anything else is printed.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}
