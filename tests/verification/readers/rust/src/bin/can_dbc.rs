//! Decodes frames with what can-dbc, a parser, reads from a file.

use can_dbc::{ByteOrder, Dbc, MultiplexIndicator, Signal, SignalExtendedValueType, ValueType};
use dbc_readers::{frames, text};

fn main() {
    let dbc = Dbc::try_from(text().as_str()).expect("a file that can-dbc supports");
    for (id, data) in frames() {
        let message = dbc
            .messages
            .iter()
            .find(|message| message.id.raw() == id)
            .expect("a message with this id");
        let selector = message
            .signals
            .iter()
            .find(|signal| signal.multiplexer_indicator == MultiplexIndicator::Multiplexor)
            .map(|signal| raw(signal, &data));
        for signal in &message.signals {
            let is_present = match signal.multiplexer_indicator {
                MultiplexIndicator::MultiplexedSignal(value) => selector == Some(value),
                _ => true,
            };
            if is_present {
                let raw = raw(signal, &data);
                let value = match dbc.extended_value_type_for_signal(message.id, &signal.name) {
                    Some(SignalExtendedValueType::IEEEfloat32Bit) => {
                        f64::from(f32::from_bits(raw as u32))
                    }
                    Some(SignalExtendedValueType::IEEEdouble64bit) => f64::from_bits(raw),
                    _ if signal.value_type == ValueType::Signed => {
                        let unused = 64 - signal.size;
                        (((raw << unused) as i64) >> unused) as f64
                    }
                    _ => raw as f64,
                };
                print!("{}={} ", signal.name, value * signal.factor + signal.offset);
            }
        }
        println!();
    }
}

/// The bits of a signal.
fn raw(signal: &Signal, data: &[u8]) -> u64 {
    let (mut value, mut bit) = (0, signal.start_bit);
    for i in 0..signal.size {
        let one = u64::from(data[(bit / 8) as usize] >> (bit % 8) & 1);
        if signal.byte_order == ByteOrder::BigEndian {
            value = value << 1 | one;
            bit = if bit % 8 == 0 { bit + 15 } else { bit - 1 };
        } else {
            value |= one << i;
            bit += 1;
        }
    }
    value
}
