//! Arguments and input of the readers: FILE, then lines ID#DATA in hexadecimal on standard input.

use std::io::{self, BufRead};

/// The text of the file.
pub fn text() -> String {
    let file = std::env::args().nth(1).expect("FILE");
    std::fs::read_to_string(file).expect("a UTF-8 file")
}

/// The id, with bit 31 set for a 29-bit id, and the data of each frame.
pub fn frames() -> impl Iterator<Item = (u32, Vec<u8>)> {
    io::stdin().lock().lines().map(|line| {
        let line = line.expect("UTF-8");
        let (id, data) = line.split_once('#').expect("an id and data");
        let bytes = data.as_bytes().chunks(2).map(|two| {
            u8::from_str_radix(std::str::from_utf8(two).expect("ASCII"), 16).expect("hexadecimal")
        });
        (
            u32::from_str_radix(id, 16).expect("hexadecimal"),
            bytes.collect(),
        )
    })
}
