//! What is wrong with a checkpoint, or with where it should be resumed.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::io_advice;

/// A checkpoint that cannot be written, read or resumed.
///
/// ```
/// use fsot::optimizer::{Checkpoint, CheckpointError};
///
/// let error = Checkpoint::read(&mut "no checkpoint".as_bytes()).unwrap_err();
/// assert!(matches!(error, CheckpointError::Foreign { .. }));
/// assert!(error.to_string().starts_with("starts with \"no checkpoint\""));
/// ```
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// It could not be read or written.
    #[error("{0}; {advice}", advice = io_advice(.0))]
    Io(#[from] io::Error),
    /// Another kind of file, or another version of this one.
    #[error(
        "starts with \"{}\" instead of \"{expected}\": give a file that a checkpoint of this version was \
         written to",
        start.escape_ascii()
    )]
    Foreign {
        /// Its first bytes.
        start: Vec<u8>,
        /// What should stand there.
        expected: &'static str,
    },
    /// It was cut short or changed.
    #[error("the checkpoint is damaged: {reason}; take an earlier one, or start the run anew")]
    Damaged {
        /// What does not fit.
        reason: String,
    },
    /// It is of another configuration or of another demand.
    #[error(
        "the checkpoint is of another configuration or demand (hash {checkpoint}, here {here}): resume it \
         where Checkpoint::config and the demand of its run are optimised"
    )]
    OtherObjective {
        /// Hash of what the checkpoint's run optimised.
        checkpoint: String,
        /// Hash of what is optimised here.
        here: String,
    },
    /// The configuration is too long to be a part of the checkpoint, or holds code.
    #[error(
        "the checkpoint does not hold its configuration ({reason}): make the optimiser as for the run itself"
    )]
    NoConfig {
        /// Why it does not.
        reason: String,
    },
    /// What is wrong with a file.
    #[error("cannot {verb} the checkpoint {}: {problem}", path.display())]
    File {
        /// `read` or `write`.
        verb: &'static str,
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: Box<CheckpointError>,
    },
}
