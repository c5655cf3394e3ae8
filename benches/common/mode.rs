//! Whether a bench measures or is itself tested, as criterion decides it.

use clap::Args;

/// Flags that cargo and criterion's users give to every bench.
#[derive(Args)]
pub struct Mode {
    /// Run everything once, small, and check it.
    #[arg(long)]
    test: bool,
    /// What `cargo bench` passes; without it this is a test.
    #[arg(long, hide = true)]
    bench: bool,
}

impl Mode {
    pub fn is_test(&self) -> bool {
        self.test || !self.bench
    }
}
