//! Prefixes of a sequence and of pixels.

use fsot::classes::{Classes, PrefixLength, PrefixLengths, PrefixOf};
use fsot::config::{Role, Term};
use fsot::metrics::{Integrands, Samples, SetError};
use fsot::targets::Target;
use fsot::{Config, Extent};

use crate::{distance, optimised};

/// Measured after 4,000 slices: below 0.1 at 64 points, below 0.06 at 256.
#[test]
fn every_power_of_two_integrates_well() {
    let points = optimised(Config::progressive(256, 2, PrefixLengths::PowersOfTwo), 4000);
    let integrands = Integrands::random(2, 64, 0).unwrap();
    for (length, limit) in [(16, 0.35), (64, 0.15), (256, 0.08)] {
        let prefix = Samples::points(&points, 2).unwrap().select(..length).unwrap();
        let ratio = SetError::measure(prefix, &[0, 1], &integrands).unwrap().ratios.mean.mean;
        assert!(ratio < limit, "{length}: {ratio}");
    }
}

#[test]
fn given_and_all_lengths_can_be_had() {
    let given = PrefixLengths::Given(vec![
        PrefixLength { length: 24, weight: 1.0 },
        PrefixLength { length: 100, weight: 0.5 },
    ]);
    let distance = |points: &[f64]| distance(points, 2, &Target::UniformCube, 64);
    for lengths in [given, PrefixLengths::Every] {
        let points = optimised(Config::progressive(100, 2, lengths), 1000);
        // White noise: sqrt((1/12) / n) in each direction, about.
        for (length, share) in [(24, 0.7), (100, 0.45)] {
            let (distance, noise) = (distance(&points[..2 * length]), (1.0 / 12.0 / length as f64).sqrt());
            assert!(distance < share * noise, "{length}: {distance} of {noise}");
        }
    }
}

/// For adaptive renderers: 1, 2, 4 and 8 of a pixel's 8 samples are stratified, beside the lattice's own
/// classes.
#[test]
fn prefixes_of_pixels_join_the_lattice() {
    let extent = Extent { frames: 1, height: 16, width: 16, spp: 8 };
    let mut config = Config::new(extent, 2);
    let plain = optimised(config.clone(), 64);
    let classes = Classes::Prefixes { of: PrefixOf::Pixel, lengths: PrefixLengths::PowersOfTwo };
    let (target, dims, role) = (Target::UniformCube, vec![0, 1], Role::Descend);
    config.terms.push(Term { classes, target, dims, weight: 0.5, role });
    let prefixed = optimised(config, 64);
    let distance = |points: &[f64]| {
        let firsts = points.chunks_exact(16).map(|pixel| &pixel[..8]);
        let of = |points| distance(points, 2, &Target::UniformCube, 16);
        firsts.map(of).sum::<f64>() / 256.0
    };
    assert!(distance(&prefixed) < 0.85 * distance(&plain), "{} {}", distance(&prefixed), distance(&plain));
}
