//! What the numbers of a file mean.

use png::{CodingIndependentCodePoints, ColorType, Info, SourceChromaticities};

use super::icc::{self, Curve};
use super::options::Transfer;
use super::primaries::{ColorMatrix, Primaries};
use super::transfer;

/// From the numbers of a file to light in the colours of Rec. 709.
pub(super) struct Light {
    /// Of red, green and blue.
    pub curves: [Curve; 3],
    /// `None`: the colours are those.
    pub matrix: Option<ColorMatrix>,
}

impl Light {
    fn new(curve: impl Fn(f32) -> f32 + Copy + 'static, matrix: Option<ColorMatrix>) -> Self {
        Self { curves: [Box::new(curve), Box::new(curve), Box::new(curve)], matrix }
    }

    /// Of numbers that say nothing of themselves.
    pub fn of_levels(transfer: Transfer) -> Self {
        match transfer {
            Transfer::Linear => Self::new(|value| value, None),
            Transfer::Srgb | Transfer::FromFile => Self::new(transfer::srgb, None),
        }
    }

    /// What a PNG file says, or is said of it; what cannot be read, in words.
    pub fn of_png(info: &Info, transfer: Transfer) -> Result<Self, String> {
        match transfer {
            Transfer::Srgb | Transfer::Linear => return Ok(Self::of_levels(transfer)),
            Transfer::FromFile => {}
        }
        // 2 is "unspecified".
        let points = info.coding_independent_code_points.filter(|points| points.transfer_function != 2);
        if let Some(points) = points {
            return Self::of_code_points(points);
        }
        if let Some(profile) = &info.icc_profile {
            let is_grey = matches!(info.color_type, ColorType::Grayscale | ColorType::GrayscaleAlpha);
            let profile = icc::read(profile, is_grey)
                .map_err(|what| format!("its ICC profile (iCCP) cannot be read: {what}"))?;
            return Ok(Self { curves: profile.curves, matrix: profile.matrix });
        }
        if info.srgb.is_some() {
            return Ok(Self::new(transfer::srgb, None));
        }
        let matrix = info.chrm_chunk.as_ref().map_or(Ok(None), of_chromaticities)?;
        let Some(gamma) = info.gama_chunk.map(|gamma| gamma.into_value()) else {
            return Ok(Self::new(transfer::srgb, matrix));
        };
        let curve = || {
            transfer::of_gamma(gamma)
                .ok_or_else(|| format!("its gAMA says {gamma}, where 0.1 to 10 is plausible"))
        };
        Ok(Self { curves: [curve()?, curve()?, curve()?], matrix })
    }

    fn of_code_points(points: CodingIndependentCodePoints) -> Result<Self, String> {
        let CodingIndependentCodePoints { color_primaries, transfer_function, .. } = points;
        if !points.is_video_full_range_image {
            return Err("its cICP says that values are of narrow range".into());
        }
        let curve = transfer::of_code_point(transfer_function).ok_or_else(|| {
            let name = if transfer_function == 18 { " (HLG)" } else { "" };
            format!("its cICP names the transfer function {transfer_function}{name}, which is not read")
        })?;
        let matrix = Primaries::of_code_point(color_primaries).and_then(Primaries::to_rec_709);
        let matrix = matrix
            .ok_or_else(|| format!("its cICP names the colours {color_primaries}, which are not read"))?;
        Ok(Self::new(curve, matrix))
    }

    /// Light of these colours in those of Rec. 709.
    pub fn in_rec_709(&self, colors: [f32; 3]) -> [f32; 3] {
        match &self.matrix {
            None => colors,
            Some(matrix) => multiplied(matrix, colors),
        }
    }
}

pub(super) fn multiplied(matrix: &ColorMatrix, [red, green, blue]: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * red + row[1] * green + row[2] * blue)
}

fn of_chromaticities(given: &SourceChromaticities) -> Result<Option<ColorMatrix>, String> {
    let [red, green, blue, white] = [given.red, given.green, given.blue, given.white]
        .map(|(x, y)| [x, y].map(|part| f64::from(part.into_value())));
    let primaries = Primaries { red, green, blue, white };
    primaries.to_rec_709().ok_or_else(|| "its cHRM names colours that span no space".into())
}
