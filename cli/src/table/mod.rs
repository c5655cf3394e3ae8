//! `fsot table`: optimises a sample table and writes it as `.npy`, with its metadata in a `.json` beside it.

mod flags;
mod literal;
mod plan;
mod reading;
mod recipe;
mod stencil;
mod summary;
mod values;

use std::ops::ControlFlow;

use fsot::files::{BoundRecord, Metadata};
use fsot::{Config, ConfigError, Optimizer, SampleTable, metrics};

pub use self::flags::Arguments;
pub use self::literal::obstacle;
use self::plan::{Besides, Planned};
use self::summary::Summary;
use crate::checkpoint::Writer;
use crate::console::{self, Console};
use crate::interrupt::Interrupt;
use crate::log::Log;
use crate::output::{self, Output};
use crate::progress::Progress;
use crate::run::Course;
use crate::{Ended, Failure, advice, run};

/// Makes the table.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { out, log, checkpoint, shared, no_bound, .. } = arguments;
    let beside = Metadata::path_beside(out);
    let mut outputs = vec![
        Output { flag: "--out", path: out, endings: &["npy"] },
        Output { flag: "--out", path: &beside, endings: &["json"] },
    ];
    outputs.extend(log.as_deref().map(|path| Output { flag: "--log", path, endings: &["csv"] }));
    outputs.extend(checkpoint.output());
    output::check(&outputs, &arguments.inputs())?;
    let Some(Start { mut optimizer, course, last_step }) = start(arguments)? else {
        return Ok(Ended::Done);
    };
    let progress = Progress::new(shared);
    let is_resumed = matches!(course, Course::Resumed);
    let mut log = log.as_deref().map(|path| Log::new(path, optimizer.config(), is_resumed)).transpose()?;
    let mut writer = checkpoint.writer();
    let report = run::watched(&mut optimizer, course, &progress, |step, a_signal_came| {
        log.iter_mut().for_each(|log| log.step(step));
        writer.iter_mut().for_each(|writer| writer.look(step, a_signal_came));
        match last_step {
            // Of a table whose run ended there.
            Some(last) if step.step >= last => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    let report = report.map_err(|failure| advice::with_flags(failure, advice::of_table))?;

    // Before the bound, which takes a while and may be stopped.
    let (table, mut metadata) = (optimizer.table(), optimizer.metadata(&report));
    table.save_with(out, &metadata)?;
    log.iter_mut().for_each(|log| log.finish(&report, &table));
    let logged = log.map_or(Ok(()), Log::end);
    let goes_on = writer.as_ref().map(|writer| writer.path().to_owned());
    let written = writer.map_or(Ok(()), Writer::end);
    let interrupt = Interrupt::listen()?;
    if !no_bound && let Some(bound) = interrupt.unless_it_comes(move || bound(&optimizer)) {
        metadata.bound = Some(bound?);
        table.save_with(out, &metadata)?;
    }

    let ended_early = metadata.run.ended_early && last_step != Some(report.steps);
    let bound_left_out = !no_bound && metadata.bound.is_none();
    let summary = Summary::new(out, &metadata, bound_left_out);
    let mut console = Console::new(shared);
    console.say(|out| summary.words(out));
    if let (true, true, Some(path)) = (ended_early, written.is_ok(), goes_on) {
        console.say(|out| writeln!(out, "the run goes on with --resume {}", path.display()));
    }
    console.figures(&summary);
    // The table is written all the same.
    logged.and(written)?;
    console.end(Ended::stopped_if(ended_early || bound_left_out))
}

/// A run that can begin.
struct Start {
    optimizer: Optimizer,
    course: Course,
    /// Of a run that is made again and had ended early.
    last_step: Option<u64>,
}

/// What is asked for; `None` where only the plan was, which is printed.
fn start(arguments: &Arguments) -> Result<Option<Start>, Failure> {
    let Arguments { checkpoint, dry_run, log, shared, .. } = arguments;
    let advised = |error: ConfigError| advice::with_flags(error.into(), advice::of_table);
    if let Some(checkpoint) = checkpoint.resumed()? {
        shared.start_threads()?;
        if checkpoint.crate_version() != env!("CARGO_PKG_VERSION") {
            let version = checkpoint.crate_version();
            console::warn(&format!(
                "the checkpoint was taken by version {version}, which may round otherwise"
            ));
        }
        let mut optimizer = Optimizer::new(checkpoint.config()?)?;
        optimizer.resume(checkpoint)?;
        return Ok(Some(Start { optimizer, course: Course::Resumed, last_step: None }));
    }
    let recipe = arguments.recipe()?;
    if recipe.steps.is_some() && checkpoint.output().is_some() {
        let complaint = "the run that --config makes again had ended early, which a checkpoint does not \
                         know: leave out --checkpoint";
        return Err(complaint.into());
    }
    shared.start_threads()?;
    let mut optimizer = Optimizer::new(recipe.config()?).map_err(advised)?;
    if !dry_run {
        if checkpoint.output().is_some() && optimizer.checkpoint().config().is_err() {
            let complaint = "the configuration is too long for a checkpoint: leave out --checkpoint, or give \
                             a smaller --kernel or fewer --terms";
            return Err(complaint.into());
        }
        let course = Course::New(recipe.until());
        return Ok(Some(Start { optimizer, course, last_step: recipe.steps }));
    }
    let besides =
        Besides { checkpoints: checkpoint.is_kept(), log: log.is_some(), bound: !arguments.no_bound };
    let plan = optimizer.plan(recipe.until()).map_err(advised)?;
    let planned = Planned::new(&optimizer, &plan, recipe.steps, besides);
    let mut console = Console::new(shared);
    console.say(|out| planned.words(out));
    console.figures(&planned);
    console.end(Ended::Done)?;
    Ok(None)
}

/// The bound of the white noise that the run began with, and of what has become of it.
fn bound(optimizer: &Optimizer) -> Result<BoundRecord, Failure> {
    // Enough slices for a standard error of about half a percent of the ratio.
    const SLICES: usize = 16_384;
    let Config { extent, dims, seed, .. } = *optimizer.config();
    let measure = |table| metrics::Bound::measure(&table, optimizer.objective(), seed, SLICES);
    let before = measure(SampleTable::white_noise(extent, dims, seed)?)?.total;
    Ok(BoundRecord { before, after: measure(optimizer.table())?.total })
}
