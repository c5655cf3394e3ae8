//! A million samples in one class.

use fsot::classes::Classes;
use fsot::config::{Role, Term};
use fsot::optimizer::SliceStep;
use fsot::targets::Target;
use fsot::{Config, Optimizer};

use crate::{assert_inside, square};

#[test]
fn a_million_samples_in_one_class() {
    let extent = square(1000, 1);
    let mut config = Config::new(extent, 2);
    config.terms = vec![Term {
        classes: Classes::WholeTable,
        target: Target::UniformCube,
        dims: vec![0, 1],
        weight: 1.0,
        role: Role::Descend,
    }];
    config.slicing.batch_slices = Some(4);
    let mut optimizer = Optimizer::new(config).unwrap();
    // Slices of a step that is not taken.
    let slices = optimizer.objective().draw(99, 0, Role::Descend);
    let value = |optimizer: &Optimizer| {
        let points: Vec<f64> = optimizer.table().values().iter().map(|&value| value.into()).collect();
        optimizer.objective().value_and_gradient(&points, &slices).unwrap().value
    };
    let before = value(&optimizer);
    for step in 0..12 {
        let SliceStep { displacement, slices, .. } = optimizer.step(0.8_f64.powi(step), 1.0).unwrap();
        assert!(displacement.is_finite() && slices == 4);
    }
    let after = value(&optimizer);
    assert_inside(optimizer.table().values(), "a million samples");
    println!("10⁶ samples in one class: mean W2 {:.1e}, from {:.1e}", after.sqrt(), before.sqrt());
    // Random points are 0.35 / √n away; 48 slices remove two thirds of that along other slices.
    assert!((1e-4..1e-3).contains(&before.sqrt()), "{before}");
    assert!(after < 0.2 * before, "{after} {before}");
}
