//! What a table is to be: by flags, by a file, or by both, and otherwise as usual.

use std::path::Path;

use clap::ValueEnum;
use fsot::classes::{Classes, FilterForm};
use fsot::config::{Descent, DimensionGroup, Schedule, Slicing, Sweeps, Term, Work};
use fsot::kernel::SpatialKernel;
use fsot::{Config, Extent, Kernel, Until};
use serde::Deserialize;

use super::stencil::{self, Stencil};
use super::values::{Domains, Groups, KernelSource, Temporal};
use crate::{Failure, temporal};

/// What is said; `None` is as usual. The keys of a file are the names of the flags, and some more.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Recipe {
    pub width: Option<usize>,
    pub height: Option<usize>,
    pub frames: Option<usize>,
    pub spp: Option<usize>,
    pub dims: Option<usize>,
    pub sigma: Option<f64>,
    pub kernel: Option<KernelSource>,
    pub temporal: Option<Temporal>,
    pub truncation: Option<f64>,
    pub kernels: Option<Vec<Kernel>>,
    pub form: Option<FilterForm>,
    pub companions: Option<bool>,
    pub groups: Option<Groups>,
    pub terms: Option<Vec<Term>>,
    pub domain: Option<Domains>,
    pub optimizer: Option<DescentName>,
    pub descent: Option<Descent>,
    pub slicing: Option<Slicing>,
    pub sweeping: Option<Sweeping>,
    pub balance: Option<Schedule>,
    pub seed: Option<u64>,
    pub seconds: Option<f64>,
    pub slices_per_class: Option<u64>,
    pub sweeps: Option<u64>,
    pub frame_sweeps: Option<u64>,
    /// Steps after which the run of a file ended early.
    #[serde(skip)]
    pub steps: Option<u64>,
    /// Why the run of a file makes something else than its table.
    #[serde(skip)]
    pub obstacle: Option<&'static str>,
}

/// How slices move the samples.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum DescentName {
    Barycentric,
    Adam,
    Sgd,
}

/// How sweeps move them, as far as it is said.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Sweeping {
    rate: Option<Schedule>,
    polish: Option<Schedule>,
    truncation: Option<f64>,
    softening: Option<f64>,
}

impl From<Sweeping> for Sweeps {
    fn from(said: Sweeping) -> Self {
        let usual = Self::default();
        Self {
            rate: said.rate.unwrap_or(usual.rate),
            polish: said.polish.unwrap_or(usual.polish),
            truncation: said.truncation.unwrap_or(usual.truncation),
            softening: said.softening.unwrap_or(usual.softening),
        }
    }
}

impl From<Sweeps> for Sweeping {
    fn from(Sweeps { rate, polish, truncation, softening }: Sweeps) -> Self {
        let (truncation, softening) = (Some(truncation), Some(softening));
        Self { rate: Some(rate), polish: Some(polish), truncation, softening }
    }
}

/// Pairs of keys that say the same thing twice.
const EITHER: [(&str, &str); 17] = [
    ("sigma", "kernel"),
    ("sigma", "kernels"),
    ("kernel", "kernels"),
    ("temporal", "kernels"),
    ("truncation", "kernels"),
    ("sigma", "terms"),
    ("kernel", "terms"),
    ("temporal", "terms"),
    ("truncation", "terms"),
    ("kernels", "terms"),
    ("form", "terms"),
    ("companions", "terms"),
    ("groups", "terms"),
    ("optimizer", "descent"),
    ("seconds", "slices_per_class"),
    ("seconds", "sweeps"),
    ("seconds", "frame_sweeps"),
];

impl Recipe {
    /// Refuses what says the same thing twice.
    ///
    /// # Errors
    /// The two keys.
    pub fn check(&self) -> Result<(), String> {
        if let Some((one, other)) = EITHER.iter().find(|(one, other)| self.says(one) && self.says(other)) {
            return Err(format!("{one} and {other} say the same thing twice: leave out one of them"));
        }
        if self.frame_sweeps.is_some() && self.sweeps.is_none() {
            return Err("frame_sweeps begin a run of sweeps: say how many sweeps, too".into());
        }
        Ok(())
    }

    fn says(&self, key: &str) -> bool {
        match key {
            "sigma" => self.sigma.is_some(),
            "kernel" => self.kernel.is_some(),
            "kernels" => self.kernels.is_some(),
            "temporal" => self.temporal.is_some(),
            "truncation" => self.truncation.is_some(),
            "form" => self.form.is_some(),
            "companions" => self.companions.is_some(),
            "groups" => self.groups.is_some(),
            "terms" => self.terms.is_some(),
            "optimizer" => self.optimizer.is_some(),
            "descent" => self.descent.is_some(),
            "seconds" => self.seconds.is_some(),
            "slices_per_class" => self.slices_per_class.is_some(),
            "sweeps" => self.sweeps.is_some(),
            "frame_sweeps" => self.frame_sweeps.is_some(),
            _ => false,
        }
    }

    /// Whether anything is said of how long the run is.
    fn says_how_long(&self) -> bool {
        ["seconds", "slices_per_class", "sweeps", "frame_sweeps"].iter().any(|key| self.says(key))
    }

    /// These flags, and what a file says where they say nothing. A flag replaces what says the same thing in
    /// other words: a width of the Gaussian a kernel, terms all filters, an amount of work a time.
    ///
    /// # Errors
    /// A flag that changes a part of what the file says as a whole; the metadata of a table that their run
    /// does not make again, unless flags say how long another is.
    pub fn over(self, mut file: Self, name: &Path) -> Result<Self, Failure> {
        let name = name.display();
        for (flag, key) in [("--sigma", "sigma"), ("--kernel", "kernel"), ("--temporal", "temporal")] {
            if self.says(key) && file.kernels.is_some() {
                return Err(
                    format!("{flag} is for one kernel, but {name} has several: change them there").into()
                );
            }
            if self.says(key) && file.terms.is_some() {
                return Err(format!(
                    "{flag} is for the usual terms, but {name} lists others: change them there"
                )
                .into());
            }
        }
        if self.says("groups") && file.terms.is_some() {
            return Err(format!(
                "--groups is for the usual terms, but {name} lists others: change them there"
            )
            .into());
        }
        let replaces_kernel = self.sigma.is_some() || self.kernel.is_some();
        if self.temporal.is_some() && !replaces_kernel && file.kernel_has_frames() {
            let problem = "has weights for each frame already: leave out the temporal kernel";
            return Err(format!("the kernel of {name} {problem} (--temporal)").into());
        }
        if replaces_kernel {
            // Weights for each frame stand for the temporal kernel as well.
            if file.kernel_has_frames() || self.kernel_has_frames() {
                file.temporal = None;
            }
            (file.sigma, file.kernel) = (None, None);
        }
        if self.terms.is_some() {
            let Self { sigma, kernel, kernels, temporal, truncation, form, companions, groups, .. } =
                &mut file;
            (*sigma, *kernel, *kernels, *temporal, *truncation) = (None, None, None, None, None);
            (*form, *companions, *groups) = (None, None, None);
        }
        if self.optimizer.is_some() {
            file.descent = None;
        }
        if self != Self::default() {
            // It was about that very table.
            file.steps = None;
        }
        if let (Some(obstacle), false) = (file.obstacle, self.says_how_long()) {
            return Err(format!(
                "the table of {name} cannot be made again: {obstacle}; say how long a run from white noise \
                 is to be, as by --sweeps 100, for another table of its configuration"
            )
            .into());
        }
        if self.says_how_long() {
            let Self { seconds, slices_per_class, sweeps, frame_sweeps, .. } = &mut file;
            (*seconds, *slices_per_class, *sweeps, *frame_sweeps) = (None, None, None, None);
        }
        let is_resized = self.width.is_some() || self.height.is_some();
        let recipe = Self {
            width: self.width.or(file.width),
            height: self.height.or(file.height),
            frames: self.frames.or(file.frames),
            spp: self.spp.or(file.spp),
            dims: self.dims.or(file.dims),
            sigma: self.sigma.or(file.sigma),
            kernel: self.kernel.or(file.kernel),
            temporal: self.temporal.or(file.temporal),
            groups: self.groups.or(file.groups),
            terms: self.terms.or(file.terms),
            domain: self.domain.or(file.domain),
            optimizer: self.optimizer.or(file.optimizer),
            seed: self.seed.or(file.seed),
            seconds: self.seconds.or(file.seconds),
            slices_per_class: self.slices_per_class.or(file.slices_per_class),
            sweeps: self.sweeps.or(file.sweeps),
            frame_sweeps: self.frame_sweeps.or(file.frame_sweeps),
            // What no flag says.
            ..file
        };
        if is_resized {
            for term in recipe.terms.iter().flatten() {
                if let Classes::Lattice { kernel, .. } = &term.classes {
                    fits(&kernel.spatial, &recipe.extent())?;
                }
            }
        }
        Ok(recipe)
    }

    /// Whether its weights are those of several frames, as far as that can be read.
    fn kernel_has_frames(&self) -> bool {
        match &self.kernel {
            Some(KernelSource::Given(spatial)) => matches!(spatial, SpatialKernel::PerFrame(_)),
            Some(KernelSource::Rows(stencil)) => stencil.over_time,
            Some(KernelSource::File(path)) => Stencil::open(path).is_ok_and(|stencil| stencil.over_time),
            None => false,
        }
    }

    fn extent(&self) -> Extent {
        let [width, height] = [self.width, self.height].map(|side| side.unwrap_or(64));
        Extent { frames: self.frames.unwrap_or(10), height, width, spp: self.spp.unwrap_or(1) }
    }

    /// How long the run is.
    pub fn until(&self) -> Until {
        if let Some(seconds) = self.seconds {
            return Until::Seconds(seconds);
        }
        let wraps = self.domain.as_ref().is_some_and(Domains::any_wraps);
        let slices_only = self.optimizer.is_some() || self.descent.is_some() || wraps;
        let slices = if slices_only { Some(320) } else { None };
        match (self.slices_per_class.or(slices), self.sweeps, self.frame_sweeps) {
            (None | Some(0), None, _) => Until::Usual,
            (None, Some(sweeps), None) => Until::Sweeps(sweeps),
            (slices, sweeps, frame_sweeps) => Until::Work(Work {
                frame_sweeps: frame_sweeps.unwrap_or(0),
                slices_per_class: slices.unwrap_or(0),
                sweeps: sweeps.unwrap_or(0),
            }),
        }
    }

    /// What is optimised.
    ///
    /// # Errors
    /// A file with a kernel that cannot be read or used.
    pub fn config(&self) -> Result<Config, Failure> {
        let extent = self.extent();
        let dims = self.dims.unwrap_or(2);
        let mut config = Config::new(extent, dims).with_seed(self.seed.unwrap_or(0));
        match &self.domain {
            Some(Domains::All(domain)) => config = config.with_domain(*domain),
            Some(Domains::Each(domains)) => config = config.with_domains(domains.clone()),
            None => {}
        }
        config.descent = match (self.optimizer, self.descent) {
            (_, Some(descent)) => descent,
            (None | Some(DescentName::Barycentric), None) => Descent::barycentric(),
            (Some(DescentName::Adam), None) => Descent::adam(),
            (Some(DescentName::Sgd), None) => Descent::sgd(),
        };
        config.slicing = self.slicing.clone().unwrap_or(config.slicing);
        config.sweeps = self.sweeping.map_or(config.sweeps, Sweeps::from);
        config.balance = self.balance.unwrap_or(config.balance);
        if let Some(terms) = &self.terms {
            config = config.with_terms(terms.clone());
            config.companions = self.companions.unwrap_or(false);
            return Ok(config);
        }
        let groups = match &self.groups {
            Some(Groups(groups)) => groups.clone(),
            None => DimensionGroup::pairs_and_whole(dims),
        };
        Ok(config
            .with_companions(self.companions.unwrap_or(true))
            .with_form(self.form.unwrap_or_default())
            .with_kernels(&self.kernels(&extent)?)
            // Last, so that their weights are not computed back.
            .with_groups(&groups))
    }

    fn kernels(&self, extent: &Extent) -> Result<Vec<Kernel>, Failure> {
        if let Some(kernels) = &self.kernels {
            kernels.iter().try_for_each(|kernel| fits(&kernel.spatial, extent))?;
            return Ok(kernels.clone());
        }
        let given = self.temporal.as_ref().map(|Temporal(temporal)| temporal);
        let temporal = temporal::or_default(given, extent.frames);
        let of = |stencil: &Stencil, name: &str| -> Result<_, Failure> {
            let failed = |problem| format!("{name} {problem} (--kernel)");
            let kernel = stencil.kernel(extent).map_err(failed)?;
            if stencil.over_time && given.is_some() {
                let problem = "has weights for each frame already: leave out the temporal kernel";
                return Err(format!("{name} {problem} (--temporal)").into());
            }
            Ok(if stencil.over_time { kernel } else { kernel.with_temporal(temporal.clone()) })
        };
        let mut kernel = match &self.kernel {
            None => {
                let sigma_px = self.sigma.unwrap_or(2.1);
                Kernel::product(SpatialKernel::Gaussian { sigma_px }, temporal)
            }
            Some(KernelSource::Given(spatial)) => {
                fits(spatial, extent)?;
                Kernel::product(spatial.clone(), temporal)
            }
            Some(KernelSource::Rows(stencil)) => of(stencil, "the kernel")?,
            Some(KernelSource::File(path)) => {
                let name = path.display().to_string();
                let stencil =
                    Stencil::open(path).map_err(|problem| format!("{name} {problem} (--kernel)"))?;
                of(&stencil, &name)?
            }
        };
        kernel.truncation = self.truncation.unwrap_or(kernel.truncation);
        Ok(vec![kernel])
    }
}

/// Refuses weights that would come in again from the other side of the tile.
fn fits(kernel: &SpatialKernel, extent: &Extent) -> Result<(), Failure> {
    let Some(span) = kernel.span() else { return Ok(()) };
    stencil::fits(span, extent).map_err(|problem| format!("the kernel {problem} (--kernel)").into())
}
