//! Where a point set goes: a picture, coordinates, and how they were made.

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};

use super::making::Work;
use super::set::PointSet;
use crate::Failure;
use crate::draw::raster::Color;
use crate::output::{self, Output};

/// Files that are asked for.
#[derive(Args, Debug)]
pub struct Files {
    /// Where to draw the points [default: a file that is named for what is made, unless --points is given].
    #[arg(long, value_name = "PNG")]
    out: Option<PathBuf>,
    /// Where to write the coordinates: .csv with the header x,y,label, or .npy with float32 of shape [n, 3]
    /// and the same columns; how they were made goes beside it, as NAME.points.json.
    #[arg(long, value_name = "NPY|CSV")]
    points: Option<PathBuf>,
    /// Where to write how the run goes, as .csv, while it goes (of several runs the first): step, seconds,
    /// step size, displacement, and now and then the loss.
    #[arg(long, value_name = "CSV")]
    log: Option<PathBuf>,
}

/// Files that can be written.
#[derive(Debug)]
pub struct Places {
    picture: Option<PathBuf>,
    points: Option<PathBuf>,
    log: Option<PathBuf>,
}

/// How points were made, for the file beside them.
#[derive(Debug, Serialize)]
pub struct Record {
    /// Which verb has made them.
    pub kind: &'static str,
    /// Its flags.
    pub flags: Value,
    /// What the labels mean, from 0.
    pub labels: Vec<String>,
    /// How much work was done, and whether it ended early.
    pub run: Work,
}

/// Kind and version of the file; the number grows when an old reader would misunderstand a new file.
const FORMAT: &str = "fsot point set 1";

impl Files {
    /// Refuses, before the work, what could not be written after it.
    pub fn check(&self, default: &str, inputs: &[&Path]) -> Result<Places, Failure> {
        let default = self.points.is_none().then(|| PathBuf::from(default));
        let (picture, points) = (self.out.clone().or(default), self.points.clone());
        let places = Places { picture, points, log: self.log.clone() };
        let beside = places.record();
        let mut outputs = Vec::new();
        outputs.extend(places.picture.as_deref().map(|path| Output {
            flag: "--out",
            path,
            endings: &["png"],
        }));
        outputs.extend(places.points.as_deref().map(|path| Output {
            flag: "--points",
            path,
            endings: &["npy", "csv"],
        }));
        outputs.extend(beside.as_deref().map(|path| Output { flag: "--points", path, endings: &["json"] }));
        outputs.extend(places.log().map(|path| Output { flag: "--log", path, endings: &["csv"] }));
        output::check(&outputs, inputs)?;
        Ok(places)
    }
}

impl Places {
    fn record(&self) -> Option<PathBuf> {
        self.points.as_deref().map(record_path)
    }

    /// Where the log goes.
    pub fn log(&self) -> Option<&Path> {
        self.log.as_deref()
    }

    /// Writes all that was asked for.
    pub fn write(
        &self,
        set: &PointSet,
        record: &Record,
        draw: impl FnOnce() -> Color,
    ) -> Result<(), Failure> {
        if let (Some(path), Some(beside)) = (&self.points, self.record()) {
            let coordinates = set.file(path)?;
            output::write("--points", path, |out| out.write_all(&coordinates))?;
            let text = record_text(set, &coordinates, record)?;
            output::write("--points", &beside, |out| out.write_all(&text))?;
        }
        match &self.picture {
            Some(path) => draw().save(path),
            None => Ok(()),
        }
    }

    /// The files, as they are named to a person.
    pub fn names(&self) -> Vec<String> {
        let files = [self.picture.clone(), self.points.clone(), self.record()];
        files.into_iter().flatten().map(|path| path.display().to_string()).collect()
    }
}

/// The text of the file beside a file of coordinates, of which the bytes are given: how they were made.
///
/// # Errors
/// A record that JSON doesn't hold.
pub fn record_text(set: &PointSet, coordinates: &[u8], record: &impl Serialize) -> io::Result<Vec<u8>> {
    let written = Written {
        format: FORMAT,
        crate_version: env!("CARGO_PKG_VERSION"),
        columns: set.columns(),
        points: set.count(),
        sha256: Sha256::digest(coordinates).iter().map(|byte| format!("{byte:02x}")).collect(),
        record,
    };
    let mut text = serde_json::to_vec_pretty(&written)?;
    text.push(b'\n');
    Ok(text)
}

/// Where it lies.
pub fn record_path(coordinates: &Path) -> PathBuf {
    coordinates.with_extension("points.json")
}

#[derive(Serialize)]
struct Written<'a, R> {
    format: &'static str,
    crate_version: &'static str,
    columns: Vec<String>,
    points: usize,
    /// Of the file of coordinates, so that a record that belongs to another is found out.
    sha256: String,
    #[serde(flatten)]
    record: &'a R,
}
