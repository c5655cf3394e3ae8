//! Headers of `.npy` files as numpy, Julia, MATLAB and people write them.

use std::time::{Duration, Instant};

use fsot::files::FormatError;

use crate::{load_bytes, npy, problem};

const VALUES: [f32; 4] = [0.0, 0.25, 0.5, 0.75];

fn bytes() -> Vec<u8> {
    VALUES.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The same header in format version 3.0, whose text is UTF-8.
fn version_3(version_1: &[u8]) -> Vec<u8> {
    [b"\x93NUMPY\x03\x00", &version_1[8..10], &[0, 0], &version_1[10..]].concat()
}

/// Every line is taken by numpy 2.4, as the same array.
const TAKEN: [&str; 40] = [
    "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2), }",
    "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr':'<f4','fortran_order':False,'shape':(1,1,2,1,2),}",
    "{ 'descr' : '<f4' , 'fortran_order' : False , 'shape' : ( 1 , 1 , 2 , 1 , 2 , ) , } ",
    "{\"descr\": \"<f4\", \"fortran_order\": False, \"shape\": (1, 1, 2, 1, 2), }",
    "{'shape': (1, 1, 2, 1, 2), 'fortran_order': False, 'descr': '<f4'}",
    // Line breaks, tabs and comments.
    "{'descr': '<f4',\n'fortran_order': False,\n'shape': (1,\n1,\n2,\n1,\n2),\n}\n",
    "{'descr': '<f4',\r\n 'fortran_order': False,\r\n\t'shape': (1,\r1, 2,\x0c1, 2)}",
    "\n{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2), }",
    " \t{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2), }  \n \n",
    "{'descr': '<f4', # little\n'fortran_order': False, 'shape': (1, 1, 2, 1, 2)} # the end",
    "{'descr': '<f4', 'fortran_order': \\\nFalse, 'shape': (1, 1, 2, 1, 2)}",
    // Parentheses that make no tuple.
    "({'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)})",
    "{'descr': ('<f4'), 'fortran_order': (False), 'shape': ((1, (1), 2, 1, ((2))))}",
    // Numbers.
    "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, +2, 1, 2)}",
    "{'descr': '<f4', 'fortran_order': False, 'shape': (0x1, 0b1, 0o2, 1, 0X2)}",
    "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 0x0_2, 1, 0b1_0)}",
    // Strings.
    "{u'descr': u'<f4', U'fortran_order': False, r'shape': (1, 1, 2, 1, 2)}",
    "{'de' 'scr': '<' \"f4\", 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'''descr''': \"\"\"<f4\"\"\", 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'\\x64escr': '\\74f4', 'fortran\\u005forder': False, '\\U00000073hape': (1, 1, 2, 1, 2)}",
    "{'descr\\\n': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    // The last of two.
    "{'descr': '<f8', 'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': '<f4', 'fortran_order': True, 'shape': (1,), 'fortran_order': False, 'shape': (1,1,2,1,2)}",
    // Other names of the type.
    "{'descr': 'f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': '=f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': '|f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': 'f', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': '<f', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': 'single', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': 'float32', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    // Python 2, which is read in versions 1 and 2.
    "{'descr': '<f4', 'fortran_order': False, 'shape': (1L, 1L, 2L, 1L, 2L), }",
    "{'descr': '<f4', 'fortran_order': False, 'shape': (1 L, 1, 2L , 1, 0x2L)}",
    "\n{'descr': '<f4', 'fortran_order': False, 'shape': (1L,\n1L,\n2L,\n1L,\n2L\n)}",
    "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 64L, 1, 2), 'shape': (1, 1, 2, 1, 2)}",
    // What stands in strings is text.
    "{'descr': '((((((((((((((', 'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': [('a', '<f4')], 'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': '}', \"descr\": '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': '\\'', 'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
    "{'descr': r'\\'', 'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}",
];

#[test]
fn what_numpy_takes_is_read() {
    let mut refused = Vec::new();
    for dictionary in TAKEN {
        let file = npy(dictionary, &bytes());
        let is_python_2 = ["2L", "4L"].iter().any(|long| dictionary.contains(long));
        let read = [load_bytes(&file), load_bytes(&version_3(&file))];
        for (version, read) in [1, 3].into_iter().zip(read) {
            match read {
                Ok(table) => assert_eq!((table.shape(), table.values()), ([1, 1, 2, 1, 2], &VALUES[..])),
                Err(_) if version == 3 && is_python_2 => {}
                Err(error) => refused.push(format!("{version}: {dictionary:?}: {error}")),
            }
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

/// Every one is refused by numpy 2.4 as well.
#[test]
fn what_numpy_refuses_is_refused() {
    let whole = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2, 1, 2)}";
    for (part, instead) in [
        ("(1, 1, 2, 1, 2)", "[1, 1, 2, 1, 2]"),
        ("(1, 1, 2, 1, 2)", "1, 1, 2, 1, 2"),
        ("(1, 1, 2, 1, 2)", "(1, 1, 2, 1, 2,,)"),
        ("(1, 1, 2, 1, 2)", "(,1, 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(1 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(1.0, 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(1, 1, 2, 1, 2j)"),
        ("(1, 1, 2, 1, 2)", "(True, 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(1l, 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(1LL, 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(1_, 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(01, 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(-1, 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(--1, 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(1, 1, 2\nL, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "((1, 1, 2, 1, 2)"),
        ("(1, 1, 2, 1, 2)", "(1, 1, 2, 1, 2]"),
        ("(1, 1, 2, 1, 2)", "(4)"),
        ("False", "0"),
        ("False", "false"),
        ("False", "'False'"),
        ("False", "not True"),
        ("'<f4'", "b'<f4'"),
        ("'<f4'", "f'<f4'"),
        ("'<f4'", "ur'<f4'"),
        ("'<f4'", "' <f4'"),
        ("'<f4'", "'<F4'"),
        ("'<f4'", "'!f4'"),
        ("'<f4'", "None"),
        ("'<f4'", "'<f4"),
        ("'descr'", "b'descr'"),
        ("'descr'", "'Descr'"),
        ("'descr'", "descr"),
        ("{", "{,"),
        ("{", "{'colour': 1, "),
        ("}", "},"),
        ("}", "};"),
        ("}", "}\0"),
        ("}", "} {}"),
        ("}", ""),
        (", 'shape'", " 'shape'"),
        ("': ", "' "),
    ] {
        let damaged = whole.replacen(part, instead, 1);
        assert_ne!(damaged, whole);
        let problem = problem(&npy(&damaged, &bytes()), &[]);
        let is_known = matches!(problem, FormatError::Header { .. } | FormatError::Dtype { .. });
        assert!(is_known, "{damaged:?}: {problem}");
    }
}

/// As long as headers may be, and of every kind of nesting: each answers in a moment.
#[test]
fn no_header_takes_long() {
    let brackets = |depth: usize| "(".repeat(depth) + "1" + &")".repeat(depth);
    let fill = |unit: &str| unit.repeat(9_900 / unit.len());
    let mut headers = vec![
        "(')',".repeat(22) + &")".repeat(22),
        fill("(')',"),
        fill("['](',"),
        fill("{'}':"),
        fill("{"),
        fill("(("),
        fill("'"),
        fill("''"),
        fill("'\\"),
        fill("\"\"\""),
        fill("1_"),
        fill("#\n"),
        fill("\\\n"),
        fill("'a':'b',"),
        fill("u'\u{fc}'"),
        "\u{fc}'".to_owned(),
        brackets(4_900),
        "[".repeat(60) + &"]".repeat(60),
    ];
    for value in [brackets(4_900), fill("'x' "), fill("(1,)"), format!("({})", fill("1,"))] {
        let value = &value[..value.len().min(9_800)];
        headers.push(format!("{{'descr': {value}, 'fortran_order': False, 'shape': (1,)}}"));
        headers.push(format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {value}}}"));
    }
    let begin = Instant::now();
    for header in &headers {
        assert!(load_bytes(&npy(header, &[])).is_err());
    }
    let each = begin.elapsed() / headers.len() as u32;
    // A tenth of a millisecond; the parser of before took minutes for some.
    assert!(each < Duration::from_millis(100), "{each:?}");
}
