//! Flags that every verb has.

use clap::Args;
use clap::builder::RangedU64ValueParser;

use crate::Failure;

/// More are a slip.
const MOST_THREADS: usize = 1024;

/// Threads, and what is printed.
#[derive(Args, Clone, Debug)]
pub struct Shared {
    /// Threads; 0 uses every core. The result does not depend on it.
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// No progress bar and no words.
    #[arg(long)]
    pub quiet: bool,
    /// Print one line of JSON with all figures, and nothing else.
    #[arg(long)]
    pub json: bool,
}

impl Shared {
    /// Gives this process as many threads as were asked for.
    ///
    /// # Errors
    /// More threads than the system has to give.
    pub(crate) fn start_threads(&self) -> Result<(), Failure> {
        match self.threads {
            0 => Ok(()),
            1..=MOST_THREADS => {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads);
                pool.build_global().map_err(|error| {
                    format!("cannot start {} threads: {error}; give fewer --threads", self.threads).into()
                })
            }
            threads => {
                Err(format!("--threads is {threads}: give at most {MOST_THREADS}, or 0 for every core")
                    .into())
            }
        }
    }
}

/// How many points: at least one.
pub(crate) fn count() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(1..1 << 31)
}
