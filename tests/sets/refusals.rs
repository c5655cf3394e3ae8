//! What cannot be a class, a prefix, a density or a cloud is refused, with what to do.

use fsot::classes::{Classes, LabelSet, PrefixLength, PrefixLengths, Ramp};
use fsot::config::{Domain, LabelSubsets, Role, Term};
use fsot::targets::{Density, PointCloud, Target};
use fsot::{Config, ConfigError, Optimizer};

fn refused(config: Config) -> ConfigError {
    Optimizer::new(config).err().unwrap()
}

fn term(classes: Classes) -> Term {
    Term { classes, target: Target::UniformCube, dims: vec![0, 1], weight: 1.0, role: Role::Descend }
}

#[test]
fn labels_must_fit_the_set() {
    let classes = Classes::labelled(vec![0, 1, 1], [vec![0]]);
    let error = refused(Config::point_set(4, 2, vec![term(classes)]));
    let expected = ConfigError::SampleCount { what: "the list of labels", given: 3, expected: 4 };
    assert_eq!(error, expected);
    assert!(error.to_string().ends_with("give one per sample"));
    for subsets in [vec![], vec![vec![]], vec![vec![7]]] {
        let error = refused(Config::point_set(3, 2, vec![term(Classes::labelled(vec![0, 1, 1], subsets))]));
        assert_eq!(error, ConfigError::NoClasses { family: "sets of labels" });
    }
    for weight in [0.0, -1.0, f64::NAN, 1e9] {
        let subsets = vec![LabelSet { labels: vec![0], weight }];
        let classes = Classes::Labelled { labels: [0, 0].into(), subsets };
        assert!(matches!(
            refused(Config::point_set(2, 2, vec![term(classes)])),
            ConfigError::OutOfRange { .. }
        ));
    }
    assert_eq!(
        refused(Config::classes(&[0, 0], 2, &LabelSubsets::Every)),
        ConfigError::EmptyAxis { axis: "width" }
    );
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
        let error = refused(Config::progressive(16, 2, lengths));
        assert_eq!(error, ConfigError::PrefixLength { length, most: 16 });
    }
    let error = refused(Config::progressive(16, 2, PrefixLengths::Given(vec![])));
    assert_eq!(error, ConfigError::NoClasses { family: "prefixes" });
}

#[test]
fn densities_and_clouds_must_be_some() {
    let error = Density::new(2, 2, vec![0.0; 4]).unwrap_err();
    assert_eq!(error, ConfigError::NoDensity { width: 2, height: 2 });
    assert!(error.to_string().contains("give at least one above 0"), "{error}");
    assert_eq!(
        Density::new(0, 2, vec![]).unwrap_err(),
        ConfigError::EmptyAxis { axis: "the width of the density" }
    );
    assert!(matches!(Density::new(1 << 17, 1, vec![]), Err(ConfigError::OutOfRange { .. })));
    assert!(matches!(Density::new(2, 2, vec![1.0; 3]), Err(ConfigError::DensityCount { expected: 4, .. })));
    for value in [-1.0, f32::NAN, f32::INFINITY] {
        let error = Density::new(2, 2, vec![1.0, 1.0, value, 1.0]).unwrap_err();
        assert!(matches!(error, ConfigError::BadDensity { x: 0, y: 1, .. }), "{error}");
    }
    let (a, b) = (Density::new(1, 2, vec![1.0; 2]).unwrap(), Density::new(2, 1, vec![1.0; 2]).unwrap());
    assert!(matches!(Density::mixture(&[(1.0, &a), (1.0, &b)]), Err(ConfigError::OtherDensity { .. })));
    assert!(matches!(Density::mixture(&[(-1.0, &a)]), Err(ConfigError::OutOfRange { .. })));
    assert!(matches!(Density::mixture(&[]), Err(ConfigError::EmptyAxis { .. })));
    assert!(matches!(PointCloud::new(2, vec![0.5; 3]), Err(ConfigError::ValueCount { .. })));
    assert!(matches!(PointCloud::new(2, vec![0.5, 1.5]), Err(ConfigError::BadPoint { index: 1, .. })));
    assert!(matches!(PointCloud::new(2, vec![]), Err(ConfigError::EmptyAxis { .. })));
}

#[test]
fn a_target_needs_its_dimensions_and_ends() {
    let density = Density::new(2, 2, vec![1.0; 4]).unwrap();
    let mut config = Config::stippling(5, density);
    config.domains[1] = Domain::Torus;
    assert_eq!(refused(config.clone()), ConfigError::TargetOnTorus { term: 0, dimension: 1 });
    config.domains[1] = Domain::Interval;
    config.terms[0].dims = vec![0];
    assert_eq!(refused(config), ConfigError::TargetDims { term: 0, target: 2, dims: 1 });
}
