//! Random configurations: whatever is asked for, the answer is a table or a refusal in words, and soon.
//!
//! `FSOT_FUZZ` multiplies their number.

mod draw;
mod odd;
mod written;

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use fsot::config::Role;
use fsot::metrics::{Bound, MeasureError};
use fsot::{Config, ConfigError, Optimizer};

use self::draw::Draw;

/// Configurations without `FSOT_FUZZ`.
const COUNT: u64 = 1500;
/// Longest that anything may take, on a machine that has nothing else to do.
const LONGEST: Duration = Duration::from_secs(2);

/// What became of a configuration.
#[derive(Debug)]
enum Ended {
    Refused(ConfigError),
    Ran,
}

fn run(index: u64) -> Ended {
    let random = fsot::random::generator(0, 4242_u64, 0, index);
    let mut draw = Draw { random, odd: 0.0 };
    draw.odd = draw.pick(&[0.0, 0.01, 0.03, 0.1]);
    match attempt(&mut draw) {
        Ok(()) => Ended::Ran,
        Err(error) => Ended::Refused(error),
    }
}

fn attempt<R: rand::Rng>(draw: &mut Draw<R>) -> Result<(), ConfigError> {
    let config = draw.config();
    if std::env::var_os("FSOT_FUZZ_SHOW").is_some() {
        println!("{config:?}");
    }
    let demand = if draw.chance(0.2) { draw.demand(&config.extent) } else { None };
    let mut optimizer = match &demand {
        Some(demand) => Optimizer::for_demand(config.clone(), demand)?,
        None => Optimizer::new(config.clone())?,
    };
    check(&optimizer);
    let until = draw.until();
    if std::env::var_os("FSOT_FUZZ_SHOW").is_some() {
        println!("{until:?} {demand:?}");
    }
    let begin = Instant::now();
    let mut seen = 0;
    let report = optimizer.run_observed(until, |step| {
        seen += 1;
        assert!(step.displacement.is_finite() && step.rate.is_finite(), "{step:?}");
        assert!(step.step <= step.steps, "{step:?}");
        if seen == 1 {
            assert!(step.loss().is_finite());
        }
        // What is asked for may be long; a step is not.
        if seen >= 40 || begin.elapsed() > LONGEST / 8 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    check(&optimizer);
    assert_eq!(report.steps, seen);
    for _ in 0..draw.below(3) {
        let [rate, balance] = [(); 2].map(|()| draw.number(0.0, 2.0));
        if draw.chance(0.5) {
            let step = optimizer.step(rate, balance)?;
            assert!(step.displacement.is_finite(), "{step:?}");
        } else {
            assert!(optimizer.sweep(rate, balance)?.is_finite());
        }
        check(&optimizer);
    }
    let metadata = optimizer.metadata(&report);
    let written = serde_json::to_string(&metadata).expect("metadata is plain data");
    let read: fsot::files::Metadata = serde_json::from_str(&written).expect("what was written");
    // Classes and measures of one's own are written by name only.
    if let Ok(read) = serde_json::from_value::<Config>(read.configuration) {
        assert_eq!(read, config);
    }
    if draw.chance(0.2) {
        let slices = optimizer.objective().draw(draw.pick(&[0, 1, u64::MAX]), 3, Role::Descend);
        let points: Vec<f64> = optimizer.points().iter().map(|&value| value.into()).collect();
        let found = optimizer.objective().value_and_gradient(&points, &slices[..slices.len().min(16)]);
        assert!(found.is_ok_and(|found| found.value.is_finite()));
        match Bound::measure(&optimizer.table(), optimizer.objective(), 1, 16) {
            Ok(bound) => assert!(bound.total.value.is_finite() && bound.total.value >= 0.0, "{bound:?}"),
            // A measure that is one along those directions only that an optimiser asks for.
            Err(error) => assert!(matches!(error, MeasureError::Target(_)), "{error}"),
        }
    }
    Ok(())
}

fn check(optimizer: &Optimizer) {
    let out = optimizer.points().iter().position(|value| !(0.0..1.0).contains(value));
    assert!(out.is_none(), "value {out:?} is {}", optimizer.points()[out.unwrap_or(0)]);
}

/// Words for people: what is wrong, a colon, what to do; no number longer than anybody reads.
fn check_words(error: &ConfigError) {
    let words = error.to_string();
    let (wrong, remedy) = words.rsplit_once(": ").expect("two parts");
    assert!(!wrong.is_empty() && !remedy.is_empty() && words.len() < 400, "{words}");
    for number in words.split(|c: char| !(c.is_ascii_digit() || c == '.')).filter(|run| run.contains('.')) {
        let digits = number.trim_start_matches(['0', '.']).chars().filter(char::is_ascii_digit).count();
        assert!(digits <= 6, "{words}");
    }
}

#[test]
fn whatever_is_asked_for_is_answered_soon() {
    let factor: f64 = std::env::var("FSOT_FUZZ").ok().map_or(1.0, |factor| factor.parse().expect("a factor"));
    let first: u64 =
        std::env::var("FSOT_FUZZ_FIRST").ok().map_or(0, |first| first.parse().expect("a number"));
    let count = (COUNT as f64 * factor).ceil() as u64;
    let (mut refused, mut ran, mut failures) = (0, 0, Vec::new());
    let mut longest = Duration::ZERO;
    for index in first..first + count {
        // Other work may share the machine: what takes too long may try again.
        for attempt in 0..3 {
            let (sender, receiver) = mpsc::channel();
            std::thread::spawn(move || {
                let begin = Instant::now();
                let ended = catch_unwind(AssertUnwindSafe(|| {
                    let ended = run(index);
                    if let Ended::Refused(error) = &ended {
                        check_words(error);
                    }
                    ended
                }));
                sender.send((ended, begin.elapsed()))
            });
            let last = attempt == 2;
            match receiver.recv_timeout(10 * LONGEST) {
                Err(_) => {
                    failures.push(format!("{index}: no answer"));
                    break;
                }
                Ok((_, elapsed)) if elapsed > LONGEST && !last => continue,
                Ok((_, elapsed)) if elapsed > LONGEST => failures.push(format!("{index}: took {elapsed:?}")),
                Ok((Err(panic), _)) => {
                    let words = panic.downcast_ref::<String>().cloned();
                    let words = words.or_else(|| panic.downcast_ref::<&str>().map(|words| words.to_string()));
                    failures.push(format!("{index}: {}", words.unwrap_or_default()));
                }
                Ok((Ok(ended), elapsed)) => {
                    longest = longest.max(elapsed);
                    match ended {
                        Ended::Refused(_) => refused += 1,
                        Ended::Ran => ran += 1,
                    }
                }
            }
            break;
        }
        assert!(failures.len() < 50, "{}", failures.join("\n"));
    }
    println!("{ran} tables, {refused} refusals, the longest after {longest:?}");
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
    // Neither everything is refused nor nothing.
    assert!(4 * ran > count && 10 * refused > count, "{ran} tables, {refused} refusals of {count}");
}
