//! From centres to camera space on vectors: `splatline::view`'s `Eye::to_camera`, the comparison with the depth range,
//! the sort key.
//!
//! Splats come with normalised mantissas (`is_mild`), so that the leading bit of a coordinate needs no counting.

use super::number::{Arithmetic, Number, Word};
use crate::fast::lanes::Wide;
use splatline::footprint::depth::{KEY_BITS, MANTISSA};
use splatline::format::Widths;
use splatline::math::{Extended, shift_round};
use splatline::view::{View, round_entry};

/// Magnitude bits of a normalised coordinate.
pub const COORDINATE: u32 = 31;

/// Exponents of this size and more are beyond any splat's.
const BEYOND: i32 = 1 << 26;

/// A point in camera space: three words with one exponent.
#[derive(Clone, Copy)]
pub struct CameraPoints<W: Wide> {
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

impl<W: Wide> Arithmetic<W> {
    /// u - e with `bits` bits, and the exponent of the three.
    #[inline(always)]
    fn difference(
        self,
        view: &View,
        centre: &[Number<W>; 3],
        bits: u32,
    ) -> ([Word<W>; 3], Word<W>) {
        const NONE: i64 = i32::MIN as i64;
        let eye = &view.pose;
        let together = eye.position.iter().fold(0, |all, e| all | e.unsigned_abs());
        let of_eye = match together {
            0 => NONE,
            _ => i64::from(eye.exponent) + 64 - i64::from(together.leading_zeros()),
        };
        let mut leading = self.splat(of_eye);
        for coordinate in centre {
            let end = self.plus(coordinate.exponent, COORDINATE.into());
            let nothing = self.lanes.wide_equal(coordinate.mantissa, self.splat(0));
            leading = self.max(leading, self.select(end, self.splat(NONE), nothing));
        }
        let unit = self.plus(leading, -60);
        let from_eye = self.plus(unit, -i64::from(eye.exponent));
        let mut difference = [self.splat(0); 3];
        let mut largest = self.splat(0);
        for ((difference, u), e) in difference.iter_mut().zip(centre).zip(eye.position) {
            let aligned = self.align(u.mantissa, self.sub(unit, u.exponent));
            *difference = self.sub(aligned, self.align(self.splat(e), from_eye));
            largest = self.max(largest, self.magnitude(*difference));
        }
        let zeros = self.lanes.wide_leading_zeros(largest);
        let drop = self.sub(self.splat(64 - i64::from(bits)), zeros);
        // Not by `map`: a closure is not compiled for the vectors' instructions.
        let [x, y, z] = difference;
        let difference = [
            self.align(x, drop),
            self.align(y, drop),
            self.align(z, drop),
        ];
        (difference, self.add(unit, drop))
    }

    /// `Eye::to_camera`.
    #[inline(always)]
    pub fn to_camera(
        self,
        view: &View,
        widths: &Widths,
        centre: &[Number<W>; 3],
    ) -> CameraPoints<W> {
        let bits = u32::from(widths.position);
        let (difference, exponent) = self.difference(view, centre, bits);
        let low = bits.saturating_sub(30);
        let mut value = [self.splat(0); 3];
        for (row, sum) in value.iter_mut().enumerate() {
            let mut cross = self.splat(0);
            for (column, part) in difference.into_iter().enumerate() {
                let entry = self.splat(round_entry(view.rotation[row][column], bits));
                if low == 0 {
                    *sum = self.add(*sum, self.mul(entry, part));
                    continue;
                }
                let rest = view.pose.rotation_rest[row][column];
                let rest = self.splat(shift_round(rest.into(), 30 - low));
                let high = self.round(part, low);
                let tail = self.sub(part, self.shl(high, low.into()));
                *sum = self.add(*sum, self.mul(entry, high));
                let products = self.add(self.mul(entry, tail), self.mul(rest, high));
                cross = self.add(cross, products);
            }
            *sum = self.add(*sum, self.round(cross, low));
        }
        CameraPoints {
            value,
            exponent: self.plus(exponent, i64::from(low) - 30),
        }
    }

    /// Is a positive depth above `near` and below `far`?
    #[inline(always)]
    pub fn depth_range(
        self,
        depth: Word<W>,
        exponent: Word<W>,
        view: &View,
    ) -> (W::Truth, W::Truth) {
        let near = self.max(self.floor_at(view.near, exponent), self.splat(0));
        let far = if view.far.exponent >= BEYOND {
            self.splat(i64::MAX)
        } else {
            let negative = Extended {
                value: -view.far.value,
                ..view.far
            };
            self.negate(self.floor_at(negative, exponent))
        };
        (self.greater(depth, near), self.greater(far, depth))
    }

    /// The largest integer that is at most `number 2^-exponent`, saturated below 2^63.
    #[inline(always)]
    fn floor_at(self, number: Extended, exponent: Word<W>) -> Word<W> {
        let room = i64::from(number.value.unsigned_abs().leading_zeros()) - 1;
        let left = self.sub(self.splat(number.exponent.into()), exponent);
        let value = self.splat(number.value);
        let zero = self.splat(0);
        let lower = self.lanes.wide_sar(value, self.negate(left));
        let upper = self.lanes.wide_shl(value, left);
        let end = match number.value {
            0 => 0,
            ..0 => -i64::MAX,
            _ => i64::MAX,
        };
        let upper = self.select(upper, self.splat(end), self.greater(left, self.splat(room)));
        self.select(lower, upper, self.greater(left, zero))
    }

    /// `depth::key` of positive depths.
    #[inline(always)]
    pub fn depth_key(self, depth: Word<W>, exponent: Word<W>) -> Word<W> {
        const POSITIVE: i64 = 1 << (KEY_BITS - 1);
        const BIAS: i64 = 1 << (KEY_BITS - 2 - MANTISSA);
        let zeros = self.lanes.wide_leading_zeros(depth);
        let biased = self.sub(self.plus(exponent, 63 + BIAS), zeros);
        let normal = self.shl(self.lanes.wide_shl(depth, zeros), 1);
        let below = self.shr(normal, 64 - i64::from(MANTISSA));
        let key = self.add(self.shl(biased, MANTISSA.into()), below);
        let key = self.select(key, self.splat(0), self.greater(self.splat(0), biased));
        let beyond = self.greater(biased, self.splat(2 * BIAS - 1));
        let key = self.select(key, self.splat(POSITIVE - 1), beyond);
        self.plus(key, POSITIVE)
    }
}
