//! Drawing by stamps: table copy, opacity, compositing (\[SWAN\] 6).

use super::{Coverage, Painter};
use crate::blend::Pixel;
use crate::footprint::Footprint;
use crate::format::Design;
use crate::raster::Stamp;
use crate::rules::Compositing;
use crate::target::Target;

impl<D: Design> Painter<'_, D> {
    /// Draws a footprint by copying `stamp` to its place: of the footprint only centre, peak and colour are used.
    ///
    /// Visited pixels are those of the stamp's square, covered ones those with a kernel value above 0.
    pub fn draw_stamp(
        &self,
        stamp: &Stamp,
        footprint: &Footprint,
        target: &mut Target,
    ) -> Coverage {
        let blend = &self.blend;
        let colour = &footprint.colour;
        match self.compositing {
            Compositing::FrontToBack => {
                self.copy_stamp(stamp, footprint, target, |_, pixel, alpha| {
                    blend.front_to_back(pixel, alpha, colour)
                })
            }
            Compositing::BackToFront => {
                self.copy_stamp(stamp, footprint, target, |_, pixel, alpha| {
                    blend.back_to_front(pixel, alpha, colour)
                })
            }
            Compositing::XRay => self.copy_stamp(stamp, footprint, target, |_, pixel, alpha| {
                blend.x_ray(pixel, alpha, colour)
            }),
        }
    }

    #[inline(always)]
    pub(super) fn copy_stamp(
        &self,
        stamp: &Stamp,
        footprint: &Footprint,
        target: &mut Target,
        mut composite: impl FnMut([u16; 2], &mut Pixel, u32),
    ) -> Coverage {
        let mut coverage = Coverage::default();
        let placement = stamp
            .shape()
            .place(footprint.centre, self.design.widths().subpixel);
        for row in stamp.rows(placement, &target.window()) {
            let length = row.weights.len() as u16;
            coverage.visited += u64::from(length);
            let pixels = target.row(row.y, row.x, length).iter_mut();
            for ((pixel, weight), x) in pixels.zip(row.weights).zip(row.x..) {
                if *weight == 0 {
                    continue;
                }
                coverage.covered += 1;
                if pixel.is_finished() {
                    coverage.finished += 1;
                    continue;
                }
                let alpha = self.blend.opacity(footprint.opacity, *weight);
                if alpha > 0 {
                    composite([x, row.y], pixel, alpha);
                }
            }
        }
        coverage
    }
}
