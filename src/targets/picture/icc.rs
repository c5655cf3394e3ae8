//! ICC profiles, as far as they are curves and a matrix.

use moxcms::{ColorProfile, DataColorSpace, ToneReprCurve};

use super::primaries::{ColorMatrix, from_d50};
use super::transfer::srgb;

/// A curve from numbers of a file to light.
pub(super) type Curve = Box<dyn Fn(f32) -> f32>;

/// Curves of red, green and blue, and what becomes of their light.
pub(super) struct Profile {
    pub curves: [Curve; 3],
    pub matrix: Option<ColorMatrix>,
}

/// Curves that differ less are read as the same: half a step of 9 bits.
const NOTHING: f32 = 0.001;

/// Reads a profile, or says what stands against it.
pub(super) fn read(profile: &[u8], is_grey: bool) -> Result<Profile, String> {
    let profile = ColorProfile::new_from_slice(profile).map_err(|error| error.to_string())?;
    let space = profile.color_space;
    match (space, is_grey) {
        (DataColorSpace::Gray, true) => {
            let curve = || curve(profile.gray_trc.as_ref());
            Ok(Profile { curves: [curve()?, curve()?, curve()?], matrix: None })
        }
        (DataColorSpace::Rgb, _) => {
            let [red, green, blue] = [&profile.red_trc, &profile.green_trc, &profile.blue_trc];
            let curves = [curve(red.as_ref())?, curve(green.as_ref())?, curve(blue.as_ref())?];
            let colorants = [profile.red_colorant, profile.green_colorant, profile.blue_colorant];
            let matrix = from_d50(colorants.map(|color| [color.x, color.y, color.z]));
            Ok(Profile { curves, matrix: matrix.ok_or("its colours span no space")? })
        }
        _ => Err(format!("it is for {space:?}, the picture is {}", if is_grey { "grey" } else { "RGB" })),
    }
}

fn curve(curve: Option<&ToneReprCurve>) -> Result<Curve, String> {
    let curve = curve.ok_or("it has tables instead of curves and a matrix")?;
    let curve = curve.make_linear_evaluator().map_err(|error| error.to_string())?;
    let light = move |value: f32| curve.evaluate_value(value);
    let levels = || (0..=255_u8).map(|level| f32::from(level) / 255.0);
    if levels().any(|level| !light(level).is_finite()) {
        return Err("its curves are not finite".into());
    }
    let is_srgb = levels().all(|level| (light(level) - srgb(level)).abs() < NOTHING);
    Ok(if is_srgb { Box::new(srgb) } else { Box::new(move |value| light(value).max(0.0)) })
}
