//! The footprint packet: what setup hands to the rasterizer, one per visible splat.
//!
//! Everything a pixel needs to know of a splat is in here; neither the camera nor the scene is seen further
//! down. Its serial form, bit for bit, is [`packet`].

pub mod depth;
pub mod packet;
pub mod surface;

use crate::math::SoftFloat;

/// A projected splat. Integer formats depend on the design's [`Widths`](crate::format::Widths).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Footprint {
    /// Sort key: depth z in scene units as a number of 48 bits ([`depth::key`]).
    pub depth: u64,
    /// Centre in pixels, Q27.subpixel.
    pub centre: [i64; 2],
    /// First column and row of the bounding box, clipped to the viewport.
    pub first: [u16; 2],
    /// One past the last column and row of the bounding box, clipped to the viewport.
    pub end: [u16; 2],
    /// Coefficients of the `spans` traversal.
    pub ldl: Ldl,
    /// Coefficients of the `box` traversal.
    pub conic: Conic,
    /// The footprint is r < cutoff; UQ4.28, at most 4 + 1/16 in ewa and 11.1 in 3dgs.
    pub cutoff: u32,
    /// Opacity at the centre (r = 0), UQ4.peak, saturated.
    pub opacity: u32,
    /// Linear red, green, blue, UQ4.colour.
    pub colour: [u32; 3],
}

impl Footprint {
    /// Covers no pixel: what memory lent for footprints can be filled with.
    pub const EMPTY: Footprint = Footprint {
        depth: 0,
        centre: [0; 2],
        first: [0; 2],
        end: [0; 2],
        ldl: Ldl {
            horizontal: SoftFloat::ZERO,
            squared_width: SoftFloat::ZERO,
            shear: SoftFloat::ZERO,
            vertical: SoftFloat::ZERO,
        },
        conic: Conic {
            mantissa: [0; 3],
            exponent: 0,
        },
        cutoff: 0,
        opacity: 0,
        colour: [0; 3],
    };
}

/// The LDL form of the quadratic form Q = (V' + V^h)^-1: r = A (x - xc(y))^2 + C dy^2 with xc(y) = u + S dy.
///
/// Every term is positive, so nothing cancels, and the row's span follows from r < c.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ldl {
    /// A = Vyy / det, per square pixel.
    pub horizontal: SoftFloat,
    /// 1 / A = det / Vyy, square pixels: the squared half-width of a row is (c - C dy^2) / A.
    pub squared_width: SoftFloat,
    /// S = Vxy / Vyy, pixels per row.
    pub shear: SoftFloat,
    /// C = 1 / Vyy, per square pixel.
    pub vertical: SoftFloat,
}

/// The conic form: r = a dx^2 + 2 b dx dy + c dy^2 with one exponent for the three coefficients, per square pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Conic {
    /// Mantissas of a, b, c; the largest uses all of the design's mantissa bits.
    pub mantissa: [i32; 3],
    /// Power of two of all three.
    pub exponent: i32,
}
