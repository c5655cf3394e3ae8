//! Where the pixels of a file go, in whatever order they come: as they are, or averaged by area.

use std::path::{Path, PathBuf};

use super::exif::Orientation;
use super::options::PictureOptions;
use crate::error::{PictureError, TargetError};
use crate::targets::density::Density;

/// What has been made of the pixels of a file: number by number, each row by row from the top.
pub(in crate::targets) struct Raster<const N: usize> {
    pub size: [usize; 2],
    pub values: [Vec<f32>; N],
}

/// `N` numbers of every pixel, or their averages.
pub(super) struct Canvas<const N: usize, F> {
    path: PathBuf,
    size: [usize; 2],
    values: [Vec<f32>; N],
    /// What becomes of a pixel, or the number that stands against it.
    convert: F,
    /// `None`: pixel by pixel.
    averaging: Option<Averaging<N>>,
}

struct Averaging<const N: usize> {
    columns: Axis,
    rows: Axis,
    /// Shares of the row at hand.
    sums: Vec<[f64; N]>,
}

/// Pixels whose sides differ more are a slip.
const MOST_ASPECT: f64 = 64.0;
/// Resolutions are rounded, also those that are meant to be equal.
const SQUARE: f64 = 0.005;

impl<const N: usize, F: Fn([f32; 4]) -> Result<[f32; N], f32>> Canvas<N, F> {
    /// For a file of so many columns and rows, with pixels that are `aspect` times as wide as they are high.
    pub fn new(
        path: &Path,
        size: [usize; 2],
        aspect: f64,
        options: &PictureOptions,
        convert: F,
    ) -> Result<Self, PictureError> {
        check_size(path, size, options)?;
        if !(MOST_ASPECT.recip()..=MOST_ASPECT).contains(&aspect) {
            return Err(PictureError::Aspect { path: path.into(), aspect });
        }
        let coarse = coarser(size, aspect, options.most_pixels);
        Density::check_size(coarse)
            .map_err(|problem| PictureError::Density { path: path.into(), problem })?;
        let values = zeros(path, coarse[0] * coarse[1])?;
        let averaging = (coarse != size).then(|| Averaging {
            columns: Axis::new(size[0], coarse[0]),
            rows: Axis::new(size[1], coarse[1]),
            sums: vec![[0.0; N]; coarse[0]],
        });
        Ok(Self { path: path.into(), size: coarse, values, convert, averaging })
    }

    /// Whether such pixels leave no trace.
    pub fn is_nothing(&self, pixel: [f32; 4]) -> bool {
        (self.convert)(pixel) == Ok([0.0; N])
    }

    /// Pixels of row `row`: those at `first`, `first + step`, ...; red, green, blue, multiplied by alpha, and
    /// alpha. Each pixel may come once.
    pub fn put(
        &mut self,
        row: usize,
        [first, step]: [usize; 2],
        pixels: &[[f32; 4]],
    ) -> Result<(), PictureError> {
        let Self { path, size, values, convert, averaging } = self;
        let convert = |x: usize, pixel: &[f32; 4]| {
            convert(*pixel).map_err(|value| {
                let problem = TargetError::BadDensity { x, y: row, value: value.into() };
                PictureError::Density { path: path.clone(), problem }
            })
        };
        let placed = (first..).step_by(step).zip(pixels);
        let Some(Averaging { columns, rows, sums }) = averaging else {
            for (x, pixel) in placed {
                let numbers = convert(x, pixel)?;
                values
                    .iter_mut()
                    .zip(numbers)
                    .for_each(|(values, number)| values[row * size[0] + x] = number);
            }
            return Ok(());
        };
        for (x, pixel) in placed {
            let numbers = convert(x, pixel)?.map(f64::from);
            for &(column, share) in columns.parts(x) {
                sums[column as usize]
                    .iter_mut()
                    .zip(numbers)
                    .for_each(|(sum, number)| *sum += share * number);
            }
        }
        for &(row, share) in rows.parts(row) {
            for (number, values) in values.iter_mut().enumerate() {
                let values = &mut values[row as usize * size[0]..][..size[0]];
                values
                    .iter_mut()
                    .zip(&*sums)
                    .for_each(|(value, sums)| *value += (share * sums[number]) as f32);
            }
        }
        sums.fill([0.0; N]);
        Ok(())
    }

    /// What the file has come to, turned as it is to be seen.
    pub fn finish(self, orientation: Orientation) -> Result<Raster<N>, PictureError> {
        let Self { path, size, values, .. } = self;
        if orientation == Orientation::default() {
            return Ok(Raster { size, values });
        }
        let [width, height] = orientation.size(size);
        let mut turned = zeros(&path, width * height)?;
        for (turned, values) in turned.iter_mut().zip(values) {
            for (index, turned) in turned.iter_mut().enumerate() {
                let [x, y] = orientation.source([index % width, index / width], size);
                *turned = values[y * size[0] + x];
            }
        }
        Ok(Raster { size: [width, height], values: turned })
    }
}

/// Memory for `count` pixels, or a refusal.
fn zeros<const N: usize>(path: &Path, count: usize) -> Result<[Vec<f32>; N], PictureError> {
    let mut all = [const { Vec::new() }; N];
    for values in &mut all {
        reserve(path, values, count)?;
        values.resize(count, 0.0);
    }
    Ok(all)
}

/// Makes room for `count` more, or refuses.
pub(super) fn reserve<T>(path: &Path, list: &mut Vec<T>, count: usize) -> Result<(), PictureError> {
    let bytes = count.saturating_mul(size_of::<T>());
    list.try_reserve_exact(count).map_err(|_| PictureError::Memory { path: path.into(), bytes })
}

/// Refuses what a file says of its size before memory is set aside for it.
pub(super) fn check_size(
    path: &Path,
    [width, height]: [usize; 2],
    options: &PictureOptions,
) -> Result<(), PictureError> {
    Density::check_size([width, height])
        .map_err(|problem| PictureError::Density { path: path.into(), problem })?;
    let most = options.limit_pixels;
    if width.saturating_mul(height) > most {
        return Err(PictureError::TooLarge { path: path.into(), width, height, most });
    }
    Ok(())
}

/// Columns and rows of square pixels, at most `most` in all, that stand for those of a file.
fn coarser([width, height]: [usize; 2], aspect: f64, most: Option<usize>) -> [usize; 2] {
    let most = most.map_or(usize::MAX, |most| most.max(1));
    let is_square = (aspect - 1.0).abs() <= SQUARE;
    let seen = match aspect {
        _ if is_square => [width, height],
        // Stretched, so that nothing is lost.
        1.0.. => [(width as f64 * aspect).round() as usize, height],
        _ => [width, (height as f64 / aspect).round() as usize],
    };
    let pixels = seen[0].saturating_mul(seen[1]);
    if pixels <= most {
        return seen;
    }
    let ratio = (pixels as f64 / most as f64).sqrt();
    let whole =
        (ratio.ceil() as usize..).take_while(|times| times * times * most <= 2 * pixels).find(|&times| {
            seen.iter().all(|side| side.is_multiple_of(times)) && pixels / (times * times) <= most
        });
    if let Some(times) = whole {
        return seen.map(|side| side / times);
    }
    // The shorter side is rounded, the longer one follows: its error is the smaller part of it.
    let [longer, shorter] = [seen[0].max(seen[1]), seen[0].min(seen[1])];
    let mut short = ((shorter as f64 / ratio) as usize).max(1);
    let mut long = (longer as f64 * short as f64 / shorter as f64).round() as usize;
    while short > 1 && short * long > most {
        short -= 1;
        long = (longer as f64 * short as f64 / shorter as f64).round() as usize;
    }
    long = long.min(most / short).max(1);
    if seen[0] == longer { [long, short] } else { [short, long] }
}

/// Which pixels along a side each pixel of the file falls on, with its share of each of them.
struct Axis {
    /// Where the parts of each pixel begin, and where the last ones end.
    starts: Vec<u32>,
    parts: Vec<(u32, f64)>,
}

impl Axis {
    fn new(fine: usize, coarse: usize) -> Self {
        // In units in which a pixel of the file is `coarse` long and a pixel of the picture `fine`.
        let mut starts = Vec::with_capacity(fine + 1);
        let mut parts = Vec::with_capacity(fine + coarse);
        for start in (0..fine).map(|pixel| pixel * coarse) {
            starts.push(parts.len() as u32);
            let end = start + coarse;
            for part in start / fine..=(end - 1) / fine {
                let length = end.min((part + 1) * fine) - start.max(part * fine);
                parts.push((part as u32, length as f64 / fine as f64));
            }
        }
        starts.push(parts.len() as u32);
        Self { starts, parts }
    }

    fn parts(&self, pixel: usize) -> &[(u32, f64)] {
        &self.parts[self.starts[pixel] as usize..self.starts[pixel + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarser_sizes_keep_shape_and_limit() {
        let most = 1 << 22;
        let size = |size| coarser(size, 1.0, Some(most));
        assert_eq!(size([2048, 2048]), [2048, 2048]);
        // A camera's 24 megapixels; maps of a sky, in whole boxes.
        assert_eq!(size([6000, 4000]), [2508, 1672]);
        assert_eq!(size([4096, 2048]), [2048, 1024]);
        assert_eq!(size([8192, 4096]), [2048, 1024]);
        for (width, height) in [(2049, 2048), (65535, 2047), (65535, 65), (64, 65535), (12_345, 6789)] {
            let [columns, rows] = size([width, height]);
            assert!(columns * rows <= most && columns * rows >= most / 2, "{columns} x {rows}");
            let shape = (width * rows) as f64 / (height * columns) as f64;
            assert!((shape - 1.0).abs() < 0.001, "{width} x {height}: {shape}");
        }
        assert_eq!(coarser([65535, 1], 1.0, Some(7)), [7, 1]);
        assert_eq!(coarser([3, 5], 1.0, Some(0)), [1, 1]);
        assert_eq!(coarser([9000, 9000], 1.0, None), [9000, 9000]);
        assert_eq!(coarser([30, 20], 2.0, None), [60, 20]);
        assert_eq!(coarser([30, 20], 0.5, Some(1200)), [30, 40]);
        assert_eq!(coarser([30, 20], 1.004, None), [30, 20]);
    }

    #[test]
    fn shares_add_up() {
        for (fine, coarse) in [(7, 3), (3, 7), (65535, 4096), (5, 5), (6, 2), (1, 9), (9, 1)] {
            let axis = Axis::new(fine, coarse);
            let mut sums = vec![0.0; coarse];
            for pixel in 0..fine {
                let parts = axis.parts(pixel);
                parts.iter().for_each(|&(part, share)| sums[part as usize] += share);
                let whole: f64 = parts.iter().map(|part| part.1).sum();
                assert!((whole - coarse as f64 / fine as f64).abs() < 1e-12, "{fine} to {coarse}");
            }
            assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-9), "{fine} to {coarse}");
        }
    }
}
