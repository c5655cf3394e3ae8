//! The figures: one table to read, and all of them as CSV.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use fsot_lab::figures::{mean_and_error, write_csv};
use fsot_lab::program;

use crate::Failure;
use crate::contenders::{CONTENDERS, Contender};
use crate::measure::Stage;

/// Ratios of all realisations.
#[derive(Default)]
pub struct Report {
    /// By stage, samples per pixel, scene, and place in [`CONTENDERS`].
    found: BTreeMap<(Stage, u32, &'static str, usize), Vec<f64>>,
}

impl Report {
    /// Adds a realisation of the contender at this place.
    pub fn add(&mut self, contender: usize, scene: &'static str, stage: Stage, spp: u32, ratio: f64) {
        self.found.entry((stage, spp, scene, contender)).or_default().push(ratio);
    }

    /// Mean over realisations.
    pub fn mean(&self, contender: usize, scene: &'static str, stage: Stage, spp: u32) -> Option<f64> {
        Some(mean_and_error(self.found.get(&(stage, spp, scene, contender))?).0)
    }

    /// Geometric mean over scenes; none if the method does not apply.
    fn over_scenes(&self, contender: usize, stage: Stage, spp: u32) -> Option<f64> {
        let mut logs = Vec::new();
        for ((s, n, _, c), ratios) in &self.found {
            if (*s, *n, *c) == (stage, spp, contender) {
                logs.push(mean_and_error(ratios).0.ln());
            }
        }
        (!logs.is_empty()).then(|| mean_and_error(&logs).0.exp())
    }

    /// The least error of those that know nothing of rendered values.
    fn best(&self, stage: Stage, spp: u32) -> f64 {
        let fair = CONTENDERS.iter().enumerate().filter(|(_, contender)| !contender.a_posteriori);
        fair.filter_map(|(at, _)| self.over_scenes(at, stage, spp)).fold(f64::INFINITY, f64::min)
    }

    /// One row per sampler, one column per stage and number of samples.
    pub fn print(&self, out: &mut dyn Write, spps: &[u32]) -> io::Result<()> {
        writeln!(
            out,
            "squared error as ratio to white noise of as many samples, geometric mean over scenes; < is the \
             best, - does not apply"
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
        for (at, Contender { name, .. }) in CONTENDERS.iter().enumerate() {
            write!(out, "{name:24}")?;
            for stage in Stage::ALL {
                write!(out, "| ")?;
                for &spp in spps {
                    match self.over_scenes(at, stage, spp) {
                        None => write!(out, "{:>5}  ", "-")?,
                        Some(ratio) => {
                            let mark = if ratio == self.best(stage, spp) { '<' } else { ' ' };
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
        )
    }

    /// Writes every figure, with its standard error over realisations.
    pub fn save_csv(&self, path: &Path) -> Result<(), Failure> {
        let heading =
            ["stage", "spp", "scene", "sampler", "ratio_to_white_noise", "standard_error", "realisations"];
        let rows = self.found.iter().map(|((stage, spp, scene, contender), ratios)| {
            let (mean, error) = mean_and_error(ratios);
            [
                stage.name().into(),
                spp.to_string(),
                (*scene).into(),
                CONTENDERS[*contender].name.into(),
                format!("{mean:.5}"),
                error.map_or(String::new(), |error| format!("{error:.5}")),
                ratios.len().to_string(),
            ]
        });
        let mut text = Vec::new();
        write_csv(&mut text, heading, rows)?;
        program::save(path, &text)
    }
}
