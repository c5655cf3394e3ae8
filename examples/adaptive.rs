//! A table for adaptive sampling: pixels may stop after 1, 2, 4 or all 8 of their samples.
//!
//! Tables of several samples are good when all of them are taken: the first of 8 is white noise.
//!
//! `cargo run --release --example adaptive` measures one, and with `-- adaptive.npy` writes it.

use fsot::classes::{ClassFamily, ClassSamples, Classes};
use fsot::config::{Role, Term};
use fsot::metrics::{FilteredError, Integrands};
use fsot::targets::Target;
use fsot::{Config, Extent, Kernel, SampleTable, Until};

/// Pixels of a tile, across and down; 64 and more for a renderer.
const SIDE: usize = 32;
const LENGTHS: [usize; 4] = [1, 2, 4, 8];

/// What a filter sees of pixels that have stopped early: one class per pixel and length.
#[derive(Debug)]
struct FirstSamples(Kernel);
impl ClassFamily for FirstSamples {
    fn name(&self) -> &str {
        "first samples under a filter"
    }
    fn members(&self, extent: &Extent) -> usize {
        extent.sites() * LENGTHS.len()
    }
    fn member(&self, extent: &Extent, member: usize) -> ClassSamples {
        let (site, length) = (extent.site(member / LENGTHS.len()), LENGTHS[member % LENGTHS.len()]);
        let taps = self.0.taps(extent).expect("the kernel was tried before");
        let samples = taps.iter().flat_map(|tap| {
            let near = extent.wrapped(site, (tap.dt.into(), tap.dy.into(), tap.dx.into()));
            let first = extent.site_index(near) * extent.spp;
            (first..first + length).map(|sample| (sample as u32, tap.weight))
        });
        ClassSamples { samples: samples.collect(), weight: 1.0 }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (extent, kernel) = (Extent::still(SIDE, SIDE).with_spp(8), Kernel::gaussian(2.1));
    kernel.taps(&extent)?;
    let of =
        |classes, weight, role| Term { classes, target: Target::UniformCube, dims: vec![0, 1], weight, role };
    let terms = vec![
        of(Classes::custom(FirstSamples(kernel.clone())), 1.0, Role::Descend),
        of(Classes::WholeTable, 0.03, Role::Balance),
    ];
    let adaptive = Config::new(extent, 2).with_terms(terms).optimize(Until::SlicesPerClass(400))?;
    let usual = Config::new(extent, 2).optimize(Until::Sweeps(60))?;

    let integrands = Integrands::random(2, 64, 0)?;
    let measure = |table: &SampleTable, spp| -> Result<f64, Box<dyn std::error::Error>> {
        let pixels = table.values().chunks_exact(2 * extent.spp);
        let first = pixels.flat_map(|pixel| &pixel[..2 * spp]).copied().collect();
        let table = SampleTable::new(Extent { spp, ..extent }, 2, first)?;
        Ok(FilteredError::measure(&table, &[0, 1], &integrands, &kernel)?.spatial.mean.mean)
    };
    println!("filtered error, of as many random samples");
    for length in LENGTHS {
        let (ours, usual) = (measure(&adaptive, length)?, measure(&usual, length)?);
        println!("first {length}: {ours:.3}; of a table for all 8 together: {usual:.3}");
        assert!(ours < if length == 1 { 0.3 } else { 0.2 });
        assert!(ours < usual || length == 8);
    }
    match std::env::args().nth(1) {
        Some(path) => Ok(adaptive.save(path)?),
        None => Ok(()),
    }
}
