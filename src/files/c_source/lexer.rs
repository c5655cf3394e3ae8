//! C and C++ cut into words, numbers and marks; comments, strings and directives are passed over.

use std::io::{self, BufRead};

/// Longest number, and longest part of a name that is kept.
const LONGEST: usize = 64;

/// Beginning of the names of macros that say what an array's axes are.
pub(super) const MACRO: &[u8] = b"FSOT_";

/// A piece of a source text. That of a word or a number is in [`Lexer::word`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Token {
    /// A name.
    Word,
    /// What begins like a number, whole or not.
    Number,
    /// Any other character; a quotation mark for a whole string.
    Mark(u8),
    End,
}

/// A text on its way through its tokens: one pass, of which nothing is kept but the last word.
pub(super) struct Lexer<R> {
    input: R,
    pub(super) word: Vec<u8>,
    /// Line, from 1.
    pub(super) line: usize,
    /// Nothing but blanks stood on this line.
    at_start: bool,
    /// The last token was the first of its line.
    is_first: bool,
    /// Ends of lines are marks.
    in_directive: bool,
    /// Whole numbers that macros with the names of ours stand for, behind `FSOT_…`; the first of a kind.
    pub(super) macros: Vec<(&'static str, u64)>,
}

impl<R: BufRead> Lexer<R> {
    pub(super) fn new(input: R) -> Self {
        let (word, macros) = (Vec::new(), Vec::new());
        Self { input, word, line: 1, at_start: true, is_first: false, in_directive: false, macros }
    }

    /// The next token, behind directives.
    pub(super) fn next(&mut self) -> io::Result<Token> {
        loop {
            match self.raw()? {
                Token::Mark(b'#') if self.is_first => self.directive()?,
                token => return Ok(token),
            }
        }
    }

    /// Reads up to the end of the line, and notes macros that are numbers.
    fn directive(&mut self) -> io::Result<()> {
        self.in_directive = true;
        let is_define = self.raw()? == Token::Word && self.word == b"define";
        let mut named = None;
        if is_define && self.raw()? == Token::Word && self.word.starts_with(MACRO) {
            named = super::MACROS.into_iter().find(|ending| self.word.ends_with(ending.as_bytes()));
        }
        if self.in_directive && self.raw()? == Token::Number {
            let number = super::number::whole(&self.word);
            if let (Some(name), Some(number)) = (named, number)
                && !self.macros.iter().any(|(other, _)| *other == name)
            {
                self.macros.push((name, number));
            }
        }
        while self.in_directive {
            if self.raw()? == Token::End {
                break;
            }
        }
        self.in_directive = false;
        Ok(())
    }

    fn raw(&mut self) -> io::Result<Token> {
        loop {
            let Some(byte) = self.peek()? else {
                self.in_directive = false;
                return Ok(Token::End);
            };
            self.skip();
            match byte {
                b'\n' => {
                    self.line += 1;
                    self.at_start = true;
                    if std::mem::take(&mut self.in_directive) {
                        return Ok(Token::Mark(b'\n'));
                    }
                }
                b' ' | b'\t' | b'\r' | b'\x0b' | b'\x0c' => {}
                b'\\' => self.continuation()?,
                b'/' if self.comment()? => {}
                _ => {
                    self.is_first = std::mem::take(&mut self.at_start);
                    return self.begun(byte);
                }
            }
        }
    }

    /// A line goes on behind a backslash at its end.
    fn continuation(&mut self) -> io::Result<()> {
        if self.peek()? == Some(b'\r') {
            self.skip();
        }
        if self.peek()? == Some(b'\n') {
            self.skip();
            self.line += 1;
        }
        Ok(())
    }

    /// Passes over a comment whose first stroke has been read; `false` if it is none.
    fn comment(&mut self) -> io::Result<bool> {
        match self.peek()? {
            Some(b'/') => {
                while self.peek()?.is_some_and(|byte| byte != b'\n') {
                    self.skip();
                }
                Ok(true)
            }
            Some(b'*') => {
                self.skip();
                let mut star = false;
                while let Some(byte) = self.peek()? {
                    self.skip();
                    if star && byte == b'/' {
                        break;
                    }
                    self.line += usize::from(byte == b'\n');
                    star = byte == b'*';
                }
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    /// The token that begins with this character, which has been read.
    fn begun(&mut self, byte: u8) -> io::Result<Token> {
        self.word.clear();
        let digit_follows = byte == b'.' && self.peek()?.is_some_and(|next| next.is_ascii_digit());
        if byte.is_ascii_digit() || digit_follows {
            self.word.push(byte);
            // As C's own first pass takes numbers, sound or not.
            while let Some(next) = self.peek()? {
                let last = self.word[self.word.len() - 1];
                let is_sign = matches!(next, b'+' | b'-') && matches!(last, b'e' | b'E' | b'p' | b'P');
                if !(next.is_ascii_alphanumeric() || matches!(next, b'.' | b'_' | b'\'') || is_sign) {
                    break;
                }
                self.skip();
                // One more than can be read, so that it will not be.
                if self.word.len() <= LONGEST {
                    self.word.push(next);
                }
            }
            return Ok(Token::Number);
        }
        let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_' || !byte.is_ascii();
        if is_letter(byte) {
            self.word.push(byte);
            while let Some(next) = self.peek()?
                && is_letter(next)
            {
                self.skip();
                if self.word.len() < LONGEST {
                    self.word.push(next);
                }
            }
            return Ok(Token::Word);
        }
        if matches!(byte, b'"' | b'\'') {
            self.string(byte)?;
        }
        Ok(Token::Mark(byte))
    }

    /// Passes over a string, which ends with its line at the latest.
    fn string(&mut self, quote: u8) -> io::Result<()> {
        while let Some(byte) = self.peek()? {
            if byte == b'\n' {
                break;
            }
            self.skip();
            if byte == quote {
                break;
            }
            if byte == b'\\' && self.peek()?.is_some_and(|next| next != b'\n') {
                self.skip();
            }
        }
        Ok(())
    }

    fn peek(&mut self) -> io::Result<Option<u8>> {
        loop {
            match self.input.fill_buf() {
                Ok(bytes) => return Ok(bytes.first().copied()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }

    fn skip(&mut self) {
        self.input.consume(1);
    }
}
