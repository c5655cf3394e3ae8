//! Families of classes and targets that come from arrays or functions of Python's.

use std::any::Any;
use std::collections::HashMap;
use std::fmt;
use std::sync::{Mutex, PoisonError};

use fsot::Extent;
use fsot::classes::{ClassFamily, ClassSamples, Classes};
use fsot::targets::{Measure, Projected, Target};
use numpy::PyArray1;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{Numbers, to_numpy};
use crate::errors::refused;
use crate::pool::raise;

/// Classes as lists, one after the other.
#[derive(Debug, PartialEq)]
pub struct OwnClasses {
    pub given: String,
    /// The name given, with a digest of the lists: a checkpoint and metadata know them by it.
    name: String,
    /// Where each class begins among the samples, and the end of the last.
    pub starts: Vec<usize>,
    pub samples: Vec<u32>,
    /// Of the samples; empty if all are 1.
    pub weights: Vec<f64>,
    /// Of the classes; empty if all are 1.
    pub emphases: Vec<f64>,
}

impl OwnClasses {
    pub fn new(
        given: String,
        starts: Vec<usize>,
        samples: Vec<u32>,
        weights: Vec<f64>,
        emphases: Vec<f64>,
    ) -> Self {
        let whole =
            starts.iter().map(|&start| start as u64).chain(samples.iter().map(|&sample| sample.into()));
        let numbers = weights.iter().chain(&emphases).map(|weight| weight.to_bits());
        let name = labelled(&given, whole.chain(numbers));
        Self { given, name, starts, samples, weights, emphases }
    }

    /// The lists of these classes, if they are such.
    pub fn of(classes: &Classes) -> Option<&Self> {
        match classes {
            Classes::Custom(custom) => (custom.get() as &dyn Any).downcast_ref(),
            _ => None,
        }
    }
}

impl ClassFamily for OwnClasses {
    fn name(&self) -> &str {
        &self.name
    }

    fn members(&self, _: &Extent) -> usize {
        self.starts.len() - 1
    }

    fn member(&self, _: &Extent, member: usize) -> ClassSamples {
        let list = self.starts[member]..self.starts[member + 1];
        let weight = |place: usize| self.weights.get(place).copied().unwrap_or(1.0);
        let samples = list.map(|place| (self.samples[place], weight(place))).collect();
        ClassSamples { samples, weight: self.emphases.get(member).copied().unwrap_or(1.0) }
    }
}

/// A target by its quantile functions.
pub struct OwnTarget {
    pub given: String,
    /// The name given, with a digest of a table.
    name: String,
    pub dims: usize,
    pub law: Law,
    /// Laws that a function has given, by the bits of their directions: it is asked once for each.
    known: Mutex<HashMap<Vec<u64>, Projected>>,
}

/// Where quantiles come from.
#[derive(Debug)]
pub enum Law {
    /// One dimension: at equally spaced levels from 0 to 1.
    Table(Vec<f64>),
    /// Of a direction.
    Function(Py<PyAny>),
}

/// Laws that are remembered, some 30 KiB each. A plan asks for half a thousand.
const MOST_KNOWN: usize = 1024;

impl fmt::Debug for OwnTarget {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, dims, .. } = self;
        formatter.debug_struct("OwnTarget").field("name", name).field("dims", dims).finish_non_exhaustive()
    }
}

impl OwnTarget {
    pub fn new(given: String, dims: usize, law: Law) -> Self {
        let name = match &law {
            Law::Table(values) => labelled(&given, values.iter().map(|value| value.to_bits())),
            Law::Function(_) => given.clone(),
        };
        Self { given, name, dims, law, known: Mutex::default() }
    }

    /// The quantiles of this target, if it is such.
    pub fn of(target: &Target) -> Option<&Self> {
        match target {
            Target::Custom(custom) => (custom.get() as &dyn Any).downcast_ref(),
            _ => None,
        }
    }

    /// Whether it is the same by its values, functions being compared by Python.
    pub fn is_same(&self, other: &Self) -> bool {
        let same = match (&self.law, &other.law) {
            (Law::Table(own), Law::Table(other)) => own == other,
            (Law::Function(own), Law::Function(other)) => {
                Python::attach(|py| own.bind(py).eq(other.bind(py)).unwrap_or(false))
            }
            _ => false,
        };
        same && (&self.name, self.dims) == (&other.name, other.dims)
    }

    /// Asks the function; any thread may, and takes the interpreter's lock.
    fn ask(&self, function: &Py<PyAny>, direction: &[f64]) -> PyResult<Projected> {
        let quantiles = Python::attach(|py| {
            let direction = PyArray1::from_slice(py, direction);
            quantiles_of(&function.bind(py).call1((direction,))?)
        })?;
        Ok(law(&quantiles))
    }
}

impl Measure for OwnTarget {
    fn name(&self) -> &str {
        &self.name
    }

    fn dims(&self) -> usize {
        self.dims
    }

    fn project(&self, direction: &[f64]) -> Projected {
        let function = match &self.law {
            Law::Function(function) => function,
            Law::Table(quantiles) => {
                let scale = direction.first().copied().unwrap_or(0.0);
                let at = |u: f64| scale * interpolated(quantiles, if scale < 0.0 { 1.0 - u } else { u });
                return Projected::from_quantile(at);
            }
        };
        let key: Vec<u64> = direction.iter().map(|component| component.to_bits()).collect();
        // Nobody holds these locks while they wait for the interpreter's.
        if let Some(known) = self.known.lock().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return known.clone();
        }
        match self.ask(function, direction) {
            Ok(law) => {
                let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
                if known.len() < MOST_KNOWN {
                    known.insert(key, law.clone());
                }
                law
            }
            Err(error) => {
                raise(error);
                // What is no law is refused by the library.
                Projected::from_samples(Vec::new())
            }
        }
    }
}

/// A name with a digest (FNV-1a) of numbers.
fn labelled(name: &str, numbers: impl Iterator<Item = u64>) -> String {
    let digest = numbers.fold(0xcbf2_9ce4_8422_2325_u64, |digest, number| {
        let add = |digest: u64, byte| (digest ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        number.to_le_bytes().into_iter().fold(digest, add)
    });
    format!("{name}#{:08x}", (digest >> 32) ^ (digest & 0xffff_ffff))
}

fn law(quantiles: &[f64]) -> Projected {
    Projected::from_quantile(|u| interpolated(quantiles, u))
}

/// Linearly between values at equally spaced levels.
fn interpolated(quantiles: &[f64], u: f64) -> f64 {
    let last = quantiles.len() - 1;
    let place = u.clamp(0.0, 1.0) * last as f64;
    let below = (place as usize).min(last - 1);
    let share = place - below as f64;
    quantiles[below] * (1.0 - share) + quantiles[below + 1] * share
}

/// A quantile function as an array: two or more finite values that don't fall.
pub fn quantiles_of(object: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let Numbers { shape, values } = Numbers::<f64>::of(object)?;
    let advice =
        "give quantiles at equally spaced levels, as numpy.quantile(values, numpy.linspace(0, 1, n))";
    if shape.len() != 1 || values.len() < 2 {
        return Err(refused(format!("quantiles of shape {shape:?}, not two or more in a row: {advice}")));
    }
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        return Err(refused(format!("quantile {at} is {}: {advice}", values[at])));
    }
    if let Some(at) = values.windows(2).position(|pair| pair[1] < pair[0]) {
        let (below, above) = (values[at], values[at + 1]);
        return Err(refused(format!("quantiles fall from {below} to {above} after number {at}: {advice}")));
    }
    Ok(values)
}

/// Whole numbers of an array or list, of any shape.
///
/// # Errors
/// A `TypeError` for numbers with fractions; a `ValueError` for those out of range.
pub fn wholes(object: &Bound<'_, PyAny>, what: &str) -> PyResult<Numbers<u32>> {
    let Numbers { shape, values } = Numbers::<f64>::of(object)?;
    let whole = |value: f64| {
        if !(0.0..=f64::from(u32::MAX)).contains(&value) {
            return Err(PyValueError::new_err(format!(
                "{what} is {value}: give whole numbers from 0 to 4294967295"
            )));
        }
        if value.fract() != 0.0 {
            return Err(PyTypeError::new_err(format!("{what} is {value}: give whole numbers")));
        }
        Ok(value as u32)
    };
    Ok(Numbers { shape, values: values.into_iter().map(whole).collect::<PyResult<_>>()? })
}

/// A list as an array of one axis.
pub fn array<'py, T: numpy::Element>(py: Python<'py>, values: Vec<T>) -> Bound<'py, PyArray1<T>> {
    to_numpy(py, ndarray::Array1::from_vec(values))
}
