//! Labelled points, and their files.

use std::io;
use std::path::Path;

use fsot::SampleTable;
use ndarray::Array2;
use ndarray_npy::WriteNpyExt;

use crate::output;

/// Points of the unit cube, each with a label. In the plane x runs to the right, and y down where they follow
/// a picture.
#[derive(Clone, Debug)]
pub struct PointSet {
    /// Those of each point in turn.
    coordinates: Vec<f32>,
    dims: usize,
    labels: Vec<u32>,
}

impl PointSet {
    /// None yet.
    pub fn empty(dims: usize) -> Self {
        Self { coordinates: Vec::new(), dims, labels: Vec::new() }
    }

    /// The samples of a table, with as many labels.
    pub fn new(table: SampleTable, labels: Vec<u32>) -> Self {
        Self { dims: table.dims(), coordinates: table.into_values(), labels }
    }

    /// Points of so many coordinates, with as many labels; `None` if they are not as many.
    pub fn of_parts(coordinates: Vec<f32>, dims: usize, labels: Vec<u32>) -> Option<Self> {
        let fits = dims > 0 && labels.len().checked_mul(dims) == Some(coordinates.len());
        fits.then_some(Self { coordinates, dims, labels })
    }

    /// Appends points that share a label.
    pub fn append(&mut self, table: SampleTable, label: u32) {
        self.coordinates.extend(table.into_values());
        self.labels.resize(self.coordinates.len() / self.dims, label);
    }

    /// How many.
    pub fn count(&self) -> usize {
        self.labels.len()
    }

    /// Points with their labels, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&[f32], u32)> {
        self.coordinates.chunks_exact(self.dims).zip(self.labels.iter().copied())
    }

    /// Coordinates of the points whose label is among these.
    pub fn with_labels(&self, labels: &[u32]) -> Vec<f32> {
        self.iter()
            .filter(|(_, label)| labels.contains(label))
            .flat_map(|(point, _)| point)
            .copied()
            .collect()
    }

    /// Names of the columns of its files: the coordinates, x, y and z or, of more, x0, x1, ..., and the
    /// label.
    pub fn columns(&self) -> Vec<String> {
        let coordinates: Vec<String> = match self.dims {
            dims @ ..=3 => ["x", "y", "z"][..dims].iter().map(ToString::to_string).collect(),
            dims => (0..dims).map(|dim| format!("x{dim}")).collect(),
        };
        coordinates.into_iter().chain(["label".into()]).collect()
    }

    /// The bytes of a `.csv` or `.npy` file, whichever the name says.
    ///
    /// # Errors
    /// None but the format's.
    pub fn file(&self, path: &Path) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        match output::has_ending(path, "csv") {
            true => self.write_csv(&mut bytes)?,
            false => self.write_npy(&mut bytes)?,
        }
        Ok(bytes)
    }

    /// A header and a line per point; coordinates in the fewest digits that read back as the same `f32`.
    fn write_csv(&self, out: impl io::Write) -> io::Result<()> {
        let mut csv = csv::Writer::from_writer(out);
        csv.write_record(self.columns())?;
        for (point, label) in self.iter() {
            let coordinates = point.iter().map(f32::to_string);
            csv.write_record(coordinates.chain([label.to_string()]))?;
        }
        csv.flush()
    }

    /// One array, since most readers know no structures; labels are exact up to 2²⁴.
    fn write_npy(&self, out: impl io::Write) -> io::Result<()> {
        let row =
            |(point, label): (&[f32], u32)| point.iter().copied().chain([label as f32]).collect::<Vec<_>>();
        let values: Vec<f32> = self.iter().flat_map(row).collect();
        let array =
            Array2::from_shape_vec([self.count(), self.dims + 1], values).map_err(io::Error::other)?;
        array.write_npy(out).map_err(io::Error::other)
    }
}
