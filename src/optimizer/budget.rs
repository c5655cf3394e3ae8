//! How much work a run is: as told, or as much as fits into a time.

use std::time::{Duration, Instant};

use super::Optimizer;
use super::course::MOST_COUNT;
use crate::config::{Role, Until, Work};
use crate::error::{ConfigError, RangeError};
use crate::objective::Pace;
use crate::sweeps::{self, Motion};

/// Pairs of samples that usual sweeps look at: some ten seconds of a core.
const USUAL_PAIRS: f64 = 5e10;
const FEWEST_SWEEPS: f64 = 3.0;
/// Slices per class that usually are enough for what has no closed form.
const USUAL_SLICES: u64 = 320;
/// Share of the time of an animation that its first frame gets: the frame's quality is what single frames
/// keep.
const FRAME_SHARE: f64 = 0.2;
/// Least share of the work that terms by which a run is counted may do.
const LEAST_SHARE: f64 = 1e-3;
/// Windows of a calibration that would fill the time of a run: a dozen are needed at most.
const WINDOWS: f64 = 64.0;
/// Windows that a single call may take to be timed once only.
const LONG: f64 = 4.0;
/// More than any core does in a second: pairs of samples in sweeps, samples of slices.
const FASTEST_PAIRS: f64 = 2e10;
const FASTEST_TOUCHES: f64 = 1e9;
/// Sweeps after which a frame is not worth more of the time.
const MOST_FRAME_SWEEPS: f64 = 2000.0;

impl Optimizer {
    /// The work of a run.
    pub(super) fn work_of(&mut self, until: Until) -> Result<Work, ConfigError> {
        let slices = |slices_per_class| Work { slices_per_class, ..Work::default() };
        let work = match until {
            Until::SlicesPerClass(slices_per_class) => slices(slices_per_class),
            Until::Epochs(epochs) => slices(epochs.saturating_mul(self.config.slicing.directions as u64)),
            Until::Usual => match self.usual_sweeps() {
                Some(sweeps) => self.with_frame(sweeps)?,
                None => slices(USUAL_SLICES),
            },
            Until::Sweeps(sweeps) => self.with_frame(sweeps)?,
            Until::Work(work) => work,
            Until::Converged { improvement, window_steps, at_most } => {
                let is_share = (0.0..1.0).contains(&improvement);
                RangeError::check(is_share, "the least improvement", improvement, "in [0, 1)")?;
                RangeError::check(window_steps > 0, "the window", 0.0, "of at least 1 step")?;
                slices(at_most)
            }
            Until::Seconds(seconds) => {
                let is_time = seconds > 0.0 && seconds <= 1e9;
                RangeError::check(is_time, "the number of seconds", seconds, "above 0, at most 1e9")?;
                self.fit(seconds)?
            }
        };
        for (name, count) in [
            ("the number of sweeps", work.sweeps),
            ("the number of sweeps of a frame", work.frame_sweeps),
            ("the number of slices per class", work.slices_per_class),
        ] {
            RangeError::check(count <= MOST_COUNT, name, count as f64, "of at most 1e9")?;
        }
        if work.sweeps > 0 {
            sweeps::check(&self.objective)?;
        }
        if work.slices_per_class > 0 {
            self.even_pace()?;
        }
        Ok(work)
    }

    /// The pace of slices, if terms that count do their share of the work.
    pub(super) fn even_pace(&self) -> Result<Pace, ConfigError> {
        let pace = self.objective.pace();
        let share = pace.share;
        if share >= LEAST_SHARE { Ok(pace) } else { Err(ConfigError::Uneven { share }) }
    }

    /// Sweeps that are usually worth it; `None` without a closed form.
    fn usual_sweeps(&mut self) -> Option<u64> {
        let pairs = self.sweeper().ok()?.pairs();
        let terms = &self.objective.terms;
        let descended = || terms.iter().filter(|term| term.spec.role == Role::Descend);
        let most = if descended().all(|term| term.spec.dims.len() == 1) { 10_000.0 } else { 1_000.0 };
        Some((USUAL_PAIRS / pairs).clamp(FEWEST_SWEEPS, most) as u64)
    }

    /// So many sweeps, and as many of a frame as take their share of the time.
    fn with_frame(&mut self, sweeps: u64) -> Result<Work, ConfigError> {
        sweeps::check(&self.objective)?;
        let work = Work { sweeps, ..Work::default() };
        let frame = if self.fresh { self.of_a_frame()? } else { None };
        let Some(mut frame) = frame else { return Ok(work) };
        let cost = self.sweeper()?.pairs() / frame.sweeper()?.pairs();
        let share = FRAME_SHARE / (1.0 - FRAME_SHARE);
        let frame_sweeps = (sweeps as f64 * cost * share).ceil().min(MOST_FRAME_SWEEPS) as u64;
        Ok(Work { frame_sweeps, ..work })
    }

    /// The work that fits into a time, of which finding that out is a part.
    fn fit(&mut self, seconds: f64) -> Result<Work, ConfigError> {
        let begin = Instant::now();
        let window = Duration::from_secs_f64((seconds / WINDOWS).clamp(2e-4, 8e-3));
        let rest = |begin: Instant| (seconds - begin.elapsed().as_secs_f64()).max(0.5 * seconds);
        let threads = rayon::current_num_threads() as f64;
        if sweeps::check(&self.objective).is_err() {
            let pace = self.even_pace()?;
            let steps = pace.steps_of(1) as f64;
            affordable(seconds, steps * self.objective.touches_per_step() / (threads * FASTEST_TOUCHES))?;
            let per_step = self.seconds_per_batch(window);
            affordable(seconds, steps * per_step)?;
            let slices = rest(begin) / per_step * pace.per_class;
            return Ok(Work { slices_per_class: slices.max(1.0) as u64, ..Work::default() });
        }
        affordable(seconds, self.sweeper()?.pairs() / (threads * FASTEST_PAIRS))?;
        let mut work = Work::default();
        let frame = if self.fresh { self.of_a_frame()? } else { None };
        let per_sweep = self.seconds_per_sweep(window)?;
        let mut of_frame = 0.0;
        if let Some(mut frame) = frame {
            let per_sweep = frame.seconds_per_sweep(window)?;
            let sweeps = (FRAME_SHARE * rest(begin) / per_sweep).clamp(1.0, MOST_FRAME_SWEEPS).floor();
            work.frame_sweeps = sweeps as u64;
            of_frame = sweeps * per_sweep;
        }
        affordable(seconds, of_frame + per_sweep)?;
        work.sweeps = ((rest(begin) - of_frame) / per_sweep).max(1.0) as u64;
        Ok(work)
    }

    /// Times a few steps that leave the table as it is.
    pub(super) fn seconds_per_batch(&mut self, window: Duration) -> f64 {
        let (fresh, steps) = (self.fresh, self.steps);
        // The first step grows the buffers and does not count, unless it has taken its time.
        let begin = Instant::now();
        self.step_in_pool(0.0, 0.0);
        let mut seconds = begin.elapsed().as_secs_f64();
        if seconds < LONG * window.as_secs_f64() {
            seconds = mean_seconds(window, || {
                self.step_in_pool(0.0, 0.0);
            });
        }
        (self.fresh, self.steps) = (fresh, steps);
        seconds
    }

    /// Times a few steps of sweeps that leave the table as it is.
    pub(super) fn seconds_per_sweep(&mut self, window: Duration) -> Result<f64, ConfigError> {
        let (fresh, swept) = (self.fresh, self.swept);
        let sweeper = self.sweeper()?;
        let (steps, turns) = (sweeper.steps(), sweeper.turns());
        let still = Motion { rate: 0.0, softening: 0.0, balance: 0.0 };
        // The first step makes the copy and does not count.
        self.sweep_step(0, still)?;
        let (mut step, mut outcome) = (0, Ok(()));
        let per_step = mean_seconds(window, || {
            // Without those that a balance follows.
            step = (step + 1) % (steps / turns - 1);
            outcome = self.sweep_step(step, still).map(|_| ());
        });
        outcome?;
        let sweeper = self.sweeper()?;
        let per_turn = mean_seconds(window, || sweeper.balance(0, 0.0));
        // What was copied has been rounded; the plan is as good as new.
        sweeper.forget();
        let per_slices = match self.objective.has_balances_beside_sweeps() {
            true => mean_seconds(window, || self.balance_by_slices(0, 0.0)),
            false => 0.0,
        };
        (self.fresh, self.swept) = (fresh, swept);
        Ok(steps as f64 * per_step + turns as f64 * per_turn + per_slices)
    }
}

/// Refuses a time that is far too short for the least that can be done.
fn affordable(seconds: f64, least: f64) -> Result<(), ConfigError> {
    if least <= 2.0 * seconds + 0.25 {
        return Ok(());
    }
    let digit = 10.0_f64.powf(least.log10().floor() - 1.0);
    Err(ConfigError::TooShort { seconds, least: (least / digit).ceil() * digit })
}

/// Mean time of a call, over as many as make a reliable figure: the median of three windows, since other work
/// may share the machine.
fn mean_seconds(window: Duration, mut call: impl FnMut()) -> f64 {
    let mut means = Vec::with_capacity(3);
    while means.len() < 3 {
        let (begin, mut timed) = (Instant::now(), 0);
        while timed == 0 || begin.elapsed() < window {
            call();
            timed += 1;
        }
        means.push(begin.elapsed().as_secs_f64() / f64::from(timed));
        if means[0] > LONG * window.as_secs_f64() {
            break; // long enough not to be disturbed
        }
    }
    means.sort_unstable_by(f64::total_cmp);
    means[means.len() / 2]
}
