//! Metrics: plain figures and arrays, of which Python makes results with names.

use std::sync::Arc;

use fsot::config::DimensionGroup;
use fsot::files::BoundEstimate;
use fsot::kernel::SpatialKernel;
use fsot::metrics::{
    Bias, Bound as OfObjective, DensityMatch, Discrepancy, ErrorImage, Estimate, FilteredError, Histogram,
    Integrands, Marginal, MeasureError, RadialBin, Ratios, SetError, SlicedDistance, Spectra,
};
use fsot::targets::{Density, Target};
use fsot::{Config, Kernel, Objective};
use ndarray::Array3;
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;

use super::given::{Given, group_of};
use super::integrand::{Places, PyIntegrand};
use super::integrands::{PyIntegrands, places};
use super::measured;
use crate::arrays::{Numbers, to_numpy};
use crate::config::PyConfig;
use crate::counts::{Count, Number};
use crate::errors::{OrPython, refused};
use crate::kernel::PyKernel;
use crate::objective::PyObjective;
use crate::target::PyTarget;

/// Mean and standard error.
type Pair = (f64, f64);
/// The mean of the families, and each of them.
type OfFamilies = (Pair, Vec<(String, Pair)>);

fn pair(Estimate { mean, standard_error, .. }: Estimate) -> Pair {
    (mean, standard_error)
}

fn of_families(ratios: &Ratios) -> OfFamilies {
    let families = ratios.families.iter().map(|family| (family.name.to_string(), pair(family.ratio)));
    (pair(ratios.mean), families.collect())
}

/// What most metrics are asked.
struct Question {
    given: Given,
    group: Vec<usize>,
}

impl Question {
    fn new(samples: &Bound<'_, PyAny>, dims: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let given = Given::of(samples)?;
        let group = group_of(dims, given.dims)?;
        Ok(Self { given, group })
    }

    /// The integrands that are given, or those that `fsot inspect` takes.
    fn integrands(&self, py: Python<'_>, given: Option<&PyIntegrands>) -> PyResult<Arc<Integrands>> {
        match given {
            Some(integrands) => integrands.at(py, &self.given, &self.group),
            None => {
                // What is wrong with the dimensions is said by the metric.
                let dims = self.group.len().clamp(1, 64);
                Integrands::random(dims, 256, 0).map(Arc::new).python()
            }
        }
    }

    /// The filter that is given, or that of `fsot inspect`.
    fn kernel(&self, kernel: Option<PyKernel>) -> Kernel {
        kernel.map_or_else(|| usual_kernel(self.given.frames()), |kernel| kernel.0)
    }
}

fn usual_kernel(frames: usize) -> Kernel {
    let temporal = fsot_cli::temporal::or_default(None, frames);
    Kernel::product(SpatialKernel::Gaussian { sigma_px: 2.1 }, temporal)
}

#[pyfunction]
#[pyo3(signature = (samples, dims, integrands, kernel, frames, threads))]
pub fn measure_filtered_error(
    py: Python<'_>,
    samples: &Bound<'_, PyAny>,
    dims: Option<&Bound<'_, PyAny>>,
    integrands: Option<PyIntegrands>,
    kernel: Option<PyKernel>,
    frames: Option<Count>,
    threads: Option<Count>,
) -> PyResult<[OfFamilies; 3]> {
    let question = Question::new(samples, dims)?;
    let integrands = question.integrands(py, integrands.as_ref())?;
    let (kernel, Question { given, group }) = (question.kernel(kernel), question);
    let measure = move || match frames {
        Some(Count(frames)) => {
            FilteredError::measure_frames(given.samples()?, &group, &integrands, &kernel, frames)
        }
        None => FilteredError::measure(given.samples()?, &group, &integrands, &kernel),
    };
    let error = measured(py, threads, measure)?.python()?;
    Ok([&error.unfiltered, &error.spatial, &error.spatio_temporal].map(of_families))
}

#[pyfunction]
#[pyo3(signature = (samples, dims, integrands, threads))]
pub fn measure_bias(
    py: Python<'_>,
    samples: &Bound<'_, PyAny>,
    dims: Option<&Bound<'_, PyAny>>,
    integrands: Option<PyIntegrands>,
    threads: Option<Count>,
) -> PyResult<[OfFamilies; 3]> {
    let question = Question::new(samples, dims)?;
    let integrands = question.integrands(py, integrands.as_ref())?;
    let Question { given, group } = question;
    let bias =
        measured(py, threads, move || Bias::measure(given.samples()?, &group, &integrands))?.python()?;
    Ok([&bias.table, &bias.frame, &bias.pixel].map(of_families))
}

#[pyfunction]
#[pyo3(signature = (samples, dims, integrands, threads))]
pub fn measure_set_error(
    py: Python<'_>,
    samples: &Bound<'_, PyAny>,
    dims: Option<&Bound<'_, PyAny>>,
    integrands: Option<PyIntegrands>,
    threads: Option<Count>,
) -> PyResult<OfFamilies> {
    let question = Question::new(samples, dims)?;
    let integrands = question.integrands(py, integrands.as_ref())?;
    let Question { given, group } = question;
    let error = measured(py, threads, move || SetError::measure(given.samples()?, &group, &integrands))?;
    Ok(of_families(&error.python()?.ratios))
}

type BoundFigures = (f64, f64, f64, f64);

fn bound_figures(estimate: &BoundEstimate) -> BoundFigures {
    let &BoundEstimate { value, standard_error, ratio_to_white_noise, ratio_standard_error } = estimate;
    (value, standard_error, ratio_to_white_noise, ratio_standard_error)
}

/// Whose bound it is.
#[derive(FromPyObject)]
pub enum Aim<'py> {
    Config(PyRef<'py, PyConfig>),
    Objective(PyRef<'py, PyObjective>),
}

#[pyfunction]
#[pyo3(signature = (samples, aim, kernel, slices, seed, threads))]
pub fn measure_bound(
    py: Python<'_>,
    samples: &Bound<'_, PyAny>,
    aim: Option<Aim<'_>>,
    kernel: Option<PyKernel>,
    slices: Count,
    seed: Number,
    threads: Option<Count>,
) -> PyResult<(BoundFigures, Vec<BoundFigures>)> {
    let given = Given::of(samples)?;
    let planned = match (aim, kernel) {
        (Some(_), Some(_)) => {
            return Err(refused("the objective has its own kernel: leave out one of them"));
        }
        (Some(Aim::Objective(objective)), None) => Ok(Arc::clone(&objective.objective)),
        (Some(Aim::Config(config)), None) => Err(config.0.clone()),
        (None, kernel) => {
            let kernel = kernel.map_or_else(|| usual_kernel(given.frames()), |kernel| kernel.0);
            let groups = DimensionGroup::pairs_and_whole(given.dims);
            Err(Config::new(given.extent(), given.dims).with_groups(&groups).with_kernel(kernel))
        }
    };
    let measure = move || -> Result<OfObjective, MeasureError> {
        let samples = given.samples()?;
        let objective = match planned {
            Ok(objective) => objective,
            Err(config) => Arc::new(Objective::new(&config)?),
        };
        OfObjective::measure(samples, &objective, seed.0, slices.0)
    };
    let bound = measured(py, threads, measure)?.python()?;
    Ok((bound_figures(&bound.total), bound.terms.iter().map(bound_figures).collect()))
}

/// Two arrays, the rings of the first, and its preferred directions.
type SpectraArrays<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    [Bound<'py, PyArray1<f64>>; 3],
    [(f64, f64, f64); 3],
);

fn spectra_arrays(py: Python<'_>, spectra: Spectra) -> SpectraArrays<'_> {
    let rings = spectra.radial();
    let column = |pick: fn(&RadialBin) -> f64| PyArray1::from_vec(py, rings.iter().map(pick).collect());
    let radial = [column(|ring| ring.frequency), column(|ring| ring.power), column(|ring| ring.count as f64)];
    let anisotropy = spectra.anisotropy().map(|ring| (ring.from, ring.to, ring.along_y_over_along_x));
    let Spectra { xy, xt, .. } = spectra;
    (to_numpy(py, xy), to_numpy(py, xt), radial, anisotropy)
}

#[pyfunction]
#[pyo3(signature = (samples, dims, integrands, threads))]
pub fn measure_spectra<'py>(
    py: Python<'py>,
    samples: &Bound<'py, PyAny>,
    dims: Option<&Bound<'py, PyAny>>,
    integrands: Option<PyIntegrands>,
    threads: Option<Count>,
) -> PyResult<SpectraArrays<'py>> {
    let question = Question::new(samples, dims)?;
    let integrands = question.integrands(py, integrands.as_ref())?;
    let Question { given, group } = question;
    let spectra = measured(py, threads, move || Spectra::measure(given.samples()?, &group, &integrands))?;
    Ok(spectra_arrays(py, spectra.python()?))
}

#[pyfunction]
pub fn spectra_of_image<'py>(
    py: Python<'py>,
    errors: &Bound<'py, PyAny>,
    variance: Option<f64>,
) -> PyResult<SpectraArrays<'py>> {
    let Numbers { shape, values } = Numbers::<f64>::of(errors)?;
    let shape = match *shape.as_slice() {
        [height, width] => [1, height, width],
        [frames, height, width] => [frames, height, width],
        _ => {
            return Err(refused(format!(
                "an image of shape {shape:?}: give an array [y, x] or [frame, y, x]"
            )));
        }
    };
    if values.is_empty() {
        return Err(refused(format!("an image of shape {shape:?} has no spectrum: give at least one pixel")));
    }
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        return Err(refused(format!("pixel {at} of the image is {}: give finite errors", values[at])));
    }
    let mean_square = || values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64;
    let variance = variance.unwrap_or_else(mean_square);
    if !(variance > 0.0 && variance.is_finite()) {
        return Err(refused(format!("the variance is {variance}: give a value above 0 that is finite")));
    }
    let image = Array3::from_shape_vec(shape, values).expect("as it came");
    let measure = move || Spectra::of_image(image.view(), variance);
    Ok(spectra_arrays(py, measured(py, None, measure)?))
}

#[pyfunction]
#[pyo3(signature = (samples, integrand, dims, threads))]
pub fn measure_error_image<'py>(
    py: Python<'py>,
    samples: &Bound<'py, PyAny>,
    integrand: &PyIntegrand,
    dims: Option<&Bound<'py, PyAny>>,
    threads: Option<Count>,
) -> PyResult<(Bound<'py, PyArray3<f64>>, f64)> {
    let Question { given, group } = Question::new(samples, dims)?;
    let list = || places(&given, &group, integrand.dims());
    let integrand = integrand.at(py, &mut Places::new(&list))?;
    let image = measured(py, threads, move || ErrorImage::measure(given.samples()?, &group, &integrand))?;
    let ErrorImage { errors, white_variance, .. } = image.python()?;
    Ok((to_numpy(py, errors), white_variance))
}

#[pyfunction]
#[pyo3(signature = (samples, dim, bins, threads))]
#[allow(clippy::type_complexity)] // counts, faces and zeros
pub fn measure_marginal<'py>(
    py: Python<'py>,
    samples: &Bound<'py, PyAny>,
    dim: Count,
    bins: Count,
    threads: Option<Count>,
) -> PyResult<(Bound<'py, PyArray1<u64>>, Vec<(f64, f64, f64)>, u64)> {
    let given = Given::of(samples)?;
    let marginal =
        measured(py, threads, move || Marginal::measure(given.samples()?, dim.0, bins.0))?.python()?;
    let faces = marginal.faces.iter().map(|face| (face.within, face.density, face.standard_error));
    Ok((PyArray1::from_vec(py, marginal.counts.clone()), faces.collect(), marginal.zeros))
}

#[pyfunction]
#[pyo3(signature = (samples, dims, cells_per_side, threads))]
pub fn measure_histogram<'py>(
    py: Python<'py>,
    samples: &Bound<'py, PyAny>,
    dims: [Count; 2],
    cells_per_side: Count,
    threads: Option<Count>,
) -> PyResult<(Bound<'py, PyArray1<u64>>, f64)> {
    let given = Given::of(samples)?;
    let dims = dims.map(|Count(dim)| dim);
    let measure = move || Histogram::measure(given.samples()?, dims, cells_per_side.0);
    let histogram = measured(py, threads, measure)?.python()?;
    let spread = histogram.spread();
    Ok((PyArray1::from_vec(py, histogram.counts), spread))
}

#[pyfunction]
#[pyo3(signature = (samples, dims, threads))]
pub fn measure_discrepancy(
    py: Python<'_>,
    samples: &Bound<'_, PyAny>,
    dims: Option<&Bound<'_, PyAny>>,
    threads: Option<Count>,
) -> PyResult<(f64, f64)> {
    let Question { given, group } = Question::new(samples, dims)?;
    let found = measured(py, threads, move || Discrepancy::measure(given.samples()?, &group))?.python()?;
    Ok((found.squared, found.ratio_to_white_noise))
}

/// The cube, a target, or a picture `[y, x]`.
fn target_of(target: Option<&Bound<'_, PyAny>>) -> PyResult<Target> {
    let Some(target) = target else { return Ok(Target::UniformCube) };
    match target.extract::<PyTarget>() {
        Ok(PyTarget(target)) => Ok(target),
        Err(_) => Ok(Target::Density(density_of(target)?)),
    }
}

fn density_of(picture: &Bound<'_, PyAny>) -> PyResult<Arc<Density>> {
    match picture.extract::<PyTarget>() {
        Ok(PyTarget(Target::Density(density))) => return Ok(density),
        Ok(_) => return Err(refused("the target is no density: give Target.density, or an array [y, x]")),
        Err(_) => {}
    }
    let Numbers { shape, values } = Numbers::<f32>::of(picture)?;
    let &[height, width] = shape.as_slice() else {
        return Err(refused(format!("a density of shape {shape:?}: give an array [y, x]")));
    };
    Density::new(width, height, values).map(Arc::new).python()
}

#[pyfunction]
#[pyo3(signature = (samples, dims, target, directions, threads))]
pub fn measure_sliced_distance(
    py: Python<'_>,
    samples: &Bound<'_, PyAny>,
    dims: Option<&Bound<'_, PyAny>>,
    target: Option<&Bound<'_, PyAny>>,
    directions: Count,
    threads: Option<Count>,
) -> PyResult<f64> {
    let Question { given, group } = Question::new(samples, dims)?;
    let target = target_of(target)?;
    let measure = move || SlicedDistance::measure(given.samples()?, &group, &target, directions.0);
    Ok(measured(py, threads, measure)?.python()?.w2)
}

/// Correlation and strays; deviation, column, row, side, points and expectation of the worst block.
type Match = ((f64, usize), (f64, usize, usize, usize, usize, f64));

#[pyfunction]
#[pyo3(signature = (samples, density, sigma, dims, threads))]
pub fn measure_density_match(
    py: Python<'_>,
    samples: &Bound<'_, PyAny>,
    density: &Bound<'_, PyAny>,
    sigma: f64,
    dims: [Count; 2],
    threads: Option<Count>,
) -> PyResult<Match> {
    let given = Given::of(samples)?;
    let density = density_of(density)?;
    let dims = dims.map(|Count(dim)| dim);
    let measure = move || DensityMatch::measure(given.samples()?, dims, &density, sigma);
    let DensityMatch { correlation, strays, worst, .. } = measured(py, threads, measure)?.python()?;
    let block = (worst.deviation, worst.column, worst.row, worst.side, worst.points, worst.expected);
    Ok(((correlation, strays), block))
}
