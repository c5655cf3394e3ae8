//! `fsot plot`: curves of the logs of runs, as SVG.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use serde_json::json;

use crate::console::Console;
use crate::draw::chart::{COLOURS, Frame, TEXT_PX, spread, write_text};
use crate::interrupt::Interrupt;
use crate::log::COLUMNS;
use crate::output::{self, Output};
use crate::{Ended, Failure, Shared};

const EXAMPLES: &str = "\
Examples:
  fsot table --frames 1 --log sweeps.csv
  fsot table --frames 1 --slices-per-class 320 --log slices.csv
  fsot plot sweeps.csv slices.csv --out curves.svg
      filtered error, loss and displacement of both runs over their time

  fsot plot run.csv
      one run, to curves.svg, also while it goes on

Exit codes: 0 done, 1 refused or failed, 2 bad command line.";

/// Draws what the logs of runs say: filtered error, loss and displacement over the time.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Logs of `fsot table --log`; each is a curve, named by its file.
    #[arg(required = true, value_name = "CSV")]
    logs: Vec<PathBuf>,
    /// Where to draw the curves.
    #[arg(long, default_value = "curves.svg", value_name = "SVG")]
    out: PathBuf,
    #[command(flatten)]
    shared: Shared,
}

/// Figures that get a panel, by the name of their column.
const FIGURES: [(&str, &str); 3] =
    [("filtered_error", "filtered error / white noise"), ("loss", "loss"), ("displacement", "displacement")];
const PANEL: (u32, u32) = (480, 340);
/// Letters of a name that are shown, and how wide one is.
const MOST_LETTERS: usize = 24;
const LETTER_PX: f64 = 0.55 * TEXT_PX as f64;
/// Points that a curve is drawn with.
const MOST_POINTS: usize = 2000;

/// A log that was read.
struct Log {
    name: String,
    /// By column.
    rows: Vec<[Option<f64>; COLUMNS.len()]>,
    /// Lines that are no rows.
    spoiled: usize,
}

/// Draws the logs.
///
/// # Errors
/// Whatever stands against it, in one sentence.
pub fn run(arguments: &Arguments) -> Result<Ended, Failure> {
    let Arguments { logs, out, shared } = arguments;
    let inputs: Vec<&Path> = logs.iter().map(PathBuf::as_path).collect();
    output::check(&[Output { flag: "--out", path: out, endings: &["svg"] }], &inputs)?;
    let logs = logs.iter().map(|path| Log::open(path)).collect::<Result<Vec<_>, _>>()?;
    let drawn = |(column, _): &&(&str, &str)| logs.iter().any(|log| !log.curve(column).is_empty());
    let panels: Vec<_> = FIGURES.iter().filter(drawn).collect();
    if panels.is_empty() {
        return Err("there is nothing to draw yet: wait for the first rows after the header".into());
    }
    let mut svg = String::new();
    draw(&mut svg, &logs, &panels)?;
    Interrupt::listen()?;
    output::write("--out", out, |file| file.write_all(svg.as_bytes()))?;

    let mut console = Console::new(shared);
    let names: Vec<&str> = panels.iter().map(|(column, _)| *column).collect();
    console.say(|words| {
        writeln!(words, "{}: {}", out.display(), names.join(", "))?;
        logs.iter().filter(|log| log.spoiled > 0).try_for_each(|Log { name, spoiled, .. }| {
            let lines = if *spoiled == 1 { "line is" } else { "lines are" };
            writeln!(words, "{name}: {spoiled} {lines} no row of a log, and left out")
        })
    });
    let spoiled: Vec<usize> = logs.iter().map(|log| log.spoiled).collect();
    console.figures(&json!({ "out": out.display().to_string(), "panels": names, "spoiled_lines": spoiled }));
    console.end(Ended::Done)
}

impl Log {
    fn open(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let unreadable = |error| format!("cannot read {name}: {error}; check the path and its permissions");
        // Before opening, because opening a pipe waits for its writer.
        let is_file = std::fs::metadata(path).map_err(unreadable)?.is_file();
        let file = is_file.then(|| File::open(path).map_err(unreadable)).transpose()?;
        let no_log = || format!("{name} is no log: give a file that `fsot table --log` has written");
        let header = format!("{}\n", COLUMNS.join(","));
        let mut file = file.ok_or_else(no_log)?;
        let mut start = vec![0; header.len()];
        if file.read_exact(&mut start).is_err() || start != header.as_bytes() {
            return Err(no_log().into());
        }
        let mut rest = Vec::new();
        file.read_to_end(&mut rest).map_err(unreadable)?;
        // A disk may have spoiled any byte.
        let text = String::from_utf8_lossy(&rest);
        let mut rows = Vec::new();
        let mut spoiled = 0;
        for row in text.split_inclusive('\n') {
            match row.strip_suffix('\n').map(|row| read(row.trim_end_matches('\r'))) {
                Some(Some(row)) => rows.push(row),
                Some(None) => spoiled += 1,
                // The last one of a run that was killed, or whose disk was full.
                None => {}
            }
        }
        Ok(Self { name, rows, spoiled })
    }

    /// Logarithms of time and figure, where both have one.
    fn curve(&self, column: &str) -> Vec<(f64, f64)> {
        let place = |name: &str| COLUMNS.iter().position(|column| *column == name);
        let (Some(time), Some(figure)) = (place("seconds"), place(column)) else { return Vec::new() };
        let logarithm = |value: Option<f64>| value.map(f64::log10).filter(|value| value.is_finite());
        let point = |row: &[_; COLUMNS.len()]| Some((logarithm(row[time])?, logarithm(row[figure])?));
        let all: Vec<(f64, f64)> = self.rows.iter().filter_map(point).collect();
        let step = all.len().div_ceil(MOST_POINTS).max(1);
        // The last one is where the run has come to.
        let last = all.len().saturating_sub(1);
        let kept = all.iter().enumerate().filter(|(at, _)| at % step == 0 || *at == last);
        kept.map(|(_, point)| *point).collect()
    }

    /// The name as it is shown: its end, where it is too long.
    fn label(&self) -> String {
        let letters = self.name.chars().count();
        match letters.checked_sub(MOST_LETTERS) {
            None | Some(0) => self.name.clone(),
            Some(more) => format!("…{}", self.name.chars().skip(more + 1).collect::<String>()),
        }
    }
}

/// Numbers by column, of which any but the first three may be missing; `None` of what is no row.
fn read(line: &str) -> Option<[Option<f64>; COLUMNS.len()]> {
    let mut row = [None; COLUMNS.len()];
    let mut fields = line.split(',');
    for (column, place) in row.iter_mut().enumerate() {
        let field = fields.next()?;
        if !(field.is_empty() && column > 2) {
            *place = Some(field.parse::<f64>().ok()?);
        }
    }
    fields.next().is_none().then_some(row)
}

fn draw(svg: &mut String, logs: &[Log], panels: &[&(&str, &str)]) -> Result<(), Failure> {
    let labels: Vec<String> = logs.iter().map(Log::label).collect();
    let longest = labels.iter().map(|label| label.chars().count()).max().unwrap_or(0);
    let right = 20.0 + LETTER_PX * longest as f64;
    let (width, height) = (PANEL.0 + right as u32, PANEL.1);
    let root = SVGBackend::with_string(svg, (width * panels.len() as u32, height));
    let root = root.into_drawing_area();
    root.fill(&WHITE)?;
    for (panel, (column, title)) in root.split_evenly((1, panels.len())).iter().zip(panels) {
        let curves: Vec<Vec<(f64, f64)>> = logs.iter().map(|log| log.curve(column)).collect();
        let points = || curves.iter().flatten();
        let frame = Frame::around(
            (width, height),
            right,
            points().map(|point| point.0),
            points().map(|point| point.1),
        );
        frame.draw_axes(panel, title, "time of the optimisation")?;
        let mut ends = Vec::new();
        for ((curve, label), colour) in curves.iter().zip(&labels).zip(COLOURS.iter().cycle()) {
            let line: Vec<(i32, i32)> = curve.iter().map(|&(x, y)| frame.at(x, y)).collect();
            panel.draw(&PathElement::new(line.clone(), colour.stroke_width(2)))?;
            // Of a few points one should see that they are so few.
            for &at in line.iter().filter(|_| line.len() <= 40) {
                panel.draw(&Circle::new(at, 2, colour.filled()))?;
            }
            if let Some(&(_, y)) = line.last() {
                ends.push((frame.rightmost() + 8, y, label.as_str(), *colour));
            }
        }
        spread(&mut ends, frame.lowest() - TEXT_PX / 2);
        for (x, y, label, colour) in ends {
            write_text(panel, label, (x, y), colour, (HPos::Left, VPos::Center))?;
        }
    }
    root.present()?;
    drop(root);
    Ok(())
}
