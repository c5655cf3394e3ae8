//! Families of filters.

use std::sync::Arc;

use fsot::classes::{ClassError, Classes, FilterForm, LabelSet, PrefixLength, PrefixLengths, PrefixOf, Ramp};

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::Numbers;
use crate::counts::Count;
use crate::errors::{OrPython, refused};
use crate::json;
use crate::kernel::PyKernel;
use crate::own::{OwnClasses, array, wholes};

/// A family of filters over the samples of a table: what a term of the objective makes even.
///
/// A *class* is one member of a family. Samples are numbered in the order of the table
/// ``[frame, y, x, sample]``; a point set has one per point. Made by its static methods.
///
/// Examples
/// --------
/// >>> import fsot
/// >>> fsot.Classes.labelled([0, 0, 1, 1], [[0], [1], [0, 1]]).kind
/// 'labelled'
#[pyclass(frozen, eq, name = "Classes", module = "fsot", from_py_object)]
#[derive(Clone, Debug)]
pub struct PyClasses(pub Classes);

impl PartialEq for PyClasses {
    fn eq(&self, other: &Self) -> bool {
        match (OwnClasses::of(&self.0), OwnClasses::of(&other.0)) {
            (Some(own), Some(other)) => own == other,
            _ => self.0 == other.0,
        }
    }
}

#[pymethods]
impl PyClasses {
    /// One class per pixel and frame: the kernel centred there.
    ///
    /// Parameters
    /// ----------
    /// kernel : Kernel
    ///     The filter.
    /// form : {"level_sets", "weighted"}
    ///     How its weights enter: by the samples above a random level, which is cheap, or all at once.
    #[staticmethod]
    #[pyo3(signature = (kernel, form = "level_sets"))]
    fn lattice(kernel: PyKernel, form: &str) -> PyResult<Self> {
        Ok(Self(Classes::Lattice { kernel: kernel.0, form: form_of(form)? }))
    }

    /// One class: all samples alike. It is what makes a table unbiased.
    #[staticmethod]
    fn whole_table() -> Self {
        Self(Classes::WholeTable)
    }

    /// One class per frame: its samples alike.
    #[staticmethod]
    fn per_frame() -> Self {
        Self(Classes::PerFrame)
    }

    /// One class per pixel and frame: its samples alike. Of use for several samples per pixel.
    #[staticmethod]
    fn per_pixel() -> Self {
        Self(Classes::PerPixel)
    }

    /// One class per set of labels: the samples that carry one of them, alike.
    ///
    /// Parameters
    /// ----------
    /// labels : array_like of int
    ///     Label of each sample, from 0 on; of any shape that has as many entries, in C order.
    /// subsets : sequence of sequences of int
    ///     The classes, as the labels that each holds.
    /// weights : sequence of float, optional
    ///     Weights of the pull of each class, from 1e-12 to 1e6; 1 by default.
    #[staticmethod]
    #[pyo3(signature = (labels, subsets, weights = None))]
    fn labelled(
        labels: &Bound<'_, PyAny>,
        subsets: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let labels: Arc<[u32]> = wholes(labels, "a label")?.values.into();
        let subsets: Vec<Vec<u32>> = subsets
            .try_iter()?
            .map(|subset| Ok(wholes(&subset?, "a label of a subset")?.values))
            .collect::<PyResult<_>>()?;
        let weights = weights_of(weights, subsets.len())?;
        let weight = |at: usize| weights.get(at).copied().unwrap_or(1.0);
        let subsets =
            subsets.into_iter().enumerate().map(|(at, labels)| LabelSet { labels, weight: weight(at) });
        Ok(Self(Classes::Labelled { labels, subsets: subsets.collect() }))
    }

    /// One class per ramp: filters that rise or fall along a coordinate of the samples, so that every part of
    /// the ramp looks like the target.
    ///
    /// Parameters
    /// ----------
    /// coordinates : array_like of float
    ///     Class coordinate of each sample, in [0, 1]; of any shape that has as many entries, in C order.
    /// ramps : sequence of {"rising", "falling"}
    ///     The classes: their weight is the coordinate, or 1 less the coordinate.
    #[staticmethod]
    #[pyo3(signature = (coordinates, ramps = vec!["rising".into(), "falling".into()]),
           text_signature = "(coordinates, ramps=('rising', 'falling'))")]
    fn ramps(coordinates: &Bound<'_, PyAny>, ramps: Vec<String>) -> PyResult<Self> {
        let coordinates = Numbers::<f64>::of(coordinates)?.values;
        if let Some(bad) = coordinates.iter().find(|value| !(0.0..=1.0).contains(*value)) {
            return Err(refused(format!("a class coordinate is {bad}: give a value in [0, 1]")));
        }
        let ramp = |name: &String| match name.as_str() {
            "rising" => Ok(Ramp::Rising),
            "falling" => Ok(Ramp::Falling),
            other => Err(refused(format!("'{other}' is no ramp: write rising or falling"))),
        };
        let ramps = ramps.iter().map(ramp).collect::<PyResult<_>>()?;
        Ok(Self(Classes::Ramps { coordinates: coordinates.into(), ramps }))
    }

    /// One class per length: the first so many samples.
    ///
    /// Parameters
    /// ----------
    /// of : {"table", "pixel"}
    ///     What is cut short: the table in its order, or the samples of each pixel.
    /// lengths : "powers_of_two", "every" or sequence
    ///     Numbers of samples, from 1 to all, each alone or as a pair with its weight. A prefix without one
    ///     weighs 1 / length: the short ones decide about the first samples, and the others follow.
    #[staticmethod]
    #[pyo3(signature = (of = "table", lengths = None),
           text_signature = "(of='table', lengths='powers_of_two')")]
    fn prefixes(of: &str, lengths: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let of = match of {
            "table" => PrefixOf::Table,
            "pixel" => PrefixOf::Pixel,
            other => return Err(refused(format!("'{other}' has no prefixes: write table or pixel"))),
        };
        let lengths = match lengths.map(|lengths| (lengths.extract::<String>(), lengths)) {
            None => PrefixLengths::PowersOfTwo,
            Some((Ok(name), _)) => match name.as_str() {
                "powers_of_two" => PrefixLengths::PowersOfTwo,
                "every" => PrefixLengths::Every,
                other => {
                    return Err(refused(format!(
                        "'{other}' are no lengths: write powers_of_two, every, or numbers"
                    )));
                }
            },
            Some((Err(_), list)) => PrefixLengths::Given(
                list.try_iter()?.map(|length| prefix_of(&length?)).collect::<PyResult<_>>()?,
            ),
        };
        Ok(Self(Classes::Prefixes { of, lengths }))
    }

    /// A family of one's own: classes as lists of samples and weights.
    ///
    /// Parameters
    /// ----------
    /// members : iterable
    ///     One class each: an array of sample numbers, all of weight 1, or a tuple of such an array and one
    ///     of as many weights in [0, 1]. A class lists a sample once at most.
    /// weights : sequence of float, optional
    ///     Weights of the pull of each class, from 1e-12 to 1e6; 1 by default.
    /// name : str
    ///     Name for messages and metadata, which add a digest of the lists.
    ///
    /// Examples
    /// --------
    /// Every window of 16 consecutive points:
    ///
    /// >>> import numpy, fsot
    /// >>> windows = fsot.Classes.listed([numpy.arange(16) + first for first in range(0, 64, 16)])
    #[staticmethod]
    #[pyo3(signature = (members, weights = None, *, name = "listed"))]
    fn listed(members: &Bound<'_, PyAny>, weights: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<Self> {
        let mut own = Lists { name, starts: vec![0], samples: Vec::new(), weights: Vec::new() };
        for member in members.try_iter()? {
            add_member(&member?, &mut own)?;
        }
        let emphases = weights_of(weights, own.starts.len() - 1)?;
        if own.samples.is_empty() {
            return Err(refused(ClassError::Empty { family: "the caller's classes" }));
        }
        let Lists { starts, samples, weights, .. } = own;
        Ok(Self(Classes::custom(OwnClasses::new(name.into(), starts, samples, weights, emphases))))
    }

    /// Which family: ``"lattice"``, ``"whole_table"``, ``"per_frame"``, ``"per_pixel"``, ``"labelled"``,
    /// ``"ramps"``, ``"prefixes"``, or ``"listed"``.
    #[getter]
    pub fn kind(&self) -> &'static str {
        match self.0 {
            Classes::Lattice { .. } => "lattice",
            Classes::WholeTable => "whole_table",
            Classes::PerFrame => "per_frame",
            Classes::PerPixel => "per_pixel",
            Classes::Labelled { .. } => "labelled",
            Classes::Ramps { .. } => "ramps",
            Classes::Prefixes { .. } => "prefixes",
            _ => "listed",
        }
    }

    /// The filter of a lattice, or None.
    #[getter]
    fn kernel(&self) -> Option<PyKernel> {
        match &self.0 {
            Classes::Lattice { kernel, .. } => Some(PyKernel(kernel.clone())),
            _ => None,
        }
    }

    /// Plain data, as in metadata; of a family of one's own its name.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.0)
    }

    /// From plain data.
    #[staticmethod]
    fn from_dict(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        json::of_python(data).map(Self)
    }

    fn __repr__(&self) -> PyResult<String> {
        match (&self.0, OwnClasses::of(&self.0)) {
            (_, Some(own)) => {
                let (classes, samples) = (own.starts.len() - 1, own.samples.len());
                Ok(format!("<Classes.listed '{}': {classes} classes, {samples} samples>", own.given))
            }
            (Classes::Labelled { labels, subsets }, _) => {
                Ok(format!("<Classes.labelled: {} samples, {} classes>", labels.len(), subsets.len()))
            }
            (Classes::Ramps { coordinates, ramps }, _) => {
                Ok(format!("<Classes.ramps: {} samples, {} classes>", coordinates.len(), ramps.len()))
            }
            _ => Ok(format!("Classes.from_dict({})", serde_json::to_string(&self.0).python()?)),
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let of_type = |name: &str| py.get_type::<Self>().getattr(name);
        let Some(own) = OwnClasses::of(&self.0) else {
            return Ok((of_type("from_dict")?, PyTuple::new(py, [self.to_dict(py)?])?));
        };
        let starts = own.starts.iter().map(|&start| start as u64).collect();
        let lists = (
            &own.given,
            array(py, starts),
            array(py, own.samples.clone()),
            array(py, own.weights.clone()),
            array(py, own.emphases.clone()),
        );
        Ok((of_type("_of_lists")?, lists.into_pyobject(py)?))
    }

    /// What `__reduce__` has written.
    #[staticmethod]
    fn _of_lists(
        name: String,
        starts: &Bound<'_, PyAny>,
        samples: &Bound<'_, PyAny>,
        weights: &Bound<'_, PyAny>,
        emphases: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let starts: Vec<usize> =
            Numbers::<u64>::of(starts)?.values.into_iter().map(|start| start as usize).collect();
        let samples = Numbers::<u32>::of(samples)?.values;
        let (weights, emphases) = (Numbers::<f64>::of(weights)?.values, Numbers::<f64>::of(emphases)?.values);
        let is_sound = starts.first() == Some(&0)
            && starts.last() == Some(&samples.len())
            && starts.windows(2).all(|pair| pair[0] <= pair[1]);
        match is_sound {
            true => Ok(Self(Classes::custom(OwnClasses::new(name, starts, samples, weights, emphases)))),
            false => Err(refused("the pickled classes are damaged: pickle them again")),
        }
    }
}

pub fn form_of(name: &str) -> PyResult<FilterForm> {
    match name {
        "level_sets" => Ok(FilterForm::LevelSets),
        "weighted" => Ok(FilterForm::Weighted),
        other => Err(refused(format!("'{other}' is no form of a filter: write level_sets or weighted"))),
    }
}

fn weights_of(weights: Option<&Bound<'_, PyAny>>, classes: usize) -> PyResult<Vec<f64>> {
    let Some(weights) = weights else { return Ok(Vec::new()) };
    let weights = Numbers::<f64>::of(weights)?.values;
    if weights.len() != classes {
        return Err(refused(format!("{} weights for {classes} classes: give one each", weights.len())));
    }
    match weights.iter().find(|weight| !(1e-12..=1e6).contains(*weight)) {
        Some(weight) => {
            Err(refused(format!("the weight of a class is {weight}: give a value from 1e-12 to 1e6")))
        }
        None => Ok(weights),
    }
}

fn prefix_of(length: &Bound<'_, PyAny>) -> PyResult<PrefixLength> {
    match length.extract::<(Count, f64)>() {
        Ok((Count(length), weight)) => Ok(PrefixLength { length, weight }),
        Err(_) => {
            let Count(length) = length.extract()?;
            Ok(PrefixLength { length, weight: 1.0 / length.max(1) as f64 })
        }
    }
}

/// Classes as they are read.
struct Lists<'a> {
    name: &'a str,
    starts: Vec<usize>,
    samples: Vec<u32>,
    /// Empty as long as all are 1.
    weights: Vec<f64>,
}

fn add_member(member: &Bound<'_, PyAny>, own: &mut Lists<'_>) -> PyResult<()> {
    let number = own.starts.len() - 1;
    let refuse = |sentence: String| Err(refused(format!("class {number} of \"{}\" {sentence}", own.name)));
    let pair = member.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
    let pair = match pair {
        // A tuple of two numbers is a list of samples.
        Some(pair) if pair.get_item(0)?.len().is_ok() => Some((pair.get_item(0)?, pair.get_item(1)?)),
        _ => None,
    };
    let samples = wholes(pair.as_ref().map_or(member, |(samples, _)| samples), "a sample of a class")?;
    if samples.shape.len() != 1 {
        return refuse(format!("lists samples in shape {:?}: give them in a row", samples.shape));
    }
    let samples = samples.values;
    if let Some((_, weights)) = pair {
        let weights = Numbers::<f64>::of(&weights)?.values;
        if weights.len() != samples.len() {
            let (of_samples, of_weights) = (samples.len(), weights.len());
            return refuse(format!("has {of_samples} samples and {of_weights} weights: give one each"));
        }
        let bad = samples.iter().zip(&weights).find(|(_, weight)| !(0.0..=1.0).contains(*weight));
        if let Some((&sample, &weight)) = bad {
            let (name, member) = (own.name.into(), number as u32);
            let problem = "give weights in [0, 1]";
            return Err(refused(ClassError::Custom { name, member, sample, weight, problem }));
        }
        own.weights.resize(own.samples.len(), 1.0);
        own.weights.extend(weights);
    } else if !own.weights.is_empty() {
        own.weights.resize(own.samples.len() + samples.len(), 1.0);
    }
    let mut sorted = samples.clone();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        return refuse(format!("lists sample {} twice: name each sample once", pair[0]));
    }
    own.samples.extend(samples);
    own.starts.push(own.samples.len());
    Ok(())
}
