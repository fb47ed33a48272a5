//! A pixel with a deep alpha channel and colour of the same depth.
//!
//! The share of a layer is what the channel lost to it, `g = T - T'`, in every representation: shares and the last T
//! sum to 1 without error, as in [`Blend`](super::super::Blend). Colour C' = C + g c has the channel's width and
//! rounding, so that a picture shows what the width costs.

use super::{Channel, ChannelRounding, noise};

/// One pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeepPixel {
    /// Linear red, green, blue, premultiplied, UQ1.(width - 1), saturating below 2.
    pub colour: [u32; 3],
    /// The channel's word.
    pub alpha: u32,
}

impl DeepPixel {
    /// Transparent black.
    pub const fn clear(channel: &Channel) -> DeepPixel {
        DeepPixel {
            colour: [0; 3],
            alpha: channel.clear(),
        }
    }

    /// "Over", nearest layer first ([EWA] eq. 5): g = T - T', C' = C + g c.
    ///
    /// Alpha in UQ1.31, colour in UQ4.28 (clamped below 2), `place` and `layer` feed the dither. Colour saturates.
    #[inline]
    pub fn front_to_back(
        &mut self,
        channel: &Channel,
        alpha: u32,
        colour: &[u32; 3],
        place: [u16; 2],
        layer: u32,
    ) {
        let noise = dither(channel, place, layer);
        let before = channel.transmittance(self.alpha);
        self.alpha = channel.over(self.alpha, alpha, noise);
        let share = before.saturating_sub(channel.transmittance(self.alpha));
        for (turn, (sum, c)) in (1..).zip(self.colour.iter_mut().zip(colour)) {
            let light = scaled(channel, share, *c, noise.rotate_left(8 * turn));
            *sum = saturated(channel, u64::from(*sum) + light);
        }
    }

    /// "Over", farthest layer first: C' = C (1 - alpha) + alpha c, and the channel as front to back.
    ///
    /// The optical depth gives nothing here but the final alpha: colour needs the layer's own 1 - alpha, not T.
    #[inline]
    pub fn back_to_front(
        &mut self,
        channel: &Channel,
        alpha: u32,
        colour: &[u32; 3],
        place: [u16; 2],
        layer: u32,
    ) {
        let noise = dither(channel, place, layer);
        let alpha = alpha.min(super::ONE);
        self.alpha = channel.over(self.alpha, alpha, noise);
        for (turn, (sum, c)) in (1..).zip(self.colour.iter_mut().zip(colour)) {
            let noise = noise.rotate_left(8 * turn);
            let kept = channel.round(u64::from(*sum) * u64::from(super::ONE - alpha), 31, noise);
            let light = scaled(channel, alpha, *c, noise.rotate_left(4));
            *sum = saturated(channel, kept + light);
        }
    }
}

/// Dithering alone pays for the hash.
#[inline(always)]
fn dither(channel: &Channel, [x, y]: [u16; 2], layer: u32) -> u32 {
    match channel.rounding {
        ChannelRounding::Dither => noise(x, y, layer),
        _ => 0,
    }
}

/// Share (UQ1.31) times colour (UQ4.28), UQ1.(width - 1), by the channel's rounding.
#[inline(always)]
fn scaled(channel: &Channel, share: u32, colour: u32, noise: u32) -> u64 {
    let colour = colour.min((2 << 28) - 1);
    channel.round(
        u64::from(share) * u64::from(colour),
        31 + 28 - (u32::from(channel.width) - 1),
        noise,
    )
}

#[inline(always)]
fn saturated(channel: &Channel, sum: u64) -> u32 {
    sum.min(channel.deepest()) as u32
}
