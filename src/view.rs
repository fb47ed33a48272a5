//! The view: camera pose, projection, viewport and depth range, as the setup stage sees them.
//!
//! Camera space is x right, y down, z forward; pixel (i, j) is sampled at (i + 0.5, j + 0.5).
//!
//! There are two ways from a splat's centre to camera space, a choice of the type [`Pose`]:
//!
//! - [`Eye`]: centres are mantissas with exponents, as files have them. The difference to the eye comes first and is
//!   exact; it is then rounded once, to a block exponent of the splat's own, and rotated. Every error is relative to
//!   the splat's distance from the eye, whatever the offset or the extent of the scene.
//! - [`Translation`]: centres are Q7.24, 32 bits a coordinate, for firmware that knows the range of its scene. t = W u
//!   + d is exact to Q9.54.

use crate::format::Widths;
use crate::math::words::{leading_zeros_wide, product, shift_word};
use crate::math::{Extended, SoftFloat, shift_round, shift_signed};
use crate::raster::Window;
use fixed::types::{I2F30, I8F24, I10F54, I32F32};

/// How camera space is mapped to the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// World-to-camera rotation W, row-major, Q1.30, |entry| <= 1.
pub type Rotation = [[I2F30; 3]; 3];

/// A point in camera space: three words with one exponent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CameraPoint {
    /// x right, y down, z forward.
    pub value: [i64; 3],
    /// Power of two of all three.
    pub exponent: i32,
}

impl CameraPoint {
    /// One coordinate: of axis 0 x, of 1 y, of any other z.
    #[inline(always)]
    pub const fn coordinate(&self, axis: usize) -> Extended {
        let [x, y, z] = self.value;
        // An index would be checked, and a build for size keeps the check.
        let value = match axis {
            0 => x,
            1 => y,
            _ => z,
        };
        Extended {
            value,
            exponent: self.exponent,
        }
    }
}

/// Where the camera stands, in the form that its splats' centres ask for.
pub trait Pose: Copy {
    /// A splat's centre.
    type Centre: Copy + core::fmt::Debug + PartialEq;

    /// t = W (u - e) = W u + d, scene units (\[EWA\] eq. 22).
    fn to_camera(&self, rotation: &Rotation, centre: &Self::Centre, widths: &Widths)
    -> CameraPoint;
}

/// The eye in the scene, for centres of any size and place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Eye {
    /// Mantissas of its coordinates. Of a magnitude above `2^60` the low bits are rounded away.
    pub position: [i64; 3],
    /// Power of two of all three.
    pub exponent: i32,
    /// What W has beyond its 30 fraction bits: units of `2^-60`, |entry| <= `2^29`. Designs whose
    /// [`position`](Widths::position) has at most 30 bits do not look at it.
    pub rotation_rest: [[i32; 3]; 3],
}

/// The translation d of t = W u + d in scene units, Q9.54, |entry| <= 256, for centres in Q7.24.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Translation(pub [I10F54; 3]);

/// Everything setup needs to know of the camera. Constant for a picture.
///
/// `Camera::view` makes one of ordinary numbers; an image without floating point states it, for instance with an eye 4
/// units before the origin that looks along z:
///
/// ```
/// use splatline::fixed::types::{I2F30, I32F32};
/// use splatline::math::{Extended, SoftFloat};
/// use splatline::view::{Eye, Projection, RatioLimits, View};
///
/// const TURN: [[I2F30; 3]; 3] = {
///     let (zero, one) = (I2F30::ZERO, I2F30::ONE);
///     [[one, zero, zero], [zero, one, zero], [zero, zero, one]]
/// };
/// const FOCAL: SoftFloat = SoftFloat { mantissa: 300 << 22, exponent: -22 }; // 300 pixels.
/// const LIMIT: I32F32 = I32F32::from_bits(2_233_382_994); // 1.3 x 120 / 300.
/// let view = View {
///     rotation: TURN,
///     pose: Eye { position: [0, 0, -4], ..Eye::ORIGIN },
///     focal: [FOCAL; 2],
///     principal: [I32F32::from_bits(120 << 32); 2],
///     near: Extended { value: 1, exponent: -6 },
///     far: Extended { value: 200, exponent: 0 },
///     viewport: [240, 240],
///     projection: Projection::Perspective,
///     limits: RatioLimits { low: [LIMIT.wrapping_neg(); 2], high: [LIMIT; 2] },
/// };
/// assert_eq!(view.window().strips(8).count(), 30);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View<P = Eye> {
    /// World-to-camera rotation W.
    pub rotation: Rotation,
    /// Where the camera stands.
    pub pose: P,
    /// Focal lengths in pixels (orthographic: pixels per scene unit), normalised, positive.
    pub focal: [SoftFloat; 2],
    /// Principal point in pixels, Q31.32.
    pub principal: [I32F32; 2],
    /// Splats with z <= near are culled; scene units.
    pub near: Extended,
    /// Splats with z >= far are culled; scene units.
    pub far: Extended,
    /// Columns and rows of the viewport, at most 32768 each.
    pub viewport: [u16; 2],
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Frustum of the Jacobian's clamp.
    pub limits: RatioLimits,
}

impl<P> View<P> {
    /// The whole viewport as a window.
    pub const fn window(&self) -> Window {
        Window {
            first: [0; 2],
            end: self.viewport,
        }
    }
}

/// Fraction bits of W's entries.
pub const ENTRY: u32 = 30;

/// A difference has its leading bit at most here, so that a sum of two fits a word with a bit to spare.
const TOP: i32 = 60;

impl Pose for Eye {
    type Centre = [SoftFloat; 3];

    /// The difference u - e is exact where a coordinate cancels, and otherwise rounded `2^-61` below the largest
    /// coordinate of u and e; then rounded to nearest to `position` bits of its largest coordinate. With `position`
    /// above 30 both the difference and W have two parts; the product of the low parts, less than the last bit, is left
    /// out. Error of t: `2^-(position - 2)` of the distance.
    #[cfg_attr(not(target_pointer_width = "32"), inline)]
    fn to_camera(
        &self,
        rotation: &Rotation,
        centre: &[SoftFloat; 3],
        widths: &Widths,
    ) -> CameraPoint {
        let bits = u32::from(widths.position);
        let (difference, exponent) = self.difference(centre, bits);
        let [low, drop] = [bits.saturating_sub(ENTRY), ENTRY.saturating_sub(bits)];
        let half = 1 << drop >> 1;
        let mut value = [0; 3];
        for (row, sum) in value.iter_mut().enumerate() {
            let entries = rotation[row];
            if low == 0 {
                for (entry, part) in entries.iter().zip(difference) {
                    let entry = entry.to_bits().wrapping_add(half) & -1 << drop;
                    *sum = i64::wrapping_add(*sum, product(entry, part as i32));
                }
                continue;
            }
            let mut cross = 0i64;
            for ((entry, rest), part) in entries.iter().zip(self.rotation_rest[row]).zip(difference)
            {
                let rest = shift_word(rest, ENTRY.saturating_sub(low) as i32);
                let (high, tail) = halves(part, low);
                *sum = sum.wrapping_add(product(entry.to_bits(), high));
                cross = cross
                    .wrapping_add(product(entry.to_bits(), tail))
                    .wrapping_add(product(rest, high));
            }
            *sum = sum.wrapping_add(shift_round(cross, low));
        }
        CameraPoint {
            value,
            exponent: exponent
                .saturating_add(low as i32)
                .saturating_sub(ENTRY as i32),
        }
    }
}

/// `value = high 2^low + tail` with high rounded to nearest; both fit a word for values of at most `30 + low` bits.
#[inline(always)]
fn halves(value: i64, low: u32) -> (i32, i32) {
    let high = shift_round(value, low);
    (high as i32, value.wrapping_sub(high << low) as i32)
}

impl Eye {
    /// At the origin of the scene, the rotation exact in 30 bits.
    pub const ORIGIN: Eye = Eye {
        position: [0; 3],
        exponent: 0,
        rotation_rest: [[0; 3]; 3],
    };

    /// u - e with the leading bit of its largest coordinate at bit `bits - 1`, and the exponent of the three.
    ///
    /// All zeros with an exponent of 0 where splat and eye coincide.
    #[inline(always)]
    fn difference(&self, centre: &[SoftFloat; 3], bits: u32) -> ([i64; 3], i32) {
        let together = |[a, b, c]: [i64; 3]| a.unsigned_abs() | b.unsigned_abs() | c.unsigned_abs();
        let length = |magnitude: u64| 64 - leading_zeros_wide(magnitude) as i32;
        let mut leading = match together(self.position) {
            0 => i32::MIN,
            magnitude => self.exponent.saturating_add(length(magnitude)),
        };
        for coordinate in centre {
            if coordinate.mantissa != 0 {
                leading = leading.max(coordinate.leading().saturating_add(1));
            }
        }
        let unit = leading.saturating_sub(TOP);
        let mut difference = [0; 3];
        for ((difference, u), e) in difference.iter_mut().zip(centre).zip(self.position) {
            let aligned = shift_signed(u.mantissa.into(), unit.saturating_sub(u.exponent));
            *difference = aligned.wrapping_sub(shift_signed(e, unit.saturating_sub(self.exponent)));
        }
        let magnitude = together(difference);
        if magnitude == 0 {
            return ([0; 3], 0);
        }
        let drop = length(magnitude) - bits as i32;
        (
            difference.map(|coordinate| shift_signed(coordinate, drop)),
            unit.saturating_add(drop),
        )
    }
}

impl Pose for Translation {
    type Centre = [I8F24; 3];

    /// The three products are exact (Q8.54); entries of W are first rounded to the design's `view` fraction bits. The
    /// sum wraps only when |d| exceeds its range; with |d| <= 256 and |u| < 128 it fits: 3 * 128 + 256 > 512 is
    /// excluded because W is a rotation, so that |W u| <= 128 sqrt(3).
    #[inline]
    fn to_camera(&self, rotation: &Rotation, centre: &[I8F24; 3], widths: &Widths) -> CameraPoint {
        let mut value = self.0.map(|d| d.to_bits());
        for (sum, entries) in value.iter_mut().zip(rotation) {
            for (w, u) in entries.iter().zip(centre) {
                let entry = round_entry(*w, widths.view.into());
                *sum = sum.wrapping_add(entry.wrapping_mul(i64::from(u.to_bits())));
            }
        }
        CameraPoint {
            value,
            exponent: -54,
        }
    }
}

/// An entry of W in Q1.30 with all but `bits` fraction bits rounded away.
#[inline(always)]
pub fn round_entry(entry: I2F30, bits: u32) -> i64 {
    let entry = i64::from(entry.to_bits());
    match ENTRY.saturating_sub(bits) {
        0 => entry,
        drop => (entry + (1 << (drop - 1))) & (-1 << drop),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Standard24;

    /// A difference is rounded once it has been taken, by half a unit of the 60 bits that the larger of u and e leaves;
    /// one that is all cancelled but for a bit keeps that bit.
    #[test]
    fn differences_keep_what_cancels() {
        let eye = |x: i64| Eye {
            position: [x, 0, 0],
            ..Eye::ORIGIN
        };
        let at = |mantissa: i32, exponent: i32| {
            [
                SoftFloat { mantissa, exponent },
                SoftFloat::ZERO,
                SoftFloat::ZERO,
            ]
        };
        let near_half = eye((1 << 40) + 31);
        assert_eq!(
            near_half.difference(&at(1 << 30, 35), 24),
            ([1 << 24, 0, 0], 41)
        );
        let one_off = eye((1 << 59) + 1);
        assert_eq!(
            one_off.difference(&at(1 << 30, 29), 24),
            ([-1 << 23, 0, 0], -23)
        );
        assert_eq!(eye(1 << 59).difference(&at(1 << 30, 29), 24), ([0; 3], 0));
    }

    /// Entries are rounded as [`round_entry`] does.
    #[test]
    fn entries_of_a_short_rotation_are_rounded() {
        let widths = Widths {
            position: 18,
            ..Standard24::WIDTHS
        };
        let row = [(1 << 30) - 5, -(1 << 29) + 2048, 97].map(I2F30::from_bits);
        let centre = [3, -70_001, 99_999].map(|mantissa| SoftFloat {
            mantissa,
            exponent: -9,
        });
        let (parts, _) = Eye::ORIGIN.difference(&centre, 18);
        let expected: i64 = row
            .iter()
            .zip(parts)
            .map(|(w, part)| round_entry(*w, 18) * part)
            .sum();
        let found = Eye::ORIGIN.to_camera(&[row; 3], &centre, &widths);
        assert_eq!(found.value, [expected; 3]);
        // Where exponents end, a mantissa does too.
        let far = [
            SoftFloat::ZERO,
            SoftFloat::ZERO,
            SoftFloat {
                mantissa: 1 << 30,
                exponent: i32::MAX,
            },
        ];
        assert_eq!(Eye::ORIGIN.difference(&far, 18).0, [0, 0, 1 << 18]);
    }

    /// W u + d in 128 bits, with W's entries rounded to the design's bits.
    #[test]
    fn translations_add_products() {
        let rotation = [[5, -70, 90], [-33, 1 << 30, 31], [32, -(1 << 29) - 97, 95]]
            .map(|row| row.map(I2F30::from_bits));
        let centre = [i32::MAX, -12_345_678, 3].map(I8F24::from_bits);
        let pose = Translation([1, -(1 << 60), 7 << 40].map(I10F54::from_bits));
        let widths = Widths {
            view: 24,
            ..Standard24::WIDTHS
        };
        let found = pose.to_camera(&rotation, &centre, &widths);
        let rounded = |entry: I2F30| (i128::from(entry.to_bits()) + 32) >> 6 << 6;
        let expected = [0, 1, 2].map(|row| {
            let products = rotation[row].iter().zip(centre);
            let sum: i128 = products
                .map(|(w, u)| rounded(*w) * i128::from(u.to_bits()))
                .sum();
            (sum + i128::from(pose.0[row].to_bits())) as i64
        });
        assert_eq!((found.value, found.exponent), (expected, -54));
        assert_eq!(round_entry(I2F30::from_bits(97), 30), 97);
    }
}
