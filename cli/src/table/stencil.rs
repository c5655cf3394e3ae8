//! Kernels of given weights: arrays of `.npy` files and rows of `.csv` files.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use fsot::Extent;
use fsot::config::Short;
use fsot::kernel::{SpatialKernel, SpatialTap, TemporalKernel};
use ndarray::ArrayD;
use ndarray_npy::{ReadNpyError, ReadNpyExt, ReadableElement};

use crate::output::has_ending;

/// Weights `[frame, y, x]`, the current frame first. An odd side is centred on the pixel that is filtered, an
/// even one reaches one pixel further right and down.
#[derive(Clone, Debug, PartialEq)]
pub struct Stencil {
    shape: [usize; 3],
    weights: Vec<f64>,
    /// Whether there are frames, be it one.
    pub over_time: bool,
}

/// An array that was read; `None` if its numbers are of another type.
type Attempt = Option<Result<ArrayD<f64>, String>>;

/// More bytes hold more weights than a tile has pixels.
const MOST_BYTES: u64 = 1 << 28;

impl Stencil {
    /// Reads a `.npy` file of two axes `[y, x]` or three `[frame, y, x]`, or the rows of a `.csv` file.
    ///
    /// # Errors
    /// What stands against it, without the name of the file.
    pub fn open(path: &Path) -> Result<Self, String> {
        const ADVICE: &str = "check the path and its permissions";
        let about = fs::metadata(path).map_err(|error| format!("cannot be read: {error}; {ADVICE}"))?;
        // Before opening, because opening a pipe waits for its writer.
        if !about.is_file() {
            return Err("is not an ordinary file: give a .npy or .csv file".into());
        }
        if about.len() > MOST_BYTES {
            return Err(format!("has {} bytes: give a kernel of at most {MOST_BYTES}", about.len()));
        }
        if has_ending(path, "csv") {
            return Self::of_csv(path);
        }
        if !has_ending(path, "npy") {
            return Err("may be anything: give a file name that ends in .npy or .csv".into());
        }
        let open = || File::open(path).map(BufReader::new).map_err(|error| format!("{error}; {ADVICE}"));
        let readers: [fn(BufReader<File>) -> Attempt; 10] = [
            read::<f64>,
            read::<f32>,
            read::<u8>,
            read::<i8>,
            read::<u16>,
            read::<i16>,
            read::<u32>,
            read::<i32>,
            read_wide::<i64>,
            read_wide::<u64>,
        ];
        for reader in readers {
            if let Some(array) = reader(open()?) {
                return Self::of_array(&array?);
            }
        }
        Err("holds no plain numbers: save it with numpy.save(path, kernel.astype('float64'))".into())
    }

    /// Rows of equal lengths.
    pub fn of_rows(rows: Vec<Vec<f64>>) -> Result<Self, String> {
        let columns = rows.first().map_or(0, Vec::len);
        if let Some(row) = rows.iter().position(|row| row.len() != columns) {
            let given = rows[row].len();
            return Err(format!(
                "row {} has {given} weights, but row 1 has {columns}: \
                 give rows of equal lengths",
                row + 1
            ));
        }
        let shape = [1, rows.len(), columns];
        Self { shape, weights: rows.concat(), over_time: false }.checked()
    }

    fn of_csv(path: &Path) -> Result<Self, String> {
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_path(path);
        let mut rows = Vec::new();
        let unreadable = |error: csv::Error| format!("cannot be read: {error}; write rows of numbers");
        for record in reader.map_err(unreadable)?.records() {
            let record = record.map_err(unreadable)?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |text: &str| {
                text.parse::<f64>().map_err(|_| {
                    format!("line {line} has '{text}' among its numbers: write weights between commas")
                })
            };
            rows.push(record.iter().map(number).collect::<Result<Vec<f64>, _>>()?);
        }
        Self::of_rows(rows)
    }

    fn of_array(array: &ArrayD<f64>) -> Result<Self, String> {
        let (shape, over_time) = match *array.shape() {
            [rows, columns] => ([1, rows, columns], false),
            [frames, rows, columns] => ([frames, rows, columns], true),
            ref other => {
                return Err(format!("has shape {other:?}: give two axes [y, x] or three [frame, y, x]"));
            }
        };
        Self { shape, weights: array.iter().copied().collect(), over_time }.checked()
    }

    fn checked(self) -> Result<Self, String> {
        let [_, rows, columns] = self.shape;
        if self.weights.is_empty() {
            return Err("holds no weights: give at least one above 0".into());
        }
        let is_weight = |weight: &f64| weight.is_finite() && *weight >= 0.0;
        if let Some(at) = self.weights.iter().position(|weight| !is_weight(weight)) {
            let (weight, x, y, frame) =
                (Short::from(self.weights[at]), at % columns, at / columns % rows, at / columns / rows);
            let frame = if self.over_time { format!("frame {frame}, ") } else { String::new() };
            return Err(format!(
                "has weight {weight} at [{frame}y {y}, x {x}]: \
                 weights must be finite and at least 0"
            ));
        }
        let sum: f64 = self.weights.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(format!(
                "has weights whose sum is {}: give a sum that is above 0 and finite",
                Short::from(sum)
            ));
        }
        Ok(self)
    }

    /// The kernel in space, and that in time if there are frames.
    ///
    /// # Errors
    /// A kernel that is larger than the tile: what lies beyond its edges would come in again from the other
    /// side. Frames may be more than the animation has, which wraps.
    pub fn kernel(&self, extent: &Extent) -> Result<(SpatialKernel, Option<TemporalKernel>), String> {
        let [_, rows, columns] = self.shape;
        fits(rows, columns, extent)?;
        let first = |size: usize| (size as i32 - 1) / 2;
        let offset =
            |at: usize| ((at / columns) as i32 - first(rows), (at % columns) as i32 - first(columns));
        let taps = |weights: &mut dyn Iterator<Item = f64>| -> Vec<SpatialTap> {
            let all = weights.enumerate().map(|(at, weight)| (offset(at), weight));
            let some = all.filter(|(_, weight)| *weight > 0.0);
            some.map(|((dy, dx), weight)| SpatialTap { dy, dx, weight }).collect()
        };
        let frames: Vec<&[f64]> = self.weights.chunks_exact(rows * columns).collect();
        if !self.over_time {
            return Ok((SpatialKernel::Taps(taps(&mut frames[0].iter().copied())), None));
        }
        let sums: Vec<f64> = frames.iter().map(|weights| weights.iter().sum()).collect();
        // What stands for a frame that weighs nothing, where it is looked at alone.
        let mut together = BTreeMap::new();
        for (at, weight) in frames.iter().flat_map(|weights| weights.iter().enumerate()) {
            *together.entry(at).or_insert(0.0) += weight;
        }
        let in_space = frames.iter().zip(&sums).map(|(weights, &sum)| match sum {
            0.0 => taps(&mut together.values().copied()),
            _ => taps(&mut weights.iter().map(|weight| weight / sum)),
        });
        let in_space = in_space.collect();
        Ok((SpatialKernel::PerFrame(in_space), Some(TemporalKernel::Taps(sums))))
    }
}

/// Refuses more weights than the tile has pixels.
pub(super) fn fits(rows: usize, columns: usize, extent: &Extent) -> Result<(), String> {
    let Extent { height, width, .. } = *extent;
    if rows <= height && columns <= width {
        return Ok(());
    }
    Err(format!(
        "has {columns} × {rows} weights, more than the {width} × {height} pixels of a frame: \
         give a smaller kernel, or more --width and --height"
    ))
}

/// The array, if its numbers are of this type.
fn read<T: ReadableElement + Into<f64> + Copy>(file: BufReader<File>) -> Attempt {
    of_type(file, |value: T| value.into())
}

/// The same for those that round.
fn read_wide<T: ReadableElement + TryInto<i128> + Copy>(file: BufReader<File>) -> Attempt {
    of_type(file, |value: T| value.try_into().map_or(f64::NAN, |value: i128| value as f64))
}

fn of_type<T: ReadableElement + Copy>(file: BufReader<File>, number: impl Fn(T) -> f64) -> Attempt {
    match ArrayD::<T>::read_npy(file) {
        Ok(array) => Some(Ok(array.mapv(number))),
        Err(ReadNpyError::WrongDescriptor(_)) => None,
        Err(error) => Some(Err(format!("cannot be read: {error}; save it again with numpy.save"))),
    }
}
