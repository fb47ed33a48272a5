//! The deep alpha channel in depth (\[SWAN\] 6): how a pixel may remember what still shines through it.
//!
//! "An accumulation channel deep enough for very transparent splats" can be had in three representations, each with the
//! one operation that hardware would build for it:
//!
//! | representation | word of `width` bits | "over" with opacity alpha |
//! |---|---|---|
//! | opacity A | UQ1.(width - 1) | A' = A + round((1 - A) alpha) |
//! | transmittance T = 1 - A | UQ1.(width - 1) | T' = round(T (1 - alpha)) |
//! | optical depth D = -log2 T | UQ4.(width - 4) | D' = D + round(-log2(1 - alpha)) |
//!
//! Optical depth turns "over" into an addition (\[EWA\] eq. 4: the exponent is an integral) and makes it independent of
//! the order; base 2 instead of e is a constant factor and lets the exponential's integer part be a shift. Its tables
//! are in [`octaves`](mod@octaves). Rounding is to nearest, truncation, or dithered by a [`noise`] without state.
//! docs/systems.md derives how the error grows with the number of layers and which width follows.
//!
//! Opacity and transmittance under rounding to nearest hold the same number up to ties; under truncation the first errs
//! towards transparent, the second towards opaque. The kernel's own [`Blend`](super::Blend) subtracts a rounded share
//! from T, which is the opacity column.

mod noise;
pub mod octaves;
mod pixel;

pub use noise::noise;
pub use pixel::DeepPixel;

use crate::format::WidthError;

/// What the channel stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Representation {
    /// A, UQ1.(width - 1).
    Opacity,
    /// T = 1 - A, UQ1.(width - 1).
    Transmittance,
    /// D = -log2 T, UQ4.(width - 4), saturating: beyond 16 octaves a pixel is as good as opaque.
    OpticalDepth,
}

/// What happens to the bits below a kept result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChannelRounding {
    /// To nearest, halves up.
    Nearest,
    /// Towards zero.
    Truncate,
    /// Up with the probability of the dropped part, decided by a hash: no bias, whatever the opacity.
    Dither,
}

/// Smallest and largest width of the word.
pub const WIDTH_RANGE: (u8, u8) = (8, 32);

/// One, UQ1.31: the format in which opacities come in and transmittances go out.
pub const ONE: u32 = 1 << 31;

/// A complete choice of the channel. Constant for a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    representation: Representation,
    rounding: ChannelRounding,
    width: u8,
}

impl Channel {
    /// A channel with words of `width` bits, 8 to 32.
    pub const fn new(
        representation: Representation,
        rounding: ChannelRounding,
        width: u8,
    ) -> Result<Channel, WidthError> {
        if width < WIDTH_RANGE.0 || width > WIDTH_RANGE.1 {
            return Err(WidthError {
                field: "deep alpha",
                value: width,
                range: WIDTH_RANGE,
            });
        }
        Ok(Channel {
            representation,
            rounding,
            width,
        })
    }

    /// What is stored.
    pub const fn representation(&self) -> Representation {
        self.representation
    }

    /// How results are rounded.
    pub const fn rounding(&self) -> ChannelRounding {
        self.rounding
    }

    /// Bits of the word.
    pub const fn width(&self) -> u8 {
        self.width
    }

    /// Fraction bits of the word: `width - 1`, or `width - 4` for the optical depth.
    pub const fn fraction(&self) -> u32 {
        match self.representation {
            Representation::OpticalDepth => self.width as u32 - 4,
            _ => self.width as u32 - 1,
        }
    }

    /// The word of a fully transparent pixel.
    pub const fn clear(&self) -> u32 {
        match self.representation {
            Representation::Transmittance => 1 << self.fraction(),
            _ => 0,
        }
    }

    /// The word after one more layer of opacity `alpha` (UQ1.31, clamped to 1); `noise` is read by dithering alone.
    ///
    /// Symmetric in the order of layers up to rounding, so front to back and back to front are the same operation.
    /// Any word is defined: opacities and transmittances beyond 1 count as 1, the optical depth saturates.
    #[inline(always)]
    pub fn over(&self, word: u32, alpha: u32, noise: u32) -> u32 {
        let alpha = alpha.min(ONE);
        match self.representation {
            Representation::Opacity => {
                let opacity = word.min(1 << self.fraction());
                let rest = (1 << self.fraction()) - opacity;
                opacity + self.round(u64::from(rest) * u64::from(alpha), 31, noise) as u32
            }
            Representation::Transmittance => {
                let rest = word.min(1 << self.fraction());
                self.round(u64::from(rest) * u64::from(ONE - alpha), 31, noise) as u32
            }
            Representation::OpticalDepth => {
                let octaves = octaves::of_opacity(alpha);
                let step = self.round(octaves, octaves::FRACTION - self.fraction(), noise);
                self.deepest()
                    .min(u64::from(word).saturating_add(step))
                    .try_into()
                    .unwrap_or(u32::MAX)
            }
        }
    }

    /// What still shines through, UQ1.31, at most 1. Exact for opacity and transmittance; for the optical depth within
    /// `2^-30` ([`octaves::transmittance`]), and 0 where the word has saturated.
    #[inline(always)]
    pub fn transmittance(&self, word: u32) -> u32 {
        let one = 1 << self.fraction();
        match self.representation {
            Representation::Opacity => (one - word.min(one)) << (31 - self.fraction()),
            Representation::Transmittance => word.min(one) << (31 - self.fraction()),
            Representation::OpticalDepth if u64::from(word) >= self.deepest() => 0,
            Representation::OpticalDepth => octaves::transmittance(word, self.fraction()),
        }
    }

    /// The largest word of `width` bits.
    const fn deepest(&self) -> u64 {
        (1 << self.width) - 1
    }

    /// `value / 2^shift` by the channel's rounding; `shift` 1 to 63, and the sum with the noise fits by the callers'
    /// ranges.
    #[inline(always)]
    fn round(&self, value: u64, shift: u32, noise: u32) -> u64 {
        let addend = match self.rounding {
            ChannelRounding::Nearest => 1 << (shift - 1),
            ChannelRounding::Truncate => 0,
            ChannelRounding::Dither if shift <= 32 => u64::from(noise >> (32 - shift)),
            ChannelRounding::Dither => u64::from(noise) << (shift - 32),
        };
        value.saturating_add(addend) >> shift
    }
}

#[cfg(test)]
mod tests;
