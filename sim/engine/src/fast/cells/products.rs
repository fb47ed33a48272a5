//! How a narrow design's products are put together from short ones, and where its words lie.
//!
//! `(a b + half) >> shift` with a = h 2^k + l is `(h b + ((l b + half) >> k)) >> (shift - k)`, because cutting twice is cutting once. If h b and
//! l b fit 32 bits, so does everything.
//!
//! | product | k | short products |
//! |---|--:|---|
//! | opacity = peak x kernel | up to 12 | 32 bits: parts of the peak are constants of the footprint |
//! | share = transmittance x opacity | 13 | 32 bits |
//! | colour = share x colour | 13 | 16 bits: the share stands in its word so that h is the upper half, and l 2^3 the lower |
//!
//! Sums of colours keep the bits below their last one that the product has left, and in them the next rounding's half.

use super::tile::{CellWord, PixelFormat};
use splatline::blend::{BlendConstants, FINISHED, Pixel};
use splatline::format::{Rounding, Widths};

/// Bits of a peak's lower part.
const PEAK_PART: u32 = 12;

/// Bits of the lower part of a transmittance and of a share.
const LIGHT_PART: u32 = 13;

/// Most fraction bits of a share.
const SHARE: u32 = 26;

/// A product by parts of one factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Split {
    /// Bits of the factor's lower part.
    pub bits: u32,
    /// Added to the lower part's product.
    pub half: u32,
    /// Right shift of the sum of both products.
    pub rest: u32,
}

impl Split {
    /// The product with `other` up to this much, brought back by `shift`; and the largest upper part that fits.
    fn new(bits: u32, shift: i32, other: u64, rounding: Rounding) -> Option<(Self, u64)> {
        let shift = u32::try_from(shift).ok().filter(|shift| *shift < 32)?;
        let bits = bits.min(shift);
        let half = match rounding {
            Rounding::Nearest => (1 << shift) >> 1,
            Rounding::Truncate => 0,
        };
        let low = ((1 << bits) - 1) * other + u64::from(half);
        let room = u64::from(u32::MAX).checked_sub(low >> bits)?;
        let split = Split {
            bits,
            half,
            rest: shift - bits,
        };
        (low <= u64::from(u32::MAX)).then_some((split, room / other.max(1)))
    }
}

/// All three products of a design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Products {
    pub opacity: Split,
    /// Sums of the opacity's parts below this are skipped.
    pub opacity_min: i32,
    pub share: Split,
    /// Largest peak.
    pub peak: u32,
    /// Left shift of a share, for its product with a colour.
    pub raise: u32,
    /// Largest colour.
    pub colour: u32,
    /// Left shift of a sum.
    pub sum: u32,
    /// What rounds it.
    pub sum_half: u32,
    /// Largest sum to which vectors can add: 16, as everything they add to a pixel is less than 16.
    largest_sum: u32,
}

impl Products {
    /// For widths whose products fit; `None` for others.
    pub fn new(widths: &Widths, constants: &BlendConstants) -> Option<Self> {
        let rounding = constants.rounding;
        let [transmittance, colour, accumulator] =
            [widths.transmittance, widths.colour, widths.accumulator].map(u32::from);
        let (opacity, peak) = Split::new(
            PEAK_PART.min(constants.opacity_min.trailing_zeros()),
            constants.opacity_shift,
            1 << widths.weight,
            rounding,
        )?;
        // Compared where the parts of the product have been put together.
        let least = constants.opacity_min + u64::from(opacity.half);
        let opacity_min = i32::try_from(least >> opacity.bits).ok()?;
        let alpha = constants.alpha_max.into();
        let (share, light) = Split::new(LIGHT_PART, constants.contribution_shift, alpha, rounding)?;
        // At least one bit, for rounding, and not more than the sum of 16 has room for.
        let sum = (LIGHT_PART + colour)
            .checked_sub(accumulator)
            .filter(|bits| *bits > 0)?;
        let fits = transmittance <= SHARE
            && (1 << transmittance >> share.bits) <= light
            && LIGHT_PART + colour <= 27;
        fits.then(|| Products {
            opacity,
            opacity_min,
            share,
            peak: (((peak + 1) << opacity.bits).min(16 << widths.peak) - 1).min(u32::MAX.into())
                as u32,
            raise: SHARE + 3 - transmittance,
            // As a signed half of a word.
            colour: (16 << colour).min(1 << 15) - 1,
            sum,
            sum_half: match rounding {
                Rounding::Nearest => 1 << sum >> 1,
                Rounding::Truncate => 0,
            },
            largest_sum: 16 << accumulator,
        })
    }
}

impl PixelFormat for Products {
    type Word = u32;

    #[inline(always)]
    fn words(&self, pixel: Pixel) -> [u32; 4] {
        let [r, g, b] = pixel.colour.map(|sum| (sum << self.sum) | self.sum_half);
        [pixel.transmittance, r, g, b]
    }

    fn holds(&self, pixel: Pixel) -> bool {
        pixel.colour.iter().all(|sum| *sum <= self.largest_sum)
    }

    #[inline(always)]
    fn pixel(&self, [transmittance, colour @ ..]: [u32; 4]) -> Pixel {
        const { assert!(<u32 as CellWord>::MARK == FINISHED) };
        Pixel {
            transmittance,
            colour: colour.map(|sum| sum >> self.sum),
        }
    }
}
