//! A configuration of the library in the words of a recipe, so that flags can change single things of it.

use fsot::Config;
use fsot::classes::{Classes, FilterForm};
use fsot::config::{Descent, DimensionGroup, Domain, Schedule, Slicing, Sweeps};
use fsot::files::{RunRecord, RunStart};
use fsot::kernel::SpatialKernel;

use super::recipe::{Recipe, Sweeping};
use super::values::{Domains, Groups, KernelSource, Temporal};
use crate::temporal;

impl Recipe {
    /// What makes this very configuration, and the same work again.
    ///
    /// What is as usual is left unsaid, so that it follows what flags change: a still that becomes an
    /// animation gets the temporal kernel of animations. Terms that are others than the usual ones are
    /// listed.
    pub fn of_config(config: Config, run: Option<RunRecord>) -> Self {
        let literal = Self::of_parts(&config);
        let usual = literal.clone().with_usual_terms(&config);
        let same = |recipe: &Self| recipe.config().is_ok_and(|made| made == config);
        let mut recipe = match usual.filter(same) {
            Some(usual) => usual,
            None => Self { companions: Some(config.companions), terms: Some(config.terms), ..literal },
        };
        if let Some(RunRecord { frame_sweeps, slices_per_class, sweeps, ended_early, steps, .. }) = run {
            recipe.obstacle = run.as_ref().and_then(obstacle);
            recipe.frame_sweeps = Some(frame_sweeps);
            recipe.slices_per_class = Some(slices_per_class);
            recipe.sweeps = Some(sweeps);
            recipe.steps = ended_early.then_some(steps);
        }
        recipe
    }

    /// All but the terms.
    fn of_parts(config: &Config) -> Self {
        let Config { extent, dims, domains, slicing, descent, sweeps, balance, seed, .. } = config;
        let domain = match domains.first() {
            Some(&first) if domains.len() == *dims && domains.iter().all(|domain| *domain == first) => {
                Some(Domains::All(first)).filter(|_| first != Domain::Interval)
            }
            _ => Some(Domains::Each(domains.clone())),
        };
        Self {
            width: Some(extent.width),
            height: Some(extent.height),
            frames: Some(extent.frames),
            spp: Some(extent.spp),
            dims: Some(*dims),
            domain,
            slicing: Some(slicing.clone()).filter(|slicing| *slicing != Slicing::default()),
            descent: Some(*descent).filter(|descent| *descent != Descent::default()),
            sweeping: Some(*sweeps).filter(|sweeps| *sweeps != Sweeps::default()).map(Sweeping::from),
            balance: Some(*balance).filter(|balance| *balance != Schedule::constant(1.0)),
            seed: Some(*seed),
            ..Self::default()
        }
    }

    /// The kernels, groups and forms that these terms are of; `None` if they are none of a table.
    fn with_usual_terms(mut self, config: &Config) -> Option<Self> {
        let form = config.terms.iter().find_map(|term| match term.classes {
            Classes::Lattice { form, .. } => Some(form),
            _ => None,
        })?;
        let groups = config.groups();
        self.form = Some(form).filter(|form| *form != FilterForm::default());
        self.companions = Some(config.companions).filter(|companions| !companions);
        self.groups =
            Some(Groups(groups)).filter(|Groups(all)| *all != DimensionGroup::pairs_and_whole(config.dims));
        let kernels = config.kernels();
        let [kernel] = kernels.as_slice() else {
            return Some(Self { kernels: Some(kernels), ..self });
        };
        match kernel.spatial {
            SpatialKernel::Gaussian { sigma_px } => {
                self.sigma = Some(sigma_px).filter(|sigma| *sigma != 2.1);
            }
            ref other => self.kernel = Some(KernelSource::Given(other.clone())),
        }
        let usual = temporal::or_default(None, config.extent.frames);
        let temporal = Some(kernel.temporal.clone()).filter(|temporal| *temporal != usual);
        self.temporal = temporal.map(Temporal);
        self.truncation = Some(kernel.truncation).filter(|truncation| *truncation != 1e-3);
        Some(self)
    }
}

/// Why a run of this configuration and work does not make the table again.
pub fn obstacle(run: &RunRecord) -> Option<&'static str> {
    match run.beginning() {
        RunStart::WhiteNoise => None,
        RunStart::Demand => Some("it was optimised for a demand, which its metadata do not hold"),
        _ => Some(
            "its run did not begin with the white noise of its seed, and its metadata do not hold what it \
             began with",
        ),
    }
}
