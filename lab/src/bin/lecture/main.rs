//! The samplers of the literature beside ours, in one run and by one metric.
//!
//! ```text
//! cargo run --release -p fsot-lab --bin lecture -- --out out
//! ```
//!
//! Renders the validation scenes with every sampler at 1, 4, 9 and 16 samples per pixel and prints one table
//! of errors as ratios to white noise: after the eye's spatial filter, after its spatio-temporal filter,
//! after temporal antialiasing, after a denoiser. Writes all figures as `lecture.csv`, and contact sheets
//! (noise, spectrum) as PNG. Three minutes on two idle cores; `--quick` shows in seconds that everything
//! works.

mod contenders;
mod measure;
mod report;
mod scale;
mod sheet;
mod shelf;

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use fsot_lab::program::{self, Failure};
use fsot_lab::render::Scene;
use indicatif::{ProgressBar, ProgressStyle};

use crate::contenders::{CONTENDERS, Rendering};
use crate::measure::{Setting, Stage, Trial};
use crate::report::Report;
use crate::scale::Scale;
use crate::sheet::Shown;
use crate::shelf::Shelf;

/// Compare the samplers of the literature with filtered sliced optimal transport, on the validation scenes.
#[derive(Parser)]
struct Arguments {
    /// Directory for the figures and contact sheets; made if absent.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Small tables, pictures and few scenes: a check that everything works, whose figures mean little.
    #[arg(long)]
    quick: bool,
    /// Samples per pixel to compare [default: 1 4 9 16; 1 4 if quick].
    #[arg(long, num_args = 1.., value_parser = clap::value_parser!(u32).range(1..=64))]
    spp: Vec<u32>,
    /// Names every random number of tables and renderings.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

fn main() -> ExitCode {
    program::main(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { out, quick, spp, seed } = arguments;
    let mut scale = if *quick { Scale::quick() } else { Scale::full() };
    if !spp.is_empty() {
        scale.spps.clone_from(spp);
        scale.spps.sort_unstable();
        scale.spps.dedup();
    }
    program::make_folder(out)?;

    let style = ProgressStyle::with_template("{elapsed_precise} {bar:30} {pos}/{len} {wide_msg}")?;
    let (recipes, trials) = (Shelf::recipes(&scale)?, scale.trials());
    let work = recipes.len() + CONTENDERS.len() * trials.len();
    let progress = ProgressBar::new(work as u64).with_style(style);
    progress.enable_steady_tick(Duration::from_secs(1));
    let mut shelf = Shelf::new(scale.clone(), *seed);
    for recipe in recipes {
        tell(&progress, format!("table: {recipe}"));
        shelf.make(recipe)?;
        progress.inc(1);
    }

    let csv = out.join("lecture.csv");
    let mut report = Report::default();
    let mut setting: Option<(Trial, Setting)> = None;
    for (trial, spp) in trials {
        if setting.as_ref().is_none_or(|(made, _)| *made != trial) {
            tell(&progress, format!("reference: {}", trial.scene));
            setting = Some((trial, Setting::new(&trial, &scale)?));
        }
        let Some((_, setting)) = &setting else { continue };
        let shown = compare(&shelf, setting, &trial, spp, &mut report, &progress)?;
        let kind = if trial.animated { "animated" } else { "still" };
        let path = out.join(format!("{}-{kind}-{spp}spp.png", trial.scene));
        sheet::draw(setting, spp, &shown)?.save(&path)?;
        // After each trial, so that a run that is cut off keeps what it has.
        report.save_csv(&csv)?;
        tell(&progress, format!("{} {kind}, {spp} spp: done", trial.scene));
    }
    progress.finish_and_clear();
    let mut stdout = io::stdout().lock();
    report.print(&mut stdout, &scale.spps)?;
    writeln!(stdout, "\nseconds that the tables took:")?;
    for (recipe, seconds) in shelf.seconds() {
        writeln!(stdout, "{seconds:7.1}  {recipe}")?;
    }
    writeln!(stdout, "figures by scene: {}; contact sheets beside it", csv.display())?;
    Ok(())
}

/// Renders with every contender that applies, and reports the errors.
fn compare(
    shelf: &Shelf,
    setting: &Setting,
    trial: &Trial,
    spp: u32,
    report: &mut Report,
    progress: &ProgressBar,
) -> Result<Vec<Shown>, Failure> {
    let mut shown = Vec::new();
    for (at, contender) in CONTENDERS.iter().enumerate() {
        progress.set_message(format!("{}, {spp} spp: {}", trial.scene, contender.name));
        let mut first = None;
        for repeat in 0..shelf.scale.repeats[usize::from(trial.animated)] {
            let Some(film) = contender.render(&Rendering { shelf, setting, spp, repeat })? else { continue };
            for (stage, ratio) in setting.ratios(&film, spp)? {
                report.add(at, trial.scene, stage, spp, ratio);
            }
            first.get_or_insert(film);
        }
        let stage = if trial.animated { Stage::Eye } else { Stage::Still };
        if let (Some(film), Some(ratio)) = (first, report.mean(at, trial.scene, stage, spp)) {
            shown.push(Shown { name: contender.name, film, ratio });
        }
        progress.inc(1);
    }
    Ok(shown)
}

/// Shows what happens; as plain lines where nobody sees a bar.
fn tell(progress: &ProgressBar, message: String) {
    if progress.is_hidden() {
        eprintln!("{}/{} {message}", progress.position(), progress.length().unwrap_or(0));
    }
    progress.set_message(message);
}

/// A scene of the gallery.
fn scene(name: &str) -> Result<Scene, Failure> {
    Scene::by_name(name).ok_or_else(|| format!("there is no scene {name:?}").into())
}
