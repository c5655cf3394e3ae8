//! Numbers as text: one sample a line, or a row of a picture, between blanks, commas or semicolons.

use std::fs::File;
use std::io::{self, Read};

use super::header::shortened;
use crate::error::ImportError;

/// Longest word that can be a number.
const LONGEST: usize = 64;

/// Why text was not read.
pub(super) enum Unread {
    Io(io::Error),
    Import(ImportError),
}

impl From<io::Error> for Unread {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<ImportError> for Unread {
    fn from(problem: ImportError) -> Self {
        Self::Import(problem)
    }
}

/// The numbers of a text file, and how many stand on a line.
pub(super) struct Numbers {
    pub(super) values: Vec<f64>,
    /// Numbers on every line; `Err` tells the first line that has another count than those before.
    pub(super) columns: Result<usize, ImportError>,
}

/// A text on its way through its bytes.
#[derive(Default)]
struct Reader {
    values: Vec<f64>,
    /// The word that has begun.
    word: Vec<u8>,
    /// Line, from 0.
    line: usize,
    /// Numbers on this line so far, and on those before.
    count: usize,
    columns: usize,
    ragged: Option<ImportError>,
    /// What is on the line is not read: after `#` or `%`, or the names of columns.
    skipping: bool,
}

/// Reads numbers up to the end. Blank lines, what stands behind `#` or `%`, and a first line of words are
/// passed over.
pub(super) fn read(mut file: File) -> Result<Numbers, Unread> {
    let mut reader = Reader::default();
    let mut block = vec![0; 1 << 16];
    let mut begun = false;
    loop {
        let count = match file.read(&mut block) {
            Ok(count) => count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error.into()),
        };
        let mut bytes = &block[..count];
        if !begun {
            // What some editors begin a file with.
            bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
            begun = true;
        }
        reader.values.try_reserve(bytes.len() / 2 + 1).map_err(io::Error::from)?;
        bytes.iter().try_for_each(|&byte| reader.take(byte)).map_err(Unread::Import)?;
        if count == 0 {
            break;
        }
    }
    reader.take(b'\n').map_err(Unread::Import)?;
    if reader.values.is_empty() {
        return Err(Unread::Import(ImportError::Empty));
    }
    let columns = reader.ragged.map_or(Ok(reader.columns), Err);
    Ok(Numbers { values: reader.values, columns })
}

/// The number that a word is in base 10, such that rounding it to `f32` gives the nearest to the word.
///
/// Rounded twice, a word that lies just beside the middle of two `f32` would go to the wrong one.
pub(super) fn nearest(word: &str) -> Option<f64> {
    let number: f64 = word.parse().ok()?;
    /// What an `f64` has behind the digits of an `f32`.
    const REST: u64 = (1 << 29) - 1;
    let is_middle = number.to_bits() & REST == 1 << 28 || number.abs() < f64::from(f32::MIN_POSITIVE);
    // Greater ones may be levels, which are no f32.
    if is_middle && number != 0.0 && number.abs() < 1.0 {
        return word.parse().ok().map(|number: f32| number.into());
    }
    Some(number)
}

impl Reader {
    fn take(&mut self, byte: u8) -> Result<(), ImportError> {
        match byte {
            b'\n' => {
                self.end_word()?;
                self.end_line();
            }
            _ if self.skipping => {}
            b' ' | b'\t' | b'\r' | b'\x0c' | b',' | b';' => self.end_word()?,
            b'#' | b'%' => {
                self.end_word()?;
                self.skipping = true;
            }
            _ if self.word.len() < LONGEST => self.word.push(byte),
            _ => return Err(self.no_number()),
        }
        Ok(())
    }

    fn end_word(&mut self) -> Result<(), ImportError> {
        if self.word.is_empty() {
            return Ok(());
        }
        // Some programs write names, or all words, in quotes.
        let quoted = self.word.strip_prefix(b"\"");
        let inner = quoted.and_then(|word| word.strip_suffix(b"\"")).unwrap_or(&self.word);
        let number = str::from_utf8(inner).ok().and_then(nearest);
        let is_name = quoted.unwrap_or(&self.word).first().is_some_and(u8::is_ascii_alphabetic);
        match number {
            Some(number) => {
                self.values.push(number);
                self.count += 1;
            }
            // Names of columns above all numbers.
            None if self.values.is_empty() && self.line == 0 && is_name => {
                self.skipping = true;
            }
            None => return Err(self.no_number()),
        }
        self.word.clear();
        Ok(())
    }

    fn end_line(&mut self) {
        self.line += 1;
        let count = std::mem::take(&mut self.count);
        self.skipping = false;
        if count == 0 {
            return;
        }
        if self.columns == 0 {
            self.columns = count;
        } else if self.columns != count && self.ragged.is_none() {
            self.ragged = Some(ImportError::Ragged { line: self.line, given: count, expected: self.columns });
        }
    }

    fn no_number(&self) -> ImportError {
        let text = shortened(String::from_utf8_lossy(&self.word).into_owned());
        ImportError::Number { line: self.line + 1, text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_once() {
        // 2⁻²⁵ above 1/2 is the middle of two f32; a trace more belongs to the upper one.
        let middle = "0.5000000298023223876953125";
        for (word, expected) in [
            (middle.to_string(), 0.5_f32),
            (format!("{middle}000001"), 0.5_f32.next_up()),
            ("1e-45".into(), f32::from_bits(1)),
            ("0.1".into(), 0.1),
        ] {
            assert_eq!(nearest(&word).map(|number| number as f32), Some(expected), "{word}");
        }
        // Whole numbers keep digits that no f32 has.
        assert_eq!(nearest("16777219"), Some(16777219.0));
    }

    fn all(text: &str) -> Result<(Vec<f64>, usize), ImportError> {
        let mut reader = Reader::default();
        text.bytes().chain([b'\n']).try_for_each(|byte| reader.take(byte))?;
        Ok((reader.values, reader.columns))
    }

    #[test]
    fn quotes_are_of_names_and_of_numbers() {
        let expected = Ok((vec![0.25, 0.5], 2));
        for text in
            ["a,b\n0.25,0.5", "\"a\",\"b\"\n0.25,0.5", "\"a b\";\"c, 1\"\n0.25;0.5", "\"0.25\",\"0.5\""]
        {
            assert_eq!(all(text), expected, "{text}");
        }
        // A comma within a number, and half a pair of quotes, are no names.
        for (text, word) in [("\"0,5\"", "\"0"), ("\"0.5", "\"0.5"), ("0.5\"", "0.5\""), ("\"\"", "\"\"")] {
            assert_eq!(all(text), Err(ImportError::Number { line: 1, text: word.into() }), "{text}");
        }
        assert!(all("1 2\n\"a\"").is_err());
    }
}
