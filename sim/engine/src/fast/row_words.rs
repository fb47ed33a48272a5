//! A footprint's rows in words of 64 bits, a row in each: root, span and seeds, as the kernel's
//! [`EllipseSpans`](splatline::raster::EllipseSpans) have them.
//!
//! Both sequences down the rows are polynomials in integers that wrap: row k has `centre + k slope` and
//! `vertical + k change + k (k - 1) / 2 second`, without an order of summation.
//!
//! [`row_reals`](super::row_reals) takes the seeds and the root's table from here and computes the rest in doubles.
//! What words could not hold is told by [`is_tame`] beforehand and by [`excess`] afterwards.

use super::lanes::Lanes;
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
pub struct RowVectors<L: Lanes> {
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

impl<L: Lanes> RowVectors<L> {
    /// The first rows of a block.
    #[inline(always)]
    pub fn new(lanes: L, constants: &RowConstants<i64>, block: &RowBlock) -> Self {
        let splat = |value| lanes.splat(value);
        let width = L::WIDE as i64;
        let rows: [i64; WORDS] = [0, 1, 2, 3, 4, 5, 6, 7];
        let pairs: [i64; WORDS] = [0, 0, 1, 3, 6, 10, 15, 21];
        let [rows, pairs] = [lanes.load(&rows), lanes.load(&pairs)];
        let times = |rows: L::Word, value| lanes.mul_whole(rows, splat(value));
        let ([vertical, change], second) = (block.vertical, constants.curve);
        // From row k to row k + w: w (change + k second) + w (w - 1) / 2 second.
        let along = change
            .wrapping_mul(width)
            .wrapping_add(second.wrapping_mul(width * (width - 1) / 2));
        let curved = lanes.add(times(rows, change), times(pairs, second));
        let along_of_row = times(rows, second.wrapping_mul(width));
        RowVectors {
            centre: lanes.add(splat(block.centre), times(rows, constants.shear)),
            vertical: lanes.add(splat(vertical), curved),
            slope: splat(constants.shear.wrapping_mul(width)),
            change: lanes.add(splat(along), along_of_row),
            second: splat(second.wrapping_mul(width * width)),
            reach: splat(constants.reach),
            longest: splat(0),
            limit: longest_rest(constants.drops.1, constants.vertical_fraction),
        }
    }

    /// What the rows leave of the cut-off.
    #[inline(always)]
    pub fn rest(&self, lanes: L) -> L::Word {
        lanes.sub(self.reach, self.vertical)
    }

    /// On to the next rows.
    #[inline(always)]
    pub fn step(&mut self, lanes: L) {
        self.longest = lanes.max(self.longest, self.rest(lanes));
        self.centre = lanes.add(self.centre, self.slope);
        self.vertical = lanes.add(self.vertical, self.change);
        self.change = lanes.add(self.change, self.second);
    }

    /// Bits of what the rows behind us left of the cut-off that the root does not take: 0 if there are none.
    #[inline(always)]
    pub fn excess(&self, lanes: L) -> L::Word {
        lanes.shr(self.longest, lanes.splat(self.limit.into()))
    }
}

/// Runs of several rows in one block: a word for each row. Empty where `end` is not beyond `x`.
#[derive(Clone, Copy)]
pub struct Runs<L: Lanes> {
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
pub struct RowWords<L: Lanes> {
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

impl<L: Lanes> RowWords<L> {
    /// Of a footprint whose words are [tame](is_tame), or of whatever.
    #[inline(always)]
    pub fn new(lanes: L, constants: &RowConstants<i64>) -> Self {
        let drop_dx = lanes.rounding_shift(lanes.splat(constants.drops.0.into()));
        let ([first, last], [visible, end]) = (constants.bounds, constants.visible);
        RowWords {
            columns: [first.max(visible - visible % BLOCK), last.min(end)].map(i64::from),
            reach: lanes.splat(constants.reach),
            squared_width: SquaredWidth::new(lanes, constants),
            drop: lanes.splat(constants.vertical_fraction.saturating_sub(REST).into()),
            drop_dx,
            turn_of_dx: lanes.turn_of(drop_dx),
            seeds: SeedWords::new(lanes, constants),
        }
    }
}

/// What the seeds of a footprint's runs are computed from.
#[derive(Clone, Copy)]
pub struct SeedWords<L: Lanes> {
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

impl<L: Lanes> SeedWords<L> {
    /// Of a footprint.
    #[inline(always)]
    pub fn new(lanes: L, constants: &RowConstants<i64>) -> Self {
        let (_, bits, drop_radial, drop_first) = constants.drops;
        let raises = [drop_radial, drop_first].map(|drop| drop.min(0).unsigned_abs());
        let [drop_radial, drop_first] = [drop_radial, drop_first].map(|drop| drop.max(0) as u32);
        let drop_vertical = constants
            .vertical_fraction
            .saturating_sub(constants.fraction);
        SeedWords::of(
            lanes,
            [
                lanes.splat(constants.horizontal),
                lanes.splat(constants.start),
                lanes.splat(constants.unit),
            ],
            [
                lanes.splat(bits.into()),
                lanes.splat(drop_radial.into()),
                lanes.splat(drop_first.into()),
                lanes.splat(drop_vertical.into()),
            ],
            [lanes.splat(raises[0].into()), lanes.splat(raises[1].into())],
        )
    }

    /// Of the mantissa of A, what is added to the seeds, right shifts in the order of the fields, and left shifts.
    #[inline(always)]
    pub fn of(
        lanes: L,
        [horizontal, start, unit]: [L::Word; 3],
        [drop_along, drop_radial, drop_first, drop_vertical]: [L::Word; 4],
        raises: [L::Word; 2],
    ) -> Self {
        let (drop_along, drop_radial) = (
            lanes.rounding_shift(drop_along),
            lanes.rounding_shift(drop_radial),
        );
        let (drop_first, drop_vertical) = (
            lanes.rounding_shift(drop_first),
            lanes.rounding_shift(drop_vertical),
        );
        // A left shift drops the turn.
        let turn = lanes.shl(lanes.turn_of(drop_radial), raises[0]);
        let turns = lanes.add(turn, lanes.turn_of(drop_vertical));
        let turn = lanes.shl(lanes.turn_of(drop_first), raises[1]);
        SeedWords {
            horizontal,
            start: lanes.sub(start, turns),
            unit: lanes.sub(unit, turn),
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
pub fn runs<L: Lanes>(
    lanes: L,
    rows: &RowWords<L>,
    [centre, vertical]: [L::Word; 2],
    columns: [i64; 2],
    large: &mut L::Word,
) -> Runs<L> {
    let zero = lanes.splat(0);
    let rest = lanes.sub(rows.reach, vertical);
    let half = rows
        .squared_width
        .half_of(lanes, lanes.shr(rest, rows.drop));
    let (low, high) = ends(lanes, centre, half);
    // An open row has its last column in the box beyond its first one: what lies outside makes the run empty.
    let x = lanes.max(low, lanes.splat(columns[0].max(rows.columns[0])));
    let high = lanes.min(high, lanes.splat(columns[1].min(rows.columns[1])));
    let end = lanes.select(zero, high, lanes.greater(rest, zero));
    let dx = lanes.dropped(lanes.sub(lanes.shl_by(x, 32), centre), rows.drop_dx);
    let dx = lanes.sub(dx, rows.turn_of_dx);
    let open = lanes.greater(end, x);
    let far = lanes.select(zero, lanes.magnitude(dx), open);
    *large = lanes.max(*large, far);
    let down = lanes.dropped(vertical, rows.seeds.drop_vertical);
    seeds(lanes, &rows.seeds, [x, end], [dx, down])
}

/// The runs between the columns of each row, `dx` from the centre and with so much, not turned back, from the vertical
/// distance.
#[inline(always)]
pub fn seeds<L: Lanes>(
    lanes: L,
    rows: &SeedWords<L>,
    [x, end]: [L::Word; 2],
    [dx, down]: [L::Word; 2],
) -> Runs<L> {
    let along = lanes.mul(rows.horizontal, dx);
    // The product sees the lower 32 bits.
    let across = lanes.mul(lanes.dropped(along, rows.drop_along), dx);
    let across = lanes.dropped(across, rows.drop_radial);
    let radial = lanes.add(lanes.shl(across, rows.raises[0]), down);
    let first = lanes.dropped(along, rows.drop_first);
    Runs {
        x,
        end,
        radial: lanes.add(radial, rows.start),
        first: lanes.add(lanes.shl(first, rows.raises[1]), rows.unit),
    }
}

/// Bits of the largest distance from the centre that are too many for the arithmetic of [`runs`]; 0 if there are none.
#[inline(always)]
pub fn excess<L: Lanes>(lanes: L, constants: &RowConstants<i64>, large: L::Word) -> L::Word {
    // Designs of at most 15 bits keep dx below their mantissa, and all of a seed in 32 bits.
    // So do those whose products are shifted to the left, which must not reach the sign.
    let (_, bits, drop_radial, drop_first) = constants.drops;
    let most = if bits <= 15 || drop_radial.min(drop_first) < 0 {
        bits
    } else {
        bits.max(30)
    };
    lanes.shr(large, lanes.splat(most.into()))
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
pub struct SquaredWidth<L: Lanes> {
    /// Mantissa of 1 / A, 1 if its exponent is odd, and the power of two of its root, Q.32.
    pub mantissa: L::Word,
    /// See `mantissa`.
    pub odd: L::Word,
    /// See `mantissa`.
    pub power: L::Word,
}

impl<L: Lanes> SquaredWidth<L> {
    /// Of a footprint.
    #[inline(always)]
    pub fn new(lanes: L, constants: &RowConstants<i64>) -> Self {
        let (mantissa, odd, power) = constants.squared_width;
        SquaredWidth {
            mantissa: lanes.splat(mantissa as i64),
            odd: lanes.splat(odd.into()),
            power: lanes.splat(power.into()),
        }
    }

    /// Q.32 pixels, for rows with a positive rest of the cut-off, of [`REST`] fraction bits; anything for others.
    #[inline(always)]
    pub fn half_of(&self, lanes: L, narrow: L::Word) -> L::Word {
        let zero = lanes.splat(0);
        let squared = lanes.mul_unsigned(self.mantissa, narrow);
        let squared = lanes.shl(squared, self.odd);
        let (root, shift) = lanes.root_seed(squared);
        let root = lanes.select(root, zero, lanes.equal(squared, zero));
        // Roots have no sign: of the shifts to the left and to the right, one is by a negative amount and gives 0.
        let left = lanes.add(shift, self.power);
        let right = lanes.sub(lanes.splat(-1), left);
        let rounded = lanes.shr_by(lanes.plus(lanes.shr(root, right), 1), 1);
        lanes.add(rounded, lanes.shl(root, left))
    }
}

/// First column and one past the last whose sample points lie within `half` of the centre.
#[inline(always)]
fn ends<L: Lanes>(lanes: L, centre: L::Word, half: L::Word) -> (L::Word, L::Word) {
    let low = lanes.floor(lanes.sub(centre, half), (1 << 32) - 1, 32);
    let high = lanes.floor(lanes.add(centre, half), 0, 32);
    (low, lanes.plus(high, 1))
}
