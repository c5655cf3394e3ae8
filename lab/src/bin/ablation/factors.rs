//! What is changed, one thing at a time.

use fsot::Config;
use fsot::classes::{Classes, FilterForm};
use fsot::config::{Descent, Role, Schedule};

/// A choice and its alternatives.
pub struct Factor {
    pub title: &'static str,
    pub variants: Vec<Variant>,
}

pub struct Variant {
    pub name: String,
    pub change: Box<dyn Fn(&mut Config)>,
    pub effort: Effort,
    pub making: Making,
}

/// What variants have in common with the defaults.
#[derive(Clone, Copy)]
pub enum Effort {
    Slices,
    Seconds,
}

/// Which table a run gives.
#[derive(Clone, Copy)]
pub enum Making {
    Last,
    /// The mean of the tables after the last steps, this share of all.
    MeanOfLast(f64),
}

pub fn defaults() -> Variant {
    at_equal_slices("defaults", |_| {})
}

pub fn all() -> Vec<Factor> {
    vec![
        Factor { title: "Batch: share of an epoch per step", variants: batches() },
        Factor { title: "Descent", variants: descents() },
        Factor { title: "Step schedule of the barycentric descent", variants: schedules() },
        Factor { title: "Momentum of SGD", variants: momenta() },
        Factor { title: "Step size of Adam", variants: adams() },
        Factor { title: "Mean of the last iterates", variants: averages() },
        Factor { title: "Form of the filter", variants: forms() },
        Factor { title: "Directions per subset", variants: directions() },
        Factor { title: "Share of directions on the axes", variants: axes() },
        Factor { title: "Share of balance slices, relative to the kernel's touches", variants: balances() },
    ]
}

fn at_equal_slices(name: impl Into<String>, change: impl Fn(&mut Config) + 'static) -> Variant {
    Variant { name: name.into(), change: Box::new(change), effort: Effort::Slices, making: Making::Last }
}

fn at_equal_time(name: impl Into<String>, change: impl Fn(&mut Config) + 'static) -> Variant {
    Variant { effort: Effort::Seconds, ..at_equal_slices(name, change) }
}

fn batches() -> Vec<Variant> {
    let batch = |parts: usize| {
        at_equal_time(format!("1/{parts}"), move |config| {
            let epoch = config.extent.sites() * config.slicing.directions;
            config.slicing.batch_slices = Some(epoch.div_ceil(parts));
        })
    };
    [1, 2, 4, 8, 16, 32, 64].map(batch).into()
}

fn descents() -> Vec<Variant> {
    let descents = [
        ("barycentric", Descent::barycentric()),
        ("SGD with momentum", Descent::sgd()),
        ("Adam", Descent::adam()),
    ];
    descents.map(|(name, descent)| at_equal_time(name, move |config| config.descent = descent)).into()
}

fn schedules() -> Vec<Variant> {
    let ends = [
        (0.5, 0.02),
        (1.0, 0.02),
        (1.5, 0.02),
        (2.0, 0.02),
        (1.0, 0.1),
        (1.0, 0.05),
        (1.0, 0.01),
        (1.0, 0.005),
    ];
    let geometric =
        ends.map(|(first, last)| (format!("geometric, {first} to {last}"), Schedule::geometric(first, last)));
    let others = [
        ("cosine, 1 to 0.02".to_owned(), Schedule::cosine(1.0, 0.02)),
        ("constant 0.3".to_owned(), Schedule::constant(0.3)),
        ("constant 0.1".to_owned(), Schedule::constant(0.1)),
    ];
    let variant = |(name, rate)| {
        at_equal_slices(name, move |config: &mut Config| config.descent = Descent::Barycentric { rate })
    };
    geometric.into_iter().chain(others).map(variant).collect()
}

/// Velocity amplifies the step by `1 / (1 - momentum)`; the product stays that of the default.
fn momenta() -> Vec<Variant> {
    let variant = |momentum: f64| {
        let rate = |natural: f64| natural * (1.0 - momentum);
        let rate = Schedule::geometric(rate(2.0), rate(0.05));
        at_equal_slices(format!("{momentum}"), move |config| config.descent = Descent::Sgd { rate, momentum })
    };
    [0.0, 0.5, 0.8, 0.9, 0.95].map(variant).into()
}

fn adams() -> Vec<Variant> {
    let variant = |(first, last): (f64, f64)| {
        let rate = Schedule::geometric(first, last);
        let name = format!("{first} to {last}");
        at_equal_slices(name, move |config| {
            config.descent = Descent::Adam { rate, beta1: 0.9, beta2: 0.99, epsilon: 1e-8 };
        })
    };
    [(0.05, 0.004), (0.1, 0.004), (0.2, 0.004), (0.1, 0.001), (0.1, 0.01)].map(variant).into()
}

fn averages() -> Vec<Variant> {
    let variant = |(last, share): (f64, f64)| {
        let (table, making) = match share {
            0.0 => ("last table".to_owned(), Making::Last),
            _ => (format!("mean of the last {:.0} %", 100.0 * share), Making::MeanOfLast(share)),
        };
        let rate = Schedule::geometric(1.0, last);
        let change = move |config: &mut Config| config.descent = Descent::Barycentric { rate };
        Variant { making, ..at_equal_slices(format!("step 1 to {last}, {table}"), change) }
    };
    [(0.02, 0.0), (0.02, 0.1), (0.1, 0.0), (0.1, 0.1), (0.1, 0.3), (0.3, 0.0), (0.3, 0.3)].map(variant).into()
}

fn forms() -> Vec<Variant> {
    let variant = |(name, chosen): (&str, FilterForm)| {
        at_equal_time(name, move |config| {
            for term in &mut config.terms {
                if let Classes::Lattice { form, .. } = &mut term.classes {
                    *form = chosen;
                }
            }
        })
    };
    [("level sets", FilterForm::LevelSets), ("weighted", FilterForm::Weighted)].map(variant).into()
}

/// The number of slices per step stays, so that there are more subsets with fewer directions each.
fn directions() -> Vec<Variant> {
    let variant = |directions: usize| {
        at_equal_time(format!("{directions}"), move |config| {
            config.slicing.batch_slices = Some(config.extent.sites());
            config.slicing.directions = directions;
        })
    };
    [1, 2, 4, 8, 16].map(variant).into()
}

fn axes() -> Vec<Variant> {
    let variant =
        |share: f64| at_equal_slices(format!("{share}"), move |config| config.slicing.axis_share = share);
    [0.0, 0.1, 0.3, 0.5].map(variant).into()
}

fn balances() -> Vec<Variant> {
    let variant = |share: f64| {
        let name = if share > 0.0 { format!("{share}") } else { "none (as published)".into() };
        at_equal_time(name, move |config| {
            config.terms.retain(|term| share > 0.0 || term.role != Role::Balance);
            let balance = config.terms.iter_mut().filter(|term| term.role == Role::Balance);
            balance.for_each(|term| term.weight = share);
        })
    };
    [0.0, 0.003, 0.01, 0.03, 0.1, 0.3].map(variant).into()
}
