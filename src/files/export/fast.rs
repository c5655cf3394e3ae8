//! Four `f32` a texel, little-endian, `(z * height + y) * width + x`, without a header: what FAST[^fast]
//! reads as `-init`.
//!
//! [^fast]: <https://github.com/electronicarts/fastnoise>

use std::io::{self, Write};

use super::encode::Encoded;
use super::parts::Part;

/// Numbers of a texel.
pub(in crate::files) const CHANNELS: usize = 4;

/// What a texel has where the table has no dimension.
const MISSING: [f32; CHANNELS] = [0.0, 0.0, 0.0, 1.0];

/// Writes the texels.
pub(super) fn write(out: &mut impl Write, values: &Encoded, part: &Part) -> io::Result<()> {
    let [.., dims] = part.shape(values.extent());
    let missing: Vec<u8> = MISSING[dims..].iter().flat_map(|number| number.to_le_bytes()).collect();
    values.write_texels(out, part, &missing)
}
