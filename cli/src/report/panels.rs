//! What is seen of a table, or of white noise: pictures and points, without words.

use fsot::metrics::{RadialBin, Spectra};
use fsot::{Extent, Kernel, SampleTable, Site};
use ndarray::Array2;

use super::edge::{Edge, ordinary_half_plane};
use crate::Failure;
use crate::draw::raster::{Grey, grey};
use crate::inspect::evenness::Evenness;

/// Pixels per side that a picture has at most.
pub const LARGEST_SIDE: usize = 256;

/// Most samples of a whole frame that are shown: more would be solid ink.
const MOST_DOTS: usize = 4096;

/// All pictures of a dimension group of a table.
pub struct Panels {
    /// The first number of each pixel of the first frame.
    pub texture: Grey,
    /// Samples of neighbouring pixels.
    pub block: Dots,
    /// Samples of the first frame.
    pub frame: Dots,
    pub edge: Edge,
    /// Spectra of the error: black 0, grey 1, white 2.
    pub xy: Grey,
    /// Of animations.
    pub xt: Option<Grey>,
    pub radial: Vec<RadialBin>,
    /// Density over the square, the second dimension upwards; of two dimensions and enough samples.
    pub density: Option<Grey>,
}

/// Points of the unit square, the second coordinate upwards.
pub struct Dots {
    pub points: Vec<[f64; 2]>,
    /// Which samples these are.
    pub what: String,
}

impl Panels {
    pub fn new(
        table: &SampleTable,
        dims: &[usize],
        kernel: &Kernel,
        seed: u64,
        spectra: &Spectra,
    ) -> Result<Self, Failure> {
        let edge = ordinary_half_plane(dims.len(), seed)?;
        Ok(Self {
            texture: texture(table, dims, LARGEST_SIDE),
            block: block(table, dims),
            frame: frame(table, dims),
            edge: Edge::new(table, dims, &edge, kernel, LARGEST_SIDE)?,
            xy: spectrum(&spectra.xy, LARGEST_SIDE),
            xt: (table.extent().frames > 1).then(|| spectrum(&spectra.xt, LARGEST_SIDE)),
            radial: spectra.radial(),
            density: density(table, dims)?,
        })
    }
}

/// The first number of each pixel of the first frame.
pub fn texture(table: &SampleTable, dims: &[usize], largest_side: usize) -> Grey {
    let Extent { height, width, .. } = table.extent();
    let [columns, rows] = [width, height].map(|side| side.min(largest_side));
    let value = |x, y| f64::from(table.sample(Site { frame: 0, y, x }, 0)[dims[0]]);
    Grey::from_fn(columns, rows, |x, y| [grey(value(x, y))])
}

/// Whether frames are larger than their picture.
pub fn is_cut(picture: &Grey, table: &SampleTable) -> bool {
    let Extent { height, width, .. } = table.extent();
    [picture.width(), picture.height()] != [width, height]
}

/// Samples of a block of pixels: as many as can be told apart.
fn block(table: &SampleTable, dims: &[usize]) -> Dots {
    let Extent { height, width, spp, .. } = table.extent();
    let side = [8, 4, 2].into_iter().find(|side| side * side * spp <= 256).unwrap_or(1);
    let [rows, columns] = [height, width].map(|len| len.min(side));
    let points = dots(table, dims, (0..rows * columns).map(|i| (i / columns, i % columns)));
    let many = |count: usize| if count == 1 { "1 sample".into() } else { format!("{count} samples") };
    let what = format!("{} of {columns} × {rows} neighbouring pixels", many(points.len()));
    Dots { points, what }
}

/// Samples of the first frame.
pub fn frame(table: &SampleTable, dims: &[usize]) -> Dots {
    let Extent { height, width, spp, .. } = table.extent();
    let shown = (MOST_DOTS / spp).clamp(1, height * width);
    let points = dots(table, dims, (0..shown).map(|i| (i / width, i % width)));
    let all = height * width * spp;
    let what = match points.len() == all {
        true => format!("all {all} of the first frame"),
        false => format!("the first {} of the {all} of a frame", points.len()),
    };
    Dots { points, what }
}

/// In one dimension the order of the samples spreads them upwards.
fn dots(
    table: &SampleTable,
    dims: &[usize],
    pixels: impl ExactSizeIterator<Item = (usize, usize)>,
) -> Vec<[f64; 2]> {
    let spp = table.extent().spp;
    let total = (pixels.len() * spp) as f64;
    let samples = pixels.flat_map(|(y, x)| (0..spp).map(move |s| (Site { frame: 0, y, x }, s)));
    let place = |(i, (site, s)): (usize, (Site, usize))| {
        let sample = table.sample(site, s);
        let upwards = dims.get(1).map_or((i as f64 + 0.5) / total, |&dim| sample[dim].into());
        [sample[dims[0]].into(), upwards]
    };
    samples.enumerate().map(place).collect()
}

/// Black at 0, grey at 1, white from 2 on; what is larger than a picture is averaged.
pub fn spectrum(values: &Array2<f64>, largest_side: usize) -> Grey {
    let (height, width) = values.dim();
    let [down, across] = [height, width].map(|side| side.div_ceil(largest_side));
    Grey::from_fn(width.div_ceil(across), height.div_ceil(down), |column, row| {
        let rows = row * down..((row + 1) * down).min(height);
        let columns = column * across..((column + 1) * across).min(width);
        let count = rows.len() * columns.len();
        let sum: f64 = rows.flat_map(|y| columns.clone().map(move |x| values[[y, x]])).sum();
        [grey(0.5 * sum / count as f64)]
    })
}

fn density(table: &SampleTable, dims: &[usize]) -> Result<Option<Grey>, Failure> {
    let &[a, b, ..] = dims else { return Ok(None) };
    let evenness = Evenness::new(table, &[a, b])?;
    let side = evenness.per_side;
    let count = |x: usize, y: usize| evenness.counts[(side - 1 - y) * side + x];
    Ok((side > 1).then(|| Grey::from_fn(side, side, |x, y| [grey(0.5 * count(x, y))])))
}
