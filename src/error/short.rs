//! Numbers in messages: as many digits as say something.

use std::fmt::{Display, Formatter, Result};

/// Displays a number by at most six significant digits, whole numbers of up to ten digits in full.
///
/// What rounding would make rounder than it is keeps its rest, so that a number just beyond a limit does not
/// look as if it were the limit.
///
/// ```
/// use fsot::config::Short;
///
/// let numbers = [0.1 + 0.2 + 0.05, 1e300 / 3.0, 2_147_483_648.0, 1.0 + 1e-9];
/// let words = numbers.map(|number| Short::from(number).to_string());
/// assert_eq!(words, ["0.35", "3.33333e299", "2147483648", "1 + 1e-9"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Short(f64);

impl From<f64> for Short {
    fn from(value: f64) -> Self {
        Self(value)
    }
}

impl From<&f64> for Short {
    fn from(value: &f64) -> Self {
        Self(*value)
    }
}

impl From<&f32> for Short {
    /// The number that is written like this one: 0.1 and not 0.10000000149.
    fn from(value: &f32) -> Self {
        Self(value.to_string().parse().unwrap_or(f64::NAN))
    }
}

/// Whole numbers below are written in full: most are counts.
const COUNTS: f64 = 1e10;

impl Display for Short {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        let Self(value) = *self;
        if !value.is_finite() || value.fract() == 0.0 && value.abs() < COUNTS {
            return write!(out, "{value}");
        }
        let shortest = format!("{value:e}");
        let written = if digits(&shortest).1 <= MOST { shortest } else { format!("{value:.*e}", MOST - 1) };
        let rounded: f64 = written.parse().unwrap_or(value);
        let (mantissa, count) = digits(&written);
        match written.rsplit_once('e').map(|(_, exponent)| (exponent, exponent.parse())) {
            Some((exponent, Ok(..-5 | 10..))) => write!(out, "{mantissa}e{exponent}")?,
            _ => write!(out, "{rounded}")?,
        }
        let rest = value - rounded;
        if count <= ROUND && rest != 0.0 && rest.is_finite() {
            let (sign, rest) = (if rest < 0.0 { '-' } else { '+' }, format!("{:.1e}", rest.abs()));
            write!(out, " {sign} {}", rest.replace(".0e", "e"))?;
        }
        Ok(())
    }
}

/// The digits before the exponent, without zeros at their end, and how many they are.
fn digits(scientific: &str) -> (&str, usize) {
    let mantissa = scientific.split('e').next().unwrap_or_default();
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
    (mantissa, mantissa.chars().filter(char::is_ascii_digit).count())
}

/// Most significant digits.
const MOST: usize = 6;
/// Digits of a number that looks as if it were a limit.
const ROUND: usize = 1;

/// Displays a list of numbers, each [`Short`], and of a long one its first four.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShortList<'a>(pub &'a [f64]);

impl Display for ShortList<'_> {
    fn fmt(&self, out: &mut Formatter<'_>) -> Result {
        const SHOWN: usize = 4;
        let shown: Vec<String> = self.0.iter().take(SHOWN).map(|x| Short::from(x).to_string()).collect();
        match self.0.len() {
            ..=SHOWN => write!(out, "[{}]", shown.join(", ")),
            len => write!(out, "[{}, … {len} in all]", shown.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_long_as_they_need_be() {
        for (value, words) in [
            (0.0, "0"),
            (-0.5, "-0.5"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
            (1e6, "1000000"),
            (1e10, "1e10"),
            (f64::MAX, "1.79769e308"),
            (5e-324, "5e-324"),
            (-1.0 / 3.0, "-0.333333"),
            (1e-5 / 3.0, "3.33333e-6"),
            (12345.678, "12345.7"),
            (123456.78, "123457"),
            (1e6 + 0.5, "1000000 + 5e-1"),
            (1.0 - f64::EPSILON / 2.0, "1 - 1.1e-16"),
        ] {
            assert_eq!(Short::from(value).to_string(), words);
        }
        assert_eq!(Short::from(&0.1_f32).to_string(), "0.1");
        assert_eq!(Short::from(&(1.0 / 3.0_f32)).to_string(), "0.333333");
    }

    #[test]
    fn long_lists_are_cut_short() {
        assert_eq!(ShortList(&[0.5, 1.0 / 3.0]).to_string(), "[0.5, 0.333333]");
        assert_eq!(ShortList(&[0.0; 64]).to_string(), "[0, 0, 0, 0, … 64 in all]");
    }
}
