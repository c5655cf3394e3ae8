//! Taps, and what kernels in space and in time share.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::error::{KernelError, RangeError};

/// One lattice offset of a kernel and its weight relative to the largest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tap {
    /// Frames forward, so at most 0: the filter looks back.
    pub dt: i32,
    /// Rows down.
    pub dy: i32,
    /// Columns right.
    pub dx: i32,
    /// Weight in `(0, 1]`; the largest is 1.
    pub weight: f64,
}

/// Relative weight below which even an untruncated kernel ends.
pub(super) const NEGLIGIBLE: f64 = 1e-12;

/// A parameter that lies outside its range.
pub(super) fn range(name: &'static str, value: f64, expected: &'static str) -> KernelError {
    RangeError::new(name, value, expected).into()
}

/// Right half `exp(-k² / sigma²)`, `k = 0, 1, …`, down to [`NEGLIGIBLE`].
pub(super) fn gaussian(name: &'static str, sigma: f64) -> Result<Vec<f64>, KernelError> {
    if !(sigma > 0.0 && sigma <= 1e6) {
        return Err(range(name, sigma, "above 0, at most 1e6"));
    }
    let weight = |k: u32| (-(f64::from(k) / sigma).powi(2)).exp();
    Ok((0..).map(weight).take_while(|&weight| weight > NEGLIGIBLE).collect())
}

/// Binomial coefficients `C(size - 1, k)` relative to the largest.
pub(super) fn binomial(name: &'static str, size: usize) -> Result<Vec<f64>, KernelError> {
    if !(1..=1000).contains(&size) {
        return Err(range(name, size as f64, "from 1 to 1000"));
    }
    let ratio = |k: usize| (size - k) as f64 / k as f64;
    let mut taps = vec![1.0];
    for k in 1..size {
        taps.push(taps[k - 1] * ratio(k));
    }
    // At most C(999, 499) ≈ 1e300, still finite.
    let largest = taps.iter().copied().fold(0.0, f64::max);
    Ok(taps.into_iter().map(|tap| tap / largest).collect())
}

pub(super) fn checked_size(name: &'static str, size: usize) -> Result<usize, KernelError> {
    if (1..=1_000_000).contains(&size) {
        Ok(size)
    } else {
        Err(range(name, size as f64, "from 1 to 1000000"))
    }
}

pub(super) fn check_taps(
    kernel: &'static str,
    weights: impl Iterator<Item = f64> + Clone,
) -> Result<(), KernelError> {
    for (index, weight) in weights.clone().enumerate() {
        if !(weight.is_finite() && weight >= 0.0) {
            return Err(KernelError::BadTap { kernel, index, weight });
        }
    }
    if !weights.clone().sum::<f64>().is_finite() {
        return Err(range("the sum of a kernel's weights", f64::INFINITY, "that is finite"));
    }
    if !weights.into_iter().any(|weight| weight > 0.0) {
        return Err(KernelError::Empty { kernel });
    }
    Ok(())
}

/// The offset on an axis that wraps, in `(-len/2, len/2]`.
pub(super) fn centred(offset: i64, len: usize) -> i32 {
    let len = len as i64;
    let wrapped = offset.rem_euclid(len);
    (if 2 * wrapped > len { wrapped - len } else { wrapped }) as i32
}

/// Sums of the weights by offset on an axis that wraps; `covers` if each of them has some.
pub(super) fn fold(
    weights: impl Iterator<Item = (i64, f64)>,
    covers: bool,
    len: usize,
) -> BTreeMap<i32, f64> {
    if covers {
        // As wide as the axis or far wider.
        let mut sums = vec![0.0; len];
        weights.for_each(|(offset, weight)| sums[offset.rem_euclid(len as i64) as usize] += weight);
        return sums.into_iter().enumerate().map(|(at, sum)| (centred(at as i64, len), sum)).collect();
    }
    let mut folded = BTreeMap::new();
    weights.for_each(|(offset, weight)| *folded.entry(centred(offset, len)).or_insert(0.0) += weight);
    folded
}

pub(super) fn maximum<K>(weights: &BTreeMap<K, f64>) -> f64 {
    weights.values().copied().fold(0.0, f64::max)
}

pub(super) fn drop_below<K: Ord>(weights: &mut BTreeMap<K, f64>, share: f64) {
    let least = share * maximum(weights);
    weights.retain(|_, weight| *weight >= least);
}

/// Brings the largest weight into `[1/2, 1)`, by a power of two, so that no digit changes.
pub(super) fn to_unit<K>(weights: &mut BTreeMap<K, f64>) {
    let (_, exponent) = libm::frexp(maximum(weights));
    weights.values_mut().for_each(|weight| *weight = libm::scalbn(*weight, -exponent));
}
