//! The batched engine against a textbook twin: one step of both, from the same table, along the same slices.

mod textbook;

use fsot::classes::FilterForm;
use fsot::config::{Descent, DimensionGroup, Domain, Role, Term};
use fsot::kernel::{SpatialKernel, SpatialTap, TemporalKernel};
use fsot::optimizer::SliceStep;
use fsot::{Config, Extent, Kernel, Optimizer, SampleTable};

/// What a case is about; the rest is [`Config::new`].
struct Case {
    extent: [usize; 4],
    dims: usize,
    temporal: TemporalKernel,
    form: FilterForm,
    groups: Vec<DimensionGroup>,
    torus: bool,
    directions: usize,
    axis_share: f64,
    /// Subsets per step, about.
    subsets: usize,
}

impl Case {
    fn new(extent: [usize; 4], dims: usize) -> Self {
        Self {
            extent,
            dims,
            temporal: TemporalKernel::None,
            form: FilterForm::LevelSets,
            groups: DimensionGroup::pairs_and_whole(dims),
            torus: false,
            directions: 16,
            axis_share: 0.0,
            subsets: 120,
        }
    }

    fn config(&self) -> Config {
        let [frames, height, width, spp] = self.extent;
        let extent = Extent { frames, height, width, spp };
        let kernel = Kernel::product(SpatialKernel::Gaussian { sigma_px: 2.1 }, self.temporal.clone());
        let mut config = Config::new(extent, self.dims);
        config.terms = Term::blue_noise(&[kernel], self.form, &self.groups, &extent);
        // As much of the balancing terms as makes them take part in every step.
        for term in &mut config.terms {
            if term.role == Role::Balance {
                term.weight *= 30.0;
            }
        }
        if self.torus {
            config.domains = vec![Domain::Torus; self.dims];
        }
        config.descent = Descent::barycentric();
        config.slicing.directions = self.directions;
        config.slicing.axis_share = self.axis_share;
        config.slicing.batch_slices = Some(self.subsets * self.directions);
        config.seed = 5;
        config
    }

    /// Compares both roles of a step from white noise and of one from a partly optimised table. Returns the
    /// sizes of all subsets that were compared.
    fn check(&self) -> Vec<usize> {
        let config = self.config();
        let mut sizes = Vec::new();
        let mut optimizer = Optimizer::new(config.clone()).unwrap();
        for step in 0..4 {
            let before = optimizer.table();
            if step % 3 == 0 {
                sizes.extend(self.check_step(&config, &before));
            }
            optimizer.step(0.8, 0.7).unwrap();
        }
        sizes
    }

    /// Compares one step, the first of an optimiser that starts from this table.
    fn check_step(&self, config: &Config, before: &SampleTable) -> Vec<usize> {
        // Only descended, then descended and balanced: the second role sees the table as it was before, and
        // moves on from where the first ended.
        let step = |balance: f64| {
            let mut optimizer = Optimizer::from_table(config.clone(), before.clone()).unwrap();
            let SliceStep { displacement, slices, .. } = optimizer.step(0.8, balance).unwrap();
            (optimizer.into_table(), displacement, slices)
        };
        let (descended, displacement, slices) = step(0.0);
        let (balanced, ..) = step(0.7);
        let optimizer = Optimizer::new(config.clone()).unwrap();
        let draw = |role| optimizer.objective().draw(config.seed, 0, role);
        let (descend, balance) = (draw(Role::Descend), draw(Role::Balance));
        assert!(!descend.is_empty() && !balance.is_empty());
        assert_eq!(slices as usize, descend.len() + balance.len());
        let mut sizes = Vec::new();
        for (role, slices, from, to, rate) in [
            ("descend", &descend, before, &descended, 0.8),
            ("balance", &balance, &descended, &balanced, 0.7),
        ] {
            let pull = textbook::pull(config, slices, before.values(), self.tie());
            if role == "descend" {
                let expected = (pull.squares / pull.mass).sqrt();
                // Ties and the rounding of sums over lanes.
                assert!((displacement - expected).abs() < 1e-5 * expected, "{displacement} {expected}");
            }
            let expected = textbook::moved(config, from.values(), &pull, rate);
            let mut moved = 0;
            for (coordinate, (&given, &expected)) in to.values().iter().zip(&expected).enumerate() {
                let torus = config.domains[coordinate % config.dims] == Domain::Torus;
                let apart = (f64::from(given) - expected).abs();
                let apart = if torus { apart.min(1.0 - apart) } else { apart };
                let tolerance = self.tolerance() + rate * pull.slack[coordinate];
                assert!(
                    apart <= tolerance,
                    "{role}: coordinate {coordinate} moved from {} to {given} instead of {expected}, \
                     {apart:e} away with {tolerance:e} allowed",
                    from.values()[coordinate],
                );
                moved += usize::from((f64::from(from.values()[coordinate]) - expected).abs() > 1e-4);
            }
            // The comparison is about motion: nearly all must have moved far more than the tolerance.
            let held = pull.hits.iter().filter(|&&hits| hits > 0.0).count();
            assert!(moved * 2 > held, "{role}: {moved} of {held}");
            // The slack must stay an exception, or it would hide anything.
            let slack = pull.slack.iter().sum::<f64>() / held as f64;
            assert!(slack < 2e-4, "{role}: {slack}");
            sizes.extend(pull.sizes);
        }
        sizes
    }

    /// Projections closer than this may change places: keys of subsets up to 1024 keep 22 bits of a support
    /// of length up to √D, and the projections themselves are sums of D roundings of 2⁻²⁴.
    fn tie(&self) -> f64 {
        let d = self.dims as f64;
        d.sqrt() * 2.0_f64.powi(-21) + d * 2.0_f64.powi(-24)
    }

    /// Rounding of a coordinate. Per displacement: D products and sums of `f32` and a target, each within
    /// 2⁻²⁴ of numbers up to √D; the mean is taken D-fold; 16 numbers and then some hundred subsets are
    /// summed one after the other, each sum within 2⁻²⁴ of up to a hundred times the mean. From three
    /// dimensions on, tabulated targets are off by up to 2e-6, D-fold again.
    fn tolerance(&self) -> f64 {
        let d = self.dims as f64;
        let tabulated = if self.groups.iter().any(|group| group.dims.len() > 2) { 2e-6 * d } else { 0.0 };
        4.0 * d * d.sqrt() * 2.0_f64.powi(-24) + 1e-6 + tabulated
    }
}

fn group(dims: &[usize], weight: f64) -> DimensionGroup {
    DimensionGroup { dims: dims.to_vec(), weight }
}

const PERCEPTUAL: TemporalKernel = TemporalKernel::Perceptual { fps: 60.0 };

#[test]
fn static_table() {
    Case::new([1, 24, 24, 1], 2).check();
}

#[test]
fn animated_table() {
    Case { temporal: PERCEPTUAL, ..Case::new([8, 16, 16, 1], 2) }.check();
    Case { temporal: TemporalKernel::Ema { alpha: 0.3 }, ..Case::new([12, 14, 14, 1], 2) }.check();
}

#[test]
fn several_samples_per_pixel() {
    let sizes = Case::new([1, 16, 16, 4], 2).check();
    assert!(sizes.iter().any(|&size| (257..=388).contains(&size)), "{sizes:?}");
}

/// Subsets above 1024 samples leave the lanes; all of these sizes share one family and its sixteen
/// directions.
#[test]
fn sixteen_samples_per_pixel() {
    for (dims, axis_share) in [(2, 0.3), (3, 0.3)] {
        let case = Case { axis_share, subsets: 128, ..Case::new([1, 16, 16, 16], dims) };
        let sizes = case.check();
        for range in [16..=16, 513..=1024, 1025..=1552] {
            assert!(sizes.iter().any(|size| range.contains(size)), "{range:?}");
        }
    }
}

/// Every subset has more than 1024 samples, so it gets a single direction.
#[test]
fn long_subsets_only() {
    for dims in [2, 3] {
        let extent = [1, 4, 5, 60];
        let sizes = Case { subsets: 50, ..Case::new(extent, dims) }.check();
        assert!(sizes.contains(&1200), "{sizes:?}"); // the whole table
        let sizes = Case { subsets: 12, ..Case::new([1, 1, 2, 1025], dims) }.check();
        assert!(sizes.iter().all(|&size| size > 1024), "{sizes:?}");
    }
}

#[test]
fn other_numbers_of_dimensions() {
    for dims in [1, 3, 4, 8] {
        Case::new([1, 16, 16, 1], dims).check();
    }
    let groups = vec![group(&[0, 1], 1.0), group(&[3, 2], 2.0), group(&[3, 0, 1, 2], 0.5)];
    Case { groups, ..Case::new([2, 12, 12, 1], 4) }.check();
    // Dimension 1 in no group: nothing moves it.
    let groups = vec![group(&[0, 2], 1.0)];
    let case = Case { groups, ..Case::new([1, 12, 12, 1], 3) };
    let (before, mut optimizer) =
        (Optimizer::new(case.config()).unwrap().table(), Optimizer::new(case.config()).unwrap());
    optimizer.step(1.0, 1.0).unwrap();
    let after = optimizer.table();
    for (index, (a, b)) in before.values().iter().zip(after.values()).enumerate() {
        assert_eq!(a == b, index % 3 == 1, "{index}");
    }
}

#[test]
fn torus() {
    for dims in [1, 2, 3] {
        Case { torus: true, ..Case::new([1, 16, 16, 1], dims) }.check();
    }
    Case { torus: true, temporal: PERCEPTUAL, ..Case::new([6, 8, 8, 2], 4) }.check();
}

#[test]
fn weighted_form() {
    for dims in [1, 2, 3] {
        let case = Case { form: FilterForm::Weighted, subsets: 100, ..Case::new([1, 16, 16, 1], dims) };
        case.check();
    }
    let case = Case { form: FilterForm::Weighted, subsets: 60, torus: true, ..Case::new([3, 8, 8, 2], 2) };
    case.check();
    // Above 1024 samples per slice.
    Case { form: FilterForm::Weighted, subsets: 40, ..Case::new([1, 12, 12, 16], 2) }.check();
}

#[test]
fn directions_on_the_axes() {
    for (dims, directions) in [(2, 16), (2, 5), (4, 16), (4, 5), (3, 16)] {
        Case { axis_share: 0.5, directions, ..Case::new([1, 16, 16, 1], dims) }.check();
    }
    Case { axis_share: 1.0, ..Case::new([1, 16, 16, 1], 2) }.check();
}

#[test]
fn fewer_directions() {
    for directions in [1, 5] {
        for dims in [2, 4] {
            Case { directions, ..Case::new([1, 16, 16, 1], dims) }.check();
        }
    }
}

#[test]
fn odd_extents() {
    for extent in [[1, 7, 30, 1], [5, 9, 3, 2], [3, 20, 1, 1], [2, 2, 2, 3]] {
        Case { temporal: PERCEPTUAL, ..Case::new(extent, 2) }.check();
    }
}

/// One pixel of one frame: the kernel folds onto it, and every subset is its single sample.
#[test]
fn one_sample() {
    for torus in [false, true] {
        for dims in [1, 2, 5] {
            let mut config = Case { torus, subsets: 4, ..Case::new([1, 1, 1, 1], dims) }.config();
            config.seed = 3;
            let mut optimizer = Optimizer::new(config.clone()).unwrap();
            for _ in 0..3 {
                let before = optimizer.table();
                let slices = optimizer.objective().draw(config.seed, 0, Role::Descend);
                let mut fresh = Optimizer::from_table(config.clone(), before.clone()).unwrap();
                fresh.step(0.5, 0.0).unwrap();
                let pull = textbook::pull(&config, &slices, before.values(), 0.0);
                let expected = textbook::moved(&config, before.values(), &pull, 0.5);
                for (given, expected) in fresh.table().values().iter().zip(expected) {
                    // As in `Case::tolerance`, with five dimensions.
                    assert!((f64::from(*given) - expected).abs() < 1.5e-5, "{given} {expected}");
                }
                optimizer.step(0.5, 0.5).unwrap();
            }
        }
    }
}

/// A weight so small beside the sum of all that its cell has no width in `f64` still has a target.
#[test]
fn weights_too_small_to_have_a_cell() {
    let tap = |index: i32| SpatialTap {
        dy: index / 16,
        dx: index % 16,
        weight: if index == 200 { 1e-12 } else { 1.0 },
    };
    let spatial = SpatialKernel::Taps((0..256).map(tap).collect());
    let kernel = Kernel { spatial, temporal: TemporalKernel::None, truncation: 0.0 };
    for dims in 1..=3 {
        let extent = Extent { frames: 1, height: 16, width: 16, spp: 128 };
        let mut config = Config::new(extent, dims);
        let groups = [group(&[0, 1, 2][..dims], 1.0)];
        config.terms =
            Term::blue_noise(std::slice::from_ref(&kernel), FilterForm::Weighted, &groups, &extent);
        config.slicing.batch_slices = Some(2);
        let mut optimizer = Optimizer::new(config).unwrap();
        assert_eq!(optimizer.objective().taps(0).unwrap().len(), 256);
        let displacement = optimizer.step(1.0, 1.0).unwrap().displacement;
        assert!((0.0..0.1).contains(&displacement), "{displacement}");
        assert!(optimizer.table().values().iter().all(|value| (0.0..1.0).contains(value)));
    }
}

/// The pull times the mass that held a coordinate is the negative gradient, times `N · slices · d / 2`.
#[test]
fn the_pull_is_the_negative_gradient() {
    for (case, d) in [
        (Case::new([1, 16, 16, 1], 2), 2.0),
        (Case { form: FilterForm::Weighted, subsets: 60, ..Case::new([1, 16, 16, 1], 2) }, 2.0),
        (Case { torus: true, temporal: PERCEPTUAL, ..Case::new([6, 10, 10, 1], 1) }, 1.0),
        (Case { groups: vec![group(&[2, 0, 1], 1.0)], ..Case::new([1, 12, 12, 1], 3) }, 3.0),
    ] {
        let config = case.config();
        let mut optimizer = Optimizer::new(config.clone()).unwrap();
        let before = optimizer.table();
        let slices = optimizer.objective().draw(config.seed, 0, Role::Descend);
        let points: Vec<f64> = before.values().iter().map(|&value| value.into()).collect();
        let gradient = optimizer.objective().value_and_gradient(&points, &slices).unwrap().gradient;
        let pull = textbook::pull(&config, &slices, before.values(), case.tie());
        let rate = 0.5;
        optimizer.step(rate, 0.0).unwrap();
        let scale = config.extent.samples() as f64 * slices.len() as f64 * d / 2.0;
        let mut compared = 0;
        for (coordinate, &after) in optimizer.table().values().iter().enumerate() {
            let hits = pull.hits[coordinate];
            if hits == 0.0 {
                assert_eq!(gradient[coordinate], 0.0);
                continue;
            }
            // The textbook's pull is the gradient, to rounding of f64 …
            let expected = -gradient[coordinate] * scale / hits;
            assert!((pull.mean[coordinate] - expected).abs() < 1e-9, "coordinate {coordinate}");
            // … and the engine's is, to that of f32, where no face of an interval stopped it.
            if after == 0.0 || after == fsot::config::BELOW_ONE {
                continue;
            }
            let mut moved = f64::from(after) - points[coordinate];
            if case.torus {
                moved -= moved.round();
            }
            let apart = (moved / rate - expected).abs();
            let tolerance = case.tolerance() / rate + pull.slack[coordinate];
            assert!(apart < tolerance, "coordinate {coordinate}: {} {expected}", moved / rate);
            compared += 1;
        }
        assert!(compared * 10 > points.len() * 9, "{compared} of {}", points.len());
    }
}
