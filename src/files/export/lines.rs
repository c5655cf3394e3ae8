//! Text with one sample a line, in the order of the table: `.csv` with names of columns, and `.dat` without,
//! as the published codes write it.

use std::io::{self, Write};

use super::encode::Encoded;
use super::parts::Part;

/// Writes the samples with this between numbers. Each number is as short as tells it from all other `f32`.
pub(super) fn write(
    out: &mut impl Write,
    values: &Encoded,
    part: &Part,
    between: &str,
    names: bool,
) -> io::Result<()> {
    let [_, height, _, _, dims] = part.shape(values.extent());
    let end = |dim: usize| if dim + 1 == dims { "\n" } else { between };
    if names {
        (0..dims).try_for_each(|dim| write!(out, "dim{dim}{}", end(dim)))?;
    }
    for frame in part.frames.clone() {
        for y in 0..height {
            for (i, at) in part.row(values.extent(), values.dims(), frame, y).enumerate() {
                write!(out, "{:?}{}", values.decoded(at), end(i % dims))?;
            }
        }
    }
    Ok(())
}
