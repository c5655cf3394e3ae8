//! What tables and points are worth. The other half, with the documentation, is `fsot/metrics.py`.

pub mod given;
pub mod integrand;
pub mod integrands;
pub mod measure;
