//! The samplers of the literature beside ours, in one run and by one metric.
//!
//! ```text
//! cargo run --release --example lecture -- --out out
//! ```
//!
//! Renders the validation scenes with every sampler at 1, 4, 9 and 16 samples per pixel and prints one table
//! of errors as ratios to white noise: after the eye's spatial filter, after its spatio-temporal filter,
//! after temporal antialiasing, after a denoiser. Writes all figures as `lecture.csv`, and contact sheets
//! (noise, spectrum) as PNG. Ten minutes on two cores; `--quick` shows in half a minute that everything
//! works.

mod contenders;
mod measure;
mod report;
mod sheet;
mod shelf;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use fsot_lab::render::{Film, Scene};
use indicatif::{ProgressBar, ProgressStyle};

use crate::contenders::Contender;
use crate::measure::{Stage, Trial};
use crate::report::Report;
use crate::shelf::Shelf;

type Failure = Box<dyn std::error::Error + Send + Sync>;

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

/// How much is done.
#[derive(Clone)]
pub struct Scale {
    /// Side of the tables, in pixels.
    tile: usize,
    /// Frames of spatio-temporal tables.
    tile_frames: usize,
    /// Side of single pictures and of animations, in pixels; multiples of `tile`.
    still: usize,
    animated: usize,
    /// Frames of the animations.
    frames: usize,
    reference_spp: u32,
    /// Realisations of single pictures, and of animations.
    repeats: [u64; 2],
    /// Share of the usual work on tables.
    effort: f64,
    spps: Vec<u32>,
    still_scenes: &'static [&'static str],
    animated_scenes: &'static [&'static str],
}

fn full() -> Scale {
    Scale {
        tile: 64,
        tile_frames: 16,
        still: 128,
        animated: 64,
        frames: 24,
        reference_spp: 1024,
        repeats: [4, 2],
        effort: 1.0,
        spps: vec![1, 4, 9, 16],
        still_scenes: &["soft_shadow", "defocus", "glossy", "ambient_occlusion"],
        animated_scenes: &["soft_shadow", "ambient_occlusion", "animated_soft_shadow"],
    }
}

fn quick() -> Scale {
    Scale {
        tile: 16,
        tile_frames: 6,
        still: 32,
        animated: 16,
        frames: 18,
        reference_spp: 64,
        repeats: [1, 1],
        effort: 0.05,
        spps: vec![1, 4],
        still_scenes: &["soft_shadow", "glossy"],
        animated_scenes: &["animated_soft_shadow"],
    }
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { out, seed, .. } = arguments;
    let mut scale = if arguments.quick { quick() } else { full() };
    if !arguments.spp.is_empty() {
        scale.spps.clone_from(&arguments.spp);
        scale.spps.sort_unstable();
        scale.spps.dedup();
    }
    std::fs::create_dir_all(out)
        .map_err(|error| format!("cannot create {}: {error}; choose another --out", out.display()))?;

    let style = ProgressStyle::with_template("{elapsed_precise} {bar:30} {pos}/{len} {wide_msg}")?;
    let recipes = Shelf::recipes(&scale)?;
    let work = recipes.len() + Contender::ALL.len() * trials(&scale).len();
    let progress = ProgressBar::new(work as u64).with_style(style);
    progress.enable_steady_tick(Duration::from_secs(1));
    let csv = out.join("lecture.csv");
    let mut shelf = Shelf::new(scale.clone(), *seed);
    for recipe in recipes {
        tell(&progress, format!("table: {recipe}"));
        shelf.make(recipe)?;
        progress.inc(1);
    }

    let mut report = Report::default();
    let mut setting: Option<(Trial, measure::Setting)> = None;
    for (trial, spp) in trials(&scale) {
        let same = setting.as_ref().is_some_and(|(made, _)| *made == trial);
        if !same {
            tell(&progress, format!("reference: {}", trial.scene));
            setting = Some((trial, measure::Setting::new(&trial, &scale)?));
        }
        let Some((_, setting)) = &setting else { continue };
        let mut shown: Vec<(Contender, Film, f64)> = Vec::new();
        for contender in Contender::ALL {
            progress.set_message(format!("{}, {spp} spp: {}", trial.scene, contender.name()));
            let repeats = scale.repeats[usize::from(trial.animated)];
            let mut first = None;
            for repeat in 0..repeats {
                let Some(film) = contender.render(&shelf, setting, spp, repeat)? else { continue };
                for (stage, ratio) in setting.ratios(&film, spp)? {
                    report.add(contender, trial.scene, stage, spp, ratio);
                }
                first.get_or_insert(film);
            }
            let stage = if trial.animated { Stage::Eye } else { Stage::Still };
            if let (Some(film), Some(ratio)) = (first, report.mean(contender, trial.scene, stage, spp)) {
                shown.push((contender, film, ratio));
            }
            progress.inc(1);
        }
        let kind = if trial.animated { "animated" } else { "still" };
        let path = out.join(format!("{}-{kind}-{spp}spp.png", trial.scene));
        sheet::draw(setting, spp, &shown)?.save(&path)?;
        // After each trial, so that a run that is cut off keeps what it has.
        std::fs::write(&csv, report.csv())
            .map_err(|error| format!("cannot write {}: {error}; choose another --out", csv.display()))?;
        tell(&progress, format!("{} {kind}, {spp} spp: done", trial.scene));
    }
    progress.finish_and_clear();
    let mut stdout = std::io::stdout().lock();
    report.print(&mut stdout, &scale.spps)?;
    writeln!(stdout, "\nseconds that the tables took:")?;
    for (recipe, seconds) in shelf.seconds() {
        writeln!(stdout, "{seconds:7.1}  {recipe}")?;
    }
    writeln!(stdout, "figures by scene: {}; contact sheets beside it", csv.display())?;
    Ok(())
}

/// Shows what happens; as plain lines where nobody sees a bar.
fn tell(progress: &ProgressBar, message: String) {
    if progress.is_hidden() {
        eprintln!("{}/{} {message}", progress.position(), progress.length().unwrap_or(0));
    }
    progress.set_message(message);
}

/// What is rendered, in order.
fn trials(scale: &Scale) -> Vec<(Trial, u32)> {
    let stills = scale.still_scenes.iter().map(|&scene| Trial { scene, animated: false });
    let animations = scale.animated_scenes.iter().map(|&scene| Trial { scene, animated: true });
    stills.chain(animations).flat_map(|trial| scale.spps.iter().map(move |&spp| (trial, spp))).collect()
}

/// A scene of the gallery.
fn scene(name: &str) -> Result<Scene, Failure> {
    Scene::by_name(name).ok_or_else(|| format!("there is no scene {name:?}").into())
}
