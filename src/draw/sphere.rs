//! Spheres in perspective: the corrected index between the lanes and the footprint table ([HYBRID] 4.2).

use super::{Coverage, Painter};
use crate::format::Design;
use crate::kernel::PerspectiveTable;
use crate::raster::SpanRows;
use crate::setup::SphereFootprint;
use crate::target::Target;

impl<D: Design> Painter<'_, D> {
    /// Draws a sphere's footprint by the traversal `spans` with the perspective-correct index.
    ///
    /// At most as many steps as the window has pixels, plus one per row, whatever the footprint's bits.
    pub fn draw_sphere(
        &self,
        sphere: &SphereFootprint,
        index: &PerspectiveTable,
        target: &mut Target,
    ) -> Coverage {
        let window = target.window();
        let rows = SpanRows::new(self.design, &sphere.footprint, &window);
        let index = index.index(sphere.spread, self.design.widths().radial.into());
        self.paint_weighted(&sphere.footprint, rows, target, |radial| {
            self.table.weight(index.correct(radial))
        })
    }
}
