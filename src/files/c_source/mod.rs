//! Arrays of numbers in C and C++ sources: `name[48][128][128] = {{{1, 2, …`, with comments, nested or flat.
//!
//! One pass without recursion. Expressions are not evaluated, and both sides of an `#if` are read.

mod lexer;
mod list;
mod number;

use std::fs::File;
use std::io::{BufRead, BufReader};

use self::lexer::{Lexer, Token};
use self::list::List;
use super::dtype::Dtype;
use super::header::shortened;
use super::text::Unread;
use crate::error::ImportError;

/// Endings of macros that say the lengths of an array's axes, and how many levels its numbers have.
pub(super) const MACROS: [&str; 6] = ["_FRAMES", "_HEIGHT", "_WIDTH", "_SPP", "_DIMS", "_LEVELS"];

/// Deepest braces, and longest declarations, that are understood.
const DEEPEST: usize = 16;

/// Names of arrays that a message has.
const MOST_NAMES: usize = 4;

/// The numbers of an array.
#[derive(Debug, PartialEq)]
pub(super) struct Array {
    pub(super) name: String,
    /// The type as it is written, without `static` and the like.
    pub(super) descr: String,
    pub(super) dtype: Option<Dtype>,
    pub(super) values: Vec<f64>,
    /// Lengths of nested braces, or of the declaration where braces are not nested.
    pub(super) shape: Vec<usize>,
    /// What macros beginning with `FSOT_` say, by their ending.
    pub(super) macros: Vec<(&'static str, u64)>,
}

/// Reads the array of this name, or the only one.
pub(super) fn read(file: File, wanted: Option<&str>) -> Result<Array, Unread> {
    read_from(BufReader::with_capacity(1 << 16, file), wanted)
}

fn read_from(input: impl BufRead, wanted: Option<&str>) -> Result<Array, Unread> {
    let mut lexer = Lexer::new(input);
    let mut declared = Declared::default();
    let mut found: Option<Array> = None;
    let (mut names, mut count) = (Vec::new(), 0_usize);
    loop {
        match lexer.next()? {
            Token::End => break,
            Token::Mark(b'{') if declared.begins_array() => {
                let name = declared.name();
                count += 1;
                if found.is_none() && wanted.is_none_or(|wanted| wanted == name) {
                    found = Some(declared.array(List::default().read(&mut lexer)?));
                } else {
                    skip(&mut lexer)?;
                }
                if names.len() < MOST_NAMES {
                    names.push(name);
                }
                declared = Declared::after_array();
            }
            token => declared.take(token, &lexer.word),
        }
    }
    let mut names = names.join(", ");
    if count > MOST_NAMES {
        names = format!("{names} and {} more", count - MOST_NAMES);
    }
    match found {
        Some(_) if wanted.is_none() && count > 1 => Err(ImportError::Arrays { names }.into()),
        Some(array) if array.values.is_empty() => Err(ImportError::Empty.into()),
        Some(array) => Ok(Array { macros: lexer.macros, ..array }),
        None if count == 0 => Err(ImportError::NoArray.into()),
        None => {
            Err(ImportError::NoSuchArray { name: shortened(wanted.unwrap_or_default().into()), names }.into())
        }
    }
}

/// Passes over an array whose first brace has been read.
fn skip(lexer: &mut Lexer<impl BufRead>) -> Result<(), Unread> {
    let mut depth = 1_usize;
    while depth > 0 {
        match lexer.next()? {
            Token::Mark(b'{') => depth += 1,
            Token::Mark(b'}') => depth -= 1,
            Token::End => return Err(ImportError::Unclosed.into()),
            _ => {}
        }
    }
    Ok(())
}

/// What has been read of a declaration.
#[derive(Default)]
struct Declared {
    /// Words before the first bracket.
    words: Vec<Vec<u8>>,
    /// Lengths between brackets, where they are plain numbers.
    lengths: Vec<Option<usize>>,
    in_bracket: bool,
    last: Option<Token>,
    is_assigned: bool,
    /// Something has been read before.
    begun: bool,
}

impl Declared {
    fn after_array() -> Self {
        Self { begun: true, ..Self::default() }
    }

    /// Whether a brace that stands here begins an array: behind `=`, behind `]`, or at the very beginning.
    fn begins_array(&self) -> bool {
        match self.last {
            Some(Token::Mark(b'=')) => true,
            Some(Token::Mark(b']')) => !self.is_assigned && !self.words.is_empty(),
            last => last.is_none() && !self.begun,
        }
    }

    fn name(&self) -> String {
        self.words.last().map(|name| String::from_utf8_lossy(name).into_owned()).unwrap_or_default()
    }

    fn take(&mut self, token: Token, word: &[u8]) {
        self.begun = true;
        match token {
            Token::Mark(b'[') if !self.is_assigned => {
                self.in_bracket = true;
                if self.lengths.len() < DEEPEST {
                    self.lengths.push(None);
                }
            }
            Token::Mark(b']') => self.in_bracket = false,
            Token::Number if self.in_bracket => {
                let length = number::whole(word).and_then(|length| usize::try_from(length).ok());
                // A length that more stands before or behind of is none.
                let is_alone = self.last == Some(Token::Mark(b'['));
                if let Some(last) = self.lengths.last_mut() {
                    *last = length.filter(|_| is_alone);
                }
            }
            _ if self.in_bracket => {
                if let Some(last) = self.lengths.last_mut() {
                    *last = None;
                }
            }
            Token::Word if !self.is_assigned && self.lengths.is_empty() => {
                // The last ones count: the type and the name.
                if self.words.len() == DEEPEST {
                    self.words.remove(0);
                }
                self.words.push(word.to_vec());
            }
            Token::Mark(b'=') => self.is_assigned = true,
            Token::Mark(b';' | b'{' | b'}' | b'(' | b')') => *self = Self::after_array(),
            _ => {}
        }
        self.last = Some(token);
    }

    /// The type among the words before the name.
    fn dtype(&self) -> (String, Option<Dtype>) {
        const MODIFIERS: [&str; 8] =
            ["static", "const", "constexpr", "inline", "extern", "constant", "volatile", "groupshared"];
        let words = &self.words[..self.words.len().saturating_sub(1)];
        let words: Vec<&str> = words.iter().filter_map(|word| str::from_utf8(word).ok()).collect();
        let is_unsigned = words.contains(&"unsigned");
        let is_type = |word: &&str| !MODIFIERS.contains(word);
        let dtype = words.iter().rev().find_map(|word| {
            Some(match *word {
                "float" | "float32_t" => "<f4",
                "double" => "<f8",
                "half" | "_Float16" | "float16_t" => "<f2",
                "uint8_t" | "uchar" | "byte" => "|u1",
                "uint16_t" | "ushort" => "<u2",
                "uint32_t" | "uint" => "<u4",
                "uint64_t" | "ulong" => "<u8",
                "char" | "int8_t" => {
                    if is_unsigned {
                        "|u1"
                    } else {
                        "|i1"
                    }
                }
                "short" | "int16_t" => {
                    if is_unsigned {
                        "<u2"
                    } else {
                        "<i2"
                    }
                }
                "int" | "int32_t" | "int64_t" if !is_unsigned => "<i8",
                _ => return None,
            })
        });
        let dtype = dtype.or(is_unsigned.then_some("<u4"));
        let descr = words.iter().filter(|word| is_type(word)).copied().collect::<Vec<_>>().join(" ");
        (shortened(descr), dtype.and_then(Dtype::named))
    }

    fn array(&self, list: List) -> Array {
        let nested = list.shape();
        let lengths: Option<Vec<usize>> = self.lengths.iter().copied().collect();
        let product = |lengths: &[usize]| lengths.iter().try_fold(1, |all: usize, one| all.checked_mul(*one));
        let shape = match lengths {
            Some(lengths) if nested.len() == 1 && product(&lengths) == Some(list.values.len()) => lengths,
            // A `std::array` needs a brace more for each of its axes.
            _ if self.lengths.is_empty() && nested.len() > 1 => {
                nested.into_iter().filter(|length| *length != 1).collect()
            }
            _ => nested,
        };
        let (descr, dtype) = self.dtype();
        Array { name: self.name(), descr, dtype, values: list.values, shape, macros: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str, wanted: Option<&str>) -> Result<Array, ImportError> {
        read_from(text.as_bytes(), wanted).map_err(|unread| match unread {
            Unread::Import(problem) => problem,
            Unread::Io(error) => panic!("{error}"),
        })
    }

    fn numbers(text: &str) -> (Vec<usize>, Vec<f64>) {
        let Array { shape, values, .. } = all(text, None).unwrap_or_else(|problem| panic!("{problem}"));
        (shape, values)
    }

    fn refusal(text: &str) -> ImportError {
        all(text, None).unwrap_err()
    }

    #[test]
    fn arrays_are_found_and_their_lists_are_axes() {
        for (text, shape) in [
            ("int a[] = {1, 2, 3, 4, 5, 6};", &[6][..]),
            ("int a[6] = {1, 2, 3, 4, 5, 6,};", &[6]),
            ("int a[2][3] = {1, 2, 3, 4, 5, 6};", &[2, 3]),
            ("int a[2][3] = {{1, 2, 3}, {4, 5, 6,},};", &[2, 3]),
            ("int a[N][M] = {{1, 2, 3}, {4, 5, 6}};", &[2, 3]),
            ("int a[N * 3] = {1, 2, 3, 4, 5, 6};", &[6]),
            ("int a[2 * 3] = {1, 2, 3, 4, 5, 6};", &[6]),
            ("int a[6]{1, 2, 3, 4, 5, 6};", &[6]),
            ("struct pair a[3] = {{1, 2}, {3, 4}, {5, 6}};", &[3, 2]),
            ("std::array<std::array<int, 3>, 2> a = {{ {{1, 2, 3}}, {{4, 5, 6}} }};", &[2, 3]),
            (
                "namespace n { extern \"C\" { const int a[] = {1,2,3,4,5,6}; } } void f(int x) { x = 1; }",
                &[6],
            ),
            ("enum { A, B }; struct s { int b[4]; }; int a[6] = {1,2,3,4,5,6};", &[6]),
            ("auto f = [] { return 1; }; int a[6] = {1,2,3,4,5,6};", &[6]),
            (
                "#include \"{1}\"\n#define X \\\n = {7}\nint a[] /* = {8} */ = // {9}\n{1,2,/*,*/3,4,5,6};",
                &[6],
            ),
            ("const char *s = \"int b[] = {1};\\\" {\"; char c = '{'; int a[] = {1,2,3,4,5,6};", &[6]),
            ("{1, 2, 3, 4, 5, 6}", &[6]),
            ("{{1, 2, 3}, {4, 5, 6}}", &[2, 3]),
        ] {
            assert_eq!(numbers(text), (shape.to_vec(), vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), "{text}");
        }
        assert_eq!(numbers("a[] = {-1, + .5f, 0x10}").1, [-1.0, 0.5, 16.0]);
    }

    #[test]
    fn types_names_and_macros_are_read() {
        for (declaration, descr, dtype) in [
            ("static const float a", "float", Some("<f4")),
            ("const unsigned char a", "unsigned char", Some("|u1")),
            ("const static unsigned short int a", "unsigned short int", Some("<u2")),
            ("extern PBRT_CONST uint16_t a", "PBRT_CONST uint16_t", Some("<u2")),
            ("unsigned a", "unsigned", Some("<u4")),
            ("short a", "short", Some("<i2")),
            ("a", "", None),
        ] {
            let array = all(&format!("{declaration}[1] = {{1}};"), None).unwrap();
            let found = (array.name.as_str(), array.descr.as_str(), array.dtype);
            assert_eq!(found, ("a", descr, dtype.and_then(Dtype::named)), "{declaration}");
        }
        // Behind other lines, and no directive within one.
        let text = "int b;\n  #define FSOT_A_SPP 5 \\\n\nint a[] /* #define FSOT_A_DIMS 7 */ = {1};\n\
                    x # define FSOT_A_WIDTH 7\n";
        assert_eq!(all(text, None).unwrap().macros, [("_SPP", 5)]);
        let text = "#define FSOT_A_FRAMES 3\n# define FSOT_A_LEVELS 256u // so many\n#define FSOT_B_SPP (2)\n\
                    #define OTHER_DIMS 7\n#define FSOT_A_FRAMES 4\nint a[] = {1};\n";
        assert_eq!(all(text, None).unwrap().macros, [("_FRAMES", 3), ("_LEVELS", 256)]);
    }

    #[test]
    fn one_of_several_is_chosen_by_its_name() {
        let text = "int a[] = {1}; int b[2][2] = {{2, x}, {}}; int c[] = {3}; int d[] = {4}; int e[] = {5};";
        assert_eq!(refusal(text), ImportError::Arrays { names: "a, b, c, d and 1 more".into() });
        assert_eq!(all(text, Some("e")).unwrap().values, [5.0]);
        let problem = all("int a[] = {1};", Some("x")).unwrap_err();
        assert_eq!(problem, ImportError::NoSuchArray { name: "x".into(), names: "a".into() });
    }

    #[test]
    fn what_is_no_array_of_numbers_is_located() {
        let number = |line, text: &str| ImportError::Literal { line, text: text.into() };
        for (text, problem) in [
            ("int a[] = {1, b};", number(1, "b")),
            ("int a[] = {1,\n2 3};", number(2, "3")),
            ("int a[] = {1,,2};", number(1, ",")),
            ("int a[] = {(int)1};", number(1, "(")),
            ("int a[] = {[3] = 1};", number(1, "[")),
            ("int a[] = {- {1}};", number(1, "{")),
            ("char a[] = {'x'};", number(1, "'")),
            ("char a[] = {\"x\"};", number(1, "\"")),
            ("int a[] = {/* \n\n */ 09};", number(3, "09")),
            ("int a[] = {{1, 2}, {3}};", ImportError::Lists { line: 1, given: 1, expected: 2 }),
            ("int a[] = {{1, 2},\n{}};", ImportError::Lists { line: 2, given: 0, expected: 2 }),
            ("int a[] = {1, {2}};", ImportError::Nesting { line: 1 }),
            ("int a[] = {{1}, 2};", ImportError::Nesting { line: 1 }),
            ("int a[] = {1, 2", ImportError::Unclosed),
            ("int a[] = {1, /* 2};", ImportError::Unclosed),
            ("int a[] = {1}; int b[] = {2", ImportError::Unclosed),
            ("int a[] = {};", ImportError::Empty),
            ("int a[] = {{}, {}};", ImportError::Empty),
            ("int a;", ImportError::NoArray),
            ("", ImportError::NoArray),
        ] {
            assert_eq!(refusal(text), problem, "{text}");
        }
        assert_eq!(refusal(&format!("int a[] = {}", "{".repeat(100_000))), ImportError::Nesting { line: 1 });
        let long = "1".repeat(100_000);
        let ImportError::Literal { text, .. } = refusal(&format!("int a[] = {{{long}}}")) else { panic!() };
        assert!(text.len() < 80, "{text}");
    }
}
