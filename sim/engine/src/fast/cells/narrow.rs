//! The pixel path of narrow designs: sixteen pixels at a time, eight of each of two rows, products put together from short ones.
//!
//! Bit for bit what [`FootprintTable::weight`], [`Blend::opacity`] and [`Blend::front_to_back`] give for values within their formats, in
//! designs that have [`Products`] and a Gaussian table in factors of single precision; `lean18` and `classic8` do. As in
//! [`fused`](super::fused), conditions stay in the words as their most significant bits, and an opacity of 0 changes no pixel.

use super::intervals::TableReach;
use super::parts::CellPart;
use super::products::{Products, Split};
use super::tile::{COLUMNS, CellWord, PixelGroup};
use super::{CellPainting, CellTiles, TileOf};
use crate::fast::lanes::factors::NarrowFactors;
use crate::fast::lanes::narrow::Narrow;
use splatline::blend::Blend;
use splatline::draw::Coverage;
use splatline::footprint::Footprint;
use splatline::format::Widths;
use splatline::kernel::FootprintTable;
use splatline::rules::Rules;

/// Rows of a cell.
const ROWS: usize = 2;

type CellOfTwo = PixelGroup<u32, { ROWS * COLUMNS }>;

/// What a footprint's pixels need beside its rows.
#[derive(Clone, Copy, Debug, Default)]
pub struct NarrowSplatNumbers {
    /// One past the largest radial index inside.
    end: u32,
    peak: u32,
    colour: [u32; 3],
}

/// Makes numbers; the same for a whole picture.
#[derive(Clone, Debug)]
pub struct NarrowScheme {
    widths: Widths,
    products: Products,
    factors: NarrowFactors,
    reach: TableReach,
    /// Bits of the position within an interval that the interpolator sees.
    kept: u32,
}

impl super::PixelScheme for NarrowScheme {
    type PixelGroup = CellOfTwo;
    type PixelFormat = Products;
    type SplatNumbers = NarrowSplatNumbers;

    fn new(widths: &Widths, rules: &Rules, table: &FootprintTable, lane_bits: u32) -> Option<Self> {
        let constants = Blend::new(widths, rules).constants();
        let reach = TableReach::new(table, widths, &constants, lane_bits)?;
        let kept = u32::from(widths.interpolation).min(reach.rest_bits);
        let entries = table.entries();
        let steepest = entries.windows(2).map(|pair| pair[0].abs_diff(pair[1]));
        if reach.deep || u64::from(steepest.max()?) << kept >= 1 << 30 {
            return None;
        }
        Some(NarrowScheme {
            widths: *widths,
            products: Products::new(widths, &constants)?,
            factors: NarrowFactors::gaussian(entries, widths, rules.table_range)?,
            reach,
            kept,
        })
    }

    fn format(&self) -> Products {
        self.products
    }

    fn tile(tiles: &mut CellTiles) -> &mut Option<TileOf<Self>> {
        &mut tiles.narrow
    }

    #[inline(always)]
    fn numbers(&self, footprint: &Footprint) -> Option<NarrowSplatNumbers> {
        let NarrowScheme {
            products, reach, ..
        } = self;
        let end = reach.end(footprint.cutoff)?;
        let fits = footprint.opacity <= products.peak
            && footprint.colour.iter().all(|c| *c <= products.colour);
        fits.then_some(NarrowSplatNumbers {
            end: end as u32,
            peak: footprint.opacity,
            colour: footprint.colour,
        })
    }

    #[inline(always)]
    fn run<L: Narrow>(lanes: L, painting: CellPainting<Self>) -> Coverage {
        if painting.rules.omit_finishing {
            run::<L, true>(lanes, painting)
        } else {
            run::<L, false>(lanes, painting)
        }
    }
}

#[inline(always)]
fn run<L: Narrow, const STOP_BEFORE: bool>(
    lanes: L,
    painting: CellPainting<NarrowScheme>,
) -> Coverage {
    let path = NarrowPixels::<L, STOP_BEFORE>::new(lanes, painting.scheme, painting.rules);
    painting.paint::<L, _, false, ROWS>(lanes, &path)
}

/// A [`Split`] on vectors.
#[derive(Clone, Copy)]
struct NarrowParts<L: Narrow> {
    bits: L::Short,
    mask: L::Short,
    half: L::Short,
    rest: L::Short,
}

impl<L: Narrow> NarrowParts<L> {
    #[inline(always)]
    fn new(lanes: L, split: &Split) -> Self {
        NarrowParts {
            bits: lanes.short_splat(split.bits),
            mask: lanes.short_splat((1 << split.bits) - 1),
            half: lanes.short_splat(split.half),
            rest: lanes.short_splat(split.rest),
        }
    }

    /// The upper and the lower part.
    #[inline(always)]
    fn split(&self, lanes: L, factor: L::Short) -> [L::Short; 2] {
        [
            lanes.short_shr(factor, self.bits),
            lanes.short_and(factor, self.mask),
        ]
    }

    /// The product of a factor in parts, without the bits of the lower part.
    #[inline(always)]
    fn sum(&self, lanes: L, [high, low]: [L::Short; 2], other: L::Short) -> L::Short {
        let low = lanes.short_add(lanes.short_mul(low, other), self.half);
        let high = lanes.short_mul(high, other);
        lanes.short_add(high, lanes.short_shr(low, self.bits))
    }

    /// The product, rounded.
    #[inline(always)]
    fn product(&self, lanes: L, factor: [L::Short; 2], other: L::Short) -> L::Short {
        lanes.short_shr(self.sum(lanes, factor, other), self.rest)
    }
}

/// Everything about the pixel path that is constant for a picture, on vectors.
#[derive(Clone, Copy)]
pub struct NarrowPixels<'a, L: Narrow, const STOP_BEFORE: bool> {
    lanes: L,
    factors: &'a NarrowFactors,
    opacity: NarrowParts<L>,
    share: NarrowParts<L>,
    zero: L::Short,
    /// k for pixel k of both rows.
    iota: L::Short,
    /// k (k - 1) / 2.
    corners: L::Short,
    /// Right shift from a radial index to its interval.
    interval: L::Short,
    /// Right shift and mask that leave the position within it.
    position: L::Short,
    position_mask: L::Short,
    /// The interpolator's rounding and right shift.
    step_half: L::Short,
    step: L::Short,
    /// Where a number's integer lies.
    value_mask: L::Short,
    alpha_max: L::Short,
    /// Sums of the opacity's parts below this are skipped, and the largest signed number.
    opacity_min: L::Short,
    largest: L::Short,
    /// Transmittances below this finish a pixel.
    stop: L::Short,
    mark: L::Short,
    raise: L::Short,
    sum_half: L::Short,
    sum_mask: L::Short,
}

/// A numbers on vectors.
#[derive(Clone, Copy)]
pub struct NarrowSplatWords<L: Narrow> {
    end: L::Short,
    peak: [L::Short; 2],
    /// In the lower halves of the words, and in the upper ones.
    colour: [[L::Short; 2]; 3],
    /// k (k - 1) / 2 s for pixel k.
    ahead: L::Short,
}

/// Pixels counted, lane by lane: at most as many as a batch has cells, and so far below 2^32.
#[derive(Clone, Copy)]
pub struct NarrowCounts<L: Narrow> {
    covered: L::Short,
    live: L::Short,
}

impl<'a, L: Narrow, const STOP_BEFORE: bool> NarrowPixels<'a, L, STOP_BEFORE> {
    #[inline(always)]
    fn new(lanes: L, scheme: &'a NarrowScheme, rules: &Rules) -> Self {
        let NarrowScheme {
            widths,
            products,
            factors,
            reach,
            kept,
        } = scheme;
        let constants = Blend::new(widths, rules).constants();
        let splat = |value: u32| lanes.short_splat(value);
        let iota = lanes.short_shr(lanes.short_iota(), splat(1));
        let corners = lanes.short_mul(iota, lanes.short_sub(iota, splat(1)));
        NarrowPixels {
            lanes,
            factors,
            opacity: NarrowParts::new(lanes, &products.opacity),
            share: NarrowParts::new(lanes, &products.share),
            zero: splat(0),
            iota,
            corners: lanes.short_shr(corners, splat(1)),
            interval: splat(reach.rest_bits),
            position: splat(reach.rest_bits - kept),
            position_mask: splat((1 << kept) - 1),
            step_half: splat((1 << kept) >> 1),
            step: splat(*kept),
            value_mask: splat((1 << 23) - 1),
            alpha_max: splat(constants.alpha_max),
            opacity_min: splat(products.opacity_min as u32),
            largest: splat(i32::MAX as u32),
            stop: splat(constants.minimum_transmittance + 1),
            mark: splat(u32::MARK),
            raise: splat(products.raise),
            sum_half: splat(products.sum_half),
            sum_mask: splat(u32::MAX << products.sum),
        }
    }

    /// The radial indices of a cell's pixels, 0 where they are negative.
    #[inline(always)]
    fn radial(&self, colours: &NarrowSplatWords<L>, part: &CellPart) -> L::Short {
        let lanes = self.lanes;
        let [radial, first] = [part.radial, part.first].map(|word| lanes.short_pairs(word));
        let along = lanes.short_mul(self.iota, first);
        let radial = lanes.short_add(lanes.short_add(radial, colours.ahead), along);
        lanes.short_max(radial, self.zero)
    }

    /// The kernel at the radial indices where `live` is -1, 0 where it is 0.
    #[inline(always)]
    fn value(&self, radial: L::Short, live: L::Short) -> L::Short {
        let lanes = self.lanes;
        let interval = lanes.short_shr(radial, self.interval);
        let [low, next] = lanes.short_factored(self.factors, interval);
        let position = lanes.short_shr(radial, self.position);
        let position = lanes.short_and(position, self.position_mask);
        let step = lanes.short_mul(lanes.short_sub(next, low), position);
        let step = lanes.short_sar(lanes.short_add(step, self.step_half), self.step);
        lanes.short_all(lanes.short_add(low, step), self.value_mask, live)
    }
}

impl<L: Narrow, const STOP_BEFORE: bool> super::PixelMethod<L>
    for NarrowPixels<'_, L, STOP_BEFORE>
{
    type PixelGroup = CellOfTwo;
    type SplatNumbers = NarrowSplatNumbers;
    type SplatWords = NarrowSplatWords<L>;
    type Counts = NarrowCounts<L>;

    #[inline(always)]
    fn splat_words(&self, numbers: &NarrowSplatNumbers, second: i64) -> NarrowSplatWords<L> {
        let lanes = self.lanes;
        let splat = |value: u32| lanes.short_splat(value);
        NarrowSplatWords {
            end: splat(numbers.end),
            peak: self.opacity.split(lanes, splat(numbers.peak)),
            colour: numbers.colour.map(|c| [splat(c), splat(c << 16)]),
            ahead: lanes.short_mul(self.corners, splat(second as u32)),
        }
    }

    #[inline(always)]
    fn paint(
        &self,
        colours: &NarrowSplatWords<L>,
        part: &CellPart,
        cell: &mut Self::PixelGroup,
        counts: &mut NarrowCounts<L>,
    ) {
        let lanes = self.lanes;
        let radial = self.radial(colours, part);
        let of_run = lanes.short_marks(part.place);
        let inside = lanes.short_and(lanes.short_sub(radial, colours.end), of_run);
        let light = lanes.short_read(&cell.light);
        let live = lanes.short_without(inside, inside, light);
        let [inside, live] = [inside, live].map(|word| lanes.short_spread(word));
        counts.covered = lanes.short_sub(counts.covered, inside);
        counts.live = lanes.short_sub(counts.live, live);
        if lanes.short_marked(live) == 0 {
            return;
        }
        let value = self.value(radial, live);
        let opacity = self.opacity.sum(lanes, colours.peak, value);
        // Where no pixel is live the value and with it the opacity is 0 already.
        let signed = lanes.short_min(opacity, self.largest);
        let too_small = lanes.short_spread(lanes.short_sub(signed, self.opacity_min));
        let alpha = lanes.short_shr(opacity, self.opacity.rest);
        let alpha = lanes.short_min(alpha, self.alpha_max);
        let alpha = lanes.short_without(alpha, alpha, too_small);
        let parts = self.share.split(lanes, light);
        let share = self.share.product(lanes, parts, alpha);
        let rest = lanes.short_sub(light, share);
        let stops = lanes.short_spread(lanes.short_sub(rest, self.stop));
        let before = if STOP_BEFORE { light } else { rest };
        let stopped = lanes.short_merge(before, before, self.mark);
        lanes.short_write(&mut cell.light, lanes.short_blend(stops, stopped, rest));
        let share = if STOP_BEFORE {
            lanes.short_without(share, share, stops)
        } else {
            share
        };
        let share = lanes.short_shl(share, self.raise);
        for (plane, [below, above]) in cell.colour.iter_mut().zip(colours.colour) {
            let low = lanes.upper_halves(share, below);
            let high = lanes.both_halves(share, above);
            let sum = lanes.short_add(lanes.short_read(plane), lanes.short_add(low, high));
            lanes.short_write(plane, lanes.short_merge(sum, self.sum_mask, self.sum_half));
        }
    }

    #[inline(always)]
    fn no_counts(&self) -> NarrowCounts<L> {
        NarrowCounts {
            covered: self.zero,
            live: self.zero,
        }
    }

    #[inline(always)]
    fn total(&self, counts: NarrowCounts<L>) -> [u64; 2] {
        [counts.covered, counts.live].map(|words| self.lanes.short_sum(words).into())
    }
}
