//! The accumulation buffer with normalisation (SURF 4, eq. 9): weighted sums per pixel, divided by the weight sum at
//! the end.
//!
//! A pixel of a surface is sum w_k a_k / sum w_k for every attribute a (premultiplied colour, opacity, normal). Sums
//! are integers, so they are the same in any order of drawing, to the last bit. Whether a splat belongs to the same
//! surface as the pixel's sums is decided by the depth of its tangent plane and a threshold (SURF 4): near enough, it
//! is accumulated; nearer than that, it replaces them; farther, it is discarded.
//!
//! Formats: the weight sum is UQ7.f and the normal sum Q7.f with f = min(accumulator, 24), colour and opacity sums
//! UQ7.f. Weights are rounded to f bits first and the rounded weight multiplies all attributes, so that a constant
//! attribute is reproduced to half a unit. A fragment whose weight sum would reach 128 takes no more: its average stays
//! what it is.

use crate::footprint::surface::{Attributes, attribute_fraction};
use crate::format::{Rounding, Widths};
use crate::math::{Product, SoftFloat, reciprocal, shift_round, shift_unsigned};

/// Fraction bits of a fragment's sums.
pub const fn sum_fraction(widths: &Widths) -> u8 {
    if widths.accumulator < 24 {
        widths.accumulator
    } else {
        24
    }
}

/// Weighted sums of what belongs to one surface at one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Fragment {
    /// Sum of the weights, UQ7.f; 0 marks an empty fragment.
    pub weight: u32,
    /// Weighted premultiplied red, green, blue, UQ7.f.
    pub colour: [u32; 3],
    /// Weighted opacity, UQ7.f.
    pub opacity: u32,
    /// Weighted normal in camera space, Q7.f.
    pub normal: [i32; 3],
    /// Least depth of what was accumulated, UQ9.23 scene units.
    pub near: u32,
    /// Greatest depth of what was accumulated, UQ9.23 scene units.
    pub far: u32,
    /// Material of the nearest sample, the smaller one if two are equally near.
    pub material: u8,
}

impl Fragment {
    /// Nothing accumulated.
    pub const EMPTY: Fragment = Fragment {
        weight: 0,
        colour: [0; 3],
        opacity: 0,
        normal: [0; 3],
        near: 0,
        far: 0,
        material: 0,
    };
}

/// One splat at one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample<'a> {
    /// Weight, UQ1.f, not 0.
    pub weight: u32,
    /// Depth of the tangent plane, UQ9.23 scene units.
    pub depth: u32,
    /// What is filtered.
    pub attributes: &'a Attributes,
}

/// The attributes of a fragment divided by its weight sum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Filtered {
    /// Premultiplied red, green, blue, UQ4.accumulator, at most 1 before shading.
    pub colour: [u32; 3],
    /// Opacity, UQ1.accumulator, at most 1.
    pub opacity: u32,
    /// Normal in camera space, Q1.30; shorter than 1 where normals differ.
    pub normal: [i32; 3],
    /// Row of the material table.
    pub material: u8,
}

/// The constants of gathering, one per picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeightedSum {
    /// Depth differences up to this belong to one surface, UQ9.23 scene units.
    pub threshold: u32,
    fraction: i32,
    alpha: i32,
    attribute: i32,
    accumulator: u32,
    mantissa: u32,
    rounding: Rounding,
}

impl WeightedSum {
    /// Widths and depth threshold (UQ9.23 scene units) brought together.
    pub const fn new(widths: &Widths, threshold: u32) -> WeightedSum {
        WeightedSum {
            threshold,
            fraction: sum_fraction(widths) as i32,
            alpha: widths.alpha as i32,
            attribute: attribute_fraction(widths) as i32,
            accumulator: widths.accumulator as u32,
            mantissa: widths.mantissa as u32,
            // Ties to even are for fused products of a pixel's colours; these sums have more bits.
            rounding: match widths.rounding {
                Rounding::NearestEven => Rounding::Nearest,
                rounding => rounding,
            },
        }
    }

    /// A splat's opacity at a pixel, UQ1.alpha, as the weight of a [`Sample`], UQ1.f.
    #[inline(always)]
    pub fn weight(&self, alpha: u32) -> u32 {
        shift_unsigned(alpha.into(), self.alpha - self.fraction, self.rounding) as u32
    }

    /// Adds a sample to the sums. A full fragment (weight sum 128) stays as it is.
    #[inline(always)]
    pub fn accumulate(&self, fragment: &mut Fragment, sample: &Sample) {
        let weight = u64::from(fragment.weight) + u64::from(sample.weight);
        if weight >> 31 != 0 {
            return;
        }
        let material = (sample.depth, sample.attributes.material);
        if fragment.weight == 0 || material < (fragment.near, fragment.material) {
            fragment.near = sample.depth;
            fragment.material = sample.attributes.material;
        }
        fragment.weight = weight as u32;
        let share = |value: u32| self.share(sample.weight, value);
        for (sum, value) in fragment.colour.iter_mut().zip(sample.attributes.colour) {
            *sum = sum.saturating_add(share(value));
        }
        fragment.opacity = fragment
            .opacity
            .saturating_add(share(sample.attributes.opacity));
        for (sum, value) in fragment.normal.iter_mut().zip(sample.attributes.normal) {
            let magnitude = share(value.unsigned_abs()) as i32;
            *sum = sum.saturating_add(if value < 0 { -magnitude } else { magnitude });
        }
        fragment.far = fragment.far.max(sample.depth);
    }

    /// Weight (UQ1.f) times attribute (UQ1 with the attributes' fraction), UQ1.f; below 2^31 for attributes up to 1.
    #[inline(always)]
    fn share(&self, weight: u32, value: u32) -> u32 {
        let product = u64::from(weight) * u64::from(value);
        shift_unsigned(product, self.attribute, self.rounding).min(i32::MAX as u64) as u32
    }

    /// Division by the weight sum (SURF eq. 9) through the reciprocal unit; an empty fragment is transparent.
    ///
    /// Relative error 2^-mantissa of the reciprocal, rounded to nearest to the result's format.
    pub fn normalise(&self, fragment: &Fragment) -> Filtered {
        let sum = SoftFloat::from_wide(fragment.weight.into(), 0, 31);
        let Some(inverse) = reciprocal(sum, self.mantissa) else {
            return Filtered::default();
        };
        let divide = |value: i64, fraction: u32| {
            let one = 1i64 << fraction;
            let quotient = Product::new(value * i64::from(inverse.mantissa), inverse.exponent);
            quotient.to_fixed(fraction).clamp(-one, one)
        };
        let unit = |value: u32| divide(value.min(i32::MAX as u32).into(), self.accumulator) as u32;
        Filtered {
            colour: fragment.colour.map(unit),
            opacity: unit(fragment.opacity),
            normal: fragment.normal.map(|n| divide(n.into(), 30) as i32),
            material: fragment.material,
        }
    }

    /// 1.0 in UQ1.accumulator.
    pub(super) fn one(&self) -> i64 {
        1 << self.accumulator
    }

    /// `value` times `unit` (UQ1.accumulator), rounded to nearest; exact products below 2^62 for values up to 2^31.
    pub(super) fn times_unit(&self, value: i64, unit: i64) -> i64 {
        shift_round(value.wrapping_mul(unit), self.accumulator)
    }

    /// A fragment of weight sum `weight` (UQ7.f) whose division gives `filtered` back, within a unit of the sums.
    pub(super) fn weigh(&self, filtered: &Filtered, weight: u32) -> Fragment {
        let times = |value: i64, fraction: u32| {
            shift_round(value * i64::from(weight.min(i32::MAX as u32)), fraction)
        };
        let unit = |value: u32| times(value.into(), self.accumulator).clamp(0, u32::MAX.into());
        Fragment {
            weight,
            colour: filtered.colour.map(|c| unit(c) as u32),
            opacity: unit(filtered.opacity) as u32,
            normal: filtered.normal.map(|n| times(n.into(), 30) as i32),
            material: filtered.material,
            ..Fragment::default()
        }
    }
}

/// What a pixel of a surface target gathers its samples into.
pub trait Cell: Clone {
    /// Nothing gathered yet.
    const EMPTY: Self;
    /// Takes one sample.
    fn add(&mut self, gather: &WeightedSum, sample: &Sample);
    /// What was gathered, nearest first, without empty fragments.
    fn fragments(&self) -> &[Fragment];
}

/// One surface per pixel: the accumulation buffer of SURF 4, for opaque scenes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Accumulation {
    fragment: [Fragment; 1],
}

impl Cell for Accumulation {
    const EMPTY: Self = Accumulation {
        fragment: [Fragment::EMPTY],
    };

    /// Accumulate, replace or discard, against the least depth accumulated so far.
    #[inline(always)]
    fn add(&mut self, gather: &WeightedSum, sample: &Sample) {
        let [fragment] = &mut self.fragment;
        if fragment.weight != 0 {
            if sample.depth > fragment.near.saturating_add(gather.threshold) {
                return;
            }
            if sample.depth.saturating_add(gather.threshold) < fragment.near {
                *fragment = Fragment::default();
            }
        }
        gather.accumulate(fragment, sample);
    }

    fn fragments(&self) -> &[Fragment] {
        match self.fragment {
            [Fragment { weight: 0, .. }] => &[],
            _ => &self.fragment,
        }
    }
}
