//! Traversal `spans`: only the pixels of each row that lie in the ellipse, by LDL forward differencing.
//!
//! r(x, y) = A (x - xc(y))^2 + C dy^2, xc(y) = u + S dy. Both ways are differenced alike, from seeds on absolute blocks: down the rows, xc is a
//! linear and C dy^2 a quadratic sequence with a seed at every multiple of [`BLOCK`] rows; along a row, r is a quadratic sequence with a seed at
//! every multiple of [`BLOCK`] columns. A row's half-width is sqrt((c - C dy^2) / A) from the root table. What a window leaves out is stepped over,
//! at most a block less one row, so that pictures do not depend on tiles, and nothing is jumped over by products.
//!
//! **Row seeds.** The block of row y begins at `y0 = max(y - y mod BLOCK, first row of the box)`. With M = mantissa and round() to nearest, halves up:
//!
//! | word | format | at row y0 | per row |
//! |---|---|---|---|
//! | dy | M bits | round(y0 + 1/2 - v), exact in Q.subpixel before | |
//! | xc - 1/2 | Q.f | round(u - 1/2) + round(S dy), the product exact | round(S) |
//! | C dy^2 | Q.g | round(round_M(C dy) dy) + start, the product with dy exact | first |
//! | first | Q.g | round(2 round_M(C dy)) + unit | second |
//!
//! f = subpixel + 8: what 31 steps of half a unit add up to is an eighth of the centre's own rounding. Words of 28 + subpixel bits hold that
//! (40 for lean18), since a span that meets the screen within a block then begins within 2^19 pixels of it. Where half-widths may reach 2^13 pixels or
//! rows are 2^12 apart (2^half > 2^13 below, or |S| >= 2^13) f = subpixel - 2, in as many bits. Here xc is kept in Q.32, its lower bits 0.
//!
//! g = max(radial, 22) + 4, and C dy^2 is below 32 within the box of a footprint of setup: g + 6 bits, 32 for radial indices of up to 22 and 37 for
//! standard24. start, unit and second are the balance of C, as those of the columns are of A:
//!
//! **Balance.** A second difference is 2 A (2 C) rounded, and the error e n^2 that this makes n steps from a block's start is met by the line
//! e (n BLOCK - BLOCK^2/8), which is folded into the constants of the seed, so that an eighth of e BLOCK^2 is left at most (e is up to a quarter of
//! the sequence's unit; [`BLOCK`]^2/32 units).
//!
//! The slack added to c makes spans include every pixel with r < c for any design, at the price of a few pixels with c <= r < c + 2^-10, which the
//! lane's own comparison rejects.

use super::seeds::{BLOCK, RowSeeds, Seed, vertical_fraction};
use super::{Quadratic, Span, Spans, Window};
use crate::footprint::Footprint;
use crate::format::{Design, Lane, Widths};
use crate::math::{SoftFloat, root_seed, shift_signed};

/// Fraction bits of what a row leaves of the cut-off, from which its half-width follows: with 18 bits of 1 / A two products of words.
pub const REST: u32 = 24;

/// Added to the cut-off before the span is computed: 2^-10.
const SLACK: u32 = 10;

/// The runs of one footprint under the traversal `spans`.
#[derive(Clone, Debug)]
pub struct EllipseSpans<D: Design> {
    /// Rows still to come: `y .. end_row`.
    y: u16,
    end_row: u16,
    /// Columns of the footprint's box, and of its part in the window.
    bounds: [u16; 2],
    visible: [u16; 2],
    seeds: RowSeeds,
    /// xc - 1/2 in the row to come, Q.32 pixels.
    centre: i64,
    /// C dy^2 in the row to come.
    vertical: Quadratic,
    /// Cut-off and slack, in the unit of C dy^2.
    reach: i64,
    half_width: HalfWidth,
    seed: Seed<D>,
    row: SpanRow,
}

/// Blocks of rows whose seeds [`RowConstants`] hold: a window of 64 rows touches no more.
pub const ROW_BLOCKS: usize = 3;

/// The rows of one footprint in one block.
#[derive(Clone, Copy, Debug, Default)]
pub struct RowBlock {
    /// One past the last row.
    pub end: u16,
    /// xc - 1/2 in the first row, Q.32 pixels.
    pub centre: i64,
    /// C dy^2 in the first row, and its change.
    pub vertical: [i64; 2],
}

/// What the rows of one footprint are computed from, for implementations that compute several at once: [`EllipseSpans`] stays their
/// definition.
#[derive(Clone, Copy, Debug)]
pub struct RowConstants<L> {
    /// First row, and one past the last of those whose seeds are here.
    pub rows: [u16; 2],
    /// Blocks of rows, the first from the first row of all; blocks without rows end where the one before ends.
    pub blocks: [RowBlock; ROW_BLOCKS],
    /// Columns of the footprint's box, and of its part in the window.
    pub bounds: [u16; 2],
    /// See `bounds`.
    pub visible: [u16; 2],
    /// Change of xc per row, Q.32 pixels.
    pub shear: i64,
    /// Change of the change of C dy^2.
    pub curve: i64,
    /// Fraction bits of C dy^2, its changes and `reach`.
    pub vertical_fraction: u32,
    /// Cut-off and slack.
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
            blocks,
            bounds,
            visible,
            shear,
            curve,
            vertical_fraction,
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
            blocks,
            bounds,
            visible,
            shear,
            curve,
            vertical_fraction,
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

/// What is left of the row being drawn.
#[derive(Clone, Copy, Debug, Default)]
struct SpanRow {
    y: u16,
    x: u16,
    end: u16,
    centre: i64,
    /// C dy^2 in the lanes' unit, with what balances a run.
    vertical: i64,
}

impl<D: Design> EllipseSpans<D> {
    /// Prepares the rows of `footprint` that lie in `window`.
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    #[cfg_attr(target_pointer_width = "32", inline)]
    pub fn new(design: D, footprint: &Footprint, window: &Window) -> Self {
        let ldl = &footprint.ldl;
        let bounds = Window::of(footprint);
        let visible = bounds.intersect(window);
        let fraction = vertical_fraction(&design.widths());
        let seeds = RowSeeds::new(&design.widths(), footprint);
        let y = visible.first[1];
        let origin = bounds.first[1].max(y - y % BLOCK);
        let (centre, vertical) = seeds.at(origin);
        let mut rows = EllipseSpans {
            y,
            end_row: if visible.is_empty() {
                0
            } else {
                visible.end[1]
            },
            bounds: [bounds.first[0], bounds.end[0]],
            visible: [visible.first[0], visible.end[0]],
            centre,
            vertical,
            reach: shift_signed(footprint.cutoff.into(), 28 - fraction as i32)
                + (1 << (fraction - SLACK)),
            half_width: HalfWidth::new(ldl.squared_width),
            seed: Seed::new(design, ldl, 32 - seeds.centre_fraction),
            seeds,
            row: SpanRow::default(),
        };
        for _ in origin..y {
            rows.step();
        }
        rows
    }

    /// What the rows to come are computed from.
    #[inline(always)]
    pub fn constants(&self) -> RowConstants<D::Lane> {
        let (half, seed) = (&self.half_width, &self.seed);
        let bits = seed.design.widths().mantissa.into();
        let mut rows = [self.y, self.y.max(self.end_row)];
        let mut next = RowBlock {
            end: self.y,
            centre: self.centre,
            vertical: [self.vertical.value, self.vertical.first],
        };
        let blocks = core::array::from_fn(|_| {
            let y = next.end;
            if y != rows[0] && y < rows[1] {
                let (centre, Quadratic { value, first, .. }) = self.seeds.at(y);
                (next.centre, next.vertical) = (centre, [value, first]);
            }
            next.end = (y - y % BLOCK).saturating_add(BLOCK).min(rows[1]);
            next
        });
        rows[1] = next.end;
        RowConstants {
            rows,
            blocks,
            bounds: self.bounds,
            visible: self.visible,
            shear: self.seeds.shear_per_row,
            curve: self.vertical.second,
            vertical_fraction: self.seeds.vertical_fraction,
            reach: self.reach,
            squared_width: (half.mantissa.into(), half.odd, half.power),
            horizontal: seed.horizontal,
            drops: (seed.drop_dx, bits, seed.drop_radial, seed.drop_first),
            fraction: self.fraction(),
            unit: seed.balance.unit,
            start: seed.balance.start,
            second: seed.second,
        }
    }

    /// On to the next row of the block.
    #[inline(always)]
    fn step(&mut self) {
        self.centre = self.centre.wrapping_add(self.seeds.shear_per_row);
        self.vertical.step();
    }

    /// Opens the next row: its span within the window, from the block that contains the window's first column.
    ///
    /// Small processors call it, so that what a run needs is not computed before it is known whether a row begins.
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    fn next_row(&mut self) {
        let mut row = SpanRow {
            y: self.y,
            x: 0,
            end: 0,
            centre: self.centre,
            vertical: 0,
        };
        let rest = self.seed.rest(self.reach, self.vertical.value);
        if rest > 0 {
            row.vertical = self.seed.down(self.vertical.value);
            let half = self.half_width.of(rest, &self.seed.design.widths());
            let (low, high) = ends(row.centre, half, self.seed.is_narrow());
            let [first, last] = self.bounds.map(i32::from);
            // Not `clamp`, which panics if first > last: an open row has first < last, but the compiler cannot know.
            let low = low.min(last).max(first) as u16;
            row.x = low.max(self.visible[0] - self.visible[0] % BLOCK);
            row.end = (high.min(last).max(first) as u16).min(self.visible[1]);
        }
        self.row = row;
        self.y += 1;
        if self.y.is_multiple_of(BLOCK) && self.y < self.end_row {
            (self.centre, self.vertical) = self.seeds.at(self.y);
        } else {
            self.step();
        }
    }

    /// The row's next part up to a multiple of [`BLOCK`], seeded at its own start.
    ///
    /// A window that begins inside a block drops the block's head, so that the seed is the same for every tiling.
    #[inline(always)]
    fn next_block(&mut self) -> Option<Span<D::Lane>> {
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

impl<D: Design> Spans for EllipseSpans<D> {
    type Lane = D::Lane;

    #[inline(always)]
    fn fraction(&self) -> u32 {
        self.seed.design.widths().radial.into()
    }

    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    #[cfg_attr(target_pointer_width = "32", inline)]
    fn next_span(&mut self) -> Option<Span<D::Lane>> {
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
        // With rest in Q.24: sqrt(m rest 2^(e - 24)) = root 2^(shift + (e - odd)/2 - 12), then Q.32.
        HalfWidth {
            mantissa: squared_width.mantissa.unsigned_abs(),
            odd: odd as u32,
            power: ((squared_width.exponent - odd) / 2).saturating_add(32 - REST as i32 / 2),
        }
    }

    /// Half-width in Q.32 pixels for `rest` in the unit of C dy^2, 0 < rest < 32.
    #[inline(always)]
    fn of(&self, rest: i64, widths: &Widths) -> i64 {
        let rest = (rest as u64) >> (vertical_fraction(widths) - REST);
        let squared = if widths.mantissa <= 17 {
            // 18 bits by 14 and 14 bits.
            let mantissa = self.mantissa << self.odd;
            let (low, high) = (rest as u32 & 0x3fff, rest as u32 >> 14);
            (u64::from(mantissa.wrapping_mul(high)) << 14)
                .wrapping_add(mantissa.wrapping_mul(low).into())
        } else {
            u64::from(self.mantissa).wrapping_mul(rest) << self.odd
        };
        let (root, shift) = root_seed(squared);
        let root = SoftFloat {
            mantissa: root as i32,
            exponent: shift.saturating_add(self.power),
        };
        root.to_fixed(0)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::super::seeds::{Balance, GUARD, centre_fraction, in_q32};
    use super::*;
    use crate::footprint::Ldl;
    use crate::format::{Lean18, Micro16, RuntimeWidths, Standard24};
    use proptest::prelude::*;

    /// Short words give the half-widths that long ones give, to the last bit of what is left of the cut-off.
    #[test]
    fn half_widths_of_short_mantissas() {
        let short = Micro16::WIDTHS;
        let long = Widths {
            mantissa: 18,
            ..short
        };
        let unit = vertical_fraction(&short) - REST;
        for variance in [0.7, 1.0, 3.3, 900.0] {
            let half = HalfWidth::new(soft(variance, short.mantissa.into()));
            for rest in (1..64).chain([0x3fff, 0x4001, 0xffffff, 0x1000003]) {
                assert_eq!(half.of(rest << unit, &short), half.of(rest << unit, &long));
            }
        }
        let fraction = |radial| vertical_fraction(&Widths { radial, ..short });
        assert_eq!([10, 21, 22, 23, 27].map(fraction), [26, 26, 26, 27, 31]);
    }

    /// A number rounded to a mantissa.
    fn soft(value: f64, bits: u32) -> SoftFloat {
        let exponent = value.abs().log2().floor() as i32 + 1 - bits as i32;
        SoftFloat::from_wide(
            (value * f64::from(-exponent).exp2()).round() as i64,
            exponent,
            bits,
        )
    }

    /// The footprint of an ellipse with these semi-axes, the first of which points along `direction`, up to r = 11.
    fn ellipse(
        widths: &Widths,
        centre: [f64; 2],
        [length, thickness]: [f64; 2],
        [cos, sin]: [f64; 2],
    ) -> Footprint {
        let [long, thin] = [length * length, thickness * thickness];
        let xx = long * cos * cos + thin * sin * sin;
        let xy = (long - thin) * sin * cos;
        let yy = long * sin * sin + thin * cos * cos;
        let bits = widths.mantissa.into();
        let side = |axis: usize, variance: f64, limit: f64| {
            let reach = (11.0 * variance).sqrt() * (1.0 + 1e-3);
            let [low, high] = [centre[axis] - reach, centre[axis] + reach];
            [
                (low - 0.5).ceil().clamp(0.0, limit) as u16,
                (high + 0.5).floor().clamp(0.0, limit) as u16,
            ]
        };
        let [columns, rows] = [side(0, xx, 8192.0), side(1, yy, 4096.0)];
        Footprint {
            centre: centre.map(|c| (c * f64::from(widths.subpixel).exp2()).round() as i64),
            first: [columns[0], rows[0]],
            end: [columns[1], rows[1]],
            ldl: Ldl {
                horizontal: soft(yy / (long * thin), bits),
                squared_width: soft(long * thin / yy, bits),
                shear: if xy == 0.0 {
                    SoftFloat::ZERO
                } else {
                    soft(xy / yy, bits)
                },
                vertical: soft(1.0 / yy, bits),
            },
            cutoff: 11 << 28,
            ..Footprint::EMPTY
        }
    }

    fn runs<D: Design>(mut rows: EllipseSpans<D>) -> std::vec::Vec<Span<D::Lane>> {
        core::iter::from_fn(|| rows.next_span()).collect()
    }

    /// A window without rows shows none, and one that begins where a row's span ends has no empty run.
    #[test]
    fn what_is_seen_has_pixels() {
        let footprint = ellipse(&Lean18::WIDTHS, [9.5, 3.5], [5.0, 2.0], [1.0, 0.0]);
        let seen = |first, end| {
            runs(EllipseSpans::new(
                Lean18,
                &footprint,
                &Window { first, end },
            ))
        };
        assert!(!seen([0; 2], [40, 40]).is_empty());
        for (first, end) in [([0, 0], [40, 0]), ([0, 3], [40, 3]), ([9, 0], [9, 40])] {
            assert_eq!(seen(first, end).len(), 0, "{first:?} to {end:?}");
        }
        for column in 0..40 {
            let runs = seen([column, 0], [40, 40]);
            assert!(
                runs.iter().all(|run| run.length > 0),
                "from column {column}"
            );
        }
    }

    /// Blocks of rows begin as rows that are stepped through do, and end with what is there.
    #[test]
    fn constants_are_those_of_the_rows() {
        let footprint = ellipse(&Lean18::WIDTHS, [70.3, 90.2], [20.0, 60.0], [0.8, 0.6]);
        for (first, end) in [(5, 49), (37, 64), (40, 200), (64, 65), (70, 70)] {
            let window = Window {
                first: [0, first],
                end: [200, end],
            };
            let mut rows = EllipseSpans::new(Lean18, &footprint, &window);
            let constants = rows.constants();
            let last = end
                .min(first / BLOCK * BLOCK + 3 * BLOCK)
                .min(footprint.end[1]);
            assert_eq!(constants.rows, [first, last.max(first)]);
            let mut begun = first;
            for block in constants.blocks {
                assert_eq!(
                    block.end,
                    (begun / BLOCK * BLOCK + BLOCK).min(last).max(first)
                );
                if begun == block.end {
                    continue;
                }
                let Quadratic { value, first, .. } = rows.vertical;
                assert_eq!(
                    (block.centre, block.vertical),
                    (rows.centre, [value, first])
                );
                (begun..block.end).for_each(|_| rows.next_row());
                begun = block.end;
            }
        }
    }

    /// Ends beyond the word are its ends, where widths allow them; designs of short mantissas and short lanes take short words.
    #[test]
    fn short_words_are_taken_where_they_suffice() {
        assert_eq!(ends(i64::MAX, i64::MAX, false), (0, i32::MAX));
        assert_eq!(ends(i64::MAX, i64::MAX, true), (0, 0));
        let micro = Seed::new(Micro16, &Footprint::EMPTY.ldl, 0);
        assert!(micro.is_narrow());
        let wide = RuntimeWidths::<i64>::new(Micro16::WIDTHS).unwrap();
        assert!(!Seed::new(wide, &Footprint::EMPTY.ldl, 0).is_narrow());
        let far = Ldl {
            squared_width: SoftFloat {
                mantissa: 1 << 14,
                exponent: 200,
            },
            ..Footprint::EMPTY.ldl
        };
        assert_eq!(Seed::new(Micro16, &far, 0).drop_dx, 63);
        assert_eq!(in_q32(1, 31), 2);
    }

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

        /// What hardware holds of xc (28 + subpixel bits, a seed saturated) and of C dy^2 (g + 6 bits) gives the same spans, for low-passed
        /// splats of any size that meet the screen or not. Variances and box come from double precision.
        #[test]
        fn short_row_words_give_the_same_spans(
            [length, thickness] in [-1.0f64..25.0, -0.85..20.0], angle in prop_oneof![-1.6..1.6f64, -1e-3..1e-3f64, -1e-6..1e-6f64],
            [x, y] in [-100.0..8300.0, -100.0..4200.0f64], along in -4.0..4.0f64, wide: bool,
        ) {
            let widths = if wide { Standard24::WIDTHS } else { Lean18::WIDTHS };
            let (length, thickness) = (length.max(thickness).exp2(), thickness.exp2());
            let (sin, cos) = f64::sin_cos(angle);
            let centre = [x - along * length * cos, y - along * length * sin];
            prop_assume!(centre.iter().all(|c: &f64| c.abs() < 26f64.exp2()));
            let footprint = ellipse(&widths, centre, [length, thickness], [cos, sin]);
            let window = Window { first: [0; 2], end: [8192, 4096] };
            let mut rows = EllipseSpans::new(RuntimeWidths::new(widths).unwrap(), &footprint, &window);
            let bits = 28 + u32::from(widths.subpixel);
            let drop = 32 - rows.seeds.centre_fraction;
            let mut word = rows.centre >> drop;
            while rows.y < rows.end_row {
                if rows.y.is_multiple_of(BLOCK) || rows.y == footprint.first[1] {
                    word = (rows.centre >> drop).clamp(-1 << (bits - 1), (1 << (bits - 1)) - 1);
                }
                prop_assert!(rows.vertical.value.unsigned_abs() >> (rows.seeds.vertical_fraction + 5) == 0);
                let rest = rows.reach - rows.vertical.value;
                if rest > 0 {
                    let half = rows.half_width.of(rest, &widths);
                    let span = |centre| {
                        let (low, high) = ends(centre, half, false);
                        (low.clamp(0, 8192), high.clamp(0, 8192))
                    };
                    let (narrow, full) = (span(word << drop), span(rows.centre));
                    prop_assert!(narrow == full || narrow.0 >= narrow.1 && full.0 >= full.1, "{narrow:?} {full:?}");
                }
                word = word.wrapping_add(rows.seeds.shear_per_row >> drop) << (64 - bits) >> (64 - bits);
                rows.next_row();
            }
        }

        #[test]
        fn every_curvature_is_defined(fine: i64) {
            let _ = Balance::new(fine);
        }
    }

    #[test]
    fn centres_of_wide_or_sheared_rows_have_fewer_bits() {
        let shear = |leading: i32| SoftFloat {
            mantissa: 1 << 17,
            exponent: leading - 17,
        };
        let bits = |half, leading| centre_fraction(16, half, shear(leading));
        assert_eq!([bits(13, 12), bits(14, 12), bits(13, 13)], [24, 14, 14]);
    }

    /// A row that the cut-off leaves nothing has no run, and one that it leaves the least has the pixel at its centre.
    #[test]
    fn the_least_rest_has_a_pixel() {
        let footprint = ellipse(&Lean18::WIDTHS, [9.5, 3.5], [5.0, 2.0], [1.0, 0.0]);
        let window = Window {
            first: [0; 2],
            end: [40, 40],
        };
        for (rest, length) in [(-1, 0), (0, 0), (1, 1), (1 << 10, 1)] {
            let mut rows = EllipseSpans::new(Lean18, &footprint, &window);
            rows.reach = rows.vertical.value + rest;
            rows.next_row();
            assert_eq!(
                rows.row.end - rows.row.end.min(rows.row.x),
                length,
                "{rest}"
            );
        }
    }

    #[test]
    fn runs_are_these() {
        fn words<D: Design>(design: D, next: &mut impl FnMut() -> u64) -> u64 {
            let widths = design.widths();
            let mut part = |most: f64| (next() >> 11) as f64 / 2f64.powi(53) * most;
            let ellipses = (0..60).flat_map(|_| {
                // No function that another platform rounds otherwise.
                let t = part(2.0) - 1.0;
                let (sin, cos) = (2.0 * t / (1.0 + t * t), (1.0 - t * t) / (1.0 + t * t));
                let size = [0.6 + part(40.0), 0.6 + part(9.0)];
                let footprint = ellipse(&widths, [part(99.0), part(99.0)], size, [cos, sin]);
                let window = Window {
                    first: [part(60.0) as u16, part(60.0) as u16],
                    end: [100; 2],
                };
                let runs = runs(EllipseSpans::new(design, &footprint, &window));
                runs.into_iter().flat_map(|run| {
                    let place =
                        u64::from(run.y) << 32 | u64::from(run.x) << 16 | u64::from(run.length);
                    [
                        place,
                        run.radial.to_wide() as u64,
                        run.first.to_wide() as u64,
                        run.second.to_wide() as u64,
                    ]
                })
            });
            crate::digest(ellipses)
        }
        let mut next = crate::random();
        let found = [
            words(Micro16, &mut next),
            words(Lean18, &mut next),
            words(Standard24, &mut next),
        ];
        assert_eq!(
            found,
            [
                4_375_629_308_115_381_701,
                15_048_125_114_524_728_255,
                6_404_172_405_956_369_961
            ]
        );
    }
}
