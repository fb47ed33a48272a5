//! Spans and seeds of many rows at once in double precision, bit for bit those of [`rows`](super::rows).
//!
//! A double holds an integer of 53 bits, and a right shift that rounds, `(v + 2^(s-1)) >> s`, is `floor(v 2^-s + 1/2)`: two instructions for
//! words with a sign, where AVX2 has no such shift. So the rows' sequences and seeds are the kernel's integers in doubles, for designs whose
//! products fit. Only the root is not the kernel's: the processor's own, of which the table's differs by at most [`ERROR`]. Where both ends of
//! that interval give the same column, so does the kernel's; elsewhere, one row in some thousand, its table is looked up.
//!
//! Columns are in pixels, what is left of the cut-off in units of 2^-[`REST`].

use super::lanes::Doubles;
use super::lanes::singles::HAS_FUSED_ADD;
use super::rows::{Runs, SquaredWidth};
use super::setup::number::Arithmetic;
use splatline::raster::{BLOCK, REST, RowBlock, RowConstants};

/// Most bits of a mantissa: what is computed from two of them stays far below 2^53.
const MOST_BITS: u32 = 18;

/// Integers end here, so that three of them and a rounding bit have a sum without an error.
const MOST: f64 = (1u64 << 49) as f64;

/// Added to an integer of up to 51 bits, makes the number's lower bits the integer's.
const WHOLE: f64 = 3.0 * (1u64 << 51) as f64;

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

/// Half-widths of the root table: relative error, and what the last bit of Q.32 and of the doubles may add.
const ERROR: [f64; 2] = [1.0 / (1 << 16) as f64, 1.0 / (1 << 26) as f64];

#[inline(always)]
fn splat<L: Doubles>(lanes: L, value: f64) -> L::Word {
    lanes.wide_splat(value.to_bits() as i64)
}

/// 2^exponent, of exponents that are no more than a number may have.
#[inline(always)]
fn power(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent.clamp(-1000, 1000)) as u64) << 52)
}

/// What is the same for all rows of a footprint.
pub struct RowReals<L: Doubles> {
    /// The vectors.
    pub lanes: L,
    kernel: SquaredWidth<L>,
    columns: [f64; 2],
    shear: f64,
    curve: f64,
    scale: f64,
    reach: L::Word,
    /// The square of a half-width for a unit of the rest.
    squared_width: L::Word,
    horizontal: L::Word,
    to_dx: L::Word,
    to_along: L::Word,
    to_vertical: L::Word,
    to_radial: L::Word,
    to_first: L::Word,
    start: L::Word,
    unit: L::Word,
    /// |dx| ends here.
    farthest: L::Word,
}

/// Some rows' words, and what leads to the next ones.
#[derive(Clone, Copy)]
pub struct RealRows<L: Doubles> {
    centre: L::Word,
    vertical: L::Word,
    slope: L::Word,
    change: L::Word,
    second: L::Word,
}

/// Where some rows begin, negative, and end.
pub struct RealSpan<L: Doubles> {
    left: L::Word,
    end: L::Word,
    /// What the vertical distance adds to the radial index.
    down: L::Word,
}

/// The largest numbers found on the way: what is left of the cut-off, and the distance from the centre.
pub struct Largest<L: Doubles> {
    rest: L::Word,
    far: L::Word,
}

impl<L: Doubles> RowReals<L> {
    /// Of a footprint; `None` where double precision has not all bits.
    #[inline(always)]
    pub fn new(lanes: L, constants: &RowConstants<i64>) -> Option<Self> {
        let (drop_dx, bits, drop_radial, drop_first) = constants.drops;
        let long = 2 * bits as i32 - drop_radial.min(drop_first);
        let added = constants.start.unsigned_abs() | constants.unit.unsigned_abs();
        let (mantissa, odd, half) = constants.squared_width;
        let is_exact = bits <= MOST_BITS
            && long < 50
            && added < MOST as u64
            && constants.horizontal.unsigned_abs() <= 1 << bits
            && mantissa < 1 << MOST_BITS
            && half <= 30
            && constants.vertical_fraction >= REST;
        if !is_exact {
            return None;
        }
        let scale = power(REST as i32 - constants.vertical_fraction as i32);
        let [first, last] = constants.bounds;
        let [visible, end] = constants.visible;
        Some(RowReals {
            lanes,
            kernel: SquaredWidth::new(Arithmetic { lanes }, constants),
            columns: [
                first.max(visible - visible % BLOCK).into(),
                last.min(end).into(),
            ],
            shear: constants.shear as f64 * power(-32),
            curve: constants.curve as f64,
            scale,
            reach: splat(lanes, constants.reach as f64 * scale),
            squared_width: splat(lanes, (mantissa << odd) as f64 * power(2 * half.max(-400) - 64)),
            horizontal: splat(lanes, constants.horizontal as f64),
            to_dx: splat(lanes, -power(32 - drop_dx as i32)),
            to_along: splat(lanes, power(-(bits as i32))),
            to_vertical: splat(lanes, power(constants.fraction as i32 - REST as i32)),
            to_radial: splat(lanes, power(-drop_radial)),
            to_first: splat(lanes, power(-drop_first)),
            start: splat(lanes, constants.start as f64),
            unit: splat(lanes, constants.unit as f64),
            farthest: splat(lanes, power(bits as i32)),
        })
    }

    #[inline(always)]
    fn splat(&self, value: f64) -> L::Word {
        splat(self.lanes, value)
    }

    /// a b + c, of which the product is exact.
    #[inline(always)]
    fn exact(&self, a: L::Word, b: L::Word, c: L::Word) -> L::Word {
        if HAS_FUSED_ADD {
            self.lanes.double_mul_add(a, b, c)
        } else {
            self.lanes.double_add(self.lanes.double_mul(a, b), c)
        }
    }

    /// a b to the nearest integer, halves up.
    #[inline(always)]
    fn rounded(&self, a: L::Word, b: L::Word) -> L::Word {
        self.lanes.double_floor(self.exact(a, b, self.splat(0.5)))
    }

    /// An integer as a word.
    #[inline(always)]
    fn word(&self, a: L::Word) -> L::Word {
        let whole = self.splat(WHOLE);
        self.lanes
            .wide_sub(self.lanes.double_add(a, whole), whole)
    }

    /// Nothing found yet.
    #[inline(always)]
    pub fn nothing(&self) -> Largest<L> {
        let zero = self.splat(0.0);
        Largest {
            rest: zero,
            far: zero,
        }
    }

    /// Did all rows have their words?
    #[inline(always)]
    pub fn holds(&self, found: &Largest<L>) -> bool {
        let lanes = self.lanes;
        let one = lanes.wide_splat(-1);
        let zero = lanes.wide_splat(0);
        let long = lanes.double_greater(self.splat(power(31)), found.rest);
        let far = lanes.double_greater(self.farthest, found.far);
        let good = lanes.wide_select(zero, lanes.wide_select(zero, one, long), far);
        !lanes.wide_any(lanes.wide_xor(good, one))
    }

    /// The first of so many rows of a block; `None` where their words are too large.
    #[inline(always)]
    pub fn block(&self, block: &RowBlock, count: usize) -> Option<RealRows<L>> {
        let lanes = self.lanes;
        let [vertical, change] = block.vertical.map(|word| word as f64);
        let centre = block.centre as f64 * power(-32);
        let last = (count + 8) as f64;
        let largest = vertical.abs() + last * (change.abs() + last * self.curve.abs());
        let farthest = centre.abs() + last * self.shear.abs();
        // Words beyond a double's are large even when they are rounded to one.
        if !(largest < MOST && farthest < power(19)) {
            return None;
        }
        let (vertical, change) = (vertical * self.scale, change * self.scale);
        let curve = self.curve * self.scale;
        let (numbers, pairs) = (lanes.wide_load(&NUMBERS), lanes.wide_load(&PAIRS));
        let width = L::WIDE as f64;
        let bent = self.exact(pairs, self.splat(curve), self.splat(vertical));
        let along = change * width + curve * (width * (width - 1.0) / 2.0);
        Some(RealRows {
            centre: self.exact(numbers, self.splat(self.shear), self.splat(centre)),
            vertical: self.exact(numbers, self.splat(change), bent),
            slope: self.splat(self.shear * width),
            change: self.exact(numbers, self.splat(curve * width), self.splat(along)),
            second: self.splat(curve * width * width),
        })
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

    /// The spans of some rows within the ellipse.
    #[inline(always)]
    pub fn span(&self, rows: &RealRows<L>, found: &mut Largest<L>) -> RealSpan<L> {
        let (lanes, zero) = (self.lanes, self.splat(0.0));
        let rest = lanes.double_sub(self.reach, rows.vertical);
        found.rest = lanes.double_max(found.rest, rest);
        let open = lanes.double_greater(rest, zero);
        let narrow = lanes.double_max(lanes.double_floor(rest), zero);
        let half = lanes.double_root(lanes.double_mul(narrow, self.squared_width));
        let error = self.exact(half, self.splat(ERROR[0]), self.splat(ERROR[1]));
        let (mut left, mut right) = self.ends(rows.centre, lanes.double_add(half, error));
        let nearer = self.ends(rows.centre, lanes.double_sub(half, error));
        let doubt = lanes.wide_or(
            lanes.wide_xor(left, nearer.0),
            lanes.wide_xor(right, nearer.1),
        );
        if lanes.wide_any(lanes.wide_select(zero, doubt, open)) {
            (left, right) = self.ends(rows.centre, self.kernels_half(narrow));
        }
        let end = lanes.double_add(right, self.splat(1.0));
        RealSpan {
            left,
            end: lanes.wide_select(zero, end, open),
            down: lanes.double_add(self.rounded(rows.vertical, self.to_vertical), self.start),
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

    /// Half-widths by the kernel's table.
    #[inline(always)]
    fn kernels_half(&self, narrow: L::Word) -> L::Word {
        let lanes = self.lanes;
        let half = self.kernel.half_of(Arithmetic { lanes }, self.word(narrow));
        let mut halves = [0; 8];
        lanes.wide_store(&mut halves, half);
        for half in &mut halves {
            *half = (*half as f64 * power(-32)).to_bits() as i64;
        }
        lanes.wide_load(&halves)
    }

    /// The runs of some rows in the block that begins at this column.
    #[inline(always)]
    pub fn runs(
        &self,
        rows: &RealRows<L>,
        span: &RealSpan<L>,
        column: u16,
        found: &mut Largest<L>,
    ) -> Runs<L> {
        let (lanes, zero) = (self.lanes, self.splat(0.0));
        let first = f64::from(column);
        let last = first + f64::from(BLOCK);
        let first = self.splat(-first.max(self.columns[0]));
        let left = lanes.double_min(span.left, first);
        let end = lanes.double_min(span.end, self.splat(last.min(self.columns[1])));
        let dx = self.rounded(lanes.double_add(left, rows.centre), self.to_dx);
        let open = lanes.double_greater(lanes.double_add(left, end), zero);
        let far = lanes.wide_and(dx, lanes.wide_splat(i64::MAX));
        found.far = lanes.double_max(found.far, lanes.wide_select(zero, far, open));
        let along = lanes.double_mul(self.horizontal, dx);
        let across = lanes.double_mul(self.rounded(along, self.to_along), dx);
        let radial = lanes.double_add(self.rounded(across, self.to_radial), span.down);
        let difference = lanes.double_add(self.rounded(along, self.to_first), self.unit);
        Runs {
            x: self.word(lanes.double_sub(zero, left)),
            end: self.word(end),
            radial: self.word(radial),
            first: self.word(difference),
        }
    }
}
