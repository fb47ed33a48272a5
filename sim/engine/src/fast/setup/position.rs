//! From centres to camera space on vectors: `splatline::view`'s `Eye::to_camera`, the comparison with the depth range,
//! the sort key.
//!
//! Splats come with normalised mantissas (`is_mild`), so that the leading bit of a coordinate needs no counting.

use super::number::{Arithmetic, Number, Word};
use super::stages::Stages;
use crate::fast::lanes::Lanes;
use splatline::footprint::depth::{KEY_BITS, MANTISSA};
use splatline::math::{Extended, shift_round};
use splatline::view::{View, round_entry};

/// Magnitude bits of a normalised coordinate.
pub const COORDINATE: u32 = 31;

/// Exponents of this size and more are beyond any splat's.
const BEYOND: i32 = 1 << 26;

/// A point in camera space: three words with one exponent.
#[derive(Clone, Copy)]
pub struct CameraPoints<W: Lanes> {
    pub value: [Word<W>; 3],
    pub exponent: Word<W>,
}

/// May vectors bring splats to this view's camera space, and compare them with its depth range?
pub fn covers(view: &View) -> bool {
    let short = |value: i64| value.unsigned_abs() < 1 << 62;
    let mild = |exponent: i32| exponent.unsigned_abs() < 200;
    let entries = view.rotation.iter().flatten();
    let eye = &view.pose;
    let far_off = view.far.value > 0 && view.far.exponent >= BEYOND;
    eye.position.into_iter().all(short)
        && (mild(eye.exponent) || eye.position == [0; 3])
        && entries
            .map(|entry| entry.to_bits())
            .all(|entry| entry.unsigned_abs() <= 1 << 30)
        && short(view.near.value)
        && mild(view.near.exponent)
        && (far_off || short(view.far.value) && mild(view.far.exponent))
}

impl<W: Lanes> Stages<'_, W> {
    /// u - e with `bits` bits, and the exponent of the three.
    #[inline(always)]
    fn difference(&self, centre: &[Number<W>; 3], bits: u32) -> ([Word<W>; 3], Word<W>) {
        const NONE: i64 = i32::MIN as i64;
        let (lanes, eye) = (self.lanes, &self.view.pose);
        let together = eye.position.iter().fold(0, |all, e| all | e.unsigned_abs());
        let of_eye = match together {
            0 => NONE,
            _ => i64::from(eye.exponent) + 64 - i64::from(together.leading_zeros()),
        };
        let mut leading = lanes.splat(of_eye);
        for coordinate in centre {
            let end = lanes.plus(coordinate.exponent, COORDINATE.into());
            let nothing = lanes.equal(coordinate.mantissa, lanes.splat(0));
            leading = lanes.max(leading, lanes.select(end, lanes.splat(NONE), nothing));
        }
        let unit = lanes.plus(leading, -60);
        let from_eye = lanes.plus(unit, -i64::from(eye.exponent));
        let mut difference = [lanes.splat(0); 3];
        let mut largest = lanes.splat(0);
        for ((difference, u), e) in difference.iter_mut().zip(centre).zip(eye.position) {
            let aligned = lanes.align(u.mantissa, lanes.sub(unit, u.exponent));
            *difference = lanes.sub(aligned, lanes.align(lanes.splat(e), from_eye));
            largest = lanes.max(largest, lanes.magnitude(*difference));
        }
        let zeros = lanes.leading_zeros(largest);
        let drop = lanes.sub(lanes.splat(64 - i64::from(bits)), zeros);
        // Not by `map`: a closure is not compiled for the vectors' instructions.
        let [x, y, z] = difference;
        let difference = [
            lanes.align(x, drop),
            lanes.align(y, drop),
            lanes.align(z, drop),
        ];
        (difference, lanes.add(unit, drop))
    }

    /// `Eye::to_camera`.
    #[inline(always)]
    pub fn camera_points(&self, centre: &[Number<W>; 3]) -> CameraPoints<W> {
        let (lanes, view) = (self.lanes, self.view);
        let bits = u32::from(self.widths.position);
        let (difference, exponent) = self.difference(centre, bits);
        let low = bits.saturating_sub(30);
        let mut value = [lanes.splat(0); 3];
        for (row, sum) in value.iter_mut().enumerate() {
            let mut cross = lanes.splat(0);
            for (column, part) in difference.into_iter().enumerate() {
                let entry = lanes.splat(round_entry(view.rotation[row][column], bits));
                if low == 0 {
                    *sum = lanes.add(*sum, lanes.mul(entry, part));
                    continue;
                }
                let rest = view.pose.rotation_rest[row][column];
                let rest = lanes.splat(shift_round(rest.into(), 30 - low));
                let high = lanes.round(part, low);
                let tail = lanes.sub(part, lanes.shl_by(high, low.into()));
                *sum = lanes.add(*sum, lanes.mul(entry, high));
                let products = lanes.add(lanes.mul(entry, tail), lanes.mul(rest, high));
                cross = lanes.add(cross, products);
            }
            *sum = lanes.add(*sum, lanes.round(cross, low));
        }
        CameraPoints {
            value,
            exponent: lanes.plus(exponent, i64::from(low) - 30),
        }
    }

    /// Is a positive depth above `near` and below `far`?
    #[inline(always)]
    pub fn depth_range(&self, depth: Word<W>, exponent: Word<W>) -> (W::Truth, W::Truth) {
        let (lanes, view) = (self.lanes, self.view);
        let near = lanes.max(self.floor_at(view.near, exponent), lanes.splat(0));
        let far = if view.far.exponent >= BEYOND {
            lanes.splat(i64::MAX)
        } else {
            let negative = Extended {
                value: -view.far.value,
                ..view.far
            };
            lanes.negate(self.floor_at(negative, exponent))
        };
        (lanes.greater(depth, near), lanes.greater(far, depth))
    }

    /// The largest integer that is at most `number 2^-exponent`, saturated below 2^63.
    #[inline(always)]
    fn floor_at(&self, number: Extended, exponent: Word<W>) -> Word<W> {
        let lanes = self.lanes;
        let room = i64::from(number.value.unsigned_abs().leading_zeros()) - 1;
        let left = lanes.sub(lanes.splat(number.exponent.into()), exponent);
        let value = lanes.splat(number.value);
        let zero = lanes.splat(0);
        let lower = lanes.sar(value, lanes.negate(left));
        let upper = lanes.shl(value, left);
        let end = match number.value {
            0 => 0,
            ..0 => -i64::MAX,
            _ => i64::MAX,
        };
        let upper = lanes.select(
            upper,
            lanes.splat(end),
            lanes.greater(left, lanes.splat(room)),
        );
        lanes.select(lower, upper, lanes.greater(left, zero))
    }

    /// `depth::key` of positive depths.
    #[inline(always)]
    pub fn depth_key(&self, depth: Word<W>, exponent: Word<W>) -> Word<W> {
        const POSITIVE: i64 = 1 << (KEY_BITS - 1);
        const BIAS: i64 = 1 << (KEY_BITS - 2 - MANTISSA);
        let lanes = self.lanes;
        let zeros = lanes.leading_zeros(depth);
        let biased = lanes.sub(lanes.plus(exponent, 63 + BIAS), zeros);
        let normal = lanes.shl_by(lanes.shl(depth, zeros), 1);
        let below = lanes.shr_by(normal, 64 - i64::from(MANTISSA));
        let key = lanes.add(lanes.shl_by(biased, MANTISSA.into()), below);
        let key = lanes.select(key, lanes.splat(0), lanes.greater(lanes.splat(0), biased));
        let beyond = lanes.greater(biased, lanes.splat(2 * BIAS - 1));
        let key = lanes.select(key, lanes.splat(POSITIVE - 1), beyond);
        lanes.plus(key, POSITIVE)
    }
}
