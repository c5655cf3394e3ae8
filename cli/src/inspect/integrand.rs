//! The error of one integrand, as a picture before and after the filter.

use fsot::kernel::Tap;
use fsot::metrics::{ErrorImage, Family, Integrand, Integrands};
use fsot::{Extent, Kernel, SampleTable, Site};
use rayon::prelude::*;

use crate::Failure;

/// Pixels per side that a page has room for.
pub const LARGEST_SIDE: usize = 384;

/// Taps that are summed for a picture, within a second or so.
const MOST_WORK: usize = 60_000_000;

/// Error of the pixels in the upper left corner of the last frame.
pub struct ErrorPictures {
    pub columns: usize,
    /// Whether the frame is larger.
    pub cut: bool,
    pub raw: Vec<f64>,
    pub filtered: Vec<f64>,
    /// Standard deviation of a pixel of white noise, before and after the filter.
    pub white: [f64; 2],
}

impl ErrorPictures {
    pub fn new(
        table: &SampleTable,
        dims: &[usize],
        integrand: &Integrand,
        kernel: &Kernel,
    ) -> Result<Self, Failure> {
        let extent = table.extent();
        let Extent { frames, height, width, .. } = extent;
        let ErrorImage { errors, white_variance, .. } = ErrorImage::measure(table, dims, integrand)?;
        let taps = kernel.taps(&extent)?;
        let affordable = ((MOST_WORK / taps.len()) as f64).sqrt().max(1.0) as usize;
        let [rows, columns] = [height, width].map(|side| side.min(LARGEST_SIDE).min(affordable));
        let sum: f64 = taps.iter().map(|tap| tap.weight).sum();
        let frame = frames - 1;
        let sites = (0..rows * columns).map(|i| Site { frame, y: i / columns, x: i % columns });
        let raw = sites.clone().map(|site| errors[[site.frame, site.y, site.x]]).collect();
        let filtered_at = |site: Site| {
            let of_tap = |tap: &Tap| {
                let at = extent.wrapped(site, (tap.dt.into(), tap.dy.into(), tap.dx.into()));
                tap.weight / sum * errors[[at.frame, at.y, at.x]]
            };
            taps.iter().map(of_tap).sum::<f64>()
        };
        let filtered = sites.collect::<Vec<_>>().into_par_iter().map(filtered_at).collect();
        let single = white_variance.sqrt();
        let shrunk = taps.iter().map(|tap| (tap.weight / sum).powi(2)).sum::<f64>().sqrt();
        let cut = rows < height || columns < width;
        Ok(Self { columns, cut, raw, filtered, white: [single, single * shrunk] })
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
