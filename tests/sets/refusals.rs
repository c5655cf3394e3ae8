//! What cannot be a class, a prefix, a density or a cloud is refused, with what to do.

use fsot::classes::{ClassError, Classes, LabelSet, PrefixLength, PrefixLengths, Ramp};
use fsot::config::{Domain, ExtentError, LabelSubsets, Role, Term, TermError};
use fsot::targets::{Density, PointCloud, Target, TargetError};
use fsot::{Config, ConfigError, Optimizer};

fn refused(config: Config) -> ConfigError {
    Optimizer::new(config).unwrap_err()
}

/// What is wrong with the first term.
fn problem(config: Config) -> TermError {
    match refused(config) {
        ConfigError::Term { term: 0, problem } => problem,
        other => panic!("{other}"),
    }
}

fn term(classes: Classes) -> Term {
    Term { classes, target: Target::UniformCube, dims: vec![0, 1], weight: 1.0, role: Role::Descend }
}

#[test]
fn labels_must_fit_the_set() {
    let classes = Classes::labelled(vec![0, 1, 1], [vec![0]]);
    let error = problem(Config::point_set(4, 2, vec![term(classes)]));
    let expected = ClassError::SampleCount { what: "the list of labels", given: 3, expected: 4 };
    assert_eq!(error, expected.into());
    assert!(error.to_string().ends_with("give one per sample"));
    for subsets in [vec![], vec![vec![]], vec![vec![7]]] {
        let error = problem(Config::point_set(3, 2, vec![term(Classes::labelled(vec![0, 1, 1], subsets))]));
        assert_eq!(error, ClassError::Empty { family: "sets of labels" }.into());
    }
    for weight in [0.0, -1.0, f64::NAN, 1e9] {
        let subsets = vec![LabelSet { labels: vec![0], weight }];
        let classes = Classes::Labelled { labels: [0, 0].into(), subsets };
        assert!(matches!(
            problem(Config::point_set(2, 2, vec![term(classes)])),
            TermError::Classes(ClassError::Range(_))
        ));
    }
    assert_eq!(
        refused(Config::classes(&[0, 0], 2, &LabelSubsets::Every)),
        ExtentError::EmptyAxis { axis: "width" }.into()
    );
}

/// Refused, not listed: labels of more points than memory holds.
#[test]
fn more_points_than_a_table_holds_are_refused() {
    for counts in [[99_999_999_999, 5], [usize::MAX, 1], [1 << 31, 0]] {
        let error = refused(Config::classes(&counts, 2, &LabelSubsets::EachAndAll));
        assert!(matches!(error, ConfigError::Extent(ExtentError::TooLarge { .. })), "{counts:?}: {error}");
    }
}

#[test]
fn ramps_must_have_coordinates() {
    for (coordinates, ramps) in [
        (vec![0.0, 0.5], vec![Ramp::Rising]),
        (vec![0.0, 0.5, 1.5], vec![Ramp::Rising]),
        (vec![0.0; 3], vec![Ramp::Rising]),
        (vec![0.5; 3], vec![]),
    ] {
        let classes = Classes::Ramps { coordinates: coordinates.into(), ramps };
        let error = refused(Config::point_set(3, 2, vec![term(classes)])).to_string();
        assert!(error.contains(": give"), "{error}");
    }
}

#[test]
fn prefixes_must_lie_inside() {
    for length in [0, 17] {
        let lengths = PrefixLengths::Given(vec![PrefixLength { length, weight: 1.0 }]);
        let error = problem(Config::progressive(16, 2, lengths));
        assert_eq!(error, ClassError::PrefixLength { length, most: 16 }.into());
    }
    let error = problem(Config::progressive(16, 2, PrefixLengths::Given(vec![])));
    assert_eq!(error, ClassError::Empty { family: "prefixes" }.into());
}

#[test]
fn densities_and_clouds_must_be_some() {
    let error = Density::new(2, 2, vec![0.0; 4]).unwrap_err();
    assert_eq!(error, TargetError::NoDensity { width: 2, height: 2 });
    assert!(error.to_string().contains("give at least one above 0"), "{error}");
    assert_eq!(
        Density::new(0, 2, vec![]).unwrap_err(),
        TargetError::Empty { what: "the width of the density" }
    );
    assert!(matches!(Density::new(1 << 17, 1, vec![]), Err(TargetError::Range(_))));
    assert!(matches!(Density::new(2, 2, vec![1.0; 3]), Err(TargetError::DensityCount { expected: 4, .. })));
    for value in [-1.0, f32::NAN, f32::INFINITY] {
        let error = Density::new(2, 2, vec![1.0, 1.0, value, 1.0]).unwrap_err();
        assert!(matches!(error, TargetError::BadDensity { x: 0, y: 1, .. }), "{error}");
    }
    let (a, b) = (Density::new(1, 2, vec![1.0; 2]).unwrap(), Density::new(2, 1, vec![1.0; 2]).unwrap());
    assert!(matches!(Density::mixture(&[(1.0, &a), (1.0, &b)]), Err(TargetError::OtherDensity { .. })));
    assert!(matches!(Density::mixture(&[(-1.0, &a)]), Err(TargetError::Range(_))));
    assert!(matches!(Density::mixture(&[]), Err(TargetError::Empty { .. })));
    assert!(matches!(
        PointCloud::new(2, vec![0.5; 3]),
        Err(TargetError::IncompletePoint { given: 3, dims: 2 })
    ));
    assert!(matches!(PointCloud::new(2, vec![0.5, 1.5]), Err(TargetError::BadCoordinate { index: 1, .. })));
    assert!(matches!(PointCloud::new(2, vec![]), Err(TargetError::Empty { .. })));
}

#[test]
fn a_target_needs_its_dimensions_and_ends() {
    let density = Density::new(2, 2, vec![1.0; 4]).unwrap();
    let mut config = Config::stippling(5, density);
    config.domains[1] = Domain::Torus;
    assert_eq!(problem(config.clone()), TermError::TargetOnTorus { dimension: 1 });
    config.domains[1] = Domain::Interval;
    config.terms[0].dims = vec![0];
    assert_eq!(problem(config), TermError::TargetDims { target: 2, dims: 1 });
}
