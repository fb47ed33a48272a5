//! Painting tiles by cells of pixels, each at a fixed place in memory, on the processor's widest vectors.
//!
//! In a tile a footprint's rows are computed first, as a list of cells ([`parts`]), of several footprints at once ([`batch`]), and then its
//! pixels, eight at a time, by products of 52 bits ([`fused`]). What vectors cannot do is left to the kernel's painter. The vectors' code
//! knows a design only by its numbers, so that one compiled copy serves all.

mod batch;
mod fused;
mod intervals;
mod parts;
mod scale;
pub mod tile;

use super::lanes::fused::Fused;
use super::lanes::{FusedLanes, FusedTask, VectorLevel, prefetch};
use super::painter::{CHECK_INTERVAL, PaintScratch, Results, ScalarPainter, Start};
use super::painter::{TilePainter, TileWork};
use super::row_words::is_tame;
use super::setup::Outcome;
use super::words::AHEAD;
use batch::{Batch, CellFootprint, Prepare};
use fused::{FusedPixels, FusedScheme};
pub use intervals::TableReach;
use splatline::blend::Pixel;
use splatline::draw::Coverage;
use splatline::format::{Design, Lane, Traversal};
use splatline::raster::{EllipseSpans, Window};
use splatline::rules::{Compositing, Rules};
use tile::CellTile;

/// Paints tiles by fused products.
pub struct FusedPainter<D> {
    /// For what vectors cannot do.
    kernel: ScalarPainter<D>,
    scheme: FusedScheme,
    lanes: FusedLanes,
    counts: bool,
}

impl<D: Design> FusedPainter<D> {
    /// A painter for a design and rules; `None` under widths or on a processor that cannot. Pixels are counted if
    /// `counts` asks for it.
    pub fn new(design: D, rules: &Rules, choice: VectorLevel, counts: bool) -> Option<Self> {
        if choice != VectorLevel::Best {
            return None;
        }
        Self::on(design, rules, FusedLanes::detect()?, counts)
    }

    /// The same on these lanes.
    pub fn on(design: D, rules: &Rules, lanes: FusedLanes, counts: bool) -> Option<Self> {
        let order = Compositing::FrontToBack;
        let kernel = ScalarPainter::new(design, rules, order, Traversal::Spans);
        let table = kernel.table.table();
        let scheme = FusedScheme::new(&design.widths(), rules, &table, D::Lane::BITS)?;
        Some(FusedPainter {
            kernel,
            scheme,
            lanes,
            counts,
        })
    }

    /// What the list's first footprint is computed from within the window, if it has one and vectors can draw it.
    fn prepare(
        &self,
        footprints: &Results,
        list: &[u32],
        window: &Window,
    ) -> Option<CellFootprint> {
        let footprint = |index: &u32| &footprints[*index as usize];
        if let Some(next) = list.get(AHEAD) {
            prefetch(footprint(next));
        }
        let footprint = footprint(list.first()?).as_ref().ok()?;
        if Window::of(footprint).intersect(window).is_empty() {
            return Some(CellFootprint::default());
        }
        let rows = EllipseSpans::new(self.kernel.design, footprint, window)
            .constants()
            .widened();
        let numbers = self.scheme.numbers(footprint)?;
        is_tame(&rows).then_some(CellFootprint { rows, numbers })
    }

    /// The kernel's painter on the tile's pixels.
    #[cold]
    #[inline(never)]
    fn paint_scalar(&self, footprint: &Outcome, tile: &mut CellTile) -> Coverage {
        let mut pixels = tile.to_pixels();
        let coverage = (self.kernel).paint_alone(footprint, tile.window(), &mut pixels);
        tile.set_pixels(&pixels);
        coverage
    }
}

impl<D: Design + Send + Sync> TilePainter for FusedPainter<D> {
    fn paint(&self, scratch: &mut PaintScratch, work: TileWork) -> Coverage {
        let (scale, footprints) = (self.scheme.scale, work.footprints);
        let tile = scratch.cells.get_or_insert_with(|| CellTile::new(scale));
        let coverage = self.lanes.run(CellPainting {
            scheme: &self.scheme,
            rules: &self.kernel.rules,
            prepare: &|list, live| self.prepare(footprints, list, live),
            scalar: &|index, tile| self.paint_scalar(&footprints[index as usize], tile),
            tile,
            clear: Pixel::clear(&self.kernel.design.widths()),
            counts: self.counts,
            work,
        });
        if self.counts {
            coverage
        } else {
            Coverage::default()
        }
    }
}

/// A tile to be painted, by whatever vectors.
struct CellPainting<'a> {
    scheme: &'a FusedScheme,
    rules: &'a Rules,
    prepare: &'a Prepare<'a>,
    /// Paints the footprint of this number by the kernel.
    scalar: &'a dyn Fn(u32, &mut CellTile) -> Coverage,
    tile: &'a mut CellTile,
    clear: Pixel,
    counts: bool,
    work: TileWork<'a>,
}

impl FusedTask for CellPainting<'_> {
    type Output = Coverage;

    #[inline(always)]
    fn run<L: Fused>(self, lanes: L) -> Coverage {
        match (self.rules.omit_finishing, self.scheme.reach.deep) {
            (true, false) => self.paint::<L, true, false>(lanes),
            (false, false) => self.paint::<L, false, false>(lanes),
            (true, true) => self.paint::<L, true, true>(lanes),
            (false, true) => self.paint::<L, false, true>(lanes),
        }
    }
}

impl CellPainting<'_> {
    #[inline(always)]
    fn paint<L: Fused, const STOP_BEFORE: bool, const DEEP: bool>(self, lanes: L) -> Coverage {
        let CellPainting {
            scheme,
            rules,
            prepare,
            scalar,
            tile,
            clear,
            counts,
            work,
        } = self;
        let TileWork { window, pixels, .. } = work;
        let path = FusedPixels::<L, STOP_BEFORE, DEEP>::new(lanes, scheme, rules);
        let mut coverage = Coverage::default();
        let mut batch = Batch::<DEEP>::new();
        tile.open(window, clear, scheme.scale);
        let mut live = window;
        if work.start == Start::Resumed {
            tile.set_pixels(pixels);
            live = tile.live_window().filter(|_| !counts).unwrap_or(window);
        }
        for chunk in work.list.chunks(CHECK_INTERVAL) {
            let mut rest = chunk;
            while let Some((first, others)) = rest.split_first() {
                let listed = batch.fill(lanes, rest, prepare, &window, &live);
                coverage += batch.paint(&path, listed, tile.cells());
                rest = if listed == 0 {
                    coverage += scalar(*first, tile);
                    others
                } else {
                    &rest[listed..]
                };
            }
            match tile.live_window() {
                Some(_) if counts => {}
                Some(smaller) => live = smaller,
                None => break,
            }
        }
        let columns = usize::from(window.columns()).max(1);
        tile.copy(pixels.chunks_exact_mut(columns));
        coverage
    }
}

/// A product modulo the word of lanes, which have 64 bits if they are `DEEP`; what is above it is anything.
#[inline(always)]
fn multiply<L: Fused, const DEEP: bool>(lanes: L, a: L::Word, b: L::Word) -> L::Word {
    if DEEP {
        lanes.wide_mul_whole(a, b)
    } else {
        lanes.wide_mul(a, b)
    }
}
