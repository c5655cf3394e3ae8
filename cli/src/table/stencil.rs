//! Kernels of given weights: arrays of `.npy` files and rows of `.csv` files.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use fsot::kernel::{KernelError, check_fit};
use fsot::{Extent, Kernel};
use ndarray::{ArrayD, ArrayView3, Axis};
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
        self.whole().map_err(without_name)?;
        Ok(self)
    }

    /// The kernel, which has weights in time if there are frames.
    ///
    /// # Errors
    /// A kernel that is larger than the tile: what lies beyond its edges would come in again from the other
    /// side. Frames may be more than the animation has, which wraps.
    pub fn kernel(&self, extent: &Extent) -> Result<Kernel, String> {
        let [_, rows, columns] = self.shape;
        fits([rows, columns], extent)?;
        self.whole().map_err(without_name)
    }

    fn whole(&self) -> Result<Kernel, KernelError> {
        let weights = ArrayView3::from_shape(self.shape, &self.weights);
        let weights = weights.expect("as many weights as the axes say");
        match self.over_time {
            true => Kernel::from_frame_weights(weights),
            false => Kernel::from_weights(weights.index_axis_move(Axis(0), 0)),
        }
    }
}

/// Refuses more weights than the tile has pixels.
pub(super) fn fits(size: [usize; 2], extent: &Extent) -> Result<(), String> {
    check_fit(size, extent).map_err(|error| match error {
        KernelError::Oversized { rows, columns, height, width } => format!(
            "has {columns} × {rows} weights, more than the {width} × {height} pixels of a frame: \
             give a smaller kernel, or more --width and --height"
        ),
        other => without_name(other),
    })
}

/// What stands against it, without the name that it has in the library: here it has one of its own.
fn without_name(error: KernelError) -> String {
    let words = error.to_string();
    words.strip_prefix("the kernel ").unwrap_or(&words).into()
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
