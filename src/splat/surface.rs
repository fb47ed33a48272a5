//! The surface splat: a point of a surface with its tangent frame, normal, colour and material (SURF 3.3, EWA 6.3).

use super::{Axis, Position};
use crate::math::SoftFloat;
use fixed::types::U4F28;

/// An elliptical Gaussian basis function in the tangent plane of a point, of variance `V = S S^T`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSplat<C = Position> {
    /// Centre in scene units.
    pub centre: C,
    /// S: the two axes of the tangent frame, each one standard deviation long.
    pub frame: [Axis; 2],
    /// Unit normal in the scene's axes; its length is not used, shading normalises the filtered one.
    pub normal: Axis,
    /// Height of the basis function at its centre, in the surface's own plane. Where neighbours' functions sum to
    /// about 1, the weight sum of a pixel is its coverage (SURF 7). Negative counts as 0.
    pub weight: SoftFloat,
    /// Linear red, green, blue, not premultiplied; clamped to 1.
    pub colour: [U4F28; 3],
    /// Opacity of the surface; clamped to 1.
    pub opacity: U4F28,
    /// Row of the material table.
    pub material: u8,
}
