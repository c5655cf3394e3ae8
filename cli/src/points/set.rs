//! Labelled points in the plane, and their files.

use std::io;
use std::path::Path;

use fsot::SampleTable;
use ndarray::Array2;
use ndarray_npy::WriteNpyExt;

use crate::Failure;
use crate::output;

/// Points of the unit square, x to the right and y down where they follow a picture, each with a label.
#[derive(Clone, Debug, Default)]
pub struct PointSet {
    /// x and y in turn.
    coordinates: Vec<f32>,
    labels: Vec<u32>,
}

impl PointSet {
    /// The samples of a table of two dimensions, with as many labels.
    pub fn new(table: SampleTable, labels: Vec<u32>) -> Self {
        Self { coordinates: table.into_values(), labels }
    }

    /// Appends points that share a label.
    pub fn append(&mut self, table: SampleTable, label: u32) {
        self.coordinates.extend(table.into_values());
        self.labels.resize(self.coordinates.len() / 2, label);
    }

    pub fn count(&self) -> usize {
        self.labels.len()
    }

    /// Points with their labels, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&[f32], u32)> {
        self.coordinates.chunks_exact(2).zip(self.labels.iter().copied())
    }

    /// Coordinates of the points whose label is among these.
    pub fn with_labels(&self, labels: &[u32]) -> Vec<f32> {
        self.iter()
            .filter(|(_, label)| labels.contains(label))
            .flat_map(|(point, _)| point)
            .copied()
            .collect()
    }

    /// The bytes of a `.csv` or `.npy` file, whichever the name says.
    pub fn file(&self, path: &Path) -> Result<Vec<u8>, Failure> {
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
        csv.write_record(["x", "y", "label"])?;
        for (point, label) in self.iter() {
            csv.write_record([point[0].to_string(), point[1].to_string(), label.to_string()])?;
        }
        csv.flush()
    }

    /// One array, since most readers know no structures; labels are exact up to 2²⁴.
    fn write_npy(&self, out: impl io::Write) -> io::Result<()> {
        let row = |(point, label): (&[f32], u32)| [point[0], point[1], label as f32];
        let values: Vec<f32> = self.iter().flat_map(row).collect();
        let array = Array2::from_shape_vec([self.count(), 3], values).map_err(io::Error::other)?;
        array.write_npy(out).map_err(io::Error::other)
    }
}
