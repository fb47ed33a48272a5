//! Right shifts that round, defined for every shift amount.
//!
//! A shift by `s` divides by `2^s`. Rounding to nearest adds half of `2^s` first, so halves go up; the sum
//! wraps only for values within half of `2^s` of the type's end, which no caller produces (all keep a spare bit).
//!
//! Where 64-bit shifts are library calls (32-bit processors) the saturating shift is a function of its own: half of the
//! code of setup would otherwise be copies of it. Shifts by constants still fold.

use super::words::{leading_zeros_wide, rounded_down, shifted_up};
use crate::format::Rounding;

/// `value / 2^shift`, rounded to nearest, halves up. `shift >= 64` gives 0. Values less than half of `2^shift` below
/// the type's end wrap.
#[inline]
pub const fn shift_round(value: i64, shift: u32) -> i64 {
    if shift == 0 {
        return value;
    }
    if shift >= 64 {
        return 0;
    }
    value.wrapping_add(1 << (shift - 1)) >> shift
}

/// `value * 2^shift` saturated to the type. `shift >= 63` saturates anything but 0.
#[cfg_attr(not(target_pointer_width = "32"), inline)]
#[cfg_attr(target_pointer_width = "32", inline(never))]
pub const fn shift_left(value: i64, shift: u32) -> i64 {
    let head_room = leading_zeros_wide(value.unsigned_abs());
    if value == 0 {
        return 0;
    }
    if shift < head_room {
        return shifted_up(value as u64, shift) as i64;
    }
    if value < 0 { i64::MIN } else { i64::MAX }
}

/// `value * 2^-shift` for either sign of `shift`: rounds to nearest, halves up, to the right and saturates to the left.
/// Nothing wraps but the largest value moved by 1.
#[cfg_attr(not(target_pointer_width = "32"), inline)]
#[cfg_attr(target_pointer_width = "32", inline(never))]
pub const fn shift_signed(value: i64, shift: i32) -> i64 {
    if shift < 0 {
        return shift_left(value, shift.unsigned_abs());
    }
    if shift == 0 {
        return value;
    }
    rounded_down(value, shift as u32)
}

/// `value / 2^shift` in the pixel path, by the design's rounding. `shift >= 64` gives 0; a negative shift multiplies
/// and drops what leaves the word (the width ranges keep values below it). Rounding up wraps at the word's end, as in
/// [`shift_round`].
#[inline(always)]
pub const fn shift_unsigned(value: u64, shift: i32, rounding: Rounding) -> u64 {
    if shift >= 64 || shift <= -64 {
        return 0;
    }
    if shift <= 0 {
        return value << shift.unsigned_abs();
    }
    match rounding {
        Rounding::Nearest => value.wrapping_add(1 << (shift - 1)) >> shift,
        // An odd result goes up from the half on, an even one from above it.
        Rounding::NearestEven => {
            let below_half = (1 << (shift - 1)) - 1;
            value.wrapping_add(below_half + (value >> shift & 1)) >> shift
        }
        Rounding::Truncate => value >> shift,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifts_end_where_the_word_ends() {
        assert_eq!([63, 64].map(|shift| shift_round(i64::MIN, shift)), [-1, 0]);
        // Half of 2^shift below the end, and one more, which wraps.
        let end = i64::MAX - 8;
        assert_eq!(
            [end, end + 1].map(|value| shift_round(value, 4)),
            [i64::MAX >> 4, i64::MIN >> 4]
        );
        assert_eq!(
            [end, end + 1].map(|value| shift_signed(value, 4)),
            [i64::MAX >> 4, 1 << 59]
        );
        assert_eq!(
            [i64::MAX, i64::MAX - 1].map(|value| shift_signed(value, 1)),
            [i64::MIN >> 1, i64::MAX >> 1]
        );
        let moved = |value, shift| shift_unsigned(value, shift, Rounding::Nearest);
        assert_eq!([-64, -63].map(|shift| moved(1, shift)), [0, 1 << 63]);
        assert_eq!([63, 64].map(|shift| moved(1 << 62, shift)), [1, 0]);
    }

    #[test]
    fn halves_go_up() {
        let table: [(i64, u32, i64); 8] = [
            (5, 1, 3),
            (-5, 1, -2),
            (7, 2, 2),
            (6, 2, 2),
            (5, 2, 1),
            (-6, 2, -1),
            (-7, 2, -2),
            (1, 64, 0),
        ];
        for (value, shift, expected) in table {
            assert_eq!(shift_round(value, shift), expected, "{value} >> {shift}");
        }
    }

    #[test]
    fn left_shift_saturates() {
        assert_eq!(shift_left(3, 2), 12);
        assert_eq!(shift_left(-3, 2), -12);
        assert_eq!(shift_left(3, 62), i64::MAX);
        assert_eq!(shift_left(-3, 63), i64::MIN);
        assert_eq!(shift_left(0, 200), 0);
        assert_eq!(shift_left(1, 62), 1 << 62);
        assert_eq!(shift_left(1, 63), i64::MAX);
    }

    #[test]
    fn pixel_path_follows_the_rounding() {
        assert_eq!(shift_unsigned(7, 2, Rounding::Nearest), 2);
        assert_eq!(shift_unsigned(7, 2, Rounding::Truncate), 1);
        let even = [
            (5, 1),
            (6, 2),
            (7, 2),
            (9, 2),
            (10, 2),
            (11, 3),
            (13, 3),
            (14, 4),
        ];
        for (value, expected) in even {
            assert_eq!(shift_unsigned(value, 2, Rounding::NearestEven), expected);
        }
        assert_eq!(shift_unsigned(7, -2, Rounding::Truncate), 28);
        assert_eq!(shift_unsigned(7, 64, Rounding::Nearest), 0);
    }
}
