//! Bare numbers, little-endian, in the order of the table; a text file beside them says which.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::encode::Encoded;
use super::parts::Part;
use crate::files::metadata::AXES;

/// First line of the text.
pub(in crate::files) const KIND: &str = "fsot raw 1";

/// Where the text lies: the path of the numbers, and `.txt`.
pub(in crate::files) fn text_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".txt");
    name.into()
}

/// Writes the numbers.
pub(super) fn write(out: &mut impl Write, values: &Encoded, part: &Part) -> io::Result<()> {
    let mut row = Vec::new();
    for frame in part.frames.clone() {
        for y in 0..values.extent().height {
            row.clear();
            values.extend_little(&mut row, part.row(values.extent(), values.dims(), frame, y));
            out.write_all(&row)?;
        }
    }
    Ok(())
}

/// What is to be known of the numbers, a line each: `key: value`.
pub(super) fn text(path: &Path, values: &Encoded, part: &Part) -> String {
    let shape = part.shape(values.extent());
    let [_, height, width, spp, dims] = shape;
    let depth = values.depth;
    let dtype = depth.dtype().to_string();
    let name = path.file_name().unwrap_or_default().to_string_lossy().replace(char::is_control, "?");
    let lengths = shape.map(|length| length.to_string()).join(", ");
    let index = format!("(((frame * {height} + y) * {width} + x) * {spp} + sample) * {dims} + dim");
    let letter = if depth.levels().is_some() { 'k' } else { 'v' };
    let bytes = shape.iter().product::<usize>() * depth.bytes();
    let mut text = String::new();
    for (key, value) in [
        ("file", name.clone()),
        ("bytes", bytes.to_string()),
        ("dtype", dtype.clone()),
        ("byte order", "little-endian".into()),
        ("axes", AXES.join(", ")),
        ("shape", lengths.clone()),
        ("order", "C, the last axis varies fastest".into()),
        ("index", format!("{letter} = number[{index}]")),
        ("decode", depth.decode_rule().into()),
        ("levels", depth.levels().map_or("none".into(), |levels| levels.to_string())),
        ("numpy", format!("numpy.fromfile({name:?}, {dtype:?}).reshape({lengths})")),
    ] {
        // Writing into a string cannot fail.
        let _ = writeln!(text, "{key}: {value}");
    }
    format!("{KIND}\n{text}")
}
