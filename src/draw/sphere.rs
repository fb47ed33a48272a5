//! Spheres in perspective: the corrected index between the lanes and the footprint table (\[HYBRID\] 4.2).

use super::{Coverage, Painter, cutoff_in_lane};
use crate::format::Design;
use crate::kernel::{PerspectiveTable, Rays};
use crate::raster::EllipseSpans;
use crate::setup::SphereFootprint;
use crate::target::Target;

/// What corrects the index of spheres. Constant for a picture.
#[derive(Clone, Copy, Debug)]
pub struct Perspective<'a> {
    /// The two-index table.
    pub table: PerspectiveTable<'a>,
    /// The rays of the picture's pixels.
    pub rays: Rays,
}

impl<D: Design> Painter<'_, D> {
    /// Draws a sphere's footprint by the traversal `spans` with the index that its setup chose.
    ///
    /// At most as many steps as the window has pixels, plus one per row, whatever the footprint's bits.
    pub fn draw_sphere(
        &self,
        sphere: &SphereFootprint,
        perspective: &Perspective,
        target: &mut Target,
    ) -> Coverage {
        let radial_bits = self.design.widths().radial;
        let window = target.window();
        let rows = EllipseSpans::new(self.design, &sphere.footprint, &window);
        let end = cutoff_in_lane(sphere.end, radial_bits);
        let inside = |radial: u64| {
            if radial < end {
                self.table.weight(radial)
            } else {
                0
            }
        };
        match sphere.slant {
            Some(slant) => {
                let rays = &perspective.rays;
                let weight = |at, radial| inside(rays.correct(at, radial, slant));
                self.paint_weighted(&sphere.footprint, rows, target, weight)
            }
            None => {
                let index = perspective.table.index(sphere.spread, radial_bits.into());
                let weight = |_, radial| inside(index.correct(radial));
                self.paint_weighted(&sphere.footprint, rows, target, weight)
            }
        }
    }
}
