//! Compositing of one splat into one pixel, with a deep alpha channel.
//!
//! The pixel keeps its transmittance T in UQ1.transmittance and its colour, premultiplied, in UQ4.accumulator. Front to back
//! (\[EWA\] eq. 5, \[HYBRID\] 4.1) the contribution g = T alpha is computed once and both T' = T - g and C' = C + g c use it, so
//! that the shares and the last T sum to 1 without any rounding error, however many layers there are. \[SWAN\] 6 asks
//! for a channel deep enough that very transparent splats still move it: that is the width of T.
//!
//! Decisions have no side. Where a footprint ends by its opacity, its cut-off is computed from the unrounded peak, and the comparison of the
//! radial index with it decides ([`cutoff`](crate::setup::cutoff)). Elsewhere a splat is skipped by its opacity before rounding, the product
//! of peak and kernel, against a threshold with [`GUARD`] bits below opacity's last: compared after rounding, all opacities within half a unit
//! below the threshold would be drawn, and a deep stack would come out too opaque. A pixel stops at the transmittance whose rounding interval ends nearest to the threshold, so that
//! stopping early and late are as likely.

pub mod deep;
pub mod edge;
pub mod layers;
pub mod points;
pub mod resolve;
pub mod shading;
pub mod sheets;
pub mod surface;

use crate::format::{Rounding, Widths};
use crate::kernel::Kernel;
use crate::math::shift_unsigned;
use crate::rules::{Cutoff, Rules, THRESHOLD};

/// One pixel of the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Pixel {
    /// Linear red, green, blue, premultiplied, UQ4.accumulator, saturating.
    pub colour: [u32; 3],
    /// Transmittance, UQ1.transmittance; [`FINISHED`] marks a pixel that takes no more splats.
    pub transmittance: u32,
}

/// Bits below opacity's last one with which opacities are compared before they are rounded.
///
/// The offset that is left is at most `2^-8` of the unit instead of half of it; with 7 bits a multiplication of 32 bits still suffices wherever
/// the product does.
pub const GUARD: i32 = 7;

/// Flag in [`Pixel::transmittance`].
pub const FINISHED: u32 = 1 << 31;

impl Pixel {
    /// Opaque black: what memory lent for pixels can be filled with; all bits are 0, so that a static of it takes no flash.
    pub const EMPTY: Pixel = Pixel {
        colour: [0; 3],
        transmittance: 0,
    };

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
    pub const fn transmittance(&self) -> u32 {
        self.transmittance & !FINISHED
    }
}

/// The constants of compositing: rules brought to the design's widths. One per picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blend {
    alpha_max: u32,
    opacity_min: u64,
    minimum_transmittance: u32,
    omit_finishing: bool,
    rounding: Rounding,
    /// Right shifts of the four products.
    opacity_shift: i32,
    contribution_shift: i32,
    colour_shift: i32,
    layer_shift: i32,
    /// Products that fit 32 bits, see [`Blend::product`].
    opacity_narrow: bool,
    contribution_narrow: bool,
    colour_narrow: bool,
    /// No sum of shares times colours leaves 32 bits: the shares sum to at most 1, so that it stays below 16 plus one unit per layer.
    sums_fit: bool,
}

/// The constants of front-to-back compositing, for implementations that blend many pixels at once: [`Blend`] stays their definition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlendConstants {
    /// Largest opacity, UQ1.alpha, at most 1.
    pub alpha_max: u32,
    /// Splats are skipped where peak (UQ4.peak) times kernel (UQ1.weight) is less: UQ4.(peak + weight), at least what rounds to one unit
    /// of alpha. All but [`GUARD`] of the bits that rounding drops are 0.
    pub opacity_min: u64,
    /// A pixel is finished when its transmittance is at most this, UQ1.transmittance.
    pub minimum_transmittance: u32,
    /// The splat that would bring the transmittance to `minimum_transmittance` is itself left out.
    pub omit_finishing: bool,
    /// Rounding of the three products.
    pub rounding: Rounding,
    /// Right shift of peak (UQ4.peak) times kernel (UQ1.weight), to UQ1.alpha.
    pub opacity_shift: i32,
    /// Right shift of transmittance times opacity, to UQ1.transmittance.
    pub contribution_shift: i32,
    /// Right shift of contribution (UQ1.transmittance) times colour (UQ4.colour), to UQ4.accumulator.
    pub colour_shift: i32,
}

impl Blend {
    /// The constants of [`Blend::opacity`] and [`Blend::front_to_back`].
    #[inline(always)]
    pub const fn constants(&self) -> BlendConstants {
        BlendConstants {
            alpha_max: self.alpha_max,
            opacity_min: self.opacity_min,
            minimum_transmittance: self.minimum_transmittance,
            omit_finishing: self.omit_finishing,
            rounding: self.rounding,
            opacity_shift: self.opacity_shift,
            contribution_shift: self.contribution_shift,
            colour_shift: self.colour_shift,
        }
    }

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
        // A Gaussian's cut-off has decided already.
        let least = match (rules.cutoff, rules.kernel) {
            (Cutoff::Opacity, Kernel::Gaussian) => 0,
            _ => rules.alpha_min,
        };
        // Truncation adds no rounding constant.
        let unrounded = match widths.rounding {
            Rounding::Nearest => 0,
            Rounding::Truncate => 1,
        };
        Blend {
            // At most 1, so that a contribution never exceeds the transmittance.
            alpha_max: at_most(from_rules(rules.alpha_max, alpha), 1 << alpha),
            opacity_min: smallest_product(least, peak + weight, alpha, widths.rounding),
            minimum_transmittance: centred_minimum(rules.minimum_transmittance, transmittance),
            omit_finishing: rules.omit_finishing,
            rounding: widths.rounding,
            opacity_shift: peak + weight - alpha,
            contribution_shift: alpha,
            colour_shift: transmittance + colour - accumulator,
            layer_shift: alpha + colour - accumulator,
            // (2^(4 + peak) - 1) 2^weight and the rounding constant, which must be less than 2^weight.
            opacity_narrow: 4 + peak + weight <= 32 && peak <= alpha + unrounded,
            contribution_narrow: transmittance + alpha <= 31,
            colour_narrow: transmittance + 4 + colour <= 32 && colour <= accumulator + unrounded,
            // Without rounding (a shift of 0) not even that unit.
            sums_fit: accumulator <= 20 || transmittance + colour <= accumulator,
        }
    }

    /// Do all products of "over" fit 32 bits, and its sums stay below the word's end?
    pub const fn is_narrow(&self) -> bool {
        self.opacity_narrow && self.contribution_narrow && self.colour_narrow && self.sums_fit
    }

    /// Opacity of a splat at a pixel, UQ1.alpha: peak (UQ4.peak) times kernel (UQ1.weight), clamped; 0 if the rules skip it.
    #[inline(always)]
    pub fn opacity(&self, peak: u32, weight: u32) -> u32 {
        let opacity = self.opacity_product(peak, weight);
        if opacity < self.opacity_min {
            return 0;
        }
        let alpha = self.round(opacity, self.opacity_narrow, self.opacity_shift);
        alpha.min(self.alpha_max.into()) as u32
    }

    /// Peak times kernel, not yet rounded.
    #[inline(always)]
    fn opacity_product(&self, peak: u32, weight: u32) -> u64 {
        if self.opacity_narrow {
            peak.wrapping_mul(weight).into()
        } else {
            u64::from(peak) * u64::from(weight)
        }
    }

    /// Can the opacity of a splat with this peak (UQ4.peak) exceed the clamp? No kernel is above 1.
    #[inline(always)]
    pub fn is_clamped(&self, peak: u32, weight_bits: u8) -> bool {
        let one = 1 << weight_bits;
        self.product(peak, one, self.opacity_narrow, self.opacity_shift) > u64::from(self.alpha_max)
    }

    /// [`Blend::opacity`] of a splat that [is not clamped](Blend::is_clamped); `None` if the rules skip it.
    #[inline(always)]
    pub fn opacity_unclamped(&self, peak: u32, weight: u32) -> Option<u32> {
        let opacity = self.opacity_product(peak, weight);
        let alpha = self.round(opacity, self.opacity_narrow, self.opacity_shift) as u32;
        (opacity >= self.opacity_min).then_some(alpha)
    }

    /// "Over", nearest splat first. Alpha in UQ1.alpha and at most 1, colour in UQ4.colour. A finished pixel must not be passed.
    #[inline(always)]
    pub fn front_to_back(&self, pixel: &mut Pixel, alpha: u32, colour: &[u32; 3]) {
        self.over(pixel, alpha, colour, u32::saturating_sub);
    }

    /// The same where alpha comes from [`Blend::opacity`] and the pixel from [`Pixel::clear`]: alpha and T are at most 1, so that the
    /// contribution never exceeds T and nothing needs to saturate.
    #[inline(always)]
    pub fn front_to_back_of_opacity(&self, pixel: &mut Pixel, alpha: u32, colour: &[u32; 3]) {
        self.over(pixel, alpha, colour, u32::wrapping_sub);
    }

    #[inline(always)]
    fn over(
        &self,
        pixel: &mut Pixel,
        alpha: u32,
        colour: &[u32; 3],
        without: impl Fn(u32, u32) -> u32,
    ) {
        let Some((contribution, after)) = self.contribution(pixel, alpha, without) else {
            return;
        };
        for (sum, c) in pixel.colour.iter_mut().zip(colour) {
            let layer =
                self.product(contribution, *c, self.colour_narrow, self.colour_shift) as u32;
            *sum = if self.sums_fit {
                sum.wrapping_add(layer)
            } else {
                sum.saturating_add(layer)
            };
        }
        pixel.transmittance = after;
    }

    /// The contribution g = T alpha that a layer takes of the light, and the transmittance word after it. `None` where the rules leave out
    /// the layer that would finish the pixel; the pixel is then marked. `without` subtracts the contribution from T.
    #[inline(always)]
    fn contribution(
        &self,
        pixel: &mut Pixel,
        alpha: u32,
        without: impl Fn(u32, u32) -> u32,
    ) -> Option<(u32, u32)> {
        let transmittance = pixel.transmittance;
        let contribution = self.product(
            transmittance,
            alpha,
            self.contribution_narrow,
            self.contribution_shift,
        ) as u32;
        let rest = without(transmittance, contribution);
        let stop = rest <= self.minimum_transmittance;
        if stop && self.omit_finishing {
            pixel.transmittance |= FINISHED;
            return None;
        }
        Some((contribution, if stop { rest | FINISHED } else { rest }))
    }

    /// "Over", farthest splat first: C' = C - alpha C + alpha c, T' = T - alpha T.
    #[inline(always)]
    pub fn back_to_front(&self, pixel: &mut Pixel, alpha: u32, colour: &[u32; 3]) {
        let hidden = |value: u32| {
            self.shift(u64::from(value) * u64::from(alpha), self.contribution_shift) as u32
        };
        for (sum, c) in pixel.colour.iter_mut().zip(colour) {
            let layer = self.shift(u64::from(alpha) * u64::from(*c), self.layer_shift) as u32;
            *sum = sum.saturating_sub(hidden(*sum)).saturating_add(layer);
        }
        pixel.transmittance = pixel
            .transmittance
            .saturating_sub(hidden(pixel.transmittance));
    }

    /// Plain summation (\[SWAN\] 3.1): C' = C + alpha c; the alpha channel is 1 - T with T' = T - alpha, not below 0.
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

    /// Fraction bits of the transmittance, from the shifts: colour_shift - layer_shift = transmittance - alpha and contribution_shift = alpha.
    #[inline(always)]
    fn transmittance_bits(&self) -> i32 {
        (self.colour_shift - self.layer_shift + self.contribution_shift) & 31
    }

    /// `a b 2^-by`, rounded. `narrow` says that the product and its rounding constant fit 32 bits for all values within their
    /// formats: same result, and no 64-bit arithmetic where the processor has none. Values beyond their formats wrap.
    #[inline(always)]
    fn product(&self, a: u32, b: u32, narrow: bool, by: i32) -> u64 {
        if !narrow {
            return self.shift(u64::from(a) * u64::from(b), by);
        }
        self.round(a.wrapping_mul(b).into(), true, by)
    }

    /// The rounding of [`Blend::product`].
    #[inline(always)]
    fn round(&self, product: u64, narrow: bool, by: i32) -> u64 {
        if !narrow || by <= 0 || by > 31 {
            return self.shift(product, by);
        }
        let product = product as u32;
        let rounded = match self.rounding {
            Rounding::Nearest => product.wrapping_add(1 << (by - 1)),
            Rounding::Truncate => product,
        };
        (rounded >> by).into()
    }

    #[inline(always)]
    fn shift(&self, value: u64, by: i32) -> u64 {
        shift_unsigned(value, by, self.rounding)
    }
}

const fn at_most(value: u32, limit: u32) -> u32 {
    if value > limit { limit } else { value }
}

/// The smallest product, with `fraction` fraction bits, that is not skipped: not below the threshold, and not 0 after rounding to `alpha` bits.
const fn smallest_product(threshold: u64, fraction: i32, alpha: i32, rounding: Rounding) -> u64 {
    let dropped = fraction - alpha;
    // The bits of the product that are not looked at.
    let blind = if dropped > GUARD { dropped - GUARD } else { 0 };
    let drop = THRESHOLD as i32 - (fraction - blind);
    let least = shift_unsigned(threshold, drop, Rounding::Nearest) << blind;
    let visible = match (rounding, dropped) {
        (_, ..=0) => 1,
        (Rounding::Nearest, dropped) => 1 << (dropped - 1),
        (Rounding::Truncate, dropped) => 1 << dropped,
    };
    if least < visible { visible } else { least }
}

/// The largest transmittance (`fraction` fraction bits) that stops a pixel: the largest integer below the threshold. Words are rounded, so
/// that it stands for all transmittances up to half a unit more, and no other integer has its end nearer to the threshold.
const fn centred_minimum(threshold: u64, fraction: i32) -> u32 {
    let drop = (THRESHOLD as i32 - fraction) as u32;
    let above = threshold.saturating_add((1 << drop) - 1) >> drop;
    let below = above.saturating_sub(1);
    if below > u32::MAX as u64 {
        u32::MAX
    } else {
        below as u32
    }
}

/// UQ1.31 to UQ1.bits, rounded to nearest.
const fn from_rules(value: u32, bits: i32) -> u32 {
    shift_unsigned(value as u64, 31 - bits, Rounding::Nearest) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::{Classic8, Standard24};
    use proptest::prelude::*;

    /// Widths for which all three products are narrow, up to the limits of 32 bits.
    const NARROW: [Widths; 3] = [
        Classic8::WIDTHS,
        Widths {
            peak: 15,
            weight: 13,
            alpha: 15,
            transmittance: 16,
            colour: 10,
            accumulator: 16,
            ..Standard24::WIDTHS
        },
        Widths {
            peak: 12,
            weight: 16,
            alpha: 11,
            transmittance: 20,
            colour: 8,
            accumulator: 20,
            rounding: Rounding::Truncate,
            ..Standard24::WIDTHS
        },
    ];

    /// A product of exactly the least opacity is drawn, one less is not.
    #[test]
    fn the_least_opacity_is_drawn() {
        for widths in [Classic8::WIDTHS, Standard24::WIDTHS] {
            for rules in [Rules::EWA, Rules::GAUSSIAN_3D] {
                let blend = Blend::new(&widths, &rules);
                let least = blend.opacity_min as u32;
                assert!(blend.opacity_unclamped(least, 1).is_some());
                assert_eq!(blend.opacity_unclamped(least - 1, 1), None);
                assert_eq!(blend.opacity(least - 1, 1), 0);
            }
        }
    }

    proptest! {
        /// The oracle is the same blend with every shortcut switched off.
        #[test]
        fn shortcuts_change_no_bit(
            choice in 0..NARROW.len(), rules in prop_oneof![Just(Rules::EWA), Just(Rules::GAUSSIAN_3D)],
            layers in prop::collection::vec((any::<u32>(), any::<u32>(), any::<[u32; 3]>()), 1..50),
        ) {
            let widths = NARROW[choice];
            let fast = Blend::new(&widths, &rules);
            prop_assert!(fast.opacity_narrow && fast.contribution_narrow && fast.colour_narrow && fast.sums_fit);
            let wide = Blend { opacity_narrow: false, contribution_narrow: false, colour_narrow: false, sums_fit: false, ..fast };
            let (mut a, mut b) = (Pixel::clear(&widths), Pixel::clear(&widths));
            for (peak, weight, colour) in layers {
                // Half of all values lie at the end of their format.
                let value = |bits: u32, integer: u8, fraction: u8| {
                    let end = (1u64 << (integer + fraction)) - u64::from(integer > 0 && fraction < 28 && integer == 4);
                    if bits & 1 == 0 { end as u32 } else { (u64::from(bits >> 1) % (end + 1)) as u32 }
                };
                let (peak, weight) = (value(peak, 4, widths.peak), value(weight, 0, widths.weight));
                let colour = colour.map(|c| value(c, 4, widths.colour));
                let alpha = fast.opacity(peak, weight);
                prop_assert_eq!(alpha, wide.opacity(peak, weight));
                if alpha > 0 && !a.is_finished() {
                    fast.front_to_back(&mut a, alpha, &colour);
                    wide.front_to_back(&mut b, alpha, &colour);
                }
                prop_assert_eq!(a, b);
            }
        }
    }
}
