//! Tables of growing effort, and what they are worth.

use std::time::Instant;

use fsot::Config;
use fsot_lab::judge::Judge;
use fsot_lab::published::Published;

use crate::cases::Case;
use crate::methods::{Effort, METHODS, Made, Method};
use crate::outcome::{Curve, Failure, Outcome, Point};

/// Runs shorter than this are repeated; their median counts.
const SHORT_SECONDS: f64 = 1.0;
const REPEATS: usize = 3;

/// Ours and the published loop on a case.
pub fn measure(case: Case) -> Result<Outcome, Failure> {
    eprintln!("{}: ours", case.name);
    let judge = Judge::new(case.extent, case.integrands, case.bound_slices)?;
    let ours = measure_ours(&case, &judge)?;
    eprintln!("{}: the published loop, for {} s", case.name, case.published_seconds);
    let published = measure_published(&case, &judge)?;
    Ok(Outcome { ours, published, case })
}

/// All methods, effort by effort, so that a disturbance of the machine meets them alike.
fn measure_ours(case: &Case, judge: &Judge) -> Result<Vec<Curve>, Failure> {
    // The published objective has nothing but the kernel.
    let config = Config::new(case.extent, 2).with_companions(false);
    // Starts the threads.
    (METHODS[0].run)(&config, Effort { slices: case.least_effort, sweeps: 1 })?;
    let mut curves: Vec<Curve> =
        METHODS.iter().map(|method| Curve { method: method.name, points: Vec::new() }).collect();
    for doubling in 0.. {
        let effort = Effort { slices: case.least_effort << doubling, sweeps: 1 << doubling };
        let unfinished = |curve: &Curve| {
            curve.points.last().is_none_or(|point| 1.5 * point.seconds < case.longest_seconds)
        };
        let mut active: Vec<(&Method, &mut Curve)> =
            METHODS.iter().zip(&mut curves).filter(|(_, curve)| unfinished(curve)).collect();
        if active.is_empty() {
            break;
        }
        let mut runs: Vec<Vec<Made>> = active.iter().map(|_| Vec::new()).collect();
        for _ in 0..REPEATS {
            for ((method, _), runs) in active.iter().zip(&mut runs) {
                if runs.first().is_none_or(|first| first.seconds < SHORT_SECONDS) {
                    runs.push((method.run)(&config, effort)?);
                }
            }
        }
        for ((_, curve), runs) in active.iter_mut().zip(runs) {
            let first = &runs[0];
            assert!(runs.iter().all(|run| run.table == first.table), "the same seed gave another table");
            let seconds = median(runs.iter().map(|run| run.seconds).collect());
            curve.points.push(Point { seconds, slices: first.slices, quality: judge.judge(&first.table)? });
        }
    }
    Ok(curves)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

/// One run, looked at whenever its time has doubled.
fn measure_published(case: &Case, judge: &Judge) -> Result<Curve, Failure> {
    let mut published = Published::new(case.published.clone())?;
    let mut points = Vec::new();
    let mut seconds = 0.0;
    let mut next = case.published_first_seconds;
    while seconds < case.published_seconds {
        let begin = Instant::now();
        published.iterate();
        seconds += begin.elapsed().as_secs_f64();
        if seconds >= next.min(case.published_seconds) {
            let quality = judge.judge(&published.table())?;
            points.push(Point { seconds, slices: published.slices(), quality });
            next *= 2.0;
        }
    }
    Ok(Curve { method: "published loop", points })
}
