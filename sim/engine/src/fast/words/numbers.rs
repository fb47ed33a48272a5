//! What is constant for a picture drawn on words, and for a footprint: designs and rules as numbers, so that one
//! compiled copy draws all, and the operators that have copies of their own.

use crate::fast::painter::TableMemory;
use crate::fast::rows::RuntimeRows;
use crate::fast::setup::number::BitDrop;
use splatline::blend::Blend;
use splatline::draw::cutoff_in_lane;
use splatline::footprint::Footprint;
use splatline::format::Rounding;
use splatline::rules::Compositing;

/// How a layer and a pixel become a pixel. Front to back; the layer that finishes a pixel is drawn.
pub const DRAW_FINISHING: u8 = 0;
/// Front to back; the layer that would finish a pixel is left out.
pub const OMIT_FINISHING: u8 = 1;
/// Back to front; no pixel finishes.
pub const BACK_TO_FRONT: u8 = 2;
/// Summation; no pixel finishes.
pub const X_RAY: u8 = 3;
/// Added to one of them: results may be rounded with ties to even.
pub const EVEN: u8 = 4;
/// Added to one of them: contributions to colours lose more bits than half a word has, or opacities are compared with a
/// threshold that does not follow from rounding.
pub(super) const UNUSUAL: u8 = 8;
/// One of the two without an end, looked up.
pub const LAYERS: u8 = 16;
/// Any of them, looked up: those that usual designs need have compiled copies of their own, which take an eighth fewer
/// instructions.
pub const ANY: u8 = 32;

/// A product's right shift; `None` if it is not one.
fn shift(by: i32, rounding: Rounding) -> Option<BitDrop> {
    let by = u32::try_from(by).ok().filter(|by| *by < 64)?;
    Some(BitDrop::new(by, rounding))
}

/// Everything about the pixel path that is constant for a picture, as numbers.
#[derive(Clone, Debug)]
pub struct PathNumbers {
    pub rows: RuntimeRows,
    /// The table's entries, and bits of the radial index below an interval's number.
    pub(super) entries: Box<[u32]>,
    pub(super) rest_bits: u32,
    /// Bits above the formats of peaks and colours.
    pub(super) beyond: [u32; 2],
    /// Left shift of lanes that have 32 bits.
    pub(super) raise: u32,
    /// Fraction bits of the position within an interval.
    pub(super) kept: u32,
    pub(super) opacity: BitDrop,
    pub(super) share: BitDrop,
    pub(super) colour: BitDrop,
    pub(super) alpha_max: u32,
    /// Products of peak and kernel below this are skipped.
    pub(super) opacity_min: i64,
    /// Transmittances below this finish a pixel.
    pub(super) stop: i64,
    /// One of the four ways.
    pub operator: u8,
    /// Opacity times colour, where a layer does not lie behind others.
    pub(super) layer: Option<BitDrop>,
    /// From an opacity raised to the transmittance's format, if that has more bits, to that format.
    pub(super) light: BitDrop,
}

/// What a footprint's pixels need beside its rows.
#[derive(Clone, Copy, Debug)]
pub struct SplatNumbers {
    /// One past the largest radial index inside, raised.
    pub end: i64,
    pub peak: u32,
    pub colour: [u32; 3],
}

impl PathNumbers {
    /// For widths and a table that words can do, in lanes of so many bits; `None` if an entry of the table exceeds 1,
    /// or a constant or the lanes' radial index its format.
    pub fn new(memory: &TableMemory, lane_bits: u32) -> Option<Self> {
        let (widths, table) = (&memory.widths, memory.table());
        let blend = Blend::new(widths, &memory.rules);
        let constants = blend.constants();
        let (entries, deep) = (table.entries(), lane_bits > 32);
        let fits = entries.iter().all(|entry| *entry <= 1 << widths.weight)
            && entries.is_sorted_by(|entry, next| entry >= next)
            && u64::from(constants.minimum_transmittance) < 1 << widths.transmittance
            && constants.alpha_max <= 1 << widths.alpha
            && (deep || widths.radial <= 27);
        if !fits {
            return None;
        }
        let shift = |by| shift(by, constants.rounding);
        let colour = shift(constants.colour_shift)?;
        let even = if constants.rounding == Rounding::NearestEven {
            EVEN
        } else {
            0
        };
        let unusual = if colour.by > 32 || !blend.draws_all_visible() {
            UNUSUAL
        } else {
            0
        };
        Some(PathNumbers {
            rows: RuntimeRows::new(widths, lane_bits)?,
            beyond: [widths.peak, widths.colour]
                .map(|fraction| u32::MAX.checked_shl(u32::from(fraction) + 4).unwrap_or(0)),
            entries: entries.into(),
            rest_bits: table.rest_bits(),
            kept: u32::from(widths.interpolation).min(table.rest_bits()),
            raise: if deep { 0 } else { 32 },
            opacity: shift(constants.opacity_shift)?,
            share: shift(constants.contribution_shift)?,
            colour,
            alpha_max: constants.alpha_max,
            opacity_min: i64::try_from(constants.opacity_min).ok()?,
            stop: i64::from(constants.minimum_transmittance) + 1,
            operator: even
                | unusual
                | if constants.omit_finishing {
                    OMIT_FINISHING
                } else {
                    DRAW_FINISHING
                },
            layer: None,
            light: shift(0)?,
        })
    }

    /// The same in another order; `None` where a sum of layers might leave what words can do.
    pub fn in_order(self, order: Compositing, rounding: Rounding) -> Option<Self> {
        let operator = match order {
            Compositing::FrontToBack => return Some(self),
            Compositing::BackToFront => BACK_TO_FRONT,
            Compositing::XRay => X_RAY,
        };
        let widths = self.rows.widths();
        let [alpha, transmittance] = [widths.alpha, widths.transmittance].map(i32::from);
        let [colour, accumulator] = [widths.colour, widths.accumulator].map(i32::from);
        // A layer is at most 16, which has no place in 32 bits otherwise.
        if accumulator > 27 {
            return None;
        }
        Some(PathNumbers {
            operator: operator | self.operator & EVEN,
            layer: Some(shift(alpha + colour - accumulator, rounding)?),
            light: shift((alpha - transmittance).max(0), rounding)?,
            ..self
        })
    }

    /// One past the largest radial index inside a footprint with this cut-off; `None` if it lies outside the table, so
    /// that vectors would look something up beyond it, or outside the lanes.
    #[inline(always)]
    fn end(&self, cutoff: u32) -> Option<i64> {
        let end = i64::try_from(cutoff_in_lane(cutoff, self.rows.widths().radial)).ok()?;
        let last = end.checked_sub(1)?;
        let fits = (self.raise == 0 || end <= i64::from(i32::MAX))
            && (last < 0 || ((last as u64) >> self.rest_bits) + 1 < self.entries.len() as u64);
        fits.then_some(end)
    }

    /// A footprint's numbers; `None` if its words lie outside their formats or its end outside the table.
    #[inline(always)]
    pub fn splat(&self, footprint: &Footprint) -> Option<SplatNumbers> {
        let end = self.end(footprint.cutoff)?;
        let [red, green, blue] = footprint.colour;
        let [peak, colour] = self.beyond;
        let fits = footprint.opacity & peak | (red | green | blue) & colour == 0;
        fits.then(|| SplatNumbers {
            end: end << self.raise,
            peak: footprint.opacity,
            colour: footprint.colour,
        })
    }
}
