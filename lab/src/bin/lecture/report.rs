//! The figures: one table to read, and all of them as CSV.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write;

use crate::Failure;
use crate::contenders::Contender;
use crate::measure::Stage;

/// Ratios of all realisations.
#[derive(Default)]
pub struct Report {
    found: BTreeMap<(Stage, u32, &'static str, Contender), Vec<f64>>,
}

impl Report {
    pub fn add(&mut self, contender: Contender, scene: &'static str, stage: Stage, spp: u32, ratio: f64) {
        self.found.entry((stage, spp, scene, contender)).or_default().push(ratio);
    }

    /// Mean over realisations.
    pub fn mean(&self, contender: Contender, scene: &'static str, stage: Stage, spp: u32) -> Option<f64> {
        let ratios = self.found.get(&(stage, spp, scene, contender))?;
        Some(ratios.iter().sum::<f64>() / ratios.len() as f64)
    }

    /// Geometric mean over scenes; none if the method does not apply.
    fn over_scenes(&self, contender: Contender, stage: Stage, spp: u32) -> Option<f64> {
        let mut logs = Vec::new();
        for ((s, n, _, c), ratios) in &self.found {
            if (*s, *n, *c) == (stage, spp, contender) {
                logs.push((ratios.iter().sum::<f64>() / ratios.len() as f64).ln());
            }
        }
        (!logs.is_empty()).then(|| (logs.iter().sum::<f64>() / logs.len() as f64).exp())
    }

    /// One row per sampler, one column per stage and number of samples.
    pub fn print(&self, out: &mut dyn Write, spps: &[u32]) -> Result<(), Failure> {
        writeln!(
            out,
            "squared error as ratio to white noise of as many samples, geometric mean over scenes; < is the best, \
             - does not apply"
        )?;
        write!(out, "{:24}", "")?;
        for stage in Stage::ALL {
            write!(out, "| {:w$}", stage.name(), w = 7 * spps.len())?;
        }
        write!(out, "\n{:24}", "samples per pixel")?;
        for _ in Stage::ALL {
            write!(out, "| ")?;
            spps.iter().try_for_each(|spp| write!(out, "{spp:>5}  "))?;
        }
        writeln!(out)?;
        let best = |stage, spp| {
            let fair = Contender::ALL.into_iter().filter(|contender| !contender.is_a_posteriori());
            fair.filter_map(|contender| self.over_scenes(contender, stage, spp)).fold(f64::INFINITY, f64::min)
        };
        for contender in Contender::ALL {
            write!(out, "{:24}", contender.name())?;
            for stage in Stage::ALL {
                write!(out, "| ")?;
                for &spp in spps {
                    match self.over_scenes(contender, stage, spp) {
                        None => write!(out, "{:>5}  ", "-")?,
                        Some(ratio) => {
                            let mark = if ratio == best(stage, spp) { '<' } else { ' ' };
                            write!(out, "{ratio:5.3}{mark} ")?;
                        }
                    }
                }
            }
            writeln!(out)?;
        }
        writeln!(
            out,
            "* looks at rendered values; not among the best. The histogram renders 8 pictures for one."
        )?;
        Ok(())
    }

    /// Every figure with its standard error over realisations.
    pub fn csv(&self) -> String {
        let mut csv =
            String::from("stage,spp,scene,sampler,ratio_to_white_noise,standard_error,realisations\n");
        for ((stage, spp, scene, contender), ratios) in &self.found {
            let count = ratios.len() as f64;
            let mean = ratios.iter().sum::<f64>() / count;
            let spread: f64 = ratios.iter().map(|ratio| (ratio - mean).powi(2)).sum();
            let error = (spread / (count - 1.0) / count).sqrt();
            let error = if error.is_finite() { format!("{error:.5}") } else { String::new() };
            let (stage, sampler) = (stage.name(), contender.name());
            let _ = writeln!(csv, "{stage},{spp},{scene},{sampler},{mean:.5},{error},{count}");
        }
        csv
    }
}
