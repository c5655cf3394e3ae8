//! Configurations that are written and read again.

use fsot::Config;
use fsot::classes::Classes;
use fsot::targets::Target;

use crate::draw::Draw;

/// Code of the caller's own, which a file only names.
fn is_code(config: &Config) -> bool {
    let code = |term: &fsot::config::Term| {
        matches!(term.classes, Classes::Custom(_)) || matches!(term.target, Target::Custom(_))
    };
    config.terms.iter().any(code)
}

/// To the last bit, by both formats, and by the JSON value that metadata hold.
#[test]
fn configurations_come_back_whole() {
    let mut compared = 0;
    for index in 0..3000 {
        let random = fsot::random::generator(0, 99_u64, 0, index);
        let config = Draw { random, odd: 0.0 }.config();
        if is_code(&config) {
            continue;
        }
        let text = serde_json::to_string(&config).unwrap();
        assert_eq!(serde_json::from_str::<Config>(&text).unwrap(), config, "{text}");
        let value = serde_json::to_value(&config).unwrap();
        assert_eq!(serde_json::from_value::<Config>(value.clone()).unwrap(), config, "{text}");
        let text = serde_json::to_string_pretty(&value).unwrap();
        assert_eq!(serde_json::from_str::<Config>(&text).unwrap(), config, "{text}");
        let text = toml::to_string(&config).unwrap();
        assert_eq!(toml::from_str::<Config>(&text).unwrap(), config, "{text}");
        compared += 1;
    }
    assert!(compared > 2000, "{compared}");
}

/// What is passed over would make another table.
#[test]
fn what_is_not_known_is_refused() {
    let config = Config::new(fsot::Extent::animation(2, 4, 4), 2);
    let whole = serde_json::to_value(&config).unwrap();
    for place in [
        "",
        "/extent",
        "/terms/0",
        "/terms/0/classes/lattice",
        "/terms/0/classes/lattice/kernel",
        "/terms/0/classes/lattice/kernel/spatial/gaussian",
        "/terms/0/classes/lattice/kernel/temporal/perceptual",
        "/slicing",
        "/descent/barycentric",
        "/descent/barycentric/rate",
        "/sweeps",
        "/balance",
    ] {
        let mut value = whole.clone();
        value.pointer_mut(place).unwrap().as_object_mut().unwrap().insert("quux".into(), 1.into());
        let error = serde_json::from_value::<Config>(value).unwrap_err().to_string();
        assert!(error.contains("quux"), "{place}: {error}");
    }
}

/// Files of before these fields were known; what they lack is as it was then.
#[test]
fn older_configurations_are_read() {
    let config = Config::new(fsot::Extent::still(4, 4), 2);
    let whole = serde_json::to_value(&config).unwrap();
    for (place, field, expected) in [
        ("", "companions", "false"),
        ("", "sweeps", "softening: 0.7"),
        ("", "slicing", "directions: 16"),
        ("", "descent", "Barycentric"),
        ("", "balance", "Constant { value: 1.0 }"),
        ("/sweeps", "softening", "softening: 0.0"),
        ("/terms/0", "target", "UniformCube"),
        ("/terms/1", "role", "Descend"),
        ("/terms/1", "weight", "weight: 1.0"),
        ("/terms/0/classes/lattice/kernel", "truncation", "truncation: 0.001"),
        ("/terms/0/classes/lattice/kernel", "temporal", "temporal: None"),
        ("/terms/0/classes/lattice", "form", "LevelSets"),
    ] {
        let mut value = whole.clone();
        assert!(value.pointer_mut(place).unwrap().as_object_mut().unwrap().remove(field).is_some());
        let read: Config = serde_json::from_value(value).unwrap();
        assert!(format!("{read:?}").contains(expected), "{place}/{field}: {read:?}");
    }
    let mut value = whole;
    value["descent"]["barycentric"]["rate"] = serde_json::json!({ "shape": "constant", "first": 0.5 });
    let read: Config = serde_json::from_value(value).unwrap();
    assert_eq!(read.descent.rate().ends(), [0.5, 0.5]);
}
