//! Named families of test integrands.

use std::sync::Arc;

use super::drawn::DrawnFamily;
use super::error::MeasureError;
use super::integrand::Integrand;
use crate::error::RangeError;
use crate::table::extent::MOST_DIMS;

/// Integrands of a family that is drawn: a million leave an error of 3e-5 in the mean.
const MOST_INTEGRANDS: usize = 1 << 20;

/// Integrands under one name; results are means over each family, and over families.
///
/// The constants name the families of [`Integrands::random`], from what renderers integrate: edges, shading,
/// highlights and lights.
///
/// ```
/// use fsot::metrics::{Family, Integrands};
///
/// let integrands = Integrands::random(2, 8, 0)?;
/// let names: Vec<&str> = integrands.families().iter().map(Family::name).collect();
/// assert_eq!(names, [Family::HALF_SPACE, Family::SMOOTH, Family::BALL, Family::BOX]);
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    name: Arc<str>,
    integrands: Vec<Integrand>,
}

impl Family {
    /// Half-planes and half-spaces: the edge of an occluder.
    pub const HALF_SPACE: &'static str = "half-space";
    /// Linear functions, cosines and Gaussian bumps in equal shares.
    pub const SMOOTH: &'static str = "smooth";
    /// Discs and balls.
    pub const BALL: &'static str = "ball";
    /// Axis-parallel boxes.
    pub const BOX: &'static str = "box";

    /// Name for reports.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// At least one.
    pub fn integrands(&self) -> &[Integrand] {
        &self.integrands
    }

    /// The name, shared with results.
    pub(super) fn shared_name(&self) -> Arc<str> {
        self.name.clone()
    }
}

/// Families of integrands on `[0, 1)^dims`: random ones, your own, or both.
///
/// ```
/// use fsot::metrics::{Integrand, Integrands, Samples, SetError};
///
/// // How well do points integrate powers of x?
/// let power = |n: i32| {
///     let (mean, mean_sq) = (1.0 / f64::from(n + 1), 1.0 / f64::from(2 * n + 1));
///     Integrand::new(1, move |x| x[0].powi(n), mean, mean_sq - mean * mean)
/// };
/// let powers = (1..9).map(power).collect::<Result<Vec<_>, _>>()?;
/// let integrands = Integrands::random(1, 16, 0)?.with_family("powers", powers)?;
///
/// let points = Samples::points(&[0.125, 0.375, 0.625, 0.875], 1)?;
/// let error = SetError::measure(points, &[0], &integrands)?;
/// assert!(error.ratios.family("powers").unwrap().mean < 0.05);
/// # Ok::<(), fsot::metrics::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Integrands {
    dims: usize,
    families: Vec<Family>,
}

impl Integrands {
    /// Draws `per_family` integrands of every family; the same `seed` gives the same integrands.
    ///
    /// In the plane (and, with D for 2, beyond it):
    /// - *half-space*: normal uniform on the circle, threshold uniform over the projection of the square on
    ///   it;
    /// - *smooth*: in turn a linear function with gradient uniform on the circle; a cosine with wave vector
    ///   of uniform direction and 0.25 to 2 cycles per unit length, uniform phase; a Gaussian bump with
    ///   centre uniform in the square and standard deviation uniform in 0.1 to 0.5;
    /// - *ball*: centre uniform in the square, radius uniform in 0.1 to 0.5, clipped by the square. In three
    ///   dimensions or more: radius uniform in 0.25 to 0.5 and centre uniform where the ball fits into the
    ///   cube;
    /// - *box*: every side uniform in 0.2 to 0.8, position uniform where the box fits into the cube.
    ///
    /// A draw whose variance is below 0.001 is rejected. Bumps, balls and boxes constrain at most 4
    /// coordinates.
    ///
    /// Ratios depend on this distribution, the less smooth and the smaller the bodies the closer to 1:
    /// compare tables under the same integrands only. 256 per family leave a standard error of about 2 % in
    /// the mean.
    ///
    /// # Errors
    /// `dims` is 0 or above [`MOST_DIMS`]; `per_family` is 0 or above 2^20.
    pub fn random(dims: usize, per_family: usize, seed: u64) -> Result<Self, MeasureError> {
        for (what, count) in [("dimensions", dims), ("integrands per family", per_family)] {
            if count == 0 {
                return Err(MeasureError::Nothing { what });
            }
        }
        let range =
            |is_good, name, count: usize, expected| RangeError::check(is_good, name, count as f64, expected);
        range(dims <= MOST_DIMS, "the number of dimensions", dims, "of at most 64")?;
        let name = "the number of integrands per family";
        range(per_family <= MOST_INTEGRANDS, name, per_family, "of at most 1048576")?;
        let families = DrawnFamily::ALL.map(|family| Family {
            name: family.name().into(),
            integrands: (0..per_family).map(|index| family.integrand(seed, index, dims)).collect(),
        });
        Ok(Self { dims, families: families.into() })
    }

    /// A single family of integrands of `dims` coordinates each.
    ///
    /// # Errors
    /// No dimensions or integrands; an integrand of another number of coordinates.
    pub fn own(
        dims: usize,
        name: impl Into<Arc<str>>,
        integrands: Vec<Integrand>,
    ) -> Result<Self, MeasureError> {
        if dims == 0 {
            return Err(MeasureError::Nothing { what: "dimensions" });
        }
        Self { dims, families: Vec::new() }.with_family(name, integrands)
    }

    /// The same with a further family, which counts as much as every other, whatever its size.
    ///
    /// # Errors
    /// No integrands; an integrand of another number of coordinates; a name that another family has.
    pub fn with_family(
        mut self,
        name: impl Into<Arc<str>>,
        integrands: Vec<Integrand>,
    ) -> Result<Self, MeasureError> {
        let name = name.into();
        if integrands.is_empty() {
            return Err(MeasureError::Nothing { what: "integrands per family" });
        }
        if let Some(index) = integrands.iter().position(|integrand| integrand.dims() != self.dims) {
            let (given, expected) = (integrands[index].dims(), self.dims);
            return Err(MeasureError::IntegrandDims { family: name, index, given, expected });
        }
        if self.family(&name).is_some() {
            return Err(MeasureError::RepeatedFamily { name });
        }
        self.families.push(Family { name, integrands });
        Ok(self)
    }

    /// Number of coordinates of the integrands.
    pub fn dims(&self) -> usize {
        self.dims
    }

    /// The families, at least one, in the order of reports.
    pub fn families(&self) -> &[Family] {
        &self.families
    }

    /// The integrands of the family with this name, if there is one.
    pub fn family(&self, name: &str) -> Option<&[Integrand]> {
        self.families.iter().find(|family| &*family.name == name).map(Family::integrands)
    }

    /// All integrands, family by family.
    pub fn iter(&self) -> impl Iterator<Item = &Integrand> {
        self.families.iter().flat_map(Family::integrands)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Kernel, SpatialKernel, TemporalKernel};
    use crate::metrics::{Bias, ErrorImage, FilteredError, SetError, Spectra};
    use crate::table::SampleTable;
    use crate::table::extent::Extent;

    #[test]
    fn the_seed_names_the_integrands() {
        let few = Integrands::random(2, 8, 5).unwrap();
        let many = Integrands::random(2, 16, 5).unwrap();
        for (few, many) in few.families().iter().zip(many.families()) {
            assert_eq!(few.integrands(), &many.integrands()[..8]);
        }
        assert_ne!(few, Integrands::random(2, 8, 6).unwrap());
        assert_eq!(few.iter().count(), 32);
    }

    #[test]
    fn nothing_to_draw_is_named() {
        let error = Integrands::random(0, 8, 5).unwrap_err();
        assert_eq!(error, MeasureError::Nothing { what: "dimensions" });
        assert!(Integrands::random(2, 0, 5).is_err());
    }

    /// The same functions, once with closed forms and once as a caller's: the same figures to the last bit.
    #[test]
    fn ones_own_are_measured_like_drawn_ones() {
        let drawn = Integrands::random(2, 3, 1).unwrap();
        let wrapped = |integrand: &Integrand| {
            let (inner, mean, variance) = (integrand.clone(), integrand.integral(), integrand.variance());
            Integrand::new(2, move |x| inner.value(x), mean, variance).unwrap()
        };
        let mut families = drawn.families().iter();
        let own = |family: &Family| family.integrands().iter().map(wrapped).collect::<Vec<_>>();
        let first = families.next().unwrap();
        let mut mine = Integrands::own(2, first.name(), own(first)).unwrap();
        for family in families {
            mine = mine.with_family(family.name(), own(family)).unwrap();
        }
        let extent = Extent { frames: 2, height: 3, width: 4, spp: 2 };
        let table = SampleTable::white_noise(extent, 3, 7).unwrap();
        let spatial = SpatialKernel::Gaussian { sigma_px: 1.0 };
        let kernel = Kernel::product(spatial, TemporalKernel::None);
        let measured = |integrands: &Integrands| {
            let first = integrands.iter().next().unwrap();
            (
                Bias::measure(&table, &[2, 0], integrands).unwrap(),
                FilteredError::measure(&table, &[2, 0], integrands, &kernel).unwrap(),
                Spectra::measure(&table, &[2, 0], integrands).unwrap(),
                SetError::measure(&table, &[2, 0], integrands).unwrap(),
                ErrorImage::measure(&table, &[2, 0], first).unwrap(),
            )
        };
        assert_eq!(measured(&mine), measured(&drawn));
    }

    #[test]
    fn what_is_no_family_is_named() {
        let plain = Integrand::new(1, |x| x[0], 0.5, 1.0 / 12.0).unwrap();
        let of_two = Integrand::new(2, |x| x[0], 0.5, 1.0 / 12.0).unwrap();
        assert!(Integrands::own(0, "mine", vec![plain.clone()]).is_err());
        let error = Integrands::own(1, "mine", vec![]).unwrap_err();
        assert_eq!(error, MeasureError::Nothing { what: "integrands per family" });
        let error = Integrands::own(1, "mine", vec![plain.clone(), of_two]).unwrap_err();
        let family = "mine".into();
        assert_eq!(error, MeasureError::IntegrandDims { family, index: 1, given: 2, expected: 1 });
        let mine = Integrands::own(1, "mine", vec![plain.clone()]).unwrap();
        assert_eq!(mine.family("mine"), Some(&[plain.clone()][..]));
        let error = mine.with_family("mine", vec![plain]).unwrap_err();
        assert_eq!(error, MeasureError::RepeatedFamily { name: "mine".into() });
    }
}
