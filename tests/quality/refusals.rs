//! Every configuration that cannot be optimised, and the words in which it is refused: what is wrong, what to
//! do.

use fsot::classes::{Classes, FilterForm};
use fsot::config::{Descent, Domain, Role, Schedule, Term};
use fsot::kernel::{SpatialKernel, SpatialTap, TemporalKernel};
use fsot::metrics::MeasureError;
use fsot::targets::Target;
use fsot::{Config, Kernel, Optimizer, SampleTable, metrics};

use crate::extent;

fn good() -> Config {
    Config::new(extent([2, 8, 8, 1]), 3)
}

/// The words in which this change to a good configuration is refused.
fn refusal(change: impl FnOnce(&mut Config)) -> String {
    let mut config = good();
    change(&mut config);
    let error = Optimizer::new(config).expect_err("a refusal").to_string();
    // What is wrong, a colon, what to do about it.
    let (wrong, remedy) = error.rsplit_once(": ").expect("two parts");
    assert!(!wrong.is_empty() && !remedy.is_empty() && !error.contains('\n'), "{error}");
    error
}

fn kernel_refusal(spatial: SpatialKernel, temporal: TemporalKernel) -> String {
    refusal(|config| {
        let kernel = Kernel::product(spatial, temporal);
        config.terms[0].classes = Classes::Lattice { kernel, form: FilterForm::LevelSets };
    })
    .strip_prefix("term 0: ")
    .expect("the term is named")
    .to_string()
}

#[test]
fn extents() {
    for (shape, axis) in
        [([0, 8, 8, 1], "frames"), ([2, 0, 8, 1], "height"), ([2, 8, 0, 1], "width"), ([2, 8, 8, 0], "spp")]
    {
        let words = refusal(|config| config.extent = extent(shape));
        assert_eq!(words, format!("{axis} is 0: give at least 1"));
    }
    let words = refusal(|config| (config.dims, config.domains) = (0, Vec::new()));
    assert_eq!(words, "dims is 0: give at least 1");
    let words = refusal(|config| config.extent = extent([usize::MAX, 2, 2, 1]));
    assert_eq!(
        words,
        format!("the table would hold {} values: stay at or below 2147483647 (2^31 - 1)", u64::MAX)
    );
}

#[test]
fn domains_and_terms() {
    let words = refusal(|config| config.domains = vec![Domain::Torus; 2]);
    assert_eq!(words, "2 domains for 3 dimensions: give one domain per dimension");
    let words = refusal(|config| config.terms.clear());
    assert_eq!(words, "the objective has no term with a positive weight: give at least one");
    for (weight, text) in [(0.0, "0"), (-1.0, "-1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        let words = refusal(|config| config.terms[1].weight = weight);
        assert_eq!(words, format!("term 1: the weight of a term is {text}: give a value from 1e-15 to 1e15"));
    }
}

#[test]
fn groups() {
    let words = refusal(|config| config.terms[2].dims.clear());
    assert_eq!(words, "term 2: the dimension group is empty: name at least one dimension");
    let words = refusal(|config| config.terms[1].dims = vec![0, 3]);
    assert_eq!(
        words,
        "term 1: the dimension group names dimension 3, but the table has 3: name dimensions from 0 to 2"
    );
    let words = refusal(|config| config.terms[0].dims = vec![2, 1, 2]);
    assert_eq!(words, "term 0: the dimension group names dimension 2 twice: name each dimension once");
}

#[test]
fn slicing() {
    for directions in [0, 17] {
        let words = refusal(|config| config.slicing.directions = directions);
        assert_eq!(words, format!("directions per subset is {directions}: give a value from 1 to 16"));
    }
    for share in [-0.1, 1.1, f64::NAN] {
        let words = refusal(|config| config.slicing.axis_share = share);
        assert_eq!(words, format!("the axis share is {share}: give a value in [0, 1]"));
    }
    let words = refusal(|config| config.slicing.batch_slices = Some(0));
    assert_eq!(words, "the batch size is 0: give a value of at least 1 slice");
    let words = refusal(|config| config.slicing.batch_slices = Some(i32::MAX as usize));
    assert!(words.starts_with("a step of 2147483647 slices would take too long: give a batch of at most "));
}

#[test]
fn descents() {
    let constant = Schedule::constant;
    let sgd = |rate, momentum| Descent::Sgd { rate, momentum };
    let adam = |beta1, beta2, epsilon| Descent::Adam { rate: constant(0.1), beta1, beta2, epsilon };
    for (descent, words) in [
        (sgd(constant(0.0), 0.9), "the first step size is 0: give a value from 1e-30 to 1e6"),
        (sgd(Schedule::cosine(1.0, -1.0), 0.9), "the last step size is -1: give a value from 1e-30 to 1e6"),
        (sgd(constant(0.1), 1.0), "momentum is 1: give a value from 0 to 0.999999"),
        (adam(f64::NAN, 0.9, 1e-8), "beta1 is NaN: give a value from 0 to 0.999999"),
        (adam(0.9, 1.5, 1e-8), "beta2 is 1.5: give a value from 0 to 0.999999"),
        (adam(0.9, 0.9, 0.0), "epsilon is 0: give a value from 1e-30 to 1e6"),
    ] {
        assert_eq!(refusal(|config| config.descent = descent), words);
    }
    let words = refusal(|config| config.balance = Schedule::geometric(1.0, f64::INFINITY));
    assert_eq!(words, "the last step size is inf: give a value from 1e-30 to 1e6");
}

#[test]
fn kernels() {
    let gaussian = SpatialKernel::Gaussian { sigma_px: 2.1 };
    let tap = |weight| SpatialTap { dy: 0, dx: 0, weight };
    for sigma_px in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let words = kernel_refusal(SpatialKernel::Gaussian { sigma_px }, TemporalKernel::None);
        assert_eq!(words, format!("sigma_px is {sigma_px}: give a value above 0, at most 1e6"));
    }
    for (spatial, words) in [
        (SpatialKernel::Box { size_px: 0 }, "size_px is 0: give a value from 1 to 1000000"),
        (SpatialKernel::Binomial { size_px: 1001 }, "size_px is 1001: give a value from 1 to 1000"),
        (
            SpatialKernel::Taps(vec![tap(1.0), tap(-0.5)]),
            "the spatial kernel has weight -0.5 at tap 1: weights must be finite and at least 0",
        ),
        (
            SpatialKernel::Taps(vec![tap(0.0)]),
            "the spatial kernel has no positive weight: give at least one tap above 0",
        ),
        (
            SpatialKernel::Taps(Vec::new()),
            "the spatial kernel has no positive weight: give at least one tap above 0",
        ),
    ] {
        assert_eq!(kernel_refusal(spatial, TemporalKernel::None), words);
    }
    for (temporal, words) in [
        (
            TemporalKernel::Gaussian { sigma_frames: f64::NAN },
            "sigma_frames is NaN: give a value above 0, at most 1e6",
        ),
        (TemporalKernel::Ema { alpha: 2.0 }, "alpha is 2: give a value from 1e-6 to 1"),
        (TemporalKernel::Box { frames: 0 }, "frames of the box is 0: give a value from 1 to 1000000"),
        (TemporalKernel::Binomial { frames: 0 }, "frames of the binomial is 0: give a value from 1 to 1000"),
        (TemporalKernel::Perceptual { fps: -60.0 }, "fps is -60: give a value above 0, at most 10000"),
        (
            TemporalKernel::Taps(vec![1.0, f64::NAN]),
            "the temporal kernel has weight NaN at tap 1: weights must be finite and at least 0",
        ),
        (
            TemporalKernel::Taps(vec![1e308, 1e308]),
            "the sum of a kernel's weights is inf: give a value that is finite",
        ),
        (
            TemporalKernel::Taps(Vec::new()),
            "the temporal kernel has no positive weight: give at least one tap above 0",
        ),
    ] {
        assert_eq!(kernel_refusal(gaussian.clone(), temporal), words);
    }
    for truncation in [1.0, -0.1, f64::NAN] {
        let words = refusal(|config| {
            let kernel = Kernel { spatial: gaussian.clone(), temporal: TemporalKernel::None, truncation };
            let classes = Classes::Lattice { kernel, form: FilterForm::Weighted };
            let (target, role) = (Target::UniformCube, Role::Descend);
            config.terms = vec![Term { classes, target, dims: vec![0], weight: 1.0, role }];
        });
        assert_eq!(words, format!("term 0: truncation is {truncation}: give a value in [0, 1)"));
    }
}

#[test]
fn bounds() {
    let other_shape =
        |given| MeasureError::OtherShape { given: Box::new(given), expected: Box::new([2, 8, 8, 1, 3]) };
    let optimizer = Optimizer::new(good()).unwrap();
    let error = metrics::Bound::measure(&optimizer.table(), optimizer.objective(), 0, 0).unwrap_err();
    assert_eq!(error.to_string(), "the number of slices is 0: give at least 1");
    let other = SampleTable::white_noise(extent([2, 8, 8, 1]), 2, 0).unwrap();
    let error = metrics::Bound::measure(&other, optimizer.objective(), 0, 64).unwrap_err();
    assert_eq!(error, other_shape([2, 8, 8, 1, 2]));
    // The same number of values in another arrangement of the axes.
    let other = SampleTable::white_noise(extent([1, 8, 16, 1]), 3, 0).unwrap();
    let error = metrics::Bound::measure(&other, optimizer.objective(), 0, 64).unwrap_err();
    assert_eq!(error, other_shape([1, 8, 16, 1, 3]));
}
