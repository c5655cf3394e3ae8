//! What is measured of a table, and how it is said to programs.

use fsot::config::{DimensionGroup, Role};
use fsot::files::{BoundEstimate, Metadata};
use fsot::metrics::{
    Bias, Bound, Discrepancy, Estimate, FaceDensity, FilteredError, Integrands, Marginal, Ratios, Spectra,
};
use fsot::{Config, Extent, Objective, SampleTable};
use serde_json::{Map, Value, json};

use super::evenness::Evenness;
use super::{Beside, Effort, Inspection};
use crate::Failure;

/// Cycles per pixel below which a frequency counts as low; the default filter halves the power at 0.09.
pub const LOW: f64 = 0.1;

/// Bins of a single dimension.
pub const BINS: usize = 64;

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
        let Inspection { table, kernel, seed, effort, .. } = inspection;
        let extent = table.extent();
        let random = |count| Integrands::random(dims.len(), count, *seed);
        let integrands = random(effort.integrands)?;
        let errors = match effort.frames {
            Some(frames) => FilteredError::measure_frames(table, &dims, &integrands, kernel, frames)?,
            None => FilteredError::measure(table, &dims, &integrands, kernel)?,
        };
        let bias = Bias::measure(table, &dims, &random(effort.of_bias)?)?;
        let evenness = Evenness::new(table, &dims[..dims.len().min(2)])?;
        let marginals = dims.iter().map(|&dim| Marginal::measure(table, dim, BINS));
        let marginals = marginals.collect::<Result<_, _>>()?;
        let per_frame = (extent.samples() / extent.frames) as u64;
        let pairs = per_frame.saturating_mul(per_frame).saturating_mul((extent.frames * dims.len()) as u64);
        let discrepancy = match pairs <= effort.most_pairs {
            true => Some(Discrepancy::measure(table, &dims)?.ratio_to_white_noise),
            false => None,
        };
        let spectra = spectra(table, &dims, &integrands, effort)?;
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

    pub fn json(&self) -> Value {
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

/// Spectra of the whole table, or of some frames and some rows of it at equal distances.
pub fn spectra(
    table: &SampleTable,
    dims: &[usize],
    integrands: &Integrands,
    effort: &Effort,
) -> Result<Spectra, Failure> {
    let Extent { frames, height, .. } = table.extent();
    let [of_frames, of_rows] = effort.slabs;
    if of_frames >= frames && (of_rows >= height || frames == 1) {
        return Ok(Spectra::measure(table, dims, integrands)?);
    }
    let spread = |all: usize, few: usize| (0..all.min(few)).map(move |k| k * all / all.min(few));
    let of_frames = part(table, spread(frames, of_frames), 0..height)?;
    let mut spectra = Spectra::measure(&of_frames, dims, integrands)?;
    if frames > 1 {
        spectra.xt =
            Spectra::measure(&part(table, 0..frames, spread(height, of_rows))?, dims, integrands)?.xt;
    }
    Ok(spectra)
}

/// A table of some frames and some rows.
fn part(
    table: &SampleTable,
    frames: impl ExactSizeIterator<Item = usize>,
    rows: impl ExactSizeIterator<Item = usize> + Clone,
) -> Result<SampleTable, Failure> {
    let extent = table.extent();
    let row = extent.width * extent.spp * table.dims();
    let part = Extent { frames: frames.len(), height: rows.len(), ..extent };
    let starts = frames.flat_map(|frame| rows.clone().map(move |y| (frame * extent.height + y) * row));
    let values = starts.flat_map(|start| &table.values()[start..start + row]).copied().collect();
    Ok(SampleTable::new(part, table.dims(), values)?)
}

/// The objective of `Term::blue_noise` for this shape and filter, at the table.
pub fn bound(inspection: &Inspection, groups: &[DimensionGroup]) -> Result<BoundEstimate, Failure> {
    let Inspection { table, kernel, seed, effort, .. } = inspection;
    let mut config =
        Config::new(table.extent(), table.dims()).with_groups(groups).with_kernel(kernel.clone());
    if !effort.balance {
        config.terms.retain(|term| term.role == Role::Descend);
    }
    let objective = Objective::new(&config)?;
    Ok(Bound::measure(table, &objective, *seed, effort.bound_slices)?.total)
}

/// Everything, for `--json`; what was not measured is `null`.
pub fn json(
    inspection: &Inspection,
    beside: &Beside,
    groups: &[GroupFigures],
    bound: &BoundEstimate,
) -> Value {
    let Inspection { name, table, kernel, seed, effort, .. } = inspection;
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
        "integrands": effort.integrands,
        "seed": seed,
        "metadata": metadata,
        "groups": groups.iter().map(GroupFigures::json).collect::<Vec<_>>(),
        "bound": bound,
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
