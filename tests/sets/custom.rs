//! Families and targets that the caller writes.

use fsot::classes::{ClassError, ClassFamily, ClassSamples, Classes};
use fsot::config::{Role, Term, TermError};
use fsot::metrics::{Samples, SlicedDistance};
use fsot::targets::{Measure, Projected, Target, TargetError};
use fsot::{Config, ConfigError, Extent, Optimizer};

use crate::{distance, optimised};

/// Samples whose number has the same remainder; weights fall along the class.
#[derive(Debug)]
struct Comb {
    teeth: usize,
    fault: Option<(u32, f64)>,
}

impl ClassFamily for Comb {
    fn name(&self) -> &str {
        "comb"
    }
    fn members(&self, _: &Extent) -> usize {
        self.teeth
    }
    fn member(&self, extent: &Extent, member: usize) -> ClassSamples {
        let samples = (member..extent.samples()).step_by(self.teeth).map(|sample| (sample as u32, 1.0));
        ClassSamples { samples: samples.chain(self.fault).collect(), weight: 1.0 }
    }
}

/// Uniform on the lower left quarter of the square.
#[derive(Debug)]
struct Quarter {
    dims: usize,
    scale: f64,
}

impl Measure for Quarter {
    fn name(&self) -> &str {
        "quarter"
    }
    fn dims(&self) -> usize {
        self.dims
    }
    fn project(&self, direction: &[f64]) -> Projected {
        let law = Target::UniformCube.project(direction);
        Projected::from_quantile(|u| self.scale * law.quantile(u))
    }
}

fn term(classes: Classes, target: Target) -> Term {
    Term { classes, target, dims: vec![0, 1], weight: 1.0, role: Role::Descend }
}

fn comb(fault: Option<(u32, f64)>) -> Classes {
    Classes::custom(Comb { teeth: 3, fault })
}

#[test]
fn a_custom_family_under_a_custom_target() {
    let target = Target::custom(Quarter { dims: 2, scale: 0.5 });
    let points = optimised(Config::point_set(90, 2, vec![term(comb(None), target.clone())]), 2000);
    assert!(points.iter().filter(|&&value| value < 0.52).count() >= 178, "{points:?}");
    for tooth in 0..3 {
        let class: Vec<f64> = points.chunks_exact(2).skip(tooth).step_by(3).flatten().copied().collect();
        // A set of 30 on the whole square, alone, reaches 0.026; half of it on a square of half the side.
        let distance = distance(&class, 2, &target, 64);
        assert!(distance < 0.018, "{distance}");
    }
}

#[test]
fn faults_are_named() {
    let refused =
        |classes, target| Optimizer::new(Config::point_set(9, 2, vec![term(classes, target)])).err().unwrap();
    for (fault, expected) in [
        ((9, 1.0), "name samples of the table only"),
        ((0, 1.0), "name each sample once"),
        ((1, 1.5), "give weights in [0, 1]"),
        ((1, f64::NAN), "give weights in [0, 1]"),
    ] {
        let error = refused(comb(Some(fault)), Target::UniformCube);
        assert!(error.to_string().starts_with("term 0: class 0 of \"comb\""), "{error}");
        assert!(error.to_string().ends_with(expected), "{error}");
    }
    let error = refused(comb(None), Target::custom(Quarter { dims: 3, scale: 0.5 }));
    assert_eq!(error, ConfigError::Term { term: 0, problem: TermError::TargetDims { target: 3, dims: 2 } });
    let error = refused(comb(None), Target::custom(Quarter { dims: 2, scale: f64::NAN }));
    assert!(is_no_law(&error), "{error}");
    let empty = Classes::custom(Comb { teeth: 0, fault: None });
    let error = refused(empty, Target::UniformCube);
    let problem = TermError::Classes(ClassError::Empty { family: "the caller's classes" });
    assert_eq!(error, ConfigError::Term { term: 0, problem });
}

fn is_no_law(error: &ConfigError) -> bool {
    matches!(error, ConfigError::Term { term: 0, problem: TermError::Target(TargetError::BadLaw { .. }) })
}

/// What is no law is refused by whoever uses it.
#[test]
fn laws_that_are_none_are_refused() {
    #[derive(Debug)]
    struct Given(fn() -> Projected);
    impl Measure for Given {
        fn name(&self) -> &str {
            "given"
        }
        fn dims(&self) -> usize {
            2
        }
        fn project(&self, _: &[f64]) -> Projected {
            (self.0)()
        }
    }
    let laws: [fn() -> Projected; 7] = [
        || Projected::from_quantile(|_| f64::NAN),
        || Projected::from_samples(Vec::new()),
        || Projected::from_density(&[0.0, 1.0], &[0.0, 0.0]),
        || Projected::from_density(&[0.0, 1.0], &[-1.0, 3.0]),
        || Projected::from_density(&[1.0, 0.0], &[1.0, 1.0]),
        || Projected::from_density(&[0.0, 0.5, 1.0], &[1.0, 1.0]),
        || Projected::from_density(&[], &[]),
    ];
    for (index, law) in laws.into_iter().enumerate() {
        let target = Target::custom(Given(law));
        let points = Samples::points(&[0.3, 0.6, 0.1, 0.9], 2).unwrap();
        let error = SlicedDistance::measure(points, &[0, 1], &target, 8).unwrap_err();
        assert!(error.to_string().contains("no finite law"), "{index}: {error}");
        let error = Optimizer::new(Config::point_set(9, 2, vec![term(comb(None), target)])).unwrap_err();
        assert!(is_no_law(&error), "{index}: {error:?}");
    }
}

#[test]
fn code_is_written_by_name_and_not_read_back() {
    let write = |term| serde_json::to_string(&Config::point_set(9, 2, vec![term])).unwrap();
    let read = |text: &str| serde_json::from_str::<Config>(text);
    let text = write(term(comb(None), Target::UniformCube));
    assert!(text.contains(r#""custom":"comb""#), "{text}");
    assert!(read(&text).unwrap_err().to_string().contains("add the term again with Classes::custom"));
    let text = write(term(Classes::WholeTable, Target::custom(Quarter { dims: 2, scale: 0.5 })));
    assert!(read(&text).unwrap_err().to_string().contains("add the term again with Target::custom"));
}

#[test]
fn all_else_is_read_back() {
    let density = fsot::targets::Density::new(2, 2, vec![0.0, 1.0, 2.0, 0.5]).unwrap();
    let cloud = Target::Cloud(fsot::targets::PointCloud::new(2, vec![0.0, 1.0, 0.5, 0.5]).unwrap().into());
    let configs = [
        Config::classes(&[3, 4], 2, &fsot::config::LabelSubsets::Every),
        Config::progressive(16, 2, fsot::classes::PrefixLengths::Every),
        Config::stippling(10, density),
        Config::point_set(5, 2, vec![term(Classes::WholeTable, cloud)]),
    ];
    for config in configs {
        let text = serde_json::to_string(&config).unwrap();
        assert_eq!(serde_json::from_str::<Config>(&text).unwrap(), config);
    }
    // A density from a file is checked like any other.
    let text = r#"{"width":1,"height":2,"values":[0.0,0.0]}"#;
    assert!(
        serde_json::from_str::<fsot::targets::Density>(text)
            .unwrap_err()
            .to_string()
            .contains("density is 0")
    );
}
