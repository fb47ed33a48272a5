//! The pixel path on fused products: radial index, footprint table, opacity, "over" front to back, eight pixels at a time.
//!
//! Bit for bit what [`FootprintTable::weight`], [`Blend::opacity`] and [`Blend::front_to_back`] give for values within their formats, in any
//! design whose widths have a [`Scale`]. A product, its shift and its rounding are one instruction and a mask, and a colour is two
//! instructions beside its load and store; words of 64 bits take as much room as the products need anyway, so that nothing is taken
//! apart into even and odd words and interleaved again.
//!
//! As in [`words`](crate::fast::words), an opacity of 0 changes no pixel.

use super::intervals::{TableReach, pairs};
use super::multiply;
use super::parts::CellPart;
use super::scale::{MARK, Scale};
use super::tile::Cell;
use crate::fast::lanes::factors::Factors;
use crate::fast::lanes::fused::{DROPPED, Fused, IOTA, Pairs};
use splatline::blend::Blend;
use splatline::footprint::Footprint;
use splatline::format::Widths;
use splatline::kernel::FootprintTable;
use splatline::rules::Rules;

/// What a footprint's pixels need beside its rows, in the kernel's words shifted to the [`Scale`].
#[derive(Clone, Copy, Debug, Default)]
pub struct FusedSplatNumbers {
    /// One past the largest radial index inside.
    end: i64,
    peak: u64,
    colour: [u64; 3],
}

/// Makes numbers; the same for a whole picture.
#[derive(Clone, Debug)]
pub struct FusedScheme {
    widths: Widths,
    /// How pixels are written in a tile.
    pub scale: Scale,
    pub reach: TableReach,
    pairs: Pairs,
    /// The same table, if it is a Gaussian.
    factors: Option<Factors>,
}

impl FusedScheme {
    /// For widths that have a scale and a table within the kernel's range, in lanes of so many bits.
    pub fn new(
        widths: &Widths,
        rules: &Rules,
        table: &FootprintTable,
        lane_bits: u32,
    ) -> Option<Self> {
        let constants = Blend::new(widths, rules).constants();
        let reach = TableReach::new(table, widths, &constants, lane_bits)?;
        Some(FusedScheme {
            widths: *widths,
            scale: Scale::new(widths, &constants)?,
            reach,
            pairs: pairs(table, widths),
            factors: Factors::gaussian(table.entries(), widths, rules.table_range),
        })
    }

    /// A footprint's numbers; `None` if its words lie outside their formats or its end outside the table.
    #[inline(always)]
    pub fn numbers(&self, footprint: &Footprint) -> Option<FusedSplatNumbers> {
        let FusedScheme { widths, scale, .. } = self;
        let end = self.reach.end(footprint.cutoff)?;
        let in_format = |value: u32, fraction: u8| u64::from(value) < 16 << fraction;
        let fits = in_format(footprint.opacity, widths.peak)
            && footprint
                .colour
                .iter()
                .all(|c| in_format(*c, widths.colour));
        fits.then(|| FusedSplatNumbers {
            end,
            peak: u64::from(footprint.opacity) << scale.peak,
            colour: footprint.colour.map(|c| u64::from(c) << scale.colour),
        })
    }
}

/// Everything about the pixel path that is constant for a picture, on vectors. `DEEP` lanes have 64 bits.
#[derive(Clone, Copy)]
pub struct FusedPixels<'a, L: Fused, const STOP_BEFORE: bool, const DEEP: bool> {
    pub lanes: L,
    table: &'a Pairs,
    /// The same table, if it is a Gaussian.
    factors: Option<&'a Factors>,
    iota: L::Word,
    /// k (k - 1) / 2 for pixel k.
    corners: L::Word,
    /// Right turn from a radial index to its interval.
    interval: L::Word,
    /// Right turn and mask that leave the position within it.
    position: L::Word,
    position_mask: L::Word,
    /// Right turn from a pair to its value, the mask that leaves it, and the rounding of the interpolated one.
    value: L::Word,
    factored_value: L::Word,
    value_mask: L::Word,
    value_half: L::Word,
    alpha_half: L::Word,
    alpha_mask: L::Word,
    alpha_max: L::Word,
    /// Opacities, with half of a unit added, below this are skipped.
    opacity_min: L::Word,
    share_half: L::Word,
    share_mask: L::Word,
    /// Right turn that makes a share a transmittance.
    to_light: L::Word,
    /// Transmittances below this finish a pixel.
    stop: L::Word,
    mark: L::Word,
    sum_half: L::Word,
    sum_mask: L::Word,
}

/// A numbers on vectors.
#[derive(Clone, Copy)]
pub struct FusedSplatWords<L: Fused> {
    end: L::Word,
    peak: L::Word,
    colour: [L::Word; 3],
    /// k (k - 1) / 2 s for pixel k.
    ahead: L::Word,
}

impl<'a, L: Fused, const STOP_BEFORE: bool, const DEEP: bool>
    FusedPixels<'a, L, STOP_BEFORE, DEEP>
{
    /// For a scheme of lanes as deep as these.
    #[inline(always)]
    pub fn new(lanes: L, scheme: &'a FusedScheme, rules: &Rules) -> Self {
        let FusedScheme { widths, scale, .. } = scheme;
        let constants = Blend::new(widths, rules).constants();
        let rest = scheme.reach.rest_bits;
        let kept = u32::from(widths.interpolation).min(rest);
        // The position's left shift: it stands where its product with a change is a value at its scale.
        let raised = scale.weight - kept;
        let splat = |value: u64| lanes.wide_splat(value as i64);
        let turn = |right: u32| splat(u64::from(right % 64));
        let factor = u64::MAX >> (64 - DROPPED);
        let above = |below: u32| splat(factor & (u64::MAX << below));
        let half = |below: u32| splat(scale.half(below));
        let value_half = if kept > 0 {
            1 << (kept - 1) << raised
        } else {
            0
        };
        let iota = lanes.wide_load(&IOTA);
        let corners = lanes.wide_mul(iota, lanes.wide_sub(iota, splat(1)));
        FusedPixels {
            lanes,
            table: &scheme.pairs,
            factors: scheme.factors.as_ref(),
            iota,
            corners: lanes.wide_shr(corners, splat(1)),
            interval: turn(rest),
            position: turn((rest - kept).wrapping_sub(raised)),
            position_mask: splat(((1 << kept) - 1) << raised),
            value: turn(32 - scale.weight),
            factored_value: turn(64 - scale.weight),
            value_mask: above(scale.weight),
            value_half: splat(value_half),
            alpha_half: half(scale.alpha),
            alpha_mask: above(scale.alpha),
            alpha_max: splat(u64::from(constants.alpha_max) << scale.alpha),
            opacity_min: splat(scale.opacity_min + scale.half(scale.alpha)),
            share_half: half(scale.share),
            share_mask: above(scale.share),
            to_light: turn(64 - scale.to_light),
            stop: splat((u64::from(constants.minimum_transmittance) + 1) << scale.transmittance),
            mark: splat(MARK),
            sum_half: half(scale.sum),
            sum_mask: splat(u64::MAX << scale.sum),
        }
    }

    /// The radial indices of a cell's pixels, 0 where they are negative.
    #[inline(always)]
    fn radial(&self, colours: &FusedSplatWords<L>, part: &CellPart) -> L::Word {
        let lanes = self.lanes;
        let [radial, first] = [part.radial, part.first].map(|word| lanes.wide_splat(word as i64));
        let along = multiply::<L, DEEP>(lanes, self.iota, first);
        let radial = lanes.wide_add(lanes.wide_add(radial, colours.ahead), along);
        if DEEP {
            lanes.max_whole(radial, lanes.wide_splat(0))
        } else {
            lanes.half_from_zero(radial)
        }
    }

    /// The kernel at the radial indices where `live` is -1, 0 where it is 0.
    #[inline(always)]
    fn value(&self, radial: L::Word, live: L::Word) -> L::Word {
        let lanes = self.lanes;
        let interval = lanes.turn(radial, self.interval);
        let (value, change) = match self.factors {
            Some(factors) => {
                let [low, next] = lanes.factored(factors, interval);
                (
                    lanes.turn(low, self.factored_value),
                    lanes.wide_sub(next, low),
                )
            }
            None => {
                let pair = lanes.gather_pairs(self.table, interval);
                (lanes.turn(pair, self.value), pair)
            }
        };
        let position = lanes.wide_and(lanes.turn(radial, self.position), self.position_mask);
        let value = lanes.merge(value, self.value_mask, self.value_half);
        let value = lanes.wide_add(value, lanes.wide_mul(change, position));
        lanes.all_three(value, self.value_mask, live)
    }

    /// A footprint's numbers on vectors, for rows with this second difference.
    #[inline(always)]
    pub fn splat_words(&self, numbers: &FusedSplatNumbers, second: i64) -> FusedSplatWords<L> {
        let splat = |value: i64| self.lanes.wide_splat(value);
        FusedSplatWords {
            end: splat(numbers.end),
            peak: splat(numbers.peak as i64),
            colour: numbers.colour.map(|c| splat(c as i64)),
            ahead: multiply::<L, DEEP>(self.lanes, self.corners, splat(second)),
        }
    }

    /// Paints what a footprint covers of a cell; covered pixels, and those of them that had not finished, are counted
    /// lane by lane.
    ///
    /// Conditions stay in the words, as their most significant bits: a detour through the mask registers takes ten cycles of the way from
    /// a radial index to a pixel.
    #[inline(always)]
    pub fn paint(
        &self,
        colours: &FusedSplatWords<L>,
        part: &CellPart,
        cell: &mut Cell,
        counts: &mut [L::Word; 2],
    ) {
        let lanes = self.lanes;
        let radial = self.radial(colours, part);
        let of_run = lanes.marks(part.place);
        let inside = lanes.wide_and(lanes.wide_sub(radial, colours.end), of_run);
        let light = lanes.read(&cell.light);
        let live = lanes.without(inside, inside, light);
        for (count, marked) in counts.iter_mut().zip([inside, live]) {
            *count = lanes.wide_add(*count, lanes.wide_shr(marked, lanes.wide_splat(63)));
        }
        if lanes.marked(live) == 0 {
            return;
        }
        let value = self.value(radial, lanes.wide_sar_by(live, 63));
        let alpha = lanes.fused(self.alpha_half, value, colours.peak);
        // Where no pixel is live the value and with it the opacity is 0 already.
        let too_small = lanes.wide_sar_by(lanes.wide_sub(alpha, self.opacity_min), 63);
        let alpha = lanes.min_whole(alpha, self.alpha_max);
        let alpha = lanes.without(alpha, self.alpha_mask, too_small);
        let share = lanes.fused(self.share_half, light, alpha);
        let share = lanes.wide_and(share, self.share_mask);
        let rest = lanes.wide_sub(light, lanes.turn(share, self.to_light));
        let stops = lanes.wide_sar_by(lanes.wide_sub(rest, self.stop), 63);
        let before = if STOP_BEFORE { light } else { rest };
        let stopped = lanes.merge(before, before, self.mark);
        lanes.write(&mut cell.light, lanes.blend(stops, stopped, rest));
        let share = if STOP_BEFORE {
            lanes.without(share, share, stops)
        } else {
            share
        };
        for (plane, colour) in cell.colour.iter_mut().zip(colours.colour) {
            let sum = lanes.fused(lanes.read(plane), share, colour);
            lanes.write(plane, lanes.merge(sum, self.sum_mask, self.sum_half));
        }
    }
}
