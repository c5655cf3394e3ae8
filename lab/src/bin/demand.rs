//! What a demand for a part of a table costs, as a share of what the whole table costs.
//!
//! ```text
//! cargo run --release -p fsot-lab --bin demand
//! ```
//!
//! Demanded are a disc, pixels here and there, and one dimension of all pixels; worked are slices and sweeps.
//! Each time has the planning in it, runs on one thread, and is the median of interleaved runs. With
//! `--quick` everything runs once on small tables.

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use fsot::classes::Demand;
use fsot::config::{Until, Work};
use fsot::{Config, Extent, Optimizer, SampleTable};
use fsot_lab::program::{self, Failure};
use fsot_lab::say;

/// What a demand for a part of a table costs.
#[derive(Parser)]
struct Arguments {
    /// Runs of each, whose median is printed.
    #[arg(long, default_value_t = 5)]
    runs: usize,
    /// Run everything once, on small tables.
    #[arg(long)]
    quick: bool,
}

/// Demanded shares of the pixels.
const SHARES: [f64; 4] = [0.3, 0.1, 0.03, 0.01];

/// What is demanded, in words; all if there is no demand.
type Case = (String, f64, Option<Demand>);

fn main() -> ExitCode {
    program::main(run)
}

fn run(&Arguments { runs, quick }: &Arguments) -> Result<(), Failure> {
    let (side, runs, work) = if quick { (24, 1, [2, 1]) } else { (96, runs.max(1), [64, 20]) };
    let still = Extent::still(side, side);
    let tables = [(still, 2), (still.with_spp(4), 4), (Extent { frames: 4, ..still }, 2)];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for (extent, dims) in tables {
        let Extent { frames, spp, .. } = extent;
        say!("\n{side}×{side}, {frames} frames, {spp} spp, {dims} dimensions\n")?;
        say!("| demanded | share | slices | sweeps |\n|---|---|---|---|")?;
        let config = Config::new(extent, dims);
        let cases = cases(extent, dims)?;
        let mut seconds = vec![[(); 2].map(|()| Vec::new()); cases.len()];
        for _ in 0..runs {
            for ((_, _, demand), seconds) in cases.iter().zip(&mut seconds) {
                for (engine, seconds) in seconds.iter_mut().enumerate() {
                    let [slices_per_class, sweeps] = [[work[0], 0], [0, work[1]]][engine];
                    let until = Until::Work(Work { slices_per_class, sweeps, ..Work::default() });
                    let begin = Instant::now();
                    pool.install(|| {
                        let optimizer = match demand {
                            None => Optimizer::new(config.clone()),
                            Some(demand) => Optimizer::for_demand(config.clone(), demand),
                        };
                        optimizer?.run(until)
                    })?;
                    seconds.push(begin.elapsed().as_secs_f64());
                }
            }
        }
        let medians: Vec<[f64; 2]> = seconds.into_iter().map(|engines| engines.map(median)).collect();
        for ((name, share, _), found) in cases.iter().zip(&medians) {
            let [slices, sweeps] = [0, 1].map(|engine| 100.0 * found[engine] / medians[0][engine]);
            say!("| {name} | {:.1} % | {slices:.1} % | {sweeps:.1} % |", 100.0 * share)?;
        }
        let [slices, sweeps] = medians[0].map(|seconds| 1000.0 * seconds);
        say!(
            "\n(100 %: {slices:.1} ms for {} slices per class, {sweeps:.1} ms for {} sweeps)",
            work[0],
            work[1]
        )?;
    }
    Ok(())
}

fn cases(extent: Extent, dims: usize) -> Result<Vec<Case>, Failure> {
    let Extent { frames, height, width, .. } = extent;
    let shape = [frames, height, width];
    let groups: Vec<Vec<usize>> = (0..dims).step_by(2).map(|dim| vec![dim, dim + 1]).collect();
    let one = Demand::new(shape, vec![true; extent.sites()], vec![vec![0]])?;
    let name = format!("one of {dims} dimensions");
    let mut cases = vec![("all".into(), 1.0, None), (name, 1.0 / dims as f64, Some(one))];
    let noise = SampleTable::white_noise(extent.with_spp(1), 1, 1)?.into_values();
    for share in SHARES {
        let in_disc = |site: usize| {
            let site = extent.site(site);
            let from = |at: usize, len: usize| at as f64 + 0.5 - len as f64 / 2.0;
            let area = std::f64::consts::PI * (from(site.y, height).powi(2) + from(site.x, width).powi(2));
            area <= share * (height * width) as f64
        };
        let disc = (0..extent.sites()).map(in_disc).collect();
        let scattered = noise.iter().map(|&value| f64::from(value) < share).collect();
        for (name, pixels) in [("a disc", disc), ("scattered pixels", scattered)] {
            let demand = Demand::new(shape, pixels, groups.clone())?;
            cases.push((name.into(), demand.share(), Some(demand)));
        }
    }
    Ok(cases)
}

fn median(mut seconds: Vec<f64>) -> f64 {
    seconds.sort_unstable_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}
