//! From the numbers of a file to linear light.

/// The light of an sRGB value in `[0, 1]` (IEC 61966-2-1).
pub(super) fn srgb(value: f32) -> f32 {
    match value {
        ..=0.04045 => value / 12.92,
        _ => ((value + 0.055) / 1.055).powf(2.4),
    }
}
