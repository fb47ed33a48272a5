//! The splat primitive: the units chained, from a footprint to the pixels of a target.

mod hybrid;
mod narrow;
mod sphere;
mod stamp;
pub mod surface;
#[cfg(test)]
mod tests;
mod visit;

pub use crate::raster::cutoff_in_lane;
pub use hybrid::PointSettings;
pub use narrow::{NarrowError, NarrowLanes, NarrowRun, NarrowRuns, Painter32};
pub use sphere::Perspective;

use crate::blend::{Blend, Pixel};
use crate::footprint::Footprint;
use crate::format::{Design, Lane, Traversal};
use crate::kernel::FootprintTable;
use crate::raster::{BoxSpans, EllipseSpans, Span, Spans};
use crate::rules::{Compositing, Rules};
use crate::target::Target;

/// Pixels that a drawing touched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// Pixels at which a radial index was computed.
    pub visited: u64,
    /// Of these, pixels inside a footprint: r < c.
    pub covered: u64,
    /// Of the covered ones, pixels that had already finished.
    pub finished: u64,
}

impl core::ops::AddAssign for Coverage {
    fn add_assign(&mut self, other: Coverage) {
        self.visited += other.visited;
        self.covered += other.covered;
        self.finished += other.finished;
    }
}

/// Everything that is constant for a picture.
#[derive(Clone, Copy, Debug)]
pub struct Painter<'a, D> {
    design: D,
    table: FootprintTable<'a>,
    blend: Blend,
    compositing: Compositing,
    traversal: Traversal,
}

impl<'a, D: Design> Painter<'a, D> {
    /// A painter for one design, rule set, footprint table, order and traversal.
    #[inline(always)]
    pub fn new(
        design: D,
        rules: &Rules,
        table: FootprintTable<'a>,
        compositing: Compositing,
        traversal: Traversal,
    ) -> Self {
        Painter {
            design,
            table,
            blend: Blend::new(&design.widths(), rules),
            compositing,
            traversal,
        }
    }

    /// Draws one footprint into the target's window. Footprints must come in the compositing's order.
    ///
    /// At most as many steps as the window has pixels, plus one per row, whatever the footprint's bits.
    pub fn draw(&self, footprint: &Footprint, target: &mut Target) -> Coverage {
        let window = target.window();
        match self.traversal {
            Traversal::Spans => self.paint(
                footprint,
                EllipseSpans::new(self.design, footprint, &window),
                target,
            ),
            Traversal::Box => self.paint(
                footprint,
                BoxSpans::new(self.design, footprint, &window),
                target,
            ),
        }
    }

    #[inline(always)]
    fn paint<R: Spans>(&self, footprint: &Footprint, rows: R, target: &mut Target) -> Coverage {
        let weight = |_, radial| self.table.weight(radial);
        self.paint_weighted(footprint, rows, target, weight)
    }

    /// By the compositing's operator, with the kernel's value at a radial index (UQ4.radial) from `weight`.
    #[inline(always)]
    fn paint_weighted<R: Spans>(
        &self,
        footprint: &Footprint,
        rows: R,
        target: &mut Target,
        weight: impl Fn([u16; 2], u64) -> u32,
    ) -> Coverage {
        let blend = &self.blend;
        let colour = &footprint.colour;
        match self.compositing {
            Compositing::FrontToBack => {
                self.paint_with(footprint, rows, target, weight, |_, pixel, alpha| {
                    blend.front_to_back(pixel, alpha, colour)
                })
            }
            Compositing::BackToFront => {
                self.paint_with(footprint, rows, target, weight, |_, pixel, alpha| {
                    blend.back_to_front(pixel, alpha, colour)
                })
            }
            Compositing::XRay => {
                self.paint_with(footprint, rows, target, weight, |_, pixel, alpha| {
                    blend.x_ray(pixel, alpha, colour)
                })
            }
        }
    }

    #[inline(always)]
    fn paint_with<R: Spans>(
        &self,
        footprint: &Footprint,
        mut rows: R,
        target: &mut Target,
        weight: impl Fn([u16; 2], u64) -> u32,
        mut composite: impl FnMut([u16; 2], &mut Pixel, u32),
    ) -> Coverage {
        let mut coverage = Coverage::default();
        let drop = rows.fraction() as i32 - i32::from(self.design.widths().radial);
        while let Some(run) = rows.next_span() {
            coverage += self.paint_run(footprint, run, drop, target, &weight, &mut composite);
        }
        coverage
    }

    /// The pixel lanes: radial index, footprint table, opacity, compositing.
    #[inline(always)]
    fn paint_run<L: Lane>(
        &self,
        footprint: &Footprint,
        run: Span<L>,
        drop: i32,
        target: &mut Target,
        weight: impl Fn([u16; 2], u64) -> u32,
        mut composite: impl FnMut([u16; 2], &mut Pixel, u32),
    ) -> Coverage {
        // Narrow counters: a run is short, and 64-bit additions per pixel cost a small processor.
        let (mut covered, mut finished) = (0u32, 0u32);
        let visited = run.length.into();
        let end = cutoff_in_lane(footprint.cutoff, self.design.widths().radial);
        for ((pixel, lane), x) in target
            .row(run.y, run.x, run.length)
            .iter_mut()
            .zip(run.sequence())
            .zip(run.x..)
        {
            let Some(radial) = inside(lane, drop, end) else {
                continue;
            };
            covered += 1;
            if pixel.is_finished() {
                finished += 1;
                continue;
            }
            let alpha = self
                .blend
                .opacity(footprint.opacity, weight([x, run.y], radial));
            if alpha > 0 {
                composite([x, run.y], pixel, alpha);
            }
        }
        Coverage {
            visited,
            covered: covered.into(),
            finished: finished.into(),
        }
    }
}

/// The radial index (UQ4.radial) of a lane word, if it lies inside the footprint; negative ones are rounding noise
/// around 0.
#[inline(always)]
fn inside<L: Lane>(lane: L, drop: i32, end: u64) -> Option<u64> {
    let radial = match drop {
        0 => lane.at_least_zero(),
        _ => crate::math::shift_signed(lane.to_wide(), drop).max(0) as u64,
    };
    (radial < end).then_some(radial)
}
