//! Linear light as screens want it.

/// The 8-bit sRGB value (IEC 61966-2-1) of linear light; what lies outside of `[0, 1]` is clamped.
pub fn srgb(linear: f64) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let curved = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (curved * 255.0).round() as u8
}
