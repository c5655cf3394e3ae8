//! Checkpoints of a run, written beside it now and then, so that it can be resumed.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use clap::Args;
use fsot::optimizer::{Checkpoint, CheckpointError, StepReport};

use crate::output::{self, Output};
use crate::{Failure, console};

/// Where checkpoints are written, and how often.
#[derive(Args, Clone, Debug)]
// The arguments of the verb are a group of the same name.
#[group(skip)]
pub struct Arguments {
    /// Write all that the rest of the run depends on to this file, again and again, so that a run that was
    /// killed can be resumed with the same bits [default: the file of --resume].
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Time between two checkpoints, such as 30s or 5min.
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = humantime::parse_duration)]
    every: Duration,
    /// Go on with the run of this checkpoint, to the table that it would have made. What is optimised and for
    /// how long stands in the file.
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
}

impl Arguments {
    /// The checkpoint to go on from.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn resumed(&self) -> Result<Option<Checkpoint>, CheckpointError> {
        self.resume.as_deref().map(Checkpoint::load).transpose()
    }

    /// What is read.
    pub fn input(&self) -> Option<&Path> {
        self.resume.as_deref()
    }

    /// What is written, but for the file that is read too.
    pub fn output(&self) -> Option<Output<'_>> {
        let is_read = |path: &&Path| {
            let resumed = self.resume.as_deref().and_then(|path| path.canonicalize().ok());
            resumed.is_some_and(|resumed| path.canonicalize().is_ok_and(|path| path == resumed))
        };
        let path = self.checkpoint.as_deref().filter(|path| !is_read(path))?;
        Some(Output { flag: "--checkpoint", path, endings: output::ANY })
    }

    /// Whether any are written.
    pub fn is_kept(&self) -> bool {
        self.checkpoint.is_some() || self.resume.is_some()
    }

    /// Starts to write them.
    pub fn writer(&self) -> Option<Writer> {
        let path = self.checkpoint.clone().or_else(|| self.resume.clone())?;
        Some(Writer::new(path, self.every))
    }
}

/// Writes checkpoints while the run goes on.
///
/// ```
/// use std::ops::ControlFlow;
/// use std::time::Duration;
///
/// use fsot::optimizer::Checkpoint;
/// use fsot::{Config, Extent, Optimizer, Until};
/// use fsot_cli::checkpoint::Writer;
///
/// let folder = std::env::temp_dir().join("fsot-checkpoint-example");
/// std::fs::create_dir_all(&folder)?;
/// let path = folder.join("run.checkpoint");
/// let mut writer = Writer::new(path.clone(), Duration::from_secs(60));
/// let mut optimizer = Optimizer::new(Config::new(Extent::still(16, 16), 2))?;
/// optimizer.run_observed(Until::Sweeps(2), |step| {
///     writer.look(step, step.step == 20);
///     ControlFlow::Continue(())
/// })?;
/// writer.end()?;
/// assert_eq!(Checkpoint::load(&path)?.progress().unwrap().1, 20);
/// # Ok::<(), fsot_cli::Failure>(())
/// ```
#[derive(Debug)]
pub struct Writer {
    path: PathBuf,
    every: Duration,
    last: Instant,
    /// None once it has ended.
    sender: Option<SyncSender<Checkpoint>>,
    thread: Option<JoinHandle<Result<(), CheckpointError>>>,
}

impl Writer {
    /// The first is written after the time between two of them.
    pub fn new(path: PathBuf, every: Duration) -> Self {
        // One waits while another is written: later ones are left out rather than keep the run waiting.
        let (sender, receiver) = sync_channel::<Checkpoint>(1);
        let to = path.clone();
        let work = move || {
            let mut outcome = Ok(());
            for checkpoint in receiver {
                let told = outcome.is_err();
                outcome = checkpoint.save(&to);
                // The disk may be full for a while only, and the run may last for hours.
                if let (false, Err(error)) = (told, &outcome) {
                    console::warn(&format!("{error} (--checkpoint); the run goes on"));
                }
            }
            outcome
        };
        Self { path, every, last: Instant::now(), sender: Some(sender), thread: Some(thread::spawn(work)) }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Takes a checkpoint after this step if it is time, or at any rate.
    pub fn look(&mut self, step: &StepReport, at_any_rate: bool) {
        let Some(sender) = &self.sender else { return };
        if at_any_rate {
            // Whether it could be written is said at the end.
            let _ = sender.send(step.checkpoint());
        } else if self.last.elapsed() >= self.every {
            self.last = Instant::now();
            let _ = sender.try_send(step.checkpoint());
        }
    }

    /// Waits for the last one.
    ///
    /// # Errors
    /// It could not be written; the run has gone on.
    pub fn end(mut self) -> Result<(), Failure> {
        self.sender = None;
        let thread = self.thread.take().map(JoinHandle::join);
        Ok(thread.unwrap_or(Ok(Ok(()))).map_err(|_| "the writer of checkpoints panicked")??)
    }
}
