//! `fsot report`: shows what tables are worth, side by side on one page, or as a sheet of pictures.

mod again;
mod chart;
mod edge;
mod effort;
mod figures;
mod glance;
mod marginals;
mod page;
mod panels;
mod sections;
mod sheet;

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use fsot::config::DimensionGroup;
use fsot::files::{BoundEstimate, Metadata, WholeFile, shell};
use fsot::metrics::{Integrands, RadialBin};
use fsot::{Kernel, SampleTable};
use serde_json::json;

use self::again::Origin;
pub use self::glance::Glance;
use self::marginals::Profile;
use self::panels::Panels;
use crate::console::Console;
use crate::inspect::figures::{self as measured, GroupFigures};
use crate::inspect::{Beside, Effort, Inspection, Yardstick, shape};
use crate::interrupt::Interrupt;
use crate::output::{self, Output};
use crate::{Ended, Failure, Shared};

const EXAMPLES: &str = "\
Examples:
  fsot report table.npy
      a page about the table beside white noise, in report.html
  fsot report ours.npy theirs.npy white.npy --out comparison.html
      several tables side by side
  fsot report table.npy --png table.png
      only the pictures, without words, for a paper

The page is one file that needs no network; pages and sheets are written whole or not at all. A signal ends it
at once. fsot inspect prints more figures, from more integrands.
Exit codes: 0 done, 1 refused or failed, 2 bad command line.";

/// Draws a page about one sample table or several: samples, errors, spectra, figures and how they were made.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Arguments {
    /// The tables: .npy files with axes [frame, y, x, sample, dim].
    #[arg(required = true, value_name = "TABLE")]
    paths: Vec<PathBuf>,
    /// Where to write the page [default: report.html; none if --png is given].
    #[arg(long, value_name = "HTML")]
    out: Option<PathBuf>,
    /// Where to write the pictures alone: a row of white noise and one of each table; columns are the first
    /// number of each pixel, samples of neighbours and of a frame, the error of an edge before and after the
    /// filter, and its spectra in x and y and, of animations, in x and t.
    #[arg(long, value_name = "PNG")]
    png: Option<PathBuf>,
    /// Test integrands per family [default: 256, fewer for large tables so that a page takes some seconds].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=65536))]
    integrands: Option<u32>,
    /// Slices per term of the bound, fewer for large subsets. The default leaves a standard error of about a
    /// percent.
    #[arg(long, default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    bound_slices: u32,
    #[command(flatten)]
    yardstick: Yardstick,
    #[command(flatten)]
    shared: Shared,
}

/// A table in memory that a page is about.
#[derive(Clone, Debug)]
pub struct Shown {
    /// What it is called on the page.
    pub label: String,
    /// The table.
    pub table: SampleTable,
    /// How it came to be, if that is known.
    pub metadata: Option<Metadata>,
}

/// A page, and a sheet of its pictures alone.
#[derive(Clone, Debug)]
pub struct Pages {
    /// HTML.
    pub html: String,
    /// PNG.
    pub png: Vec<u8>,
}

/// Makes a page about tables in memory, like that of `fsot report` about files. Prints and writes nothing;
/// `made_by` is said at its end.
///
/// # Errors
/// Whatever stands against it, in one sentence.
///
/// ```
/// use fsot::{Extent, SampleTable};
/// use fsot_cli::inspect::Yardstick;
/// use fsot_cli::report::{Shown, pages};
///
/// let table = SampleTable::white_noise(Extent::still(8, 8), 2, 0)?;
/// let shown = Shown { label: "noise".into(), table, metadata: None };
/// let html = pages(vec![shown], "a test", &Yardstick::default(), Some(16), 64)?.html;
/// assert!(html.contains("a test"));
/// # Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
/// ```
pub fn pages(
    tables: Vec<Shown>,
    made_by: &str,
    yardstick: &Yardstick,
    integrands: Option<usize>,
    bound_slices: usize,
) -> Result<Pages, Failure> {
    let first = tables.first().ok_or("there are no tables: give at least 1")?;
    for Shown { table, .. } in &tables {
        yardstick.kernel(table.extent().frames).taps(&table.extent())?;
    }
    let look = Look { yardstick, integrands, bound_slices };
    let white = look.white_noise(&first.table)?;
    let columns = tables.into_iter().map(|Shown { label, table, metadata }| {
        let beside = Beside::given(metadata, &table);
        Column::measure(table, label.clone(), label, beside, None, &look)
    });
    let columns = columns.collect::<Result<Vec<_>, Failure>>()?;
    let report = Report { white, columns, command: made_by.to_owned() };
    Ok(Pages { html: page::html(&report)?, png: sheet::picture(&report).to_png()? })
}

/// How tables are looked at.
struct Look<'a> {
    yardstick: &'a Yardstick,
    integrands: Option<usize>,
    bound_slices: usize,
}

/// A table, measured.
struct Column {
    label: String,
    inspection: Inspection,
    beside: Beside,
    origin: Origin,
    groups: Vec<GroupFigures>,
    bound: BoundEstimate,
    panels: Panels,
    /// Of the dimensions that are shown.
    profiles: Vec<Profile>,
}

/// Everything that is on the page.
struct Report {
    /// White noise of the shape of the first table.
    white: Panels,
    columns: Vec<Column>,
    /// That made the page.
    command: String,
}

/// Makes the page.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { paths, png, shared, yardstick, integrands, bound_slices, .. } = arguments;
    let out = match (&arguments.out, png) {
        (None, Some(_)) => None,
        (out, _) => Some(out.clone().unwrap_or_else(|| "report.html".into())),
    };
    let page = out.as_deref().map(|path| Output { flag: "--out", path, endings: &["html", "htm"] });
    let sheet = png.as_deref().map(|path| Output { flag: "--png", path, endings: &["png"] });
    let outputs: Vec<Output> = page.into_iter().chain(sheet).collect();
    let besides: Vec<PathBuf> = paths.iter().map(|path| Metadata::path_beside(path)).collect();
    let inputs: Vec<&Path> = paths.iter().chain(&besides).map(PathBuf::as_path).collect();
    output::check(&outputs, &inputs)?;
    let tables = paths.iter().map(SampleTable::load).collect::<Result<Vec<_>, _>>()?;
    for table in &tables {
        // A bad kernel is found out before anything is measured.
        yardstick.kernel(table.extent().frames).taps(&table.extent())?;
    }
    shared.start_threads()?;

    let mut console = Console::new(shared);
    let labels = labels(paths);
    let integrands = integrands.map(|count| count as usize);
    let look = Look { yardstick, integrands, bound_slices: *bound_slices as usize };
    let white = look.white_noise(&tables[0])?;
    let mut columns = Vec::new();
    for ((table, path), label) in tables.into_iter().zip(paths).zip(labels) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let beside = Beside::find(path, &table);
        let column = Column::measure(table, name, label, beside, Some(path), &look)?;
        console.say(|out| {
            let (error, bound) = (column.error(), column.bound.ratio_to_white_noise);
            writeln!(out, "{}: {}", column.label, shape(&column.inspection.table))?;
            writeln!(out, "  of white noise: filtered error {error:.3}, bound {bound:.3}")
        });
        columns.push(column);
    }
    let report = Report { white, columns, command: command() };

    // Files are not left half-written by a signal, and it takes no time to complete them.
    Interrupt::listen()?;
    let mut files = Vec::new();
    if let Some(page) = &out {
        files.push(("--out", page, page::html(&report)?.into_bytes()));
    }
    if let Some(png) = png {
        files.push(("--png", png, sheet::picture(&report).to_png()?));
    }
    let written = files.iter().map(|(flag, path, bytes)| {
        let file = WholeFile::write(path, |to| to.write_all(bytes));
        file.map_err(|error| output::cannot_write(flag, path, &error)).map(|file| (flag, path, file))
    });
    // Both are complete before either appears.
    for (flag, path, file) in written.collect::<Result<Vec<_>, _>>()? {
        file.commit().map_err(|error| output::cannot_write(flag, path, &error))?;
    }
    for (_, path, bytes) in &files {
        console.say(|out| writeln!(out, "{}: {} kB", path.display(), bytes.len().div_ceil(1000)));
    }
    let name = |path: &PathBuf| path.display().to_string();
    console.figures(&json!({
        "tables": report.columns.iter().map(Column::json).collect::<Vec<_>>(),
        "page": out.as_ref().map(name),
        "png": png.as_ref().map(name),
    }));
    console.end(Ended::Done)
}

impl Look<'_> {
    fn effort(&self, table: &SampleTable, kernel: &Kernel) -> Result<Effort, Failure> {
        effort::of(table, kernel, self.integrands, self.bound_slices)
    }

    /// Pictures of white noise of the table's shape.
    fn white_noise(&self, table: &SampleTable) -> Result<Panels, Failure> {
        let seed = self.yardstick.seed;
        let extent = table.extent();
        // Another seed than a table's own, which may have started from white noise of this very seed.
        let white = SampleTable::white_noise(extent, table.dims(), seed ^ 0x0077_6869_7465)?;
        let dims: Vec<usize> = (0..table.dims().min(2)).collect();
        let kernel = self.yardstick.kernel(extent.frames);
        let effort = self.effort(&white, &kernel)?;
        let integrands = Integrands::random(dims.len(), effort.of_spectra, seed)?;
        let spectra = measured::spectra(&white, &dims, &integrands, &effort)?;
        Panels::new(&white, &dims, &kernel, seed, &spectra)
    }
}

impl Column {
    fn measure(
        table: SampleTable,
        name: String,
        label: String,
        beside: Beside,
        path: Option<&Path>,
        look: &Look<'_>,
    ) -> Result<Self, Failure> {
        let kernel = look.yardstick.kernel(table.extent().frames);
        let effort = look.effort(&table, &kernel)?;
        let seed = look.yardstick.seed;
        let inspection = Inspection { name, table, kernel, seed, effort };
        let Inspection { table, kernel, .. } = &inspection;
        let dims = DimensionGroup::pairs_and_whole(table.dims());
        let groups = dims.iter().map(|group| GroupFigures::measure(&inspection, group.dims.clone()));
        let groups = groups.collect::<Result<Vec<_>, Failure>>()?;
        let shown = groups.first().ok_or("a table without dimensions cannot be shown")?;
        let panels = Panels::new(table, &shown.dims, kernel, seed, &shown.spectra)?;
        let profiles = shown.dims.iter().take(2).map(|&dim| Profile::measure(table, dim));
        let profiles = profiles.collect::<Result<_, _>>()?;
        let bound = measured::bound(&inspection, &dims)?;
        let origin = Origin::new(path, &beside, kernel);
        Ok(Self { label, beside, origin, groups, bound, panels, profiles, inspection })
    }

    /// The group whose pictures are shown.
    fn shown(&self) -> &GroupFigures {
        &self.groups[0]
    }

    /// The figure that matters most.
    fn error(&self) -> f64 {
        self.shown().errors.spatio_temporal.mean.mean
    }

    fn json(&self) -> serde_json::Value {
        let Self { label, inspection, beside, groups, bound, origin, .. } = self;
        let mut figures = measured::json(inspection, beside, groups, bound);
        figures["label"] = label.as_str().into();
        figures["integrands_of_bias"] = inspection.effort.of_bias.into();
        figures["frames_of_filtered_error"] = inspection.effort.frames.into();
        figures["made_again_by"] = origin.command.clone().into();
        figures
    }
}

impl Report {
    /// Radial averages: white noise's, then the tables'.
    fn radial(&self) -> Vec<(&str, &[RadialBin])> {
        let tables = self.columns.iter().map(|column| (column.label.as_str(), &*column.panels.radial));
        std::iter::once(("white noise", &*self.white.radial)).chain(tables).collect()
    }

    fn is_animated(&self) -> bool {
        self.columns.iter().any(|column| column.shown().animated)
    }
}

/// A name for each table: that of its file, or its path where files have the same name, or with a number.
fn labels(paths: &[PathBuf]) -> Vec<String> {
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let names: Vec<String> = paths.iter().map(name).collect();
    let is_unique =
        |names: &[String], at: usize| names.iter().filter(|name| **name == names[at]).count() == 1;
    let of_path = |at: usize| match is_unique(&names, at) {
        true => names[at].clone(),
        false => paths[at].display().to_string(),
    };
    let longer: Vec<String> = (0..names.len()).map(of_path).collect();
    let numbered = |at: usize| match is_unique(&longer, at) {
        true => longer[at].clone(),
        false => format!("{} ({})", longer[at], at + 1),
    };
    (0..longer.len()).map(numbered).collect()
}

/// The command line of this process.
fn command() -> String {
    let words = std::env::args_os().skip(1).collect::<Vec<OsString>>();
    let words = words.iter().map(shell::word);
    std::iter::once("fsot".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_short_and_different() {
        let of = |paths: &[&str]| labels(&paths.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(of(&["a/x.npy", "b/y.npy"]), ["x.npy", "y.npy"]);
        assert_eq!(of(&["a/x.npy", "b/x.npy", "y.npy"]), ["a/x.npy", "b/x.npy", "y.npy"]);
        assert_eq!(of(&["x.npy", "x.npy"]), ["x.npy (1)", "x.npy (2)"]);
    }
}
