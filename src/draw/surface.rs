//! The surface primitive: the units chained, from a surface footprint to the fragments of a target.
//!
//! Traversal and footprint table are those of the volume primitive; the plane's depth runs beside the radial
//! index, one addition per pixel.

use super::{Coverage, cutoff_in_lane, inside};
use crate::blend::Blend;
use crate::blend::surface::{Cell, Sample, WeightedSum};
use crate::footprint::surface::{SurfaceFootprint, depth_in_pixel};
use crate::format::{Design, Lane, Traversal};
use crate::kernel::FootprintTable;
use crate::raster::{BoxSpans, EllipseSpans, Span, Spans};
use crate::rules::Rules;
use crate::target::cells::CellTarget;

/// Everything that is constant for a picture of surfaces.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePainter<'a, D> {
    design: D,
    table: FootprintTable<'a>,
    blend: Blend,
    gather: WeightedSum,
    traversal: Traversal,
}

impl<'a, D: Design> SurfacePainter<'a, D> {
    /// A painter for one design, rule set, footprint table, depth threshold and traversal.
    pub fn new(
        design: D,
        rules: &Rules,
        table: FootprintTable<'a>,
        gather: WeightedSum,
        traversal: Traversal,
    ) -> Self {
        SurfacePainter {
            design,
            table,
            blend: Blend::new(&design.widths(), rules),
            gather,
            traversal,
        }
    }

    /// Draws one footprint into the target's window, in any order. [`Coverage::finished`] stays 0: no pixel finishes.
    ///
    /// At most as many steps as the window has pixels, plus one per row, whatever the footprint's bits.
    pub fn draw<C: Cell>(
        &self,
        footprint: &SurfaceFootprint,
        target: &mut CellTarget<C>,
    ) -> Coverage {
        let window = target.window();
        let shape = &footprint.footprint;
        match self.traversal {
            Traversal::Spans => self.paint(
                footprint,
                EllipseSpans::new(self.design, shape, &window),
                target,
            ),
            Traversal::Box => self.paint(
                footprint,
                BoxSpans::new(self.design, shape, &window),
                target,
            ),
        }
    }

    #[inline(always)]
    fn paint<R: Spans, C: Cell>(
        &self,
        footprint: &SurfaceFootprint,
        mut rows: R,
        target: &mut CellTarget<C>,
    ) -> Coverage {
        let mut coverage = Coverage::default();
        let drop = rows.fraction() as i32 - i32::from(self.design.widths().radial);
        while let Some(run) = rows.next_span() {
            coverage += self.paint_run(footprint, run, drop, target);
        }
        coverage
    }

    /// The pixel lanes: radial index and depth, footprint table, weight, gathering.
    #[inline(always)]
    fn paint_run<L: Lane, C: Cell>(
        &self,
        footprint: &SurfaceFootprint,
        run: Span<L>,
        drop: i32,
        target: &mut CellTarget<C>,
    ) -> Coverage {
        let mut coverage = Coverage {
            visited: run.length.into(),
            ..Coverage::default()
        };
        let end = cutoff_in_lane(footprint.footprint.cutoff, self.design.widths().radial);
        let step = footprint.plane.step[0];
        let mut depth = footprint.depth_at(run.x, run.y);
        let cells = target.row(run.y, run.x, run.length);
        for (cell, lane) in cells.iter_mut().zip(run.radials()) {
            let here = depth;
            depth = depth.wrapping_add(step);
            let Some(radial) = inside(lane, drop, end) else {
                continue;
            };
            coverage.covered += 1;
            let alpha = self
                .blend
                .opacity(footprint.footprint.opacity, self.table.weight(radial));
            let weight = self.gather.weight(alpha);
            if weight > 0 {
                let sample = Sample {
                    weight,
                    depth: depth_in_pixel(here),
                    attributes: &footprint.attributes,
                };
                cell.add(&self.gather, &sample);
            }
        }
        coverage
    }
}
