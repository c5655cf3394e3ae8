//! The error of one integrand, as a picture before and after the filter.

use fsot::kernel::Tap;
use fsot::metrics::{ErrorImage, Family, Integrand, Integrands};
use fsot::{Extent, Kernel, SampleTable, Site};
use rayon::prelude::*;

use crate::Failure;
use crate::draw::raster::{Grey, grey};

/// Taps that are summed for a picture, within a second or so.
const MOST_WORK: usize = 60_000_000;

/// Error of the pixels in the upper left corner of the last frame; grey is none.
pub struct Edge {
    /// Black and white are two standard deviations of white noise.
    pub before: Grey,
    /// Black and white are three standard deviations of what the filter leaves of white noise.
    pub after: Grey,
}

impl Edge {
    pub fn new(
        table: &SampleTable,
        dims: &[usize],
        integrand: &Integrand,
        kernel: &Kernel,
        largest_side: usize,
    ) -> Result<Self, Failure> {
        let extent = table.extent();
        let Extent { frames, height, width, .. } = extent;
        let ErrorImage { errors, white_variance, .. } = ErrorImage::measure(table, dims, integrand)?;
        let taps = kernel.taps(&extent)?;
        let affordable = ((MOST_WORK / taps.len()) as f64).sqrt().max(1.0) as usize;
        let [rows, columns] = [height, width].map(|side| side.min(largest_side).min(affordable));
        let sum: f64 = taps.iter().map(|tap| tap.weight).sum();
        let frame = frames - 1;
        let sites = (0..rows * columns).map(|i| Site { frame, y: i / columns, x: i % columns });
        let raw: Vec<f64> = sites.clone().map(|site| errors[[site.frame, site.y, site.x]]).collect();
        let filtered_at = |site: Site| {
            let of_tap = |tap: &Tap| {
                let at = extent.wrapped(site, (tap.dt.into(), tap.dy.into(), tap.dx.into()));
                tap.weight / sum * errors[[at.frame, at.y, at.x]]
            };
            taps.iter().map(of_tap).sum::<f64>()
        };
        let filtered: Vec<f64> = sites.collect::<Vec<_>>().into_par_iter().map(filtered_at).collect();
        let single = white_variance.sqrt();
        let shrunk = taps.iter().map(|tap| (tap.weight / sum).powi(2)).sum::<f64>().sqrt();
        let picture = |errors: &[f64], end: f64| {
            Grey::from_fn(columns, rows, |x, y| [grey(0.5 + 0.5 * errors[y * columns + x] / end)])
        };
        let (before, after) = (picture(&raw, 2.0 * single), picture(&filtered, 3.0 * single * shrunk));
        Ok(Self { before, after })
    }
}

/// A half-plane that covers about a third of the square: an ordinary edge, of no special symmetry.
pub fn ordinary_half_plane(dims: usize, seed: u64) -> Result<Integrand, Failure> {
    let integrands = Integrands::random(dims, 64, seed)?;
    let edges = integrands.family(Family::HALF_SPACE).unwrap_or_default().iter();
    let from_a_third = |edge: &Integrand| (edge.integral() - 0.35).abs();
    let ordinary = edges.min_by(|a, b| from_a_third(a).total_cmp(&from_a_third(b)));
    Ok(ordinary.ok_or("there is no half-plane to show")?.clone())
}
