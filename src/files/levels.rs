//! Which number in `[0, 1)` a value of somebody else's file stands for.

use super::dtype::{Dtype, Kind};
use crate::error::ImportError;
use crate::table::domain::BELOW_ONE;

/// How values become numbers in `[0, 1)`: `(value - first + 1/2) / levels`, or as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) levels: Option<u64>,
    /// The lowest level: 1 for ranks that are counted from 1.
    pub(super) first: u64,
}

impl Scale {
    const FRACTIONS: Self = Self { levels: None, first: 0 };

    /// The scale of these values, whose type is not known where they come from text.
    ///
    /// Fractions in `[0, 1]` are what they are. Whole numbers are levels: as many as are given; or, where
    /// each from 0 or 1 to the greatest is there equally often, so many; or all of an unsigned type of at
    /// most 32 bits, if its upper half is used.
    pub(super) fn of(values: &[f64], dtype: Option<Dtype>, given: Option<u64>) -> Result<Self, ImportError> {
        if let Some(at) = values.iter().position(|value| !value.is_finite() || *value < 0.0) {
            return Err(ImportError::Value { at, value: values[at] });
        }
        let is_whole = |value: &f64| value.fract() == 0.0;
        if let Some(levels) = given {
            let is_level = |value: &f64| is_whole(value) && *value < levels as f64;
            return match values.iter().position(|value| !is_level(value)) {
                Some(at) => Err(ImportError::NoLevel { at, value: values[at], levels }),
                None => Ok(Self { levels: Some(levels), first: 0 }),
            };
        }
        let [least, greatest] =
            values.iter().fold([f64::INFINITY, 0.0], |[low, high], &value| [value.min(low), value.max(high)]);
        let is_float = dtype.is_none_or(|dtype| dtype.kind == Kind::Float);
        if is_float && greatest <= 1.0 {
            return Ok(Self::FRACTIONS);
        }
        if !values.iter().all(is_whole) {
            let at = values.iter().position(|&value| value > 1.0).unwrap_or(0);
            return Err(ImportError::Value { at, value: values[at] });
        }
        if let Some(levels) = ranks(values, least, greatest) {
            return Ok(Self { levels: Some(levels), first: least as u64 });
        }
        match dtype {
            Some(Dtype { kind: Kind::Bool, .. }) => Ok(Self { levels: Some(2), first: 0 }),
            Some(Dtype { kind: Kind::Unsigned, size, .. })
                if size <= 4 && greatest >= 2.0_f64.powi(8 * size as i32 - 1) =>
            {
                Ok(Self { levels: Some(1 << (8 * size)), first: 0 })
            }
            _ => {
                let above = (greatest as u64).saturating_add(1).max(2);
                let suggested = above.checked_next_power_of_two().unwrap_or(u64::MAX);
                Err(ImportError::Levels { greatest, suggested })
            }
        }
    }

    /// The number that a value stands for. 1 itself, and what would be rounded to it, is the largest number
    /// below.
    pub(super) fn apply(self, value: f64) -> f32 {
        let number = match self.levels {
            None => value,
            Some(levels) => (value - self.first as f64 + 0.5) / levels as f64,
        };
        (number as f32).min(BELOW_ONE)
    }
}

/// How many ranks there are, if each from `least`, 0 or 1, to `greatest` is there equally often.
fn ranks(values: &[f64], least: f64, greatest: f64) -> Option<u64> {
    if greatest - least >= values.len() as f64 {
        return None;
    }
    let levels = (greatest - least) as usize + 1;
    if least > 1.0 || levels < 2 || levels > values.len() || !values.len().is_multiple_of(levels) {
        return None;
    }
    let most = values.len() / levels;
    let mut counts: Vec<usize> = Vec::new();
    counts.try_reserve_exact(levels).ok()?;
    counts.resize(levels, 0);
    for value in values {
        let count = &mut counts[(value - least) as usize];
        *count += 1;
        if *count > most {
            return None;
        }
    }
    Some(levels as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64], dtype: &str, given: Option<u64>) -> Result<(Option<u64>, u64), ImportError> {
        Scale::of(values, Dtype::named(dtype), given).map(|Scale { levels, first }| (levels, first))
    }

    #[test]
    fn levels_are_given_found_or_those_of_the_type() {
        assert_eq!(of(&[0.0, 0.25, 1.0], "<f8", None), Ok((None, 0)));
        assert_eq!(of(&[3.0, 0.0, 1.0, 2.0], "<i4", None), Ok((Some(4), 0)));
        assert_eq!(of(&[3.0, 4.0, 1.0, 2.0], "<f8", None), Ok((Some(4), 1)));
        assert_eq!(of(&[0.0, 1.0, 1.0, 0.0], "|u1", None), Ok((Some(2), 0)));
        assert_eq!(of(&[0.0, 1.0, 1.0], "|b1", None), Ok((Some(2), 0)));
        assert_eq!(of(&[0.0, 128.0], "|u1", None), Ok((Some(256), 0)));
        assert_eq!(of(&[7.0, 32768.0], "<u2", None), Ok((Some(65536), 0)));
        assert_eq!(of(&[7.0, 2.0_f64.powi(31)], "<u4", None), Ok((Some(1 << 32), 0)));
        assert_eq!(of(&[7.0, 9.0], "<u2", Some(10)), Ok((Some(10), 0)));
        // Ten bits in sixteen would be a table whose values are all below 1/64.
        let suggested = |greatest, suggested| Err(ImportError::Levels { greatest, suggested });
        assert_eq!(of(&[7.0, 1023.0], "<u2", None), suggested(1023.0, 1024));
        assert_eq!(of(&[0.0, 0.0], "|u1", None), suggested(0.0, 2));
        assert_eq!(of(&[1.0, 1e300], "<f8", None), suggested(1e300, u64::MAX));
        assert_eq!(of(&[7.0, 2.0_f64.powi(63)], "<u8", None), suggested(2.0_f64.powi(63), u64::MAX));
    }

    #[test]
    fn what_is_no_level_is_located() {
        let value = |at, value| Err(ImportError::Value { at, value });
        assert_eq!(of(&[0.5, -1.0], "<f8", None), value(1, -1.0));
        assert_eq!(of(&[0.5, 1.5, 7.0], "<f8", None), value(1, 1.5));
        assert_eq!(of(&[0.0, f64::INFINITY], "<f8", Some(9)), value(1, f64::INFINITY));
        for (values, levels) in [([0.0, 9.0], 9), ([0.0, 0.5], 9), ([1.0, 0.0], 0)] {
            let at = usize::from(levels != 0);
            let expected = Err(ImportError::NoLevel { at, value: values[at], levels });
            assert_eq!(of(&values, "<f8", Some(levels)), expected);
        }
    }

    #[test]
    fn one_never_appears() {
        for value in [1.0, 1.0 - 1e-12, 1.0_f64.next_down()] {
            assert_eq!(Scale::FRACTIONS.apply(value), BELOW_ONE);
        }
        for levels in [2, 256, 65536, 1 << 25, 1 << 32, u64::MAX] {
            let scale = Scale { levels: Some(levels), first: 0 };
            let last = scale.apply(levels as f64 - 1.0);
            assert!(last > 0.5 && last <= BELOW_ONE, "{levels}: {last}");
        }
        assert_eq!(Scale { levels: Some(4), first: 1 }.apply(1.0), 0.125);
    }
}
