//! What all kinds of points have in common: a run, its files, and what is said of it.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use fsot::files::RunRecord;
use fsot::{Config, Optimizer, SampleTable, Until};
use serde::Serialize;

use super::files::Places;
use crate::console::{self, Console};
use crate::log::Log;
use crate::progress::Progress;
use crate::run::Course;
use crate::{Ended, Failure, Shared, advice, run};

/// Points that a run has made.
pub struct Made {
    pub table: SampleTable,
    pub work: Work,
    /// To be ended when all else is written.
    pub log: Option<Log>,
}

/// How much work that was.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Work {
    /// Time before the first step.
    pub planning_seconds: f64,
    /// The steps, and how they ended.
    #[serde(flatten)]
    pub run: RunRecord,
}

impl Work {
    /// This and another run's work; what both were asked for is the other's.
    pub fn and(self, other: Self) -> Self {
        let run = RunRecord {
            steps: self.run.steps + other.run.steps,
            seconds: self.run.seconds + other.run.seconds,
            ended_early: self.run.ended_early || other.run.ended_early,
            ..other.run
        };
        Self { planning_seconds: self.planning_seconds + other.planning_seconds, run }
    }
}

/// Optimises points by so many slices per class, or until a signal comes.
pub fn make(config: Config, slices: u64, progress: &Progress, log: Option<&Path>) -> Result<Made, Failure> {
    let begin = Instant::now();
    let advised = |failure| advice::with_flags(failure, advice::of_points);
    // A signal ends this as it ends any process: there is nothing to keep yet.
    let planned = Optimizer::new_observed(config, |share| {
        progress.show_planning(share);
        ControlFlow::Continue(())
    });
    let mut optimizer = planned.map_err(|error| advised(error.into()))?;
    progress.end_planning();
    let planning_seconds = begin.elapsed().as_secs_f64();
    let course = Course::New(Until::SlicesPerClass(slices));
    let mut log = log.map(|path| Log::new(path, optimizer.config(), false)).transpose()?;
    let report = run::watched(&mut optimizer, course, progress, |step, _| {
        log.iter_mut().for_each(|log| log.step(step));
        ControlFlow::Continue(())
    });
    let report = report.map_err(advised)?;
    let work = Work { planning_seconds, run: RunRecord::from(&report) };
    let table = optimizer.into_table();
    log.iter_mut().for_each(|log| log.finish(&report, &table));
    Ok(Made { table, work, log })
}

/// What is measured of points, in words and as JSON.
pub trait Figures: Serialize {
    fn words(&self, out: &mut dyn Write) -> io::Result<()>;
}

#[derive(Serialize)]
struct Line<'a, F> {
    points: usize,
    files: Vec<String>,
    #[serde(flatten)]
    work: &'a Work,
    /// `null` if a signal came before they were measured.
    figures: &'a Option<F>,
}

/// Says what was made, and what it is worth unless a signal came before that was measured.
pub fn tell<F: Figures>(
    flags: &Shared,
    points: usize,
    work: &Work,
    places: &Places,
    figures: &Option<F>,
) -> Result<Ended, Failure> {
    let mut console = Console::new(flags);
    console.say(|out| {
        let Work { planning_seconds, run: RunRecord { steps, seconds, ended_early, .. } } = work;
        let stopped =
            if *ended_early { format!(", stopped early after {steps} steps") } else { String::new() };
        writeln!(
            out,
            "{}, planned in {planning_seconds:.2} s, optimised in {seconds:.2} s{stopped}",
            console::points(points)
        )?;
        match figures {
            Some(figures) => figures.words(out)?,
            None => writeln!(out, "not measured, since a signal came")?,
        }
        writeln!(out, "{}", places.names().join(", "))
    });
    console.figures(&Line { points, files: places.names(), work, figures });
    console.end(Ended::stopped_if(work.run.ended_early || figures.is_none()))
}
