//! Painting tiles by cells of pixels, each at a fixed place in memory, on the processor's widest vectors.
//!
//! In a tile a footprint's rows are computed first, as a list of cells ([`parts`]), of several footprints at once ([`batch`]), and then its
//! pixels, in one of two ways. [`narrow`] puts products together from short ones, sixteen pixels at a time, for designs that are narrow
//! enough; [`fused`] has products of 52 bits, eight pixels at a time, for all. What vectors cannot do is left to the kernel's painter. The
//! vectors' code knows a design only by its numbers, so that one compiled copy serves all.

mod batch;
mod fused;
mod intervals;
mod narrow;
mod parts;
mod products;
mod scale;
mod tile;

use super::lanes::fused::{FusedLanes, FusedTask};
use super::lanes::narrow::Narrow;
use super::lanes::{VectorLevel, prefetch};
use super::paint::{CHECK_INTERVAL, PaintScratch, Results, TableMemory, TilePainter};
use super::rows::is_tame;
use batch::{Batch, CellFootprint};
pub use intervals::TableReach;
use parts::CellPart;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Design, Lane, Traversal, Widths};
use splatline::kernel::FootprintTable;
use splatline::raster::{EllipseSpans, Window};
use splatline::rules::{Compositing, Rules};
use splatline::setup::Cull;
use splatline::target::Target;
use tile::{CellTile, PixelFormat, TileGroup};

/// Painters for any design, and for narrow ones.
pub type FusedPainter<D> = CellPainter<D, fused::FusedScheme>;
/// See [`FusedPainter`].
pub type NarrowPainter<D> = CellPainter<D, narrow::NarrowScheme>;

/// How many footprints ahead memory is asked for: lists name them in an order that no cache foresees.
const AHEAD: usize = 4;

/// A thread's memory.
#[derive(Clone, Debug, Default)]
pub struct CellTiles {
    fused: Option<TileOf<fused::FusedScheme>>,
    narrow: Option<TileOf<narrow::NarrowScheme>>,
}

type TileOf<P> = CellTile<<P as PixelScheme>::PixelGroup, <P as PixelScheme>::PixelFormat>;

/// One way of computing pixels: makes of footprints what it needs of them. The same for a whole picture.
pub trait PixelScheme: Send + Sync + Sized {
    type PixelGroup: TileGroup;
    type PixelFormat: PixelFormat<Word = <Self::PixelGroup as TileGroup>::Word>;
    /// What a footprint's pixels need beside its rows.
    type SplatNumbers: Copy + Default;

    /// For widths and a table that this way can do, in lanes of so many bits.
    fn new(widths: &Widths, rules: &Rules, table: &FootprintTable, lane_bits: u32) -> Option<Self>;

    /// How pixels are written in a tile.
    fn format(&self) -> Self::PixelFormat;

    /// The thread's tile.
    fn tile(tiles: &mut CellTiles) -> &mut Option<TileOf<Self>>;

    /// A footprint's numbers; `None` if its words lie outside their formats or its end outside the table.
    fn numbers(&self, footprint: &Footprint) -> Option<Self::SplatNumbers>;

    /// Chooses the compiled copy that paints a tile. Implement with `#[inline(always)]`, as everything it calls.
    fn run<L: Narrow>(lanes: L, painting: CellPainting<Self>) -> Coverage;
}

/// The pixels of a scheme on vectors, with everything that is constant for a picture. All methods with `#[inline(always)]`.
pub trait PixelMethod<L: Narrow>: Copy {
    type PixelGroup: TileGroup;
    type SplatNumbers: Copy + Default;
    /// A numbers on vectors.
    type SplatWords: Copy;
    /// Pixels counted, lane by lane.
    type Counts: Copy;

    /// A numbers on vectors, for rows with this second difference.
    fn splat_words(&self, numbers: &Self::SplatNumbers, second: i64) -> Self::SplatWords;
    /// Paints what a footprint covers of a cell.
    fn paint(
        &self,
        colours: &Self::SplatWords,
        part: &CellPart,
        cell: &mut Self::PixelGroup,
        counts: &mut Self::Counts,
    );
    /// No pixels.
    fn no_counts(&self) -> Self::Counts;
    /// Pixels covered, and those of them that were not finished; of one batch.
    fn total(&self, counts: Self::Counts) -> [u64; 2];
}

/// Paints tiles with one scheme.
pub struct CellPainter<D, P> {
    table: TableMemory,
    design: D,
    rules: Rules,
    scheme: P,
    lanes: FusedLanes,
}

impl<D: Design, P: PixelScheme> CellPainter<D, P> {
    /// A painter for a design and rules; `None` under widths or on a processor that the scheme cannot do.
    pub fn new(design: D, rules: &Rules, choice: VectorLevel) -> Option<Self> {
        if choice != VectorLevel::Best {
            return None;
        }
        Self::on(design, rules, FusedLanes::detect()?)
    }

    /// The same on these lanes.
    pub fn on(design: D, rules: &Rules, lanes: FusedLanes) -> Option<Self> {
        let table = TableMemory::new(&design.widths(), rules);
        let scheme = P::new(&design.widths(), rules, &table.table(), D::Lane::BITS)?;
        Some(CellPainter {
            table,
            design,
            rules: *rules,
            scheme,
            lanes,
        })
    }
}

impl<D: Design + Send + Sync, P: PixelScheme> TilePainter for CellPainter<D, P> {
    fn paint(
        &self,
        scratch: &mut PaintScratch,
        window: Window,
        footprints: &Results,
        list: &[u32],
        pixels: &mut [Pixel],
    ) -> Coverage {
        let format = self.scheme.format();
        let tile = P::tile(&mut scratch.cells).get_or_insert_with(|| CellTile::new(format));
        self.lanes.run(CellPainting {
            scheme: &self.scheme,
            rules: &self.rules,
            prepare: &|list| self.prepare(footprints, list, &window),
            scalar: &|index, tile| self.paint_scalar(&footprints[index as usize], tile),
            tile,
            window,
            clear: Pixel::clear(&self.design.widths()),
            list,
            pixels,
        })
    }
}

impl<D: Design, P: PixelScheme> CellPainter<D, P> {
    /// What the list's first footprint is computed from within the window, if it has one and vectors can draw it.
    fn prepare(
        &self,
        footprints: &Results,
        list: &[u32],
        window: &Window,
    ) -> Option<CellFootprint<P::SplatNumbers>> {
        let footprint = |index: &u32| &footprints[*index as usize];
        if let Some(next) = list.get(AHEAD) {
            prefetch(footprint(next));
        }
        let footprint = footprint(list.first()?).as_ref().ok()?;
        let rows = EllipseSpans::new(self.design, footprint, window)
            .constants()
            .widened();
        let numbers = self.scheme.numbers(footprint)?;
        is_tame(&rows).then_some(CellFootprint { rows, numbers })
    }

    /// The scalar painter on the tile's pixels.
    #[cold]
    #[inline(never)]
    fn paint_scalar(&self, footprint: &Result<Footprint, Cull>, tile: &mut TileOf<P>) -> Coverage {
        let mut pixels = tile.to_pixels();
        let window = tile.window();
        let stride = usize::from(window.end[0] - window.first[0]);
        let target = Target::new(&mut pixels, window, stride);
        let (Ok(footprint), Ok(mut target)) = (footprint, target) else {
            return Coverage::default();
        };
        let (table, order) = (self.table.table(), Compositing::FrontToBack);
        let painter = Painter::new(self.design, &self.rules, table, order, Traversal::Spans);
        let coverage = painter.draw(footprint, &mut target);
        tile.set_pixels(&pixels);
        coverage
    }
}

/// Gives what is needed of the footprint that a list begins with; nothing if vectors cannot draw it.
pub type Prepare<'a, B> = dyn Fn(&[u32]) -> Option<CellFootprint<B>> + 'a;

/// A tile to be painted, by whatever vectors.
pub struct CellPainting<'a, P: PixelScheme> {
    scheme: &'a P,
    rules: &'a Rules,
    prepare: &'a Prepare<'a, P::SplatNumbers>,
    /// Paints the footprint of this number by the kernel.
    scalar: &'a dyn Fn(u32, &mut TileOf<P>) -> Coverage,
    tile: &'a mut TileOf<P>,
    window: Window,
    clear: Pixel,
    list: &'a [u32],
    /// The tile's pixels, row by row.
    pixels: &'a mut [Pixel],
}

impl<P: PixelScheme> FusedTask for CellPainting<'_, P> {
    type Output = Coverage;

    #[inline(always)]
    fn run<L: Narrow>(self, lanes: L) -> Coverage {
        P::run(lanes, self)
    }
}

impl<P: PixelScheme> CellPainting<'_, P> {
    /// Paints the tile, with pixels of this path.
    #[inline(always)]
    fn paint<L, Method, const DEEP: bool, const ROWS: usize>(
        self,
        lanes: L,
        path: &Method,
    ) -> Coverage
    where
        L: Narrow,
        Method: PixelMethod<L, PixelGroup = P::PixelGroup, SplatNumbers = P::SplatNumbers>,
    {
        let CellPainting {
            scheme,
            prepare,
            scalar,
            tile,
            window,
            clear,
            list,
            pixels,
            ..
        } = self;
        const { assert!(<P::PixelGroup as TileGroup>::ROWS == ROWS) };
        let mut coverage = Coverage::default();
        let mut batch = Batch::<P::SplatNumbers, DEEP, ROWS>::new();
        tile.open(window, clear, scheme.format());
        for chunk in list.chunks(CHECK_INTERVAL) {
            let mut rest = chunk;
            while let Some((first, others)) = rest.split_first() {
                let listed = match tile.cells() {
                    Some(cells) => {
                        let listed = batch.fill(lanes, rest, prepare, &window);
                        coverage += batch.paint(path, listed, cells);
                        listed
                    }
                    None => 0,
                };
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
        let columns = usize::from(window.end[0] - window.first[0]).max(1);
        tile.copy(pixels.chunks_exact_mut(columns));
        coverage
    }
}
