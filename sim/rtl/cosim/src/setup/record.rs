//! A splat as the setup unit takes it.

use splatline::splat::VolumeSplat;

/// Words of a record.
pub const RECORD: usize = 19;

/// A splat as the unit takes it; nothing if an exponent has no place.
pub fn record(splat: &VolumeSplat) -> Option<[u32; RECORD]> {
    let mut bits = RecordBits::default();
    for coordinate in splat.centre {
        bits.put(coordinate.mantissa as u32, 32);
    }
    for coordinate in splat.centre {
        bits.put(exponent(coordinate.exponent, coordinate.mantissa == 0)?, 10);
    }
    for axis in splat.axes {
        for component in axis.mantissa {
            bits.put(component as u32, 32);
        }
    }
    for axis in splat.axes {
        bits.put(exponent(axis.exponent, axis.mantissa == [0; 3])?, 10);
    }
    bits.put(splat.weight.mantissa as u32, 32);
    bits.put(
        exponent(splat.weight.exponent, splat.weight.mantissa == 0)?,
        10,
    );
    for channel in splat.colour {
        bits.put(channel.to_bits(), 32);
    }
    Some(bits.words)
}

/// Ten bits; 0 has any exponent.
fn exponent(value: i32, zero: bool) -> Option<u32> {
    match value {
        _ if zero => Some(0),
        -512..=511 => Some(value as u32 & 0x3ff),
        _ => None,
    }
}

#[derive(Default)]
struct RecordBits {
    words: [u32; RECORD],
    filled: usize,
}

impl RecordBits {
    fn put(&mut self, value: u32, bits: usize) {
        let placed = u64::from(value) << (self.filled % 32);
        let word = self.filled / 32;
        self.words[word] |= placed as u32;
        if let Some(next) = self.words.get_mut(word + 1) {
            *next |= (placed >> 32) as u32;
        }
        self.filled += bits;
    }
}
