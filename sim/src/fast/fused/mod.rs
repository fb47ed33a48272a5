//! Painting tiles with fused products of 52 bits, in any design.
//!
//! Of a footprint everything that does not depend on the tile is computed once per picture ([`Prepared`]): the constants of its rows and of its
//! pixels. What vectors cannot do in a tile is left to the kernel's painter. The vectors' code knows a design only by its numbers, so
//! that one compiled copy serves all that have lanes of the same depth.

mod pixels;
mod scale;
mod tile;

use super::lanes::Choice;
use super::lanes::fused::{Fused, FusedJob, dispatch_fused, has_fused};
use super::paint::{CHECK_INTERVAL, Results, Scratch, TilePainter};
use super::rows::RowBatch;
use pixels::{Brush, Palette, PixelPath};
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Design, Lane, Traversal};
use splatline::kernel::FootprintTable;
use splatline::raster::{RowConstants, SpanRows, Window};
use splatline::rules::{Compositing, Rules};
use splatline::setup::Cull;
use splatline::target::Target;
pub use tile::Tile;

/// How many footprints ahead memory is asked for: lists name them in an order that no cache foresees.
const AHEAD: usize = 4;

/// What a footprint's rows and pixels are computed from, in every tile.
#[derive(Clone, Copy, Debug)]
struct Prepared {
    rows: RowConstants<i64>,
    brush: Brush,
}

/// Everything that is constant for a picture.
pub struct FusedPainter<'a, D> {
    scalar: Painter<'a, D>,
    design: D,
    rules: Rules,
    palette: Palette,
    prepared: Vec<Option<Prepared>>,
    portable: bool,
}

impl<'a, D: Design + Sync> FusedPainter<'a, D> {
    /// A painter of these footprints; `None` under widths or on a processor whose products are not fused.
    pub fn new(
        design: D,
        rules: &Rules,
        table: FootprintTable<'a>,
        choice: Choice,
        footprints: &Results,
    ) -> Option<Self> {
        (choice == Choice::Best && has_fused()).then_some(())?;
        Self::on(design, rules, table, footprints, false)
    }

    /// The same, on arrays if asked for.
    pub fn on(
        design: D,
        rules: &Rules,
        table: FootprintTable<'a>,
        footprints: &Results,
        portable: bool,
    ) -> Option<Self> {
        let palette = Palette::new(&design.widths(), rules, &table, D::Lane::BITS)?;
        let prepare = |footprint: &Footprint| {
            let window = Window {
                first: footprint.first,
                last: footprint.last,
            };
            let rows = SpanRows::new(design, footprint, &window).constants();
            Some(Prepared {
                rows: rows.widened(),
                brush: palette.brush(footprint)?,
            })
        };
        let prepared = footprints
            .par_iter()
            .with_min_len(1024)
            .map(|footprint| prepare(footprint.as_ref().ok()?))
            .collect();
        let (order, traversal) = (Compositing::FrontToBack, Traversal::Spans);
        Some(FusedPainter {
            scalar: Painter::new(design, rules, table, order, traversal),
            design,
            rules: *rules,
            palette,
            prepared,
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
        tile.open(window, Pixel::clear(&self.design.widths()));
        let coverage = dispatch_fused(
            self.portable,
            Painting {
                palette: &self.palette,
                rules: &self.rules,
                prepared: &self.prepared,
                scalar: &|index, tile| self.paint_scalar(&footprints[index as usize], tile),
                tile,
                list,
                deep: D::Lane::BITS > 32,
            },
        );
        for (y, row) in rows.iter_mut().enumerate() {
            tile.copy_row(y, row);
        }
        coverage
    }
}

impl<D: Design> FusedPainter<'_, D> {
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
struct Painting<'a> {
    palette: &'a Palette,
    rules: &'a Rules,
    prepared: &'a [Option<Prepared>],
    /// Paints the footprint of this number by the kernel.
    scalar: &'a dyn Fn(u32, &mut Tile) -> Coverage,
    tile: &'a mut Tile,
    list: &'a [u32],
    deep: bool,
}

impl FusedJob for Painting<'_> {
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

impl Painting<'_> {
    #[inline(always)]
    fn paint<L: Fused, const STOP_BEFORE: bool, const DEEP: bool>(self, lanes: L) -> Coverage {
        let Painting {
            palette,
            rules,
            prepared,
            scalar,
            tile,
            list,
            ..
        } = self;
        let path = PixelPath::<L, STOP_BEFORE, DEEP>::new(lanes, palette, rules);
        let mut coverage = Coverage::default();
        let mut batch = RowBatch::new();
        let window = tile.window();
        for part in list.chunks(CHECK_INTERVAL) {
            for (number, index) in part.iter().enumerate() {
                if let Some(next) = part.get(number + AHEAD) {
                    lanes.fetch(&prepared[*next as usize]);
                }
                let Some(Prepared { rows, brush }) = &prepared[*index as usize] else {
                    coverage += scalar(*index, tile);
                    continue;
                };
                let rows = rows.within(&window);
                if !batch.fill(lanes, &rows, window.first[0]) {
                    coverage += scalar(*index, tile);
                    continue;
                }
                let colours = path.colours(brush, rows.second);
                let planes = tile.rows_from(rows.rows[0]);
                for (row, plane) in planes.iter_mut().take(batch.rows()).enumerate() {
                    for block in batch.touched() {
                        if let Some(run) = batch.seeds(row, block) {
                            let x = run.x - usize::from(window.first[0]);
                            path.paint(&colours, run.seed, x, run.length, plane, &mut coverage);
                        }
                    }
                }
            }
            if tile.is_finished() {
                break;
            }
        }
        coverage
    }
}
