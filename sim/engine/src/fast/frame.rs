//! A picture's way through the stages, in memory that the next picture uses again.
//!
//! ```text
//! parts of the scene: setup, keys -> tile lists -> tiles, each in a place of its own -> frame of the caller's pixels
//! ```
//!
//! A deep scene takes this way slice by slice ([`depth_first`](super::depth_first)), and tiles are then resumed.
//!
//! Fresh memory costs as much as drawing: its first touch is a trap for every 4 KB. So nothing is allocated once a
//! frame has been drawn, and setup notes what ordering needs while the footprints are still in the cache. Tiles are
//! painted one after the other in memory and brought into the frame's rows afterwards, because the caller's pixels are
//! converted there anyway.

use super::TILE;
use super::depth_first::{DepthFirst, LiveBlocks, Slices, live_blocks};
use super::order::{Grid, Key, TileOrder, part_length};
use super::painter::{PaintScratch, Results, Start, TilePainter, TileWork};
use super::setup::Outcome;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::Coverage;
use splatline::footprint::Footprint;
use splatline::raster::Window;
use splatline::setup::Cull;
use splatline::splat::VolumeSplat;
use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

/// Pixels of a tile.
pub(crate) const AREA: usize = TILE[0] as usize * TILE[1] as usize;

/// Splats of a slice that are brought together for setup.
const GATHERED: usize = 64;

thread_local! {
    /// A thread's memory for the tile that it paints, kept from frame to frame.
    static SCRATCH: RefCell<PaintScratch> = RefCell::default();
}

/// Wall-clock seconds of each part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    /// Quantised splats to footprints.
    pub setup: f64,
    /// Depth order and tile lists.
    pub sort: f64,
    /// Footprints to pixels.
    pub raster: f64,
}

/// Splats culled, by reason, in the order of [`Cull::ALL`].
pub type CullCounts = [usize; Cull::ALL.len()];

/// What a frame did beside its pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameFacts {
    /// Splats culled, by reason.
    pub culled: CullCounts,
    /// Splats that were not set up, because no pixel in work was in their reach.
    pub left_out: usize,
    /// Pixels visited and covered.
    pub coverage: Coverage,
    /// Time taken.
    pub times: Times,
}

/// The caller did not want the frame to be finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("drawing was cancelled")]
pub struct Cancelled;

/// Is told how many of how many steps are done; `false` leaves the rest of the frame undone. Called from any thread.
pub type Progress<'a> = dyn Fn(usize, usize) -> bool + Sync + 'a;

/// Sets up some splats, numbered from the first, into as many places.
pub type SetUpPart<'a> = dyn Fn(usize, &[VolumeSplat], &mut [Outcome]) + Sync + 'a;

/// How splats become pixels: the same for all frames of a scene but for the view.
#[derive(Clone, Copy)]
pub struct FramePlan<'a> {
    /// Columns and rows of the frame.
    pub viewport: [u16; 2],
    /// Are the farthest splats painted first?
    pub back_to_front: bool,
    /// Are splats left out that finished pixels alone would see? They have no outcome, and setup gets the others by
    /// other numbers than the scene's.
    pub depth_first: Option<DepthFirst<'a>>,
    /// Setup of some splats, numbered from the first, into as many places.
    pub set_up: &'a SetUpPart<'a>,
    /// Paints a tile.
    pub painter: &'a dyn TilePainter,
    /// Is told about the frame's progress.
    pub progress: &'a Progress<'a>,
}

/// The memory of frames.
#[derive(Clone, Debug, Default)]
pub struct FrameMemory {
    outcomes: Vec<Outcome>,
    order: TileOrder,
    slices: Slices,
    live: LiveBlocks,
    /// Tile after tile, each row by row.
    pixels: Vec<Pixel>,
    viewport: [u16; 2],
}

/// A frame on its way: counts its steps and notes when the caller has had enough.
struct FrameSteps<'a> {
    plan: &'a FramePlan<'a>,
    grid: Grid,
    done: AtomicUsize,
    of: usize,
    cancelled: AtomicBool,
}

impl FrameSteps<'_> {
    /// Does one step, unless the frame has been cancelled.
    fn step<T: Default>(&self, work: impl FnOnce() -> T) -> T {
        if self.cancelled.load(Ordering::Relaxed) {
            return T::default();
        }
        let result = work();
        let done = 1 + self.done.fetch_add(1, Ordering::Relaxed);
        if !(self.plan.progress)(done, self.of) {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        result
    }

    fn check(&self) -> Result<(), Cancelled> {
        if self.cancelled.load(Ordering::Relaxed) {
            Err(Cancelled)
        } else {
            Ok(())
        }
    }
}

impl FrameMemory {
    /// Draws a frame of the splats, which [`copy`](FrameMemory::copy) hands out. The caller's rayon pool decides the
    /// number of threads.
    pub fn draw(
        &mut self,
        splats: &[VolumeSplat],
        plan: &FramePlan,
    ) -> Result<FrameFacts, Cancelled> {
        let started = Instant::now();
        let grid = Grid::new(plan.viewport, TILE);
        self.live.open(plan.viewport);
        let sliced = (plan.depth_first.as_ref())
            .is_some_and(|front| self.slices.cut(front, splats, plan.set_up, &self.live));
        let slices = if sliced { self.slices.count() } else { 1 };
        let parts = splats.len().div_ceil(part_length(splats.len()));
        let steps = FrameSteps {
            plan,
            done: AtomicUsize::new(0),
            of: if sliced {
                slices * grid.len()
            } else {
                parts + grid.len()
            },
            cancelled: AtomicBool::new(false),
            grid,
        };
        let mut facts = FrameFacts::default();
        let painted = if slices == 1 {
            facts.culled = self.set_up(splats, &steps);
            self.order_and_paint(&steps, (Start::Clear, true), &mut facts)
        } else {
            self.draw_slices(splats, &steps, &mut facts)
        };
        painted?;
        let whole = started.elapsed().as_secs_f64();
        facts.times.setup = whole - facts.times.sort - facts.times.raster;
        Ok(facts)
    }

    /// From the front, slice by slice, those of its splats that may reach a pixel in work.
    fn draw_slices(
        &mut self,
        splats: &[VolumeSplat],
        steps: &FrameSteps,
        facts: &mut FrameFacts,
    ) -> Result<(), Cancelled> {
        facts.left_out = splats.len();
        for slice in 0..self.slices.count() {
            let seen = self.slices.seen(slice, &self.live);
            facts.left_out -= seen.len();
            self.outcomes.resize(seen.len(), Err(Cull::Near));
            let culled = self.order.fill(
                seen,
                &mut self.outcomes,
                &|work| work(),
                &|seen, outcomes, first, keys| {
                    let groups = seen.chunks(GATHERED).zip(outcomes.chunks_mut(GATHERED));
                    for (seen, outcomes) in groups {
                        let mut group = [VolumeSplat::EMPTY; GATHERED];
                        for (splat, index) in group.iter_mut().zip(seen) {
                            *splat = splats[*index as usize];
                        }
                        (steps.plan.set_up)(first, &group[..seen.len()], outcomes);
                    }
                    note(outcomes, first, keys, by_depth)
                },
                add_counts,
            );
            facts.culled = add_counts(facts.culled, culled);
            let last = slice + 1 == self.slices.count();
            let start = if slice == 0 {
                Start::Clear
            } else {
                Start::Resumed
            };
            self.order_and_paint(steps, (start, last), facts)?;
            if !last {
                self.live.sum();
            }
        }
        Ok(())
    }

    /// Orders what has been set up, and paints it into the tiles, whose last footprints they are or not.
    fn order_and_paint(
        &mut self,
        steps: &FrameSteps,
        (start, last): (Start, bool),
        facts: &mut FrameFacts,
    ) -> Result<(), Cancelled> {
        steps.check()?;
        let started = Instant::now();
        self.order.sort(&steps.grid);
        if steps.plan.back_to_front {
            self.order.reverse();
        }
        let sorted = started.elapsed().as_secs_f64();
        facts.coverage += self.paint(steps, (start, last));
        facts.times.sort += sorted;
        facts.times.raster += started.elapsed().as_secs_f64() - sorted;
        steps.check()
    }

    /// What setup made of every splat of the last frame, in the scene's order; of its last slice alone if splats were
    /// left out.
    pub fn outcomes(&self) -> &Results {
        &self.outcomes
    }

    /// The same, to keep.
    pub fn into_outcomes(self) -> Vec<Outcome> {
        self.outcomes
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.outcomes.capacity() * size_of::<Outcome>()
            + self.pixels.capacity() * size_of::<Pixel>()
            + self.order.bytes()
            + self.slices.bytes()
            + self.live.bytes()
    }

    fn set_up(&mut self, splats: &[VolumeSplat], steps: &FrameSteps) -> CullCounts {
        if self.outcomes.len() != splats.len() {
            // In parallel: most of its time is the first touch of its memory.
            self.outcomes = splats.par_iter().map(|_| Err(Cull::Near)).collect();
        }
        self.order.fill(
            splats,
            &mut self.outcomes,
            &|work| steps.step(work),
            &|splats, outcomes, first, keys| {
                (steps.plan.set_up)(first, splats, outcomes);
                note(outcomes, first, keys, by_depth)
            },
            add_counts,
        )
    }

    /// Every tile on some core. Not inlined, so that a profiler can tell it from the rest.
    #[inline(never)]
    fn paint(&mut self, steps: &FrameSteps, (start, last): (Start, bool)) -> Coverage {
        let FrameSteps { plan, grid, .. } = steps;
        let FrameMemory {
            outcomes,
            order,
            pixels,
            viewport,
            live,
            ..
        } = self;
        *viewport = plan.viewport;
        pixels.resize(grid.len() * AREA, Pixel::default());
        // One by one: a thread that has drawn its own empty ones takes over from another's full ones.
        let tiles = pixels.par_chunks_mut(AREA).zip(&mut live.tiles);
        let tiles = tiles.enumerate().with_max_len(1);
        tiles
            .map(|(tile, (pixels, live))| {
                let window = grid.window(tile);
                let pixels = &mut pixels[..window.pixels()];
                steps.step(|| {
                    let list = order.list(tile);
                    if start == Start::Resumed && (list.is_empty() || *live == 0) {
                        return Coverage::default();
                    }
                    let work = TileWork {
                        window,
                        footprints: outcomes,
                        list,
                        start,
                        pixels: &mut *pixels,
                    };
                    let coverage =
                        SCRATCH.with_borrow_mut(|scratch| plan.painter.paint(scratch, work));
                    if !last {
                        *live = live_blocks(&window, pixels);
                    }
                    coverage
                })
            })
            .reduce(Coverage::default, |mut sum, part| {
                sum += part;
                sum
            })
    }

    /// The last frame's pixels, row by row.
    pub fn pixels(&self) -> Vec<Pixel> {
        let [columns, rows] = self.viewport.map(usize::from);
        let mut pixels = vec![Pixel::default(); columns * rows];
        self.copy(&mut pixels, |pixel| *pixel);
        pixels
    }

    /// The last frame's pixels, row by row, as the caller wants them. A frame of another size is filled as far as it
    /// goes.
    pub fn copy<T: Send>(&self, frame: &mut [T], convert: impl Fn(&Pixel) -> T + Sync) {
        copy_tiles(&self.pixels, self.viewport, frame, convert);
    }
}

/// Tiles one after the other, each row by row in a place of its own, as a frame's rows. A frame of another size is
/// filled as far as it goes.
pub(crate) fn copy_tiles<P: Sync, T: Send>(
    tiles: &[P],
    viewport: [u16; 2],
    frame: &mut [T],
    convert: impl Fn(&P) -> T + Sync,
) {
    let grid = Grid::new(viewport, TILE);
    let width = usize::from(viewport[0]).max(1);
    let columns = viewport[0].div_ceil(TILE[0]).into();
    let bands = frame.par_chunks_mut(width * usize::from(TILE[1]));
    bands.enumerate().for_each(|(band, rows)| {
        for tile in (band * columns..).take(columns) {
            let window = grid.window(tile);
            let pixels = tiles.get(tile * AREA..).unwrap_or_default();
            let from = pixels.chunks_exact(usize::from(window.columns()).max(1));
            for (row, from) in rows.chunks_mut(width).zip(from) {
                let to = row.iter_mut().skip(window.first[0].into());
                to.zip(from).for_each(|(to, from)| *to = convert(from));
            }
        }
    });
}

/// The sum of two parts' counts.
pub(crate) fn add_counts(mut sum: CullCounts, part: CullCounts) -> CullCounts {
    let sums = sum.iter_mut().zip(part);
    sums.for_each(|(sum, part)| *sum += part);
    sum
}

/// Lists the keys of the splats that are drawn, numbered from `first`, and counts the culled ones. `key` gives the
/// depth and bounds of one that has a footprint; none if it is not drawn after all.
pub(crate) fn note<T>(
    outcomes: &[Result<T, Cull>],
    first: usize,
    keys: &mut Vec<Key>,
    mut key: impl FnMut(&T) -> Option<(u64, Window)>,
) -> CullCounts {
    let mut culled = CullCounts::default();
    for (outcome, index) in outcomes.iter().zip(first as u32..) {
        match outcome.as_ref().map(&mut key) {
            Ok(Some((depth, bounds))) if !bounds.is_empty() => keys.push(Key {
                depth,
                index,
                bounds,
            }),
            Ok(_) => {}
            Err(reason) => culled[reason.place()] += 1,
        }
    }
    culled
}

/// What a footprint is sorted by, and its bounds.
fn by_depth(footprint: &Footprint) -> Option<(u64, Window)> {
    Some((footprint.depth, Window::of(footprint)))
}
