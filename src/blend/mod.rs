//! Compositing of one splat into one pixel, with a deep alpha channel.
//!
//! The pixel keeps its transmittance T in UQ1.transmittance and its colour, premultiplied, in UQ4.accumulator. Front to back
//! ([EWA] eq. 5, [HYBRID] 4.1) the share g = T alpha is computed once and both T' = T - g and C' = C + g c use it, so
//! that the shares and the last T sum to 1 without any rounding error, however many layers there are. [SWAN] 6 asks
//! for a channel deep enough that very transparent splats still move it: that is the width of T.

pub mod deep;
pub mod sheets;

use crate::format::{Rounding, Widths};
use crate::math::shift_unsigned;
use crate::rules::Rules;

/// One pixel of the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Pixel {
    /// Linear red, green, blue, premultiplied, UQ4.accumulator, saturating.
    pub colour: [u32; 3],
    /// Transmittance, UQ1.transmittance; [`FINISHED`] marks a pixel that takes no more splats.
    pub transmittance: u32,
}

/// Flag in [`Pixel::transmittance`].
pub const FINISHED: u32 = 1 << 31;

impl Pixel {
    /// Transparent black.
    pub const fn clear(widths: &Widths) -> Pixel {
        Pixel {
            colour: [0; 3],
            transmittance: 1 << widths.transmittance,
        }
    }

    /// Does it take no more splats?
    #[inline(always)]
    pub const fn is_finished(&self) -> bool {
        self.transmittance & FINISHED != 0
    }

    /// Transmittance without the flag, UQ1.transmittance.
    #[inline(always)]
    pub const fn clear_share(&self) -> u32 {
        self.transmittance & !FINISHED
    }
}

/// The constants of compositing: rules brought to the design's widths. One per picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blend {
    alpha_max: u32,
    alpha_min: u32,
    stop: u32,
    stop_before: bool,
    rounding: Rounding,
    /// Right shifts of the four products.
    opacity_shift: i32,
    share_shift: i32,
    colour_shift: i32,
    layer_shift: i32,
}

impl Blend {
    /// Rules and widths brought together.
    #[inline(always)]
    pub const fn new(widths: &Widths, rules: &Rules) -> Blend {
        let [peak, weight, alpha, transmittance, colour, accumulator] = [
            widths.peak as i32,
            widths.weight as i32,
            widths.alpha as i32,
            widths.transmittance as i32,
            widths.colour as i32,
            widths.accumulator as i32,
        ];
        Blend {
            alpha_max: from_rules(rules.alpha_max, alpha),
            alpha_min: from_rules(rules.alpha_min, alpha),
            stop: from_rules(rules.stop, transmittance),
            stop_before: rules.stop_before,
            rounding: widths.rounding,
            opacity_shift: peak + weight - alpha,
            share_shift: alpha,
            colour_shift: transmittance + colour - accumulator,
            layer_shift: alpha + colour - accumulator,
        }
    }

    /// Opacity of a splat at a pixel, UQ1.alpha: peak (UQ4.peak) times kernel (UQ1.weight), clamped; 0 if the rules skip it.
    #[inline(always)]
    pub fn opacity(&self, peak: u32, weight: u32) -> u32 {
        let alpha = self.shift(u64::from(peak) * u64::from(weight), self.opacity_shift);
        let alpha = alpha.min(self.alpha_max.into()) as u32;
        if alpha < self.alpha_min { 0 } else { alpha }
    }

    /// "Over", nearest splat first. Alpha in UQ1.alpha, colour in UQ4.colour. A finished pixel must not be passed.
    #[inline(always)]
    pub fn front_to_back(&self, pixel: &mut Pixel, alpha: u32, colour: &[u32; 3]) {
        let share = self.shift(
            u64::from(pixel.transmittance) * u64::from(alpha),
            self.share_shift,
        ) as u32;
        let rest = pixel.transmittance.saturating_sub(share);
        let stop = rest <= self.stop;
        if stop && self.stop_before {
            pixel.transmittance |= FINISHED;
            return;
        }
        for (sum, c) in pixel.colour.iter_mut().zip(colour) {
            *sum = sum.saturating_add(
                self.shift(u64::from(share) * u64::from(*c), self.colour_shift) as u32,
            );
        }
        pixel.transmittance = if stop { rest | FINISHED } else { rest };
    }

    /// "Over", farthest splat first: C' = C - alpha C + alpha c, T' = T - alpha T.
    #[inline(always)]
    pub fn back_to_front(&self, pixel: &mut Pixel, alpha: u32, colour: &[u32; 3]) {
        let hidden =
            |value: u32| self.shift(u64::from(value) * u64::from(alpha), self.share_shift) as u32;
        for (sum, c) in pixel.colour.iter_mut().zip(colour) {
            let layer = self.shift(u64::from(alpha) * u64::from(*c), self.layer_shift) as u32;
            *sum = sum.saturating_sub(hidden(*sum)).saturating_add(layer);
        }
        pixel.transmittance = pixel
            .transmittance
            .saturating_sub(hidden(pixel.transmittance));
    }

    /// Plain summation ([SWAN] 3.1): C' = C + alpha c; the alpha channel is 1 - T with T' = T - alpha, not below 0.
    #[inline(always)]
    pub fn x_ray(&self, pixel: &mut Pixel, alpha: u32, colour: &[u32; 3]) {
        for (sum, c) in pixel.colour.iter_mut().zip(colour) {
            *sum = sum.saturating_add(
                self.shift(u64::from(alpha) * u64::from(*c), self.layer_shift) as u32,
            );
        }
        pixel.transmittance = pixel
            .transmittance
            .saturating_sub(self.in_transmittance(alpha));
    }

    #[inline(always)]
    fn in_transmittance(&self, alpha: u32) -> u32 {
        // colour_shift - layer_shift = transmittance - alpha.
        self.shift(alpha.into(), self.layer_shift - self.colour_shift) as u32
    }

    #[inline(always)]
    fn shift(&self, value: u64, by: i32) -> u64 {
        shift_unsigned(value, by, self.rounding)
    }
}

/// UQ1.31 to UQ1.bits, rounded to nearest.
const fn from_rules(value: u32, bits: i32) -> u32 {
    shift_unsigned(value as u64, 31 - bits, Rounding::Nearest) as u32
}
