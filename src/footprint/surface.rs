//! The surface footprint: a footprint with the depth of its tangent plane and the attributes to be filtered.
//!
//! The plane's depth is a third lane of the rasterizer beside the radial index: an affine function of the pixel, so one
//! addition per pixel. It is computed at a run's start as an exact integer expression of column and row, so that
//! a picture is the same whatever its tiles.

use super::Footprint;
use crate::format::Widths;

/// Fraction bits of the depth lane.
pub const DEPTH_FRACTION: u32 = 32;

/// Fraction bits of [`Attributes`]: those of a colour and four more, as far as the inputs have them.
///
/// Surfaces of one colour are the rule. What its rounding does it does to every pixel alike, where a volume's many
/// colours would average out: with a colour's own bits the whole of a surface came out on one side, by more than the
/// pixels' own rounding.
pub const fn attribute_fraction(widths: &Widths) -> u8 {
    if widths.colour < 24 {
        widths.colour + 4
    } else {
        28
    }
}

/// A projected surface splat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceFootprint {
    /// Where and how heavy it is. The footprint's own colour is [`Attributes::colour`], rounded to a colour's bits.
    pub footprint: Footprint,
    /// Depth of the tangent plane.
    pub plane: Plane,
    /// What a pixel filters.
    pub attributes: Attributes,
    /// The splat shows its back: its normal pointed away from the eye and was turned. Whoever draws closed surfaces
    /// leaves these out.
    pub back: bool,
}

/// Depth of a tangent plane as a function of the pixel, scene units, Q31.32.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plane {
    /// Depth at the sample point of the bounding box's first column and row.
    pub origin: i64,
    /// Difference to the next column and to the next row.
    pub step: [i64; 2],
}

/// Attributes of a surface splat, constant over its footprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Attributes {
    /// Linear red, green, blue, premultiplied with the opacity, UQ1 with [`attribute_fraction`] bits, at most 1.
    pub colour: [u32; 3],
    /// Opacity in the same format, at most 1.
    pub opacity: u32,
    /// Normal in camera space towards the eye, Q1 with as many bits, each component within [-1, 1].
    pub normal: [i32; 3],
    /// Row of the material table.
    pub material: u8,
}

impl SurfaceFootprint {
    /// Depth at column `x` and row `y`, Q31.32, modulo 2^64: exact for the plane's integers.
    #[inline(always)]
    pub fn depth_at(&self, x: u16, y: u16) -> i64 {
        let [first_x, first_y] = self.footprint.first;
        let [step_x, step_y] = self.plane.step;
        let across = i64::from(x).wrapping_sub(first_x.into());
        let down = i64::from(y).wrapping_sub(first_y.into());
        self.plane
            .origin
            .wrapping_add(step_x.wrapping_mul(across))
            .wrapping_add(step_y.wrapping_mul(down))
    }
}

/// A lane's depth in UQ9.23, rounded to nearest, saturated: the format in which pixels keep depths.
#[inline(always)]
pub fn depth_in_pixel(lane: i64) -> u32 {
    const DROP: u32 = DEPTH_FRACTION - 23;
    let rounded = lane.saturating_add(1 << (DROP - 1)) >> DROP;
    rounded.clamp(0, u32::MAX.into()) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Standard24;

    #[test]
    fn attributes_have_four_bits_more_than_colours() {
        let fraction = |colour| {
            attribute_fraction(&Widths {
                colour,
                ..Standard24::WIDTHS
            })
        };
        assert_eq!([4, 23, 24, 28].map(fraction), [8, 27, 28, 28]);
    }

    #[test]
    fn depths_of_pixels_are_rounded_and_saturate() {
        let found = [i64::MIN, -1, 0, 255, 256, 767, 768, 1 << 41, i64::MAX].map(depth_in_pixel);
        assert_eq!(found, [0, 0, 0, 0, 1, 1, 2, u32::MAX, u32::MAX]);
    }
}
