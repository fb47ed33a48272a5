//! Where the fused products' binary points lie, and what the kernel's words are at these scales.
//!
//! A fused product drops 52 bits, whatever the design's widths are. So every factor is shifted to the left, once, to where its product's
//! result has the bits that are kept and at least one below them, for rounding: with F fraction bits of the kernel's value,
//!
//! | quantity | fraction bits | from |
//! |---|---|---|
//! | kernel's value | F = min(51, 31 + weight) | table, interpolated |
//! | peak | 48 | footprint; below 16 |
//! | opacity | F - 4 | peak, kernel's value |
//! | transmittance | 51 | tile |
//! | share | F - 5 | transmittance, opacity |
//! | colour | 48 | footprint; below 16 |
//! | sum of a colour | F - 9 | share, colour |
//!
//! A result is rounded where it stands: half of its last bit is the product's addend, and the bits below are cut off by a mask. That gives
//! the kernel's `(a b + half) >> shift`, because cutting twice is cutting once. The sums in the tile hold their next rounding's half.

use splatline::blend::{BlendConstants, FINISHED, Pixel};
use splatline::format::{Rounding, Widths};

/// The most significant bit of a transmittance: the mark of a finished pixel, which no product sees.
pub const MARK: u64 = 1 << 63;

/// Fraction bits of a peak and of a colour.
const FACTOR: u32 = 48;

/// Fraction bits of the transmittance.
const LIGHT: u32 = 51;

/// Left shifts from the kernel's words to the scales above, the bits below a kept result in each product.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    /// Of a kernel value; also the bits of an interpolated one below the kept ones.
    pub weight: u32,
    /// Of a peak.
    pub peak: u32,
    /// Of an opacity.
    pub alpha: u32,
    /// Unrounded opacities below this are skipped.
    pub opacity_min: u64,
    /// Of the transmittance.
    pub transmittance: u32,
    /// Of a share, to round it.
    pub share: u32,
    /// Left shift that makes a share a transmittance.
    pub to_light: u32,
    /// Of a colour.
    pub colour: u32,
    /// Of a sum.
    pub sum: u32,
    /// Do products round to nearest?
    rounds: bool,
}

impl Scale {
    /// For widths whose products keep at least one bit below their results and do not round ties to even; `None` for others.
    pub fn new(widths: &Widths, constants: &BlendConstants) -> Option<Self> {
        if constants.rounding == Rounding::NearestEven {
            return None;
        }
        let value = (31 + u32::from(widths.weight)).min(51);
        let below = |fraction: u32, width: u8| {
            let bits = fraction.checked_sub(width.into())?;
            (bits > 0).then_some(bits)
        };
        let product = u32::from(widths.peak) + u32::from(widths.weight);
        Some(Scale {
            opacity_min: at_scale(constants.opacity_min, product, value - 4)?,
            weight: value - u32::from(widths.weight),
            peak: FACTOR - u32::from(widths.peak),
            alpha: below(value - 4, widths.alpha)?,
            transmittance: LIGHT - u32::from(widths.transmittance),
            share: below(value - 5, widths.transmittance)?,
            to_light: LIGHT - (value - 5),
            colour: FACTOR - u32::from(widths.colour),
            sum: below(value - 9, widths.accumulator)?,
            rounds: constants.rounding == Rounding::Nearest,
        })
    }

    /// What rounds a result with so many bits below it.
    pub fn half(&self, below: u32) -> u64 {
        if self.rounds { 1 << below >> 1 } else { 0 }
    }

    /// A pixel of the kernel as transmittance, red, green and blue.
    #[inline(always)]
    pub fn words(&self, pixel: Pixel) -> [u64; 4] {
        let [r, g, b] = pixel.colour;
        let mark = u64::from(pixel.transmittance & FINISHED) << 32;
        let light = u64::from(pixel.transmittance & !FINISHED) << self.transmittance;
        let sum = |sum: u32| (u64::from(sum) << self.sum) | self.half(self.sum);
        [light | mark, sum(r), sum(g), sum(b)]
    }

    /// The inverse of `words`.
    #[inline(always)]
    pub fn pixel(&self, [light, colour @ ..]: [u64; 4]) -> Pixel {
        let mark = if light & MARK == 0 { 0 } else { FINISHED };
        Pixel {
            colour: colour.map(|sum| (sum >> self.sum) as u32),
            transmittance: ((light & !MARK) >> self.transmittance) as u32 | mark,
        }
    }
}

/// A threshold of a product, brought from the product's fraction bits to others; `None` if that loses a bit.
fn at_scale(least: u64, from: u32, to: u32) -> Option<u64> {
    if least >= 1 << 63 {
        return None;
    }
    let raised = u128::from(least) << to >> from;
    let exact = raised << from == u128::from(least) << to;
    u64::try_from(raised)
        .ok()
        .filter(|least| exact && *least < 1 << 62)
}
