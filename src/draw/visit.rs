//! The pixel lanes without a target: for compositing units that keep more or other things per pixel than a
//! [`Pixel`](crate::blend::Pixel).

use super::{Coverage, Painter, cutoff_in_lane, inside};
use crate::footprint::Footprint;
use crate::format::{Design, Traversal};
use crate::raster::{BoxSpans, EllipseSpans, Spans, Window};

impl<D: Design> Painter<'_, D> {
    /// Calls `composite(x, y, alpha)` for every pixel of `window` at which the footprint is not transparent; alpha in
    /// UQ1.alpha.
    ///
    /// The same radial indices and opacities as [`draw`](Self::draw), bit for bit; nothing counts as finished.
    pub fn visit(
        &self,
        footprint: &Footprint,
        window: &Window,
        composite: impl FnMut(u16, u16, u32),
    ) -> Coverage {
        match self.traversal {
            Traversal::Spans => self.visit_rows(
                footprint,
                EllipseSpans::new(self.design, footprint, window),
                composite,
            ),
            Traversal::Box => self.visit_rows(
                footprint,
                BoxSpans::new(self.design, footprint, window),
                composite,
            ),
        }
    }

    #[inline(always)]
    fn visit_rows<R: Spans>(
        &self,
        footprint: &Footprint,
        mut rows: R,
        mut composite: impl FnMut(u16, u16, u32),
    ) -> Coverage {
        let mut coverage = Coverage::default();
        let radial = self.design.widths().radial;
        let drop = rows.fraction() as i32 - i32::from(radial);
        let end = cutoff_in_lane(footprint.cutoff, radial);
        while let Some(run) = rows.next_span() {
            coverage.visited += u64::from(run.length);
            for (step, lane) in run.radials().enumerate() {
                let x = run.x.wrapping_add(step as u16);
                let Some(radial) = inside(lane, drop, end) else {
                    continue;
                };
                coverage.covered += 1;
                let weight = self.table.weight(radial);
                let alpha = self.blend.opacity(footprint.opacity, weight);
                if alpha > 0 {
                    composite(x, run.y, alpha);
                }
            }
        }
        coverage
    }
}
