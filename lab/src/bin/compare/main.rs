//! Renders a scene with sample tables, white noise and Owen-scrambled Sobol', and says which is better.
//!
//! ```text
//! cargo run --release -p fsot-lab --bin compare -- --table a.npy b.npy --scene glossy --out sheet
//! ```
//!
//! Prints the errors as ratios to white noise and writes `SCENE-SPPspp.png`, a contact sheet with a column
//! per sampler (rendered, filtered, filtered error, error spectrum), and one EXR of the last frame per
//! sampler.

mod sheet;

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use fsot::kernel::TemporalKernel;
use fsot::{Extent, SampleTable};
use fsot_lab::figures::mean_and_error;
use fsot_lab::names::{distinct, plain};
use fsot_lab::program::{self, Failure};
use fsot_lab::render::{
    Comparison, Film, ImageFilter, Reference, Scales, Scene, compare, demand, error_spectrum, render,
};
use fsot_lab::samplers::{OwenSobol, Sampler, TableSampler, WhiteNoise};
use fsot_lab::say;
use indicatif::{ProgressBar, ProgressStyle};

use crate::sheet::{Cell, Sheet};

/// Render a scene with sample tables, white noise and Owen-scrambled Sobol', and compare their errors.
#[derive(Parser)]
struct Args {
    /// Tables to compare, as .npy files with axes [frame, y, x, sample, dim].
    #[arg(long, num_args = 1.., value_name = "PATH")]
    table: Vec<PathBuf>,
    /// Scene: soft_shadow, defocus, glossy, ambient_occlusion or animated_soft_shadow.
    #[arg(long, default_value = "soft_shadow", value_name = "NAME")]
    scene: String,
    /// Samples per pixel.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=65536))]
    spp: u32,
    /// Height and width of the picture in pixels.
    #[arg(long, default_value_t = 128, value_parser = clap::value_parser!(u32).range(32..=1024))]
    resolution: u32,
    /// Samples per pixel of the reference.
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(64..=1_048_576))]
    reference_spp: u32,
    /// First realisation of the noise: seeds white noise and Sobol', displaces tables. The one that is shown.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Realisations to average the errors over; a single picture's error is itself noisy.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: u32,
    /// Frames per second, for the eye's temporal filter on animated scenes.
    #[arg(long, default_value_t = 60.0)]
    fps: f64,
    /// Directory for the pictures; made if absent.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Directory for references [default: fsot-references in the system's temporary directory].
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
}

fn main() -> ExitCode {
    program::main(run)
}

/// What tables are compared with.
const WHITE_NOISE: &str = "white noise";
const OWEN_SOBOL: &str = "Owen-Sobol'";

/// A sampler's realisation with this seed.
type Realise<'t> = Box<dyn Fn(u64) -> Box<dyn Sampler + 't> + 't>;

/// A rendering and what is said about it.
struct Entry {
    label: String,
    note: String,
    /// The first realisation.
    film: Film,
    ratios: Ratios,
}

/// Errors over those of white noise, mean over realisations.
struct Ratios {
    rmse: f64,
    rel_mse: f64,
    p_rel_mse: f64,
    /// Standard error of `p_rel_mse`; NaN for one realisation.
    p_rel_mse_error: f64,
    p_rel_mse_wide: f64,
    /// What the reference's own error adds to `p_rel_mse`.
    floor: f64,
}

impl Ratios {
    fn mean(found: &[Comparison]) -> Self {
        let mean = |ratio: fn(&Comparison) -> f64| found.iter().map(ratio).sum::<f64>() / found.len() as f64;
        let ratios: Vec<f64> = found.iter().map(|c| c.p_rel_mse.ratio()).collect();
        let (p_rel_mse, error) = mean_and_error(&ratios);
        Self {
            rmse: mean(|c| c.mse.ratio()).sqrt(),
            rel_mse: mean(|c| c.rel_mse.ratio()),
            p_rel_mse,
            p_rel_mse_error: error.unwrap_or(f64::NAN),
            p_rel_mse_wide: mean(|c| c.p_rel_mse_wide.ratio()),
            floor: mean(|c| c.p_rel_mse.floor / c.p_rel_mse.white),
        }
    }
}

fn run(args: &Args) -> Result<(), Failure> {
    let scene = Scene::by_name(&args.scene).ok_or_else(|| {
        format!("there is no scene {:?}; choose one of {}", args.scene, Scene::NAMES.join(", "))
    })?;
    let tables = load(&args.table)?;
    program::make_folder(&args.out)?;
    let resolution = [args.resolution as usize; 2];
    let temporal = match scene.frames {
        1 => TemporalKernel::None,
        _ => TemporalKernel::Perceptual { fps: args.fps },
    };

    let progress = ProgressBar::new(tables.len() as u64 + 3)
        .with_style(ProgressStyle::with_template("{bar:30} {pos}/{len} {wide_msg}")?);
    progress.set_message(format!("reference of {} at {} spp", scene.name, args.reference_spp));
    let cache = args.cache.clone().unwrap_or_else(|| std::env::temp_dir().join("fsot-references"));
    let reference = Reference::cached(&scene, resolution, args.reference_spp, cache)?;
    progress.inc(1);

    let mut contenders: Vec<(String, String, Realise)> = vec![
        (WHITE_NOISE.into(), String::new(), Box::new(|seed| Box::new(WhiteNoise::new(seed)))),
        (OWEN_SOBOL.into(), String::new(), Box::new(|seed| Box::new(OwenSobol::new(seed)))),
    ];
    for (label, table) in &tables {
        let realise: Realise = Box::new(|seed| {
            Box::new(TableSampler::new(table).shifted(Extent::still(1024, 1024).displacement(seed)))
        });
        contenders.push((label.clone(), notes(table, &scene, args.spp), realise));
    }
    // Two labels may be one name of a file.
    let files = distinct(contenders.iter().map(|(label, ..)| plain(label)), "-");
    let mut entries = Vec::new();
    for ((label, note, realise), file) in contenders.into_iter().zip(files) {
        progress.set_message(label.clone());
        let mut shown = None;
        let mut found = Vec::new();
        for seed in args.seed..args.seed + u64::from(args.repeats) {
            let film = render(&scene, &*realise(seed), resolution, args.spp)?;
            found.push(compare(&film, &reference, args.spp, &temporal)?);
            shown.get_or_insert(film);
        }
        let film = shown.ok_or("give --repeats of at least 1")?;
        let file = format!("{}-{}spp-{file}.exr", scene.name, args.spp);
        film.save_exr(args.out.join(file), scene.frames - 1)?;
        entries.push(Entry { label, note, film, ratios: Ratios::mean(&found) });
        progress.inc(1);
    }
    progress.finish_and_clear();

    let path = args.out.join(format!("{}-{}spp.png", scene.name, args.spp));
    contact_sheet(&scene, args, &entries, &reference, &temporal)?.picture().save(&path)?;
    let demand = demand(&scene, resolution)?;
    say!(
        "{}, {}x{}, {} frame(s), {} spp, dimension groups {:?}, {:.0} % of the pixels demanded",
        scene.name,
        args.resolution,
        args.resolution,
        scene.frames,
        args.spp,
        scene.dimension_groups(),
        100.0 * demand.share()
    )?;
    print_ratios(&entries)?;
    say!("contact sheet: {}", path.display())?;
    Ok(())
}

/// Tables with labels, which are told apart by numbers where files have the same name, or that of what every
/// table is compared with.
fn load(paths: &[PathBuf]) -> Result<Vec<(String, SampleTable)>, Failure> {
    let stem = |path: &PathBuf| path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let others = [WHITE_NOISE, OWEN_SOBOL].map(String::from);
    let skipped = others.len();
    let labels = distinct(others.into_iter().chain(paths.iter().map(stem)), " #");
    let tables = labels.into_iter().skip(skipped).zip(paths);
    tables.map(|(label, path)| Ok((label, SampleTable::load(path)?))).collect()
}

/// What the table lacks for this scene, in the words of `TableSampler`.
fn notes(table: &SampleTable, scene: &Scene, spp: u32) -> String {
    let mut notes = Vec::new();
    if table.dims() < scene.dims() {
        notes.push(format!("{} of {} dims, rest white", table.dims(), scene.dims()));
    }
    if table.extent().spp < spp as usize {
        notes.push(format!("{} of {spp} spp, rest displaced", table.extent().spp));
    }
    notes.join("; ")
}

fn print_ratios(entries: &[Entry]) -> io::Result<()> {
    let width = entries.iter().map(|entry| entry.label.len()).max().unwrap_or(0);
    say!("ratios to the expectation of white noise; lower is better")?;
    say!("{:width$}    RMSE  relMSE  pRelMSE s=2.1 +-error  pRelMSE sd=2.1", "sampler")?;
    for Entry { label, note, ratios, .. } in entries {
        say!(
            "{label:width$}  {:6.3}  {:6.3}  {:13.3}  {:6.3}  {:14.3}  {note}",
            ratios.rmse,
            ratios.rel_mse,
            ratios.p_rel_mse,
            ratios.p_rel_mse_error,
            ratios.p_rel_mse_wide,
        )?;
    }
    let floor = entries.iter().map(|entry| entry.ratios.floor).fold(0.0, f64::max);
    say!("the reference's own error contributes {floor:.5} to pRelMSE ratios")?;
    say!("s: exp(-r^2/2.1^2); sd: exp(-r^2/(2*2.1^2)); animations: after the eye's temporal filter")
}

/// A column per sampler, and the truth at the left.
fn contact_sheet(
    scene: &Scene,
    args: &Args,
    entries: &[Entry],
    reference: &Reference,
    temporal: &TemporalKernel,
) -> Result<Sheet, Failure> {
    let filter = ImageFilter::gaussian(2.1)?.with_temporal(temporal)?;
    let last = scene.frames - 1;
    let scales = Scales::new(reference, &filter, args.spp)?;
    let exposure = scales.exposure();
    let truth = filter.apply(&reference.mean)?;
    let kept = truth.shape()[0] - 1;

    let when = if scene.frames > 1 { ", last frame" } else { "" };
    let mut sheet = Sheet::new(
        args.resolution as usize,
        &format!("{}{when}: {} spp, {} x {}", scene.name, args.spp, args.resolution, args.resolution),
    );
    let of_all = if scene.frames > 1 { "spectrum, all frames" } else { "error spectrum" };
    let after = if scene.frames > 1 { "filtered, space + time" } else { "filtered, s = 2.1 px" };
    sheet.column(
        "reference",
        ["error, as a ratio", "to white noise:"],
        [
            Cell::linear("as rendered", reference.mean.frame(last)?, exposure),
            Cell::linear(after, truth.frame(kept)?, exposure),
            Cell::blank(&[
                "HOW TO READ",
                "",
                "Row 1: as rendered.",
                "Row 2: as the eye or a",
                "denoiser smooths it.",
                "Row 3: what is wrong in",
                "row 2; grey = nothing,",
                "ends = 3 deviations of",
                "white noise.",
                "Row 4: spectrum of the",
                "error; middle = low",
                "frequency = visible.",
                "Even grey: white noise.",
                "Dark middle: blue noise.",
            ]),
            Cell::blank(&[]),
        ],
    );
    for entry in entries {
        let error = entry.film.minus(&reference.mean)?;
        let filtered_error = filter.apply(&error)?;
        let spectrum = error_spectrum(&error, &reference.variance, args.spp);
        sheet.column(
            &entry.label,
            [
                &format!("pRelMSE  {:.3}", entry.ratios.p_rel_mse),
                &format!("RMSE     {:.3}", entry.ratios.rmse),
            ],
            [
                Cell::linear("as rendered", entry.film.frame(last)?, exposure),
                Cell::linear(after, filter.apply(&entry.film)?.frame(kept)?, exposure),
                Cell::levels(
                    "error of the filtered",
                    filtered_error.frame(kept)?.iter().map(|&error| scales.error(error)),
                ),
                // Half of the power, so that white noise is mid-grey.
                Cell::levels(of_all, spectrum.iter().map(|power| power / 2.0)),
            ],
        );
    }
    Ok(sheet)
}
