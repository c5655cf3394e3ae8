//! The compiled half of the Python package `fsot`; the other half, with the documentation, is `fsot/`.

use pyo3::prelude::*;

mod arrays;
mod checkpoint;
mod classes;
mod config;
mod counts;
mod demand;
mod errors;
mod json;
mod kernel;
mod objective;
mod optimizer;
mod own;
mod pool;
mod settings;
mod slices;
mod step;
mod tables;
mod target;
mod term;
mod until;
mod work;

#[pymodule]
mod _fsot {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::checkpoint::PyCheckpoint;
    #[pymodule_export]
    use crate::classes::PyClasses;
    #[pymodule_export]
    use crate::config::{PyConfig, configure};
    #[pymodule_export]
    use crate::demand::PyDemand;
    #[pymodule_export]
    use crate::kernel::PyKernel;
    #[pymodule_export]
    use crate::objective::PyObjective;
    #[pymodule_export]
    use crate::optimizer::{PyOptimizer, PyReport};
    #[pymodule_export]
    use crate::slices::PySlices;
    #[pymodule_export]
    use crate::step::PyStep;
    #[pymodule_export]
    use crate::tables::{check_table, load_table, save_table};
    #[pymodule_export]
    use crate::target::PyTarget;
    #[pymodule_export]
    use crate::term::PyTerm;
    #[pymodule_export]
    use crate::until::{Until, until};

    /// Runs the command `fsot` with these arguments, and returns its exit code.
    #[pyfunction]
    fn command(py: Python<'_>, arguments: Vec<String>) -> u8 {
        py.detach(|| fsot_cli::command(arguments))
    }

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("BELOW_ONE", f64::from(fsot::config::BELOW_ONE))?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
