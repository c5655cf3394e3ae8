//! Tables of all variants, and what they are worth.

use fsot::{Config, Optimizer, SampleTable, Until};
use fsot_lab::judge::Judge;

use crate::averaged;
use crate::case::{Case, Failure, Outcome, Row};
use crate::factors::{Effort, Making, Variant};

/// A row per variant.
pub fn rows(cases: &[Case], variants: Vec<Variant>) -> Result<Vec<Row>, Failure> {
    let row = |variant: Variant| {
        let outcomes = cases.iter().map(|case| measure(case, &variant)).collect::<Result<_, _>>()?;
        Ok(Row { name: variant.name, outcomes })
    };
    variants.into_iter().map(row).collect()
}

/// The mean over the seeds of a case.
fn measure(case: &Case, variant: &Variant) -> Result<Outcome, Failure> {
    let judge = Judge::new(case.extent, case.integrands, case.bound_slices)?;
    let outcomes = (0..case.seeds).map(|seed| -> Result<Outcome, Failure> {
        let default = Config::new(case.extent, 2).with_companions(false).with_seed(seed);
        let mut config = default.clone();
        (variant.change)(&mut config);
        let slices_per_class = match variant.effort {
            Effort::Slices => case.slices_per_class,
            Effort::Seconds => {
                let calibration = case.slices_per_class.div_ceil(8);
                let share = quickest(&default, calibration)? / quickest(&config, calibration)?;
                (case.slices_per_class as f64 * share).round().max(1.0) as u64
            }
        };
        let until = Until::SlicesPerClass(slices_per_class);
        let (table, slices_per_class, seconds) = make(config, variant.making, until)?;
        Ok(Outcome { slices_per_class, seconds, quality: judge.judge(&table)? })
    });
    Ok(Outcome::mean(&outcomes.collect::<Result<Vec<_>, _>>()?))
}

/// Seconds of the quickest of three interludes: other work on the machine comes and goes.
fn quickest(config: &Config, slices_per_class: u64) -> Result<f64, Failure> {
    let mut quickest = f64::INFINITY;
    for _ in 0..3 {
        let until = Until::SlicesPerClass(slices_per_class);
        quickest = quickest.min(make(config.clone(), Making::Last, until)?.2);
    }
    Ok(quickest)
}

/// A table, its slices per class and its seconds.
fn make(config: Config, making: Making, until: Until) -> Result<(SampleTable, f64, f64), Failure> {
    let mut optimizer = Optimizer::new(config)?;
    if let Making::MeanOfLast(share) = making {
        return averaged::run(optimizer, until, share);
    }
    let report = optimizer.run(until)?;
    Ok((optimizer.into_table(), report.work.slices_per_class as f64, report.elapsed.as_secs_f64()))
}
