use super::*;
use crate::metrics::{ErrorImage, Estimate};
use crate::table::SampleTable;
use crate::table::extent::Extent;
use approx::{assert_abs_diff_eq, assert_relative_eq};
use ndarray::Array3;

fn image(shape: (usize, usize, usize), f: impl Fn(usize, usize, usize) -> f64) -> Spectra {
    Spectra::of_image(Array3::from_shape_fn(shape, |(t, y, x)| f(t, y, x)).view(), 1.0)
}

/// All power at one frequency: N times white noise there, nothing elsewhere.
fn assert_peaks(spectrum: &Array2<f64>, peaks: &[([usize; 2], f64)]) {
    for ((row, column), &power) in spectrum.indexed_iter() {
        let peak = peaks.iter().find(|(at, _)| *at == [row, column]);
        assert_abs_diff_eq!(power, peak.map_or(0.0, |(_, power)| *power), epsilon = 1e-10);
    }
}

#[test]
fn patterns_peak_where_they_should() {
    let sign = |n: usize| if n.is_multiple_of(2) { 1.0 } else { -1.0 };
    // A checkerboard that stands still: the Nyquist frequency, which is row and column 0 of a centred array.
    let checkerboard = image((4, 6, 8), |_, y, x| sign(x + y));
    assert_peaks(&checkerboard.xy, &[([0, 0], 48.0)]);
    assert_peaks(&checkerboard.xt, &[([2, 0], 32.0)]);
    // Flicker of whole frames; a constant.
    let flicker = image((4, 6, 8), |t, _, _| sign(t));
    assert_peaks(&flicker.xy, &[([3, 4], 48.0)]);
    assert_peaks(&flicker.xt, &[([0, 4], 32.0)]);
    // One cycle down 5 rows, two cycles across 7 columns: a wave and its mirror share the power ½ · 35.
    let wave =
        image((1, 5, 7), |_, y, x| (std::f64::consts::TAU * (y as f64 / 5.0 + 2.0 * x as f64 / 7.0)).cos());
    assert_peaks(&wave.xy, &[([3, 5], 8.75), ([1, 1], 8.75)]);
    let radial = wave.radial();
    let peak = radial.iter().max_by(|a, b| a.power.total_cmp(&b.power)).unwrap();
    // Two frequencies of the ring around 0.35 · 7 ≈ 2: radius (1/5, 2/7).
    assert!((peak.frequency - 0.2_f64.hypot(2.0 / 7.0)).abs() < 0.5 / 7.0);
    assert_abs_diff_eq!(wave.low_frequency_share(0.2), 0.0, epsilon = 1e-12);
    assert!(wave.low_frequency_share(0.36) > 1.0);
    assert!(wave.low_frequency_share(0.01).is_nan());
}

/// Mean power over 64 tables of every frequency within 5 standard errors of 1 (192 checks, p = 1e-4).
#[test]
fn white_noise_is_flat() {
    let extent = Extent { frames: 3, height: 6, width: 8, spp: 2 };
    let integrands = Integrands::random(2, 16, 1).unwrap();
    let spectra: Vec<Spectra> = (0..64)
        .map(|seed| {
            let table = SampleTable::white_noise(extent, 2, seed).unwrap();
            Spectra::measure(&table, &[1, 0], &integrands).unwrap()
        })
        .collect();
    let check = |pick: &dyn Fn(&Spectra) -> f64| {
        let over = Estimate::of(spectra.iter().map(pick));
        assert!((over.mean - 1.0).abs() < 5.0 * over.standard_error, "{over:?}");
        assert!(over.standard_error < 0.2, "{over:?}");
    };
    for x in 0..8 {
        for y in 0..6 {
            check(&|spectra| spectra.xy[[y, x]]);
        }
        for t in 0..3 {
            check(&|spectra| spectra.xt[[t, x]]);
        }
    }
    check(&|spectra| spectra.radial()[1].power);
    check(&|spectra| spectra.low_frequency_share(0.25));
}

#[test]
fn a_table_is_the_mean_of_its_images() {
    let extent = Extent { frames: 2, height: 3, width: 4, spp: 2 };
    let table = SampleTable::white_noise(extent, 3, 7).unwrap();
    let integrands = Integrands::random(2, 3, 1).unwrap();
    let spectra = Spectra::measure(&table, &[2, 1], &integrands).unwrap();
    let (mut xy, mut xt) = (Array2::zeros((3, 4)), Array2::zeros((2, 4)));
    for integrand in integrands.iter() {
        let image = ErrorImage::measure(&table, &[2, 1], integrand).unwrap();
        let one = Spectra::of_image(image.errors.view(), image.white_variance);
        xy += &(one.xy / 12.0);
        xt += &(one.xt / 12.0);
    }
    for (mean, expected) in spectra.xy.iter().chain(&spectra.xt).zip(xy.iter().chain(&xt)) {
        assert_relative_eq!(mean, expected, max_relative = 1e-10);
    }
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Spectra::measure(&table, &[2, 1], &integrands).unwrap())
    };
    assert_eq!(on(1), on(2));
}

/// White noise prefers no direction: 64 tables within 4 standard errors of 1 in every ring.
#[test]
fn white_noise_is_isotropic_and_stripes_are_not() {
    let integrands = Integrands::random(2, 16, 1).unwrap();
    let rings: Vec<[AnisotropyRing; 3]> = (0..64)
        .map(|seed| {
            let table = SampleTable::white_noise(Extent::still(32, 32), 2, seed).unwrap();
            Spectra::measure(&table, &[0, 1], &integrands).unwrap().anisotropy()
        })
        .collect();
    for ring in 0..3 {
        // Logarithms, so that a ratio and its inverse are alike.
        let over = Estimate::of(rings.iter().map(|rings| rings[ring].along_y_over_along_x.ln()));
        assert!(over.mean.abs() < 4.0 * over.standard_error, "{ring}: {over:?}");
        assert!(over.standard_error < 0.03, "{ring}: {over:?}");
    }
    let stripes = ndarray::Array3::from_shape_fn((1, 32, 32), |(_, _, x)| if x % 4 < 2 { 0.5 } else { -0.5 });
    let of_stripes = Spectra::of_image(stripes.view(), 0.25).anisotropy()[1].along_y_over_along_x;
    assert!(of_stripes < 1e-6, "{of_stripes}");
}
