//! One step of barycentric descent as the textbook writes it: dense loops over all samples, in `f64`.
//!
//! Shared with the engine are the slices and the law of a projection, which has tests of its own.

use fsot::classes::{Classes, FilterForm};
use fsot::config::{Domain, Role, Term};
use fsot::kernel::{SpatialKernel, TemporalKernel};
use fsot::objective::Slice;
use fsot::targets::Target;
use fsot::{Config, Extent, Site};

/// The first five taps of the perceptual kernel at 60 frames per second; the sixth is negative. From the
/// published table of Korać et al. 2023.
const PERCEPTUAL: [f64; 5] =
    [0.0395582850655909, 0.398409765599820, 0.404689211439515, 0.177879764807883, 0.0419136195197315];

/// Mean pull on every coordinate.
pub struct Pull {
    /// Mean displacement times the factor of the role; 0 where no slice held the coordinate.
    pub mean: Vec<f64>,
    /// Mass of the slices that held the coordinate.
    pub hits: Vec<f64>,
    /// By how much `mean` may change if projections that differ by less than `tie` change places.
    pub slack: Vec<f64>,
    /// Sum over slices and samples of mass times squared displacement, and of mass.
    pub squares: f64,
    /// See `squares`.
    pub mass: f64,
    /// Sizes of the subsets.
    pub sizes: Vec<usize>,
}

/// What these slices pull at the points. The displacements of descended terms are multiplied by the number of
/// dimensions of their group.
pub fn pull(config: &Config, slices: &[Slice], points: &[f32], tie: f64) -> Pull {
    let zeros = || vec![0.0; points.len()];
    let mut pull =
        Pull { mean: zeros(), hits: zeros(), slack: zeros(), squares: 0.0, mass: 0.0, sizes: Vec::new() };
    let mut subset = Vec::new();
    for (index, slice) in slices.iter().enumerate() {
        let term = &config.terms[slice.term];
        // The slices of one subset follow each other.
        let same = |other: &Slice| {
            (other.term, other.member, other.level) == (slice.term, slice.member, slice.level)
        };
        if index == 0 || !same(&slices[index - 1]) {
            subset = select(&config.extent, term, slice);
            pull.sizes.push(subset.len());
        }
        transport(config, term, slice, &subset, points, tie, &mut pull);
    }
    for coordinate in 0..points.len() {
        let hits = pull.hits[coordinate].max(f64::MIN_POSITIVE);
        pull.mean[coordinate] /= hits;
        pull.slack[coordinate] /= hits;
    }
    pull
}

/// Moves the points by `rate` times the pull, and back into their domains.
pub fn moved(config: &Config, points: &[f32], pull: &Pull, rate: f64) -> Vec<f64> {
    let coordinates = points.iter().zip(&pull.mean).enumerate();
    let moved = coordinates.map(|(coordinate, (&point, mean))| {
        let moved = f64::from(point) + rate * mean;
        match config.domains[coordinate % config.dims] {
            Domain::Interval => moved.clamp(0.0, 1.0),
            Domain::Torus => moved - moved.floor(),
        }
    });
    moved.collect()
}

/// Samples and masses of a slice's subset.
fn select(extent: &Extent, term: &Term, slice: &Slice) -> Vec<(usize, f64)> {
    let weight = weights(extent, term, slice.member);
    let mass = |sample: usize| {
        let weight = weight(extent.site(sample / extent.spp));
        match &term.classes {
            Classes::Lattice { kernel, .. } if weight < kernel.truncation => 0.0,
            Classes::Lattice { form: FilterForm::Weighted, .. } => weight,
            _ => f64::from(u8::from(weight > slice.level)),
        }
    };
    (0..extent.samples()).map(|sample| (sample, mass(sample))).filter(|&(_, mass)| mass > 0.0).collect()
}

/// The filter of a class: weights of sites, relative to the largest.
fn weights(extent: &Extent, term: &Term, member: usize) -> impl Fn(Site) -> f64 {
    let (t, y, x) = match &term.classes {
        Classes::WholeTable => (vec![1.0; extent.frames], vec![1.0; extent.height], vec![1.0; extent.width]),
        Classes::PerFrame => {
            let frame = (0..extent.frames).map(|frame| f64::from(u8::from(frame == member)));
            (frame.collect(), vec![1.0; extent.height], vec![1.0; extent.width])
        }
        Classes::Lattice { kernel, .. } => {
            let SpatialKernel::Gaussian { sigma_px } = kernel.spatial else { panic!("has no twin") };
            let centre = extent.site(member);
            let axis = |at: usize, len: usize| -> Vec<f64> {
                (0..len).map(|other| in_space(sigma_px, at.abs_diff(other), len)).collect()
            };
            let frames = extent.frames;
            let frame = (0..frames).map(|frame| in_time(&kernel.temporal, centre.frame, frame, frames));
            (frame.collect(), axis(centre.y, extent.height), axis(centre.x, extent.width))
        }
        other => panic!("{other:?} has no twin"),
    };
    move |site| t[site.frame] * y[site.y] * x[site.x]
}

/// Weight of a row or column `apart` pixels away, relative to that of the centre; each of its images on a
/// tile that wraps counts.
fn in_space(sigma: f64, apart: usize, len: usize) -> f64 {
    // Images more than 8 sigma away weigh less than 1e-27.
    let turns = (8.0 * sigma / len as f64) as i32 + 1;
    let images = |apart: f64| {
        let image = |turn: i32| (-((apart + f64::from(turn) * len as f64) / sigma).powi(2)).exp();
        (-turns..=turns).map(image).sum::<f64>()
    };
    images(apart as f64) / images(0.0)
}

/// Weight of a frame when the animation shows `now`, relative to that of the frame that weighs most.
fn in_time(kernel: &TemporalKernel, now: usize, frame: usize, frames: usize) -> f64 {
    let back = |k: usize| match kernel {
        TemporalKernel::None => f64::from(u8::from(k == 0)),
        TemporalKernel::Perceptual { fps: 60.0 } => PERCEPTUAL.get(k).copied().unwrap_or(0.0),
        TemporalKernel::Ema { alpha } => (1.0 - alpha).powi(k as i32),
        other => panic!("{other:?} has no twin"),
    };
    let images = |k: usize| (0..100).map(|turn| back(k + turn * frames)).sum::<f64>();
    let largest = (0..frames).map(images).fold(0.0, f64::max);
    images((now + frames - frame) % frames) / largest
}

/// Transports one slice and adds its displacements to the sums.
fn transport(
    config: &Config,
    term: &Term,
    slice: &Slice,
    subset: &[(usize, f64)],
    points: &[f32],
    tie: f64,
    pull: &mut Pull,
) {
    let coordinate = |sample: usize, i: usize| {
        let value = f64::from(points[sample * config.dims + term.dims[i]]);
        match config.domains[term.dims[i]] {
            Domain::Interval => value,
            Domain::Torus => (value - slice.cut[i]).rem_euclid(1.0),
        }
    };
    let along = |sample| (0..term.dims.len()).map(|i| coordinate(sample, i) * slice.direction[i]).sum();
    let mut sorted: Vec<(f64, usize, f64)> =
        subset.iter().map(|&(sample, mass)| (along(sample), sample, mass)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let law = Target::UniformCube.project(&slice.direction);
    let total: f64 = sorted.iter().map(|(.., mass)| mass).sum();
    let mut edges = vec![0.0];
    for (.., mass) in &sorted {
        edges.push(edges[edges.len() - 1] + mass / total);
    }
    let targets: Vec<f64> = match &term.classes {
        Classes::Lattice { form: FilterForm::Weighted, .. } => {
            edges.windows(2).map(|cell| law.cell_mean(cell[0], cell[1])).collect()
        }
        _ => law.cell_means(sorted.len()).collect(),
    };
    let factor = if term.role == Role::Descend { term.dims.len() as f64 } else { 1.0 };
    for (rank, &(projection, sample, mass)) in sorted.iter().enumerate() {
        // In whatever order a row of ties is taken, their targets stay between the two ends of their cells.
        let near = |&&(other, ..): &&(f64, usize, f64)| (other - projection).abs() <= tie;
        let after = sorted[rank + 1..].iter().take_while(near).count();
        let before = sorted[..rank].iter().rev().take_while(near).count();
        let slack = match after + before {
            0 => 0.0,
            _ => law.quantile(edges[rank + after + 1]) - law.quantile(edges[rank - before]),
        };
        pull.squares += mass * (targets[rank] - projection).powi(2);
        pull.mass += mass;
        for (&dim, &component) in term.dims.iter().zip(&slice.direction) {
            let at = sample * config.dims + dim;
            pull.mean[at] += factor * mass * (targets[rank] - projection) * component;
            pull.slack[at] += factor * mass * slack * component.abs();
            pull.hits[at] += mass;
        }
    }
}
