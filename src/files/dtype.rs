//! Types of numbers in a `.npy` file, by the names that numpy gives them.

use std::fmt;
use std::str::FromStr;

use half::f16;

/// What a number is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Bool,
    Unsigned,
    Signed,
    Float,
}

/// A type of numbers that is read, of 8 to 64 bits, by the name that numpy gives it: `<f4`, `>u2`, `u1`.
///
/// ```
/// use fsot::files::Dtype;
///
/// let little: Dtype = "<u2".parse()?;
/// assert_eq!(little.to_string(), "<u2");
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dtype {
    pub(super) kind: Kind,
    /// Bytes of a number: 1, 2, 4 or 8.
    pub(super) size: usize,
    big_endian: bool,
}

impl Dtype {
    /// Little-endian `f32`, which is what tables are.
    pub(super) const TABLE: Self = Self { kind: Kind::Float, size: 4, big_endian: false };
    /// The others that an export writes.
    pub(super) const HALF: Self = Self { kind: Kind::Float, size: 2, big_endian: false };
    pub(super) const U8: Self = Self { kind: Kind::Unsigned, size: 1, big_endian: false };
    pub(super) const U16: Self = Self { kind: Kind::Unsigned, size: 2, big_endian: false };

    /// The type of this name; `None` if there is none, or if it is no plain number of at most 64 bits.
    pub(super) fn named(name: &str) -> Option<Self> {
        let (order, code) = match name.chars().next() {
            Some(order @ ('<' | '>' | '=' | '|')) => (order, &name[1..]),
            _ => ('=', name),
        };
        let (kind, size) = match code {
            "?" | "b1" => (Kind::Bool, 1),
            "b" | "i1" => (Kind::Signed, 1),
            "h" | "i2" => (Kind::Signed, 2),
            "i" | "i4" => (Kind::Signed, 4),
            "q" | "i8" => (Kind::Signed, 8),
            "B" | "u1" => (Kind::Unsigned, 1),
            "H" | "u2" => (Kind::Unsigned, 2),
            "I" | "u4" => (Kind::Unsigned, 4),
            "Q" | "u8" => (Kind::Unsigned, 8),
            "e" | "f2" => (Kind::Float, 2),
            "f" | "f4" => (Kind::Float, 4),
            "d" | "f8" => (Kind::Float, 8),
            // Words have no byte order.
            _ if code.len() != name.len() => return None,
            "bool" => (Kind::Bool, 1),
            "int8" | "byte" => (Kind::Signed, 1),
            "int16" | "short" => (Kind::Signed, 2),
            "int32" => (Kind::Signed, 4),
            "int64" | "longlong" => (Kind::Signed, 8),
            "uint8" | "ubyte" => (Kind::Unsigned, 1),
            "uint16" | "ushort" => (Kind::Unsigned, 2),
            "uint32" => (Kind::Unsigned, 4),
            "uint64" | "ulonglong" => (Kind::Unsigned, 8),
            "float16" | "half" => (Kind::Float, 2),
            "float32" | "single" => (Kind::Float, 4),
            "float64" | "double" | "float" => (Kind::Float, 8),
            _ => return None,
        };
        let big_endian = match order {
            '<' => false,
            '>' => true,
            _ => cfg!(target_endian = "big"),
        };
        // A single byte has no order.
        Some(Self { kind, size, big_endian: big_endian && size > 1 })
    }

    /// The number in these `size` bytes; whole numbers beyond 2⁵³ are rounded.
    pub(super) fn decode(self, bytes: &[u8]) -> f64 {
        let mut little = [0; 8];
        for (i, &byte) in bytes.iter().enumerate() {
            little[if self.big_endian { self.size - 1 - i } else { i }] = byte;
        }
        let bits = u64::from_le_bytes(little);
        match (self.kind, self.size) {
            (Kind::Bool, _) => f64::from(u8::from(bits != 0)),
            (Kind::Unsigned, _) => bits as f64,
            (Kind::Signed, size) => {
                let unused = 64 - 8 * size as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
            (Kind::Float, 2) => f16::from_bits(bits as u16).to_f64(),
            (Kind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
            (Kind::Float, _) => f64::from_bits(bits),
        }
    }
}

impl fmt::Display for Dtype {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let order = if self.size == 1 {
            '|'
        } else if self.big_endian {
            '>'
        } else {
            '<'
        };
        let kind = ['b', 'u', 'i', 'f'][self.kind as usize];
        write!(out, "{order}{kind}{}", self.size)
    }
}

impl FromStr for Dtype {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::named(text).ok_or_else(|| {
            format!("'{text}' is no type of numbers: write <f4, <f2, <u2, u1 or another as numpy names them")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_become_numbers() {
        for (name, bytes, number) in [
            ("<f4", &[0, 0, 0x40, 0x3f][..], 0.75),
            (">f4", &[0x3f, 0x40, 0, 0], 0.75),
            ("<f2", &[0, 0x3a], 0.75),
            (">f8", &[0x3f, 0xe8, 0, 0, 0, 0, 0, 0], 0.75),
            ("|u1", &[200], 200.0),
            (">u1", &[200], 200.0),
            ("|i1", &[200], -56.0),
            ("<u2", &[1, 2], 513.0),
            (">u2", &[1, 2], 258.0),
            (">i4", &[0xff, 0xff, 0xff, 0xfe], -2.0),
            ("<i8", &[0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff], -2.0),
            ("<u8", &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff], 2.0_f64.powi(64)),
            ("|b1", &[7], 1.0),
        ] {
            let dtype = Dtype::named(name).unwrap();
            assert_eq!((dtype.size, dtype.decode(bytes)), (bytes.len(), number), "{name}");
        }
    }

    #[test]
    fn names_are_numpys() {
        let native = if cfg!(target_endian = "big") { ">f4" } else { "<f4" };
        for name in ["f4", "=f4", "|f4", "f", "single", "float32"] {
            assert_eq!(Dtype::named(name), Dtype::named(native), "{name}");
        }
        for name in ["", "<", "f3", "<f", "<float32", "F4", " <f4", "<f4 ", "<c8", "|O", "<f16", "<U1", "V4"]
        {
            assert_eq!(Dtype::named(name).is_some(), name == "<f", "{name}");
        }
    }
}
