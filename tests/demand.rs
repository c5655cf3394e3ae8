//! Only what is demanded is optimised: nothing else moves, nothing demanded is worse for it, and the work
//! shrinks with the demand.

use fsot::classes::Demand;
use fsot::config::{Domain, GroupError, Role, Work};
use fsot::{Config, ConfigError, Extent, Objective, Optimizer, SampleTable, Site, Until, metrics};

const EXTENT: Extent = Extent { frames: 2, height: 24, width: 40, spp: 2 };

fn run(mut optimizer: Optimizer, slices: u64) -> Optimizer {
    optimizer.run(Until::SlicesPerClass(slices)).unwrap();
    optimizer
}

/// Pixels inside a disc, about a tenth of the frame.
fn disc(extent: Extent, groups: Vec<Vec<usize>>) -> Demand {
    let pixels = (0..extent.sites()).map(|index| {
        let Site { y, x, .. } = extent.site(index);
        let [dy, dx] = [y as f64 - extent.height as f64 / 2.0, x as f64 - extent.width as f64 / 2.0];
        dy * dy + dx * dx <= 0.1 * (extent.height * extent.width) as f64 / std::f64::consts::PI
    });
    Demand::new([extent.frames, extent.height, extent.width], pixels.collect(), groups).unwrap()
}

#[test]
fn coordinates_that_are_not_demanded_keep_their_bits() {
    for domain in [Domain::Interval, Domain::Torus] {
        let mut config = Config::new(EXTENT, 5);
        config.domains = vec![domain; 5];
        let demand = disc(EXTENT, vec![vec![0, 1], vec![4]]);
        let before = SampleTable::white_noise(EXTENT, 5, config.seed).unwrap();
        let after = run(Optimizer::for_demand(config, &demand).unwrap(), 48).into_table();
        let mut moved = 0;
        for index in 0..EXTENT.sites() {
            let site = EXTENT.site(index);
            for sample in 0..EXTENT.spp {
                for dim in 0..5 {
                    let [old, new] = [&before, &after].map(|table| table.sample(site, sample)[dim]);
                    let demanded = demand.wants(site) && [0, 1, 4].contains(&dim);
                    assert!(demanded || old.to_bits() == new.to_bits(), "{site:?} sample {sample} dim {dim}");
                    moved += usize::from(old != new);
                }
            }
        }
        // A sample that is moved by hundreds of random slices does not come back to the same bits.
        assert!(moved as f64 > 0.99 * (demand.count() * EXTENT.spp * 3) as f64, "{moved} moved");
    }
}

/// The path for partial demands pads its sorting networks and draws from lists; with everything demanded it
/// must still do what the direct path does.
#[test]
fn a_demand_for_everything_changes_nothing() {
    for dims in [2, 4] {
        let config = Config::new(EXTENT, dims);
        let pixels = vec![true; EXTENT.sites()];
        let demand = Demand::new([2, 24, 40], pixels, vec![(0..dims).collect()]).unwrap();
        let direct = run(Optimizer::new(config.clone()).unwrap(), 32).into_table();
        let demanded = run(Optimizer::for_demand(config, &demand).unwrap(), 32).into_table();
        assert_eq!(direct, demanded);
    }
}

/// Slices draw a tenth of the classes' samples; only classes near the disc are visited at all.
#[test]
fn the_work_shrinks_with_the_demand() {
    let extent = Extent { frames: 1, height: 64, width: 64, spp: 1 };
    let config = Config::new(extent, 2);
    let demand = disc(extent, vec![vec![0, 1]]);
    let whole = Objective::new(&config).unwrap();
    let part = Objective::for_demand(&config, &demand).unwrap();
    let near = |member: usize| {
        let Site { y, x, .. } = extent.site(member);
        // Radius of the disc, 11.4 pixels, and of the kernel, 5.4.
        (y as f64 - 32.0).hypot(x as f64 - 32.0) < 11.5 + 5.5
    };
    let count = |objective: &Objective| {
        let slices: Vec<_> = (0..16).flat_map(|step| objective.draw(3, step, Role::Descend)).collect();
        (slices.len() as f64, slices.iter().all(|slice| near(slice.member)))
    };
    let ((all, all_near), (some, some_near)) = (count(&whole), count(&part));
    assert!(!all_near && some_near);
    // Discs of radius 17 and a square of side 64.
    assert!(some / all < 0.24, "{}", some / all);
}

/// Draws whose level selects no demanded sample are left out, and one dimension has a slice where two have
/// sixteen.
#[test]
fn slices_that_say_nothing_are_not_drawn() {
    let extent = Extent { frames: 1, height: 64, width: 64, spp: 1 };
    let config = Config::new(extent, 2);
    let noise = SampleTable::white_noise(extent, 1, 5).unwrap();
    let some: Vec<bool> = noise.values().iter().map(|&value| value < 0.01).collect();
    let count = |objective: Objective| {
        (0..16).map(|step| objective.draw(3, step, Role::Descend).len()).sum::<usize>() as f64
    };
    let of = |pixels, groups| {
        let demand = Demand::new([1, 64, 64], pixels, groups).unwrap();
        count(Objective::for_demand(&config, &demand).unwrap())
    };
    let all = count(Objective::new(&config).unwrap());
    // A pixel in a hundred, and classes of 14 in the mean: seven of eight levels lie above what is demanded.
    let scattered = of(some, vec![vec![0, 1]]) / all;
    assert!((0.05..0.2).contains(&scattered), "{scattered}");
    let one = of(vec![true; 4096], vec![vec![1]]) / all;
    assert!((one - 1.0 / 16.0).abs() < 0.005, "{one}");
}

/// Samples that are not demanded no longer take part, so the demanded ones can only gain.
#[test]
fn demanded_pixels_are_as_good_as_in_a_full_run() {
    let extent = Extent { frames: 1, height: 64, width: 64, spp: 1 };
    let config = Config::new(extent, 2);
    let demand = disc(extent, vec![vec![0, 1]]);
    let full = run(Optimizer::new(config.clone()).unwrap(), 256).into_table();
    let part = run(Optimizer::for_demand(config, &demand).unwrap(), 256);
    let bound = |table| metrics::Bound::measure(table, part.objective(), 1, 16_384).unwrap().terms[0];
    let (of_full, of_part) = (bound(&full), bound(&part.table()));
    assert!(of_part.ratio_to_white_noise < of_full.ratio_to_white_noise, "{of_part:?} {of_full:?}");
    assert!(of_part.ratio_to_white_noise < 0.70, "{of_part:?}");
}

#[test]
fn a_larger_image_folds_onto_the_tile() {
    let tile = Extent { frames: 1, height: 16, width: 16, spp: 1 };
    let mut pixels = vec![false; 48 * 40];
    pixels[17 * 40 + 21] = true; // reads the tile at (1, 5)
    let demand = Demand::new([1, 48, 40], pixels, vec![vec![0, 1]]).unwrap();
    let before = SampleTable::white_noise(tile, 2, 0).unwrap();
    let after = run(Optimizer::for_demand(Config::new(tile, 2), &demand).unwrap(), 64).into_table();
    for index in 0..tile.sites() {
        let site = tile.site(index);
        assert_eq!(before.sample(site, 0) != after.sample(site, 0), (site.y, site.x) == (1, 5));
    }
}

#[test]
fn demands_that_cannot_be_met_are_named() {
    let refused = |pixel: bool, groups: Vec<Vec<usize>>| {
        let demand = Demand::new([1, 1, 1], vec![pixel], groups).unwrap();
        Optimizer::for_demand(Config::new(EXTENT, 2), &demand).err().unwrap()
    };
    assert_eq!(refused(false, vec![vec![0, 1]]), ConfigError::NoDemand);
    assert_eq!(refused(true, vec![]), ConfigError::NoDemand);
    let problem = GroupError::NoSuchDimension { dimension: 2, dims: 2 };
    let missing = ConfigError::DemandGroup { group: 1, problem };
    assert_eq!(refused(true, vec![vec![0], vec![1, 2]]), missing);
}

/// Dimensions of an animation that nobody asked for keep their bits in any run: it does not begin with a
/// frame that is made for all of them.
#[test]
fn an_animation_keeps_the_dimensions_that_are_not_demanded() {
    let extent = Extent::animation(4, 32, 32);
    for (dims, group) in [(2, vec![0]), (5, vec![0, 1, 2, 4])] {
        let config = Config::new(extent, dims);
        let before = SampleTable::white_noise(extent, dims, config.seed).unwrap();
        let demand = Demand::new([4, 32, 32], vec![true; 4096], vec![group.clone()]).unwrap();
        for until in [Until::Sweeps(2), Until::Work(Work { frame_sweeps: 1, sweeps: 1, ..Work::default() })] {
            let mut optimizer = Optimizer::for_demand(config.clone(), &demand).unwrap();
            optimizer.run(until).unwrap();
            let after = optimizer.into_table();
            for (index, (old, new)) in before.values().iter().zip(after.values()).enumerate() {
                assert_eq!(old.to_bits() == new.to_bits(), !group.contains(&(index % dims)), "{index}");
            }
        }
    }
}

/// Some frames of an animation, also across its end: the others keep their bits, and these get better.
#[test]
fn frames_are_swept_by_themselves() {
    let extent = Extent::animation(16, 16, 16);
    for wanted in [0..1, 3..5, 14..19] {
        let is_wanted = |site: usize| wanted.contains(&(site / 256)) || wanted.contains(&(site / 256 + 16));
        let pixels: Vec<bool> = (0..extent.sites()).map(is_wanted).collect();
        let demand = Demand::new([16, 16, 16], pixels.clone(), vec![vec![0, 1]]).unwrap();
        let config = Config::new(extent, 2);
        let before = SampleTable::white_noise(extent, 2, config.seed).unwrap();
        let mut optimizer = Optimizer::for_demand(config, &demand).unwrap();
        let value = |optimizer: &Optimizer| {
            let points: Vec<f64> = optimizer.points().iter().map(|&value| value.into()).collect();
            optimizer.objective().cramer(&points).unwrap().value
        };
        let start = value(&optimizer);
        optimizer.run(Until::Sweeps(10)).unwrap();
        let end = value(&optimizer);
        assert!(end < 0.5 * start, "{wanted:?}: {start} {end}");
        let after = optimizer.into_table();
        for (index, (old, new)) in before.values().iter().zip(after.values()).enumerate() {
            assert!(pixels[index / 2] || old == new, "{wanted:?} {index}");
        }
    }
}
