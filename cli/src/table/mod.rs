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
use fsot::{Config, Optimizer, SampleTable, metrics};

pub use self::flags::Arguments;
use self::plan::Planned;
use self::summary::Summary;
use crate::console::Console;
use crate::interrupt::Interrupt;
use crate::log::Log;
use crate::output::{self, Output};
use crate::progress::Progress;
use crate::{Ended, Failure, advice, run};

/// Makes the table.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { out, log, dry_run, shared, no_bound, .. } = arguments;
    let beside = Metadata::path_beside(out);
    let mut outputs = vec![
        Output { flag: "--out", path: out, endings: &["npy"] },
        Output { flag: "--out", path: &beside, endings: &["json"] },
    ];
    outputs.extend(log.as_deref().map(|path| Output { flag: "--log", path, endings: &["csv"] }));
    output::check(&outputs, &arguments.inputs())?;
    let recipe = arguments.recipe()?;
    shared.start_threads()?;
    let advised = |failure| advice::with_flags(failure, advice::of_table);
    let mut optimizer = Optimizer::new(recipe.config()?).map_err(|error| advised(error.into()))?;
    if *dry_run {
        let plan = optimizer.plan(recipe.until()).map_err(|error| advised(error.into()))?;
        let planned = Planned::new(&optimizer, &plan, recipe.steps);
        let mut console = Console::new(shared);
        console.say(|out| planned.words(out));
        console.figures(&planned);
        return console.end(Ended::Done);
    }
    let progress = Progress::new(shared);
    let mut log = log.as_deref().map(|path| Log::new(path, optimizer.config())).transpose()?;
    let report = run::watched(&mut optimizer, recipe.until(), &progress, |step| {
        log.iter_mut().for_each(|log| log.step(step));
        match recipe.steps {
            // Of a table whose run ended there.
            Some(last) if step.step >= last => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    let report = report.map_err(advised)?;

    // Before the bound, which takes a while and may be stopped.
    let (table, mut metadata) = (optimizer.table(), optimizer.metadata(&report));
    table.save_with(out, &metadata)?;
    log.iter_mut().for_each(|log| log.finish(&report, &table));
    log.map_or(Ok(()), Log::end)?;
    let interrupt = Interrupt::listen()?;
    if !no_bound && let Some(bound) = interrupt.unless_it_comes(move || bound(&optimizer)) {
        metadata.bound = Some(bound?);
        table.save_with(out, &metadata)?;
    }

    let bound_left_out = !no_bound && metadata.bound.is_none();
    let summary = Summary::new(out, &metadata, bound_left_out);
    let mut console = Console::new(shared);
    console.say(|out| summary.words(out));
    console.figures(&summary);
    let ended_early = metadata.run.ended_early && recipe.steps != Some(report.steps);
    console.end(Ended::stopped_if(ended_early || bound_left_out))
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
