use super::*;
#[test]
fn measure() {
    let text = std::fs::read_to_string("/tmp/tw/cases.txt").unwrap();
    let mut worst: std::collections::BTreeMap<String, [f64; 6]> = Default::default();
    for line in text.lines() {
        let (left, right) = line.split_once('|').unwrap();
        let mut it = left.split_whitespace();
        let name = it.next().unwrap().to_string();
        let _d = it.next();
        let w: Vec<f64> = it.map(|v| v.parse().unwrap()).collect();
        let r: Vec<f64> = right.split_whitespace().map(|v| v.parse().unwrap()).collect();
        let (x, u, j) = (r[0], r[1], r[2]);
        let p = Target::UniformCube.project(&w);
        let l = p.support().1;
        let e = worst.entry(format!("{:02} {name}", w.len())).or_insert([0.0; 6]);
        e[0] = e[0].max((p.cdf(x) - u).abs());
        if u > 1e-6 && u < 1.0 - 1e-5 { e[1] = e[1].max((p.quantile(u) - x).abs() / l); }
        else if u > 1e-15 && u < 0.5 { e[2] = e[2].max((p.quantile(u) - x).abs() / l); }
        e[3] = e[3].max((p.quantile_integral(u) - j).abs() / l);
        if u > 1e-6 && u < 0.5 {
        e[4] = e[4].max((p.cell_mean(0.0, u) - j/u).abs() / l);}
    }
    for (k, e) in worst { println!("{k:14} cdf {:.1e} q {:.1e} qtail {:.1e} int {:.1e} mean(0,u) {:.1e}", e[0], e[1], e[2], e[3], e[4]); }
}
#[test]
fn speed() {
    for d in 1..=16 {
        for (name, w) in [("lin", (0..d).map(|i| 1.0 + 0.37 * i as f64).collect::<Vec<f64>>()), ("mix", (0..d).map(|i| 0.5f64.powi(i)).collect()),
          ("geo3", (0..d).map(|i| 0.31f64.powi(i)).collect()), ("equal", vec![1.0; d as usize])] {
            let t = std::time::Instant::now();
            for _ in 0..200 { std::hint::black_box(Target::UniformCube.project(std::hint::black_box(&w))); }
            let b = t.elapsed().as_secs_f64() / 200.0 * 1e6;
            let p = Target::UniformCube.project(&w);
            let mut m = vec![0.0; 1024];
            let t = std::time::Instant::now();
            for _ in 0..20 { p.cell_means_into(&mut m); std::hint::black_box(&m); }
            println!("{d} {name}: build {b:.1} us, cell mean {:.0} ns", t.elapsed().as_secs_f64() / 20.0 / 1024.0 * 1e9);
        }
    }
}
