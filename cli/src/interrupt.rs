//! Signals that ask a run to end: SIGINT (Ctrl-C), SIGTERM and SIGHUP.
//!
//! A signal sets a flag. Whoever works looks at it after each step, breaks off, and writes what it has
//! reached. Figures that take long are measured after that, and are left out when a signal comes: see
//! [`Interrupt::unless_it_comes`]. Further signals change nothing, since nothing is left to be waited for but
//! one step and the files.

use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use crate::Failure;

static CAME: AtomicBool = AtomicBool::new(false);

/// How soon a signal is noticed by who waits for figures.
const NOTICE: Duration = Duration::from_millis(20);

/// The signals of this process.
///
/// ```
/// use fsot::{Config, Extent, Optimizer, Until};
/// use fsot_cli::interrupt::Interrupt;
///
/// let mut optimizer = Optimizer::new(Config::new(Extent::still(16, 16), 2))?;
/// let interrupt = Interrupt::listen()?;
/// optimizer.run_observed(Until::Sweeps(2), |_| interrupt.flow())?;
/// assert!(!interrupt.came());
/// # Ok::<(), fsot_cli::Failure>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Interrupt(());

impl Interrupt {
    /// From now on signals are heard of here instead of killing the process. To be called when there is
    /// something to keep, and as often as is convenient.
    ///
    /// Under `nohup` signals keep their usual effect, so that the end of a session is ignored as it was asked
    /// for.
    ///
    /// # Errors
    /// The system refuses to tell of signals.
    pub fn listen() -> Result<Self, Failure> {
        static LISTENING: OnceLock<Result<(), String>> = OnceLock::new();
        let start = || {
            if hangups_are_ignored() {
                return Ok(());
            }
            ctrlc::set_handler(|| CAME.store(true, Ordering::Relaxed)).map_err(|error| error.to_string())
        };
        match LISTENING.get_or_init(start) {
            Ok(()) => Ok(Self(())),
            Err(reason) => Err(format!("cannot listen to signals: {reason}").into()),
        }
    }

    /// Whether a signal has come.
    pub fn came(self) -> bool {
        CAME.load(Ordering::Relaxed)
    }

    /// Breaks if a signal has come: what [`run_observed`](fsot::Optimizer::run_observed) asks for.
    pub fn flow(self) -> ControlFlow<()> {
        if self.came() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// The result of work that is worth nothing by halves; `None` as soon as a signal has come. The work is
    /// then left alone and ends with the process.
    ///
    /// # Panics
    /// If the work does.
    pub fn unless_it_comes<T: Send + 'static>(self, work: impl FnOnce() -> T + Send + 'static) -> Option<T> {
        if self.came() {
            return None;
        }
        let (tell, told) = channel();
        let worker = thread::spawn(move || {
            // Nobody listens any more after a signal.
            let _ = tell.send(work());
        });
        loop {
            match told.recv_timeout(NOTICE) {
                // Runs inside the work may have been broken off.
                Ok(result) => return (!self.came()).then_some(result),
                Err(RecvTimeoutError::Timeout) if self.came() => return None,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => match worker.join() {
                    Ok(()) => return None,
                    Err(panic) => resume_unwind(panic),
                },
            }
        }
    }
}

/// Whether the process was started to outlive its terminal, as by `nohup`; known on Linux alone.
fn hangups_are_ignored() -> bool {
    const SIGHUP: u32 = 1;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (SIGHUP - 1) & 1 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_done_where_no_signal_comes_and_its_panic_is_heard() {
        let interrupt = Interrupt::listen().unwrap();
        assert_eq!(interrupt.unless_it_comes(|| 6 * 7), Some(42));
        let panic = thread::spawn(move || interrupt.unless_it_comes(|| panic!("heard"))).join().unwrap_err();
        assert_eq!(panic.downcast_ref(), Some(&"heard"));
    }
}
