//! `fsot table --dry-run`: what the run would take.

use std::io::{self, Write};

use fsot::classes::Classes;
use fsot::config::{Descent, Role, Term, Work};
use fsot::optimizer::Plan;
use fsot::{Config, Extent, Optimizer};
use serde::Serialize;

/// The plan, for people and for scripts.
#[derive(Debug, Serialize)]
pub(super) struct Planned {
    /// `[frame, y, x, sample, dim]`.
    shape: [usize; 5],
    seed: u64,
    terms: Vec<PlannedTerm>,
    #[serde(flatten)]
    work: Work,
    /// Steps after which the run of the file that is followed ended early.
    ends_after_steps: Option<u64>,
    steps: u64,
    slices: f64,
    pairs: f64,
    expected_seconds: f64,
    threads: usize,
    bytes: usize,
    table_bytes: usize,
}

#[derive(Debug, Serialize)]
struct PlannedTerm {
    classes: &'static str,
    /// How many, where the configuration says it.
    count: Option<usize>,
    /// Pixels and frames that a filter holds.
    taps: Option<usize>,
    dims: Vec<usize>,
    role: Role,
    weight: f64,
}

/// Bytes of the slices of a pixel and a term, from which those are picked that the loss of a log is estimated
/// on. What is logged of the worth takes a copy of the table, and its coordinates as doubles.
const LOSS: usize = 32;

/// What the command does besides the run, which takes memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Besides {
    pub checkpoints: bool,
    pub log: bool,
    pub bound: bool,
}

impl Planned {
    pub fn new(optimizer: &Optimizer, plan: &Plan, ends_after_steps: Option<u64>, besides: Besides) -> Self {
        let Config { extent, dims, seed, .. } = *optimizer.config();
        let Extent { frames, height, width, spp } = extent;
        let objective = optimizer.objective();
        let term = |(index, term): (usize, &Term)| {
            let (classes, count) = named(&term.classes, &extent);
            let taps = objective.taps(index).map(|taps| taps.len());
            let Term { dims, role, weight, .. } = term.clone();
            PlannedTerm { classes, count, taps, dims, role, weight }
        };
        let table_bytes = size_of::<f32>() * extent.samples() * dims;
        let moments = match optimizer.config().descent {
            Descent::Barycentric { .. } => 0,
            Descent::Sgd { .. } => 1,
            _ => 2,
        };
        let Besides { checkpoints, log, bound } = besides;
        // At the end the table is a copy. The system does not always get back what a run has used, so that
        // all this is added. One checkpoint waits while another is written.
        let copies = 1 + usize::from(bound) + if checkpoints { 2 * (1 + moments) } else { 0 };
        let descended = objective.terms().filter(|term| term.role == Role::Descend).count();
        let logged = if log { LOSS * extent.sites() * descended + 3 * table_bytes } else { 0 };
        Self {
            shape: [frames, height, width, spp, dims],
            seed,
            terms: objective.terms().enumerate().map(term).collect(),
            work: plan.work,
            ends_after_steps,
            steps: plan.steps,
            slices: plan.slices,
            pairs: plan.pairs,
            expected_seconds: plan.seconds,
            threads: rayon::current_num_threads(),
            bytes: plan.bytes + copies * table_bytes + logged,
            table_bytes,
        }
    }

    /// For people.
    pub fn words(&self, out: &mut dyn Write) -> io::Result<()> {
        let [frames, height, width, spp, dims] = self.shape;
        let mb = |bytes: usize| bytes as f64 / 1e6;
        let table = mb(self.table_bytes);
        let [frames, dims] = [(frames, "frame"), (dims, "dimension")].map(counted);
        writeln!(out, "{width}×{height} pixels × {frames}, {spp} spp, {dims}: {table:.1} MB")?;
        for PlannedTerm { classes, count, taps, dims, role, weight } in &self.terms {
            let role = match role {
                Role::Descend => "descended",
                Role::Balance => "balanced",
            };
            let classes_of =
                |count| if count == 1 { ", 1 class".into() } else { format!(", {count} classes") };
            let count = count.map_or(String::new(), classes_of);
            let taps = taps.map_or(String::new(), |taps| format!(" of {}", counted((taps, "tap"))));
            writeln!(out, "  {role}: {classes}{count}{taps}, dimensions {dims:?}, weight {weight:.4}")?;
        }
        let Work { frame_sweeps, slices_per_class, sweeps } = self.work;
        let frame = if frame_sweeps > 0 { format!("--frame-sweeps {frame_sweeps} ") } else { String::new() };
        writeln!(
            out,
            "{frame}--slices-per-class {slices_per_class} --sweeps {sweeps}: {}",
            counted((self.steps as usize, "step"))
        )?;
        if let Some(steps) = self.ends_after_steps {
            writeln!(out, "ends after {}, as the run of that table did", counted((steps as usize, "step")))?;
        }
        if self.slices > 0.0 {
            writeln!(out, "{:.3e} slices", self.slices)?;
        }
        if self.pairs > 0.0 {
            writeln!(out, "{:.3e} pairs of samples", self.pairs)?;
        }
        writeln!(out, "{:.1} MB of memory at the peak, beside the program", mb(self.bytes))?;
        writeln!(out, "{:.2} s expected, with {}", self.expected_seconds, counted((self.threads, "thread")))
    }
}

fn counted((count, what): (usize, &str)) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

fn named(classes: &Classes, extent: &Extent) -> (&'static str, Option<usize>) {
    match classes {
        Classes::Lattice { .. } => ("filter of each pixel", Some(extent.sites())),
        Classes::PerPixel => ("samples of each pixel", Some(extent.sites())),
        Classes::PerFrame => ("samples of each frame", Some(extent.frames)),
        Classes::WholeTable => ("all samples", Some(1)),
        Classes::Labelled { subsets, .. } => ("labels", Some(subsets.len())),
        Classes::Ramps { ramps, .. } => ("ramps", Some(ramps.len())),
        Classes::Prefixes { .. } => ("prefixes", None),
        _ => ("classes of another kind", None),
    }
}
