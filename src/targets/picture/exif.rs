//! Which way up a picture is to be seen.

/// How a picture is turned, as cameras say it: 1 to 8, of which 1 is not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Orientation(u8);

impl Default for Orientation {
    fn default() -> Self {
        Self(1)
    }
}

impl Orientation {
    /// What an `eXIf` chunk says: the entry 0x0112 of the first directory of a TIFF file. A chunk that says
    /// nothing, or is damaged, turns nothing.
    pub fn of_exif(chunk: &[u8]) -> Self {
        Self::search(chunk.strip_prefix(b"Exif\0\0").unwrap_or(chunk)).unwrap_or_default()
    }

    fn search(bytes: &[u8]) -> Option<Self> {
        const TAG: usize = 0x0112;
        const SHORT: usize = 3;
        let is_big = match bytes.get(..4)? {
            b"MM\0*" => true,
            b"II*\0" => false,
            _ => return None,
        };
        let number = |at: usize, length: usize| -> Option<usize> {
            let digits = bytes.get(at..at.checked_add(length)?)?.iter().map(|&byte| usize::from(byte));
            let add = |sum: usize, digit: usize| sum << 8 | digit;
            Some(if is_big { digits.fold(0, add) } else { digits.rev().fold(0, add) })
        };
        let start = number(4, 4)?;
        (0..number(start, 2)?)
            .map(|entry| start + 2 + 12 * entry)
            .find_map(|at| {
                let is_meant = number(at, 2)? == TAG && number(at + 2, 2)? == SHORT;
                is_meant.then(|| number(at + 8, 2)).flatten()
            })
            .filter(|value| (1..=8).contains(value))
            .map(|value| Self(value as u8))
    }

    /// Columns and rows as they are seen.
    pub fn size(self, [width, height]: [usize; 2]) -> [usize; 2] {
        if self.0 < 5 { [width, height] } else { [height, width] }
    }

    /// Where a pixel that is seen at `[x, y]` is stored, in a picture of so many columns and rows.
    pub fn source(self, [x, y]: [usize; 2], [width, height]: [usize; 2]) -> [usize; 2] {
        let [right, down] = [width - 1, height - 1];
        match self.0 {
            2 => [right - x, y],
            3 => [right - x, down - y],
            4 => [x, down - y],
            5 => [y, x],
            6 => [y, down - x],
            7 => [right - y, down - x],
            8 => [right - y, x],
            _ => [x, y],
        }
    }
}
