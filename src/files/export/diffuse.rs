//! Levels whose rounding errors cancel in the neighbourhood.
//!
//! By `floor` the rounding errors of neighbours are independent of each other, and a filter leaves of them
//! what it leaves of white noise. Here some values of each level take the next one, and as many of the next
//! one that level, so that as many have each level as before; chosen are those pairs that lower the energy
//! `Σ_pixels (kernel * error)²` of each dimension and frame, with the Gaussian of the eye for kernel. A pair
//! is exchanged once, and only across a border that is a quarter of a level away from both at most, so that
//! no error exceeds three quarters of one.

use crate::table::SampleTable;
use crate::table::extent::Extent;

/// Width of the Gaussian `exp(-r²/σ²)`, in pixels.
const SIGMA_PX: f32 = 2.1;

/// What is farther apart counts as independent: the autocorrelation is below 1/50 of its peak there.
const REACH_PX: i64 = 6;

/// The levels of a table, in the order of its values. Asked before each frame, `stops` may break that off;
/// what comes then is worth nothing.
pub(super) fn levels(table: &SampleTable, levels: u32, stops: &mut dyn FnMut() -> bool) -> Vec<u16> {
    let scale = levels as f32;
    let mut found: Vec<u16> = table.values().iter().map(|value| (value * scale) as u16).collect();
    let Extent { frames, height, width, .. } = table.extent();
    let mut field = Field::new(height, width);
    for dim in 0..table.dims() {
        for frame in 0..frames {
            if stops() {
                return found;
            }
            diffuse(table, &mut found, scale, frame, dim, &mut field);
        }
    }
    found
}

/// The autocorrelation of the kernel over a frame, and the errors of one dimension filtered by it.
struct Field {
    height: usize,
    width: usize,
    taps: Vec<(i64, i64, f32)>,
    values: Vec<f32>,
}

impl Field {
    fn new(height: usize, width: usize) -> Self {
        // As far as the frame goes once.
        let reach = |len: usize| REACH_PX.min((len as i64 - 1) / 2);
        let taps = (-reach(height)..=reach(height)).flat_map(|dy| {
            (-reach(width)..=reach(width)).map(move |dx| {
                let distance_sq = (dy * dy + dx * dx) as f32;
                (dy, dx, (-distance_sq / (2.0 * SIGMA_PX * SIGMA_PX)).exp())
            })
        });
        Self { height, width, taps: taps.collect(), values: vec![0.0; height * width] }
    }

    /// Adds an error at a pixel.
    fn add(&mut self, pixel: usize, error: f32) {
        let Self { height, width, taps, values } = self;
        let (y, x) = ((pixel / *width) as i64, (pixel % *width) as i64);
        for (dy, dx, weight) in taps {
            let y = (y + *dy).rem_euclid(*height as i64) as usize;
            let x = (x + *dx).rem_euclid(*width as i64) as usize;
            values[y * *width + x] += *weight * error;
        }
    }

    /// Between two pixels.
    fn correlation(&self, first: usize, second: usize) -> f32 {
        let apart = |first: usize, second: usize, len: usize| {
            let apart = first.abs_diff(second);
            apart.min(len - apart) as f32
        };
        let dy = apart(first / self.width, second / self.width, self.height);
        let dx = apart(first % self.width, second % self.width, self.width);
        (-(dy * dy + dx * dx) / (2.0 * SIGMA_PX * SIGMA_PX)).exp()
    }
}

/// A value near a border of levels: its position in the table and its pixel in the frame.
#[derive(Clone, Copy)]
struct Candidate {
    at: usize,
    pixel: usize,
}

fn diffuse(table: &SampleTable, levels: &mut [u16], scale: f32, frame: usize, dim: usize, field: &mut Field) {
    let Extent { height, width, spp, .. } = table.extent();
    let (dims, pixels) = (table.dims(), height * width);
    field.values.fill(0.0);
    let borders = scale as usize;
    // Those that may rise from a level to the next, and those that may fall from the next to it.
    let (mut rising, mut falling) = (vec![Vec::new(); borders], vec![Vec::new(); borders]);
    for pixel in 0..pixels {
        for sample in 0..spp {
            let at = ((frame * pixels + pixel) * spp + sample) * dims + dim;
            let (value, level) = (table.values()[at] * scale, levels[at]);
            let error = f32::from(level) + 0.5 - value;
            field.add(pixel, error);
            // A quarter of a level from the border at most, so that no error exceeds three quarters.
            if error.abs() < 0.25 {
                continue;
            }
            match (error < 0.0, usize::from(level)) {
                (true, level) => rising[level].push(Candidate { at, pixel }),
                (false, level) if level > 0 => falling[level - 1].push(Candidate { at, pixel }),
                _ => {}
            }
        }
    }
    for (rising, falling) in rising.iter_mut().zip(&mut falling) {
        while let Some((up, down)) = best(rising, falling, field) {
            let (up, down) = (rising.swap_remove(up), falling.swap_remove(down));
            levels[up.at] += 1;
            levels[down.at] -= 1;
            field.add(up.pixel, 1.0);
            field.add(down.pixel, -1.0);
        }
    }
}

/// The pair whose exchange lowers the energy, of those that have the lowest and the highest field.
fn best(rising: &[Candidate], falling: &[Candidate], field: &Field) -> Option<(usize, usize)> {
    let of = |candidate: &Candidate| field.values[candidate.pixel];
    let up = (0..rising.len()).min_by(|&a, &b| of(&rising[a]).total_cmp(&of(&rising[b])))?;
    let down = (0..falling.len()).max_by(|&a, &b| of(&falling[a]).total_cmp(&of(&falling[b])))?;
    let own = 1.0 - field.correlation(rising[up].pixel, falling[down].pixel);
    (of(&rising[up]) - of(&falling[down]) + own < 0.0).then_some((up, down))
}
