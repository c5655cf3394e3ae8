//! What `fsot.table` says of a table.

use fsot::kernel::{TemporalKernel, check_fit};
use fsot::{Config, Extent, Kernel};
use pyo3::prelude::*;

use crate::config::{PyConfig, extent};
use crate::counts::{Count, Number};
use crate::errors::{OrPython, refused};
use crate::kernel::{PyKernel, Weights, in_time_of};
use crate::settings::{groups_of, with_domain};

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
        let groups = groups_of(groups, config.dims)?;
        config = config.with_groups(&groups);
    }
    Ok(PyConfig(config))
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
