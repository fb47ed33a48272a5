//! Constants of several footprints' rows at once, a footprint in each word.
//!
//! What [`EllipseSpans::constants`](splatline::raster::EllipseSpans::constants) computes for one footprint takes more
//! instructions than its rows. Here it is the same, step by step, in double precision, where a right shift that rounds
//! is `floor(v + 1/2)`.
//! Footprints that are [not ordinary](RowGroup::is_ordinary) are left to it.

use super::lanes::{Lanes, apart};
use super::row_reals::{DIFFERENT, FARTHEST, MOST, ROWS, RealBlock, RowNumbers, RowReals, scale};
use super::row_words::{SeedWords, SquaredWidth, longest_rest};
use super::rows::BLOCKS;
use super::setup::number::{Word, power};
use super::setup::real::{Real, Reals};
use super::tile::TILE;
use splatline::footprint::Footprint;
use splatline::format::Widths;
use splatline::math::SoftFloat;
use splatline::raster::{BLOCK, GUARD, REST, Window, vertical_fraction};
use std::cell::Cell;

/// Most words of a vector.
const WORDS: usize = 8;

/// Blocks of rows that a tile has: seeds are computed for each.
pub const ROW_BLOCKS: usize = (TILE[1] / BLOCK) as usize;
const _: () = assert!(ROW_BLOCKS == 2 && TILE[1].is_multiple_of(BLOCK));

/// Fraction bits of rows' centres beyond those of footprints' centres, where shears and half-widths are ordinary.
const CENTRE: i32 = 8;

/// Least and largest 1 / A, A and C, and largest |S|, that are taken.
const ORDINARY: [[i32; 2]; 3] = [[-10, 22], [-40, 4], [-60, 4]];
const STEEPEST: i32 = 13;

/// Words that are read of a footprint.
const INPUTS: usize = 12;

/// A word of each footprint.
type List = [i64; WORDS];

/// What one footprint shows in a window.
#[derive(Clone, Copy, Debug, Default)]
pub struct Member {
    /// First row, and one past the last.
    pub rows: [u16; 2],
    /// Columns of the box in the window.
    pub visible: [u16; 2],
    /// Do its rows lie in two blocks, as all do in a tile of the screen?
    is_short: bool,
}

/// Some footprints and their constants; memory that is used again for the next ones.
#[derive(Default)]
pub struct RowGroup {
    members: [Member; WORDS],
    inputs: [List; INPUTS],
    seeds: [[List; 3]; ROW_BLOCKS],
    columns: [[List; 2]; BLOCKS],
    constants: [List; DIFFERENT],
    shear: List,
    curve: List,
    second: List,
    doubt: List,
}

impl Member {
    /// Has it nothing in the window?
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.rows[0] >= self.rows[1] || self.visible[0] >= self.visible[1]
    }
}

impl RowGroup {
    /// Takes a footprint as number `k`.
    #[inline(always)]
    pub fn read(&mut self, k: usize, footprint: &Footprint, window: &Window) {
        let (ldl, bounds) = (&footprint.ldl, Window::of(footprint));
        let visible = bounds.intersect(window);
        let ([x, y], [right, end]) = (visible.first, visible.end);
        let block = y - y % BLOCK;
        let origin = block.max(bounds.first[1]);
        self.members[k % WORDS] = Member {
            rows: [y, end],
            visible: [x, right],
            is_short: end <= block.saturating_add(ROW_BLOCKS as u16 * BLOCK),
        };
        let words = [
            packed(ldl.squared_width),
            packed(ldl.horizontal),
            packed(ldl.vertical),
            packed(ldl.shear),
            bits(footprint.centre[0] as f64),
            bits(footprint.centre[1] as f64),
            bits(f64::from(footprint.cutoff)),
            bits(f64::from(origin)),
            bits(f64::from(y - origin.min(y))),
            bits(f64::from(block) + f64::from(BLOCK)),
            // First column that runs may begin at, and one past the last.
            bits(f64::from(bounds.first[0].max(x - x % BLOCK))),
            bits(f64::from(right)),
        ];
        for (list, word) in self.inputs.iter_mut().zip(words) {
            list[k % WORDS] = word;
        }
    }

    /// Computes the constants of the footprints that were read, for a tile that begins at column `left`. What does not
    /// differ between them comes back.
    #[inline(always)]
    pub fn compute<L: Lanes>(&mut self, lanes: L, widths: &Widths, left: u16) -> RowReals<L> {
        if L::ROWS_APART {
            apart(|| self.compute_here(lanes, widths, left))
        } else {
            self.compute_here(lanes, widths, left)
        }
    }

    #[inline(always)]
    fn compute_here<L: Lanes>(&mut self, lanes: L, widths: &Widths, left: u16) -> RowReals<L> {
        let mut inputs = [lanes.splat(0); INPUTS];
        for (word, list) in inputs.iter_mut().zip(&self.inputs) {
            *word = lanes.load(list);
        }
        let [squared_width, horizontal, vertical, shear, u, v, ..] = inputs;
        let [.., cutoff, origin, skipped, next, begin, right] = inputs;
        let doubt = Cell::new(lanes.splat(0));
        let reals = Reals {
            lanes,
            doubt: &doubt,
        };
        let bits = i64::from(widths.mantissa);
        let squared_width = Parts::new(reals, squared_width, bits);
        let horizontal = Parts::new(reals, horizontal, bits);
        let vertical = Parts::new(reals, vertical, bits).number;
        let shear = Parts::new(reals, shear, bits).number;
        let numbers = [squared_width.number, horizontal.number, vertical];
        for (number, [least, most]) in numbers.into_iter().zip(ORDINARY) {
            reals.doubt_unless_greater(number.0, power(least));
            reals.doubt_unless_less(number.0, power(most));
        }
        reals.doubt_unless_less(reals.magnitude(shear).0, power(STEEPEST));

        let seeds = RowSeeds::new(reals, widths, [u, v], [shear, vertical]);
        // Rows above the window are stepped over.
        let first = seeds.skip(seeds.at(origin), skipped);
        let fraction = vertical_fraction(widths);
        let unit = scale(fraction);
        let scale = reals.constant(unit);
        let shear = lanes.double_mul(seeds.shear_per_row, seeds.unit);
        let curve = lanes.double_mul(seeds.balance.second, scale);
        for (lists, [centre, value, change]) in self.seeds.iter_mut().zip([first, seeds.at(next)]) {
            let centre = lanes.double_mul(centre, seeds.unit);
            let [value, change] = [
                lanes.double_mul(value, scale),
                lanes.double_mul(change, scale),
            ];
            let bent = seeds.farthest(change, curve);
            reals.doubt_unless_less(seeds.farthest(value, bent), MOST * unit);
            reals.doubt_unless_less(seeds.farthest(centre, shear), FARTHEST);
            lanes.store(&mut lists[0], centre);
            lanes.store(&mut lists[1], value);
            lanes.store(&mut lists[2], change);
        }
        lanes.store(&mut self.shear, shear);
        lanes.store(&mut self.curve, curve);
        for (number, lists) in self.columns.iter_mut().enumerate() {
            let column = f64::from(left) + f64::from(BLOCK) * number as f64;
            let end = reals.constant(column + f64::from(BLOCK));
            let first = lanes.double_max(begin, reals.constant(column));
            lanes.store(&mut lists[0], reals.opposite(Real(first)).0);
            lanes.store(&mut lists[1], lanes.double_min(end, right));
        }

        let radial = i64::from(widths.radial);
        let half = halved(
            lanes,
            lanes.plus(reals.exponent(squared_width.number, 1), 6),
        );
        let odd = lanes.masked(squared_width.exponent, 1);
        let root = halved(lanes, lanes.sub(squared_width.exponent, odd));
        let table = SquaredWidth {
            mantissa: squared_width.mantissa,
            odd,
            power: lanes.plus(root, 32 - i64::from(REST) / 2),
        };
        let finest = -(i64::from(widths.subpixel) + i64::from(CENTRE));
        let unit = lanes.max(lanes.plus(half, -bits), lanes.splat(finest));
        let along = lanes.add(horizontal.exponent, unit);
        let drop_radial = lanes.negate(lanes.plus(lanes.add(along, unit), bits + radial));
        let drop_first = lanes.negate(lanes.plus(along, 1 + radial));
        reals.doubt_where(reals.sign(drop_radial));
        reals.doubt_where(reals.sign(drop_first));
        let Balance {
            second,
            start,
            step,
        } = Balance::new(reals, horizontal.number, widths.radial.into());
        let drop_vertical = lanes.splat(i64::from(fraction) - radial);
        let drops = [lanes.splat(bits), drop_radial, drop_first, drop_vertical];
        let [start, step] = [reals.to_short_word(start), reals.to_short_word(step)];
        let slack = reals.constant(power(fraction as i32 - 10));
        let reach = reals.to_fixed(Real(cutoff), power(fraction as i32 - 28));
        let mut together = RowReals::new(
            lanes,
            RowNumbers {
                seeds: SeedWords::of(
                    lanes,
                    [horizontal.mantissa, start, step],
                    drops,
                    [lanes.splat(0); 2],
                ),
                fraction,
                longest_rest: longest_rest(widths.mantissa.into(), fraction),
                reach: lanes.double_add(reach, slack),
                squared_width: reals.scaled(squared_width.number, power(-(REST as i32))).0,
                table,
                unit,
                most_bits: lanes.splat(if bits <= 15 { bits } else { bits.max(30) }),
            },
        );
        for (list, word) in self.constants.iter_mut().zip(together.different()) {
            lanes.store(list, *word);
        }
        lanes.store(&mut self.second, reals.to_short_word(second));
        lanes.store(&mut self.doubt, doubt.get());
        together
    }

    /// What footprint number `k` shows.
    #[inline(always)]
    pub fn member(&self, k: usize) -> &Member {
        &self.members[k % WORDS]
    }

    /// Are the words of footprint number `k` as large as most are, so that its constants are the kernel's?
    #[inline(always)]
    pub fn is_ordinary(&self, k: usize) -> bool {
        self.members[k % WORDS].is_short && self.doubt[k % WORDS] == 0
    }

    /// 2 A in the unit of radial indices.
    #[inline(always)]
    pub fn second(&self, k: usize) -> i64 {
        self.second[k % WORDS]
    }

    /// The constants of footprint number `k`; `together` comes from [`RowGroup::compute`].
    #[inline(always)]
    pub fn reals<L: Lanes>(&self, k: usize, together: &RowReals<L>) -> RowReals<L> {
        let (k, lanes) = (k % WORDS, together.lanes);
        let mut reals = *together;
        for (word, list) in reals.different().into_iter().zip(&self.constants) {
            *word = lanes.splat(list[k]);
        }
        reals
    }

    /// First column, negative, that runs of footprint number `k` may begin at in each block of columns, and one past
    /// the last.
    #[inline(always)]
    pub fn columns<L: Lanes>(&self, k: usize, reals: &RowReals<L>) -> [[Word<L>; 2]; BLOCKS] {
        let lanes = reals.lanes;
        let mut columns = [[lanes.splat(0); 2]; BLOCKS];
        for ([first, last], lists) in columns.iter_mut().zip(&self.columns) {
            *first = lanes.splat(lists[0][k % WORDS]);
            *last = lanes.splat(lists[1][k % WORDS]);
        }
        columns
    }

    /// Block of rows number `number`, of two, of footprint number `k`.
    #[inline(always)]
    pub fn block(&self, k: usize, number: usize) -> RealBlock {
        let k = k % WORDS;
        let [y, end] = self.members[k].rows;
        let last = (y - y % BLOCK).saturating_add(BLOCK * (number as u16 + 1));
        let [centre, value, change] = &self.seeds[number % ROW_BLOCKS];
        RealBlock {
            end: last.min(end),
            centre: [centre[k], self.shear[k]].map(double),
            vertical: [value[k], change[k], self.curve[k]].map(double),
        }
    }
}

/// A number's mantissa and exponent in a word.
#[inline(always)]
fn packed(number: SoftFloat) -> i64 {
    i64::from(number.exponent) << 32 | i64::from(number.mantissa as u32)
}

#[inline(always)]
fn bits(number: f64) -> i64 {
    number.to_bits() as i64
}

#[inline(always)]
fn double(bits: i64) -> f64 {
    f64::from_bits(bits as u64)
}

/// Half of integers from -2048 on, rounded down.
#[inline(always)]
fn halved<L: Lanes>(lanes: L, word: Word<L>) -> Word<L> {
    lanes.plus(lanes.shr_by(lanes.plus(word, 2048), 1), -1024)
}

/// Numbers of the kernel.
struct Parts<L: Lanes> {
    mantissa: Word<L>,
    exponent: Word<L>,
    number: Real<L>,
}

impl<L: Lanes> Parts<L> {
    /// Of [`packed`] ones, with mantissas of so many bits.
    #[inline(always)]
    fn new(reals: Reals<L>, packed: Word<L>, bits: i64) -> Self {
        const SIGN: i64 = 1 << 31;
        let lanes = reals.lanes;
        let lower = lanes.masked(packed, u32::MAX.into());
        let lower = lanes.xor(lower, lanes.splat(SIGN));
        let upper = lanes.xor(lanes.shr_by(packed, 32), lanes.splat(SIGN));
        let (mantissa, exponent) = (lanes.plus(lower, -SIGN), lanes.plus(upper, -SIGN));
        // The exponent of 0 is far from all others.
        let beyond = lanes.shr_by(lanes.plus(exponent, 1022), 11);
        let nothing = lanes.equal(mantissa, lanes.splat(0));
        reals.doubt_where(lanes.select(beyond, lanes.splat(0), nothing));
        reals.doubt_where(lanes.shr_by(lanes.magnitude(mantissa), bits));
        Parts {
            mantissa,
            exponent,
            number: reals.times(reals.short(mantissa), reals.power(exponent)),
        }
    }
}

/// The kernel's constants of a sequence with this factor of the square.
struct Balance<L: Lanes> {
    second: Word<L>,
    start: Word<L>,
    step: Word<L>,
}

impl<L: Lanes> Balance<L> {
    /// In units of 2^-fraction.
    #[inline(always)]
    fn new(reals: Reals<L>, factor: Real<L>, fraction: u32) -> Self {
        let lanes = reals.lanes;
        let fine = reals.to_fixed(factor, power((fraction + GUARD) as i32));
        let second = reals.to_fixed(Real(fine), power(1 - GUARD as i32));
        let rounded = reals.scaled(Real(second), power(GUARD as i32 - 1)).0;
        let excess = Real(lanes.double_sub(rounded, fine));
        let block = f64::from(BLOCK);
        let moved = reals.scaled(excess, block).0;
        Balance {
            second,
            start: reals.to_fixed(excess, block * block / 8.0 * power(-(GUARD as i32))),
            step: reals.to_fixed(
                Real(lanes.double_sub(rounded, moved)),
                power(-(GUARD as i32)),
            ),
        }
    }
}

/// What the seeds of blocks of rows are computed from.
struct RowSeeds<'a, L: Lanes> {
    reals: Reals<'a, L>,
    widths: Widths,
    /// u - 1/2 in the unit of rows' centres, and 1/2 - v in that of footprints' centres.
    centre: [Word<L>; 2],
    shear: Real<L>,
    vertical: Real<L>,
    shear_per_row: Word<L>,
    balance: Balance<L>,
    /// The unit of rows' centres in pixels.
    unit: Word<L>,
}

impl<'a, L: Lanes> RowSeeds<'a, L> {
    #[inline(always)]
    fn new(
        reals: Reals<'a, L>,
        widths: &Widths,
        [u, v]: [Word<L>; 2],
        [shear, vertical]: [Real<L>; 2],
    ) -> Self {
        let (lanes, subpixel) = (reals.lanes, i32::from(widths.subpixel));
        let half = reals.constant(power(subpixel - 1));
        let raised = reals
            .scaled(Real(lanes.double_sub(u, half)), power(CENTRE))
            .0;
        RowSeeds {
            reals,
            widths: *widths,
            centre: [raised, lanes.double_sub(half, v)],
            shear,
            vertical,
            shear_per_row: reals.to_fixed(shear, power(subpixel + CENTRE)),
            balance: Balance::new(reals, vertical, vertical_fraction(widths)),
            unit: reals.constant(power(-subpixel - CENTRE)),
        }
    }

    /// Centre, C dy^2 and its change in rows where blocks begin.
    #[inline(always)]
    fn at(&self, y: Word<L>) -> [Word<L>; 3] {
        let (reals, lanes) = (self.reals, self.reals.lanes);
        let (subpixel, bits) = (i32::from(self.widths.subpixel), self.widths.mantissa.into());
        let fine = vertical_fraction(&self.widths) as i32;
        let y = reals.scaled(Real(y), power(subpixel)).0;
        let dy = reals.narrow(Real(lanes.double_add(y, self.centre[1])), bits);
        let dy = reals.scaled(dy, power(-subpixel));
        let moved = reals.times_to_fixed(self.shear, dy, power(subpixel + CENTRE));
        let along = reals.multiply(self.vertical, dy, bits);
        let value = reals.times_to_fixed(along, dy, power(fine));
        let change = reals.to_fixed(along, power(fine + 1));
        [
            lanes.double_add(self.centre[0], reals.short(moved).0),
            lanes.double_add(reals.short(value).0, self.balance.start),
            lanes.double_add(change, self.balance.step),
        ]
    }

    /// The most that a number and so much more in every row can be.
    #[inline(always)]
    fn farthest(&self, number: Word<L>, change: Word<L>) -> Word<L> {
        let (reals, lanes) = (self.reals, self.reals.lanes);
        let rows = reals.constant(ROWS);
        let changes = lanes.double_mul(reals.magnitude(Real(change)).0, rows);
        lanes.double_add(reals.magnitude(Real(number)).0, changes)
    }

    /// The same so many rows on.
    #[inline(always)]
    fn skip(&self, [centre, value, change]: [Word<L>; 3], rows: Word<L>) -> [Word<L>; 3] {
        let (reals, lanes) = (self.reals, self.reals.lanes);
        let pairs = lanes.double_mul(rows, lanes.double_sub(rows, reals.constant(1.0)));
        let pairs = reals.scaled(Real(pairs), 0.5).0;
        let curve = self.balance.second;
        let value = lanes.double_mul_add(rows, change, value);
        [
            lanes.double_mul_add(rows, self.shear_per_row, centre),
            lanes.double_mul_add(pairs, curve, value),
            lanes.double_mul_add(rows, curve, change),
        ]
    }
}
