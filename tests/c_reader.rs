//! The C program among the examples reads what the library writes, where there is a C compiler.

use std::path::Path;
use std::process::Command;

use fsot::{Extent, SampleTable, Site};

#[test]
fn a_c_program_reads_a_table() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/c/read_table.c");
    let home = tempfile::tempdir().unwrap();
    let program = home.path().join("read_table");
    let compiler = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "-o"])
        .args([&program, &source])
        .arg("-lm")
        .output();
    let Ok(compiled) = compiler else {
        println!("no C compiler here: left out");
        return;
    };
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));

    let table = SampleTable::white_noise(Extent::animation(3, 7, 13).with_spp(2), 3, 5).unwrap();
    let path = home.path().join("table.npy");
    table.save(&path).unwrap();
    let output = Command::new(&program).arg(&path).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let [shape, value, displaced] = text.lines().collect::<Vec<_>>()[..] else { panic!("{text}") };
    assert_eq!(shape, "3 7 13 2 3");
    // Nine digits tell every f32 from its neighbours.
    assert_eq!(value.parse::<f32>().unwrap(), table.sample(Site { frame: 0, y: 5, x: 12 }, 0)[1]);
    let by = table.extent().displacement(1);
    let there = table.sample(Site { frame: 0, y: 5 + by.y, x: 12 + by.x }, 0)[1];
    let (place, value) = displaced.rsplit_once(' ').unwrap();
    assert_eq!((place, value.parse::<f32>().unwrap()), (&*format!("{} {}", by.y, by.x), there));

    // What is no table is refused.
    let output = Command::new(&program).arg(&source).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
}
