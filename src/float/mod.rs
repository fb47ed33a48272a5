//! Ordinary numbers to the kernel's: the one place where floating point is converted. Feature `float`, on by default.
//!
//! Everything that has an exponent of its own keeps 31 bits or more, so that an f32 of a file arrives as it is,
//! wherever in the scene it lies; what the kernel keeps in fixed point is rounded once, as each function says. All
//! functions are defined for every number: NaN counts as 0, what is too large saturates. The front door's types
//! ([`Camera`], [`Gaussian`], [`Point`], [`Surfel`]) refuse such numbers instead.
//!
//! On a processor without floating point these are library calls, made once per splat and camera; an image that holds
//! its scene in the kernel's types (`default-features = false`) links none of them.

mod camera;
mod primitives;
#[cfg(test)]
mod tests;

pub use camera::{Camera, CameraError};
pub use primitives::{Gaussian, Point, Surfel};

use crate::math::{Extended, SoftFloat};
use crate::rules::THRESHOLD;
use crate::splat::{Axis, Position};
use crate::view::{Eye, Rotation};
use fixed::types::{I2F30, I4F28, I32F32, U4F28};

/// `2^power`; 0 or infinite beyond the format.
#[inline]
pub fn exp2(power: i32) -> f64 {
    libm::ldexp(1.0, power)
}

/// A double as it is: 53 bits and an exponent. Numbers that are not finite count as 0.
pub const fn extended(value: f64) -> Extended {
    const FRACTION: u32 = f64::MANTISSA_DIGITS - 1;
    if !value.is_finite() {
        return Extended::ZERO;
    }
    let bits = value.to_bits();
    let below = (bits & ((1 << FRACTION) - 1)) as i64;
    let power = (bits >> FRACTION & 0x7ff) as i32;
    // Subnormal numbers have no leading one, and the exponent of the smallest normal ones.
    let (magnitude, power) = match power {
        0 => (below, 1),
        _ => (below | 1 << FRACTION, power),
    };
    Extended {
        value: if value < 0.0 { -magnitude } else { magnitude },
        exponent: power - 1075,
    }
}

/// A double as mantissa and exponent, rounded to nearest to 31 bits: exact for an f32. Numbers that are not finite
/// count as 0.
pub const fn scaled(value: f64) -> SoftFloat {
    let Extended { value, exponent } = extended(value);
    SoftFloat::from_wide(value, exponent, 31)
}

/// A centre, scene units: every coordinate rounded to nearest to 31 bits.
pub const fn position([x, y, z]: [f64; 3]) -> Position {
    [scaled(x), scaled(y), scaled(z)]
}

/// A vector, scene units: 31 bits of its largest component.
pub fn axis(components: [f64; 3]) -> Axis {
    Axis::from_components(components.map(scaled))
}

/// A colour channel in UQ4.28, saturated to 0 and 16 - 2^-28; rounded to odd, that is, with the last bit set where bits
/// below it are lost.
///
/// The design rounds once more, to fewer bits. Rounded to nearest here, one colour in sixteen would lie in the middle
/// between two numbers of 24 bits there and go up: a bias of `2^-29` in every picture.
pub fn colour(value: f64) -> U4F28 {
    let bits = value * exp2(28);
    if bits.is_nan() {
        return U4F28::ZERO;
    }
    let whole = libm::floor(bits.clamp(0.0, u32::MAX as f64));
    U4F28::from_bits(whole as u32 | u32::from(whole < bits))
}

/// A coefficient of the colour's spherical harmonics, or their base, in Q3.28: rounded to nearest, halves to even,
/// saturated. NaN counts as 0.
pub fn coefficient(value: f64) -> I4F28 {
    I4F28::from_bits(libm::rint(value * exp2(28)) as i32)
}

/// Pixels, or a ratio of lengths, in Q31.32: rounded to nearest, halves to even, saturated.
pub fn pixels(value: f64) -> I32F32 {
    I32F32::from_bits(libm::rint(value * exp2(32)) as i64)
}

/// A threshold of the rules (`alpha_min`, `minimum_transmittance`) in UQ1.60: clamped to 0 to 1, rounded to nearest.
pub fn threshold(value: f64) -> u64 {
    libm::round(value.clamp(0.0, 1.0) * exp2(THRESHOLD as i32)) as u64
}

/// The largest opacity of the rules (`alpha_max`) in UQ1.31: clamped to 0 to 1, rounded to nearest.
pub fn opacity_limit(value: f64) -> u32 {
    libm::round(value * exp2(31)).clamp(0.0, exp2(31)) as u32
}

/// A cut-off of the rules on the radial index in UQ4.28: clamped to 0 to 15, rounded to nearest.
pub fn radial_cutoff(value: f64) -> u32 {
    libm::round(value * exp2(28)).clamp(0.0, 15.0 * exp2(28)) as u32
}

/// A depth or a difference of depths in UQ9.23, scene units: rounded to nearest, saturated to 0 and 512.
pub fn depth(value: f64) -> u32 {
    libm::round(value * exp2(23)) as u32
}

/// W in the kernel's two parts: 30 fraction bits to nearest, and the rest to 60. Entries are clamped to -1 to 1.
pub fn rotation(rows: [[f64; 3]; 3]) -> (Rotation, [[i32; 3]; 3]) {
    let fine = rows.map(|row| row.map(fine_entry));
    let coarse = fine.map(|row| row.map(|entry| entry.wrapping_add(1 << 29) >> 30));
    let part = |[a, b, c]: [i64; 3], [p, q, r]: [i64; 3]| {
        [a - (p << 30), b - (q << 30), c - (r << 30)].map(|rest| rest as i32)
    };
    let ([f0, f1, f2], [c0, c1, c2]) = (fine, coarse);
    let rest = [part(f0, c0), part(f1, c1), part(f2, c2)];
    let entry = |bits: i64| I2F30::from_bits(bits as i32);
    (coarse.map(|row| row.map(entry)), rest)
}

/// An entry of W in units of 2^-60.
fn fine_entry(entry: f64) -> i64 {
    libm::round(entry.clamp(-1.0, 1.0) * exp2(60)) as i64
}

/// The eye, scene units, with what W has beyond 30 bits ([`rotation`]): three doubles with one exponent. Of the smaller
/// coordinates the bits beyond 59 below the largest one's leading bit are rounded away. Coordinates that are not finite
/// put it at the origin.
pub fn eye(position: [f64; 3], rotation_rest: [[i32; 3]; 3]) -> Eye {
    let largest = position.iter().fold(0.0f64, |m, value| m.max(value.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return Eye {
            rotation_rest,
            ..Eye::ORIGIN
        };
    }
    let leading = extended(largest).leading();
    let unit = exp2(58 - leading);
    Eye {
        position: position.map(|value| libm::round(value * unit) as i64),
        exponent: leading - 58,
        rotation_rest,
    }
}
