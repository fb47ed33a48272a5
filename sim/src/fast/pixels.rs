//! The pixel path on vectors: radial index, footprint table, opacity, "over" front to back.
//!
//! Bit for bit what [`FootprintTable::weight`], [`Blend::opacity`] and [`Blend::front_to_back`] give, pixel by pixel, for values within
//! their formats. Three things make it short:
//!
//! - r(x + w) = r(x) + w f(x) + w (w - 1) / 2 s with the differences f and s: w pixels on, the radial index still costs two additions,
//!   exactly, because integers modulo 2^32 have no order of summation.
//! - An opacity of 0 leaves a pixel as it is, whatever its state: T - 0 = T > stop for a pixel in work, and a finished pixel's word
//!   is negative, hence below stop, hence marked again. So pixels outside or finished need no selection, only opacity 0.
//! - The sum of shares never exceeds 1, so that colours stay below 16 and cannot saturate.

use super::lanes::{Drop, Lanes};
use super::tile::{TILE, TileRow};
use splatline::blend::{Blend, BlendConstants, FINISHED};
use splatline::draw::{Coverage, cutoff_in_lane};
use splatline::footprint::Footprint;
use splatline::format::{Lane, Rounding, Widths};
use splatline::kernel::FootprintTable;
use splatline::raster::Run;
use splatline::rules::Rules;

/// The table in the form in which vectors read it: an interval's value and its change.
#[derive(Clone, Debug)]
pub struct Intervals {
    lows: Vec<u32>,
    changes: Vec<u32>,
    rest_bits: u32,
    /// Largest magnitude of a change.
    steepest: u32,
}

impl Intervals {
    /// Every interval of `table`.
    pub fn new(table: &FootprintTable) -> Self {
        let entries = table.entries();
        let lows = entries[..entries.len() - 1].to_vec();
        let changes: Vec<u32> = entries
            .windows(2)
            .map(|pair| pair[1].wrapping_sub(pair[0]))
            .collect();
        let steepest = changes
            .iter()
            .map(|change| (*change as i32).unsigned_abs())
            .max()
            .unwrap_or(0);
        Intervals {
            lows,
            changes,
            rest_bits: table.rest_bits(),
            steepest,
        }
    }

    /// Do all radial indices up to `last` lie in the table?
    #[inline(always)]
    fn reach(&self, last: i32) -> bool {
        last < 0 || ((last as u32) >> self.rest_bits) < self.lows.len() as u32
    }
}

/// What widths ask of the three products.
#[derive(Clone, Copy, Debug)]
struct Products {
    opacity: Drop,
    share: Drop,
    colour: Drop,
}

impl Products {
    #[inline(always)]
    const fn new(widths: &Widths, constants: &BlendConstants) -> Products {
        let rounding = constants.rounding;
        let (peak, colour) = (4 + widths.peak as u32, 4 + widths.colour as u32);
        let (weight, alpha) = (widths.weight as u32 + 1, widths.alpha as u32 + 1);
        let transmittance = widths.transmittance as u32 + 1;
        Products {
            opacity: drop(rounding, constants.opacity_shift, peak + weight),
            share: drop(rounding, constants.share_shift, transmittance + alpha),
            colour: drop(
                rounding,
                constants.colour_shift + raise(widths, constants) as i32,
                transmittance + colour + raise(widths, constants),
            ),
        }
    }
}

/// How far colours can be shifted to the left once per footprint, so that the product's result lies in its upper word and needs no shift.
#[inline(always)]
const fn raise(widths: &Widths, constants: &BlendConstants) -> u32 {
    let shift = constants.colour_shift;
    let wide = widths.transmittance as u32 + 1 + 4 + widths.colour as u32 > 31;
    if wide && shift <= 32 && 4 + widths.colour as i32 + 32 - shift <= 32 {
        (32 - shift) as u32
    } else {
        0
    }
}

/// A product of so many bits, brought back by `shift`.
#[inline(always)]
const fn drop(rounding: Rounding, shift: i32, bits: u32) -> Drop {
    let shift = (shift & 63) as u32;
    let half = match rounding {
        Rounding::Nearest => (1 << shift) >> 1,
        Rounding::Truncate => 0,
    };
    Drop {
        shift,
        half,
        narrow: bits <= 31 && shift <= 31,
    }
}

/// Bits of the largest change over an interval: no kernel falls faster than exp(-r/2) at its peak, by half of an interval's length.
#[inline(always)]
const fn change_bits(widths: &Widths, range: u32) -> u32 {
    (widths.weight as u32 + range).saturating_sub(widths.table as u32 + 1)
}

/// Can vectors draw under these widths and rules? The scalar painter can under all.
pub fn supports(widths: &Widths, rules: &Rules, intervals: &Intervals) -> bool {
    let constants = Blend::new(widths, rules).constants();
    let shifts = [
        constants.opacity_shift,
        constants.share_shift,
        constants.colour_shift,
    ];
    shifts.iter().all(|shift| (1..=48).contains(shift))
        && constants.opacity_min
            < 1 << if Products::new(widths, &constants).opacity.narrow {
                31
            } else {
                63
            }
        && widths.radial <= 27
        && u64::from(constants.stop) < 1 << widths.transmittance
        && intervals.steepest <= 1 << change_bits(widths, rules.table_range.into())
}

/// Everything about the pixel path that is constant for a picture, on vectors. `STOP_BEFORE` and `RANGE` are the rules' fields.
#[derive(Clone, Copy)]
pub struct PixelPath<'a, L: Lanes, const STOP_BEFORE: bool, const RANGE: u32> {
    lanes: L,
    widths: Widths,
    products: Products,
    intervals: &'a Intervals,
    /// Left shift of a footprint's colours.
    raise: u32,
    /// Fraction bits of the position within an interval, if the table is interpolated.
    rest_bits: u32,
    kept_bits: u32,
    iota: L::Words,
    alpha_max: L::Words,
    /// Products of peak and kernel below this are skipped.
    opacity_min: u64,
    /// Transmittances below this finish a pixel.
    stop: L::Words,
    finished: L::Words,
    zero: L::Words,
}

/// What is constant for a footprint.
#[derive(Clone, Copy)]
pub struct Brush<L: Lanes> {
    /// One past the largest radial index inside.
    end: L::Words,
    peak: L::Words,
    colour: [L::Words; 3],
    /// k (k - 1) / 2 s and w (w - 1) / 2 s + w k s for pixel k of a vector of w.
    ahead: [L::Words; 2],
    /// w^2 s.
    second: L::Words,
}

/// Truth values counted over many runs.
#[derive(Clone, Copy)]
pub struct Counts<L: Lanes> {
    visited: u64,
    covered: L::Count,
    live: L::Count,
}

impl<L: Lanes> Counts<L> {
    /// Nothing counted.
    #[inline(always)]
    pub fn new(lanes: L) -> Self {
        Counts {
            visited: 0,
            covered: lanes.no_count(),
            live: lanes.no_count(),
        }
    }

    /// In the painter's terms.
    #[inline(always)]
    pub fn coverage(&self, lanes: L) -> Coverage {
        let covered = lanes.total(self.covered);
        Coverage {
            visited: self.visited,
            covered,
            finished: covered - lanes.total(self.live),
        }
    }
}

impl<'a, L: Lanes, const STOP_BEFORE: bool, const RANGE: u32> PixelPath<'a, L, STOP_BEFORE, RANGE> {
    /// For widths and rules that are [supported](supports).
    #[inline(always)]
    pub fn new(lanes: L, widths: Widths, rules: &Rules, intervals: &'a Intervals) -> Self {
        let constants = Blend::new(&widths, rules).constants();
        // As in `FootprintTable::new`; computed from the widths so that the compiler sees constants.
        let rest_bits = (u32::from(widths.radial) + RANGE).saturating_sub(widths.table.into());
        debug_assert_eq!(rest_bits, intervals.rest_bits);
        PixelPath {
            lanes,
            widths,
            products: Products::new(&widths, &constants),
            intervals,
            raise: raise(&widths, &constants),
            rest_bits,
            kept_bits: u32::from(widths.interpolation).min(rest_bits),
            iota: lanes.iota(),
            alpha_max: lanes.splat(constants.alpha_max),
            opacity_min: constants.opacity_min,
            stop: lanes.splat(constants.stop + 1),
            finished: lanes.splat(FINISHED),
            zero: lanes.splat(0),
        }
    }

    /// A footprint's constants; `None` if its words lie outside their formats or its end outside the table.
    #[inline(always)]
    pub fn brush(&self, footprint: &Footprint, second: i32) -> Option<Brush<L>> {
        let lanes = self.lanes;
        let end = cutoff_in_lane(footprint.cutoff, self.widths.radial);
        let last = i32::try_from(end).ok()?.checked_sub(1)?;
        let in_format = |value: u32, fraction: u8| u64::from(value) < 16 << fraction;
        let fits = in_format(footprint.peak, self.widths.peak)
            && footprint
                .colour
                .iter()
                .all(|c| in_format(*c, self.widths.colour))
            && self.intervals.reach(last);
        if !fits {
            return None;
        }
        let width = L::WIDTH as u32;
        let pairs = width * (width - 1) / 2;
        let second = second as u32;
        let seconds = lanes.splat(second);
        let k = self.iota;
        let triangle = lanes.shr(lanes.mul(k, lanes.sub(k, lanes.splat(1))), 1);
        Some(Brush {
            end: lanes.splat(end as u32),
            peak: lanes.splat(footprint.peak),
            colour: [
                lanes.splat(footprint.colour[0] << self.raise),
                lanes.splat(footprint.colour[1] << self.raise),
                lanes.splat(footprint.colour[2] << self.raise),
            ],
            ahead: [
                lanes.mul(triangle, seconds),
                lanes.add(
                    lanes.splat(pairs.wrapping_mul(second)),
                    lanes.mul(k, lanes.splat(width.wrapping_mul(second))),
                ),
            ],
            second: lanes.splat((width * width).wrapping_mul(second)),
        })
    }

    /// Paints one run into a row of the tile, from its column `x`.
    #[inline(always)]
    pub fn paint(
        &self,
        brush: &Brush<L>,
        run: &Run<impl Lane>,
        x: u16,
        row: &mut TileRow,
        counts: &mut Counts<L>,
    ) {
        let lanes = self.lanes;
        let first = lanes.splat(run.first.to_wide() as u32);
        let mut radial = lanes.add(
            lanes.add(
                lanes.splat(run.radial.to_wide() as u32),
                lanes.mul(self.iota, first),
            ),
            brush.ahead[0],
        );
        let mut difference = lanes.add(lanes.shl(first, L::WIDTH.trailing_zeros()), brush.ahead[1]);
        counts.visited += u64::from(run.length);
        let (mut x, mut rest) = (usize::from(x), usize::from(run.length));
        while rest > L::WIDTH {
            let inside = lanes.greater(brush.end, radial);
            self.blend(brush, radial, inside, x, row, counts);
            radial = lanes.add(radial, difference);
            difference = lanes.add(difference, brush.second);
            x += L::WIDTH;
            rest -= L::WIDTH;
        }
        let inside = lanes.both(lanes.greater(brush.end, radial), lanes.first(rest));
        self.blend(brush, radial, inside, x, row, counts);
    }

    /// One vector of pixels.
    #[inline(always)]
    fn blend(
        &self,
        brush: &Brush<L>,
        radial: L::Words,
        inside: L::Mask,
        x: usize,
        row: &mut TileRow,
        counts: &mut Counts<L>,
    ) {
        let lanes = self.lanes;
        // Never changes x; tells the compiler that a vector fits.
        let x = x % usize::from(TILE[0]);
        let transmittance = lanes.load(&row[0][x..]);
        let live = lanes.except(inside, lanes.negative(transmittance));
        counts.covered = lanes.count(counts.covered, inside);
        if lanes.is_none(live) {
            return;
        }
        counts.live = lanes.count(counts.live, live);
        let weight = self.weight(radial, live);
        // Where no pixel is live the gathered weight and with it the opacity is 0 already.
        let opacity = self.products.opacity;
        let alpha = lanes.product_from(brush.peak, weight, opacity, self.opacity_min);
        let alpha = lanes.min_unsigned(alpha, self.alpha_max);
        let share = lanes.product(transmittance, alpha, self.products.share);
        let rest = lanes.sub(transmittance, share);
        let stop = lanes.greater(self.stop, rest);
        let (share, after) = if STOP_BEFORE {
            let marked = lanes.or(transmittance, self.finished);
            (lanes.clear(share, stop), lanes.select(rest, marked, stop))
        } else {
            let marked = lanes.or(rest, self.finished);
            (share, lanes.select(rest, marked, stop))
        };
        lanes.store(&mut row[0][x..], after);
        for (plane, colour) in row[1..].iter_mut().zip(brush.colour) {
            let layer = lanes.product(share, colour, self.products.colour);
            let sum = lanes.add(lanes.load(&plane[x..]), layer);
            lanes.store(&mut plane[x..], sum);
        }
    }

    /// The kernel at the radial indices where `live` holds, 0 elsewhere.
    #[inline(always)]
    fn weight(&self, radial: L::Words, live: L::Mask) -> L::Words {
        let lanes = self.lanes;
        let radial = lanes.max_signed(radial, self.zero);
        let index = lanes.shr(radial, self.rest_bits);
        let low = lanes.gather(&self.intervals.lows, index, live);
        if self.kept_bits == 0 {
            return low;
        }
        let change = lanes.gather(&self.intervals.changes, index, live);
        let mask = (1 << self.kept_bits) - 1;
        let rest = lanes.and(
            lanes.shr(radial, self.rest_bits - self.kept_bits),
            lanes.splat(mask),
        );
        let drop = Drop {
            shift: self.kept_bits,
            half: 1 << (self.kept_bits - 1),
            narrow: change_bits(&self.widths, RANGE) + self.kept_bits <= 31,
        };
        lanes.add(low, lanes.signed_product(change, rest, drop))
    }
}
