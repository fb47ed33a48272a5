//! The pixel path on 64-bit words: radial index, footprint table, opacity, and "over" front to back or one of the two
//! operators without an end.
//!
//! Bit for bit what [`FootprintTable::weight`], [`Blend::opacity`] and [`Blend::front_to_back`] (or `back_to_front`,
//! `x_ray`) give, pixel by pixel, for values within their formats. Five things make it short:
//!
//! - r(x + w) = r(x) + w f(x) + w (w - 1) / 2 s with the differences f and s: w pixels on, the radial index still costs
//!   two additions, exactly, because integers that wrap have no order of summation. Lanes of 32 bits lie in the upper
//!   half of a word, so that they wrap as lanes of 64 do.
//! - Every product is of 32 bits by 32 and stays in its word.
//! - A pixel is two words ([`super::tile`]): half the memory, and sums of two colours are read, added and written
//!   together. The transmittance lies in an upper half, where the mark is the word's sign.
//! - A contribution of 0 leaves a pixel as it is, whatever its state: T - 0 = T > stop for a pixel in work, and a
//!   finished pixel's word is negative, hence below stop, hence marked again. So pixels outside or finished need no
//!   selection: the first have opacity 0, the others no transmittance.
//! - A table that falls is interpolated without a sign: low + ((change rest + half) >> k) = low - ((fall rest + half -
//!   1) >> k).
//!
//! [`FootprintTable::weight`]: splatline::kernel::FootprintTable::weight

use super::numbers::{
    ANY, BACK_TO_FRONT, DRAW_FINISHING, EVEN, LAYERS, OMIT_FINISHING, PathNumbers, SplatNumbers,
    UNUSUAL, X_RAY,
};
use super::tile::{PixelWord, Row};
use crate::fast::lanes::Lanes;
use crate::fast::lanes::words::Entries;
use crate::fast::rows::Pixels;
use crate::fast::setup::number::BitDrop;
use crate::fast::tile::TILE;
use splatline::draw::Coverage;

/// The pixels of a footprint's runs, by whatever words.
pub trait PixelPath {
    /// Word of a pixel.
    type Word: PixelWord;
    /// What is constant for a footprint.
    type Splat: Copy;
    /// Can it paint a footprint with these numbers?
    #[inline(always)]
    fn fits(&self, _: &SplatNumbers) -> bool {
        true
    }
    /// A footprint's constants, for rows with this second difference.
    fn splat(&self, numbers: &SplatNumbers, second: i64) -> Self::Splat;
    /// Paints some pixels of a row; covered ones, and those of them that had finished, are counted if `COUNTS` says so.
    fn paint<const COUNTS: bool>(
        &self,
        splat: &Self::Splat,
        pixels: &Pixels,
        row: &mut Row<Self::Word>,
        counts: &mut Coverage,
    );
    /// Does a vector hold short runs of two rows?
    const TAKES_TWO: bool = false;
    /// Paints the short runs of two adjacent rows.
    fn paint_two(&self, _: &Self::Splat, _: &TwoRuns, _: &mut [Row<Self::Word>; 2]) {}
    /// A bit for every finished pixel of a row.
    fn finished(&self, row: &Row<Self::Word>) -> u64;
}

/// Columns of a short run.
pub const SHORT: usize = 4;

/// Runs of two adjacent rows, of at most [`SHORT`] pixels each: their first columns, a bit for every pixel to be
/// painted, and seeds.
#[derive(Clone, Copy, Debug)]
pub struct TwoRuns<'a> {
    pub x: &'a [i64; 2],
    pub pixels: &'a [i64; 2],
    pub radial: &'a [i64; 2],
    pub first: &'a [i64; 2],
}

/// The path on vectors.
#[derive(Clone, Copy)]
pub struct WordPixels<'a, L: Lanes, const OPERATOR: u8> {
    lanes: L,
    /// The operator, for the copy that looks it up.
    operator: u8,
    entries: Entries<'a>,
    /// Left shifts of lanes that have 32 bits, and to a vector's width.
    raise: u32,
    width: L::Word,
    /// Right shift from a raised radial index to its interval.
    interval: L::Word,
    /// Right shift and mask that leave the position within it.
    position: L::Word,
    position_mask: L::Word,
    kept: L::Word,
    kept_half: L::Word,
    opacity: ShiftWords<L>,
    share: ShiftWords<L>,
    colour: ShiftWords<L>,
    alpha_max: L::Word,
    opacity_min: L::Word,
    stop: L::Word,
    mark: L::Word,
    /// Left shift of a green contribution to its half.
    green: L::Word,
    layer: ShiftWords<L>,
    /// Left shift of an opacity before it.
    raised: L::Word,
    light: ShiftWords<L>,
    last: L::Word,
}

/// A [`BitDrop`] on vectors.
#[derive(Clone, Copy)]
struct ShiftWords<L: Lanes> {
    by: L::Word,
    half: L::Word,
    odd: L::Word,
}

/// What is constant for a footprint.
#[derive(Clone, Copy)]
pub struct SplatWords<L: Lanes> {
    end: L::Word,
    peak: L::Word,
    colour: [L::Word; 3],
    /// k (k - 1) / 2 s and w (w - 1) / 2 s + w k s for pixel k of a vector of w.
    ahead: [L::Word; 2],
    /// w^2 s.
    second: L::Word,
}

impl<'a, L: Lanes, const OPERATOR: u8> WordPixels<'a, L, OPERATOR> {
    /// On these vectors.
    #[inline(always)]
    pub fn new(lanes: L, numbers: &'a PathNumbers) -> Self {
        let word = |value: u64| lanes.splat(value as i64);
        let shift = |BitDrop { by, half, odd }| ShiftWords {
            by: word(by.into()),
            half: word(half),
            odd: word(odd),
        };
        let widths = numbers.rows.widths();
        let [alpha, transmittance] = [widths.alpha, widths.transmittance];
        let (rest, kept) = (numbers.rest_bits, numbers.kept);
        WordPixels {
            lanes,
            operator: numbers.operator,
            entries: Entries::new(&numbers.entries),
            raise: numbers.raise,
            width: word(L::WIDE.ilog2().into()),
            interval: word(u64::from(numbers.raise + rest)),
            position: word(u64::from(numbers.raise + rest - kept)),
            position_mask: word((1 << kept) - 1),
            kept: word(kept.into()),
            // Half of a unit less one; an entry that is not interpolated loses nothing.
            kept_half: word(((1u64 << kept) >> 1).saturating_sub(1)),
            opacity: shift(numbers.opacity),
            share: shift(numbers.share),
            colour: shift(numbers.colour),
            alpha_max: word(numbers.alpha_max.into()),
            opacity_min: lanes.splat(numbers.opacity_min),
            stop: lanes.splat(numbers.stop << 32),
            mark: lanes.splat(super::tile::MARK),
            green: word(32u32.saturating_sub(numbers.colour.by).into()),
            layer: shift(numbers.layer.unwrap_or(numbers.light)),
            raised: word(transmittance.saturating_sub(alpha).into()),
            light: shift(numbers.light),
            last: word(u32::MAX.into()),
        }
    }

    /// The operator, a constant in copies for one.
    #[inline(always)]
    fn operator(&self) -> u8 {
        match OPERATOR {
            ANY => self.operator,
            LAYERS => BACK_TO_FRONT | self.operator & X_RAY,
            one => one,
        }
    }

    /// The vectors.
    #[inline(always)]
    pub fn lanes(&self) -> L {
        self.lanes
    }

    /// Radial indices of the first vector of some pixels, and their differences to the next one's.
    #[inline(always)]
    pub fn start(&self, splat: &SplatWords<L>, pixels: &Pixels) -> [L::Word; 2] {
        let lanes = self.lanes;
        let raised = |lane: i64| lanes.splat(lane << self.raise);
        let first = raised(pixels.first);
        let start = lanes.add(raised(pixels.radial), splat.ahead[0]);
        let radial = lanes.add(start, lanes.multiples(first));
        let width = lanes.shl(first, self.width);
        [radial, lanes.add(width, splat.ahead[1])]
    }

    /// On to the next vector.
    #[inline(always)]
    pub fn step(&self, splat: &SplatWords<L>, [radial, difference]: [L::Word; 2]) -> [L::Word; 2] {
        let lanes = self.lanes;
        [
            lanes.add(radial, difference),
            lanes.add(difference, splat.second),
        ]
    }

    /// Which of the first `rest` words are radial indices inside the footprint?
    #[inline(always)]
    pub fn inside(&self, splat: &SplatWords<L>, radial: L::Word, rest: usize) -> L::Truth {
        let lanes = self.lanes;
        lanes.both(lanes.greater(splat.end, radial), lanes.first(rest))
    }

    /// Opacities at these radial indices where they are inside, 0 elsewhere.
    #[inline(always)]
    pub fn alpha(&self, splat: &SplatWords<L>, radial: L::Word, inside: L::Truth) -> L::Word {
        let lanes = self.lanes;
        let product = lanes.mul_unsigned(splat.peak, self.weight(radial));
        let product = lanes.keep(product, inside);
        let product = if matches!(OPERATOR, DRAW_FINISHING | OMIT_FINISHING) {
            // What is below the usual threshold rounds to 0: see [`UNUSUAL`].
            product
        } else {
            lanes.clear(product, lanes.greater(self.opacity_min, product))
        };
        lanes.min_short(self.rounded(product, self.opacity), self.alpha_max)
    }

    /// One vector of pixels.
    #[inline(always)]
    fn blend<const COUNTS: bool>(
        &self,
        splat: &SplatWords<L>,
        radial: L::Word,
        inside: L::Truth,
        x: usize,
        row: &mut Row<i64>,
        counts: &mut Coverage,
    ) {
        let lanes = self.lanes;
        // Never changes x; tells the compiler that a vector fits.
        let x = x % usize::from(TILE[0]);
        let light = lanes.read(&row[0], x);
        if COUNTS {
            let finished = lanes.both(inside, lanes.marked(light));
            counts.covered += u64::from(lanes.flags(inside).count_ones());
            counts.finished += u64::from(lanes.flags(finished).count_ones());
        }
        if self.operator() & BACK_TO_FRONT != 0 {
            let live = lanes.except(inside, lanes.marked(light));
            self.layer(splat, self.alpha(splat, radial, live), live, x, row);
            return;
        }
        let alpha = self.alpha(splat, radial, inside);
        let left = lanes.unmarked(light);
        let share = self.rounded(lanes.mul_unsigned(left, alpha), self.share);
        let rest = lanes.sub(light, lanes.raised(share));
        let stop = lanes.greater(self.stop, rest);
        let (share, after) = if self.operator() & OMIT_FINISHING != 0 {
            (lanes.clear(share, stop), lanes.select(rest, light, stop))
        } else {
            (share, rest)
        };
        let after = lanes.or(after, lanes.keep(self.mark, stop));
        if self.operator() & (EVEN | UNUSUAL) == 0 {
            self.colour(splat, share, after, x, row);
        } else {
            self.any_colour(splat, share, after, x, row);
        }
    }

    /// Adds contributions to colours, of which two are in place after a shift each.
    #[inline(always)]
    fn colour(
        &self,
        splat: &SplatWords<L>,
        share: L::Word,
        after: L::Word,
        x: usize,
        row: &mut Row<i64>,
    ) {
        let lanes = self.lanes;
        let [red, green, blue] = splat.colour;
        let red = lanes.add(lanes.mul_unsigned(share, red), self.colour.half);
        let green = lanes.add(lanes.mul_unsigned(share, green), self.colour.half);
        let blue = lanes.add(lanes.mul_unsigned(share, blue), self.colour.half);
        // No accumulator has more than 27 fraction bits, so that a contribution fits half a word.
        let blue = lanes.shr(blue, self.colour.by);
        lanes.write(&mut row[0], x, lanes.add_halves(after, blue));
        let red = lanes.shr(red, self.colour.by);
        let both = lanes.halves(red, lanes.shl(green, self.green));
        let sums = lanes.read(&row[1], x);
        lanes.write(&mut row[1], x, lanes.add_halves(sums, both));
    }

    /// The same for all shifts, and with ties to even, for which the sum is what is rounded.
    #[inline(always)]
    fn any_colour(
        &self,
        splat: &SplatWords<L>,
        share: L::Word,
        after: L::Word,
        x: usize,
        row: &mut Row<i64>,
    ) {
        let lanes = self.lanes;
        let [red, green, blue] = splat.colour;
        let blue = self.added(after, share, blue);
        lanes.write(&mut row[0], x, lanes.halves(blue, after));
        let sums = lanes.read(&row[1], x);
        let red = self.added(sums, share, red);
        let green = self.added(lanes.upper(sums), share, green);
        lanes.write(&mut row[1], x, lanes.halves(red, lanes.raised(green)));
    }

    /// A contribution's light of a colour added to the sum in a lower half.
    #[inline(always)]
    fn added(&self, sum: L::Word, share: L::Word, colour: L::Word) -> L::Word {
        let lanes = self.lanes;
        let product = lanes.mul_unsigned(share, colour);
        if self.operator() & EVEN == 0 {
            return lanes.add(sum, self.rounded(product, self.colour));
        }
        let sum = lanes.shl(lanes.lower(sum), self.colour.by);
        self.rounded(lanes.add(sum, product), self.colour)
    }

    /// [`Blend::back_to_front`] or [`Blend::x_ray`]: opacities are at most 1, so that what a layer hides of a sum is at
    /// most the sum.
    #[inline(always)]
    fn layer(
        &self,
        splat: &SplatWords<L>,
        alpha: L::Word,
        inside: L::Truth,
        x: usize,
        row: &mut Row<i64>,
    ) {
        let lanes = self.lanes;
        let [red, green, blue] = splat.colour;
        let first = lanes.read(&row[0], x);
        let light = lanes.upper(first);
        let rest = if self.is_x_ray() {
            let taken = self.rounded(lanes.shl(alpha, self.raised), self.light);
            let rest = lanes.sub(light, taken);
            lanes.clear(rest, lanes.marked(rest))
        } else {
            lanes.sub(light, self.hidden(light, alpha))
        };
        let blue = self.above(lanes.lower(first), alpha, blue);
        let after = lanes.halves(blue, lanes.raised(rest));
        // Marks beyond the tile stay.
        lanes.write(&mut row[0], x, lanes.select(first, after, inside));
        let sums = lanes.read(&row[1], x);
        let red = self.above(lanes.lower(sums), alpha, red);
        let green = self.above(lanes.upper(sums), alpha, green);
        lanes.write(&mut row[1], x, lanes.halves(red, lanes.raised(green)));
    }

    #[inline(always)]
    fn is_x_ray(&self) -> bool {
        self.operator() & X_RAY == X_RAY
    }

    /// What a layer hides of a sum or a transmittance.
    #[inline(always)]
    fn hidden(&self, word: L::Word, alpha: L::Word) -> L::Word {
        self.rounded(self.lanes.mul_unsigned(word, alpha), self.share)
    }

    /// A sum behind a layer of a colour, at most the format's last number.
    #[inline(always)]
    fn above(&self, sum: L::Word, alpha: L::Word, colour: L::Word) -> L::Word {
        let lanes = self.lanes;
        let layer = self.rounded(lanes.mul_unsigned(alpha, colour), self.layer);
        let rest = if self.is_x_ray() {
            sum
        } else {
            lanes.sub(sum, self.hidden(sum, alpha))
        };
        let sum = lanes.add(rest, layer);
        lanes.select(sum, self.last, lanes.greater(sum, self.last))
    }

    /// A product brought back to its format.
    #[inline(always)]
    fn rounded(&self, product: L::Word, shift: ShiftWords<L>) -> L::Word {
        let lanes = self.lanes;
        let half = if self.operator() & EVEN == 0 {
            shift.half
        } else {
            let odd = lanes.and(lanes.shr(product, shift.by), shift.odd);
            lanes.add(shift.half, odd)
        };
        lanes.shr(lanes.add(product, half), shift.by)
    }

    /// The kernel at raised radial indices inside the footprint, in lower halves; anything elsewhere.
    #[inline(always)]
    fn weight(&self, radial: L::Word) -> L::Word {
        let lanes = self.lanes;
        let radial = lanes.clear(radial, lanes.marked(radial));
        let entries = lanes.pairs(self.entries, lanes.shr(radial, self.interval));
        let position = lanes.and(lanes.shr(radial, self.position), self.position_mask);
        let fall = lanes.sub(entries, lanes.upper(entries));
        let fall = lanes.add(lanes.mul_unsigned(fall, position), self.kept_half);
        lanes.sub(entries, lanes.shr(fall, self.kept))
    }
}

impl<L: Lanes, const OPERATOR: u8> PixelPath for WordPixels<'_, L, OPERATOR> {
    type Word = i64;
    type Splat = SplatWords<L>;

    #[inline(always)]
    fn splat(&self, numbers: &SplatNumbers, second: i64) -> SplatWords<L> {
        let lanes = self.lanes;
        let width = L::WIDE as i64;
        let second = second << self.raise;
        let seconds = lanes.splat(second);
        let pairs: [i64; 8] = [0, 0, 1, 3, 6, 10, 15, 21];
        let along = lanes.multiples(lanes.splat(second.wrapping_mul(width)));
        let whole = lanes.splat(second.wrapping_mul(width * (width - 1) / 2));
        SplatWords {
            end: lanes.splat(numbers.end),
            peak: lanes.splat(numbers.peak.into()),
            colour: [
                lanes.splat(numbers.colour[0].into()),
                lanes.splat(numbers.colour[1].into()),
                lanes.splat(numbers.colour[2].into()),
            ],
            ahead: [
                lanes.mul_whole(lanes.load(&pairs), seconds),
                lanes.add(whole, along),
            ],
            second: lanes.splat(second.wrapping_mul(width * width)),
        }
    }

    #[inline(always)]
    fn paint<const COUNTS: bool>(
        &self,
        splat: &SplatWords<L>,
        pixels: &Pixels,
        row: &mut Row<i64>,
        counts: &mut Coverage,
    ) {
        let lanes = self.lanes;
        let [mut radial, mut difference] = self.start(splat, pixels);
        let (mut x, mut rest) = (pixels.x, pixels.length);
        while rest > L::WIDE {
            let inside = lanes.greater(splat.end, radial);
            self.blend::<COUNTS>(splat, radial, inside, x, row, counts);
            [radial, difference] = self.step(splat, [radial, difference]);
            x += L::WIDE;
            rest -= L::WIDE;
        }
        let inside = self.inside(splat, radial, rest);
        self.blend::<COUNTS>(splat, radial, inside, x, row, counts);
    }

    #[inline(always)]
    fn finished(&self, row: &Row<i64>) -> u64 {
        let lanes = self.lanes;
        let columns = (0..usize::from(TILE[0])).step_by(L::WIDE);
        columns.fold(0, |all, x| {
            let flags = lanes.flags(lanes.marked(lanes.read(&row[0], x)));
            all | u64::from(flags) << x
        })
    }
}
