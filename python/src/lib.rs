//! The compiled half of the Python package `fsot`; the other half, with the documentation, is `fsot/`.

use pyo3::prelude::*;

mod arrays;
mod checkpoint;
mod config;
mod counts;
mod errors;
mod exchange;
mod json;
mod kernel;
mod metrics;
mod optimizer;
mod pool;
mod step;
mod tables;
mod until;
mod work;
mod worth;

#[pymodule]
mod _fsot {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::checkpoint::PyCheckpoint;
    #[pymodule_export]
    use crate::config::{PyConfig, configure};
    #[pymodule_export]
    use crate::exchange::{export_table, import_table};
    #[pymodule_export]
    use crate::kernel::PyKernel;
    #[pymodule_export]
    use crate::metrics::integrand::PyIntegrand;
    #[pymodule_export]
    use crate::metrics::integrands::PyIntegrands;
    #[pymodule_export]
    use crate::metrics::measure::{
        measure_bias, measure_bound, measure_density_match, measure_discrepancy, measure_error_image,
        measure_filtered_error, measure_histogram, measure_marginal, measure_set_error,
        measure_sliced_distance, measure_spectra, spectra_of_image,
    };
    #[pymodule_export]
    use crate::optimizer::{PyOptimizer, PyReport};
    #[pymodule_export]
    use crate::step::PyStep;
    #[pymodule_export]
    use crate::tables::{check_table, displacement, left_beside, load_table, save_table};
    #[pymodule_export]
    use crate::until::{Until, until};
    #[pymodule_export]
    use crate::worth::{glance_at_table, inspect_table, mapped_table, report_tables};

    /// Runs the command `fsot` with these arguments, and returns its exit code.
    #[pyfunction]
    fn command(py: Python<'_>, arguments: Vec<String>) -> u8 {
        py.detach(|| fsot_cli::command(arguments))
    }

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
