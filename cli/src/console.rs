//! What is printed: words for people, or one line of JSON.

use std::error::Error;
use std::io::{self, ErrorKind, StdoutLock, Write};

use serde::Serialize;

use crate::{Ended, Failure, Shared};

/// Standard output. A fault of it never stands between a verb and its files: it is kept until
/// [`Console::end`].
#[derive(Debug)]
pub struct Console {
    out: StdoutLock<'static>,
    form: Form,
    fault: Option<io::Error>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Words,
    Json,
    Nothing,
}

impl Console {
    /// Speaks as the flags say; `--json` is printed in spite of `--quiet`.
    pub fn new(flags: &Shared) -> Self {
        let form = match flags {
            Shared { json: true, .. } => Form::Json,
            Shared { quiet: true, .. } => Form::Nothing,
            _ => Form::Words,
        };
        Self { out: io::stdout().lock(), form, fault: None }
    }

    /// Prints words, if words are wanted.
    pub fn say(&mut self, words: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
        if self.form == Form::Words {
            self.print(words);
        }
    }

    /// Prints a line of JSON, if JSON is wanted; what is not a finite number is `null`.
    pub fn figures(&mut self, figures: &impl Serialize) {
        if self.form == Form::Json {
            self.print(|out| {
                serde_json::to_writer(&mut *out, figures)?;
                writeln!(out)
            });
        }
    }

    fn print(&mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
        if self.fault.is_none() {
            self.fault = write(&mut self.out).and_then(|()| self.out.flush()).err();
        }
    }

    /// Ends the verb like this, if all could be printed. A reader who has gone away has read enough, and
    /// after a signal there may be no terminal.
    ///
    /// # Errors
    /// Any other fault of standard output.
    pub fn end(self, ended: Ended) -> Result<Ended, Failure> {
        match self.fault {
            Some(fault) if ended == Ended::Done && fault.kind() != ErrorKind::BrokenPipe => {
                Err(format!("cannot write to standard output: {fault}; the files are written").into())
            }
            _ => Ok(ended),
        }
    }
}

/// So many points, in words.
pub fn points(count: usize) -> String {
    if count == 1 { "1 point".into() } else { format!("{count} points") }
}

/// Says something on standard error that doesn't end the verb.
pub fn warn(words: &str) {
    let _ = writeln!(io::stderr(), "warning: {words}");
}

/// Says on standard error what went wrong. Not by `eprintln`, which panics where nobody can listen.
pub fn complain(error: &dyn Error) {
    let _ = writeln!(io::stderr(), "error: {error}");
}
