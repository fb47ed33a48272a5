//! A splat as the setup unit takes it.

use splatline::splat::VolumeSplat;

/// Words of a record.
pub const RECORD: usize = 19;

/// A splat as the unit takes it, and a word of nothing; nothing if an exponent has no place.
pub fn record(splat: &VolumeSplat) -> Option<[u32; RECORD + 1]> {
    let (centre, axes, weight) = (splat.centre, splat.axes, splat.weight);
    // Values with their bits, the lowest ones first.
    let mut fields: Vec<(u32, usize)> = Vec::new();
    fields.extend(centre.map(|place| (place.mantissa as u32, 32)));
    for place in centre {
        fields.push((exponent(place.exponent, place.mantissa == 0)?, 10));
    }
    let components = axes.iter().flat_map(|axis| axis.mantissa);
    fields.extend(components.map(|component| (component as u32, 32)));
    for axis in axes {
        fields.push((exponent(axis.exponent, axis.mantissa == [0; 3])?, 10));
    }
    fields.push((weight.mantissa as u32, 32));
    fields.push((exponent(weight.exponent, weight.mantissa == 0)?, 10));
    fields.extend(splat.colour.map(|channel| (channel.to_bits(), 32)));
    let bits = |(value, bits)| (0..bits).map(move |bit| value >> bit & 1);
    let mut words = [0; RECORD + 1];
    for (place, bit) in fields.into_iter().flat_map(bits).enumerate() {
        words[place / 32] |= bit << (place % 32);
    }
    Some(words)
}

/// Ten bits; 0 has any exponent.
fn exponent(value: i32, zero: bool) -> Option<u32> {
    match value {
        _ if zero => Some(0),
        -512..=511 => Some(value as u32 & 0x3ff),
        _ => None,
    }
}
