//! Decodes frames with dbc-rs.

use dbc_readers::{frames, text};

fn main() {
    let text = text();
    let dbc = dbc_rs::Dbc::parse(&text).expect("a file that dbc-rs supports");
    for (id, data) in frames() {
        let signals = dbc
            .decode(id & 0x1FFF_FFFF, &data, id >> 31 == 1)
            .expect("a frame that dbc-rs decodes");
        for signal in signals.iter() {
            print!("{}={} ", signal.name, signal.value);
        }
        println!();
    }
}
