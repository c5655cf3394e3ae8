//! The gradient is the derivative of the value, by central differences in a property test that seeks trouble.

use fsot::classes::{Classes, FilterForm};
use fsot::config::Domain;
use fsot::objective::Slice;
use fsot::{Extent, Objective};
use proptest::prelude::*;

use crate::{lattice, objective, term, unit};

/// Raw material of a case; every number is used as it is or reduced modulo what it chooses from.
#[derive(Clone, Debug)]
struct Raw {
    dims: usize,
    spp: usize,
    torus: Vec<bool>,
    group: Vec<usize>,
    points: Vec<f64>,
    troubles: Vec<(usize, usize, usize, f64)>,
    slices: Vec<RawSlice>,
}

/// Term, member, level, direction and cut.
type RawSlice = (usize, usize, f64, Vec<f64>, Vec<f64>);

struct Case {
    objective: Objective,
    domains: Vec<Domain>,
    group: Vec<usize>,
    points: Vec<f64>,
    slices: Vec<Slice>,
}

fn extent(spp: usize) -> Extent {
    Extent { frames: 2, height: 2, width: 3, spp }
}

fn raw() -> impl Strategy<Value = Raw> {
    (1_usize..=5, 1_usize..=2).prop_flat_map(|(dims, spp)| {
        let samples = extent(spp).samples();
        let group = Just((0..dims).collect::<Vec<_>>()).prop_shuffle();
        let group = (group, 1..=dims).prop_map(|(group, len)| group[..len].to_vec());
        let component = prop_oneof![4 => -1.0..1.0, 1 => Just(0.0), 1 => Just(0.5), 1 => -1e-4..1e-4];
        let direction = prop::collection::vec(component, dims);
        // 0.96 and more select a single pixel of the current frame.
        let level = prop_oneof![3 => 0.0..1.0, 1 => Just(0.0), 1 => 0.96..1.0];
        let cut = prop::collection::vec(0.0..1.0, dims);
        (
            Just((dims, spp)),
            prop::collection::vec(any::<bool>(), dims),
            group,
            prop::collection::vec(0.0..1.0, samples * dims),
            prop::collection::vec((0..2_usize, 0..samples, 0..samples, -6.0..-2.0), 0..4),
            prop::collection::vec((0..5_usize, 0..1000_usize, level, direction, cut), 1..8),
        )
            .prop_map(|((dims, spp), torus, group, points, troubles, slices)| Raw {
                dims,
                spp,
                torus,
                group,
                points,
                troubles,
                slices,
            })
    })
}

fn build(raw: &Raw) -> Case {
    let Raw { dims, spp, group, .. } = raw;
    let domain = |&torus: &bool| if torus { Domain::Torus } else { Domain::Interval };
    let domains: Vec<Domain> = raw.torus.iter().map(domain).collect();
    let families = [
        (lattice(FilterForm::LevelSets), 12),
        (lattice(FilterForm::Weighted), 12),
        (Classes::WholeTable, 1),
        (Classes::PerFrame, 2),
        (Classes::PerPixel, 12),
    ];
    let terms: Vec<_> = families.iter().map(|(classes, _)| term(classes.clone(), group)).collect();
    let objective = objective(extent(*spp), &domains, &terms);
    let mut points = raw.points.clone();
    for &(kind, a, b, exponent) in &raw.troubles {
        let little = 10_f64.powf(exponent);
        for dim in 0..*dims {
            points[a * dims + dim] = match kind {
                // Nearly the same point as another one.
                0 if a != b => (points[b * dims + dim] + little * (1.0 + dim as f64)).rem_euclid(1.0),
                // Near the seam, on either side.
                _ if b % 2 == 0 => little,
                _ => 1.0 - little,
            };
        }
    }
    let slice = |(term, member, level, direction, cut): &RawSlice| {
        let mut direction = direction[..group.len()].to_vec();
        if direction.iter().all(|component| component.abs() < 1e-3) {
            direction[0] = 1.0;
        }
        Slice {
            term: *term,
            member: member % families[*term].1,
            level: *level,
            direction: unit(&direction),
            cut: cut[..group.len()].to_vec(),
        }
    };
    Case { objective, slices: raw.slices.iter().map(slice).collect(), group: group.clone(), domains, points }
}

impl Case {
    /// How far a coordinate may move, at least, before two samples swap ranks along a slice, pass its cut or
    /// leave the interval: the value is a quadratic polynomial up to there.
    fn smooth(&self) -> f64 {
        let dims = self.domains.len();
        let mut gap: f64 = 1e-3;
        for slice in &self.slices {
            let mut projections = Vec::new();
            for point in self.points.chunks_exact(dims) {
                let mut along = 0.0;
                for (i, &dim) in self.group.iter().enumerate() {
                    let mut value = point[dim];
                    if self.domains[dim] == Domain::Torus {
                        value = (value - slice.cut[i]).rem_euclid(1.0);
                    }
                    gap = gap.min(value).min(1.0 - value);
                    along += value * slice.direction[i];
                }
                projections.push(along);
            }
            projections.sort_by(f64::total_cmp);
            gap = projections.windows(2).map(|pair| pair[1] - pair[0]).fold(gap, f64::min);
        }
        gap
    }

    fn value(&self, points: &[f64]) -> f64 {
        self.objective.value_and_gradient(points, &self.slices).unwrap().value
    }

    /// Central difference with respect to one coordinate; a torus wraps.
    fn difference(&self, coordinate: usize, step: f64) -> f64 {
        let torus = self.domains[coordinate % self.domains.len()] == Domain::Torus;
        let at = |by: f64| {
            let mut points = self.points.clone();
            points[coordinate] += by;
            if torus {
                points[coordinate] = points[coordinate].rem_euclid(1.0);
            }
            self.value(&points)
        };
        (at(step) - at(-step)) / (2.0 * step)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    /// The value is piecewise quadratic, so a central difference inside a piece is exact up to rounding:
    /// 1e-15 of the value over steps of at least 2.5e-8, against gradients of about the value.
    #[test]
    fn the_gradient_is_that_of_the_value(raw in raw()) {
        let case = build(&raw);
        let gap = case.smooth();
        prop_assume!(gap > 1e-7);
        let gradient = case.objective.value_and_gradient(&case.points, &case.slices).unwrap().gradient;
        let largest = gradient.iter().fold(0.0_f64, |largest, g| largest.max(g.abs()));
        prop_assert!(largest > 0.0);
        for (coordinate, &analytic) in gradient.iter().enumerate() {
            if !case.group.contains(&(coordinate % raw.dims)) {
                prop_assert_eq!(analytic, 0.0);
                continue;
            }
            let numeric = case.difference(coordinate, gap / 4.0);
            prop_assert!(
                (numeric - analytic).abs() <= 1e-6 * largest,
                "coordinate {}: {} instead of {}, gap {}", coordinate, analytic, numeric, gap
            );
        }
    }
}
