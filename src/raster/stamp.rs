//! Traversal `stamp`: footprints of one size and shape, drawn by table copy (\[SWAN\] 6: a sub-pixel-centred bitblt).
//!
//! Beyond the distance k, and for points and spheres in a parallel view, all footprints of a picture have one size on
//! the screen (\[SWAN\] 4.3). Their kernel values are computed once for `2^n x 2^n` positions of the centre within a
//! pixel (a glyph cache for splats); drawing then rounds the centre to the nearest phase, copies rows and composites.
//! There is no radial index, no table lookup and no multiplication but the opacity's own.
//!
//! The centre moves by at most half a phase: 2^-(n+1) pixels. Its error falls by two with every bit of n and its memory
//! grows by four (docs/systems.md has the measurement).

use super::{EllipseSpans, Spans, Window, cutoff_in_lane};
use crate::footprint::Footprint;
use crate::format::{Design, Lane};
use crate::kernel::FootprintTable;
use crate::math::{SoftFloat, shift_signed, square_root};

/// Largest number of phase bits.
pub const MAX_PHASE_BITS: u8 = 6;

/// Largest number of columns or rows of a stamp.
pub const MAX_SIDE: u16 = 64;

/// The size of a stamp: constant for a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StampShape {
    /// Phases per pixel and axis, as a power of two.
    phase_bits: u8,
    /// Half-extents of the footprint, pixels, Q15.16.
    extent: [i64; 2],
    /// Columns and rows.
    side: [u16; 2],
}

/// The footprint is too large for a stamp, or there are too many phases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StampError {
    /// Columns and rows needed; [`MAX_SIDE`] are allowed.
    pub side: [u16; 2],
    /// Phase bits asked for; [`MAX_PHASE_BITS`] are allowed.
    pub phase_bits: u8,
}

/// Kernel values at all phases, in memory that the caller lends.
#[derive(Clone, Copy, Debug)]
pub struct Stamp<'a> {
    shape: StampShape,
    weights: &'a [u32],
}

/// Where a footprint's copy of the stamp lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placement {
    /// First column and row, perhaps outside the screen.
    first: [i64; 2],
    /// Phase along both axes.
    phase: [usize; 2],
}

/// One row of a placed stamp within a window.
#[derive(Clone, Copy, Debug)]
pub struct StampRow<'a> {
    /// Row on the screen.
    pub y: u16,
    /// First column on the screen.
    pub x: u16,
    /// Kernel values, UQ1.weight, at most [`MAX_SIDE`].
    pub weights: &'a [u32],
}

impl StampShape {
    /// The stamp that holds `footprint`'s shape at `2^phase_bits` phases per axis.
    pub fn new(footprint: &Footprint, phase_bits: u8) -> Result<StampShape, StampError> {
        let cutoff = SoftFloat::from_wide(footprint.cutoff.into(), -28, 24);
        // r = A (dx - S dy)^2 + C dy^2 < c reaches sqrt(c / C) down and sqrt(c (1/A + S^2 / C)) across.
        let scan = &footprint.ldl;
        let down = crate::math::reciprocal(scan.vertical, 24).unwrap_or(SoftFloat::ZERO);
        let slant = scan.shear.multiply(scan.shear, 24).times(down);
        let across = crate::math::sum_of_products([scan.squared_width.times(ONE), slant], 24);
        let extent = [across, down].map(|variance| {
            let root = square_root(cutoff.multiply(variance, 24), 24).to_fixed(16);
            root.clamp(0, 1 << 40).saturating_add(1)
        });
        let side = extent.map(|extent| ((2 * extent) >> 16).saturating_add(1).min(0xffff) as u16);
        if side.iter().any(|side| *side > MAX_SIDE) || phase_bits > MAX_PHASE_BITS {
            return Err(StampError { side, phase_bits });
        }
        Ok(StampShape {
            phase_bits,
            extent,
            side,
        })
    }

    /// Words of memory for all phases.
    pub const fn words(&self) -> usize {
        (self.side[0] as usize * self.side[1] as usize) << (2 * self.phase_bits)
    }

    /// Columns and rows.
    pub const fn side(&self) -> [u16; 2] {
        self.side
    }

    /// Rounds a centre (Q27.subpixel) to the nearest phase: two shifts and additions per axis.
    #[inline(always)]
    pub fn place(&self, centre: [i64; 2], subpixel: u8) -> Placement {
        let bits = u32::from(self.phase_bits);
        let mut placement = Placement {
            first: [0; 2],
            phase: [0; 2],
        };
        for (axis, coordinate) in centre.into_iter().enumerate() {
            let nearest = shift_signed(coordinate, i32::from(subpixel) - bits as i32);
            placement.phase[axis] = (nearest & ((1 << bits) - 1)) as usize;
            let at = shift_signed(nearest, bits as i32 - 16);
            // The first sample point (j + 1/2) at or after the footprint's left end.
            let left = at
                .wrapping_sub(self.extent[axis])
                .wrapping_sub(1 << 15)
                .wrapping_add((1 << 16) - 1);
            placement.first[axis] = left >> 16;
        }
        placement
    }
}

impl StampShape {
    /// First and one past the last column and row of a placed stamp within the viewport; empty where `first >= last`.
    ///
    /// Rounding to a phase moves a footprint by up to half a phase, so that its own box may not hold its stamp.
    pub fn bounds(&self, placement: &Placement, viewport: [u16; 2]) -> Window {
        let mut bounds = Window {
            first: [0; 2],
            end: [0; 2],
        };
        for (axis, size) in viewport.into_iter().enumerate() {
            let first = placement.first[axis];
            let limit = i64::from(size);
            let last = first.saturating_add(self.side[axis].into());
            bounds.first[axis] = first.clamp(0, limit) as u16;
            bounds.end[axis] = last.clamp(0, limit) as u16;
        }
        bounds
    }
}

const ONE: SoftFloat = SoftFloat {
    mantissa: 1 << 30,
    exponent: -30,
};

/// Computes the stamps of `footprint`'s shape through the traversal `spans`; false if `memory` has not
/// [`StampShape::words`] words.
pub fn fill_stamps<D: Design>(
    memory: &mut [u32],
    design: D,
    table: &FootprintTable,
    shape: &StampShape,
    footprint: &Footprint,
) -> bool {
    let widths = design.widths();
    let area = usize::from(shape.side[0]) * usize::from(shape.side[1]);
    if memory.len() != shape.words() || area == 0 {
        return false;
    }
    let phases = 1usize << shape.phase_bits;
    let subpixel = u32::from(widths.subpixel);
    for (index, stamp) in memory.chunks_exact_mut(area).enumerate() {
        let phase = [index % phases, index / phases];
        // Far enough from the screen's edge that the stamp begins within it.
        let base = i64::from(MAX_SIDE);
        let centre = phase.map(|phase| {
            let offset = shift_signed(phase as i64, i32::from(shape.phase_bits) - subpixel as i32);
            (base << subpixel) + offset
        });
        let first = shape
            .place(centre, widths.subpixel)
            .first
            .map(|first| first as u16);
        let placed = Footprint {
            centre,
            first,
            end: [first[0] + shape.side[0], first[1] + shape.side[1]],
            ..*footprint
        };
        stamp.fill(0);
        fill_stamp(stamp, design, table, &placed);
    }
    true
}

fn fill_stamp<D: Design>(
    stamp: &mut [u32],
    design: D,
    table: &FootprintTable,
    footprint: &Footprint,
) {
    let window = Window::of(footprint);
    let columns = usize::from(window.end[0] - window.first[0]);
    let mut rows = EllipseSpans::new(design, footprint, &window);
    let end = cutoff_in_lane(footprint.cutoff, design.widths().radial);
    while let Some(run) = rows.next_span() {
        let start =
            usize::from(run.y - window.first[1]) * columns + usize::from(run.x - window.first[0]);
        for (weight, lane) in stamp.iter_mut().skip(start).zip(run.radials()) {
            let radial = lane.at_least_zero();
            *weight = if radial < end {
                table.weight(radial)
            } else {
                0
            };
        }
    }
}

impl<'a> Stamp<'a> {
    /// Stamps in `weights`, which [`fill_stamps`] filled; `None` if there are not [`StampShape::words`] of them.
    pub fn new(weights: &'a [u32], shape: StampShape) -> Option<Self> {
        (weights.len() == shape.words()).then_some(Stamp { shape, weights })
    }

    /// Size and phases.
    pub fn shape(&self) -> &StampShape {
        &self.shape
    }

    /// The placed stamp's rows within `window`: at most [`MAX_SIDE`] of at most [`MAX_SIDE`] pixels.
    #[inline(always)]
    pub fn rows(
        &self,
        placement: Placement,
        window: &Window,
    ) -> impl Iterator<Item = StampRow<'a>> {
        let side = self.shape.side;
        let columns = usize::from(side[0]);
        let area = columns * usize::from(side[1]);
        let stamp = (placement.phase[1] << self.shape.phase_bits) + placement.phase[0];
        let weights = self
            .weights
            .get(stamp * area..(stamp + 1) * area)
            .unwrap_or_default();
        let [x, y] = placement.first;
        let [left, right] = visible(x, side[0], window.first[0], window.end[0]);
        let [top, bottom] = visible(y, side[1], window.first[1], window.end[1]);
        let height = if left < right {
            bottom.saturating_sub(top)
        } else {
            0
        };
        weights
            .chunks_exact(columns.max(1))
            .skip(top)
            .take(height)
            .zip(top..)
            .map(move |(row, index)| StampRow {
                y: (y + index as i64) as u16,
                x: (x + left as i64) as u16,
                weights: row.get(left..right).unwrap_or_default(),
            })
    }
}

/// The part of `first .. first + length` inside `low .. high`, counted from `first`.
#[inline(always)]
fn visible(first: i64, length: u16, low: u16, high: u16) -> [usize; 2] {
    let length = i64::from(length);
    [low, high].map(|edge| i64::from(edge).saturating_sub(first).clamp(0, length) as usize)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::digest;

    /// In a window that begins at different columns and rows, what is left of a stamp is what the whole screen shows
    /// there.
    #[test]
    fn rows_are_cut_to_the_window() {
        let shape = StampShape {
            phase_bits: 0,
            extent: [0; 2],
            side: [3, 4],
        };
        let weights: [u32; 12] = core::array::from_fn(|index| index as u32);
        let stamp = Stamp::new(&weights, shape).unwrap();
        let placement = Placement {
            first: [2, 7],
            phase: [0; 2],
        };
        for (first, end) in [
            ([0, 0], [20, 20]),
            ([3, 1], [5, 9]),
            ([1, 8], [4, 20]),
            ([5, 9], [6, 10]),
            ([6, 7], [9, 9]),
            ([2, 11], [6, 12]),
            ([4, 8], [4, 9]),
            ([0, 9], [20, 8]),
        ] {
            let window = Window { first, end };
            let mut found = std::vec::Vec::new();
            for row in stamp.rows(placement, &window) {
                assert!(!row.weights.is_empty());
                let columns = row.x..;
                found.extend(columns.zip(row.weights).map(|(x, w)| (x, row.y, *w)));
            }
            let pixels = (7..11u16).flat_map(|y| (2..5u16).map(move |x| (x, y)));
            let inside = pixels.filter(|(x, y)| {
                window.first[0] <= *x
                    && *x < window.end[0]
                    && window.first[1] <= *y
                    && *y < window.end[1]
            });
            let expected: std::vec::Vec<_> = inside
                .map(|(x, y)| (x, y, u32::from((y - 7) * 3 + x - 2)))
                .collect();
            assert_eq!(found, expected, "{window:?}");
        }
    }

    /// Stamps lie row by row of their phases.
    #[test]
    fn stamps_are_found_by_their_phase() {
        let shape = StampShape {
            phase_bits: 1,
            extent: [0; 2],
            side: [1; 2],
        };
        let stamp = Stamp::new(&[10, 11, 12, 13], shape).unwrap();
        let window = Window {
            first: [0; 2],
            end: [1; 2],
        };
        for (phase, weight) in [([0, 0], 10), ([1, 0], 11), ([0, 1], 12), ([1, 1], 13)] {
            let placement = Placement {
                first: [0; 2],
                phase,
            };
            let row = stamp.rows(placement, &window).next().unwrap();
            assert_eq!(row.weights, [weight], "{phase:?}");
        }
    }

    /// An upright or sheared ellipse with these half-axes in pixels, in units of 2^-8, sheared by units of 2^-16, up to
    /// `cutoff`, UQ4.28.
    fn ellipse([a, b]: [i64; 2], shear: i64, cutoff: u32) -> Footprint {
        let squared = |half: i64| SoftFloat::from_wide(half * half, -16, 24);
        Footprint {
            cutoff,
            ldl: crate::footprint::Ldl {
                squared_width: squared(a),
                horizontal: crate::math::reciprocal(squared(a), 24).unwrap(),
                vertical: crate::math::reciprocal(squared(b), 24).unwrap(),
                shear: SoftFloat::from_wide(shear, -16, 24),
            },
            ..Footprint::EMPTY
        }
    }

    #[test]
    fn shapes_end_with_their_limits() {
        let upright = |half: i64| ellipse([half, 300], 0, 1 << 28);
        assert_eq!(
            StampShape::new(&upright(8100), 6).unwrap().side,
            [MAX_SIDE, 3]
        );
        let error = |footprint: Footprint, bits| StampShape::new(&footprint, bits).unwrap_err();
        assert_eq!(error(upright(8200), 6).side, [MAX_SIDE + 1, 3]);
        assert_eq!(error(upright(300), 7).phase_bits, 7);
        assert_eq!(error(upright(1 << 30), 0).side, [u16::MAX, 3]);
        let point = StampShape::new(&ellipse([300; 2], 0, 0), 0).unwrap();
        assert_eq!((point.extent, point.side), ([1; 2], [1; 2]));
        let half = StampShape {
            extent: [1 << 15; 2],
            ..point
        };
        assert_eq!(half.place([0; 2], 12).first, [-1; 2]);
        let sizes = (1..3000i64).flat_map(|index| {
            let halves = [index * 97 % 2001 + 60, index * 61 % 1511 + 60];
            let footprint = ellipse(
                halves,
                index * 7919 % 179_001 - 89_500,
                (1 << 28) + index as u32 * 9973,
            );
            StampShape::new(&footprint, 3)
                .unwrap()
                .extent
                .map(|extent| extent as u64)
        });
        assert_eq!(digest(sizes), 12_141_748_393_616_475_173);
    }

    #[test]
    fn stamps_are_these_weights() {
        use crate::format::Standard24;
        let table = crate::kernel::table_4::<Standard24>();
        let words = [[900, 300], [300, 900], [60, 60]].map(|halves| {
            let footprint = ellipse(halves, 40 << 8, 2 << 28);
            let shape = StampShape::new(&footprint, 1).unwrap();
            let mut memory = std::vec![7; shape.words()];
            assert!(fill_stamps(
                &mut memory,
                Standard24,
                &table,
                &shape,
                &footprint
            ));
            digest(memory.into_iter().map(u64::from))
        });
        assert_eq!(
            words,
            [
                2_597_538_657_799_752_838,
                14_656_489_452_415_588_771,
                3_370_390_743_661_276_171
            ]
        );
        // Of four phases one has its sample on the centre, which lies at the end.
        let nothing = ellipse([300; 2], 0, 0);
        let point = StampShape::new(&nothing, 1).unwrap();
        let mut memory = [7; 4];
        assert!(fill_stamps(
            &mut memory,
            Standard24,
            &table,
            &point,
            &nothing
        ));
        assert_eq!(memory, [0; 4]);
    }
}
