//! `fsot table`: optimises a sample table and writes it as `.npy`, with its metadata in a `.json` beside it.

mod flags;
mod summary;

use fsot::files::{BoundRecord, Metadata};
use fsot::optimizer::StepReport;
use fsot::{Config, Optimizer, SampleTable, metrics};

pub use self::flags::Arguments;
use self::summary::Summary;
use crate::checkpoint::Writer;
use crate::console::Console;
use crate::interrupt::Interrupt;
use crate::output::{self, Output};
use crate::progress::Progress;
use crate::run::Course;
use crate::{Ended, Failure, advice, run};

/// Makes the table.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { out, shared, no_bound, .. } = arguments;
    let beside = Metadata::path_beside(out);
    let mut outputs = vec![
        Output { flag: "--out", path: out, endings: &["npy"] },
        Output { flag: "--out", path: &beside, endings: &["json"] },
    ];
    outputs.extend(arguments.checkpoint.output());
    output::check(&outputs, &arguments.checkpoint.inputs())?;
    shared.start_threads()?;
    let advised = |failure| advice::with_flags(failure, advice::of_table);
    let (mut optimizer, course) = match arguments.checkpoint.resumed()? {
        None => {
            let optimizer = Optimizer::new(arguments.config()).map_err(|error| advised(error.into()))?;
            (optimizer, Course::New(arguments.until()))
        }
        Some(checkpoint) => {
            let mut optimizer = Optimizer::new(checkpoint.config()?)?;
            optimizer.resume(checkpoint)?;
            (optimizer, Course::Resumed)
        }
    };
    let progress = Progress::new(shared);
    let mut writer = arguments.checkpoint.writer();
    let watch = |step: &StepReport, is_last| {
        if let Some(writer) = &mut writer {
            writer.look(step, is_last);
        }
    };
    let report = run::watched(&mut optimizer, course, &progress, watch).map_err(advised)?;
    let path = writer.as_ref().map(|writer| writer.path().to_owned());
    // The table is written all the same.
    let written = writer.map_or(Ok(()), Writer::end);

    // Before the bound, which takes a while and may be stopped.
    let (table, mut metadata) = (optimizer.table(), optimizer.metadata(&report));
    table.save_with(out, &metadata)?;
    let interrupt = Interrupt::listen()?;
    if !no_bound && let Some(bound) = interrupt.unless_it_comes(move || bound(&optimizer)) {
        metadata.bound = Some(bound?);
        table.save_with(out, &metadata)?;
    }

    let bound_left_out = !no_bound && metadata.bound.is_none();
    let summary = Summary::new(out, &metadata, bound_left_out);
    let mut console = Console::new(shared);
    console.say(|out| summary.words(out));
    if let (true, Some(path)) = (metadata.run.ended_early && written.is_ok(), &path) {
        console.say(|out| writeln!(out, "the run goes on with --resume {}", path.display()));
    }
    console.figures(&summary);
    written?;
    console.end(Ended::stopped_if(metadata.run.ended_early || bound_left_out))
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
