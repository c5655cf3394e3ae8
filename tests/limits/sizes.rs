//! Sizes that nothing has: refused before anything is made of them.

use fsot::classes::{ClassFamily, ClassSamples, Classes, Demand, PrefixLengths};
use fsot::config::{LabelSubsets, Role};
use fsot::metrics::{Bound, Integrands};
use fsot::targets::{Density, Inks, Picture};
use fsot::{Config, ConfigError, Extent, Objective, Optimizer, Site};

use crate::{TILE, in_time, term};

/// A picture of one red pixel.
fn inks() -> Inks {
    Inks::from_picture(&Picture::new(1, 1, vec![[1.0, 0.0, 0.0, 1.0]]).unwrap()).unwrap()
}

#[test]
fn absurd_sizes_are_refused_before_anything_is_made() {
    let refused = |config: Config| Optimizer::new(config).unwrap_err().to_string();
    for words in [
        refused(Config::classes(&[usize::MAX], 2, &LabelSubsets::EachAndAll)),
        refused(Config::classes(&[usize::MAX; 3], 2, &LabelSubsets::Every)),
        refused(Config::classes(&[16], usize::MAX, &LabelSubsets::Every)),
        refused(Config::progressive(16, usize::MAX, PrefixLengths::PowersOfTwo)),
        refused(Config::progressive(usize::MAX, usize::MAX, PrefixLengths::Every)),
        refused(Config::point_set(usize::MAX, 2, vec![])),
        refused(Config::stippling(usize::MAX, Density::new(1, 1, vec![1.0]).unwrap())),
        refused(Config::color_stippling(usize::MAX, &inks())),
        refused(Config::new(Extent::animation(usize::MAX, usize::MAX, usize::MAX).with_spp(usize::MAX), 2)),
    ] {
        assert!(words.contains(": "), "{words}");
    }
}

#[test]
fn the_bound_takes_no_more_slices_than_it_can() {
    in_time(20, || {
        let config = Config::new(TILE, 2);
        let table = Optimizer::new(config.clone()).unwrap().into_table();
        let error = Bound::measure(&table, &Objective::new(&config).unwrap(), 0, usize::MAX).unwrap_err();
        assert!(error.to_string().contains(": give"), "{error}");
    });
}

#[test]
fn integrands_of_many_dimensions_are_drawn_or_refused() {
    for dims in [64, 65, 1000, usize::MAX] {
        in_time(20, move || match Integrands::random(dims, 4, 0) {
            Ok(integrands) => assert_eq!(integrands.iter().count(), 16),
            Err(error) => assert!(error.to_string().contains(": "), "{error}"),
        });
    }
    assert!(Integrands::random(2, usize::MAX, 0).is_err());
}

#[test]
fn a_demand_for_a_dimension_without_end_is_refused() {
    for dimension in [64, usize::MAX] {
        let demand = Demand::new([1, 8, 8], vec![true; 64], vec![vec![0, dimension]]);
        let error = demand.and_then(|demand| {
            assert!(demand.dims() > 64);
            Optimizer::for_demand(Config::new(TILE, 2), &demand)
        });
        assert!(matches!(error.unwrap_err(), ConfigError::DemandGroup { group: 0, .. }));
    }
}

#[test]
fn extents_answer_whatever_they_are() {
    let empty = Extent { frames: 0, height: 0, width: 0, spp: 0 };
    assert_eq!(empty.site(5), Site { frame: 5, y: 0, x: 0 });
    let origin = Site { frame: 0, y: 0, x: 0 };
    assert_eq!(empty.wrapped(origin, (1, -1, i64::MIN)), origin);
    let endless = Extent { frames: usize::MAX, height: usize::MAX, width: usize::MAX, spp: usize::MAX };
    assert_eq!((endless.sites(), endless.samples()), (usize::MAX, usize::MAX));
    let at = Site { frame: usize::MAX, y: usize::MAX, x: 3 };
    _ = (endless.site_index(at), endless.wrapped(at, (i64::MAX, i64::MIN, 1)));
    assert_eq!(TILE.wrapped(at, (i64::MAX, i64::MIN, 1)), Site { frame: 0, y: 7, x: 4 });
}

#[test]
fn slices_of_any_step_are_drawn() {
    in_time(20, || {
        let objective = Objective::new(&Config::new(TILE, 2)).unwrap();
        let usual = objective.draw(1, 5, Role::Descend).len();
        for step in [u64::MAX, u64::MAX - 1, 1 << 63, 1 << 60, 1 << 53] {
            let drawn = objective.draw(1, step, Role::Descend).len();
            assert!(drawn.abs_diff(usual) <= 16, "step {step}: {drawn} slices instead of {usual}");
        }
    });
}

/// A family that says it has more classes than anybody can ask for.
#[derive(Debug)]
struct Endless;

impl ClassFamily for Endless {
    fn name(&self) -> &str {
        "endless"
    }
    fn members(&self, _: &Extent) -> usize {
        usize::MAX
    }
    fn member(&self, _: &Extent, _: usize) -> ClassSamples {
        ClassSamples { samples: vec![(0, 1.0)], weight: 1.0 }
    }
}

#[test]
fn classes_without_end_are_refused() {
    in_time(20, || {
        let terms = vec![term(Classes::custom(Endless), Role::Descend, 1.0)];
        let error = Optimizer::new(Config::point_set(16, 2, terms)).unwrap_err().to_string();
        assert!(error.contains("the number of the caller's classes is 1.84467e19: give"), "{error}");
    });
}
