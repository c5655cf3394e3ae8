//! What several tests need.

use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::metrics::{FilteredError, Integrands, Spectra};
use fsot::{Extent, Kernel, SampleTable, Site};
use fsot_lab::samplers::Sampler;

pub fn tile(frames: usize, side: usize, spp: usize) -> Extent {
    Extent { frames, height: side, width: side, spp }
}

/// All dimensions of the table.
pub fn all(table: &SampleTable) -> Vec<usize> {
    (0..table.dims()).collect()
}

/// Share of the power of white noise below 0.1 cycles per pixel.
pub fn low(table: &SampleTable) -> f64 {
    let integrands = Integrands::random(table.dims(), 16, 11).unwrap();
    Spectra::measure(table, &all(table), &integrands).unwrap().low_frequency_share(0.1)
}

pub fn gaussian() -> Kernel {
    Kernel::product(SpatialKernel::Gaussian { sigma_px: 2.1 }, TemporalKernel::None)
}

/// Squared error before the filter, after it in space, after all of it; 1 for white noise.
pub fn errors(table: &SampleTable, kernel: &Kernel, per_family: usize) -> [f64; 3] {
    let integrands = Integrands::random(table.dims(), per_family, 0).unwrap();
    let found = FilteredError::measure(table, &all(table), &integrands, kernel).unwrap();
    [found.unfiltered, found.spatial, found.spatio_temporal].map(|ratios| ratios.mean.mean)
}

/// What a sampler gives, as a table.
pub fn tabulated(sampler: &dyn Sampler, extent: Extent, dims: usize) -> SampleTable {
    let mut values = Vec::new();
    for index in 0..extent.sites() {
        let site: Site = extent.site(index);
        for sample in 0..extent.spp as u32 {
            values.extend((0..dims as u32).map(|dim| sampler.sample(site, sample, dim)));
        }
    }
    SampleTable::new(extent, dims, values).unwrap()
}
