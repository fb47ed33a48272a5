//! Traversal `spans`: only the pixels of each row that lie in the ellipse, by LDL forward differencing.
//!
//! r(x, y) = A (x - xc(y))^2 + C dy^2, xc(y) = u + S dy. Down the rows, xc is a linear and C dy^2 a quadratic sequence
//! in 64-bit integers (Q.32 pixels, Q11.52). A row's half-width is sqrt((c - C dy^2) / A) from the root
//! table; at its start the radial index is seeded by two multiplications and then differenced in the lanes.
//!
//! Three things bound the error. Seeds are taken anew at every multiple of [`BLOCK`] columns. Seeds are balanced: the lanes' second difference
//! is 2 A rounded, and the error e n^2 that this makes n pixels from a block's start is met by the line e (n BLOCK - BLOCK^2/8), which is folded
//! into the constants of the seed, so that an eighth of e BLOCK^2 is left at most (e is up to a quarter of the lanes' unit; [`BLOCK`]^2/32 units).
//! And the slack added to c makes spans include every pixel with r < c for any design, at the price of a few pixels with c <= r < c + 2^-10,
//! which the lane's own comparison rejects.

use super::{Quadratic, Span, Spans, Window};
use crate::footprint::Footprint;
use crate::format::{Design, Lane};
use crate::math::words::shift_word;
use crate::math::{SoftFloat, root_seed, shift_left, shift_round, shift_signed};

/// Columns between two seeds of the radial index within a row.
pub const BLOCK: u16 = 32;

/// Bits of the horizontal factor below the lanes' unit from which the seeds are balanced.
pub const GUARD: u32 = 8;

/// Fraction bits of C dy^2.
const VERTICAL: u32 = 52;

/// Added to the cut-off before the span is computed: 2^-10.
const SLACK: i64 = 1 << (VERTICAL - 10);

/// The runs of one footprint under the traversal `spans`.
#[derive(Clone, Debug)]
pub struct EllipseSpans<L> {
    /// Rows still to come: `y .. end_row`.
    y: u16,
    end_row: u16,
    /// Columns of the footprint's box, and of its part in the window.
    bounds: [u16; 2],
    visible: [u16; 2],
    /// xc - 1/2 in the row to come, Q.32 pixels, and its change per row.
    centre: i64,
    shear: i64,
    /// C dy^2 in the row to come, Q.52.
    vertical: Quadratic,
    /// Cut-off and slack, Q.52.
    reach: i64,
    half_width: HalfWidth,
    seed: Seed<L>,
    row: SpanRow,
}

/// What the rows of one footprint are computed from, for implementations that compute several at once: [`EllipseSpans`] stays their
/// definition.
#[derive(Clone, Copy, Debug)]
pub struct RowConstants<L> {
    /// First row, and one past the last.
    pub rows: [u16; 2],
    /// Columns of the footprint's box, and of its part in the window.
    pub bounds: [u16; 2],
    /// See `bounds`.
    pub visible: [u16; 2],
    /// xc - 1/2 in the first row, Q.32 pixels, and its change per row.
    pub centre: i64,
    /// See `centre`.
    pub shear: i64,
    /// C dy^2 in the first row, its change and the change of its change, Q.52.
    pub vertical: [i64; 3],
    /// Cut-off and slack, Q.52.
    pub reach: i64,
    /// Mantissa of 1 / A, 1 if its exponent is odd, and the power of two of its root, Q.32.
    pub squared_width: (u64, u32, i32),
    /// Mantissa of A.
    pub horizontal: i64,
    /// Right shifts: of dx from Q.32, of A dx, of the radial index and of its difference.
    pub drops: (u32, u32, i32, i32),
    /// Fraction bits of the runs' radial indices.
    pub fraction: u32,
    /// Added to 2 A dx for a run's first difference, and to its first radial index, Q.fraction.
    pub unit: i64,
    /// See `unit`.
    pub start: i64,
    /// 2 A in the lane's word.
    pub second: L,
}

impl<L: Lane> RowConstants<L> {
    /// The same with the lanes' word sign-extended, for implementations that do not tell lanes apart by type.
    #[inline(always)]
    pub fn widened(&self) -> RowConstants<i64> {
        let RowConstants {
            rows,
            bounds,
            visible,
            centre,
            shear,
            vertical,
            reach,
            squared_width,
            horizontal,
            drops,
            fraction,
            unit,
            start,
            second,
        } = *self;
        RowConstants {
            rows,
            bounds,
            visible,
            centre,
            shear,
            vertical,
            reach,
            squared_width,
            horizontal,
            drops,
            fraction,
            unit,
            start,
            second: second.to_wide(),
        }
    }
}

/// Fraction bits of [`RowConstants::vertical`].
pub const VERTICAL_FRACTION: u32 = VERTICAL;

/// What is left of the row being drawn.
#[derive(Clone, Copy, Debug, Default)]
struct SpanRow {
    y: u16,
    x: u16,
    end: u16,
    centre: i64,
    vertical: i64,
}

impl<L: Lane> EllipseSpans<L> {
    /// Prepares the rows of `footprint` that lie in `window`.
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    #[cfg_attr(target_pointer_width = "32", inline)]
    pub fn new<D: Design<Lane = L>>(design: D, footprint: &Footprint, window: &Window) -> Self {
        let widths = design.widths();
        let (subpixel, mantissa) = (u32::from(widths.subpixel), u32::from(widths.mantissa));
        let ldl = &footprint.ldl;
        let bounds = Window::of(footprint);
        let visible = bounds.intersect(window);
        // Distance of the first row's sample points from the centre, in pixels.
        let dy = ((2 * i64::from(bounds.first[1]) + 1) << (subpixel - 1))
            .wrapping_sub(footprint.centre[1]);
        let dy = SoftFloat::from_wide(dy, -(subpixel as i32), mantissa);
        let shear = ldl.shear.to_fixed(32);
        let skipped = visible.first[1] - bounds.first[1];
        let mut vertical = vertical(ldl.vertical, dy, mantissa);
        let mut centre = shift_left(footprint.centre[0], 32 - subpixel)
            .wrapping_sub(1 << 31)
            .wrapping_add(ldl.shear.times(dy).to_fixed(32));
        // Four 64-bit products, which a window that begins above the footprint saves a small processor.
        if skipped > 0 {
            vertical.jump(skipped);
            centre = centre.wrapping_add(shear.wrapping_mul(skipped.into()));
        }
        EllipseSpans {
            y: visible.first[1],
            end_row: if visible.is_empty() {
                0
            } else {
                visible.end[1]
            },
            bounds: [bounds.first[0], bounds.end[0]],
            visible: [visible.first[0], visible.end[0]],
            centre,
            shear,
            vertical,
            reach: (i64::from(footprint.cutoff) << (VERTICAL - 28)) + SLACK,
            half_width: HalfWidth::new(ldl.squared_width),
            seed: Seed::new(
                ldl.horizontal,
                ldl.squared_width,
                mantissa,
                widths.radial.into(),
            ),
            row: SpanRow::default(),
        }
    }

    /// What the rows to come are computed from.
    #[inline(always)]
    pub fn constants(&self) -> RowConstants<L> {
        let (half, seed) = (&self.half_width, &self.seed);
        RowConstants {
            rows: [self.y, self.end_row],
            bounds: self.bounds,
            visible: self.visible,
            centre: self.centre,
            shear: self.shear,
            vertical: [
                self.vertical.value,
                self.vertical.first,
                self.vertical.second,
            ],
            reach: self.reach,
            squared_width: (half.mantissa.into(), half.odd, half.power),
            horizontal: seed.horizontal,
            drops: (seed.drop_dx, seed.bits, seed.drop_radial, seed.drop_first),
            fraction: seed.fraction,
            unit: seed.balance.unit,
            start: seed.balance.start,
            second: seed.second,
        }
    }

    /// Opens the next row: its span within the window, from the block that contains the window's first column.
    #[inline(always)]
    fn next_row(&mut self) {
        let mut row = SpanRow {
            y: self.y,
            x: 0,
            end: 0,
            centre: self.centre,
            vertical: self.vertical.value,
        };
        let rest = self.reach.wrapping_sub(row.vertical);
        if rest > 0 {
            let narrow = self.seed.is_narrow();
            let half = self.half_width.of(rest, narrow);
            let (low, high) = ends(row.centre, half, narrow);
            let [first, last] = self.bounds.map(i32::from);
            // Not `clamp`, which panics if first > last: an open row has first < last, but the compiler cannot know.
            let low = low.min(last).max(first) as u16;
            row.x = low.max(self.visible[0] - self.visible[0] % BLOCK);
            row.end = (high.min(last).max(first) as u16).min(self.visible[1]);
        }
        self.row = row;
        self.y += 1;
        self.centre = self.centre.wrapping_add(self.shear);
        self.vertical.step();
    }

    /// The row's next part up to a multiple of [`BLOCK`], seeded at its own start.
    ///
    /// A window that begins inside a block drops the block's head, so that the seed is the same for every tiling.
    #[inline(always)]
    fn next_block(&mut self) -> Option<Span<L>> {
        let SpanRow {
            y,
            x,
            end,
            centre,
            vertical,
        } = self.row;
        let stop = (x - x % BLOCK).saturating_add(BLOCK).min(end);
        self.row.x = stop;
        let (radial, first, second) = self.seed.at(x, centre, vertical);
        let run = Span {
            y,
            x,
            length: stop - x,
            radial,
            first,
            second,
        };
        let head = self.visible[0].saturating_sub(x);
        if head == 0 {
            return Some(run);
        }
        if head >= run.length {
            None
        } else {
            Some(run.skip(head))
        }
    }
}

impl<L: Lane> Spans for EllipseSpans<L> {
    type Lane = L;

    #[inline(always)]
    fn fraction(&self) -> u32 {
        self.seed.fraction
    }

    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    #[cfg_attr(target_pointer_width = "32", inline)]
    fn next_span(&mut self) -> Option<Span<L>> {
        loop {
            while self.row.x < self.row.end {
                if let Some(run) = self.next_block() {
                    return Some(run);
                }
            }
            if self.y >= self.end_row {
                return None;
            }
            self.next_row();
        }
    }
}

/// First column and one past the last whose sample points lie within `half` of `centre` (xc - 1/2), both Q.32.
///
/// Narrow designs leave out the saturation: setup keeps centres and half-widths below 2^30 pixels.
#[inline(always)]
fn ends(centre: i64, half: i64, narrow: bool) -> (i32, i32) {
    const ALMOST_ONE: i64 = (1 << 32) - 1;
    let (low, high) = if narrow {
        let low = centre.wrapping_sub(half).wrapping_add(ALMOST_ONE);
        (low, centre.wrapping_add(half))
    } else {
        let low = centre.saturating_sub(half).saturating_add(ALMOST_ONE);
        (low, centre.saturating_add(half))
    };
    ((low >> 32) as i32, ((high >> 32) as i32).saturating_add(1))
}

/// C dy^2 and its differences per row, C (2 dy + 1) and 2 C, in Q.52.
#[cfg_attr(not(target_pointer_width = "32"), inline(always))]
fn vertical(coefficient: SoftFloat, dy: SoftFloat, bits: u32) -> Quadratic {
    let along = coefficient.multiply(dy, bits);
    let unit = coefficient.to_fixed(VERTICAL);
    Quadratic {
        value: along.times(dy).to_fixed(VERTICAL),
        first: along.scaled_by(1).to_fixed(VERTICAL).wrapping_add(unit),
        second: unit.wrapping_mul(2),
    }
}

/// sqrt(rest / A): the root table and a multiplication.
#[derive(Clone, Copy, Debug)]
struct HalfWidth {
    mantissa: u32,
    odd: u32,
    power: i32,
}

impl HalfWidth {
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    fn new(squared_width: SoftFloat) -> Self {
        let odd = squared_width.exponent & 1;
        // With rest in Q.28: sqrt(m rest 2^(e - 28)) = root 2^(shift + (e - odd)/2 - 14), then Q.32.
        HalfWidth {
            mantissa: squared_width.mantissa.unsigned_abs(),
            odd: odd as u32,
            power: ((squared_width.exponent - odd) / 2).saturating_add(32 - 14),
        }
    }

    /// Half-width in Q.32 pixels for `rest` in Q.52, 0 < rest < 2^56.
    #[inline(always)]
    fn of(&self, rest: i64, narrow: bool) -> i64 {
        let rest = (rest as u64) >> (VERTICAL - 28);
        let squared = if narrow {
            // 15 bits by 16 and 16 bits.
            let (low, high) = (rest as u32 & 0xffff, rest as u32 >> 16);
            (u64::from(self.mantissa.wrapping_mul(high)) << 16)
                .wrapping_add(self.mantissa.wrapping_mul(low).into())
        } else {
            u64::from(self.mantissa).wrapping_mul(rest)
        };
        let (root, shift) = root_seed(squared << self.odd);
        let root = SoftFloat {
            mantissa: root as i32,
            exponent: shift.saturating_add(self.power),
        };
        root.to_fixed(0)
    }
}

/// Seeds of the lanes: r and its first difference at a column by two multiplications.
///
/// dx is held in as many bits as the mantissa has: its unit is a power of two that follows from the footprint's
/// largest half-width, so that all alignments are constants of the footprint.
#[derive(Clone, Copy, Debug)]
struct Seed<L> {
    horizontal: i64,
    bits: u32,
    fraction: u32,
    /// Right shifts: dx from Q.32, r and its difference to Q.fraction.
    drop_dx: u32,
    drop_radial: i32,
    drop_first: i32,
    balance: Balance,
    second: L,
}

/// The constants of a footprint's seeds, Q.fraction: what the lanes add up stays within `BLOCK^2 / 32` units of A dx^2.
///
/// With the lanes' horizontal factor second/2 = A + e, the sum n first + n (n - 1) second/2 exceeds the truth by e n^2 if first is
/// 2 A dx + second/2. Here first is smaller by e BLOCK and the start larger by e BLOCK^2/8, which leaves e (n^2 - n BLOCK + BLOCK^2/8).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Balance {
    /// 2 A to the nearest unit.
    second: i64,
    /// Added to 2 A dx for the first difference: second/2 - e BLOCK.
    unit: i64,
    /// Added to r: e BLOCK^2/8.
    start: i64,
}

impl Balance {
    /// `fine` is A in Q.(fraction + GUARD); wraps where A saturates, beyond any footprint of two adjacent pixels.
    fn new(fine: i64) -> Self {
        let block = i64::from(BLOCK);
        let second = shift_round(fine, GUARD - 1);
        let rounded = second << (GUARD - 1);
        let excess = rounded.wrapping_sub(fine);
        Balance {
            second,
            unit: shift_round(rounded.wrapping_sub(excess * block), GUARD),
            start: shift_round(excess * block * block / 8, GUARD),
        }
    }
}

impl<L: Lane> Seed<L> {
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    fn new(horizontal: SoftFloat, squared_width: SoftFloat, bits: u32, fraction: u32) -> Self {
        // |dx|^2 <= 16 / A < 2^(leading + 5), hence |dx| < 2^half in pixels.
        let half = squared_width.leading().saturating_add(6) >> 1;
        let drop_dx = half.saturating_add(32 - bits as i32).clamp(0, 63);
        let power = horizontal.exponent.clamp(-1024, 1024) + drop_dx - 32;
        let balance = Balance::new(horizontal.to_fixed(fraction + GUARD));
        Seed {
            horizontal: horizontal.mantissa.into(),
            bits,
            fraction,
            drop_dx: drop_dx as u32,
            drop_radial: -(power + drop_dx - 32 + bits as i32 + fraction as i32),
            drop_first: -(power + 1 + fraction as i32),
            balance,
            second: L::from_wide(balance.second),
        }
    }

    /// Do all products of a seed fit a signed word, and the lanes too? Then they are 32-bit products, with the same bits for every
    /// footprint of setup: |dx| is below `2^bits` within its rows.
    #[inline(always)]
    fn is_narrow(&self) -> bool {
        self.bits <= 15 && L::BITS == 32
    }

    /// r = A dx^2 + vertical, its difference A (2 dx + 1) and 2 A at column `x`, balanced; `centre` is xc - 1/2 in Q.32.
    #[inline(always)]
    fn at(&self, x: u16, centre: i64, vertical: i64) -> (L, L, L) {
        let dx = (i64::from(x) << 32).wrapping_sub(centre);
        if self.is_narrow() {
            let dx = shift_signed(dx, self.drop_dx as i32) as i32;
            let along = (self.horizontal as i32).wrapping_mul(dx);
            let across = shift_word(along, self.bits as i32).wrapping_mul(dx);
            let radial = shift_word(across, self.drop_radial)
                .wrapping_add(shift_round(vertical, VERTICAL - self.fraction) as i32)
                .wrapping_add(self.balance.start as i32);
            let first = shift_word(along, self.drop_first).wrapping_add(self.balance.unit as i32);
            return (
                L::from_wide(radial.into()),
                L::from_wide(first.into()),
                self.second,
            );
        }
        let dx = shift_round(dx, self.drop_dx);
        let along = self.horizontal.wrapping_mul(dx);
        let across = shift_round(along, self.bits).wrapping_mul(dx);
        let radial = shift_signed(across, self.drop_radial)
            .wrapping_add(shift_round(vertical, VERTICAL - self.fraction))
            .wrapping_add(self.balance.start);
        let first = shift_signed(along, self.drop_first).wrapping_add(self.balance.unit);
        (L::from_wide(radial), L::from_wide(first), self.second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The oracle is the parabola itself, in units of the lanes' last place.
        #[test]
        fn balanced_differences_stay_close_to_the_parabola(fine in 0i64..1 << 40, dx in -64.0f64..64.0) {
            let Balance { second, unit, start } = Balance::new(fine);
            let horizontal = fine as f64 / f64::from(1 << GUARD);
            // The part of the first difference that depends on dx, rounded as the seed rounds it.
            let along = (2.0 * horizontal * dx).round();
            let (mut radial, mut first) = (start as f64, along + unit as f64);
            for n in 0..=i32::from(BLOCK) {
                let exact = horizontal * f64::from(n * n) + 2.0 * horizontal * dx * f64::from(n);
                // A quarter of BLOCK^2/8, and the roundings of both parts of the first difference.
                let bound = f64::from(BLOCK).powi(2) / 32.0 + f64::from(n) + 1.0;
                prop_assert!((radial - exact).abs() <= bound, "{n}: {}", radial - exact);
                radial += first;
                first += second as f64;
            }
        }

        #[test]
        fn every_curvature_is_defined(fine: i64) {
            let _ = Balance::new(fine);
        }
    }
}
