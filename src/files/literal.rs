//! The header of a `.npy` file: a dictionary as Python writes one, in every dialect that numpy's reader
//! takes.
//!
//! One pass without recursion, so that a header costs time in proportion to its length, however it is nested.

use std::mem;

/// What a literal says, as far as headers go.
#[derive(Debug, PartialEq)]
pub(super) enum Value {
    Text(String),
    Int(u64),
    Bool(bool),
    /// A tuple of whole numbers.
    Tuple(Vec<u64>),
    /// Keys and values in turn. Its own dictionaries are [`Value::Other`], so that nothing nests.
    Dict(Vec<Item>),
    /// Anything else that is well formed.
    Other,
}

/// A literal, and where it stands among the characters.
#[derive(Debug, PartialEq)]
pub(super) struct Item {
    pub(super) value: Value,
    pub(super) from: usize,
    pub(super) to: usize,
}

/// An open bracket.
struct Frame {
    close: char,
    from: usize,
    items: Vec<Item>,
    want: Want,
    /// A comma has made a tuple of a parenthesis.
    commas: bool,
}

/// What may come next inside of a bracket.
#[derive(Clone, Copy, PartialEq)]
enum Want {
    Item,
    Colon,
    Separator,
}

pub(super) struct Parser<'a> {
    text: &'a [char],
    at: usize,
    /// Python 2 wrote `L` behind long integers.
    python_2: bool,
    open: Vec<Frame>,
    done: Option<Item>,
    /// The last token was a string, which another one would continue.
    string_before: bool,
}

impl<'a> Parser<'a> {
    /// For text whose lines end in `\n`.
    pub(super) fn new(text: &'a [char], python_2: bool) -> Self {
        Self { text, at: 0, python_2, open: Vec::new(), done: None, string_before: false }
    }

    /// The one literal that the text is.
    pub(super) fn parse(mut self) -> Result<Item, String> {
        loop {
            self.skip_blank()?;
            let from = self.at;
            let Some(next) = self.peek() else { break };
            let string_before = mem::take(&mut self.string_before);
            match next {
                '(' | '[' | '{' => self.open(next)?,
                ')' | ']' | '}' => self.close(next)?,
                ',' | ':' => self.separate(next)?,
                '\'' | '"' => self.string("", string_before)?,
                '+' | '-' => {
                    self.at += 1;
                    self.skip_blank()?;
                    let is_number = self.peek().is_some_and(|next| next.is_ascii_digit() || next == '.');
                    if !is_number {
                        return Err(format!("'{next}' before no number"));
                    }
                    let number = self.number()?;
                    self.push(if next == '-' { Value::Other } else { number }, from)?;
                }
                '0'..='9' | '.' => {
                    let number = self.number()?;
                    self.push(number, from)?;
                }
                _ if is_name(next) => self.name(string_before)?,
                _ => return Err(format!("unexpected {next:?}")),
            }
        }
        match (self.open.last(), self.done) {
            (Some(frame), _) => Err(format!("'{}' is missing", frame.close)),
            (None, Some(item)) => Ok(item),
            (None, None) => Err("it is empty".into()),
        }
    }

    fn peek(&self) -> Option<char> {
        self.text.get(self.at).copied()
    }

    fn skip_blank(&mut self) -> Result<(), String> {
        while let Some(next) = self.peek() {
            match next {
                ' ' | '\t' | '\x0c' | '\n' => self.at += 1,
                '#' => {
                    while self.peek().is_some_and(|next| next != '\n') {
                        self.at += 1;
                    }
                }
                '\\' if self.text.get(self.at + 1) == Some(&'\n') => self.at += 2,
                '\\' => return Err("'\\' before no line break".into()),
                _ => break,
            }
        }
        Ok(())
    }

    /// A literal ends here.
    fn push(&mut self, value: Value, from: usize) -> Result<(), String> {
        let item = Item { value, from, to: self.at };
        match self.open.last_mut() {
            Some(frame) if frame.want == Want::Item => {
                let is_key = frame.close == '}' && frame.items.len().is_multiple_of(2);
                frame.want = if is_key { Want::Colon } else { Want::Separator };
                frame.items.push(item);
                Ok(())
            }
            None if self.done.is_none() => {
                self.done = Some(item);
                Ok(())
            }
            _ => Err(format!("{:?} where ',' or an end should stand", self.quote(from))),
        }
    }

    fn open(&mut self, bracket: char) -> Result<(), String> {
        if self.open.last().map_or(self.done.is_some(), |frame| frame.want != Want::Item) {
            return Err(format!("'{bracket}' where ',' or an end should stand"));
        }
        let close = match bracket {
            '(' => ')',
            '[' => ']',
            _ => '}',
        };
        let items = Vec::new();
        self.open.push(Frame { close, from: self.at, items, want: Want::Item, commas: false });
        self.at += 1;
        Ok(())
    }

    fn separate(&mut self, separator: char) -> Result<(), String> {
        let want = if separator == ':' { Want::Colon } else { Want::Separator };
        match self.open.last_mut() {
            Some(frame) if frame.want == want => {
                frame.want = Want::Item;
                frame.commas |= separator == ',';
                self.at += 1;
                Ok(())
            }
            _ => Err(format!("unexpected '{separator}'")),
        }
    }

    fn close(&mut self, bracket: char) -> Result<(), String> {
        let unexpected = || Err(format!("unexpected '{bracket}'"));
        let Some(mut frame) = self.open.pop_if(|frame| frame.close == bracket) else { return unexpected() };
        // After a comma, or with nothing inside; not after a colon.
        let may_end = frame.want == Want::Item
            && (frame.items.is_empty() || frame.commas)
            && (bracket != '}' || frame.items.len().is_multiple_of(2));
        if frame.want != Want::Separator && !may_end {
            return unexpected();
        }
        self.at += 1;
        let value = match bracket {
            ')' if !frame.commas && frame.items.len() == 1 => frame.items.remove(0).value,
            ')' => {
                let number =
                    |item: &Item| if let Value::Int(number) = item.value { Some(number) } else { None };
                frame.items.iter().map(number).collect::<Option<_>>().map_or(Value::Other, Value::Tuple)
            }
            ']' => Value::Other,
            _ => {
                for item in &mut frame.items {
                    if matches!(item.value, Value::Dict(_)) {
                        item.value = Value::Other;
                    }
                }
                Value::Dict(frame.items)
            }
        };
        self.push(value, frame.from)
    }

    /// A constant, or the prefix of a string.
    fn name(&mut self, string_before: bool) -> Result<(), String> {
        let from = self.at;
        while self.peek().is_some_and(is_name) {
            self.at += 1;
        }
        let name: String = self.text[from..self.at].iter().collect();
        if matches!(self.peek(), Some('\'' | '"')) {
            return self.string(&name, string_before);
        }
        let value = match name.as_str() {
            "True" => Value::Bool(true),
            "False" => Value::Bool(false),
            "None" => Value::Other,
            _ => return Err(format!("{name} is no constant")),
        };
        self.push(value, from)
    }

    /// A whole number, or another one.
    fn number(&mut self) -> Result<Value, String> {
        let from = self.at;
        let is_part = |c: char| is_name(c) && c != 'L' || c == '.';
        while self.peek().is_some_and(is_part) {
            self.at += 1;
        }
        let digits: String = self.text[from..self.at].iter().collect();
        // On the same line, maybe after a blank.
        let mut end = self.at;
        while matches!(self.text.get(end), Some(' ' | '\t' | '\x0c')) {
            end += 1;
        }
        if self.python_2 && self.text.get(end) == Some(&'L') {
            self.at = end + 1;
        }
        if self.peek().is_some_and(is_name) {
            return Err(format!("{:?} is no number", self.quote(from)));
        }
        let (radix, digits) = match digits.get(..2) {
            Some("0x" | "0X") => (16, digits[2..].strip_prefix('_').unwrap_or(&digits[2..])),
            Some("0o" | "0O") => (8, digits[2..].strip_prefix('_').unwrap_or(&digits[2..])),
            Some("0b" | "0B") => (2, digits[2..].strip_prefix('_').unwrap_or(&digits[2..])),
            _ => (10, digits.as_str()),
        };
        let is_whole = digits.split('_').all(|run| !run.is_empty() && run.chars().all(|c| c.is_digit(radix)));
        if !is_whole {
            let is_float = digits.bytes().all(|byte| byte.is_ascii_digit() || b".eEjJ_".contains(&byte));
            return if radix == 10 && is_float {
                Ok(Value::Other)
            } else {
                Err(format!("{:?} is no number", self.quote(from)))
            };
        }
        let digits = digits.replace('_', "");
        if radix == 10 && digits.starts_with('0') && digits.bytes().any(|byte| byte != b'0') {
            return Err(format!("{digits} begins with 0"));
        }
        // Beyond 64 bits it is well formed, and of no use.
        Ok(u64::from_str_radix(&digits, radix).map_or(Value::Other, Value::Int))
    }

    /// A string of any kind; one that follows another continues it.
    fn string(&mut self, prefix: &str, string_before: bool) -> Result<(), String> {
        let from = self.at - prefix.chars().count();
        let (raw, bytes) = match prefix.to_ascii_lowercase().as_str() {
            "" | "u" => (false, false),
            "r" => (true, false),
            "b" => (false, true),
            "br" | "rb" => (true, true),
            _ => return Err(format!("a string of kind {prefix}")),
        };
        let quote = self.text[self.at];
        let three = self.text[self.at..].starts_with(&[quote; 3]);
        let end = if three { &[quote; 3][..] } else { &[quote][..] };
        self.at += end.len();
        let mut string = String::new();
        loop {
            let Some(next) = self.peek() else { return Err("a string without an end".into()) };
            if self.text[self.at..].starts_with(end) {
                self.at += end.len();
                break;
            }
            self.at += 1;
            match next {
                '\n' if !three => return Err("a line break in a string".into()),
                '\\' if raw => {
                    string.push(next);
                    string.extend(self.peek());
                    self.at += 1;
                }
                '\\' => self.escape(&mut string)?,
                _ => string.push(next),
            }
        }
        let before = self.open.last_mut().and_then(|frame| frame.items.last_mut());
        if let (true, false, Some(Item { value: Value::Text(text), to, .. })) = (string_before, bytes, before)
        {
            text.push_str(&string);
            *to = self.at;
        } else {
            self.push(if bytes { Value::Other } else { Value::Text(string) }, from)?;
        }
        self.string_before = !bytes;
        Ok(())
    }

    /// What stands behind a backslash.
    fn escape(&mut self, string: &mut String) -> Result<(), String> {
        let Some(next) = self.peek() else { return Err("a string without an end".into()) };
        self.at += 1;
        let digits = match next {
            'x' => 2,
            'u' => 4,
            'U' => 8,
            '0'..='7' => {
                self.at -= 1;
                let run = self.text[self.at..].iter().take(3).take_while(|digit| digit.is_digit(8));
                let octal: String = run.collect();
                self.at += octal.len();
                string.extend(u32::from_str_radix(&octal, 8).ok().and_then(char::from_u32));
                return Ok(());
            }
            '\n' => return Ok(()),
            _ => {
                const NAMED: [(char, char); 10] = [
                    ('\\', '\\'),
                    ('\'', '\''),
                    ('"', '"'),
                    ('a', '\x07'),
                    ('b', '\x08'),
                    ('f', '\x0c'),
                    ('n', '\n'),
                    ('r', '\r'),
                    ('t', '\t'),
                    ('v', '\x0b'),
                ];
                match NAMED.iter().find(|(name, _)| *name == next) {
                    Some((_, meant)) => string.push(*meant),
                    None if next == 'N' => return Err("a character by its name".into()),
                    None => string.extend(['\\', next]),
                }
                return Ok(());
            }
        };
        let code: String = self.text[self.at..].iter().take(digits).collect();
        let found = if code.chars().all(|digit| digit.is_ascii_hexdigit()) && code.len() == digits {
            u32::from_str_radix(&code, 16).ok().and_then(char::from_u32)
        } else {
            None
        };
        string.push(found.ok_or_else(|| format!("\\{next}{code} is no character"))?);
        self.at += digits;
        Ok(())
    }

    /// The text from here to where the parser is.
    fn quote(&self, from: usize) -> String {
        self.text[from..self.at.max(from + 1).min(self.text.len())].iter().take(40).collect()
    }
}

/// Letters of Python names; any that is not ASCII is none of its constants anyway.
fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}
