//! The view: camera pose, projection, viewport and depth range, as the setup stage sees them.
//!
//! Camera space is x right, y down, z forward; pixel (i, j) is sampled at (i + 0.5, j + 0.5). One *scene unit* of the
//! kernel is whatever power-of-two multiple of the scene's own unit puts all positions within Q7.24; scaling
//! positions, axes and translation by the same power of two changes no picture and no bit of a footprint's shape.

use crate::math::Scaled;
use fixed::types::{I2F30, I8F24, I10F54, I32F32};

/// How camera space is mapped to the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// u = fx x / z + cx (\[EWA\] eq. 24-26 with the focal length in pixels).
    Perspective,
    /// u = fx x + cx.
    Orthographic,
}

/// The widened frustum to which x/z and y/z are clamped in the Jacobian under the rules `3dgs`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RatioLimits {
    /// Smallest x/z and y/z, Q31.32.
    pub low: [I32F32; 2],
    /// Largest x/z and y/z, Q31.32.
    pub high: [I32F32; 2],
}

/// Everything setup needs to know of the camera. Constant for a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// World-to-camera rotation W, row-major, Q1.30, |entry| <= 1.
    pub rotation: [[I2F30; 3]; 3],
    /// World-to-camera translation d (t = W u + d), scene units, Q9.54, |entry| <= 256.
    pub translation: [I10F54; 3],
    /// Focal lengths in pixels (orthographic: pixels per scene unit), normalised, positive.
    pub focal: [Scaled; 2],
    /// Principal point in pixels, Q31.32.
    pub principal: [I32F32; 2],
    /// Splats with z <= near are culled; scene units.
    pub near: I10F54,
    /// Splats with z >= far are culled; scene units.
    pub far: I10F54,
    /// Columns and rows of the viewport, at most 32768 each.
    pub viewport: [u16; 2],
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Frustum of the Jacobian's clamp.
    pub limits: RatioLimits,
}

impl View {
    /// t = W u + d in scene units, Q9.54 (\[EWA\] eq. 22).
    ///
    /// The three products are exact (Q8.54); entries of W are first rounded to the design's `view` fraction bits. The sum wraps
    /// only when |d| exceeds its range; with |d| <= 256 and |u| < 128 it fits: 3 * 128 + 256 > 512 is
    /// excluded because W is a rotation, so that |W u| <= 128 sqrt(3).
    pub fn to_camera(&self, centre: [I8F24; 3], view_bits: u32) -> [i64; 3] {
        let mut t = [0; 3];
        for (row, (entries, d)) in self.rotation.iter().zip(self.translation).enumerate() {
            t[row] = d.to_bits();
            for (w, u) in entries.iter().zip(centre) {
                let product = round_entry(*w, view_bits).wrapping_mul(i64::from(u.to_bits()));
                t[row] = i64::wrapping_add(t[row], product);
            }
        }
        t
    }
}

/// An entry of W in Q1.30 with all but `bits` fraction bits rounded away.
#[inline(always)]
pub fn round_entry(entry: I2F30, bits: u32) -> i64 {
    let entry = i64::from(entry.to_bits());
    match 30u32.saturating_sub(bits) {
        0 => entry,
        drop => (entry + (1 << (drop - 1))) & (-1 << drop),
    }
}
