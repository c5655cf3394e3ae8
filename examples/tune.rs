//! tune
use fsot::metrics::*;
use fsot::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let has = |k: &str| a.iter().position(|x| x == k);
    let get = |k: &str, d: f64| has(k).map_or(d, |i| a[i + 1].parse().unwrap());
    let (frames, spp, size) =
        (get("frames", 1.0) as usize, get("spp", 1.0) as usize, get("size", 64.0) as usize);
    let extent = Extent { frames, height: size, width: size, spp };
    let dims = get("dims", 2.0) as usize;
    let mut config = Config::new(extent, dims);
    config.seed = get("seed", 0.0) as u64;
    if get("nogroup", 0.0) > 0.0 {
        config.terms.retain(|t| t.dims.len() == 2);
    }
    let last = get("last", 0.17);
    config.sweeps = Sweeps {
        rate: Schedule::geometric(get("first", 2.2), last),
        polish: Schedule::geometric(get("polish", 1.3), last),
        truncation: get("trunc", 0.02),
    };
    config.descent =
        Descent::Barycentric { rate: Schedule::geometric(get("bfirst", 2.0), get("blast", 0.03)) };
    if get("adam", 0.0) > 0.0 {
        config.descent = Descent::adam();
    }
    let Classes::Lattice { kernel, .. } = config.terms[0].classes.clone() else { panic!() };
    let until = match has("seconds") {
        Some(_) => Until::Seconds(get("seconds", 1.0)),
        None => Until::Work(Work {
            slices_per_class: get("slices", 0.0) as u64,
            sweeps: get("sweeps", 40.0) as u64,
        }),
    };
    let mut opt = Optimizer::new(config).unwrap();
    let mut split = 0.0;
    let report = opt
        .run(until, |s| {
            if s.rate >= get("first", 2.2) && split == 0.0 {
                split = s.elapsed.as_secs_f64();
            }
            std::ops::ControlFlow::Continue(())
        })
        .unwrap();
    let table = opt.table();
    print!("{:?} time {:.4} (slices {split:.3})", report.work, report.elapsed.as_secs_f64());
    let n = get("ints", 256.0) as usize;
    if n > 0 {
        let ints = Integrands::random(2, n, 0).unwrap();
        let fe = filtered_error(&table, &[0, 1], &kernel, &ints).unwrap();
        let bias = Bias::measure(&table, &[0, 1], &ints).unwrap();
        print!(" filtered {:.4} [", fe.spatio_temporal.mean.mean);
        for f in Family::ALL {
            print!("{:.3} ", fe.spatio_temporal.family(f).mean);
        }
        print!("] bias {:.3} frame {:.3}", bias.table.mean.mean, bias.frame.mean.mean);
    }
    if get("bound", 8192.0) > 0.0 {
        print!(
            " bound {:.4}",
            bound(opt.objective(), &table, 0, get("bound", 8192.0) as usize)
                .unwrap()
                .total
                .ratio_to_white_noise
        );
    }
    println!();
}
