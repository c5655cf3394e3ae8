//! What is measured of a table, and how it is said to programs.

use std::path::Path;

use fsot::config::DimensionGroup;
use fsot::files::{BoundEstimate, Metadata};
use fsot::metrics::{
    Bias, Bound, Discrepancy, Estimate, FaceDensity, FilteredError, Integrands, Marginal, Ratios, Spectra,
};
use fsot::{Config, Extent, Objective};
use serde_json::{Map, Value, json};

use super::evenness::Evenness;
use super::{Beside, Inspection};
use crate::Failure;

/// Cycles per pixel below which a frequency counts as low; the default filter halves the power at 0.09.
pub const LOW: f64 = 0.1;

/// Bins of a single dimension.
pub const BINS: usize = 64;

/// Pairs of samples whose comparison takes some ten seconds.
const MOST_PAIRS: u64 = 10_000_000_000;

/// What is measured of one dimension group.
pub struct GroupFigures {
    pub dims: Vec<usize>,
    /// Whether there are frames to tell apart.
    pub animated: bool,
    pub errors: FilteredError,
    pub bias: Bias,
    /// Of the first two dimensions.
    pub evenness: Evenness,
    /// Of each dimension of the group.
    pub marginals: Vec<Marginal>,
    /// As a ratio to white noise; left out where it would take too long.
    pub discrepancy: Option<f64>,
    pub samples_per_frame: u64,
    pub spectra: Spectra,
    /// Power at low frequencies, if the tile has any.
    pub low: Option<f64>,
}

impl GroupFigures {
    pub fn measure(inspection: &Inspection, dims: Vec<usize>) -> Result<Self, Failure> {
        let Inspection { table, kernel, .. } = inspection;
        let extent = table.extent();
        let integrands = Integrands::random(dims.len(), inspection.integrands, inspection.seed)?;
        let errors = FilteredError::measure(table, &dims, &integrands, kernel)?;
        let bias = Bias::measure(table, &dims, &integrands)?;
        let evenness = Evenness::new(table, &dims[..dims.len().min(2)])?;
        let marginals = dims.iter().map(|&dim| Marginal::measure(table, dim, BINS));
        let marginals = marginals.collect::<Result<_, _>>()?;
        let per_frame = (extent.samples() / extent.frames) as u64;
        let pairs = per_frame.saturating_mul(per_frame).saturating_mul((extent.frames * dims.len()) as u64);
        let discrepancy = match pairs {
            0..=MOST_PAIRS => Some(Discrepancy::measure(table, &dims)?.ratio_to_white_noise),
            _ => None,
        };
        let spectra = Spectra::measure(table, &dims, &integrands)?;
        let low = Some(spectra.low_frequency_share(LOW)).filter(|low| low.is_finite());
        Ok(Self {
            animated: extent.frames > 1,
            samples_per_frame: per_frame,
            dims,
            errors,
            bias,
            evenness,
            marginals,
            discrepancy,
            spectra,
            low,
        })
    }

    fn json(&self) -> Value {
        let Self { dims, animated, errors, bias, evenness, marginals, discrepancy, spectra, low, .. } = self;
        let of_frames = |figure: &Ratios| animated.then(|| ratios(figure));
        let histogram = (dims.len() <= 2 && evenness.per_side > 1).then(|| {
            let [emptiest, fullest] = evenness.extremes();
            json!({
                "cells": evenness.counts.len(),
                "spread": evenness.spread,
                "emptiest": emptiest,
                "fullest": fullest,
                "corners": evenness.corners,
            })
        });
        json!({
            "dims": dims,
            "error": {
                "unfiltered": ratios(&errors.unfiltered),
                "spatial": ratios(&errors.spatial),
                "spatio_temporal": of_frames(&errors.spatio_temporal),
            },
            "bias": {
                "table": ratios(&bias.table),
                "frame": of_frames(&bias.frame),
                "pixel": ratios(&bias.pixel),
            },
            "histogram": histogram,
            "marginals": marginals.iter().map(marginal).collect::<Vec<_>>(),
            "squared_l2_discrepancy": discrepancy,
            "power_at_low_frequencies": low,
            "power_along_y_over_along_x": spectra.anisotropy().map(|ring| ring.along_y_over_along_x),
        })
    }
}

/// The objective of `Term::blue_noise` for this shape and filter, at the table.
pub fn bound(inspection: &Inspection, groups: &[DimensionGroup]) -> Result<BoundEstimate, Failure> {
    let Inspection { table, kernel, bound_slices, seed, .. } = inspection;
    let config = Config::new(table.extent(), table.dims()).with_groups(groups).with_kernel(kernel.clone());
    let objective = Objective::new(&config)?;
    Ok(Bound::measure(table, &objective, *seed, *bound_slices)?.total)
}

/// Everything, for `--json`; what was not measured is `null`.
pub fn json(
    inspection: &Inspection,
    beside: &Beside,
    groups: &[GroupFigures],
    bound: &BoundEstimate,
    page: Option<&Path>,
) -> Value {
    let Inspection { name, table, kernel, integrands, seed, .. } = inspection;
    let Extent { frames, height, width, spp } = table.extent();
    let metadata = match beside {
        Beside::Nothing => Value::Null,
        Beside::Unusable(error) => json!({ "unusable": error.to_string() }),
        Beside::Foreign(problem) => json!({ "of_another_table": problem.to_string() }),
        Beside::Own(metadata) => {
            let Metadata { crate_version, seed, run, bound, sha256, .. } = &**metadata;
            json!({
                "crate_version": crate_version,
                "seed": seed,
                "run": run,
                "bound": bound,
                "says_of_which_values": sha256.is_some(),
            })
        }
    };
    json!({
        "name": name,
        "shape": [frames, height, width, spp, table.dims()],
        "kernel": kernel,
        "integrands": integrands,
        "seed": seed,
        "metadata": metadata,
        "groups": groups.iter().map(GroupFigures::json).collect::<Vec<_>>(),
        "bound": bound,
        "page": page.map(|page| page.display().to_string()),
    })
}

fn marginal(marginal: &Marginal) -> Value {
    let faces = marginal.faces.map(|FaceDensity { within, density, standard_error, .. }| {
        json!({ "within": within, "density": density, "standard_error_of_random": standard_error })
    });
    json!({ "counts": marginal.counts, "faces": faces, "zeros": marginal.zeros })
}

fn ratios(ratios: &Ratios) -> Value {
    let families = ratios.families.iter().map(|family| (family.name.to_string(), estimate(&family.ratio)));
    json!({ "mean": estimate(&ratios.mean), "families": families.collect::<Map<_, _>>() })
}

fn estimate(Estimate { mean, standard_error, .. }: &Estimate) -> Value {
    json!({ "ratio": mean, "standard_error": standard_error })
}
