//! Spans of many rows at once in double precision, bit for bit those of [`rows`](super::rows).
//!
//! A double holds an integer of 53 bits, and a right shift that rounds, `(v + 2^(s-1)) >> s`, is `floor(v 2^-s + 1/2)`:
//! two instructions for words with a sign, where AVX2 has no such shift. So the rows' sequences are the kernel's
//! integers in doubles. The root is not the kernel's but the processor's, of which the table's differs by at most
//! [`ERROR`]. Where both ends of that interval give the same column, so does the kernel's; elsewhere, in one row of
//! some thousand, its table is looked up.
//!
//! Columns are in pixels, what is left of the cut-off in units of 2^-[`REST`].

use super::lanes::Lanes;
use super::lanes::singles::HAS_FUSED_ADD;
use super::row_words::{Runs, SeedWords, SquaredWidth, seeds};
use super::setup::number::{Arithmetic, power};
use super::tile::TILE;
use splatline::raster::REST;

/// Integers below this have no error in a double, nor has a sum of three of them and a rounding bit.
pub const MOST: f64 = (1u64 << 49) as f64;

/// Columns below this have at most 51 bits in Q.32.
pub const FARTHEST: f64 = (1 << 19) as f64;

/// Rows of a tile, and those of a vector behind the last one.
pub const ROWS: f64 = TILE[1] as f64 + 8.0;

/// Added to an integer of up to 51 bits, makes the number's lower bits the integer's.
const WHOLE: f64 = 3.0 * (1u64 << 51) as f64;

/// Half-widths by the root table: relative error, and what the last bits of Q.32 and of the doubles may add.
pub(super) const ERROR: [f64; 2] = [1.0 / (1 << 16) as f64, 1.0 / (1 << 26) as f64];

/// k and k (k - 1) / 2 for row k of a vector.
static NUMBERS: [i64; 8] = bits([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
static PAIRS: [i64; 8] = bits([0.0, 0.0, 1.0, 3.0, 6.0, 10.0, 15.0, 21.0]);

/// Numbers as a vector takes them.
const fn bits(numbers: [f64; 8]) -> [i64; 8] {
    let mut bits = [0; 8];
    let mut k = 0;
    while k < 8 {
        bits[k] = numbers[k].to_bits() as i64;
        k += 1;
    }
    bits
}

/// A unit of C dy^2 with so many fraction bits, which is so large here.
#[inline(always)]
pub fn scale(fraction: u32) -> f64 {
    power(-(fraction.saturating_sub(REST) as i32))
}

/// [`power`] in each word.
#[inline(always)]
fn powers<L: Lanes>(lanes: L, exponent: L::Word) -> L::Word {
    lanes.shl_by(lanes.plus(exponent, 1023), 52)
}

#[inline(always)]
fn splat<L: Lanes>(lanes: L, value: f64) -> L::Word {
    lanes.splat(value.to_bits() as i64)
}

/// What is the same for all rows of a footprint, or of a footprint in each word.
#[derive(Clone, Copy)]
pub struct RowReals<L: Lanes> {
    pub lanes: L,
    seeds: SeedWords<L>,
    reach: L::Word,
    /// One past the longest rest that the table takes, and past the longest square of a half-width whose distances fit
    /// the seeds.
    longest: [L::Word; 2],
    /// The square of a half-width for a unit of the rest.
    squared_width: L::Word,
    /// The root's table of rests with no bits more than it takes.
    table: SquaredWidth<L>,
    to_dx: L::Word,
    to_down: L::Word,
    /// [`WHOLE`], less what a turned shift would leave too large.
    turn_of_down: L::Word,
}

/// The seeds of a block of one footprint's rows.
#[derive(Clone, Copy, Debug)]
pub struct RealBlock {
    /// One past the last row.
    pub end: u16,
    /// xc - 1/2 in the first row, and its change per row.
    pub centre: [f64; 2],
    /// C dy^2 in the first row, its change to the next one, and the change of that.
    pub vertical: [f64; 3],
}

/// Some rows' words, and what leads to the next ones.
#[derive(Clone, Copy)]
pub struct RealRows<L: Lanes> {
    centre: L::Word,
    vertical: L::Word,
    slope: L::Word,
    change: L::Word,
    second: L::Word,
}

/// Where some rows begin, negative, and end, and what the vertical distance adds to their radial indices.
pub struct RealSpan<L: Lanes> {
    left: L::Word,
    end: L::Word,
    down: L::Word,
}

/// What [`RowReals`] follow from.
pub struct RowNumbers<L: Lanes> {
    pub seeds: SeedWords<L>,
    /// Fraction bits of C dy^2.
    pub fraction: u32,
    /// Bits of the longest rest of the cut-off that the root takes, in the unit of C dy^2.
    pub longest_rest: u32,
    /// Cut-off and slack in the unit of C dy^2, and the square of a half-width for a unit of the rest.
    pub reach: L::Word,
    /// See `reach`.
    pub squared_width: L::Word,
    /// The same for the root's table, of rests with no bits more than it takes.
    pub table: SquaredWidth<L>,
    /// Distances along a row have a unit of two to this power, and as many bits.
    pub unit: L::Word,
    /// See `unit`.
    pub most_bits: L::Word,
}

/// Words of [`RowReals`] that differ between footprints.
pub const DIFFERENT: usize = 14;

impl<L: Lanes> RowReals<L> {
    /// From these numbers, of a footprint in each word.
    #[inline(always)]
    pub fn new(lanes: L, numbers: RowNumbers<L>) -> Self {
        let seeds = numbers.seeds;
        let below = numbers.fraction.saturating_sub(REST) as i32;
        // Roots are wrong by less than this leaves.
        let almost = splat(lanes, 1.0 - 1.0 / 1024.0);
        let farthest = powers(lanes, lanes.add(numbers.most_bits, numbers.unit));
        let farthest = lanes.double_mul(farthest, almost);
        let to_dx = powers(lanes, lanes.negate(numbers.unit));
        RowReals {
            lanes,
            reach: lanes.double_mul(numbers.reach, splat(lanes, scale(numbers.fraction))),
            longest: [
                splat(lanes, power(numbers.longest_rest as i32 - below)),
                lanes.double_mul(farthest, farthest),
            ],
            squared_width: numbers.squared_width,
            table: numbers.table,
            to_dx: lanes.double_sub(lanes.splat(0), to_dx),
            to_down: powers(
                lanes,
                lanes.sub(lanes.splat(below.into()), seeds.drop_vertical.by),
            ),
            turn_of_down: lanes.sub(splat(lanes, WHOLE), lanes.turn_of(seeds.drop_vertical)),
            seeds,
        }
    }

    /// The words that differ between footprints.
    #[inline(always)]
    pub fn different(&mut self) -> [&mut L::Word; DIFFERENT] {
        let [a, b, c, d, e, f, g] = self.seeds.different();
        let SquaredWidth {
            mantissa,
            odd,
            power,
        } = &mut self.table;
        let [_, farthest] = &mut self.longest;
        let (reach, width, to_dx) = (&mut self.reach, &mut self.squared_width, &mut self.to_dx);
        [
            a, b, c, d, e, f, g, mantissa, odd, power, reach, farthest, width, to_dx,
        ]
    }

    /// The number in each word.
    #[inline(always)]
    pub fn splat(&self, value: f64) -> L::Word {
        splat(self.lanes, value)
    }

    /// a b + c, of which the product is exact.
    #[inline(always)]
    fn exact(&self, a: L::Word, b: L::Word, c: L::Word) -> L::Word {
        let lanes = self.lanes;
        if HAS_FUSED_ADD {
            lanes.double_mul_add(a, b, c)
        } else {
            lanes.double_add(lanes.double_mul(a, b), c)
        }
    }

    /// a b to the nearest integer, halves up, [`WHOLE`] more.
    #[inline(always)]
    fn rounded(&self, a: L::Word, b: L::Word) -> L::Word {
        let lanes = self.lanes;
        let floor = lanes.double_floor(self.exact(a, b, self.splat(0.5)));
        lanes.double_add(floor, self.splat(WHOLE))
    }

    /// An integer, [`WHOLE`] more, as a word.
    #[inline(always)]
    fn word(&self, a: L::Word) -> L::Word {
        self.lanes.sub(a, self.splat(WHOLE))
    }

    /// The first rows of a block.
    #[inline(always)]
    pub fn rows(&self, block: &RealBlock) -> RealRows<L> {
        let lanes = self.lanes;
        let width = L::WIDE as f64;
        let (numbers, pairs) = (lanes.load(&NUMBERS), lanes.load(&PAIRS));
        let [centre, shear] = [self.splat(block.centre[0]), self.splat(block.centre[1])];
        let [vertical, change] = [self.splat(block.vertical[0]), self.splat(block.vertical[1])];
        let curve = self.splat(block.vertical[2]);
        let wider = lanes.double_mul(curve, self.splat(width));
        let along = self.exact(
            change,
            self.splat(width),
            lanes.double_mul(curve, self.splat(width * (width - 1.0) / 2.0)),
        );
        RealRows {
            centre: self.exact(numbers, shear, centre),
            vertical: self.exact(numbers, change, self.exact(pairs, curve, vertical)),
            slope: lanes.double_mul(shear, self.splat(width)),
            change: self.exact(numbers, wider, along),
            second: lanes.double_mul(wider, self.splat(width)),
        }
    }

    /// On to the next rows.
    #[inline(always)]
    pub fn step(&self, rows: &RealRows<L>) -> RealRows<L> {
        let lanes = self.lanes;
        RealRows {
            centre: lanes.double_add(rows.centre, rows.slope),
            vertical: lanes.double_add(rows.vertical, rows.change),
            change: lanes.double_add(rows.change, rows.second),
            ..*rows
        }
    }

    /// The spans of some rows within the ellipse. `longest` becomes the most that a row leaves of the cut-off.
    #[inline(always)]
    pub fn span(&self, rows: &RealRows<L>, longest: &mut L::Word) -> RealSpan<L> {
        let (lanes, zero) = (self.lanes, self.splat(0.0));
        let rest = lanes.double_sub(self.reach, rows.vertical);
        *longest = lanes.double_max(*longest, rest);
        let open = lanes.double_greater(rest, zero);
        let narrow = lanes.double_max(lanes.double_floor(rest), zero);
        let half = lanes.double_root(lanes.double_mul(narrow, self.squared_width));
        let error = self.exact(half, self.splat(ERROR[0]), self.splat(ERROR[1]));
        let (mut left, mut right) = self.ends(rows.centre, lanes.double_add(half, error));
        // A column that is farther than the nearer end of the interval.
        let nearer = lanes.double_sub(half, error);
        let left_of = lanes.double_sub(left, lanes.double_sub(nearer, rows.centre));
        let right_of = lanes.double_sub(right, lanes.double_add(nearer, rows.centre));
        let doubt = lanes.double_max(lanes.double_max(left_of, right_of), zero);
        if lanes.any(lanes.select(zero, doubt, open)) {
            (left, right) = self.ends(rows.centre, self.half_by_table(narrow));
        }
        let end = lanes.double_add(right, self.splat(1.0));
        RealSpan {
            left,
            end: lanes.select(zero, end, open),
            down: self
                .lanes
                .sub(self.rounded(rows.vertical, self.to_down), self.turn_of_down),
        }
    }

    /// First columns, negative, and last ones within so much of the centre.
    #[inline(always)]
    fn ends(&self, centre: L::Word, half: L::Word) -> (L::Word, L::Word) {
        let lanes = self.lanes;
        (
            lanes.double_floor(lanes.double_sub(half, centre)),
            lanes.double_floor(lanes.double_add(half, centre)),
        )
    }

    /// The kernel's half-widths.
    #[inline(always)]
    fn half_by_table(&self, narrow: L::Word) -> L::Word {
        let lanes = self.lanes;
        let narrow = self.word(lanes.double_add(narrow, self.splat(WHOLE)));
        let half = self.table.half_of(self.lanes, narrow);
        let mut halves = lanes.list(half);
        for half in &mut halves {
            *half = (*half as f64 * power(-32)).to_bits() as i64;
        }
        lanes.load(&halves)
    }

    /// The runs of some rows between these columns, the first one negative, by [`seeds`].
    #[inline(always)]
    pub fn runs(
        &self,
        rows: &RealRows<L>,
        span: &RealSpan<L>,
        [first, last]: [L::Word; 2],
    ) -> Runs<L> {
        let lanes = self.lanes;
        let left = lanes.double_min(span.left, first);
        let end = lanes.double_min(span.end, last);
        let dx = self.rounded(lanes.double_add(left, rows.centre), self.to_dx);
        let whole = self.splat(WHOLE);
        let x = lanes.double_sub(whole, left);
        let end = lanes.double_add(whole, end);
        let columns = [self.word(x), self.word(end)];
        seeds(self.lanes, &self.seeds, columns, [self.word(dx), span.down])
    }

    /// Is something left of the cut-off that table or seeds do not take? Not 0 where it is.
    #[inline(always)]
    pub fn excess(&self, longest: L::Word) -> L::Word {
        let (lanes, zero, one) = (self.lanes, self.lanes.splat(0), self.lanes.splat(1));
        let square = lanes.double_mul(longest, self.squared_width);
        let fits = lanes.double_greater(self.longest[0], longest);
        let near = lanes.double_greater(self.longest[1], square);
        let excess = lanes.select(one, zero, fits);
        lanes.select(one, excess, near)
    }
}
