//! A reader of unpacked OpenEXR files[^exr], as short as the format allows: a second opinion on the crate
//! that writes them.
//!
//! [^exr]: <https://openexr.com/en/latest/OpenEXRFileLayout.html>

use std::collections::BTreeMap;

#[derive(Default)]
pub struct Part {
    pub name: String,
    pub width: usize,
    pub height: usize,
    /// Bits of the numbers, row by row.
    pub channels: BTreeMap<String, Vec<u32>>,
    /// Name and bytes of a number, in the order of the file.
    list: Vec<(String, usize)>,
}

struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(count);
        self.0 = rest;
        taken
    }

    fn int(&mut self) -> i32 {
        i32::from_le_bytes(self.take(4).try_into().unwrap())
    }

    /// Up to a zero.
    fn text(&mut self) -> String {
        let end = self.0.iter().position(|&byte| byte == 0).unwrap();
        let text = String::from_utf8(self.take(end).to_vec()).unwrap();
        self.take(1);
        text
    }
}

pub fn read(file: &[u8]) -> Vec<Part> {
    let mut bytes = Bytes(file);
    assert_eq!(bytes.int(), 20_000_630);
    let version = bytes.int();
    let is_multipart = version & 0x1000 != 0;
    assert_eq!(version & !0x1000, 2);
    let mut parts = vec![header(&mut bytes)];
    while is_multipart && bytes.0[0] != 0 {
        parts.push(header(&mut bytes));
    }
    bytes.take(usize::from(is_multipart));
    // Blocks are found by their places in the file, a block a line.
    for (number, part) in parts.iter_mut().enumerate() {
        for line in 0..part.height {
            let place = u64::from_le_bytes(bytes.take(8).try_into().unwrap());
            let mut block = Bytes(&file[place as usize..]);
            if is_multipart {
                assert_eq!(block.int(), number as i32);
            }
            assert_eq!(block.int(), line as i32);
            let length = block.int() as usize;
            let mut row = Bytes(block.take(length));
            let Part { width, channels, list, .. } = &mut *part;
            for (name, size) in list {
                for _ in 0..*width {
                    let mut number = [0; 4];
                    number[..*size].copy_from_slice(row.take(*size));
                    channels.entry(name.clone()).or_default().push(u32::from_le_bytes(number));
                }
            }
            assert!(row.0.is_empty());
        }
    }
    parts
}

fn header(bytes: &mut Bytes) -> Part {
    let mut part = Part::default();
    loop {
        let name = bytes.text();
        if name.is_empty() {
            return part;
        }
        bytes.text();
        let length = bytes.int() as usize;
        let mut value = Bytes(bytes.take(length));
        match name.as_str() {
            "compression" => assert_eq!(value.0, [0]),
            "lineOrder" => assert_eq!(value.0, [0]),
            "name" => part.name = String::from_utf8(value.0.to_vec()).unwrap(),
            "dataWindow" => {
                let [left, top, right, bottom] = [(); 4].map(|()| value.int());
                assert_eq!([left, top], [0, 0]);
                (part.width, part.height) = (right as usize + 1, bottom as usize + 1);
            }
            "channels" => {
                while value.0.len() > 1 {
                    let name = value.text();
                    let size = [4, 2, 4][value.int() as usize];
                    // Perceptually linear or not, and samples for every pixel.
                    value.take(4);
                    assert_eq!([value.int(), value.int()], [1, 1]);
                    part.list.push((name, size));
                }
            }
            _ => {}
        }
    }
}
