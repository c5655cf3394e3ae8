//! All that determines a table but for the length of the run.

use fsot::config::{DimensionGroup, Domain};
use fsot::kernel::{TemporalKernel, check_fit};
use fsot::{Config, Extent, Kernel};
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::counts::{Count, Number};
use crate::errors::{OrPython, refused};
use crate::json;
use crate::kernel::{PyKernel, Weights, in_time_of};

/// All that determines a table but for the length of the run.
///
/// Plain data that does not change: `with_...` methods return another one.
#[pyclass(frozen, eq, name = "Config", module = "fsot", from_py_object)]
#[derive(Clone, Debug, PartialEq)]
pub struct PyConfig(pub Config);

#[pymethods]
impl PyConfig {
    #[new]
    #[pyo3(signature = (
        width = Count(64), height = Count(64), frames = Count(1), spp = Count(1), dims = Count(2), *,
        seed = Number(0)
    ), text_signature = "(width=64, height=64, frames=1, spp=1, dims=2, *, seed=0)")]
    fn new(width: Count, height: Count, frames: Count, spp: Count, dims: Count, seed: Number) -> Self {
        Self(Config::new(extent(width, height, frames, spp), dims.0).with_seed(seed.0))
    }

    /// Lengths of the axes `[frame, y, x, sample, dim]`.
    #[getter]
    fn shape(&self) -> (usize, usize, usize, usize, usize) {
        let Extent { frames, height, width, spp } = self.0.extent;
        (frames, height, width, spp, self.0.dims)
    }

    /// Seed of all random numbers.
    #[getter]
    fn seed(&self) -> u64 {
        self.0.seed
    }

    /// The filters, of which `with_kernels` would make the same terms.
    #[getter]
    fn kernels(&self) -> Vec<PyKernel> {
        self.0.kernels().into_iter().map(PyKernel).collect()
    }

    /// The same with another seed.
    fn with_seed(&self, seed: Number) -> Self {
        Self(self.0.clone().with_seed(seed.0))
    }

    /// The same for another filter.
    fn with_kernel(&self, kernel: PyKernel) -> Self {
        Self(self.0.clone().with_kernel(kernel.0))
    }

    /// The same for several filters at once.
    fn with_kernels(&self, kernels: Vec<PyKernel>) -> Self {
        let kernels: Vec<Kernel> = kernels.into_iter().map(|kernel| kernel.0).collect();
        Self(self.0.clone().with_kernels(&kernels))
    }

    /// The same for other groups of dimensions that integrands consume together: lists of dimensions, or
    /// pairs of such a list and a weight.
    fn with_groups(&self, groups: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(self.0.clone().with_groups(&groups_of(groups)?)))
    }

    /// The same on `"interval"`s or a `"torus"`: one for all dimensions, or a list with one for each.
    fn with_domain(&self, domain: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(with_domain(self.0.clone(), domain)?))
    }

    /// The same with or without the smaller filters that come with each kernel.
    fn with_companions(&self, companions: bool) -> Self {
        Self(self.0.clone().with_companions(companions))
    }

    /// Plain data, as in metadata.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0)
    }

    /// From plain data.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        json::of_python(data).map(Self)
    }

    /// As JSON.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.0).python()
    }

    /// From JSON.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        json::of_text(text).map(Self)
    }

    fn __repr__(&self) -> String {
        let (frames, height, width, spp, dims) = self.shape();
        format!(
            "Config(width={width}, height={height}, frames={frames}, spp={spp}, dims={dims}, seed={}, \
             terms={})",
            self.0.seed,
            self.0.terms.len()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("from_json")?, (self.to_json()?,)))
    }
}

/// What `fsot.table` says of a table.
#[pyfunction]
#[pyo3(signature = (width, height, frames, spp, dims, *, sigma, temporal, kernel, groups, domain, seed))]
#[allow(clippy::too_many_arguments)] // they are the arguments of a function of Python
pub fn configure(
    width: Count,
    height: Count,
    frames: Count,
    spp: Count,
    dims: Count,
    sigma: Option<f64>,
    temporal: Option<&Bound<'_, PyAny>>,
    kernel: Option<&Bound<'_, PyAny>>,
    groups: Option<&Bound<'_, PyAny>>,
    domain: Option<&Bound<'_, PyAny>>,
    seed: Number,
) -> PyResult<PyConfig> {
    let mut config = Config::new(extent(width, height, frames, spp), dims.0).with_seed(seed.0);
    if let Some(domain) = domain {
        config = with_domain(config, domain)?;
    }
    if sigma.is_some() && kernel.is_some() {
        return Err(refused("sigma and kernel say the same thing twice: leave out one of them"));
    }
    let usual = config.kernels().swap_remove(0);
    let own = match (kernel, sigma) {
        (Some(kernel), _) => given(kernel, temporal, usual, &config.extent)?,
        (None, sigma) => {
            let own =
                sigma.map_or(usual.clone(), |sigma| Kernel::gaussian(sigma).with_temporal(usual.temporal));
            temporal.map_or(Ok(own.clone()), |temporal| in_time_of(own, temporal))?
        }
    };
    config = config.with_kernel(own);
    if let Some(groups) = groups {
        config = config.with_groups(&groups_of(groups)?);
    }
    Ok(PyConfig(config))
}

fn extent(width: Count, height: Count, frames: Count, spp: Count) -> Extent {
    Extent { frames: frames.0, height: height.0, width: width.0, spp: spp.0 }
}

/// A `Kernel` as it is, or an array of weights: those in space alone are seen over time as is usual.
fn given(
    kernel: &Bound<'_, PyAny>,
    temporal: Option<&Bound<'_, PyAny>>,
    usual: Kernel,
    extent: &Extent,
) -> PyResult<Kernel> {
    let (kernel, size) = match kernel.extract::<PyKernel>() {
        Ok(PyKernel(kernel)) => {
            if temporal.is_some() && kernel.temporal != TemporalKernel::None {
                // Of weights for each frame there is more to say.
                temporal.map(|temporal| in_time_of(kernel.clone(), temporal)).transpose()?;
                return Err(refused(
                    "kernel and temporal both say how frames are seen: leave out one of them, or give the \
                     kernel by kernel.with_temporal(...)",
                ));
            }
            let size = kernel.spatial.span();
            (kernel, size)
        }
        Err(_) => {
            let Weights { kernel, size } = Weights::of(kernel)?;
            let kernel = match kernel.temporal {
                TemporalKernel::None if temporal.is_none() => kernel.with_temporal(usual.temporal),
                _ => kernel,
            };
            (kernel, Some(size))
        }
    };
    size.map_or(Ok(()), |size| check_fit(size, extent)).python()?;
    temporal.map_or(Ok(kernel.clone()), |temporal| in_time_of(kernel, temporal))
}

pub fn with_domain(config: Config, domain: &Bound<'_, PyAny>) -> PyResult<Config> {
    match domain.cast::<PyList>() {
        Ok(list) => Ok(config.with_domains(list.iter().map(|one| domain_of(&one)).collect::<PyResult<_>>()?)),
        Err(_) => Ok(config.with_domain(domain_of(domain)?)),
    }
}

fn domain_of(name: &Bound<'_, PyAny>) -> PyResult<Domain> {
    match name.extract::<&str>()? {
        "interval" => Ok(Domain::Interval),
        "torus" => Ok(Domain::Torus),
        other => Err(refused(format!("'{other}' is no domain: write interval or torus"))),
    }
}

fn groups_of(groups: &Bound<'_, PyAny>) -> PyResult<Vec<DimensionGroup>> {
    let group = |one: Bound<'_, PyAny>| -> PyResult<DimensionGroup> {
        let numbers = |dims: Vec<Count>| dims.into_iter().map(|Count(dim)| dim).collect::<Vec<_>>();
        match one.extract::<(Vec<Count>, f64)>() {
            Ok((dims, weight)) => Ok(DimensionGroup::new(numbers(dims)).with_weight(weight)),
            Err(_) => Ok(DimensionGroup::new(numbers(one.extract()?))),
        }
    };
    groups.try_iter()?.map(|one| group(one?)).collect()
}
