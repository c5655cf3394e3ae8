//! scratch
use fsot::*;
use std::ops::ControlFlow;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let has = |k: &str| a.iter().position(|x| x == k);
    let get = |k: &str, d: f64| has(k).map_or(d, |i| a[i + 1].parse().unwrap());
    let labels = get("labels", 2.0) as usize;
    let n = get("n", 512.0) as usize;
    let power = get("power", 0.5);
    let subsets = if has("every").is_some() { Subsets::Every } else { Subsets::EachAndAll };
    let slices = get("slices", 2000.0) as u64;
    let dirs = get("dirs", 256.0) as usize;
    let seed = get("seed", 0.0) as u64;
    let rate = Schedule::geometric(get("first", 1.0), get("last", 0.02));
    let go = |mut config: Config| {
        config.seed = seed;
        config.descent = Descent::Barycentric { rate };
        if let Classes::Labelled { subsets, .. } = &mut config.terms[0].classes {
            for s in subsets {
                s.weight = s.weight.powf(2.0 * power);
            }
        }
        let mut opt = Optimizer::new(config).unwrap();
        let r = opt.run(Until::SlicesPerClass(slices), |_| ControlFlow::Continue(())).unwrap();
        println!("{:?} {} steps", r.elapsed, r.steps);
        opt.into_table()
    };
    let w2 = |t: &SampleTable, keep: &dyn Fn(usize) -> bool| {
        let p: Vec<f64> = t
            .values()
            .chunks(2)
            .enumerate()
            .filter(|(i, _)| keep(*i))
            .flat_map(|(_, p)| [p[0] as f64, p[1] as f64])
            .collect();
        (p.len() / 2, metrics::sliced_w2(&p, 2, &Target::UniformCube, dirs).unwrap())
    };
    let t = go(Config::classes(&vec![n; labels], 2, &subsets));
    let mut alone = std::collections::BTreeMap::new();
    for mask in 1..1usize << labels {
        if mask.count_ones() as usize > 1
            && mask.count_ones() as usize != labels
            && subsets == Subsets::EachAndAll
        {
            continue;
        }
        let (m, d) = w2(&t, &|i| mask >> (i / n) & 1 == 1);
        let best = *alone.entry(m).or_insert_with(|| {
            let t = go(Config::classes(&[m], 2, &Subsets::Every));
            w2(&t, &|_| true).1
        });
        println!("{mask:07b} {m} {d:.6} alone {best:.6} ratio {:.3}", d / best);
    }
}
