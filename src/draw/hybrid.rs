//! Points and splats in one picture: points are gathered in slabs, splats composited between them (\[HYBRID\] 4).

use super::{Coverage, Painter};
use crate::blend::points::Slabs;
use crate::footprint::{Footprint, depth};
use crate::format::Design;
use crate::raster::{EllipseSpans, Stamp};
use crate::target::Target;

/// How points are gathered. Constant for a picture.
#[derive(Clone, Copy, Debug)]
pub struct PointSettings<'a> {
    /// Thickness of the depth range within which points are summed, UQ9.23 scene units.
    pub range: u32,
    /// The filter as a stamp; without it points go through the traversal `spans`.
    pub stamp: Option<Stamp<'a>>,
}

impl<D: Design> Painter<'_, D> {
    /// Gathers a point into the slabs. Points and splats must come nearest first.
    pub fn draw_point(
        &self,
        point: &Footprint,
        gathering: &PointSettings,
        target: &mut Target,
        slabs: &mut Slabs,
    ) -> Coverage {
        let blend = &self.blend;
        let depth = depth::fixed(point.depth);
        let gather = |at, pixel: &mut _, alpha| {
            if let Some(slab) = slabs.at(at) {
                blend.gather(pixel, slab, alpha, &point.colour, depth, gathering.range);
            }
        };
        match &gathering.stamp {
            Some(stamp) => self.copy_stamp(stamp, point, target, gather),
            None => {
                let rows = EllipseSpans::new(self.design, point, &target.window());
                self.paint_with(
                    point,
                    rows,
                    target,
                    |_, radial| self.table.weight(radial),
                    gather,
                )
            }
        }
    }

    /// Composites a splat behind what its pixels have gathered so far.
    pub fn draw_among_points(
        &self,
        splat: &Footprint,
        target: &mut Target,
        slabs: &mut Slabs,
    ) -> Coverage {
        let blend = &self.blend;
        let rows = EllipseSpans::new(self.design, splat, &target.window());
        self.paint_with(
            splat,
            rows,
            target,
            |_, radial| self.table.weight(radial),
            |at, pixel, alpha| {
                if let Some(slab) = slabs.at(at) {
                    blend.close(pixel, slab);
                }
                if !pixel.is_finished() {
                    blend.front_to_back(pixel, alpha, &splat.colour);
                }
            },
        )
    }

    /// Composites what is still gathered: to be called once, after the last point and splat.
    pub fn finish_points(&self, target: &mut Target, slabs: &mut Slabs) {
        let window = target.window();
        let columns = window.end[0].saturating_sub(window.first[0]);
        for y in window.first[1]..window.end[1] {
            let row = target.row(y, window.first[0], columns);
            for (pixel, x) in row.iter_mut().zip(window.first[0]..) {
                if let Some(slab) = slabs.at([x, y]) {
                    self.blend.close(pixel, slab);
                }
            }
        }
    }
}
