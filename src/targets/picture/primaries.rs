//! From the colours of a file to those of Rec. 709, by whose weights luminance is told.

use nalgebra::{Matrix3, Vector3};

/// Where red, green, blue and white lie in the CIE's diagram: `[x, y]` each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Primaries {
    pub red: [f64; 2],
    pub green: [f64; 2],
    pub blue: [f64; 2],
    pub white: [f64; 2],
}

/// To be multiplied with red, green and blue.
pub(super) type ColorMatrix = [[f32; 3]; 3];

const D65: [f64; 2] = [0.3127, 0.329];
/// White of the space that ICC profiles refer to.
const D50: [f64; 3] = [0.9642, 1.0, 0.8249];

const fn with_d65(red: [f64; 2], green: [f64; 2], blue: [f64; 2]) -> Primaries {
    Primaries { red, green, blue, white: D65 }
}

/// Rec. 709 and sRGB.
const REC_709: Primaries = with_d65([0.64, 0.33], [0.3, 0.6], [0.15, 0.06]);

/// Below, no difference is seen at 8 bits; rounded numbers of the same colours differ less.
const NOTHING: f64 = 0.002;

impl Primaries {
    /// Those that a code point of ITU-T H.273, table 2, stands for.
    pub fn of_code_point(code: u8) -> Option<Self> {
        Some(match code {
            1 | 2 => REC_709,
            5 => with_d65([0.64, 0.33], [0.29, 0.6], [0.15, 0.06]),
            6 | 7 => with_d65([0.63, 0.34], [0.31, 0.595], [0.155, 0.07]),
            9 => with_d65([0.708, 0.292], [0.17, 0.797], [0.131, 0.046]),
            11 => Primaries { white: [0.314, 0.351], ..P3 },
            12 => P3,
            _ => return None,
        })
    }

    /// `None` if these span no colours.
    fn to_xyz(self) -> Option<(Matrix3<f64>, Vector3<f64>)> {
        let place = |[x, y]: [f64; 2]| Vector3::new(x, y, 1.0 - x - y);
        let white = place(self.white) / self.white[1];
        let columns = Matrix3::from_columns(&[self.red, self.green, self.blue].map(place));
        let scales = columns.try_inverse()? * white;
        let matrix = columns * Matrix3::from_diagonal(&scales);
        matrix.iter().all(|value| value.is_finite()).then_some((matrix, white))
    }

    /// From these colours to those of Rec. 709: `Some(None)` if they are the same, `None` if these are no
    /// colours.
    pub fn to_rec_709(self) -> Option<Option<ColorMatrix>> {
        let (matrix, white) = self.to_xyz()?;
        from_xyz(matrix, white)
    }
}

const P3: Primaries = with_d65([0.68, 0.32], [0.265, 0.69], [0.15, 0.06]);

/// The same for red, green and blue of an ICC profile, in XYZ under D50.
pub(super) fn from_d50(colorants: [[f64; 3]; 3]) -> Option<Option<ColorMatrix>> {
    from_xyz(Matrix3::from_columns(&colorants.map(Vector3::from)), Vector3::from(D50))
}

fn from_xyz(matrix: Matrix3<f64>, white: Vector3<f64>) -> Option<Option<ColorMatrix>> {
    // Bradford's cones.
    let cones = Matrix3::new(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296);
    let (rec_709, d65) = REC_709.to_xyz()?;
    let adapt = Matrix3::from_diagonal(&(cones * d65).component_div(&(cones * white)));
    let whole = rec_709.try_inverse()? * cones.try_inverse()? * adapt * cones * matrix;
    if whole.iter().any(|value| !value.is_finite()) || whole.try_inverse().is_none() {
        return None;
    }
    let is_same = (whole - Matrix3::identity()).amax() < NOTHING;
    Some((!is_same).then(|| std::array::from_fn(|row| std::array::from_fn(|at| whole[(row, at)] as f32))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_become_those_of_rec_709() {
        assert_eq!(REC_709.to_rec_709(), Some(None));
        // As profiles of sRGB have them.
        let srgb = [[0.4361, 0.2225, 0.0139], [0.3851, 0.7169, 0.0971], [0.1431, 0.0606, 0.7141]];
        assert_eq!(from_d50(srgb), Some(None));
        // White stays white, and BT.2020's matrix is that of ITU-R BT.2087.
        let matrix = Primaries::of_code_point(9).unwrap().to_rec_709().unwrap().unwrap();
        let expected = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
        for (row, expected) in matrix.iter().zip(expected) {
            assert!((row.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{matrix:?}");
            assert!(row.iter().zip(expected).all(|(a, b): (&f32, f32)| (a - b).abs() < 2e-4), "{matrix:?}");
        }
        for code in [5, 6, 11, 12] {
            let matrix = Primaries::of_code_point(code).unwrap().to_rec_709().unwrap().unwrap();
            assert!(matrix.iter().all(|row| (row.iter().sum::<f32>() - 1.0).abs() < 1e-5), "{code}");
        }
        let flat = Primaries { red: [0.3, 0.6], ..REC_709 };
        assert_eq!(flat.to_rec_709(), None);
        assert_eq!(Primaries { white: [0.3, 0.0], ..REC_709 }.to_rec_709(), None);
    }
}
