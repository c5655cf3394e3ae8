//! Numbers between braces.

use std::io::{self, BufRead};

use super::super::header::shortened;
use super::super::text::Unread;
use super::lexer::{Lexer, Token};
use super::{DEEPEST, number};
use crate::error::ImportError;

/// Nested lists of equal lengths.
#[derive(Default)]
pub(super) struct List {
    pub(super) values: Vec<f64>,
    /// Lengths by depth, as the first list of each has shown.
    lengths: [Option<usize>; DEEPEST],
    /// Members so far of the lists that are open.
    counts: [usize; DEEPEST],
    /// Lists that are open.
    depth: usize,
    /// Depth of the lists that hold numbers.
    of_numbers: Option<usize>,
}

impl List {
    /// Reads a list whose first brace has been read.
    pub(super) fn read(mut self, lexer: &mut Lexer<impl BufRead>) -> Result<Self, Unread> {
        self.depth = 1;
        // A member may stand here: behind a brace and behind a comma.
        let mut wants_member = true;
        let mut sign = None;
        while self.depth > 0 {
            let token = lexer.next()?;
            match token {
                Token::Mark(b'{') if wants_member && sign.is_none() => self.open(lexer.line)?,
                Token::Mark(b'}') if sign.is_none() => {
                    self.close(lexer.line)?;
                    wants_member = false;
                }
                Token::Mark(b',') if !wants_member => wants_member = true,
                Token::Mark(mark @ (b'+' | b'-')) if wants_member && sign.is_none() => sign = Some(mark),
                Token::Number if wants_member => {
                    let value = number::parse(&lexer.word).ok_or_else(|| no_number(token, lexer))?;
                    self.push(if sign.take() == Some(b'-') { -value } else { value }, lexer.line)?;
                    wants_member = false;
                }
                Token::End => return Err(ImportError::Unclosed.into()),
                _ => return Err(no_number(token, lexer).into()),
            }
        }
        Ok(self)
    }

    fn open(&mut self, line: usize) -> Result<(), ImportError> {
        if self.depth == DEEPEST || self.of_numbers.is_some_and(|depth| depth <= self.depth) {
            return Err(ImportError::Nesting { line });
        }
        self.counts[self.depth] = 0;
        self.depth += 1;
        Ok(())
    }

    fn close(&mut self, line: usize) -> Result<(), ImportError> {
        self.depth -= 1;
        let given = self.counts[self.depth];
        let expected = *self.lengths[self.depth].get_or_insert(given);
        if given != expected {
            return Err(ImportError::Lists { line, given, expected });
        }
        if self.depth > 0 {
            self.counts[self.depth - 1] += 1;
        }
        Ok(())
    }

    fn push(&mut self, value: f64, line: usize) -> Result<(), Unread> {
        if *self.of_numbers.get_or_insert(self.depth) != self.depth {
            return Err(ImportError::Nesting { line }.into());
        }
        if self.values.len() == self.values.capacity() {
            self.values.try_reserve(self.values.len().max(1 << 12)).map_err(io::Error::from)?;
        }
        self.values.push(value);
        self.counts[self.depth - 1] += 1;
        Ok(())
    }

    /// Lengths of the lists by depth, from the outermost.
    pub(super) fn shape(&self) -> Vec<usize> {
        let depth = self.of_numbers.unwrap_or(1);
        self.lengths[..depth].iter().map(|length| length.unwrap_or(0)).collect()
    }
}

fn no_number<R: BufRead>(token: Token, lexer: &Lexer<R>) -> ImportError {
    let text = match token {
        Token::Mark(mark) => char::from(mark).into(),
        _ => String::from_utf8_lossy(&lexer.word).into_owned(),
    };
    ImportError::Literal { line: lexer.line, text: shortened(text) }
}
