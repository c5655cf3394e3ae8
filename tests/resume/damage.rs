//! Checkpoints that were changed, or are another optimiser's.

use fsot::classes::Demand;
use fsot::config::Descent;
use fsot::optimizer::{Checkpoint, CheckpointError};
use fsot::targets::Density;
use fsot::{Config, Extent, Optimizer};

fn optimizer(config: &Config) -> Optimizer {
    let mut optimizer = Optimizer::new(config.clone()).unwrap();
    optimizer.step(1.0, 1.0).unwrap();
    optimizer
}

fn bytes(checkpoint: &Checkpoint) -> Vec<u8> {
    let mut bytes = Vec::new();
    checkpoint.write(&mut bytes).unwrap();
    bytes
}

/// Each byte is looked at, and each length.
#[test]
fn no_change_goes_unseen() {
    let config = Config::new(Extent::still(4, 4), 1).with_descent(Descent::sgd());
    let good = bytes(&optimizer(&config).checkpoint());
    for place in 0..good.len() {
        let mut bad = good.clone();
        bad[place] ^= 1 << (place % 8);
        let error = Checkpoint::read(&mut bad.as_slice()).unwrap_err();
        let is_told = matches!(error, CheckpointError::Damaged { .. } | CheckpointError::Foreign { .. });
        assert!(is_told, "byte {place}: {error}");
        assert!(Checkpoint::read(&mut &good[..place]).is_err(), "cut at {place}");
    }
}

/// A header may promise anything: nothing is allocated for it.
#[test]
fn promises_take_no_memory() {
    let mut bytes = b"fsot checkpoint 1\n".to_vec();
    bytes.extend(u64::MAX.to_le_bytes());
    let error = Checkpoint::read(&mut bytes.as_slice()).unwrap_err();
    assert!(error.to_string().contains("its header is too long"), "{error}");
    let later = b"fsot checkpoint 2\n";
    let error = Checkpoint::read(&mut later.as_slice()).unwrap_err();
    assert!(error.to_string().contains("fsot checkpoint 2\\n"), "{error}");
}

#[test]
fn another_configuration_or_demand_is_refused() {
    let config = Config::new(Extent::still(8, 8), 2);
    let checkpoint = optimizer(&config).checkpoint();
    let half = Demand::new([1, 8, 8], (0..64).map(|pixel| pixel < 32).collect(), vec![vec![0, 1]]).unwrap();
    let one = Demand::new([1, 8, 8], vec![true; 64], vec![vec![1]]).unwrap();
    let others = [
        Optimizer::new(config.clone().with_seed(1)).unwrap(),
        Optimizer::new(config.clone().with_descent(Descent::adam())).unwrap(),
        Optimizer::new(Config::new(Extent::still(8, 9), 2)).unwrap(),
        Optimizer::for_demand(config.clone(), &half).unwrap(),
        Optimizer::for_demand(config, &one).unwrap(),
    ];
    for mut other in others {
        let before = other.points().to_vec();
        let error = other.resume(checkpoint.clone()).unwrap_err();
        assert!(matches!(error, CheckpointError::OtherObjective { .. }), "{error}");
        assert_eq!(other.points(), before);
    }
}

#[test]
fn long_configurations_are_known_by_their_hash() {
    let side = 2048;
    let picture = |shift: usize| {
        let values = (0..side * side).map(|pixel| ((pixel + shift) % 97) as f32 / 7.0).collect();
        Config::stippling(100, Density::new(side, side, values).unwrap())
    };
    let checkpoint = optimizer(&picture(0)).checkpoint();
    assert!(bytes(&checkpoint).len() < 4096);
    let error = checkpoint.config().unwrap_err();
    assert!(matches!(error, CheckpointError::NoConfig { .. }), "{error}");
    assert!(optimizer(&picture(1)).resume(checkpoint.clone()).is_err());
    optimizer(&picture(0)).resume(checkpoint).unwrap();
}

#[test]
fn files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.checkpoint");
    let error = Checkpoint::load(&path).unwrap_err().to_string();
    assert!(error.contains("run.checkpoint") && error.contains("cannot read"), "{error}");
    let checkpoint = optimizer(&Config::new(Extent::still(4, 4), 2)).checkpoint();
    checkpoint.save(&path).unwrap();
    assert_eq!(Checkpoint::load(&path).unwrap().table(), checkpoint.table());
    let error = checkpoint.save(folder.path()).unwrap_err().to_string();
    assert!(error.contains("cannot write") && error.contains("it is a directory"), "{error}");
}
