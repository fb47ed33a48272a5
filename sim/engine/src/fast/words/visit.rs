//! Opacities of pixels on words, for compositing that keeps more or other things than a pixel's colour and
//! transmittance.
//!
//! What [`Painter::visit`](splatline::draw::Painter::visit) gives, bit for bit, a run at a time: rows and opacities are
//! those of painting, and whoever asked composites them.

use super::numbers::{EVEN, PathNumbers};
use super::path::{PixelPath, SplatWords, WordPixels};
use crate::fast::lanes::{Lanes, VectorLevel, VectorTask, dispatch_pixels};
use crate::fast::row_group::RowGroup;
use crate::fast::rows::{Pixels, RowBatch};
use crate::fast::tile::TILE;
use splatline::footprint::Footprint;
use splatline::raster::Window;

/// Takes a footprint's number and the opacities of adjacent pixels from a column and row of the screen on, UQ1.alpha; 0
/// where a pixel is transparent.
pub type TakeOpacities<'a> = dyn FnMut(u32, [u16; 2], &[i64]) + 'a;

/// Visits one footprint by the kernel.
pub type VisitAlone<'a> = dyn Fn(u32, &mut TakeOpacities) + 'a;

/// Footprints' pixels to be visited along spans.
pub struct VisitTask<'a> {
    pub path: &'a PathNumbers,
    /// At most a [`TILE`]; begins a block.
    pub window: Window,
    pub footprints: &'a [Footprint],
    /// The footprints, in this order.
    pub list: &'a [u32],
    /// What vectors cannot do is visited by it.
    pub alone: &'a VisitAlone<'a>,
    pub take: &'a mut TakeOpacities<'a>,
}

impl VisitTask<'_> {
    /// Visits them on these vectors.
    pub fn visit(self, choice: VectorLevel) {
        if let Err(task) = dispatch_pixels(choice, self) {
            (task.list.iter()).for_each(|index| (task.alone)(*index, task.take));
        }
    }
}

impl VectorTask for VisitTask<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let path = self.path;
        let pixels = WordPixels::<L, EVEN>::new(lanes, path);
        let (mut group, mut batch) = (RowGroup::default(), RowBatch::new());
        let mut memory = [0; ROOM];
        let left = self.window.first[0];
        for indices in self.list.chunks(L::WIDE) {
            for (k, index) in indices.iter().enumerate() {
                group.read(k, &self.footprints[*index as usize], &self.window);
            }
            let together = group.compute(lanes, &path.rows.widths(), left);
            for (k, index) in indices.iter().enumerate() {
                let footprint = &self.footprints[*index as usize];
                let of_group = (&together, &group, k);
                if let Some(numbers) = path.splat(footprint)
                    && let Some((first, second)) =
                        batch.fill(&path.rows, of_group, footprint, (&self.window, left))
                {
                    let splat = pixels.splat(&numbers, second);
                    for row in 0..batch.rows() {
                        for block in batch.touched() {
                            if let Some(run) = batch.block(block).run(row, left) {
                                let place = [left + run.x as u16, first + row as u16];
                                opacities(&pixels, &splat, &run, &mut memory);
                                (self.take)(*index, place, &memory[..run.length]);
                            }
                        }
                    }
                } else {
                    (self.alone)(*index, self.take);
                }
            }
        }
    }
}

/// Words of a run, and what a vector may write beyond it.
const ROOM: usize = TILE[0] as usize + 8;

/// Writes the opacities of a run's pixels.
#[inline(always)]
fn opacities<L: Lanes>(
    pixels: &WordPixels<L, EVEN>,
    splat: &SplatWords<L>,
    run: &Pixels,
    opacities: &mut [i64; ROOM],
) {
    let lanes = pixels.lanes();
    let mut radial = pixels.start(splat, run);
    for from in (0..run.length).step_by(L::WIDE) {
        let inside = pixels.inside(splat, radial[0], run.length - from);
        lanes.write(opacities, from, pixels.alpha(splat, radial[0], inside));
        radial = pixels.step(splat, radial);
    }
}
