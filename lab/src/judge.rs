//! What a table is worth, in the three figures that the benches report.

use fsot::metrics::{Bias, Bound, FilteredError, Integrands, MeasureError};
use fsot::{Config, Extent, Kernel, Objective, SampleTable};

/// Ratios to white noise of the same shape: 1 is random, 0 is perfect.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    /// Squared error after the filter, mean over the families of test integrands.
    pub filtered: f64,
    /// The default objective with exact distances.
    pub bound: f64,
    /// Squared error of the mean over the whole table.
    pub bias: f64,
}

/// Measures tables of one shape: always the same filter, integrands and slices, so that differences have
/// little noise.
#[derive(Debug)]
pub struct Judge {
    kernel: Kernel,
    objective: Objective,
    integrands: Integrands,
    slices: usize,
}

impl Judge {
    /// Judges two-dimensional tables of this extent by the default kernel, without companions: by the
    /// objective of the papers.
    pub fn new(extent: Extent, integrands: usize, slices: usize) -> Result<Self, MeasureError> {
        let config = Config::new(extent, 2).with_companions(false);
        Ok(Self {
            kernel: config.kernels().remove(0),
            objective: Objective::new(&config)?,
            integrands: Integrands::random(2, integrands, 0)?,
            slices,
        })
    }

    /// Measures a table of the extent that was announced.
    pub fn judge(&self, table: &SampleTable) -> Result<Quality, MeasureError> {
        Ok(Quality {
            filtered: FilteredError::measure(table, &[0, 1], &self.integrands, &self.kernel)?
                .spatio_temporal
                .mean
                .mean,
            bound: Bound::measure(table, &self.objective, 0, self.slices)?.total.ratio_to_white_noise,
            bias: Bias::measure(table, &[0, 1], &self.integrands)?.table.mean.mean,
        })
    }
}
