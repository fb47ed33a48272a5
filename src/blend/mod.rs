//! Compositing of one splat into one pixel, with a deep alpha channel.
//!
//! The pixel keeps its transmittance T in UQ1.transmittance and its colour, premultiplied, in UQ4.accumulator. Front to
//! back (\[EWA\] eq. 5, \[HYBRID\] 4.1) the contribution g = T alpha is computed once and both T' = T - g and C' = C +
//! g c use it, so that the shares and the last T sum to 1 without any rounding error, however many layers there are.
//! \[SWAN\] 6 asks for a channel deep enough that very transparent splats still move it: that is the width of T.
//!
//! Decisions have no side. Where a footprint ends by its opacity, its cut-off is computed from the unrounded peak, and
//! the comparison of the radial index with it decides ([`cutoff`](crate::setup::cutoff)). Elsewhere a splat is skipped
//! by its opacity before rounding, the product of peak and kernel, against a threshold with [`GUARD`] bits below
//! opacity's last: compared after rounding, all opacities within half a unit below the threshold would be drawn, and a
//! deep stack would come out too opaque. A pixel stops at the transmittance whose rounding interval ends nearest to the
//! threshold, so that stopping early and late are as likely.
//!
//! # One product, one multiply-add
//!
//! Let p, w, a, t, c and s be the fraction bits of peak, kernel, opacity, transmittance, colour and sum, n the integer
//! bits of the last two ([`Widths::colour_range`]), and \[x\] the integer nearest to x, halves to even
//! ([`Rounding::NearestEven`]). All words are integers, and one pixel of "over" is
//!
//! ```text
//! A  = min([P W 2^-(p+w-a)], A_max)         opacity        P < 2^(4+p), W <= 2^w
//! G  = [T A 2^-a]                           contribution   T <= 2^t,    A <= 2^a
//! T' = T - G
//! C' = [C + G K 2^-(t+c-s)]                 each colour    K < 2^(n+c)
//! ```
//!
//! The sum is what is rounded, so that its ties go to even sums; without ties to even that is C + \[G K 2^-(t+c-s)\].
//! Two facts hold for every rounding:
//!
//! - G <= T, because A 2^-a <= 1 and rounding does not pass an integer. T never rises and never falls below 0.
//! - Where s + n >= t, C <= 2^(n+s) (1 - T 2^-t): the product is at most G 2^(n+s-t), an integer, which rounding does
//!   not pass. So sums never leave UQn.s, whatever the number of layers, and nothing saturates.
//!
//! A fused multiply-add of single precision is exact before it rounds, once, to 24 bits, halves to even. From 2^23 to
//! 2^24 its unit is 1. So with M = 2^23 each line above is one of them, `fma(P 2^-(p+w-a), W, M)`, `fma(T 2^-a, A, M)`
//! and `fma(G, K 2^-(t+c-s), M + C)`, where factors have at most 24 bits (4 + p, w, t + 1, a + 1, n + c + 1) and
//! results at most 2^23 (4 + a, t and n + s bits). [`Blend::is_single`] is that condition;
//! [`Lean18`](crate::format::Lean18) is the named design that meets it. Its kernel, opacity and colour have 18 bits, so
//! that one operand of every product also fits a multiplier of 18 bits, the other one has 22.

pub mod deep;
pub mod edge;
pub mod layers;
pub mod points;
mod product;
pub mod resolve;
pub mod shading;
pub mod sheets;
pub mod surface;

use crate::format::{Rounding, Widths};
use crate::kernel::Kernel;
use crate::math::shift_unsigned;
use crate::rules::{Cutoff, Rules, THRESHOLD};
use product::{Product, Words};

/// One pixel of the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Pixel {
    /// Linear red, green, blue, premultiplied, UQ4.accumulator.
    pub colour: [u32; 3],
    /// Transmittance, UQ1.transmittance; [`FINISHED`] marks a pixel that takes no more splats.
    pub transmittance: u32,
}

/// Bits below opacity's last one with which opacities are compared before they are rounded.
///
/// The offset that is left is at most `2^-8` of the unit instead of half of it; with 7 bits a multiplication of 32 bits
/// still suffices wherever the product does.
pub const GUARD: i32 = 7;

/// Flag in [`Pixel::transmittance`].
pub const FINISHED: u32 = 1 << 31;

impl Pixel {
    /// Opaque black: what memory lent for pixels can be filled with; all bits are 0, so that a static of it takes no
    /// flash.
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
    /// Does an opacity count unless it rounds to 0?
    all_visible: bool,
    opacity: Product,
    contribution: Product,
    colour: Product,
    /// Right shift of opacity times colour.
    layer_shift: i32,
    /// Sums stay in their format, see [above](self).
    sums_fit: bool,
    /// See [`Blend::is_single`].
    single: bool,
}

/// The constants of front-to-back compositing, for implementations that blend many pixels at once: [`Blend`] stays
/// their definition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlendConstants {
    /// Largest opacity, UQ1.alpha, at most 1.
    pub alpha_max: u32,
    /// Splats are skipped where peak (UQ4.peak) times kernel (UQ1.weight) is less: UQ4.(peak + weight), at least what
    /// rounds to one unit of alpha. All but [`GUARD`] of the bits that rounding drops are 0.
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
            opacity_shift: self.opacity.by(),
            contribution_shift: self.contribution.by(),
            colour_shift: self.colour.by(),
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
        let opacity_min = smallest_product(least, peak + weight, alpha, widths.rounding);
        let visible = smallest_product(0, peak + weight, alpha, widths.rounding);
        let range = widths.colour_range() as i32;
        let even = matches!(widths.rounding, Rounding::NearestEven);
        Blend {
            // At most 1, so that a contribution never exceeds the transmittance.
            alpha_max: at_most(from_rules(rules.alpha_max, alpha), 1 << alpha),
            opacity_min,
            all_visible: opacity_min == visible,
            minimum_transmittance: centred_minimum(rules.minimum_transmittance, transmittance),
            omit_finishing: rules.omit_finishing,
            rounding: widths.rounding,
            opacity: Product::new(
                [below_16(peak), 1 << weight],
                peak + weight - alpha,
                widths.rounding,
            ),
            contribution: Product::new([1 << transmittance, 1 << alpha], alpha, widths.rounding),
            colour: Product::new(
                [1 << transmittance, below_16(colour) >> (4 - range)],
                transmittance + colour - accumulator,
                widths.rounding,
            ),
            layer_shift: alpha + colour - accumulator,
            sums_fit: accumulator + range >= transmittance,
            single: even
                && peak <= 20
                && weight <= 24
                && alpha <= 19
                && transmittance <= 23
                && colour + range <= 23
                && accumulator + range <= 23
                && accumulator + range >= transmittance
                && peak + weight > alpha
                && transmittance + colour > accumulator,
        }
    }

    /// Do all products of "over" need no more than multiplications of 32 bits by 32 to 32, and its sums stay below the
    /// word's end?
    pub const fn is_narrow(&self) -> bool {
        self.sums_fit
            && !matches!(self.opacity.words, Words::Wide)
            && !matches!(self.contribution.words, Words::Wide)
            && !matches!(self.colour.words, Words::Wide)
    }

    /// Is every product of "over", with its rounding and its addition, one fused multiply-add of single precision
    /// ([above](self))?
    pub const fn is_single(&self) -> bool {
        self.single
    }

    /// Is every opacity drawn that does not round to 0?
    pub const fn draws_all_visible(&self) -> bool {
        self.all_visible
    }

    /// Opacity of a splat at a pixel, UQ1.alpha: peak (UQ4.peak) times kernel (UQ1.weight), clamped; 0 if the rules
    /// skip it.
    #[inline(always)]
    pub fn opacity(&self, peak: u32, weight: u32) -> u32 {
        if self.is_skipped(peak, weight) {
            return 0;
        }
        self.opacity.of(peak, weight).min(self.alpha_max.into()) as u32
    }

    /// Is the product of peak and kernel, not yet rounded, below a threshold that does not follow from rounding?
    #[inline(always)]
    fn is_skipped(&self, peak: u32, weight: u32) -> bool {
        if self.all_visible {
            return false;
        }
        let product = match self.opacity.words {
            Words::One => peak.wrapping_mul(weight).into(),
            _ => u64::from(peak) * u64::from(weight),
        };
        product < self.opacity_min
    }

    /// Can the opacity of a splat with this peak (UQ4.peak) exceed the clamp? No kernel is above 1, which has
    /// `weight_bits` fraction bits: the widths' (at most 28; of others the low five bits count).
    #[inline(always)]
    pub fn is_clamped(&self, peak: u32, weight_bits: u8) -> bool {
        let one = 1u32.wrapping_shl(weight_bits.into());
        self.opacity.of(peak, one) > u64::from(self.alpha_max)
    }

    /// [`Blend::opacity`] of a splat that [is not clamped](Blend::is_clamped).
    #[inline(always)]
    pub fn opacity_unclamped(&self, peak: u32, weight: u32) -> u32 {
        if self.is_skipped(peak, weight) {
            return 0;
        }
        self.opacity.of(peak, weight) as u32
    }

    /// "Over", nearest splat first. Alpha in UQ1.alpha and at most 1, colour in UQ4.colour. A finished pixel must not
    /// be passed.
    #[inline(always)]
    pub fn front_to_back(&self, pixel: &mut Pixel, alpha: u32, colour: &[u32; 3]) {
        self.over(pixel, alpha, colour, u32::saturating_sub);
    }

    /// The same where alpha comes from [`Blend::opacity`] and the pixel from [`Pixel::clear`]: alpha and T are at most
    /// 1, so that the contribution never exceeds T and nothing needs to saturate.
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
            let layer = self.colour.added_to(*sum, contribution, *c) as u32;
            *sum = if self.sums_fit {
                sum.wrapping_add(layer)
            } else {
                sum.saturating_add(layer)
            };
        }
        pixel.transmittance = after;
    }

    /// The contribution g = T alpha that a layer takes of the light, and the transmittance word after it. `None` where
    /// the rules leave out the layer that would finish the pixel; the pixel is then marked. `without` subtracts the
    /// contribution from T.
    #[inline(always)]
    fn contribution(
        &self,
        pixel: &mut Pixel,
        alpha: u32,
        without: impl Fn(u32, u32) -> u32,
    ) -> Option<(u32, u32)> {
        let transmittance = pixel.transmittance;
        let contribution = self.contribution.of(transmittance, alpha) as u32;
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
            self.shift(u64::from(value) * u64::from(alpha), self.contribution.by()) as u32
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
        // The shifts of colour and layer differ by transmittance - alpha.
        self.shift(alpha.into(), self.layer_shift - self.colour.by()) as u32
    }

    /// Fraction bits of the transmittance, from the shifts: those of colour and layer differ by transmittance - alpha,
    /// the contribution's is alpha.
    #[inline(always)]
    fn transmittance_bits(&self) -> i32 {
        (self.colour.by() - self.layer_shift + self.contribution.by()) & 31
    }

    #[inline(always)]
    fn shift(&self, value: u64, by: i32) -> u64 {
        shift_unsigned(value, by, self.rounding)
    }
}

/// The largest number below 16 with so many fraction bits, up to 28.
const fn below_16(fraction: i32) -> u32 {
    u32::MAX >> (28 - fraction)
}

const fn at_most(value: u32, limit: u32) -> u32 {
    if value > limit { limit } else { value }
}

/// The smallest product, with `fraction` fraction bits, that is not skipped: not below the threshold, and not 0 after
/// rounding to `alpha` bits.
const fn smallest_product(threshold: u64, fraction: i32, alpha: i32, rounding: Rounding) -> u64 {
    let dropped = fraction - alpha;
    // The bits of the product that are not looked at.
    let blind = if dropped > GUARD { dropped - GUARD } else { 0 };
    let drop = THRESHOLD as i32 - (fraction - blind);
    let least = shift_unsigned(threshold, drop, Rounding::Nearest) << blind;
    let visible = match (rounding, dropped) {
        (_, ..=0) => 1,
        (Rounding::Nearest, dropped) => 1 << (dropped - 1),
        // The half itself goes to 0.
        (Rounding::NearestEven, dropped) => (1 << (dropped - 1)) + 1,
        (Rounding::Truncate, dropped) => 1 << dropped,
    };
    if least < visible { visible } else { least }
}

/// The largest transmittance (`fraction` fraction bits) that stops a pixel: the largest integer below the threshold.
/// Words are rounded, so that it stands for all transmittances up to half a unit more, and no other integer has its end
/// nearer to the threshold.
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
mod tests;
