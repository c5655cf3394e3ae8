//! The log of a run, as CSV: a row from time to time, with what the run tells of itself and what the table is
//! worth by then.
//!
//! A row is written at once and as a whole, behind a header: whoever reads the file while the run goes on, or
//! after it was killed, finds rows that are complete. Rows become rarer as the run goes on, so that one of a
//! minute has some 400 of them and one of a day some 800. What costs time is only measured as far as all of
//! it together takes some 2 % of the run; the steps are the same ones with a log and without. A run of less
//! than a second may spend 20 ms on what its table is worth at the end.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fsot::classes::Classes;
use fsot::metrics::{Bias, FilteredError, Integrands, MeasureError};
use fsot::optimizer::StepReport;
use fsot::{Config, Extent, Kernel, RunReport, SampleTable};

use crate::Failure;

/// Names of the columns. A field is empty where nothing was measured.
pub const COLUMNS: [&str; 8] =
    ["step", "steps", "seconds", "rate", "displacement", "loss", "filtered_error", "bias"];

/// Shares of the run that the loss, and what the table is worth, may take to measure.
const LOSS_SHARE: f64 = 0.005;
const WORTH_SHARE: f64 = 0.015;
/// Time between rows, as share of the time of the run, and at the least.
const SPACING: f64 = 0.02;
const LEAST_SPACING: Duration = Duration::from_millis(10);
/// The same for what is measured.
const MEASURE_SPACING: f64 = 0.1;
/// What the table that a run ended with is worth may take so long, however short the run was.
const LAST_WORTH: Duration = Duration::from_millis(20);
/// Integrands of each family.
const INTEGRANDS: usize = 4;
/// Pixels over which the filtered error of an animation is averaged, or one frame: the more of them, the
/// longer it takes.
const PIXELS: usize = 1 << 13;

/// A log on its way.
#[derive(Debug)]
pub struct Log {
    /// Opened by the first row, so that a run that is refused leaves none.
    out: Option<File>,
    path: PathBuf,
    is_resumed: bool,
    fault: Option<io::Error>,
    worth: Option<Worth>,
    losses: Pacer,
    worths: Pacer,
    next_row: Duration,
    steps: u64,
}

/// What is measured of a table.
#[derive(Debug)]
struct Worth {
    dims: Vec<usize>,
    kernel: Kernel,
    integrands: Integrands,
    /// Frames that are enough, where they take less time than all.
    frames: Option<usize>,
}

/// When something is measured again that takes its time.
#[derive(Debug)]
struct Pacer {
    next: Duration,
    share: f64,
    spent: Duration,
    /// What the last time will take, where there is one after the run.
    reserve: Duration,
}

impl Pacer {
    /// The first time is when a measurement that takes as long as this guess is its share.
    fn new(share: f64, guess: Duration) -> Self {
        Self { next: guess.div_f64(share), share, spent: Duration::ZERO, reserve: Duration::ZERO }
    }

    /// Measures if it is time, and if what it has taken is no more than its share of the run.
    fn measure<T>(&mut self, elapsed: Duration, measure: impl FnOnce() -> T) -> Option<T> {
        if elapsed < self.next || self.spent + self.reserve > elapsed.mul_f64(self.share) {
            return None;
        }
        let begin = Instant::now();
        let measured = measure();
        self.spent += begin.elapsed();
        self.next = elapsed.mul_f64(1.0 + MEASURE_SPACING);
        Some(measured)
    }

    /// Measures what a run ended with, unless it takes more than its share and more than this.
    fn last<T>(
        &mut self,
        elapsed: Duration,
        least: Duration,
        measure: impl FnOnce() -> Option<T>,
    ) -> Option<T> {
        let room = elapsed.mul_f64(self.share).max(least);
        if self.spent + self.reserve > room { None } else { measure() }
    }
}

impl Log {
    /// Of a run of this configuration. The file begins with its first step, in place of what was there; that
    /// of a run that was resumed is continued, and steps that were taken twice are in it twice.
    ///
    /// # Errors
    /// Dimensions of which nothing can be measured.
    pub fn new(path: &Path, config: &Config, is_resumed: bool) -> Result<Self, Failure> {
        let worth = Worth::of(config).map_err(Failure::from)?;
        // Some tens of nanoseconds for a site and an integrand.
        let guess = Duration::from_nanos(500 * config.extent.sites() as u64);
        Ok(Self {
            out: None,
            path: path.to_owned(),
            is_resumed,
            fault: None,
            worth,
            losses: Pacer::new(LOSS_SHARE, Duration::from_millis(2).max(guess / 5)),
            worths: Pacer { reserve: guess, ..Pacer::new(WORTH_SHARE, 2 * guess) },
            next_row: Duration::ZERO,
            steps: 0,
        })
    }

    /// Writes a row of a step, if it is time.
    pub fn step(&mut self, step: &StepReport) {
        self.steps = step.steps;
        // A run that is not watched would be so far.
        let elapsed = step.elapsed.saturating_sub(self.spent());
        if self.fault.is_some() || elapsed < self.next_row && step.step < step.steps {
            return;
        }
        self.next_row = elapsed + elapsed.mul_f64(SPACING).max(LEAST_SPACING);
        let loss = self.losses.measure(elapsed, || step.loss());
        let worth = self.worth.as_ref();
        let before = self.worths.spent;
        let worth =
            worth.and_then(|worth| self.worths.measure(elapsed, || worth.measure(&step.table())).flatten());
        if worth.is_some() {
            self.worths.reserve = self.worths.spent - before;
        }
        self.row(step.step, elapsed, [Some(step.rate), Some(step.displacement), loss], worth);
    }

    /// Writes the row of the table that the run ended with; what it is worth, if there is time for it.
    pub fn finish(&mut self, report: &RunReport, table: &SampleTable) {
        if self.fault.is_none() {
            let elapsed = report.elapsed.saturating_sub(self.spent());
            let worth = self.worth.as_ref();
            let worth =
                worth.and_then(|worth| self.worths.last(elapsed, LAST_WORTH, || worth.measure(table)));
            self.row(report.steps, elapsed, [None; 3], worth);
        }
    }

    /// What stood against a row, if anything did; rows after it were left out.
    ///
    /// # Errors
    /// The file could not be written to its end.
    pub fn end(self) -> Result<(), Failure> {
        match self.fault {
            Some(error) => Err(format!("{}; all else is written", cannot_write(&self.path, &error)).into()),
            None => Ok(()),
        }
    }

    fn spent(&self) -> Duration {
        self.losses.spent + self.worths.spent
    }

    fn row(&mut self, step: u64, elapsed: Duration, told: [Option<f64>; 3], worth: Option<[f64; 2]>) {
        let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.6e}"));
        let [rate, displacement, loss] = told.map(number);
        let [error, bias] = [0, 1].map(|which| number(worth.map(|worth| worth[which])));
        let (steps, seconds) = (self.steps, elapsed.as_secs_f64());
        let row = format!("{step},{steps},{seconds:.6},{rate},{displacement},{loss},{error},{bias}\n");
        self.fault = self.write(&row).err();
    }

    fn write(&mut self, row: &str) -> io::Result<()> {
        let out = match &mut self.out {
            Some(out) => out,
            none => {
                let header = format!("{}\n", COLUMNS.join(","));
                let begun =
                    || std::fs::read(&self.path).is_ok_and(|text| text.starts_with(header.as_bytes()));
                if self.is_resumed && begun() {
                    cut_half_row(&self.path)?;
                    none.insert(File::options().append(true).open(&self.path)?)
                } else {
                    let out = none.insert(File::create(&self.path)?);
                    out.write_all(header.as_bytes())?;
                    out
                }
            }
        };
        // In one piece, so that no reader finds half a row.
        out.write_all(row.as_bytes())
    }
}

impl Worth {
    /// Under the first kernel, in the first of the dimension groups; of a point set nothing.
    fn of(config: &Config) -> Result<Option<Self>, MeasureError> {
        let filters = |classes: &Classes| matches!(classes, Classes::Lattice { .. });
        let Some(term) = config.terms.iter().find(|term| filters(&term.classes)) else { return Ok(None) };
        let Classes::Lattice { kernel, .. } = term.classes.clone() else { return Ok(None) };
        let integrands = Integrands::random(term.dims.len(), INTEGRANDS, 0)?;
        let Extent { frames, height, width, .. } = config.extent;
        // A kernel that cannot be used is refused elsewhere.
        let taps = kernel.taps(&config.extent).unwrap_or_default();
        let seen = taps.iter().map(|tap| tap.dt).collect::<BTreeSet<_>>().len().max(1);
        let enough = (PIXELS / (height * width).max(1)).max(1);
        let frames = Some(enough).filter(|enough| enough * seen < frames);
        Ok(Some(Self { dims: term.dims.clone(), kernel, integrands, frames }))
    }

    /// Filtered error and bias, as ratios to white noise.
    fn measure(&self, table: &SampleTable) -> Option<[f64; 2]> {
        let Self { dims, kernel, integrands, frames } = self;
        let error = match *frames {
            Some(frames) => FilteredError::measure_frames(table, dims, integrands, kernel, frames),
            None => FilteredError::measure(table, dims, integrands, kernel),
        };
        let error = error.ok()?;
        let bias = Bias::measure(table, dims, integrands).ok()?;
        Some([error.spatio_temporal.mean.mean, bias.table.mean.mean])
    }
}

/// Of a run that was killed, or whose disk was full: what comes next would become part of it.
fn cut_half_row(path: &Path) -> io::Result<()> {
    let text = std::fs::read(path)?;
    let whole = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    if whole == text.len() { Ok(()) } else { File::options().write(true).open(path)?.set_len(whole as u64) }
}

fn cannot_write(path: &Path, error: &io::Error) -> String {
    format!("cannot write {}: {error}; choose another --log", path.display())
}
