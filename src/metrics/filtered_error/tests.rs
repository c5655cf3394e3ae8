use super::*;
use crate::kernel::SpatialKernel;
use crate::metrics::ErrorImage;
use crate::table::SampleTable;
use approx::assert_relative_eq;

const EXTENT: Extent = Extent { frames: 3, height: 10, width: 12, spp: 4 };

fn kernel() -> Kernel {
    let temporal = TemporalKernel::Taps(vec![0.5, 1.0, 0.25]);
    Kernel::product(SpatialKernel::Gaussian { sigma_px: 1.5 }, temporal)
}

fn stages(measured: &FilteredError) -> [&Ratios; 3] {
    [&measured.unfiltered, &measured.spatial, &measured.spatio_temporal]
}

/// The definition, tap by tap.
fn direct(image: &ndarray::Array3<f64>, extent: &Extent, kernel: &Kernel) -> f64 {
    let taps = kernel.taps(extent).unwrap();
    let sum: f64 = taps.iter().map(|tap| tap.weight).sum();
    let squares = (0..extent.sites()).map(|site| {
        let filtered: f64 = taps
            .iter()
            .map(|tap| {
                let offset = (tap.dt.into(), tap.dy.into(), tap.dx.into());
                let at = extent.wrapped(extent.site(site), offset);
                tap.weight * image[[at.frame, at.y, at.x]]
            })
            .sum();
        (filtered / sum).powi(2)
    });
    squares.sum::<f64>() / extent.sites() as f64
}

#[test]
fn parseval_agrees_with_direct_convolution() {
    let table = SampleTable::white_noise(EXTENT, 3, 5).unwrap();
    let dims = [2, 0];
    let lopsided = vec![
        crate::kernel::SpatialTap { dy: 0, dx: 1, weight: 1.0 },
        crate::kernel::SpatialTap { dy: -2, dx: 0, weight: 0.3 },
    ];
    let odd = Kernel { spatial: SpatialKernel::Taps(lopsided), ..kernel() };
    for kernel in [kernel(), odd] {
        // An odd number, so that a transform with an empty imaginary part occurs as well.
        let integrands = Integrands::random(2, 3, 8).unwrap();
        let measured = FilteredError::measure(&table, &dims, &integrands, &kernel).unwrap();
        let spatial = Kernel { temporal: TemporalKernel::None, ..kernel.clone() };
        let point = Kernel::product(SpatialKernel::Box { size_px: 1 }, TemporalKernel::None);
        for (ratios, kernel) in stages(&measured).iter().zip([&point, &spatial, &kernel]) {
            let taps = kernel.taps(&EXTENT).unwrap();
            let sum: f64 = taps.iter().map(|tap| tap.weight).sum();
            let white: f64 = taps.iter().map(|tap| (tap.weight / sum).powi(2)).sum();
            for family in integrands.families() {
                let ratio = |f| {
                    let image = ErrorImage::measure(&table, &dims, f).unwrap();
                    direct(&image.errors, &EXTENT, kernel) / (f.variance() / 4.0 * white)
                };
                let expected = family.integrands().iter().map(ratio).sum::<f64>() / 3.0;
                assert_relative_eq!(
                    ratios.family(family.name()).unwrap().mean,
                    expected,
                    max_relative = 1e-10
                );
            }
        }
    }
}

/// Mean over 64 tables, within 4 standard errors of 1 in every family and stage (15 checks, p = 1e-3 in all).
#[test]
fn white_noise_is_one() {
    let integrands = Integrands::random(2, 32, 3).unwrap();
    let tables: Vec<FilteredError> = (0..64)
        .map(|seed| {
            let table = SampleTable::white_noise(EXTENT, 2, 100 + seed).unwrap();
            FilteredError::measure(&table, &[0, 1], &integrands, &kernel()).unwrap()
        })
        .collect();
    for stage in 0..3 {
        let check = |name: &str, pick: &dyn Fn(&Ratios) -> f64| {
            let over = super::super::Estimate::of(tables.iter().map(|table| pick(stages(table)[stage])));
            let deviation = (over.mean - 1.0) / over.standard_error;
            assert!(deviation.abs() < 4.0, "{name}, stage {stage}: {over:?}");
            assert!(over.standard_error < 0.1, "{name}, stage {stage}: {over:?}");
        };
        check("mean", &|ratios| ratios.mean.mean);
        for family in integrands.families() {
            check(family.name(), &|ratios| ratios.family(family.name()).unwrap().mean);
        }
    }
}

#[test]
fn equal_points_err_by_the_value_at_the_point() {
    let table = SampleTable::new(EXTENT, 2, vec![0.625; EXTENT.samples() * 2]).unwrap();
    let integrands = Integrands::random(2, 6, 1).unwrap();
    let measured = FilteredError::measure(&table, &[0, 1], &integrands, &kernel()).unwrap();
    for (ratios, kernel) in
        stages(&measured)[1..].iter().zip([Kernel { temporal: TemporalKernel::None, ..kernel() }, kernel()])
    {
        let taps = kernel.taps(&EXTENT).unwrap();
        let sum: f64 = taps.iter().map(|tap| tap.weight).sum();
        let white: f64 = taps.iter().map(|tap| (tap.weight / sum).powi(2)).sum();
        for family in integrands.families() {
            let of = family.integrands().iter();
            // A constant image passes a normalised filter unchanged.
            let ratio = of.map(|f| {
                let error = f.value(&[0.625, 0.625]) - f.integral();
                error * error / (f.variance() / 4.0 * white)
            });
            let expected = ratio.sum::<f64>() / 6.0;
            assert_relative_eq!(ratios.family(family.name()).unwrap().mean, expected, max_relative = 1e-10);
        }
    }
}

#[test]
fn a_single_frame_has_no_time_to_filter() {
    let extent = Extent { frames: 1, height: 8, width: 6, spp: 1 };
    let table = SampleTable::white_noise(extent, 2, 5).unwrap();
    let integrands = Integrands::random(2, 4, 1).unwrap();
    let measured = FilteredError::measure(&table, &[0, 1], &integrands, &kernel()).unwrap();
    let (space, both) = (measured.spatial.mean.mean, measured.spatio_temporal.mean.mean);
    assert_relative_eq!(space, both, max_relative = 1e-12);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let table = SampleTable::white_noise(EXTENT, 4, 5).unwrap();
    let integrands = Integrands::random(4, 16, 1).unwrap();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| FilteredError::measure(&table, &[0, 1, 2, 3], &integrands, &kernel()).unwrap())
    };
    assert_eq!(on(1), on(2));
}

/// All frames: the same to rounding, also for a filter that doesn't see the frame itself or has no symmetry.
#[test]
fn all_frames_one_by_one_are_the_whole() {
    let extent = Extent { frames: 5, ..EXTENT };
    let table = SampleTable::white_noise(extent, 3, 5).unwrap();
    let lopsided = vec![
        crate::kernel::SpatialTap { dy: 0, dx: 1, weight: 1.0 },
        crate::kernel::SpatialTap { dy: -2, dx: 0, weight: 0.3 },
    ];
    let odd = Kernel { spatial: SpatialKernel::Taps(lopsided), ..kernel() };
    let past = Kernel { temporal: TemporalKernel::Taps(vec![0.0, 0.5, 1.0]), ..odd.clone() };
    let integrands = Integrands::random(2, 3, 8).unwrap();
    for kernel in [kernel(), odd, past, Kernel::gaussian(2.1)] {
        let whole = FilteredError::measure(&table, &[2, 0], &integrands, &kernel).unwrap();
        let frames = FilteredError::measure_frames(&table, &[2, 0], &integrands, &kernel, 5).unwrap();
        for (whole, frames) in stages(&whole).iter().zip(stages(&frames)) {
            for (whole, frames) in whole.families.iter().zip(&frames.families) {
                assert_relative_eq!(whole.ratio.mean, frames.ratio.mean, max_relative = 1e-11);
            }
        }
    }
}

/// Two frames that are alike, of four: those two alone, or the other two.
#[test]
fn frames_are_taken_at_equal_distances() {
    let extent = Extent { frames: 2, ..EXTENT };
    let two = SampleTable::white_noise(extent, 2, 5).unwrap();
    let [first, second] =
        [0, 1].map(|half| &two.values()[half * two.values().len() / 2..][..EXTENT.samples() / 3 * 2]);
    let four =
        SampleTable::new(Extent { frames: 4, ..EXTENT }, 2, [first, second, first, second].concat()).unwrap();
    let alone = SampleTable::new(Extent { frames: 1, ..EXTENT }, 2, first.to_vec()).unwrap();
    let integrands = Integrands::random(2, 4, 8).unwrap();
    let still = Kernel::gaussian(1.5);
    let of_two = FilteredError::measure_frames(&four, &[0, 1], &integrands, &still, 2).unwrap();
    let of_one = FilteredError::measure(&alone, &[0, 1], &integrands, &still).unwrap();
    assert_relative_eq!(of_two.spatial.mean.mean, of_one.spatial.mean.mean, max_relative = 1e-11);
    assert_relative_eq!(of_two.unfiltered.mean.mean, of_one.unfiltered.mean.mean, max_relative = 1e-11);
    for frames in [0, 5] {
        let error = FilteredError::measure_frames(&four, &[0, 1], &integrands, &still, frames).unwrap_err();
        assert!(error.to_string().contains("the number of frames"), "{error}");
    }
}
