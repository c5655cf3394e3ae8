//! Other people's files: what refuses them says what makes a table of them, and that does.

use std::env;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use fsot::{Extent, SampleTable};
use tempfile::tempdir;

use crate::{command, names, run, texts};

/// A `.npy` file.
fn npy(descr: &str, order: &str, shape: &str, values: impl IntoIterator<Item = Vec<u8>>) -> Vec<u8> {
    let dictionary = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}}}\n");
    let length = (dictionary.len() as u16).to_le_bytes();
    let values = values.into_iter().flatten().collect::<Vec<u8>>();
    [b"\x93NUMPY\x01\x00", &length[..], dictionary.as_bytes(), &values].concat()
}

/// The line as a person types it into a shell.
fn shell(home: &Path, line: &str) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_fsot")).parent().unwrap();
    let path = format!("{}:{}", program.display(), env::var("PATH").unwrap());
    Command::new("sh").args(["-c", line]).current_dir(home).env("PATH", path).output().unwrap()
}

/// Follows the advice of the first refusal, and that alone.
fn followed(name: &str, bytes: &[u8]) -> SampleTable {
    let home = tempdir().unwrap();
    fs::write(home.path().join(name), bytes).unwrap();
    let inspected =
        command(home.path(), "inspect --integrands 2 --bound-slices 64").arg(format!("./{name}")).output();
    let (out, err) = texts(&inspected.unwrap());
    assert!(
        out.is_empty() && err.lines().count() == 1 && err.matches('`').count() == 2,
        "{name}: {out}{err}"
    );
    let advice = err.split('`').nth(1).unwrap();
    let (_, err) = texts(&shell(home.path(), advice));
    assert_eq!(err, "", "{name}: {advice}");
    let made: Vec<String> = names(home.path()).into_iter().filter(|other| other != name).collect();
    assert_eq!(made.len(), 1, "{name}: {made:?}");
    SampleTable::load(home.path().join(&made[0])).unwrap()
}

#[test]
fn advice_leads_to_a_table_in_one_step() {
    let ranks: Vec<u16> = (0..4096).map(|i| (i * 1001 % 4096) as u16).collect();
    let expected: Vec<f32> = ranks.iter().map(|rank| (f32::from(*rank) + 0.5) / 4096.0).collect();
    let transposed: Vec<f32> = (0..4096).map(|i| expected[i % 64 * 64 + i / 64]).collect();
    let little = || ranks.iter().map(|rank| rank.to_le_bytes().to_vec());
    let big = || ranks.iter().map(|rank| rank.to_be_bytes().to_vec());
    let doubles = || expected.iter().map(|value| f64::from(*value).to_le_bytes().to_vec());
    let singles = || expected.iter().map(|value| value.to_le_bytes().to_vec());
    let from_1 = || ranks.iter().map(|rank| (f64::from(*rank) + 1.0).to_le_bytes().to_vec());
    let longs = || ranks.iter().map(|rank| i64::from(*rank).to_be_bytes().to_vec());
    for (name, bytes, expected) in [
        ("u2.npy", npy("'<u2'", "False", "(64, 64)", little()), &expected),
        ("big.npy", npy("'>u2'", "False", "(64L,\n64L)", big()), &expected),
        ("u2 of a list.npy", npy("'<u2'", "False", "(4096, 1)", little()), &expected),
        ("-5.axes'.npy", npy("'<u2'", "False", "(1, 64, 64, 1, 1)", little()), &expected),
        ("longs.npy", npy("'>i8'", "False", "(4096,)", longs()), &expected),
        ("julia.npy", npy("'<u2'", "True", "(64, 64)", little()), &transposed),
        ("matlab.npy", npy("'<f8'", "True", "(64, 64)", from_1()), &transposed),
        ("f8.npy", npy("'<f8'", "False", "(64, 64, 1)", doubles()), &expected),
        ("f4.npy", npy("'<f4'", "False", "(1, 64, 64)", singles()), &expected),
        ("fortran.npy", npy("'<f4'", "True", "(1, 64, 64, 1, 1)", singles()), &transposed),
        (
            "words",
            expected.iter().map(|value| format!("{value}\n")).collect::<String>().into_bytes(),
            &expected,
        ),
        (
            "ranks.dat",
            ranks.iter().map(|rank| format!("{rank}\n")).collect::<String>().into_bytes(),
            &expected,
        ),
    ] {
        let table = followed(name, &bytes);
        assert_eq!(table.shape(), [1, 64, 64, 1, 1], "{name}");
        assert!(table.values() == expected.as_slice(), "{name}");
    }

    // What nobody can know is suggested: levels, and how many frames or rows there are.
    let ten_bits = || (0..4096_u32).map(|i| ((i * i % 1021) as u16).to_le_bytes().to_vec());
    let table = followed("ten_bits.npy", &npy("'<u2'", "False", "(64, 64)", ten_bits()));
    assert!(table.values().iter().enumerate().all(|(i, v)| *v == ((i * i % 1021) as f32 + 0.5) / 1024.0));
    let animation: String = (0..40960).map(|i| format!("0.{i:05} 0.5\n")).collect();
    let table = followed("samples.dat", animation.as_bytes());
    assert_eq!((table.shape(), table.values()[81918]), ([10, 64, 64, 1, 2], 0.40959));
    assert_eq!(followed("points.dat", b"0 3\n9 1000\n5 5\n").shape(), [1, 1, 3, 1, 2]);
    // All in range but for what is rounded to 1, or is 1.
    let ones = [0.0_f32, 0.5, 1.0, 0.25].map(|value| value.to_le_bytes().to_vec());
    let table = followed("ones.npy", &npy("'<f4'", "False", "(1, 2, 2, 1, 1)", ones));
    assert_eq!(table.values(), [0.0, 0.5, 1.0_f32.next_down(), 0.25]);
}

#[test]
fn what_cannot_be_a_table_is_refused_in_words() {
    let home = tempdir().unwrap();
    let zeros = |count: usize| [vec![0; count]];
    for (name, bytes, words) in [
        (
            "fields.npy",
            npy("[('a', '<f4'), ('b', '<f4')]", "False", "(4,)", zeros(32)),
            "save an array of such",
        ),
        ("complex.npy", npy("'<c8'", "False", "(4,)", zeros(32)), "no number of at most 64 bits"),
        ("objects.npy", npy("'|O'", "False", "(4,)", zeros(32)), "no number of at most 64 bits"),
        (
            "nan.npy",
            npy("'<f8'", "False", "(1,)", [f64::NAN.to_le_bytes().to_vec()]),
            "is NaN: bring all values",
        ),
        (
            "below.npy",
            npy("'<i4'", "False", "(1,)", [(-3_i32).to_le_bytes().to_vec()]),
            "is -3: bring all values",
        ),
        ("short.npy", npy("'<f8'", "False", "(4,)", zeros(31)), "takes 32"),
        ("prose", b"Once upon a time\nthere was".to_vec(), "which is no number"),
        ("empty", Vec::new(), "no numbers in it"),
    ] {
        fs::write(home.path().join(name), bytes).unwrap();
        for verb in ["import --out table.npy", "inspect"] {
            let output = command(home.path(), &format!("{verb} {name}")).output().unwrap();
            let (out, err) = texts(&output);
            assert_eq!((output.status.code(), out.as_str()), (Some(1), ""), "{err}");
            let is_it = err.contains(words) || name == "empty";
            assert!(err.lines().count() == 1 && err.contains(name) && is_it && !err.contains('`'), "{err}");
        }
    }
    assert!(!home.path().join("table.npy").exists());
}

#[test]
fn import_says_what_it_took_for_what() {
    let home = tempdir().unwrap();
    fs::write(home.path().join("mask.dat"), "0.5\n1\n0\n0.25\n").unwrap();
    let (out, _) = run(home.path(), "import mask.dat --out table.npy");
    let expected = "mask.dat: text of shape [4, 1] as a list of samples in the order of a table, values as \
                    they are, 1 of them 1, which became the largest number below\n\
                    table.npy: 1 frame of 2 x 2 pixels, 1 sample per pixel, 1 dimension\n";
    assert_eq!(out, expected);
    assert_eq!(names(home.path()), ["mask.dat", "table.npy"]);
    let (json, _) = run(home.path(), "import mask.dat --out table.npy --json --frames 4 --quiet");
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&json["shape"], &json["ones"]), (&serde_json::json!([4, 1, 1, 1, 1]), &1.into()));
    assert_eq!(SampleTable::load(home.path().join("table.npy")).unwrap().shape(), [4, 1, 1, 1, 1]);

    // Metadata of a table that was there before are not this one's.
    run(home.path(), "table --width 2 --height 2 --frames 1 --dims 1 --quiet");
    let (out, _) = run(home.path(), "import mask.dat --out table.npy");
    assert!(out.ends_with("table.json is of another table\n"), "{out}");
    let (out, _) = run(home.path(), "inspect table.npy --integrands 2 --bound-slices 64");
    assert!(out.contains("metadata: NOT OF THIS TABLE") && out.contains("SHA-256"), "{out}");

    let refused = |arguments: &str, code: i32, words: &str| {
        let output = command(home.path(), arguments).output().unwrap();
        let (_, err) = texts(&output);
        assert!(output.status.code() == Some(code) && err.contains(words), "{arguments}: {err}");
    };
    refused("import table.npy --out table.npy", 1, "would overwrite what is read");
    refused("import mask.dat --out other.csv", 1, "ends in .npy");
    refused("import mask.dat", 2, "--out");
    refused("import mask.dat --out a.npy --axes y,z", 2, "'z' is no axis: write frame, y, x, sample or dim");
    refused("import mask.dat --out a.npy --axes y,x --frames 2", 2, "cannot be used with");
    refused("import mask.dat --out a.npy --levels 0", 2, "--levels");
    refused("import mask.dat --out a.npy --axes dim", 1, "has 2 axes, but --axes names 1");
    refused("import mask.dat --out a.npy --frames 3", 1, "4 numbers do not fill");
    refused("import mask.dat --out a.npy --levels 7", 1, "no whole number below 7");
    assert_eq!(names(home.path()), ["mask.dat", "table.json", "table.npy"]);
    let named = SampleTable::white_noise(Extent::still(3, 4), 2, 0).unwrap();
    named.save(home.path().join("named.npy")).unwrap();
    run(home.path(), "import named.npy --axes dim,x,y,frame,sample --out turned.npy");
    let turned = SampleTable::load(home.path().join("turned.npy")).unwrap();
    assert_eq!(
        (turned.shape(), turned.view()[[0, 3, 2, 1, 0]]),
        ([1, 4, 3, 2, 1], named.view()[[0, 2, 3, 0, 1]])
    );
}
