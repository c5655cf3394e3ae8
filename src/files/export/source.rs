//! C and C++: a header with an array and two functions, and the blue-noise textures of pbrt-v4[^pbrt].
//!
//! [^pbrt]: <https://github.com/mmp/pbrt-v4>, `src/pbrt/util/bluenoise.h`

use std::io::{self, Write};
use std::path::Path;

use super::encode::Encoded;
use super::options::Depth;
use super::parts::Part;
use crate::files::metadata::Hash;

/// Longest line of numbers.
const WIDTH: usize = 100;

/// The array of pbrt-v4.
pub(in crate::files) const PBRT_ARRAY: &str = "BlueNoiseTextures";

/// Numbers between braces, in lines that an editor can show.
struct Numbers<'a, W> {
    out: &'a mut W,
    line: Vec<u8>,
    is_float: bool,
}

impl<W: Write> Numbers<'_, W> {
    fn push(&mut self, values: &Encoded, at: usize) -> io::Result<()> {
        if self.is_float {
            write!(self.line, "{:?}f,", values.decoded(at))?;
        } else {
            write!(self.line, "{},", values.number(at))?;
        }
        if self.line.len() < WIDTH { Ok(()) } else { self.end_line() }
    }

    fn end_line(&mut self) -> io::Result<()> {
        if !self.line.is_empty() {
            self.line.push(b'\n');
            self.out.write_all(&self.line)?;
            self.line.clear();
        }
        Ok(())
    }
}

fn numbers<'a, W: Write>(out: &'a mut W, values: &Encoded) -> Numbers<'a, W> {
    Numbers { out, line: Vec::with_capacity(WIDTH + 32), is_float: values.depth.levels().is_none() }
}

/// What C can be called by: the file's name without its extension, in small letters, digits and single low
/// lines. `fsot_` comes before it, so that it may be a word of C or begin with a digit.
fn name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut name = String::new();
    for letter in stem.chars() {
        if letter.is_ascii_alphanumeric() {
            name.push(letter.to_ascii_lowercase());
        } else if !name.is_empty() && !name.ends_with('_') {
            // Two in a row are reserved in C++.
            name.push('_');
        }
    }
    let name = name.trim_end_matches('_');
    if name.is_empty() { "fsot_table".into() } else { format!("fsot_{name}") }
}

/// Tells tables apart whose files have names that become the same: compilers refuse two such headers in a
/// file, where an equal guard would leave the second out without a word.
fn digits(values: &Encoded, part: &Part) -> String {
    let mut hash = Hash::default();
    let shape = part.shape(values.extent());
    shape.iter().chain([&values.depth.bytes()]).for_each(|&length| hash.add(length as f32));
    for frame in part.frames.clone() {
        for y in 0..values.extent().height {
            let row = part.row(values.extent(), values.dims(), frame, y);
            row.for_each(|at| hash.add(values.decoded(at)));
        }
    }
    hash.digits()[..8].to_uppercase()
}

/// What the file is, above everything.
fn title(path: &Path, part: &Part, values: &Encoded) -> String {
    let [frames, height, width, spp, dims] = part.shape(values.extent());
    let name = path.file_name().unwrap_or_default().to_string_lossy().replace(char::is_control, "?");
    let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let [frames, samples, numbers] =
        [(frames, "frame"), (spp, "sample"), (dims, "number")].map(|(count, what)| counted(count, what));
    format!(
        "{name}: {frames} of {width} x {height} pixels with {samples} of {numbers} in [0, 1), by fsot {}.",
        env!("CARGO_PKG_VERSION")
    )
}

fn macros(out: &mut impl Write, name: &str, values: &Encoded, part: &Part) -> io::Result<()> {
    let lengths = part.shape(values.extent());
    for (axis, length) in ["FRAMES", "HEIGHT", "WIDTH", "SPP", "DIMS"].iter().zip(lengths) {
        writeln!(out, "#define {name}_{axis} {length}")?;
    }
    match values.depth.levels() {
        Some(levels) => writeln!(out, "#define {name}_LEVELS {levels}"),
        None => Ok(()),
    }
}

/// Writes a header for C99 and C++.
pub(super) fn write_header(
    out: &mut impl Write,
    path: &Path,
    values: &Encoded,
    part: &Part,
) -> io::Result<()> {
    let name = name(path);
    let upper = name.to_uppercase();
    let guard = format!("{upper}_{}_H", digits(values, part));
    let (kind, decoded) = match values.depth {
        Depth::U8 => ("uint8_t", "((float)k + 0.5f) / 256.0f"),
        Depth::U16 => ("uint16_t", "((float)k + 0.5f) / 65536.0f"),
        Depth::Half | Depth::F32 => ("float", "k"),
    };
    let count: usize = part.shape(values.extent()).iter().product();
    let parameters = "size_t frame, size_t y, size_t x, size_t sample, size_t dim";
    write!(
        out,
        "/* {title}\n *\n *     float u = {name}_sample(frame, y, x, sample, dim);\n *\n \
         * Every index wraps, as in a texture that repeats. */\n\
         #ifndef {guard}\n#define {guard}\n\n#include <stddef.h>\n#include <stdint.h>\n\n",
        title = title(path, part, values),
    )?;
    macros(out, &upper, values, part)?;
    write!(
        out,
        "\n/* Place of a number in {name}_values: [frame][y][x][sample][dim], the last varies fastest. */\n\
         static inline size_t {name}_index({parameters}) {{\n    \
             size_t at = frame % {upper}_FRAMES;\n    \
             at = at * {upper}_HEIGHT + y % {upper}_HEIGHT;\n    \
             at = at * {upper}_WIDTH + x % {upper}_WIDTH;\n    \
             at = at * {upper}_SPP + sample % {upper}_SPP;\n    \
             return at * {upper}_DIMS + dim % {upper}_DIMS;\n}}\n\n\
         static const {kind} {name}_values[{count}] = {{\n",
    )?;
    let mut numbers = numbers(out, values);
    for frame in part.frames.clone() {
        for y in 0..values.extent().height {
            let mut row = part.row(values.extent(), values.dims(), frame, y);
            row.try_for_each(|at| numbers.push(values, at))?;
        }
    }
    numbers.end_line()?;
    write!(
        out,
        "}};\n\n/* The number. */\n\
         static inline float {name}_sample({parameters}) {{\n    \
             {kind} k = {name}_values[{name}_index(frame, y, x, sample, dim)];\n    \
             return {decoded};\n}}\n\n\
         #endif\n",
    )
}

/// Writes a source text that takes the place of `src/pbrt/util/bluenoise.cpp`: `[texture][x][y]`, one texture
/// for each dimension of each sample of each frame.
pub(super) fn write_pbrt(out: &mut impl Write, path: &Path, values: &Encoded, part: &Part) -> io::Result<()> {
    let extent = values.extent();
    let [frames, height, width, spp, dims] = part.shape(extent);
    let textures = frames * spp * dims;
    let square = if width == height { "" } else { " Pbrt's own are square, and these are not." };
    write!(
        out,
        "// {title}\n//\n\
         // The blue-noise textures of pbrt-v4, [texture][x][y] with\n\
         //     texture = (frame * {spp} + sample) * {dims} + dim:\n\
         // in the place of src/pbrt/util/bluenoise.cpp, with the lengths below in bluenoise.h.{square}\n\
         // Level k stands for (k + 0.5) / 65536; pbrt takes k / 65535 for it, which is half a level off at \
         most.\n\
         // Elsewhere, define FSOT_STANDALONE.\n\n",
        title = title(path, part, values),
    )?;
    macros(out, "FSOT_BLUENOISE", values, part)?;
    write!(
        out,
        "\n#ifndef FSOT_STANDALONE\n\
         #include <pbrt/util/bluenoise.h>\n\
         namespace pbrt {{\n\
         static_assert(NumBlueNoiseTextures == {textures}, \"{textures} textures: set it in bluenoise.h\");\n\
         static_assert(BlueNoiseResolution == {width} && BlueNoiseResolution == {height},\n              \
                       \"{width} x {height} pixels: set it in bluenoise.h\");\n\
         PBRT_CONST\n\
         #else\n\
         #include <stdint.h>\n\
         namespace pbrt {{\n\
         extern const\n\
         #endif\n\
         uint16_t {PBRT_ARRAY}[{textures}][{width}][{height}] = {{\n",
    )?;
    let mut numbers = numbers(out, values);
    for frame in part.frames.clone() {
        for sample in part.samples.clone() {
            for dim in part.dims.clone() {
                numbers.out.write_all(b"{\n")?;
                for x in 0..width {
                    numbers.line.push(b'{');
                    for y in 0..height {
                        let site = (frame * height + y) * width + x;
                        numbers.push(values, (site * extent.spp + sample) * values.dims() + dim)?;
                    }
                    numbers.line.extend_from_slice(b"},");
                    numbers.end_line()?;
                }
                numbers.out.write_all(b"},\n")?;
            }
        }
    }
    out.write_all(b"};\n}  // namespace pbrt\n")
}
