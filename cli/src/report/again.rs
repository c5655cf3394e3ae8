//! The command that makes a table again, where its metadata say how it was made.

use std::path::Path;

use fsot::files::{Metadata, shell};
use fsot::kernel::SpatialKernel;
use fsot::{Config, Kernel};

use crate::inspect::{Beside, temporal_flag};
use crate::table::obstacle;

/// How a table came to be, for a reader.
pub struct Origin {
    /// One sentence or more.
    pub words: String,
    /// What makes it again.
    pub command: Option<String>,
    /// The configuration, as it lies in the metadata.
    pub configuration: Option<String>,
}

/// Longer configurations (lists of pixels, say) are left where they are.
const LONGEST: usize = 40_000;

impl Origin {
    /// Of the table at this path, if it has one, which is measured under this kernel.
    pub fn new(path: Option<&Path>, beside: &Beside, kernel: &Kernel) -> Self {
        let nothing = |words| Self { words, command: None, configuration: None };
        match beside {
            Beside::Nothing => {
                nothing("No metadata lie beside the table, so nobody knows how it was made.".into())
            }
            Beside::Unusable(error) => nothing(format!("The metadata beside it cannot be used: {error}.")),
            Beside::Foreign(problem) => {
                nothing(format!("The metadata beside it are not of this table: {problem}."))
            }
            Beside::Own(metadata) => Self::known(path, metadata, kernel),
        }
    }

    fn known(path: Option<&Path>, metadata: &Metadata, kernel: &Kernel) -> Self {
        let Metadata { crate_version, seed, run, bound, sha256, configuration, .. } = metadata;
        let mut words = format!(
            "Made by fsot {crate_version} with seed {seed}, in {} steps and {:.2} s: {} sweeps of the \
             frame that an animation begins with, {} slices per pixel, {} sweeps.",
            run.steps, run.seconds, run.frame_sweeps, run.slices_per_class, run.sweeps
        );
        if let Some(bound) = bound {
            let [before, after] = [bound.before, bound.after].map(|bound| bound.ratio_to_white_noise);
            words += &format!(
                " By its own objective, the bound went from {before:.3} to {after:.3} of white noise’s."
            );
        }
        if sha256.is_none() {
            words += " The metadata do not say of which values they are.";
        }
        let config = serde_json::from_value::<Config>(configuration.clone());
        let config = config.ok().filter(|config| {
            let [frames, height, width, spp, dims] = metadata.shape;
            config.extent == fsot::Extent { frames, height, width, spp } && config.dims == dims
        });
        let kernels = config.as_ref().map(Config::kernels).unwrap_or_default();
        if !kernels.is_empty() && !kernels.contains(kernel) {
            words += " It was made for another filter than that of this page";
            if let [Some(flags)] = &*kernels.iter().map(flags).collect::<Vec<_>>() {
                words += &format!(": give {flags} to see it under its own");
            }
            words += ".";
        }
        let obstacle = obstacle(run).filter(|_| config.is_some());
        let command = match (config.is_some(), path.map(Path::to_str)) {
            _ if obstacle.is_some() => {
                words += &format!(" No command makes it again: {}.", obstacle.unwrap_or_default());
                None
            }
            (false, _) => {
                words += " Their configuration is none of fsot table, so there is no command that makes \
                          the table again.";
                None
            }
            // Whoever has the table has its configuration at hand.
            (true, None) => None,
            (true, Some(None)) => {
                words += " The name of its file is not text, so that no command can be printed.";
                None
            }
            (true, Some(Some(path))) => {
                let json = shell::path(Metadata::path_beside(Path::new(path)));
                Some(format!("fsot table --config {json} --out again.npy"))
            }
        };
        let text = serde_json::to_string_pretty(configuration).unwrap_or_default();
        let configuration = (text.len() <= LONGEST).then_some(text);
        if configuration.is_none() {
            words += " The configuration is long: read it in the metadata.";
        }
        Self { words, command, configuration }
    }
}

/// What makes this the filter of the page.
fn flags(kernel: &Kernel) -> Option<String> {
    let SpatialKernel::Gaussian { sigma_px } = kernel.spatial else { return None };
    Some(format!("--sigma {sigma_px} --temporal {}", temporal_flag(&kernel.temporal)?))
}
