//! The renderer of surfaces: set up, gather, resolve; no sorting, no display list.
//!
//! Surfaces need no order: the accumulation buffer decides by depth, the A-buffer by ranges of depths (\[SURF\] 4 and
//! 6). Each splat is set up and drawn at once, so that a picture in strips sets a scene up once per strip: memory
//! against time.

use super::{Counts, Frame, PixelReader, Primitive};
use crate::blend::Pixel;
use crate::blend::resolve::Resolve;
use crate::blend::surface::{Cell, WeightedSum};
use crate::draw::Coverage;
use crate::draw::surface::SurfacePainter;
use crate::footprint::surface::SurfaceFootprint;
use crate::format::Traversal;
use crate::kernel::{Tabled, table_4};
use crate::raster::Window;
use crate::rules::Rules;
use crate::target::TargetError;
use crate::target::cells::CellTarget;
use crate::view::{Pose, View};

/// Everything that is constant for a picture of surfaces, under [`Rules::SURFACE`]. By spans, unshaded and without
/// antialiased edges unless told otherwise.
///
/// Depths are compared in UQ9.23: a scene must lie within 512 scene units of the eye, and fill that range for the
/// finest threshold (`Camera::quantised`).
///
/// ```
/// use splatline::blend::surface::{Accumulation, Cell};
/// use splatline::{Camera, Pixel, Standard24, SurfaceRenderer, Surfel};
///
/// let view = Camera::look_at([0.0, 0.0, -2.0], [0.0; 3], [0.0, -1.0, 0.0], 45.0, [32, 32])?.view()?;
/// let surfel = Surfel {
///     position: [0.0; 3],
///     tangents: [[0.2, 0.0, 0.0], [0.0, 0.2, 0.0]],
///     weight: 1.0,
///     colour: [1.0; 3],
///     opacity: 1.0,
///     material: 0,
/// };
/// let renderer = SurfaceRenderer::new(Standard24, splatline::float::depth(0.05));
/// let (mut cells, mut pixels) = ([Accumulation::EMPTY; 32 * 32], [Pixel::EMPTY; 32 * 32]);
/// let (frame, counts) = renderer.draw(&view, [surfel], view.window(), &mut cells, &mut pixels)?;
/// assert_eq!((counts.drawn, frame.rgb8([0; 3]).nth(16 * 32 + 16)), (1, Some([255; 3])));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SurfaceRenderer<'r, D> {
    design: D,
    gather: WeightedSum,
    resolve: Resolve<'r>,
    traversal: Traversal,
}

impl<'r, D: Tabled> SurfaceRenderer<'r, D> {
    /// Splats whose depths at a pixel differ by at most `threshold` (UQ9.23 scene units,
    /// [`depth`](crate::footprint::depth)) are one surface.
    pub fn new(design: D, threshold: u32) -> Self {
        let gather = WeightedSum::new(&D::WIDTHS, threshold);
        SurfaceRenderer {
            design,
            gather,
            resolve: Resolve::new(&D::WIDTHS, gather, None, None),
            traversal: Traversal::Spans,
        }
    }

    /// The same with a light or antialiased edges.
    pub fn with_resolve(mut self, resolve: impl FnOnce(WeightedSum) -> Resolve<'r>) -> Self {
        self.resolve = resolve(self.gather);
        self
    }

    /// The same with another traversal.
    pub const fn with_traversal(mut self, traversal: Traversal) -> Self {
        self.traversal = traversal;
        self
    }

    /// Draws the part of the picture that `window` selects: gathers the scene in `cells` and resolves them into
    /// `pixels`, both of at least the window's size; neither needs to be cleared.
    /// [`Accumulation`](crate::blend::surface::Accumulation) is the cell of opaque scenes,
    /// [`Layers`](crate::blend::layers::Layers) of transparent ones.
    pub fn draw<'p, P: Pose, S: Primitive<P, Footprint = SurfaceFootprint>, C: Cell>(
        &self,
        view: &View<P>,
        scene: impl IntoIterator<Item = S>,
        window: Window,
        cells: &mut [C],
        pixels: &'p mut [Pixel],
    ) -> Result<(Frame<'p>, Counts), TargetError> {
        let needed = window.pixels();
        let found = pixels.len().min(cells.len());
        let (Some(pixels), Some(cells)) = (pixels.get_mut(..needed), cells.get_mut(..needed))
        else {
            return Err(TargetError { needed, found });
        };
        let mut target = CellTarget::new(cells, window)?;
        target.clear();
        let (coverage, counts) = self.gather(view, scene, &mut target);
        self.resolve(&mut target, pixels);
        let frame = Frame {
            pixels,
            window,
            coverage: Some(coverage),
            reader: PixelReader::new(&D::WIDTHS),
        };
        Ok((frame, counts))
    }

    fn gather<P: Pose, S: Primitive<P, Footprint = SurfaceFootprint>, C: Cell>(
        &self,
        view: &View<P>,
        scene: impl IntoIterator<Item = S>,
        target: &mut CellTarget<C>,
    ) -> (Coverage, Counts) {
        let rules = Rules::SURFACE;
        let (table, traversal) = (table_4::<D>(), self.traversal);
        let painter = SurfacePainter::new(self.design, &rules, table, self.gather, traversal);
        let (mut coverage, mut counts) = (Coverage::default(), Counts::default());
        for splat in scene {
            match splat.set_up(self.design, view, &rules) {
                Ok(footprint) => {
                    counts.drawn = counts.drawn.saturating_add(1);
                    coverage += painter.draw(&footprint, target);
                }
                Err(reason) => counts.reject(reason),
            }
        }
        (coverage, counts)
    }

    fn resolve<C: Cell>(&self, target: &mut CellTarget<C>, pixels: &mut [Pixel]) {
        let window = target.window();
        let (first, columns) = (window.first[0], window.columns());
        let rows = pixels.chunks_mut(usize::from(columns).max(1));
        for (y, row) in (window.first[1]..window.end[1]).zip(rows) {
            let cells = target.row(y, first, columns).iter();
            for ((pixel, cell), x) in row.iter_mut().zip(cells).zip(first..) {
                *pixel = self.resolve.pixel(cell, x, y);
            }
        }
    }
}
