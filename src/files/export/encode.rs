//! Values as the numbers of a file, one by one, so that no second table is needed.

use std::io::{self, Write};

use half::f16;

use super::diffuse;
use super::options::{Depth, ExportOptions, Rounding};
use super::parts::Part;
use crate::table::SampleTable;
use crate::table::domain::BELOW_ONE;
use crate::table::extent::Extent;

/// The largest half below 1.
const HALF_BELOW_ONE: f16 = f16::from_bits(0x3bff);

/// A table whose values are read as numbers of a file.
pub(super) struct Encoded<'a> {
    table: &'a SampleTable,
    pub(super) depth: Depth,
    /// Levels that do not follow from a value alone.
    levels: Option<Vec<u16>>,
}

impl<'a> Encoded<'a> {
    /// Worth nothing if `stops` has said so.
    pub(super) fn new(
        table: &'a SampleTable,
        options: &ExportOptions,
        stops: &mut dyn FnMut() -> bool,
    ) -> Self {
        let depth = options.depth();
        Self { table, depth, levels: levels(table, depth, options.rounding, stops) }
    }

    pub(super) fn extent(&self) -> Extent {
        self.table.extent()
    }

    pub(super) fn dims(&self) -> usize {
        self.table.dims()
    }

    /// The level of the value at this position of the table's memory; that of floating point is its bits.
    pub(super) fn number(&self, at: usize) -> u32 {
        if let Some(levels) = &self.levels {
            return levels[at].into();
        }
        number(self.depth, self.table.values()[at])
    }

    /// What a reader makes of it.
    pub(super) fn decoded(&self, at: usize) -> f32 {
        decode(self.depth, self.number(at))
    }

    /// The bytes of numbers, least significant first.
    pub(super) fn extend_little(&self, bytes: &mut Vec<u8>, positions: impl Iterator<Item = usize>) {
        let size = self.depth.bytes();
        positions.for_each(|at| bytes.extend_from_slice(&self.number(at).to_le_bytes()[..size]));
    }

    /// Writes the texels of a texture, least significant bytes first: its frames one after the other, row by
    /// row; each ends with the channels that the table has no dimensions for.
    pub(super) fn write_texels(&self, out: &mut impl Write, part: &Part, missing: &[u8]) -> io::Result<()> {
        let [_, height, width, _, dims] = part.shape(self.extent());
        let mut row = Vec::with_capacity(width * (dims * self.depth.bytes() + missing.len()));
        for frame in part.frames.clone() {
            for y in 0..height {
                row.clear();
                let mut positions = part.row(self.extent(), self.dims(), frame, y);
                for _ in 0..width {
                    self.extend_little(&mut row, positions.by_ref().take(dims));
                    row.extend_from_slice(missing);
                }
                out.write_all(&row)?;
            }
        }
        Ok(())
    }

    /// The bytes of numbers in the order of this machine.
    #[cfg(feature = "image")]
    pub(super) fn extend_native(&self, bytes: &mut Vec<u8>, positions: impl Iterator<Item = usize>) {
        if cfg!(target_endian = "big") {
            self.extend_big(bytes, positions);
        } else {
            self.extend_little(bytes, positions);
        }
    }

    /// The bytes of numbers, most significant first.
    #[cfg(feature = "image")]
    pub(super) fn extend_big(&self, bytes: &mut Vec<u8>, positions: impl Iterator<Item = usize>) {
        let size = self.depth.bytes();
        positions.for_each(|at| bytes.extend_from_slice(&self.number(at).to_be_bytes()[4 - size..]));
    }
}

impl SampleTable {
    /// The table that is read from files of these numbers: what an export costs can be measured on it.
    ///
    /// ```
    /// use fsot::files::{Depth, Rounding};
    /// use fsot::{Extent, SampleTable};
    ///
    /// let table = SampleTable::new(Extent::still(1, 2), 1, vec![0.0, 0.3])?;
    /// let read = table.quantized(Depth::U8, Rounding::Floor);
    /// assert_eq!(read.values(), [0.5 / 256.0, 76.5 / 256.0]);
    /// # Ok::<(), fsot::files::TableError>(())
    /// ```
    #[must_use]
    pub fn quantized(&self, depth: Depth, rounding: Rounding) -> Self {
        self.clone().into_quantized(depth, rounding)
    }

    /// The same in the place of this table, without room for another.
    #[must_use]
    pub fn into_quantized(self, depth: Depth, rounding: Rounding) -> Self {
        let levels = levels(&self, depth, rounding, &mut || false);
        let (extent, dims) = (self.extent(), self.dims());
        let mut values = self.into_values();
        match levels {
            Some(levels) => {
                values.iter_mut().zip(levels).for_each(|(value, level)| *value = decode(depth, level.into()));
            }
            None => values.iter_mut().for_each(|value| *value = decode(depth, number(depth, *value))),
        }
        Self::trusted(extent, dims, values)
    }
}

/// Levels that do not follow from a value alone.
fn levels(
    table: &SampleTable,
    depth: Depth,
    rounding: Rounding,
    stops: &mut dyn FnMut() -> bool,
) -> Option<Vec<u16>> {
    match (rounding, depth.levels()) {
        (Rounding::Diffuse, Some(levels)) => Some(diffuse::levels(table, levels, stops)),
        _ => None,
    }
}

/// The number that follows from a value alone.
fn number(depth: Depth, value: f32) -> u32 {
    match depth {
        // Exact: a value below 1 by a power of two.
        Depth::U8 => (value * 256.0) as u32,
        Depth::U16 => (value * 65536.0) as u32,
        Depth::Half => u32::from(f16::from_f32(value).min(HALF_BELOW_ONE).to_bits()),
        Depth::F32 => value.to_bits(),
    }
}

/// The value that a number of a file stands for.
pub(super) fn decode(depth: Depth, number: u32) -> f32 {
    match depth {
        // Exact: 17 bits at most.
        Depth::U8 => (number as f32 + 0.5) / 256.0,
        Depth::U16 => (number as f32 + 0.5) / 65536.0,
        Depth::Half => f16::from_bits(number as u16).to_f32().min(BELOW_ONE),
        Depth::F32 => f32::from_bits(number),
    }
}
