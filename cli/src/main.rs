//! The command `fsot`.

use std::process::ExitCode;

fn main() -> ExitCode {
    fsot_cli::main()
}
