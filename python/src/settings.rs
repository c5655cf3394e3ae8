//! What `Config.with_...` take: schedules, descents, groups, domains.

use fsot::config::{DimensionGroup, Domain, GroupError, Schedule, Term};
use fsot::{Config, ConfigError};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString, PyTuple};

use crate::errors::{OrPython, refused};
use crate::json;
use crate::own::{OwnClasses, OwnTarget};
use crate::term::dims_of;

/// A number that stays, a pair from the first to the last by equal factors, or plain data.
pub fn schedule_of(object: &Bound<'_, PyAny>) -> PyResult<Schedule> {
    let is_number = !object.is_instance_of::<PyBool>() && !object.is_instance_of::<PyString>();
    let schedule = if object.is_instance_of::<PyDict>() {
        json::of_python(object)?
    } else if let Some(value) = object.extract::<f64>().ok().filter(|_| is_number) {
        Schedule::constant(value)
    } else if let Some([first, last]) = object.extract::<[f64; 2]>().ok().filter(|_| is_number) {
        Schedule::geometric(first, last)
    } else {
        return Err(PyTypeError::new_err(format!(
            "{} is no schedule: give a number, a pair of the first and the last, or a dictionary such as \
             {{'shape': 'cosine', 'first': 1.0, 'last': 0.1}}",
            object.repr()?
        )));
    };
    schedule.validate().python()?;
    Ok(schedule)
}

/// Changes plain data of a setting: each of `changes` by its name, where it is given.
///
/// # Errors
/// A `TypeError` for a name that the setting does not have.
pub fn change(
    data: &Bound<'_, PyDict>,
    of: &str,
    changes: &[(&str, Option<&Bound<'_, PyAny>>)],
) -> PyResult<()> {
    for &(name, value) in changes {
        let Some(value) = value else { continue };
        if !data.contains(name)? {
            return Err(PyTypeError::new_err(format!("{of} has no {name}: leave it out")));
        }
        if ["rate", "polish"].contains(&name) {
            data.set_item(name, json::to_python(value.py(), &schedule_of(value)?)?)?;
            continue;
        }
        if value.is_instance_of::<PyBool>() || value.extract::<f64>().is_err() {
            return Err(PyTypeError::new_err(format!("{name} is {}: give a number", value.repr()?)));
        }
        let number: f64 = value.extract()?;
        if !number.is_finite() {
            return Err(refused(format!("{name} is {number}: give a finite number")));
        }
        data.set_item(name, number)?;
    }
    Ok(())
}

pub fn with_domain(config: Config, domain: &Bound<'_, PyAny>) -> PyResult<Config> {
    if domain.is_instance_of::<PyString>() {
        return Ok(config.with_domain(domain_of(domain)?));
    }
    let domains: Vec<Domain> = domain.try_iter()?.map(|one| domain_of(&one?)).collect::<PyResult<_>>()?;
    if domains.len() != config.dims {
        let (given, dims) = (domains.len(), config.dims);
        return Err(ConfigError::DomainCount { given, dims }).python();
    }
    Ok(config.with_domains(domains))
}

fn domain_of(name: &Bound<'_, PyAny>) -> PyResult<Domain> {
    match name.extract::<&str>()? {
        "interval" => Ok(Domain::Interval),
        "torus" => Ok(Domain::Torus),
        other => Err(refused(format!("'{other}' is no domain: write interval or torus"))),
    }
}

pub fn domain_name(domain: Domain) -> &'static str {
    match domain {
        Domain::Interval => "interval",
        Domain::Torus => "torus",
    }
}

/// Lists of dimensions, or pairs of such a list and a weight.
pub fn groups_of(groups: &Bound<'_, PyAny>, dims: usize) -> PyResult<Vec<DimensionGroup>> {
    let group = |one: Bound<'_, PyAny>| -> PyResult<DimensionGroup> {
        let pair = one.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
        let group = match pair.map(|pair| (pair.get_item(0), pair.get_item(1))) {
            // A tuple of two numbers is a list of dimensions.
            Some((Ok(dims), Ok(weight))) if dims.len().is_ok() => {
                DimensionGroup::new(dims_of(&dims)?).with_weight(weight.extract()?)
            }
            _ => DimensionGroup::new(dims_of(&one)?),
        };
        GroupError::check(&group.dims, dims).python()?;
        Ok(group)
    };
    groups.try_iter()?.map(|one| group(one?)).collect()
}

/// Refuses terms that a table of so many dimensions does not have.
pub fn check_terms(terms: &[Term], dims: usize) -> PyResult<()> {
    for (term, of) in terms.iter().enumerate() {
        let checked = of.validate().and_then(|()| Ok(GroupError::check(&of.dims, dims)?));
        checked.map_err(|problem| ConfigError::Term { term, problem }).python()?;
    }
    match terms {
        [] => Err(ConfigError::NoTerms).python(),
        _ => Ok(()),
    }
}

/// Whether a configuration is plain data, and not in part an array or a function of the caller's.
pub fn is_plain(config: &Config) -> bool {
    let is_own =
        |term: &Term| OwnClasses::of(&term.classes).is_some() || OwnTarget::of(&term.target).is_some();
    !config.terms.iter().any(is_own)
}
