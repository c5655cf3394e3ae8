//! Damage: bits, bytes, cuts and splices everywhere, and words of the grammar where a reader would stop too
//! soon.

use fsot::files::{Axis, ImportOptions};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;
use sha2::{Digest, Sha256};

use crate::seeds::npy;

pub type Random = Xoshiro256PlusPlus;

fn pick<'a, T>(random: &mut Random, among: &'a [T]) -> &'a T {
    &among[random.random_range(0..among.len())]
}

/// A sound file with a little damage, or much.
pub fn bytes(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = pick(random, seeds).clone();
    for _ in 0..*pick(random, &[1, 1, 2, 6]) {
        damage(random, &mut bytes, seeds);
    }
    bytes
}

fn damage(random: &mut Random, bytes: &mut Vec<u8>, seeds: &[Vec<u8>]) {
    if bytes.is_empty() {
        return bytes.push(random.random());
    }
    let at = random.random_range(0..bytes.len());
    let end = (at + random.random_range(1..=16)).min(bytes.len());
    match random.random_range(0..9) {
        0 | 1 => bytes[at] ^= 1 << random.random_range(0..8),
        2 => bytes[at] = *pick(random, &[0, 1, 0x7f, 0x80, 0xff, b'\n', b'0', b'-']),
        3 => bytes[at] = random.random(),
        4 => bytes.truncate(at),
        5 => drop(bytes.drain(at..end)),
        6 => {
            let copy = bytes[at..end].to_vec();
            bytes.splice(at..at, copy);
        }
        7 => {
            // A length, or an offset, that cannot be.
            let number = *pick(random, &[0, 1, 0xff, 0x7fff, 0xffff, 0x7fff_ffff, 0xffff_fffe, u64::MAX]);
            let size = *pick(random, &[2, 4, 8]);
            let little = number.to_le_bytes();
            let big: Vec<u8> = little[..size].iter().rev().copied().collect();
            let number = if random.random() { &little[..size] } else { &big };
            bytes.iter_mut().skip(at).zip(number).for_each(|(byte, new)| *byte = *new);
        }
        _ => {
            // The rest of another file.
            let other = pick(random, seeds);
            let from = random.random_range(0..=other.len());
            bytes.truncate(at);
            bytes.extend(&other[from..]);
        }
    }
}

/// Words of a header's grammar.
const HEADER: [&str; 48] = [
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    ",",
    ":",
    "'",
    "\"",
    "'''",
    "\\",
    "\n",
    "#",
    " ",
    "\t",
    "L",
    "u",
    "r",
    "b",
    "_",
    "'descr'",
    "'fortran_order'",
    "'shape'",
    "True",
    "False",
    "None",
    "'<f4'",
    "'>f8'",
    "'<u2'",
    "'|u1'",
    "'<i8'",
    "'f'",
    "(1, 1, 4, 1, 6)",
    "(24,)",
    "(2, 3, 4)",
    "()",
    "0",
    "1",
    "24",
    "0x18",
    "+6",
    "-1",
    "4L",
    "1.5",
    "18446744073709551615",
    "99999999999999999999",
    "\u{e9}",
];

/// An array of which half the time only the dictionary is damaged, word by word, and its length is right.
pub fn array(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    if random.random() {
        return bytes(random, seeds);
    }
    let whole = pick(random, seeds);
    let start = whole.iter().position(|byte| *byte == b'{').unwrap_or(0);
    let end = whole.iter().rposition(|byte| *byte == b'}').map_or(whole.len(), |end| end + 1);
    let mut dictionary = String::from_utf8_lossy(&whole[start..end]).into_owned();
    words(random, &mut dictionary, &HEADER);
    npy(*pick(random, &[1, 1, 2, 3]), &dictionary, &whole[end..])
}

/// Words put in, put in the place of others, left out, or repeated many times.
fn words(random: &mut Random, text: &mut String, among: &[&str]) {
    for _ in 0..*pick(random, &[1, 1, 2, 4]) {
        // Whole words: boundaries are where letters and digits end.
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '\'' || c == '"';
        let mut cuts: Vec<usize> =
            text.char_indices().filter(|(_, c)| !is_part(*c)).map(|(at, _)| at).collect();
        cuts.extend([0, text.len()]);
        cuts.sort_unstable();
        let at = random.random_range(0..cuts.len());
        let (from, to) = (cuts[at], *cuts.get(at + 1).unwrap_or(&text.len()));
        let word = *pick(random, among);
        match random.random_range(0..5) {
            0 | 1 => text.insert_str(from, word),
            2 => text.replace_range(from..to, word),
            3 => text.replace_range(from..to, ""),
            _ => text.insert_str(from, &word.repeat(*pick(random, &[2, 30, 3000]))),
        }
    }
}

pub fn text(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    if random.random() {
        return bytes(random, seeds);
    }
    let mut text = String::from_utf8_lossy(&pick(random, seeds)[..]).into_owned();
    let among = [
        "\n",
        "\r\n",
        " ",
        ",",
        ";",
        "#",
        "%",
        "0",
        "1",
        "1.0",
        "0.99999999999",
        "-0.0",
        "1e-400",
        "1e400",
        "nan",
        "inf",
        "255",
        "4294967295",
        "1e300",
        ".",
        "e",
        "\u{feff}",
        "\u{e9}",
        "x",
    ];
    words(random, &mut text, &among);
    text.into_bytes()
}

pub fn json(random: &mut Random, seed: &[u8]) -> Vec<u8> {
    if random.random() {
        return bytes(random, &[seed.to_vec()]);
    }
    let mut text = String::from_utf8_lossy(seed).into_owned();
    let among = [
        "{",
        "}",
        "[",
        "]",
        ",",
        ":",
        "\"",
        "null",
        "true",
        "-1",
        "0",
        "1e400",
        "1e-400",
        "18446744073709551616",
        "\"NaN\"",
        "\"inf\"",
        "\"sha256\"",
        "\"shape\"",
        "\"note\": 1,",
        "\\u0000",
        "\\ud800",
        "\u{e9}",
        " ",
    ];
    words(random, &mut text, &among);
    text.into_bytes()
}

/// A picture of which half the time a chunk is damaged whose checksum is right, so that it is looked into.
pub fn png(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    if random.random() {
        return bytes(random, seeds);
    }
    let whole = pick(random, seeds);
    let mut chunks = Vec::new();
    let mut rest = &whole[8..];
    while let Some((length, after)) = rest.split_first_chunk() {
        let length = u32::from_be_bytes(*length) as usize;
        chunks.push((after[..4].to_vec(), after[4..4 + length].to_vec()));
        rest = &after[8 + length..];
    }
    for _ in 0..random.random_range(1..=3) {
        let at = random.random_range(0..chunks.len());
        match random.random_range(0..6) {
            0 => drop(chunks.remove(at)),
            1 => chunks.insert(at, chunks[random.random_range(0..chunks.len())].clone()),
            2 => {
                let kind = *pick(
                    random,
                    &[b"gAMA", b"cICP", b"sRGB", b"iCCP", b"tRNS", b"PLTE", b"bKGD", b"acTL", b"fcTL"],
                );
                let data = (0..random.random_range(0..30)).map(|_| random.random()).collect();
                chunks.insert(at, (kind.to_vec(), data));
            }
            _ => damage(random, &mut chunks[at].1, seeds),
        }
        if chunks.is_empty() {
            break;
        }
    }
    let mut file = whole[..8].to_vec();
    for (kind, data) in chunks {
        let body = [kind, data].concat();
        file.extend((body.len() as u32 - 4).to_be_bytes());
        file.extend(&body);
        file.extend(crc(&body).to_be_bytes());
    }
    file
}

/// The checksum of a chunk: CRC-32 with the polynomial of ISO 3309, bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

/// A checkpoint whose header says something else, with the hash of that; or any damage.
pub fn checkpoint(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    if random.random_bool(0.1) {
        return bytes(random, seeds);
    }
    let whole = pick(random, seeds);
    let begin = whole.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    let (length, rest) = whole[begin..].split_first_chunk().unwrap();
    let (header, lists) = rest.split_at(u64::from_le_bytes(*length) as usize);
    let mut header = String::from_utf8(header.to_vec()).unwrap();
    for _ in 0..random.random_range(1..=3) {
        let numbers: Vec<_> = header.match_indices(|c: char| c.is_ascii_digit()).map(|(at, _)| at).collect();
        let at = *pick(random, &numbers);
        let number =
            ["0", "1", "9", "-1", "18446744073709551615", "1e300", "null", "4294967296", "2147483648"];
        let other: &str = pick::<&str>(random, &number);
        header.replace_range(at..=at, other);
    }
    let mut lists = lists[..lists.len() - 32].to_vec();
    if random.random_bool(0.3) {
        damage(random, &mut lists, seeds);
    }
    let mut bytes = whole[..begin].to_vec();
    bytes.extend((header.len() as u64).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(lists);
    let hash = Sha256::digest(&bytes);
    bytes.extend(hash.as_slice());
    bytes
}

/// Any options at all.
pub fn options(random: &mut Random) -> ImportOptions {
    let mut length = || -> Option<usize> {
        let length = *pick(random, &[0, 1, 2, 3, 4, 6, 8, 24, usize::MAX]);
        random.random_bool(0.2).then_some(length)
    };
    let [frames, height, width, spp, dims] = [length(), length(), length(), length(), length()];
    let named = random.random_bool(0.3);
    let count = if named { random.random_range(0..=5) } else { 0 };
    let axes = (0..count).map(|_| *pick(random, &Axis::ALL)).collect();
    let levels = random.random_bool(0.2).then(|| *pick(random, &[0, 1, 2, 24, 256, 1 << 40, u64::MAX]));
    let channels = random.random_bool(0.1).then(|| *pick(random, &[0, 1, 2, 3, 4, usize::MAX]));
    let types = ["u1", "<u2", ">u2", "<f2", "<f4", ">f4", "<f8", "i1", "b1"];
    let dtype = random.random_bool(0.1).then(|| pick(random, &types).parse().expect("a type"));
    let array = random.random_bool(0.1).then(|| (*pick(random, &["a", "mask", ""])).into());
    ImportOptions { axes, levels, frames, height, width, spp, dims, channels, dtype, array }
}

/// C of which half the time only words are changed.
pub fn source(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    if random.random() {
        return bytes(random, seeds);
    }
    let mut text = String::from_utf8_lossy(&pick(random, seeds)[..]).into_owned();
    let among = [
        "{",
        "}",
        "},",
        "{{",
        "[",
        "]",
        "(",
        ",",
        ";",
        "=",
        "-",
        "+",
        "/*",
        "*/",
        "//",
        "\n",
        "\\\n",
        "#",
        "#define FSOT_A_FRAMES 3\n",
        "#define FSOT_A_DIMS 99999999999999999999\n",
        "\"",
        "'",
        "0x",
        "0x1p-1f",
        "1e400",
        "08",
        ".5f",
        "0.99999999f",
        "65536",
        "nan",
        "float a[]",
        "uint16_t BlueNoiseTextures[2][3][4]",
        "BlueNoiseTextures",
        "\u{e9}",
    ];
    words(random, &mut text, &among);
    text.into_bytes()
}
