//! Traversal `box`: every pixel of the bounding box by conic forward differencing, as in the papers (\[EWA\] 7.1.2,
//! \[SURF\] 4).
//!
//! r = a dx^2 + 2 b dx dy + c dy^2 from the corner of the box: two additions per pixel and three per row. It is the
//! baseline of the speed-against-error report: most visited pixels lie outside the ellipse, and the corner's huge terms
//! cancel on the way to the ellipse, so that a thin splat inherits their rounding.
//!
//! Accumulators are 64-bit integers in Q27.36. Where the conic at a corner exceeds that range, values wrap modulo 2^27;
//! such footprints are thinner than one part in 10^3 and their pictures under `box` are undefined, though bounded.

use super::{Quadratic, Span, Spans, Window};
use crate::footprint::Footprint;
use crate::format::Design;
use crate::math::SoftFloat;

/// Fraction bits of the accumulators.
const FRACTION: u32 = 36;

/// The runs of one footprint under the traversal `box`: one per row.
#[derive(Clone, Debug)]
pub struct BoxSpans {
    y: u16,
    end_row: u16,
    first_column: u16,
    columns: u16,
    /// r at the first visible column, down the rows.
    radial: Quadratic,
    /// Its difference along the row, and how that changes per row.
    across: i64,
    cross: i64,
    second: i64,
}

impl BoxSpans {
    /// Prepares the rows of `footprint` that lie in `window`.
    pub fn new<D: Design>(design: D, footprint: &Footprint, window: &Window) -> Self {
        let widths = design.widths();
        let bits = u32::from(widths.mantissa);
        let corner = [0, 1].map(|axis| distance(footprint, axis, widths.subpixel.into(), bits));
        let [a, b, c] = footprint.conic.mantissa.map(|mantissa| SoftFloat {
            mantissa,
            exponent: footprint.conic.exponent,
        });
        let [dx, dy] = corner;
        let [adx, bdx, bdy, cdy] = [
            a.multiply(dx, bits),
            b.multiply(dx, bits),
            b.multiply(dy, bits),
            c.multiply(dy, bits),
        ];
        let fixed = |value: SoftFloat| value.to_fixed(FRACTION);
        let radial = adx.times(dx).to_fixed(FRACTION);
        let radial = radial.wrapping_add(bdx.times(dy).to_fixed(FRACTION).wrapping_mul(2));
        let mut rows = BoxSpans {
            y: footprint.first[1],
            end_row: 0,
            first_column: 0,
            columns: 0,
            radial: Quadratic {
                value: radial.wrapping_add(cdy.times(dy).to_fixed(FRACTION)),
                first: fixed(cdy)
                    .wrapping_add(fixed(bdx))
                    .wrapping_mul(2)
                    .wrapping_add(fixed(c)),
                second: fixed(c).wrapping_mul(2),
            },
            across: fixed(adx)
                .wrapping_add(fixed(bdy))
                .wrapping_mul(2)
                .wrapping_add(fixed(a)),
            cross: fixed(b).wrapping_mul(2),
            second: fixed(a).wrapping_mul(2),
        };
        rows.clip(footprint, window);
        rows
    }

    /// Moves the differences to the visible part's corner, exactly.
    fn clip(&mut self, footprint: &Footprint, window: &Window) {
        let visible = Window::of(footprint).intersect(window);
        if visible.is_empty() {
            return;
        }
        let skip = [0, 1].map(|axis| visible.first[axis] - footprint.first[axis]);
        let mut row = Quadratic {
            value: self.radial.value,
            first: self.across,
            second: self.second,
        };
        row.jump(skip[0]);
        self.radial.value = row.value;
        self.across = row.first;
        self.radial.first = self
            .radial
            .first
            .wrapping_add(self.cross.wrapping_mul(skip[0].into()));
        self.radial.jump(skip[1]);
        self.across = self
            .across
            .wrapping_add(self.cross.wrapping_mul(skip[1].into()));
        self.y = visible.first[1];
        self.end_row = visible.end[1];
        self.first_column = visible.first[0];
        self.columns = visible.end[0] - visible.first[0];
    }
}

impl Spans for BoxSpans {
    type Lane = i64;

    #[inline(always)]
    fn fraction(&self) -> u32 {
        FRACTION
    }

    fn next_span(&mut self) -> Option<Span<i64>> {
        if self.y >= self.end_row {
            return None;
        }
        let run = Span {
            y: self.y,
            x: self.first_column,
            length: self.columns,
            radial: self.radial.value,
            first: self.across,
            second: self.second,
        };
        self.y += 1;
        self.radial.step();
        self.across = self.across.wrapping_add(self.cross);
        Some(run)
    }
}

/// Distance of the first sample point of the box from the centre, pixels.
fn distance(footprint: &Footprint, axis: usize, subpixel: u32, bits: u32) -> SoftFloat {
    let sample = (2 * i64::from(footprint.first[axis]) + 1) << (subpixel - 1);
    SoftFloat::from_wide(
        sample.wrapping_sub(footprint.centre[axis]),
        -(subpixel as i32),
        bits,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Lean18;

    #[test]
    fn nothing_is_seen_outside_the_window() {
        let footprint = Footprint {
            end: [8, 8],
            ..Footprint::EMPTY
        };
        let window = Window {
            first: [8, 0],
            end: [9, 8],
        };
        assert_eq!(BoxSpans::new(Lean18, &footprint, &window).next_span(), None);
    }
}
