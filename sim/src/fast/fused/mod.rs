//! Painting tiles with fused products of 52 bits, in any design.
//!
//! In a tile a footprint's rows are computed first, as a list of cells ([`cells`]), of several footprints at once ([`batch`]), and then its
//! pixels ([`pixels`]). What vectors cannot do is left to the kernel's painter. The vectors' code knows a design only by its numbers, so
//! that one compiled copy serves all that have lanes of the same depth.

mod batch;
mod cells;
mod pixels;
mod scale;
mod tile;

use super::lanes::fused::{Fused, FusedJob, dispatch_fused, has_fused};
use super::lanes::{Choice, prefetch};
use super::paint::{CHECK_INTERVAL, Results, Scratch, TilePainter};
use super::rows::is_tame;
use batch::{Batch, Prepared};
use pixels::{Counts, Palette, PixelPath};
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Design, Lane, Traversal};
use splatline::kernel::FootprintTable;
use splatline::raster::{SpanRows, Window};
use splatline::rules::{Compositing, Rules};
use splatline::setup::Cull;
use splatline::target::Target;
pub use tile::Tile;

/// How many footprints ahead memory is asked for: lists name them in an order that no cache foresees.
const AHEAD: usize = 4;

/// Everything that is constant for a picture.
pub struct FusedPainter<'a, D> {
    scalar: Painter<'a, D>,
    design: D,
    rules: Rules,
    palette: Palette,
    portable: bool,
}

impl<'a, D: Design + Sync> FusedPainter<'a, D> {
    /// A painter for a design and rules; `None` under widths or on a processor whose products are not fused.
    pub fn new(
        design: D,
        rules: &Rules,
        table: FootprintTable<'a>,
        choice: Choice,
    ) -> Option<Self> {
        (choice == Choice::Best && has_fused()).then_some(())?;
        Self::on(design, rules, table, false)
    }

    /// The same, on arrays if asked for.
    pub fn on(design: D, rules: &Rules, table: FootprintTable<'a>, portable: bool) -> Option<Self> {
        let palette = Palette::new(&design.widths(), rules, &table, D::Lane::BITS)?;
        let (order, traversal) = (Compositing::FrontToBack, Traversal::Spans);
        Some(FusedPainter {
            scalar: Painter::new(design, rules, table, order, traversal),
            design,
            rules: *rules,
            palette,
            portable,
        })
    }
}

impl<D: Design + Sync> TilePainter for FusedPainter<'_, D> {
    fn paint(
        &self,
        scratch: &mut Scratch,
        window: Window,
        footprints: &Results,
        list: &[u32],
        rows: &mut [&mut [Pixel]],
    ) -> Coverage {
        let tile = scratch
            .fused
            .get_or_insert_with(|| Tile::new(self.palette.scale));
        dispatch_fused(
            self.portable,
            Painting {
                palette: &self.palette,
                rules: &self.rules,
                prepare: &|list| self.prepare(footprints, list, &window),
                scalar: &|index, tile| self.paint_scalar(&footprints[index as usize], tile),
                tile,
                window,
                clear: Pixel::clear(&self.design.widths()),
                list,
                frame: rows,
                deep: D::Lane::BITS > 32,
            },
        )
    }
}

impl<D: Design> FusedPainter<'_, D> {
    /// What the list's first footprint is computed from within the window, if it has one and vectors can draw it.
    fn prepare(&self, footprints: &Results, list: &[u32], window: &Window) -> Option<Prepared> {
        let footprint = |index: &u32| &footprints[*index as usize];
        if let Some(next) = list.get(AHEAD) {
            prefetch(footprint(next));
        }
        let footprint = footprint(list.first()?).as_ref().ok()?;
        let rows = SpanRows::new(self.design, footprint, window)
            .constants()
            .widened();
        let brush = self.palette.brush(footprint)?;
        is_tame(&rows).then_some(Prepared { rows, brush })
    }

    /// The scalar painter on the tile's pixels.
    #[cold]
    #[inline(never)]
    fn paint_scalar(&self, footprint: &Result<Footprint, Cull>, tile: &mut Tile) -> Coverage {
        let mut pixels = tile.to_pixels();
        let window = tile.window();
        let stride = usize::from(window.last[0] - window.first[0]);
        let target = Target::new(&mut pixels, window, stride);
        let (Ok(footprint), Ok(mut target)) = (footprint, target) else {
            return Coverage::default();
        };
        let coverage = self.scalar.draw(footprint, &mut target);
        tile.set_pixels(&pixels);
        coverage
    }
}

/// A tile to be painted, by whatever vectors.
struct Painting<'a, 'f> {
    palette: &'a Palette,
    rules: &'a Rules,
    /// What is needed of the footprint that this list begins with.
    prepare: &'a dyn Fn(&[u32]) -> Option<Prepared>,
    /// Paints the footprint of this number by the kernel.
    scalar: &'a dyn Fn(u32, &mut Tile) -> Coverage,
    tile: &'a mut Tile,
    window: Window,
    clear: Pixel,
    list: &'a [u32],
    /// The tile's rows of the frame.
    frame: &'a mut [&'f mut [Pixel]],
    deep: bool,
}

impl FusedJob for Painting<'_, '_> {
    type Output = Coverage;

    #[inline(always)]
    fn run<L: Fused>(self, lanes: L) -> Coverage {
        match (self.rules.stop_before, self.deep) {
            (true, false) => self.paint::<L, true, false>(lanes),
            (false, false) => self.paint::<L, false, false>(lanes),
            (true, true) => self.paint::<L, true, true>(lanes),
            (false, true) => self.paint::<L, false, true>(lanes),
        }
    }
}

impl Painting<'_, '_> {
    #[inline(always)]
    fn paint<L: Fused, const STOP_BEFORE: bool, const DEEP: bool>(self, lanes: L) -> Coverage {
        let Painting {
            palette,
            rules,
            prepare,
            scalar,
            tile,
            window,
            clear,
            list,
            frame,
            ..
        } = self;
        let path = PixelPath::<L, STOP_BEFORE, DEEP>::new(lanes, palette, rules);
        let mut coverage = Coverage::default();
        let mut counts = Counts::new(lanes);
        let mut batch = Batch::<DEEP>::new();
        tile.open(window, clear, palette.scale);
        for chunk in list.chunks(CHECK_INTERVAL) {
            let mut rest = chunk;
            while let Some((first, others)) = rest.split_first() {
                let listed = batch.fill(lanes, rest, prepare, &window);
                batch.paint(&path, listed, tile, &mut counts);
                rest = if listed == 0 {
                    coverage += scalar(*first, tile);
                    others
                } else {
                    &rest[listed..]
                };
            }
            if tile.is_finished() {
                break;
            }
        }
        tile.copy(frame.iter_mut().map(|row| &mut **row));
        coverage += counts.coverage(lanes, batch.visited());
        coverage
    }
}
