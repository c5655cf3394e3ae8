//! Steps work in buffers that the first ones have made, and those are few.

use allocation_counter::measure;
use fsot::classes::Demand;
use fsot::config::{Role, Work};
use fsot::kernel::Kernel;
#[cfg(feature = "image")]
use fsot::targets::{Density, Inks, PictureOptions, Tone};
use fsot::{Config, Extent, Objective, Optimizer, SampleTable, Until};

/// Allocations of 64 steps and 4 sweeps, after 64 times as many have grown the buffers to the largest
/// subsets.
fn allocations(extent: Extent) -> u64 {
    let mut optimizer = Optimizer::new(Config::new(extent, 2)).unwrap();
    let mut work = || {
        (0..64).for_each(|_| {
            _ = optimizer.step(0.1, 1.0).unwrap();
        });
        (0..4).for_each(|_| _ = optimizer.sweep(0.1, 1.0).unwrap());
    };
    one_thread().install(|| {
        (0..64).for_each(|_| work());
        measure(work).count_total
    })
}

#[test]
fn nothing_is_allocated() {
    for extent in [
        Extent { frames: 1, height: 32, width: 32, spp: 1 },
        Extent { frames: 1, height: 16, width: 16, spp: 4 },
        Extent { frames: 6, height: 16, width: 16, spp: 1 },
    ] {
        assert_eq!(allocations(extent), 0, "{extent:?}");
    }
}

/// The counter is that of its thread: all work happens on this one.
fn one_thread() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap()
}

#[test]
fn the_peak_of_a_run_is_a_small_multiple_of_the_table() {
    let extent = Extent { frames: 64, height: 64, width: 64, spp: 1 };
    let table = (extent.samples() * 2 * size_of::<f32>()) as f64;
    for (slices_per_class, sweeps, most) in [(2, 0, 10.5), (0, 1, 6.5), (2, 1, 10.5)] {
        let peak = one_thread().install(|| {
            measure(|| {
                let mut optimizer = Optimizer::new(Config::new(extent, 2)).unwrap();
                let work = Until::Work(Work { slices_per_class, sweeps, ..Work::default() });
                optimizer.run(work).unwrap();
            })
            .bytes_max
        });
        // The table, and either the sweep's copy (3) and ranks, or the pulls (2), the buffers of the
        // whole-table slice (2), the orders of visits (0.5 for each of four filters), the draws of a step and
        // what is in flight (2, less of a larger table).
        let multiple = peak as f64 / table;
        assert!(multiple < most, "{slices_per_class} slices, {sweeps} sweeps: {multiple:.2} times the table");
    }
}

/// The law that the crate page states: so many times the table, an order of visits per term, and in one
/// dimension the draws of a step.
#[test]
fn memory_follows_its_law() {
    let long = Extent { frames: 64, height: 64, width: 64, spp: 1 };
    let [still, many] =
        [(640, 1), (192, 12)].map(|(side, spp)| Extent { frames: 1, height: side, width: side, spp });
    for (extent, dims, kernels) in
        [(long, 1, 1), (still, 1, 1), (still, 1, 8), (many, 1, 8), (still, 2, 8), (long, 4, 8), (many, 3, 2)]
    {
        let kernels: Vec<Kernel> = (0..kernels).map(|k| Kernel::gaussian(1.0 + 0.3 * f64::from(k))).collect();
        let mut config = Config::new(extent, dims);
        if kernels.len() > 1 {
            config = config.with_kernels(&kernels);
        }
        let objective = Objective::new(&config).unwrap();
        let terms = objective.terms().filter(|term| term.role == Role::Descend).count();
        // Buffers of the thread, tabulated laws.
        let fixed = 4e6;
        let table = (extent.samples() * dims * size_of::<f32>()) as f64;
        let orders = (4 * extent.sites() * terms) as f64;
        let draws = if dims == 1 { (64 * extent.sites()) as f64 } else { 0.0 };
        for (slices_per_class, sweeps) in [(2, 0), (0, 1)] {
            let peak = one_thread().install(|| {
                measure(|| {
                    let mut optimizer = Optimizer::new(config.clone()).unwrap();
                    let work = Until::Work(Work { slices_per_class, sweeps, ..Work::default() });
                    optimizer.run(work).unwrap();
                })
                .bytes_max
            });
            let law = match sweeps {
                0 => 11.0 * table + orders + draws + fixed,
                _ => 9.0 * table + fixed,
            };
            let case = format!("{extent:?}, {dims} dimensions, {terms} terms, {sweeps} sweeps");
            let [of_table, of_law] = [table, law].map(|bytes| peak as f64 / bytes);
            println!("{case}: {of_table:.1} times the table, {of_law:.2} of the law");
            assert!(of_law < 1.0, "{case}: {of_table:.1} times the table, {of_law:.2} of the law");
        }
    }
}

/// What a plan says of memory is near what a run holds, with some room: a dry run is for those who wonder.
#[test]
fn plans_foresee_memory() {
    let still = |side| Extent { frames: 1, height: side, width: side, spp: 1 };
    let long = Extent { frames: 32, height: 64, width: 64, spp: 1 };
    let mut far = Vec::new();
    for (extent, dims, slices_per_class, sweeps) in [
        (still(640), 2, 2, 0),
        (still(640), 2, 0, 1),
        (still(512), 1, 2, 1),
        (still(64), 2, 4, 1),
        (still(256).with_spp(4), 4, 1, 1),
        (long, 2, 2, 0),
        (long, 2, 0, 1),
    ] {
        let until = Until::Work(Work { slices_per_class, sweeps, ..Work::default() });
        let (planned, peak) = one_thread().install(|| {
            let planned = Optimizer::new(Config::new(extent, dims)).unwrap().plan(until).unwrap().bytes;
            let run = || _ = Optimizer::new(Config::new(extent, dims)).unwrap().run(until).unwrap();
            (planned, measure(run).bytes_max)
        });
        let case = format!("{extent:?}, {dims} dimensions, {slices_per_class} slices, {sweeps} sweeps");
        let ratio = planned as f64 / peak as f64;
        println!("{case}: {ratio:.2} of {peak} bytes");
        // Buffers that move while they grow are there twice for a moment; tabulated laws and what a thread
        // needs are guessed.
        if !(0.78 * peak as f64..1.25 * peak as f64 + 3e6).contains(&(planned as f64)) {
            far.push(format!("{case}: {ratio:.2} of {peak} bytes"));
        }
    }
    assert!(far.is_empty(), "{}", far.join("\n"));
}

/// Lists of the neighbours of scattered samples take sixteen tables at most, and tiles are made instead where
/// they would take more (the last of these).
#[test]
fn lists_of_neighbours_are_bounded() {
    let extent = Extent { frames: 4, height: 160, width: 160, spp: 1 };
    let table = (extent.samples() * 2 * size_of::<f32>()) as f64;
    let noise = SampleTable::white_noise(extent, 1, 5).unwrap();
    for share in [0.02, 0.1, 0.13, 0.3] {
        let pixels = noise.values().iter().map(|&value| value < share).collect();
        let demand = Demand::new([4, 160, 160], pixels, vec![vec![0, 1]]).unwrap();
        let peak = one_thread().install(|| {
            measure(|| {
                let mut optimizer = Optimizer::for_demand(Config::new(extent, 2), &demand).unwrap();
                optimizer.run(Until::Sweeps(1)).unwrap();
            })
            .bytes_max
        });
        let multiple = (peak as f64 - 4e6) / table;
        println!("{share}: {multiple:.1} times the table and 4 MB");
        assert!(multiple < 9.0 + 16.0, "{share}: {multiple:.1} times the table and 4 MB");
    }
}

/// Peaks of opening a picture of 8.4 megapixels, in bytes per pixel.
#[cfg(feature = "image")]
#[test]
fn a_large_picture_is_opened_in_few_bytes_a_pixel() {
    const SIZE: [u32; 2] = [3500, 2400];
    let folder = tempfile::tempdir().unwrap();
    let [png, deep, exr] = ["8.png", "16.png", "32.exr"].map(|name| folder.path().join(name));
    let level = |x: u32, y: u32| (x * 7 + y * 3 + x * y / 64) % 256;
    let light = |x: u32, y: u32| image::Rgb([level(x, y), level(y, x), level(x, x)]);
    let bytes = |x, y| image::Rgb(light(x, y).0.map(|level| level as u8));
    image::RgbImage::from_fn(SIZE[0], SIZE[1], bytes).save(&png).unwrap();
    let words = |x, y| image::Rgb(light(x, y).0.map(|level| 257 * level as u16));
    image::ImageBuffer::from_fn(SIZE[0], SIZE[1], words).save(&deep).unwrap();
    let floats = |x, y| image::Rgb(light(x, y).0.map(|level| level as f32 / 255.0));
    image::Rgb32FImage::from_fn(SIZE[0], SIZE[1], floats).save(&exr).unwrap();

    let whole = PictureOptions { most_pixels: None, ..PictureOptions::default() };
    for path in [&png, &deep, &exr] {
        let peak = |open: &dyn Fn()| measure(open).bytes_max as f64 / f64::from(SIZE[0] * SIZE[1]);
        let averaged = peak(&|| _ = Density::open(path, Tone::Dark).unwrap());
        let full = peak(&|| _ = Density::open_with(path, Tone::Dark, &whole).unwrap());
        let inks = peak(&|| _ = Inks::open(path).unwrap());
        let full_inks = peak(&|| _ = Inks::open_with(path, &whole).unwrap());
        println!("{averaged:.2} {full:.2} {inks:.2} {full_inks:.2} {}", path.display());
        // Half of the pixels are kept, or all, at 4 bytes; or at 16 for four inks. The rest are rows.
        assert!(averaged < 2.5 && full < 4.5 && inks < 8.5 && full_inks < 16.5, "{}", path.display());
    }
}

/// A picture of 16 megapixels for 1,000 points: 4 bytes a pixel are the picture itself.
#[test]
fn planning_a_large_picture_takes_less_than_twice_its_memory() {
    use fsot::targets::Density;

    let side = 4000;
    let values = (0..side * side).map(|i| ((i % side) * (i / side) % 256) as f32).collect();
    let density = Density::new(side, side, values).unwrap();
    let config = Config::stippling(1000, density);
    let peak = one_thread().install(|| measure(|| drop(Optimizer::new(config.clone()).unwrap())).bytes_max);
    let per_pixel = peak as f64 / (side * side) as f64;
    assert!(per_pixel < 4.0, "{per_pixel:.2} bytes a pixel beside the picture");
}
