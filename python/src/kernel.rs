//! Filters.

use fsot::kernel::{SpatialKernel, Tap, TemporalKernel};
use fsot::{Extent, Kernel};
use ndarray::{Array2, ArrayView2, ArrayView3};
use numpy::PyArray2;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::arrays::{Numbers, to_numpy};
use crate::counts::Count;
use crate::errors::{OrPython, refused};
use crate::json;
use crate::work::left_alone;

/// A filter over pixels and frames, under which errors are to be small.
///
/// Made of an array of weights, or by `gaussian`, `box_` and `binomial`. Plain data that does not change;
/// what cannot filter is refused at once.
///
/// Parameters
/// ----------
/// weights : array_like
///     Weights ``[y, x]`` in space, rows from the top, or ``[t, y, x]`` in space and time: the current frame
///     first, then one frame further back each. An odd side is centred on the pixel that is filtered, an even
///     one reaches one pixel further right and down: row ``r`` of ``h`` lies ``r - (h - 1) // 2`` rows below.
///     Finite and at least 0, with a sum above 0; only their ratios matter.
/// temporal : str or array_like, optional
///     The filter over frames that weights ``[y, x]`` are multiplied by: see `fsot.table`. The current frame
///     alone by default.
/// truncation : float
///     Taps below this share of the largest are dropped; in ``[0, 1)``.
///
/// Raises
/// ------
/// ValueError
///     Another number of axes; a weight that is negative or not finite; a sum that is 0 or not finite; frames
///     among the weights beside ``temporal``.
/// TypeError
///     An array of anything but real numbers.
///
/// Examples
/// --------
/// >>> import fsot
/// >>> cross = fsot.Kernel([[0, 1, 0], [1, 2, 1], [0, 1, 0]])
/// >>> cross.taps()[:2]  # dt, dy, dx, weight
/// array([[ 0. ,  0. ,  0. ,  1. ],
///        [ 0. , -1. ,  0. ,  0.5]])
#[pyclass(frozen, eq, name = "Kernel", module = "fsot")]
#[derive(Clone, Debug, PartialEq)]
pub struct PyKernel(pub Kernel);

#[pymethods]
impl PyKernel {
    #[new]
    #[pyo3(signature = (weights, *, temporal = None, truncation = 1e-3))]
    fn new(
        weights: &Bound<'_, PyAny>,
        temporal: Option<&Bound<'_, PyAny>>,
        truncation: f64,
    ) -> PyResult<Self> {
        let Weights { kernel, .. } = Weights::of(weights)?;
        match temporal {
            Some(temporal) => Self::checked(in_time_of(kernel, temporal)?, truncation),
            None => Self::checked(kernel, truncation),
        }
    }

    /// The Gaussian ``exp(-r**2 / sigma**2)``, whose standard deviation is ``sigma / sqrt(2)``.
    ///
    /// Parameters
    /// ----------
    /// sigma : float
    ///     Width in pixels, above 0 and at most 1e6.
    /// temporal, truncation : optional
    ///     As of `Kernel`.
    #[staticmethod]
    #[pyo3(signature = (sigma = 2.1, *, temporal = None, truncation = 1e-3))]
    fn gaussian(sigma: f64, temporal: Option<&Bound<'_, PyAny>>, truncation: f64) -> PyResult<Self> {
        Self::product(SpatialKernel::Gaussian { sigma_px: sigma }, temporal, truncation)
    }

    /// Equal weights on ``size`` times ``size`` pixels, 1 to 1000000; an even size reaches one pixel further
    /// right and down. ``temporal`` and ``truncation`` as of `Kernel`.
    #[staticmethod]
    #[pyo3(signature = (size, *, temporal = None, truncation = 1e-3))]
    fn box_(size: Count, temporal: Option<&Bound<'_, PyAny>>, truncation: f64) -> PyResult<Self> {
        Self::product(SpatialKernel::Box { size_px: size.0 }, temporal, truncation)
    }

    /// The outer product of the binomial coefficients of ``size`` taps, 1 to 1000; an even size reaches one
    /// pixel further right and down. ``temporal`` and ``truncation`` as of `Kernel`.
    #[staticmethod]
    #[pyo3(signature = (size, *, temporal = None, truncation = 1e-3))]
    fn binomial(size: Count, temporal: Option<&Bound<'_, PyAny>>, truncation: f64) -> PyResult<Self> {
        Self::product(SpatialKernel::Binomial { size_px: size.0 }, temporal, truncation)
    }

    /// Taps below this share of the largest are dropped.
    #[getter]
    fn truncation(&self) -> f64 {
        self.0.truncation
    }

    /// The same in space, times this in time: see `fsot.table`.
    fn with_temporal(&self, temporal: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::checked(in_time_of(self.0.clone(), temporal)?, self.0.truncation)
    }

    /// The same with another truncation, in ``[0, 1)``. 0 keeps everything down to 1e-12.
    fn with_truncation(&self, truncation: f64) -> PyResult<Self> {
        Self::checked(self.0.clone(), truncation)
    }

    /// The filter within a frame, and the filter over frames within a pixel, as two kernels for
    /// `Config.with_kernels`: errors are to be small under each, not under their product.
    ///
    /// Examples
    /// --------
    /// >>> import fsot
    /// >>> space, time = fsot.Kernel.gaussian(2.1, temporal="ema:0.1").separate()
    /// >>> space == fsot.Kernel.gaussian(2.1), time == fsot.Kernel.box_(1, temporal="ema:0.1")
    /// (True, True)
    fn separate(&self) -> PyResult<[Self; 2]> {
        let Kernel { spatial, temporal, truncation } = self.0.clone();
        if matches!(spatial, SpatialKernel::PerFrame(_)) {
            return Err(refused(
                "the kernel has weights for each frame: give weights [y, x] and a temporal kernel, which are \
                 separate",
            ));
        }
        Ok(Kernel::separate(spatial, temporal).map(|kernel| Self(Kernel { truncation, ..kernel })))
    }

    /// The taps on a tile that wraps, by falling weight: rows of ``[dt, dy, dx, weight]``, float64. Offsets
    /// are in frames forward (0 or less), rows down and columns right; the largest weight is 1.
    #[pyo3(
        signature = (width = Count(64), height = Count(64), frames = Count(1)),
        text_signature = "($self, width=64, height=64, frames=1)"
    )]
    fn taps<'py>(
        &self,
        py: Python<'py>,
        width: Count,
        height: Count,
        frames: Count,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let extent = Extent { frames: frames.0, height: height.0, width: width.0, spp: 1 };
        let kernel = self.0.clone();
        let taps = left_alone(py, None, move || kernel.taps(&extent))?.python()?;
        Ok(rows(py, &taps))
    }

    /// Plain data, as in metadata.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0)
    }

    /// From plain data.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        let kernel: Kernel = json::of_python(data)?;
        let truncation = kernel.truncation;
        Self::checked(kernel, truncation)
    }

    fn __repr__(&self) -> PyResult<String> {
        Ok(format!("Kernel.from_dict({})", serde_json::to_string(&self.0).python()?))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyAny>,))> {
        Ok((py.get_type::<Self>().getattr("from_dict")?, (self.to_dict(py)?,)))
    }
}

impl PyKernel {
    fn product(
        spatial: SpatialKernel,
        temporal: Option<&Bound<'_, PyAny>>,
        truncation: f64,
    ) -> PyResult<Self> {
        let temporal = temporal.map_or(Ok(TemporalKernel::None), in_time)?;
        Self::checked(Kernel::product(spatial, temporal), truncation)
    }

    /// Refuses what would be refused when it is used.
    fn checked(kernel: Kernel, truncation: f64) -> PyResult<Self> {
        let kernel = Kernel { truncation, ..kernel };
        // Whatever folds, folds onto a pixel.
        kernel.taps(&Extent::still(1, 1)).python()?;
        Ok(Self(kernel))
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for PyKernel {
    type Error = PyErr;

    /// No array of weights: where there are frames, `fsot.table` and a `Kernel` make different things of one.
    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match object.cast::<Self>() {
            Ok(kernel) => Ok(kernel.get().clone()),
            Err(_) => Err(PyTypeError::new_err(format!(
                "a {} is no Kernel: give one, as by fsot.Kernel(weights)",
                object.get_type().name()?
            ))),
        }
    }
}

/// An array of weights, and what is known of it.
pub struct Weights {
    pub kernel: Kernel,
    /// Rows and columns.
    pub size: [usize; 2],
}

impl Weights {
    /// Weights `[y, x]` or `[t, y, x]`.
    pub fn of(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let Numbers { shape, values } = Numbers::<f64>::of(object)?;
        let (kernel, size) = match *shape.as_slice() {
            [rows, columns] => {
                let weights = ArrayView2::from_shape([rows, columns], &values).expect("it fits its shape");
                (Kernel::from_weights(weights), [rows, columns])
            }
            [frames, rows, columns] => {
                let weights = ArrayView3::from_shape([frames, rows, columns], &values);
                (Kernel::from_frame_weights(weights.expect("it fits its shape")), [rows, columns])
            }
            _ => {
                return Err(refused(format!(
                    "the kernel has shape {shape:?}: give two axes [y, x] or three [t, y, x]"
                )));
            }
        };
        Ok(Self { kernel: kernel.python()?, size })
    }
}

/// This kernel in space, times that in time.
///
/// # Errors
/// Weights for each frame: they stand for the temporal kernel as well.
pub fn in_time_of(kernel: Kernel, temporal: &Bound<'_, PyAny>) -> PyResult<Kernel> {
    if matches!(kernel.spatial, SpatialKernel::PerFrame(_)) {
        return Err(refused("the kernel has weights for each frame already: leave out the temporal kernel"));
    }
    Ok(kernel.with_temporal(in_time(temporal)?))
}

/// A temporal kernel as it is written on a command line, or weights with the current frame first.
pub fn in_time(temporal: &Bound<'_, PyAny>) -> PyResult<TemporalKernel> {
    if let Ok(text) = temporal.extract::<String>() {
        return fsot_cli::temporal::parse(&text).map_err(refused);
    }
    let Numbers { shape, values } = Numbers::<f64>::of(temporal)?;
    if shape.len() != 1 {
        return Err(refused(format!(
            "the temporal kernel has shape {shape:?}: give a list of weights, the current frame first, or \
             words such as 'ema:0.1'"
        )));
    }
    Ok(TemporalKernel::Taps(values))
}

/// Taps as rows of `[dt, dy, dx, weight]`.
pub fn rows<'py>(py: Python<'py>, taps: &[Tap]) -> Bound<'py, PyArray2<f64>> {
    let row = |tap: &Tap| [f64::from(tap.dt), f64::from(tap.dy), f64::from(tap.dx), tap.weight];
    let values = taps.iter().flat_map(row).collect();
    to_numpy(py, Array2::from_shape_vec((taps.len(), 4), values).expect("four numbers a tap"))
}
