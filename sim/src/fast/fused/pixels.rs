//! The pixel path on fused products: radial index, footprint table, opacity, "over" front to back, eight pixels at a time.
//!
//! Bit for bit what [`FootprintTable::weight`], [`Blend::opacity`] and [`Blend::front_to_back`] give for values within their formats, in any
//! design whose widths have a [`Scale`]. A product, its shift and its rounding are one instruction and a mask, and a colour is two
//! instructions beside its load and store; words of 64 bits take as much room as the products need anyway, so that nothing is taken
//! apart into even and odd words and interleaved again.
//!
//! As in [`pixels`](crate::fast::pixels), r is differenced eight pixels at a time, and an opacity of 0 changes no pixel.

use super::scale::Scale;
use super::tile::{MARK, Row};
use crate::fast::lanes::fused::Fused;
use crate::fast::tile::TILE;
use splatline::blend::Blend;
use splatline::draw::{Coverage, cutoff_in_lane};
use splatline::footprint::Footprint;
use splatline::format::Widths;
use splatline::kernel::FootprintTable;
use splatline::rules::Rules;

/// The table as vectors read it: an interval's value in the upper half of a word, its change in the lower one.
#[derive(Clone, Debug)]
pub struct Intervals {
    pairs: Vec<u64>,
    rest_bits: u32,
}

impl Intervals {
    /// Every interval of `table`; `None` if an entry exceeds 1.
    pub fn new(table: &FootprintTable, widths: &Widths) -> Option<Self> {
        let entries = table.entries();
        let interpolates = widths.interpolation > 0;
        let pair = |pair: &[u32]| {
            let change = if interpolates {
                pair[1].wrapping_sub(pair[0])
            } else {
                0
            };
            (u64::from(pair[0]) << 32) | u64::from(change)
        };
        let fits = entries.iter().all(|entry| *entry <= 1 << widths.weight);
        fits.then(|| Intervals {
            pairs: entries.windows(2).map(pair).collect(),
            rest_bits: table.rest_bits(),
        })
    }

    /// Do all radial indices up to `last` lie in the table?
    fn reach(&self, last: i64) -> bool {
        last < 0 || ((last as u64) >> self.rest_bits) < self.pairs.len() as u64
    }
}

/// What a footprint's pixels need beside its rows, in the kernel's words shifted to the [`Scale`].
#[derive(Clone, Copy, Debug)]
pub struct Brush {
    /// One past the largest radial index inside.
    end: i64,
    peak: u64,
    colour: [u64; 3],
}

/// Makes brushes; the same for a whole picture.
#[derive(Clone, Debug)]
pub struct Palette {
    widths: Widths,
    pub scale: Scale,
    pub intervals: Intervals,
    /// Do lanes have 64 bits?
    deep: bool,
}

impl Palette {
    /// For widths that have a scale and a table within the kernel's range.
    pub fn new(
        widths: &Widths,
        rules: &Rules,
        table: &FootprintTable,
        lane_bits: u32,
    ) -> Option<Self> {
        let constants = Blend::new(widths, rules).constants();
        let deep = lane_bits > 32;
        let known = u64::from(constants.stop) < 1 << widths.transmittance
            && constants.alpha_max <= 1 << widths.alpha
            && (deep || widths.radial <= 27);
        known.then_some(())?;
        Some(Palette {
            widths: *widths,
            scale: Scale::new(widths, &constants)?,
            intervals: Intervals::new(table, widths)?,
            deep,
        })
    }

    /// A footprint's brush; `None` if its words lie outside their formats or its end outside the table.
    #[inline(always)]
    pub fn brush(&self, footprint: &Footprint) -> Option<Brush> {
        let Palette { widths, scale, .. } = self;
        let end = cutoff_in_lane(footprint.cutoff, widths.radial);
        let end = i64::try_from(end).ok()?;
        let in_format = |value: u32, fraction: u8| u64::from(value) < 16 << fraction;
        let fits = in_format(footprint.peak, widths.peak)
            && footprint
                .colour
                .iter()
                .all(|c| in_format(*c, widths.colour))
            && (self.deep || end <= i64::from(i32::MAX))
            && self.intervals.reach(end.checked_sub(1)?);
        fits.then(|| Brush {
            end,
            peak: u64::from(footprint.peak) << scale.peak,
            colour: footprint.colour.map(|c| u64::from(c) << scale.colour),
        })
    }
}

/// Everything about the pixel path that is constant for a picture, on vectors. `DEEP` lanes have 64 bits.
#[derive(Clone, Copy)]
pub struct PixelPath<'a, L: Fused, const STOP_BEFORE: bool, const DEEP: bool> {
    lanes: L,
    table: &'a [u64],
    iota: L::Word,
    triangle: L::Word,
    zero: L::Word,
    /// Right shift from a radial index to its interval.
    interval: L::Word,
    /// Right turn and mask that leave the position within it.
    position: L::Word,
    position_mask: L::Word,
    /// Right shift from a pair to its value, the mask that leaves it, and the rounding of the interpolated one.
    value: L::Word,
    value_mask: L::Word,
    value_half: L::Word,
    alpha_half: L::Word,
    alpha_mask: L::Word,
    alpha_max: L::Word,
    alpha_min: L::Word,
    share_half: L::Word,
    share_mask: L::Word,
    to_light: L::Word,
    /// Transmittances below this finish a pixel.
    stop: L::Word,
    mark: L::Word,
    sum_half: L::Word,
    sum_mask: L::Word,
}

/// A brush on vectors.
#[derive(Clone, Copy)]
pub struct Colours<L: Fused> {
    end: L::Word,
    peak: L::Word,
    colour: [L::Word; 3],
    /// k (k - 1) / 2 s and 28 s + 8 k s for pixel k of a vector.
    ahead: [L::Word; 2],
    /// 64 s.
    second: L::Word,
}

impl<'a, L: Fused, const STOP_BEFORE: bool, const DEEP: bool> PixelPath<'a, L, STOP_BEFORE, DEEP> {
    /// For a palette of lanes as deep as these.
    #[inline(always)]
    pub fn new(lanes: L, palette: &'a Palette, rules: &Rules) -> Self {
        let Palette {
            widths,
            scale,
            intervals,
            ..
        } = palette;
        let constants = Blend::new(widths, rules).constants();
        let rest = intervals.rest_bits;
        let kept = u32::from(widths.interpolation).min(rest);
        // The position's left shift: it stands where its product with a change is a value at its scale.
        let raised = scale.weight - kept;
        let splat = |value: u64| lanes.wide_splat(value as i64);
        let above = |below: u32| splat(u64::MAX << below);
        let half = |below: u32| splat(scale.half(below));
        let value_half = if kept > 0 {
            1 << (kept - 1) << raised
        } else {
            0
        };
        PixelPath {
            lanes,
            table: &intervals.pairs,
            iota: lanes.wide_iota(),
            triangle: lanes.wide_shr(
                lanes.mul_words(
                    lanes.wide_iota(),
                    lanes.max_whole(splat(0), lanes.wide_sub(lanes.wide_iota(), splat(1))),
                ),
                splat(1),
            ),
            zero: splat(0),
            interval: splat(rest.into()),
            position: splat(u64::from((rest - kept).wrapping_sub(raised) % 64)),
            position_mask: splat(((1 << kept) - 1) << raised),
            value: splat(u64::from(32 - scale.weight)),
            value_mask: above(scale.weight),
            value_half: splat(value_half),
            alpha_half: half(scale.alpha),
            alpha_mask: above(scale.alpha),
            alpha_max: splat(u64::from(constants.alpha_max) << scale.alpha),
            alpha_min: splat(u64::from(constants.alpha_min) << scale.alpha),
            share_half: half(scale.share),
            share_mask: above(scale.share),
            to_light: splat(scale.to_light.into()),
            stop: splat((u64::from(constants.stop) + 1) << scale.transmittance),
            mark: splat(MARK),
            sum_half: half(scale.sum),
            sum_mask: above(scale.sum),
        }
    }

    /// A brush on vectors, for rows with this second difference.
    #[inline(always)]
    pub fn colours(&self, brush: &Brush, second: i64) -> Colours<L> {
        let lanes = self.lanes;
        let splat = |value: i64| lanes.wide_splat(value);
        let second = self.lane(second);
        let part = |factor: i64| self.lane(second.wrapping_mul(factor));
        Colours {
            end: splat(brush.end),
            peak: splat(brush.peak as i64),
            colour: brush.colour.map(|c| splat(c as i64)),
            ahead: [
                self.multiply(self.triangle, splat(second)),
                self.sum(splat(part(28)), self.multiply(self.iota, splat(part(8)))),
            ],
            second: splat(part(64)),
        }
    }

    /// A lane's word without its sign.
    #[inline(always)]
    fn lane(&self, word: i64) -> i64 {
        if DEEP { word } else { (word as u32).into() }
    }

    #[inline(always)]
    fn multiply(&self, a: L::Word, b: L::Word) -> L::Word {
        if DEEP {
            self.lanes.mul_whole(a, b)
        } else {
            self.lanes.mul_words(a, b)
        }
    }

    #[inline(always)]
    fn sum(&self, a: L::Word, b: L::Word) -> L::Word {
        if DEEP {
            self.lanes.wide_add(a, b)
        } else {
            self.lanes.add_words(a, b)
        }
    }

    /// Paints one run into a row of the tile, from its column `x`: radial index and first difference at its first pixel.
    #[inline(always)]
    pub fn paint(
        &self,
        colours: &Colours<L>,
        (radial, first): (i64, i64),
        x: usize,
        length: usize,
        row: &mut Row,
        coverage: &mut Coverage,
    ) {
        let lanes = self.lanes;
        let first = lanes.wide_splat(self.lane(first));
        let radial = lanes.wide_splat(self.lane(radial));
        let mut radial = self.sum(
            self.sum(radial, self.multiply(self.iota, first)),
            colours.ahead[0],
        );
        coverage.visited += length as u64;
        if length > L::WIDE {
            let eight = lanes.wide_splat(8);
            let mut difference = self.sum(self.multiply(first, eight), colours.ahead[1]);
            let (mut x, mut rest) = (x, length);
            while rest > L::WIDE {
                self.blend(colours, radial, u8::MAX, x, row, coverage);
                radial = self.sum(radial, difference);
                difference = self.sum(difference, colours.second);
                x += L::WIDE;
                rest -= L::WIDE;
            }
            return self.blend(colours, radial, first_bits(rest), x, row, coverage);
        }
        self.blend(colours, radial, first_bits(length), x, row, coverage);
    }

    /// One vector of pixels, of which those with their bit belong to the run.
    #[inline(always)]
    fn blend(
        &self,
        colours: &Colours<L>,
        radial: L::Word,
        of_run: u8,
        x: usize,
        row: &mut Row,
        coverage: &mut Coverage,
    ) {
        let lanes = self.lanes;
        // Never changes x; tells the compiler that a vector fits.
        let x = x % usize::from(TILE[0]);
        let radial = if DEEP {
            lanes.max_whole(radial, self.zero)
        } else {
            lanes.max_words(radial, self.zero)
        };
        let inside = lanes.bits(lanes.wide_greater(colours.end, radial)) & of_run;
        let light = lanes.read(&row[0][x..]);
        let live = inside & !lanes.bits(lanes.negative_word(light));
        coverage.covered += u64::from(inside.count_ones());
        if live == 0 {
            coverage.finished += u64::from(inside.count_ones());
            return;
        }
        coverage.finished += u64::from((inside & !live).count_ones());
        let value = self.value(radial, lanes.truth(live));
        let alpha = lanes.fused(self.alpha_half, value, colours.peak);
        let alpha = lanes.min_whole(alpha, self.alpha_max);
        // Where no pixel is live the value and with it the opacity is 0 already.
        let counts = lanes.at_least(alpha, self.alpha_min);
        let alpha = lanes.keep(alpha, self.alpha_mask, counts);
        let share = lanes.fused(self.share_half, light, alpha);
        let share = lanes.wide_and(share, self.share_mask);
        let rest = lanes.wide_sub(light, lanes.wide_shl(share, self.to_light));
        let goes_on = lanes.at_least(rest, self.stop);
        let before = if STOP_BEFORE { light } else { rest };
        let after = lanes.choose(rest, before, self.mark, goes_on);
        lanes.write(&mut row[0][x..], after);
        for (plane, colour) in row[1..].iter_mut().zip(colours.colour) {
            let sum = lanes.read(&plane[x..]);
            let sum = if STOP_BEFORE {
                lanes.fused_where(sum, share, colour, goes_on)
            } else {
                lanes.fused(sum, share, colour)
            };
            lanes.write(
                &mut plane[x..],
                lanes.merge(sum, self.sum_mask, self.sum_half),
            );
        }
    }

    /// The kernel at the radial indices where it is true, 0 elsewhere.
    #[inline(always)]
    fn value(&self, radial: L::Word, live: L::Truth) -> L::Word {
        let lanes = self.lanes;
        let interval = lanes.wide_shr(radial, self.interval);
        let pair = lanes.gather_pairs(self.table, interval, live);
        let position = lanes.wide_and(lanes.turn(radial, self.position), self.position_mask);
        let value = lanes.merge(
            lanes.wide_shr(pair, self.value),
            self.value_mask,
            self.value_half,
        );
        let value = lanes.wide_add(value, lanes.wide_mul(pair, position));
        lanes.wide_and(value, self.value_mask)
    }
}

/// The lowest `count` bits of eight, `count` up to 8.
#[inline(always)]
fn first_bits(count: usize) -> u8 {
    ((1u32 << count) - 1) as u8
}
