//! Numbers as C, C++ and shading languages write them.

use super::super::text;

/// The number that this word is: whole in bases 2, 8, 10 and 16, or a fraction in base 10 or 16, with any
/// suffix of its kind.
pub(super) fn parse(word: &[u8]) -> Option<f64> {
    // Separators of C++14 and C23.
    let mut bytes = [0; 64];
    let mut length = 0;
    for &byte in word.iter().filter(|byte| **byte != b'\'') {
        *bytes.get_mut(length)? = byte;
        length += 1;
    }
    let word = str::from_utf8(&bytes[..length]).ok()?;
    if let Some(digits) = word.strip_prefix("0x").or_else(|| word.strip_prefix("0X")) {
        return match digits.contains(['p', 'P', '.']) {
            true => fraction_in_16(digits),
            false => in_base(digits, 16),
        };
    }
    if let Some(digits) = word.strip_prefix("0b").or_else(|| word.strip_prefix("0B")) {
        return in_base(digits, 2);
    }
    let whole = without_suffix(word);
    if whole.bytes().all(|byte| byte.is_ascii_digit()) {
        let is_octal = whole.len() > 1 && whole.starts_with('0');
        return in_base(word, if is_octal { 8 } else { 10 });
    }
    text::nearest(word.strip_suffix(['f', 'F', 'l', 'L', 'h', 'H']).unwrap_or(word))
}

/// A whole number in base 10.
pub(super) fn whole(word: &[u8]) -> Option<u64> {
    without_suffix(str::from_utf8(word).ok()?).parse().ok()
}

fn without_suffix(word: &str) -> &str {
    word.trim_end_matches(['u', 'U', 'l', 'L'])
}

fn in_base(word: &str, base: u32) -> Option<f64> {
    let digits = without_suffix(word);
    // That would be no C, and a sign is no digit.
    if word.len() - digits.len() > 3 || digits.starts_with('+') {
        return None;
    }
    Some(u64::from_str_radix(digits, base).ok()? as f64)
}

/// `1.8p-3`, of at most 53 bits.
fn fraction_in_16(word: &str) -> Option<f64> {
    let (digits, exponent) = word.split_once(['p', 'P'])?;
    let exponent: i32 = exponent.strip_suffix(['f', 'F', 'l', 'L']).unwrap_or(exponent).parse().ok()?;
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    if digits.starts_with('+') || part.starts_with('+') || whole.is_empty() && part.is_empty() {
        return None;
    }
    let hex = |digits: &str| if digits.is_empty() { Some(0) } else { u64::from_str_radix(digits, 16).ok() };
    let [high, low] = [hex(whole)?, hex(part)?];
    if part.len() > 13 || high >= 1 << (53 - 4 * part.len()).min(53) {
        return None;
    }
    let bits = high << (4 * part.len()) | low;
    // Beyond these every number is 0 or infinite.
    let exponent = exponent.clamp(-1200, 1200) - 4 * part.len() as i32;
    // In two steps, because the power alone may be out of range.
    Some(bits as f64 * 2.0_f64.powi(exponent / 2) * 2.0_f64.powi(exponent - exponent / 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_those_of_c() {
        for (word, value) in [
            ("0", 0.0),
            ("0u", 0.0),
            ("65535U", 65535.0),
            ("7ull", 7.0),
            ("017", 15.0),
            ("0x1F", 31.0),
            ("0XffffUL", 65535.0),
            ("0b101", 5.0),
            ("1'000'000", 1e6),
            ("0.5", 0.5),
            (".5f", 0.5),
            ("5e-1F", 0.5),
            ("1.", 1.0),
            ("0.25h", 0.25),
            ("010.5", 10.5),
            ("0x1p-1f", 0.5),
            ("0x1.8p-3", 0.1875),
            ("0x.8p0", 0.5),
            ("0x1.fffffep-1f", f64::from(1.0_f32.next_down())),
            ("0x1p-1074", 5e-324),
            ("18446744073709551615", 2.0_f64.powi(64)),
        ] {
            assert_eq!(parse(word.as_bytes()), Some(value), "{word}");
        }
        for word in [
            "",
            ".",
            "08",
            "1f2",
            "0x",
            "0xg",
            "1.2.3",
            "0x1.8",
            "0xp1",
            "1e",
            "1u1",
            "1uuuu",
            "0b2",
            "1_f",
            "18446744073709551616",
            "0x1.00000000000001p0",
            "0x1p99999999999",
            "0x1p",
            "1.5u",
        ] {
            assert_eq!(parse(word.as_bytes()), None, "{word}");
        }
        assert_eq!(parse(&[b'1'; 65]), None);
    }
}
