//! `fsot table`: optimises a sample table and writes it as `.npy`, with its metadata in a `.json` beside it.

mod flags;
mod summary;

use fsot::files::{BoundRecord, Metadata};
use fsot::{Config, Optimizer, SampleTable, metrics};

pub use self::flags::Arguments;
use self::summary::Summary;
use crate::console::Console;
use crate::interrupt::Interrupt;
use crate::output::{self, Output};
use crate::progress::Progress;
use crate::{Ended, Failure, advice, run};

/// Makes the table.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { out, shared, no_bound, .. } = arguments;
    let beside = Metadata::path_beside(out);
    let outputs = [
        Output { flag: "--out", path: out, endings: &["npy"] },
        Output { flag: "--out", path: &beside, endings: &["json"] },
    ];
    output::check(&outputs, &[])?;
    shared.start_threads()?;
    let advised = |failure| advice::with_flags(failure, advice::of_table);
    let mut optimizer = Optimizer::new(arguments.config()).map_err(|error| advised(error.into()))?;
    let progress = Progress::new(shared);
    let report = run::observed(&mut optimizer, arguments.until(), &progress).map_err(advised)?;

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
    console.figures(&summary);
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
