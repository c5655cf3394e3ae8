//! The compiled half of the Python package `fsot`; the other half, with the documentation, is `fsot/`.

use pyo3::prelude::*;

mod arrays;
mod checkpoint;
mod classes;
mod config;
mod counts;
mod demand;
mod drawing;
mod errors;
mod exchange;
mod json;
mod kernel;
mod make;
mod metrics;
mod objective;
mod optimizer;
mod own;
mod picture;
mod points;
mod pool;
mod settings;
mod slices;
mod step;
mod tables;
mod target;
mod term;
mod until;
mod work;
mod worth;

#[pymodule]
mod _fsot {
    use std::ffi::OsString;
    use std::io::{self, Write};

    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::checkpoint::PyCheckpoint;
    #[pymodule_export]
    use crate::classes::PyClasses;
    #[pymodule_export]
    use crate::config::PyConfig;
    #[pymodule_export]
    use crate::demand::PyDemand;
    #[pymodule_export]
    use crate::drawing::draw_points;
    #[pymodule_export]
    use crate::exchange::{export_table, import_table};
    #[pymodule_export]
    use crate::kernel::PyKernel;
    #[pymodule_export]
    use crate::make::configure;
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
    use crate::objective::PyObjective;
    #[pymodule_export]
    use crate::optimizer::{PyOptimizer, PyReport};
    #[pymodule_export]
    use crate::points::{plan_classes, plan_color_stippling, plan_progressive, plan_stippling, save_points};
    #[pymodule_export]
    use crate::slices::PySlices;
    #[pymodule_export]
    use crate::step::PyStep;
    #[pymodule_export]
    use crate::tables::{check_table, displacement, left_beside, load_table, save_table};
    #[pymodule_export]
    use crate::target::PyTarget;
    #[pymodule_export]
    use crate::term::PyTerm;
    #[pymodule_export]
    use crate::until::{Until, until};
    #[pymodule_export]
    use crate::worth::{glance_at_table, inspect_table, mapped_table, report_tables};

    /// Runs the command `fsot` with these arguments, and returns its exit code.
    #[pyfunction]
    fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
        py.detach(|| {
            let code = fsot_cli::command(arguments);
            // Nobody else does: the process is Python's. Who reads it may have gone away.
            let _ = io::stdout().flush();
            code
        })
    }

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("BELOW_ONE", f64::from(fsot::config::BELOW_ONE))?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
