//! From the numbers of a file to linear light.

/// The light of an sRGB value in `[0, 1]` (IEC 61966-2-1).
pub(super) fn srgb(value: f32) -> f32 {
    match value {
        ..=0.04045 => value / 12.92,
        _ => ((value + 0.055) / 1.055).powf(2.4),
    }
}

/// The light that a camera had before the curve of BT.709, BT.601 and BT.2020.
fn bt709(value: f32) -> f32 {
    match value {
        ..0.081_242_86 => value / 4.5,
        _ => ((value + 0.099_296_83) / 1.099_296_8).powf(1.0 / 0.45),
    }
}

/// The light of a PQ value (SMPTE ST 2084) over that of white paper, 203 cd/m² (ITU-R BT.2408).
fn pq(value: f32) -> f32 {
    const PAPER: f64 = 203.0;
    const M1: f64 = 2610.0 / 16384.0;
    const M2: f64 = 2523.0 / 4096.0 * 128.0;
    const C1: f64 = 3424.0 / 4096.0;
    const C2: f64 = 2413.0 / 4096.0 * 32.0;
    const C3: f64 = 2392.0 / 4096.0 * 32.0;
    let root = f64::from(value).powf(1.0 / M2);
    let light = ((root - C1).max(0.0) / (C2 - C3 * root)).powf(1.0 / M1);
    (10000.0 / PAPER * light) as f32
}

/// The curve that a code point of ITU-T H.273, table 3, stands for.
pub(super) fn of_code_point(code: u8) -> Option<fn(f32) -> f32> {
    Some(match code {
        1 | 6 | 14 | 15 => bt709,
        4 => |value| value.powf(2.2),
        5 => |value| value.powf(2.8),
        8 => |value| value,
        13 => srgb,
        16 => pq,
        17 => |value| value.powf(2.6) * (52.37 / 48.0),
        _ => return None,
    })
}

/// The curve of `gAMA`: the power that a light was raised to.
pub(super) fn of_gamma(gamma: f32) -> Option<Box<dyn Fn(f32) -> f32>> {
    /// Beyond is no picture of anything.
    const PLAUSIBLE: std::ops::RangeInclusive<f32> = 0.1..=10.0;
    match gamma {
        // What software writes beside the chunk `sRGB`, and leaves where others drop that.
        _ if (2.2 * gamma - 1.0).abs() <= 0.02 => Some(Box::new(srgb)),
        1.0 => Some(Box::new(|value| value)),
        _ if PLAUSIBLE.contains(&gamma) => Some(Box::new(move |value| value.powf(gamma.recip()))),
        _ => None,
    }
}
