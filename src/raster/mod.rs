//! The rasterizer: a footprint becomes spans of adjacent pixels with their radial index by forward differencing.
//!
//! Both traversals yield the same thing, a [`Span`]: where it starts, how long it is, and three lane words. From pixel
//! to pixel the radial index costs two additions (\[EWA\] 7.1.2). What a traversal yields depends on the footprint and
//! the viewport alone: a [`Window`] only selects pixels, so a picture is the same whatever its tiles.

mod conic;
mod seeds;
mod spans;
mod stamp;

pub use conic::BoxSpans;
pub use seeds::{BLOCK, GUARD, vertical_fraction};
pub use spans::{EllipseSpans, REST, ROW_BLOCKS, RowBlock, RowConstants};
pub use stamp::{
    MAX_PHASE_BITS, MAX_SIDE, Placement, Stamp, StampError, StampRow, StampShape, fill_stamps,
};

use crate::footprint::Footprint;
use crate::format::Lane;

/// The part of the screen to be drawn: columns and rows `first .. end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Window {
    /// First column and row.
    pub first: [u16; 2],
    /// One past the last column and row.
    pub end: [u16; 2],
}

impl Window {
    /// The box of a footprint.
    #[inline(always)]
    pub const fn of(footprint: &Footprint) -> Window {
        Window {
            first: footprint.first,
            end: footprint.end,
        }
    }

    /// The pixels that both windows contain; empty where `first >= end` on an axis.
    #[inline]
    pub fn intersect(&self, other: &Window) -> Window {
        let mut both = *self;
        for axis in 0..2 {
            both.first[axis] = self.first[axis].max(other.first[axis]);
            both.end[axis] = self.end[axis].min(other.end[axis]);
        }
        both
    }

    /// Columns; 0 where `first >= end`.
    #[inline]
    pub const fn columns(&self) -> u16 {
        self.end[0].saturating_sub(self.first[0])
    }

    /// Rows; 0 where `first >= end`.
    #[inline]
    pub const fn rows(&self) -> u16 {
        self.end[1].saturating_sub(self.first[1])
    }

    /// Pixels; saturates on processors of 16 bits.
    pub const fn pixels(&self) -> usize {
        (self.columns() as usize).saturating_mul(self.rows() as usize)
    }

    /// The window cut into strips of `rows` rows (at least 1), from top to bottom; the last one may be lower.
    pub fn strips(self, rows: u16) -> impl Iterator<Item = Window> {
        let rows = rows.max(1);
        (self.first[1]..self.end[1])
            .step_by(rows.into())
            .map(move |first| Window {
                first: [self.first[0], first],
                end: [self.end[0], first.saturating_add(rows).min(self.end[1])],
            })
    }

    /// Has it no pixel?
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.first[0] >= self.end[0] || self.first[1] >= self.end[1]
    }
}

/// Adjacent pixels of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span<L> {
    /// Row.
    pub y: u16,
    /// First column.
    pub x: u16,
    /// Pixels, at least 1.
    pub length: u16,
    /// Radial index at the first pixel.
    pub radial: L,
    /// Difference to the next pixel.
    pub first: L,
    /// Difference of differences.
    pub second: L,
}

impl<L: Lane> Span<L> {
    /// The run's radial indices, pixel by pixel: two additions each.
    #[inline(always)]
    pub fn radials(self) -> impl Iterator<Item = L> {
        self.sequence().take(self.length.into())
    }

    /// The same, without end: for a loop that counts its pixels itself.
    #[inline(always)]
    pub fn sequence(self) -> impl Iterator<Item = L> {
        let Span {
            mut radial,
            mut first,
            second,
            ..
        } = self;
        core::iter::repeat_with(move || {
            let here = radial;
            radial = radial.add(first);
            first = first.add(second);
            here
        })
    }

    /// The same run without its first `count` pixels, exactly (count <= length).
    #[inline(always)]
    fn skip(self, count: u16) -> Span<L> {
        let n = i64::from(count);
        let pairs = n * (n - 1) / 2;
        let (radial, first, second) = (
            self.radial.to_wide(),
            self.first.to_wide(),
            self.second.to_wide(),
        );
        Span {
            x: self.x + count,
            length: self.length - count,
            radial: L::from_wide(
                radial
                    .wrapping_add(n.wrapping_mul(first))
                    .wrapping_add(pairs.wrapping_mul(second)),
            ),
            first: L::from_wide(first.wrapping_add(n.wrapping_mul(second))),
            ..self
        }
    }
}

/// A source of spans: one footprint under one traversal.
pub trait Spans {
    /// Word of the spans.
    type Lane: Lane;
    /// Fraction bits of the spans' radial indices; negative indices are rounding noise around 0.
    fn fraction(&self) -> u32;
    /// The next span, rows from top to bottom, each from left to right.
    fn next_span(&mut self) -> Option<Span<Self::Lane>>;
}

/// A quadratic sequence by forward differencing, exact modulo 2^64.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Quadratic {
    value: i64,
    first: i64,
    second: i64,
}

impl Quadratic {
    fn step(&mut self) {
        self.value = self.value.wrapping_add(self.first);
        self.first = self.first.wrapping_add(self.second);
    }

    /// `count` steps at once.
    fn jump(&mut self, count: u16) {
        let n = i64::from(count);
        let pairs = n * (n - 1) / 2;
        self.value = self
            .value
            .wrapping_add(n.wrapping_mul(self.first))
            .wrapping_add(pairs.wrapping_mul(self.second));
        self.first = self.first.wrapping_add(n.wrapping_mul(self.second));
    }
}

/// The cut-off (UQ4.28) in UQ4.radial, rounded to nearest: what a pixel lane compares its radial index with.
#[inline(always)]
pub fn cutoff_in_lane(cutoff: u32, radial: u8) -> u64 {
    crate::math::shift_unsigned(
        cutoff.into(),
        28 - i32::from(radial),
        crate::format::Rounding::Nearest,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn strips_keep_the_columns_and_share_the_rows() {
        let window = Window {
            first: [7, 3],
            end: [9, 13],
        };
        let rows = window.strips(4).map(|strip| {
            assert_eq!([strip.first[0], strip.end[0]], [7, 9]);
            assert!(!strip.is_empty());
            [strip.first[1], strip.end[1]]
        });
        assert!(rows.eq([[3, 7], [7, 11], [11, 13]]));
        for end in [[7, 13], [9, 3], [6, 13], [9, 2]] {
            assert!(Window { end, ..window }.is_empty(), "{end:?}");
        }
    }

    proptest! {
        #[test]
        fn a_jump_is_its_steps(value: i64, first: i64, second: i64, count in 0u16..300) {
            let start = Quadratic { value, first, second };
            let (mut stepped, mut jumped) = (start, start);
            (0..count).for_each(|_| stepped.step());
            jumped.jump(count);
            prop_assert_eq!(stepped, jumped);
        }

        #[test]
        fn a_shortened_run_is_the_rest_of_it(radial: i32, first: i32, second: i32, length in 1u16..100, part in 0.0f64..1.0) {
            let run = Span { y: 0, x: 7, length, radial, first, second };
            let count = (part * f64::from(length)) as u16;
            prop_assert!(run.radials().skip(count.into()).eq(run.skip(count).radials()));
        }
    }
}
