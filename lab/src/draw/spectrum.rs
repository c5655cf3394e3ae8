//! Spectra as pictures and tables on disk.

use std::io;
use std::path::Path;

use fsot::files::{TableError, WholeFile};
use fsot::metrics::RadialBin;
use fsot_cli::draw::raster::Grey;
use ndarray::Array2;

use crate::figures::write_csv;

/// An 8-bit gray picture of an array, one pixel per entry: 0 is black, `white` and everything above is white,
/// linear between. NaN is black.
///
/// For a spectrum, `white = 4` shows white noise as the gray 64 and keeps peaks apart from it.
pub fn gray(values: &Array2<f64>, white: f64) -> Grey {
    let (height, width) = values.dim();
    // The cast saturates, and makes 0 of NaN.
    Grey::from_fn(width, height, |x, y| [(255.0 * values[[y, x]] / white).round() as u8])
}

/// Writes [`gray`] as a PNG file, which appears whole or not at all.
///
/// # Errors
/// The file cannot be written.
pub fn write_gray_png(path: &Path, values: &Array2<f64>, white: f64) -> Result<(), TableError> {
    gray(values, white).write_png(path).map_err(|source| unwritten(path, source))
}

/// Writes a radial average as CSV with the columns `frequency_cycles_per_px,power,count`, over an existing
/// file; it appears whole or not at all.
///
/// # Errors
/// The file cannot be written.
pub fn write_radial_csv(path: &Path, bins: &[RadialBin]) -> Result<(), TableError> {
    let columns = ["frequency_cycles_per_px", "power", "count"];
    let row = |bin: &RadialBin| {
        [format!("{:.6}", bin.frequency), format!("{:.6e}", bin.power), format!("{}", bin.count)]
    };
    WholeFile::write(path, |out| write_csv(out, columns, bins.iter().map(row)))
        .and_then(WholeFile::commit)
        .map_err(|source| unwritten(path, source))
}

fn unwritten(path: &Path, source: io::Error) -> TableError {
    TableError::Io { verb: "write", path: path.to_owned(), source }
}

#[cfg(test)]
mod tests {
    use fsot::metrics::Spectra;
    use ndarray::array;

    use super::*;

    #[test]
    fn pictures_clip_at_black_and_white_and_come_back_from_disk() {
        let values = array![[0.0, 1.0, 4.0], [5.0, -1.0, f64::NAN]];
        let picture = gray(&values, 4.0);
        assert_eq!([picture.width(), picture.height()], [3, 2]);
        assert_eq!(picture.samples(), &[0, 64, 255, 255, 0, 0]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("spectrum.png");
        write_gray_png(&path, &values, 4.0).unwrap();
        assert_eq!(image::open(&path).unwrap().as_luma8().unwrap().as_raw(), picture.samples());
    }

    #[test]
    fn radial_averages_are_three_columns() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("radial.csv");
        // All power of a checkerboard of variance 1/4 is at one of its three frequencies. Of length 1/2, 1/2
        // and 1/√2, they are one ring.
        let checkerboard = array![[[0.5, -0.5], [-0.5, 0.5]]];
        write_radial_csv(&path, &Spectra::of_image(checkerboard.view(), 0.25).radial()).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let lines = ["frequency_cycles_per_px,power,count", "0.569036,1.333333e0,3", ""];
        assert_eq!(text.split('\n').collect::<Vec<_>>(), lines);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing").join("file");
        for error in [
            write_gray_png(&path, &array![[1.0]], 4.0).unwrap_err(),
            write_radial_csv(&path, &[]).unwrap_err(),
        ] {
            assert!(error.to_string().contains("missing"), "{error}");
        }
    }
}
