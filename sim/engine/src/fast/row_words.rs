//! A footprint's rows in words of 64 bits, a row in each: root, span and seeds, as the kernel's
//! [`EllipseSpans`](splatline::raster::EllipseSpans) have them.
//!
//! Both sequences down the rows are polynomials in integers that wrap: row k has `centre + k slope` and
//! `vertical + k change + k (k - 1) / 2 second`, without an order of summation.
//!
//! [`row_reals`](super::row_reals) takes the seeds and the root's table from here and computes the rest in doubles.
//! What words could not hold is told by [`is_tame`] beforehand and by [`excess`] afterwards.

use super::lanes::Wide;
use super::setup::number::{Arithmetic, RoundingShift};
use splatline::raster::{BLOCK, REST, RowBlock, RowConstants};

/// Most words of a vector.
const WORDS: usize = 8;

/// Bits of the longest rest of the cut-off that the root takes, of a mantissa and C dy^2 with so many.
#[inline(always)]
pub fn longest_rest(mantissa: u32, vertical_fraction: u32) -> u32 {
    let bits = if mantissa <= 18 { 28 } else { 32 };
    vertical_fraction.saturating_sub(REST).min(31) + bits
}

/// xc - 1/2 and C dy^2 of some rows, and what leads to the next ones.
pub struct RowVectors<L: Wide> {
    /// xc - 1/2 of each row.
    pub centre: L::Word,
    /// C dy^2 of each row.
    pub vertical: L::Word,
    slope: L::Word,
    change: L::Word,
    second: L::Word,
    /// The cut-off, and the largest rest of it so far.
    reach: L::Word,
    longest: L::Word,
    limit: u32,
}

impl<L: Wide> RowVectors<L> {
    /// The first rows of a block.
    #[inline(always)]
    pub fn new(lanes: L, constants: &RowConstants<i64>, block: &RowBlock) -> Self {
        let splat = |value| lanes.wide_splat(value);
        let width = L::WIDE as i64;
        let rows: [i64; WORDS] = [0, 1, 2, 3, 4, 5, 6, 7];
        let pairs: [i64; WORDS] = [0, 0, 1, 3, 6, 10, 15, 21];
        let [rows, pairs] = [lanes.wide_load(&rows), lanes.wide_load(&pairs)];
        let times = |rows: L::Word, value| lanes.wide_mul_whole(rows, splat(value));
        let ([vertical, change], second) = (block.vertical, constants.curve);
        // From row k to row k + w: w (change + k second) + w (w - 1) / 2 second.
        let along = change
            .wrapping_mul(width)
            .wrapping_add(second.wrapping_mul(width * (width - 1) / 2));
        let curved = lanes.wide_add(times(rows, change), times(pairs, second));
        let along_of_row = times(rows, second.wrapping_mul(width));
        RowVectors {
            centre: lanes.wide_add(splat(block.centre), times(rows, constants.shear)),
            vertical: lanes.wide_add(splat(vertical), curved),
            slope: splat(constants.shear.wrapping_mul(width)),
            change: lanes.wide_add(splat(along), along_of_row),
            second: splat(second.wrapping_mul(width * width)),
            reach: splat(constants.reach),
            longest: splat(0),
            limit: longest_rest(constants.drops.1, constants.vertical_fraction),
        }
    }

    /// What the rows leave of the cut-off.
    #[inline(always)]
    pub fn rest(&self, lanes: L) -> L::Word {
        lanes.wide_sub(self.reach, self.vertical)
    }

    /// On to the next rows.
    #[inline(always)]
    pub fn step(&mut self, lanes: L) {
        self.longest = Arithmetic { lanes }.max(self.longest, self.rest(lanes));
        self.centre = lanes.wide_add(self.centre, self.slope);
        self.vertical = lanes.wide_add(self.vertical, self.change);
        self.change = lanes.wide_add(self.change, self.second);
    }

    /// Bits of what the rows behind us left of the cut-off that the root does not take: 0 if there are none.
    #[inline(always)]
    pub fn excess(&self, lanes: L) -> L::Word {
        lanes.wide_shr(self.longest, lanes.wide_splat(self.limit.into()))
    }
}

/// Runs of several rows in one block: a word for each row. Empty where `end` is not beyond `x`.
#[derive(Clone, Copy)]
pub struct Runs<L: Wide> {
    /// First column, and one past the last.
    pub x: L::Word,
    /// See `x`.
    pub end: L::Word,
    /// Radial index and first difference at `x`, not cut to the lanes' word yet.
    pub radial: L::Word,
    /// See `radial`.
    pub first: L::Word,
}

/// What is the same for all rows of a footprint, on vectors.
pub struct RowWords<L: Wide> {
    /// First column that runs may begin at, from the block that the window begins in, and one past the last.
    columns: [i64; 2],
    reach: L::Word,
    squared_width: SquaredWidth<L>,
    /// Bits of a rest beyond [`REST`].
    drop: L::Word,
    drop_dx: RoundingShift<L>,
    turn_of_dx: L::Word,
    seeds: SeedWords<L>,
}

impl<L: Wide> RowWords<L> {
    /// Of a footprint whose words are [tame](is_tame), or of whatever.
    #[inline(always)]
    pub fn new(math: Arithmetic<L>, constants: &RowConstants<i64>) -> Self {
        let drop_dx = math.drop(math.splat(constants.drops.0.into()));
        let ([first, last], [visible, end]) = (constants.bounds, constants.visible);
        RowWords {
            columns: [first.max(visible - visible % BLOCK), last.min(end)].map(i64::from),
            reach: math.splat(constants.reach),
            squared_width: SquaredWidth::new(math, constants),
            drop: math.splat(constants.vertical_fraction.saturating_sub(REST).into()),
            drop_dx,
            turn_of_dx: math.turn_of(drop_dx),
            seeds: SeedWords::new(math, constants),
        }
    }
}

/// What the seeds of a footprint's runs are computed from.
#[derive(Clone, Copy)]
pub struct SeedWords<L: Wide> {
    horizontal: L::Word,
    /// Without what the shifts beside them leave too large.
    start: L::Word,
    unit: L::Word,
    drop_along: RoundingShift<L>,
    drop_radial: RoundingShift<L>,
    /// Right shift from the vertical distance to the radial index.
    pub drop_vertical: RoundingShift<L>,
    drop_first: RoundingShift<L>,
    /// Left shifts of radial index and first difference, where lanes have more fraction bits than the products.
    raises: [L::Word; 2],
}

impl<L: Wide> SeedWords<L> {
    /// Of a footprint.
    #[inline(always)]
    pub fn new(math: Arithmetic<L>, constants: &RowConstants<i64>) -> Self {
        let (_, bits, drop_radial, drop_first) = constants.drops;
        let raises = [drop_radial, drop_first].map(|drop| drop.min(0).unsigned_abs());
        let [drop_radial, drop_first] = [drop_radial, drop_first].map(|drop| drop.max(0) as u32);
        let drop_vertical = constants
            .vertical_fraction
            .saturating_sub(constants.fraction);
        SeedWords::of(
            math,
            [
                math.splat(constants.horizontal),
                math.splat(constants.start),
                math.splat(constants.unit),
            ],
            [
                math.splat(bits.into()),
                math.splat(drop_radial.into()),
                math.splat(drop_first.into()),
                math.splat(drop_vertical.into()),
            ],
            [math.splat(raises[0].into()), math.splat(raises[1].into())],
        )
    }

    /// Of the mantissa of A, what is added to the seeds, right shifts in the order of the fields, and left shifts.
    #[inline(always)]
    pub fn of(
        math: Arithmetic<L>,
        [horizontal, start, unit]: [L::Word; 3],
        [drop_along, drop_radial, drop_first, drop_vertical]: [L::Word; 4],
        raises: [L::Word; 2],
    ) -> Self {
        let (drop_along, drop_radial) = (math.drop(drop_along), math.drop(drop_radial));
        let (drop_first, drop_vertical) = (math.drop(drop_first), math.drop(drop_vertical));
        // A left shift drops the turn.
        let turn = math.lanes.wide_shl(math.turn_of(drop_radial), raises[0]);
        let turns = math.add(turn, math.turn_of(drop_vertical));
        let turn = math.lanes.wide_shl(math.turn_of(drop_first), raises[1]);
        SeedWords {
            horizontal,
            start: math.sub(start, turns),
            unit: math.sub(unit, turn),
            drop_along,
            drop_radial,
            drop_vertical,
            drop_first,
            raises,
        }
    }

    /// The words that differ between footprints without left shifts.
    #[inline(always)]
    pub fn different(&mut self) -> [&mut L::Word; 7] {
        let (radial, first) = (&mut self.drop_radial, &mut self.drop_first);
        let [a, b] = [&mut radial.raise, &mut radial.by];
        let [c, d] = [&mut first.raise, &mut first.by];
        [
            &mut self.horizontal,
            &mut self.start,
            &mut self.unit,
            a,
            b,
            c,
            d,
        ]
    }
}

/// The runs between two columns, the first of which begins a block, of rows with these centres and radial indices at
/// the centre. `large` becomes the largest distance from the centre.
#[inline(always)]
pub fn runs<L: Wide>(
    math: Arithmetic<L>,
    rows: &RowWords<L>,
    [centre, vertical]: [L::Word; 2],
    columns: [i64; 2],
    large: &mut L::Word,
) -> Runs<L> {
    let zero = math.splat(0);
    let rest = math.sub(rows.reach, vertical);
    let half = rows
        .squared_width
        .half_of(math, math.lanes.wide_shr(rest, rows.drop));
    let (low, high) = ends(math, centre, half);
    // An open row has its last column in the box beyond its first one: what lies outside makes the run empty.
    let x = math.max(low, math.splat(columns[0].max(rows.columns[0])));
    let high = math.min(high, math.splat(columns[1].min(rows.columns[1])));
    let end = math.select(zero, high, math.greater(rest, zero));
    let dx = math.dropped(math.sub(math.shl(x, 32), centre), rows.drop_dx);
    let dx = math.sub(dx, rows.turn_of_dx);
    let open = math.greater(end, x);
    let far = math.select(zero, math.magnitude(dx), open);
    *large = math.max(*large, far);
    let down = math.dropped(vertical, rows.seeds.drop_vertical);
    seeds(math, &rows.seeds, [x, end], [dx, down])
}

/// The runs between the columns of each row, `dx` from the centre and with so much, not turned back, from the vertical
/// distance.
#[inline(always)]
pub fn seeds<L: Wide>(
    math: Arithmetic<L>,
    rows: &SeedWords<L>,
    [x, end]: [L::Word; 2],
    [dx, down]: [L::Word; 2],
) -> Runs<L> {
    let along = math.mul(rows.horizontal, dx);
    // The product sees the lower 32 bits.
    let across = math.mul(math.dropped(along, rows.drop_along), dx);
    let across = math.dropped(across, rows.drop_radial);
    let radial = math.add(math.lanes.wide_shl(across, rows.raises[0]), down);
    let first = math.dropped(along, rows.drop_first);
    Runs {
        x,
        end,
        radial: math.add(radial, rows.start),
        first: math.add(math.lanes.wide_shl(first, rows.raises[1]), rows.unit),
    }
}

/// Bits of the largest distance from the centre that are too many for the arithmetic of [`runs`]; 0 if there are none.
#[inline(always)]
pub fn excess<L: Wide>(lanes: L, constants: &RowConstants<i64>, large: L::Word) -> L::Word {
    // Designs of at most 15 bits keep dx below their mantissa, and all of a seed in 32 bits.
    // So do those whose products are shifted to the left, which must not reach the sign.
    let (_, bits, drop_radial, drop_first) = constants.drops;
    let most = if bits <= 15 || drop_radial.min(drop_first) < 0 {
        bits
    } else {
        bits.max(30)
    };
    lanes.wide_shr(large, lanes.wide_splat(most.into()))
}

/// Do the words of so many rows fit the vectors' arithmetic, apart from what is noticed row by row?
#[inline(always)]
pub fn stays_near(constants: &RowConstants<i64>, count: usize) -> bool {
    let farthest = 1 << 60;
    let is_near = |block: &RowBlock| block.centre.unsigned_abs() < farthest;
    constants.blocks.iter().all(is_near)
        && constants.shear.unsigned_abs() < farthest / (count + WORDS) as u64
}

/// Are a footprint's words small enough for vectors, whatever the row?
#[inline(always)]
pub fn is_tame(constants: &RowConstants<i64>) -> bool {
    let (_, bits, drop_radial, drop_first) = constants.drops;
    // A product of two mantissas, shifted to the left, stays below 2^62, and below 2^31 times a lane's word.
    let most_raised = (62 - 2 * bits as i32).clamp(0, 31);
    // Designs of at most 18 bits multiply the root's argument in two halves.
    let short = if bits <= 18 { 18 } else { 32 };
    constants.squared_width.0 < 1 << short
        && constants.squared_width.2 <= 30
        && constants.horizontal.unsigned_abs() <= 1 << bits
        && drop_radial.min(drop_first) >= -most_raised
}

/// 1 / A on vectors, for half-widths sqrt(rest / A) by the root table, a multiplication and a shift that rounds.
#[derive(Clone, Copy)]
pub struct SquaredWidth<L: Wide> {
    /// Mantissa of 1 / A, 1 if its exponent is odd, and the power of two of its root, Q.32.
    pub mantissa: L::Word,
    /// See `mantissa`.
    pub odd: L::Word,
    /// See `mantissa`.
    pub power: L::Word,
}

impl<L: Wide> SquaredWidth<L> {
    /// Of a footprint.
    #[inline(always)]
    pub fn new(math: Arithmetic<L>, constants: &RowConstants<i64>) -> Self {
        let (mantissa, odd, power) = constants.squared_width;
        SquaredWidth {
            mantissa: math.splat(mantissa as i64),
            odd: math.splat(odd.into()),
            power: math.splat(power.into()),
        }
    }

    /// Q.32 pixels, for rows with a positive rest of the cut-off, of [`REST`] fraction bits; anything for others.
    #[inline(always)]
    pub fn half_of(&self, math: Arithmetic<L>, narrow: L::Word) -> L::Word {
        let (lanes, zero) = (math.lanes, math.splat(0));
        let squared = lanes.wide_mul_unsigned(self.mantissa, narrow);
        let squared = lanes.wide_shl(squared, self.odd);
        let (root, shift) = math.root_seed(squared);
        let root = math.select(root, zero, lanes.wide_equal(squared, zero));
        // Roots have no sign: of the shifts to the left and to the right, one is by a negative amount and gives 0.
        let left = math.add(shift, self.power);
        let right = math.sub(math.splat(-1), left);
        let rounded = math.shr(math.plus(lanes.wide_shr(root, right), 1), 1);
        math.add(rounded, lanes.wide_shl(root, left))
    }
}

/// First column and one past the last whose sample points lie within `half` of the centre.
#[inline(always)]
fn ends<L: Wide>(math: Arithmetic<L>, centre: L::Word, half: L::Word) -> (L::Word, L::Word) {
    let low = math.floor(math.sub(centre, half), (1 << 32) - 1, 32);
    let high = math.floor(math.add(centre, half), 0, 32);
    (low, math.plus(high, 1))
}
