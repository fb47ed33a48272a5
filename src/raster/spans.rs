//! Traversal `spans`: only the pixels of each row that lie in the ellipse, by LDL forward differencing.
//!
//! r(x, y) = A (x - xc(y))^2 + C dy^2, xc(y) = u + S dy. Both ways are differenced alike, from seeds on absolute
//! blocks: down the rows, xc is a linear and C dy^2 a quadratic sequence with a seed at every multiple of [`BLOCK`]
//! rows; along a row, r is a quadratic sequence with a seed at every multiple of [`BLOCK`] columns. A row's half-width
//! is sqrt((c - C dy^2) / A) from the root table. What a window leaves out is stepped over, at most a block less one
//! row, so that pictures do not depend on tiles, and nothing is jumped over by products.
//!
//! **Row seeds.** The block of row y begins at `y0 = max(y - y mod BLOCK, first row of the box)`. With M = mantissa and
//! round() to nearest, halves up:
//!
//! | word | format | at row y0 | per row |
//! |---|---|---|---|
//! | dy | M bits | round(y0 + 1/2 - v), exact in Q.subpixel before | |
//! | xc - 1/2 | Q.f | round(u - 1/2) + round(S dy), the product exact | round(S) |
//! | C dy^2 | Q.g | round(round_M(C dy) dy) + start, the product with dy exact | first |
//! | first | Q.g | round(2 round_M(C dy)) + unit | second |
//!
//! f = subpixel + 8: what 31 steps of half a unit add up to is an eighth of the centre's own rounding. Words of 28 +
//! subpixel bits hold that (40 for lean18), since a span that meets the screen within a block then begins within 2^19
//! pixels of it. Where half-widths may reach 2^13 pixels or rows are 2^12 apart (2^half > 2^13 below, or |S| >= 2^13)
//! f = subpixel - 2, in as many bits. Here xc is kept in Q.32, its lower bits 0.
//!
//! g = max(radial, 22) + 4, and C dy^2 is below 32 within the box of a footprint of setup: g + 6 bits, 32 for radial
//! indices of up to 22 and 37 for standard24. start, unit and second are the balance of C, as those of the columns are
//! of A:
//!
//! **Balance.** A second difference is 2 A (2 C) rounded, and the error e n^2 that this makes n steps from a block's
//! start is met by the line e (n BLOCK - BLOCK^2/8), which is folded into the constants of the seed, so that an eighth
//! of e BLOCK^2 is left at most (e is up to a quarter of the sequence's unit; [`BLOCK`]^2/32 units).
//!
//! The slack added to c makes spans include every pixel with r < c for any design, at the price of a few pixels with c
//! <= r < c + 2^-10, which the lane's own comparison rejects.

use super::seeds::{BLOCK, RowSeeds, Seed, centre_fraction, reach_of_rows, vertical_fraction};
use super::{Quadratic, Span, Spans, Window};
use crate::footprint::Footprint;
use crate::format::{Design, Widths};
use crate::math::words::shifted_up;
use crate::math::{SoftFloat, root_of, root_seed, shift_signed};

/// Fraction bits of what a row leaves of the cut-off, from which its half-width follows: with 18 bits of 1 / A two
/// products of words.
pub const REST: u32 = 24;

/// Added to the cut-off before the span is computed: 2^-10.
const SLACK: u32 = 10;

/// The runs of one footprint under the traversal `spans`.
#[derive(Clone, Debug)]
pub struct EllipseSpans<D: Design> {
    /// Rows still to come: `y .. end_row`.
    y: u16,
    end_row: u16,
    /// First row of the footprint's box.
    first_row: u16,
    /// Columns of the footprint's box, and of its part in the window.
    bounds: [u16; 2],
    visible: [u16; 2],
    /// First column in the box of the block that the window begins in.
    begin: u16,
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

/// What the rows of one footprint are computed from, for implementations that compute several at once: [`EllipseSpans`]
/// stays their definition.
#[derive(Clone, Copy, Debug, Default)]
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
    #[inline(always)]
    pub fn new(design: D, footprint: &Footprint, window: &Window) -> Self {
        let mut rows = EllipseSpans::unplaced(design, footprint, window);
        rows.place();
        rows
    }

    /// The same without the first row's words, which [`place`](EllipseSpans::place) adds: small processors would copy
    /// what is changed before it is returned.
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    #[cfg_attr(target_pointer_width = "32", inline)]
    pub(crate) fn unplaced(design: D, footprint: &Footprint, window: &Window) -> Self {
        let ldl = &footprint.ldl;
        let bounds = Window::of(footprint);
        let visible = bounds.intersect(window);
        let widths = design.widths();
        let fraction = vertical_fraction(&widths);
        let half = reach_of_rows(ldl.squared_width);
        let centre_fraction = centre_fraction(widths.subpixel.into(), half, ldl.shear);
        EllipseSpans {
            y: visible.first[1],
            first_row: bounds.first[1],
            end_row: if visible.is_empty() {
                0
            } else {
                visible.end[1]
            },
            bounds: [bounds.first[0], bounds.end[0]],
            visible: [visible.first[0], visible.end[0]],
            begin: bounds.first[0].max(visible.first[0] - visible.first[0] % BLOCK),
            seeds: RowSeeds::new(&widths, footprint, centre_fraction),
            centre: 0,
            vertical: Quadratic::default(),
            reach: shift_signed(footprint.cutoff.into(), 28 - fraction as i32)
                + (1 << (fraction - SLACK)),
            half_width: HalfWidth::new(ldl.squared_width),
            seed: Seed::new(design, ldl, half, 32 - centre_fraction),
            row: SpanRow::default(),
        }
    }

    /// Goes to the first row from the seed of its block.
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    pub(crate) fn place(&mut self) {
        let origin = self.first_row.max(self.y - self.y % BLOCK);
        (self.centre, self.vertical) = self.seeds.at(self.seed.design, origin);
        for _ in origin..self.y {
            self.step();
        }
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
        let mut blocks = [next; ROW_BLOCKS];
        for block in &mut blocks {
            let y = next.end;
            if y != rows[0] && y < rows[1] {
                let (centre, Quadratic { value, first, .. }) = self.seeds.at(self.seed.design, y);
                (next.centre, next.vertical) = (centre, [value, first]);
            }
            next.end = (y - y % BLOCK).saturating_add(BLOCK).min(rows[1]);
            *block = next;
        }
        rows[1] = next.end;
        RowConstants {
            rows,
            blocks,
            bounds: self.bounds,
            visible: self.visible,
            shear: self.seeds.shear_per_row,
            curve: self.vertical.second,
            vertical_fraction: vertical_fraction(&seed.design.widths()),
            reach: self.reach,
            squared_width: ((half.mantissa >> half.odd).into(), half.odd, half.power),
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
    #[inline(always)]
    fn next_row(&mut self) -> SpanRow {
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
            let low = low.max(self.begin.into());
            let high = high.min(self.visible[1].into());
            if low < high {
                (row.x, row.end) = (low as u16, high as u16);
            }
        }
        self.y += 1;
        if self.y.is_multiple_of(BLOCK) && self.y < self.end_row {
            (self.centre, self.vertical) = self.seeds.at(self.seed.design, self.y);
        } else {
            self.step();
        }
        row
    }

    /// The next part of the row, or of the next row. Not a loop, before which small processors would load all that any
    /// turn may need.
    #[cfg_attr(not(target_pointer_width = "32"), inline(always))]
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    fn next_part(&mut self) -> Option<Span<D::Lane>> {
        let row = if self.row.x < self.row.end {
            self.row
        } else {
            self.next_row()
        };
        if row.x < row.end {
            self.next_block(row)
        } else {
            None
        }
    }

    /// The row's next part up to a multiple of [`BLOCK`], seeded at its own start.
    ///
    /// A window that begins inside a block drops the block's head, so that the seed is the same for every tiling.
    #[inline(always)]
    fn next_block(&mut self, row: SpanRow) -> Option<Span<D::Lane>> {
        let SpanRow {
            y,
            x,
            end,
            centre,
            vertical,
        } = row;
        let stop = (u32::from(x | (BLOCK - 1)) + 1).min(end.into()) as u16;
        // What is left is kept, which of most rows is nothing.
        self.row.end = 0;
        if stop < end {
            self.row = SpanRow { x: stop, ..row };
        }
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

    #[inline(always)]
    fn next_span(&mut self) -> Option<Span<D::Lane>> {
        while self.row.x < self.row.end || self.y < self.end_row {
            let run = self.next_part();
            if run.is_some() {
                return run;
            }
        }
        None
    }
}

/// First column and one past the last whose sample points lie within `half` of `centre` (xc - 1/2), both Q.32.
///
/// Narrow designs leave out the saturation: setup keeps centres and half-widths below 2^30 pixels.
#[inline(always)]
fn ends(centre: i64, half: i64, narrow: bool) -> (i32, i32) {
    const ALMOST_ONE: i64 = (1 << 32) - 1;
    if narrow {
        let low = centre.wrapping_sub(half).wrapping_add(ALMOST_ONE);
        let high = centre.wrapping_add(half);
        return ((low >> 32) as i32, ((high >> 32) as i32).wrapping_add(1));
    }
    let low = centre.saturating_sub(half).saturating_add(ALMOST_ONE);
    let high = centre.saturating_add(half);
    ((low >> 32) as i32, ((high >> 32) as i32).saturating_add(1))
}

/// sqrt(rest / A): the root table and a multiplication.
#[derive(Clone, Copy, Debug)]
struct HalfWidth {
    /// Of 1 / A, twice as much where its exponent is odd.
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
            mantissa: squared_width.mantissa.unsigned_abs() << odd,
            odd: odd as u32,
            power: ((squared_width.exponent - odd) / 2).saturating_add(32 - REST as i32 / 2),
        }
    }

    /// Half-width in Q.32 pixels for `rest` in the unit of C dy^2, 0 < rest < 32.
    #[inline(always)]
    fn of(&self, rest: i64, widths: &Widths) -> i64 {
        let rest = ((rest as u64) >> (vertical_fraction(widths) - REST)) as u32;
        let by_words = match widths.mantissa {
            0..=15 => self.short_root(rest),
            16..=18 => self.split_root(rest),
            _ => None,
        };
        let (root, shift) = by_words
            .unwrap_or_else(|| root_seed(u64::from(self.mantissa).wrapping_mul(rest.into())));
        let exponent = shift.wrapping_add(self.power);
        match exponent as u32 {
            // What most rows are, in line.
            up @ 0..32 => shifted_up(root.into(), up) as i64,
            _ => SoftFloat {
                mantissa: root as i32,
                exponent,
            }
            .to_fixed(0),
        }
    }

    /// [`root_seed`] of the product of 16 bits with 29 in words, where it is not small: what lies 14 bits up in it has
    /// the 24 bits that count.
    #[inline(always)]
    fn short_root(&self, rest: u32) -> Option<(u32, i32)> {
        let (low, high) = (rest & 0x3fff, rest >> 14);
        let normal =
            (self.mantissa.wrapping_mul(low) >> 14).wrapping_add(self.mantissa.wrapping_mul(high));
        root_of_bits(normal, -1)
    }

    /// The same of 19 bits with 29: what lies 16 bits up.
    #[inline(always)]
    fn split_root(&self, rest: u32) -> Option<(u32, i32)> {
        let (low, high) = (rest & 0x1fff, rest >> 13);
        let (below, above) = (self.mantissa & 0x3f, self.mantissa >> 6);
        let carried =
            (self.mantissa.wrapping_mul(low) >> 13).wrapping_add(below.wrapping_mul(high));
        root_of_bits(
            (above.wrapping_mul(high) << 3).wrapping_add(carried >> 3),
            0,
        )
    }
}

/// Root and shift of a product's upper bits, unless they are fewer than count; `shift` if both of the highest bits are
/// taken.
#[inline(always)]
fn root_of_bits(mut normal: u32, mut shift: i32) -> Option<(u32, i32)> {
    if normal >> 22 == 0 {
        return None;
    }
    while normal >> 30 == 0 {
        normal <<= 2;
        shift -= 1;
    }
    Some((root_of(normal), shift))
}

#[cfg(test)]
mod tests;
