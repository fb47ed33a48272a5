//! What gathers a tile's points and resolves its pixels: vectors where they can, else the kernel's painter.

use crate::fast::lanes::VectorLevel;
use crate::fast::surface::{Gather, GatherNumbers, GatherTask, SumTile, SurfaceTile};
use splatline::blend::Pixel;
use splatline::blend::layers::Layers;
use splatline::blend::resolve::Resolve;
use splatline::blend::surface::{Accumulation, Cell, Sample, WeightedSum};
use splatline::draw::Coverage;
use splatline::draw::surface::SurfacePainter;
use splatline::footprint::surface::Attributes;
use splatline::format::RuntimeWidths;
use splatline::raster::Window;
use splatline::target::cells::CellTarget;
use std::any::Any;
use std::marker::PhantomData;

/// A pixel, and the sum of the weights of all its fragments.
#[derive(Clone, Copy, Debug, Default)]
pub struct Resolved {
    pub pixel: Pixel,
    pub weight: u64,
}

/// A thread's memory.
#[derive(Default)]
pub struct SurfaceScratch {
    sums: Option<SumTile>,
    /// A vector of whatever cells were drawn last.
    cells: Option<Box<dyn Any>>,
}

impl SurfaceScratch {
    /// So many empty cells.
    fn cells<C: Cell + 'static>(&mut self, count: usize) -> &mut [C] {
        let cells = self.cells.get_or_insert_with(|| Box::new(Vec::<C>::new()));
        if !cells.is::<Vec<C>>() {
            *cells = Box::new(Vec::<C>::new());
        }
        let Some(cells) = cells.downcast_mut::<Vec<C>>() else {
            unreachable!("cells of another type have just been replaced")
        };
        cells.clear();
        cells.resize(count, C::EMPTY);
        cells
    }
}

/// Paints tiles of a surface, whatever cells.
pub trait SurfaceTiles: Sync {
    /// Gathers a tile's footprints and resolves its pixels row by row. Pixels that were touched, and the number of
    /// those at which fragments had to be merged.
    fn paint(
        &self,
        scratch: &mut SurfaceScratch,
        tile: SurfaceTile,
        resolved: &mut [Resolved],
    ) -> (Coverage, usize);
}

/// A cell type that the host draws into.
pub trait HostCell: Cell + Send + 'static {
    /// Is it what vectors keep as sums?
    const IS_SUM: bool = false;

    /// Pairs of its fragments that had to be merged.
    fn merges(&self) -> u64 {
        0
    }
}

impl HostCell for Accumulation {
    const IS_SUM: bool = true;
}

impl<const L: usize> HostCell for Layers<L> {
    fn merges(&self) -> u64 {
        Layers::merges(self).into()
    }
}

/// What tiles of any cells share.
pub struct TileConstants<'a> {
    pub gather: WeightedSum,
    pub resolve: Resolve<'a>,
    /// What vectors gather by, and which ones do.
    pub numbers: Option<(&'a GatherNumbers, VectorLevel)>,
    /// Are pixels counted?
    pub counts: bool,
}

impl TileConstants<'_> {
    /// The tile's cells as pixels.
    fn resolve<C: Cell>(
        &self,
        window: Window,
        cells: impl Iterator<Item = C>,
        resolved: &mut [Resolved],
    ) {
        let columns = usize::from(window.columns()).max(1);
        for ((index, cell), resolved) in cells.enumerate().zip(resolved) {
            let (x, y) = ((index % columns) as u16, (index / columns) as u16);
            let weights = cell.fragments().iter().map(|f| u64::from(f.weight));
            *resolved = Resolved {
                weight: weights.sum(),
                pixel: (self.resolve).pixel(&cell, window.first[0] + x, window.first[1] + y),
            };
        }
    }
}

/// Tiles of one kind of cell.
pub struct GatherTiles<'a, C> {
    painter: SurfacePainter<'a, RuntimeWidths>,
    constants: &'a TileConstants<'a>,
    cell: PhantomData<fn() -> C>,
}

impl<'a, C: HostCell> GatherTiles<'a, C> {
    /// With the kernel's painter for what vectors cannot do.
    pub fn new(
        painter: SurfacePainter<'a, RuntimeWidths>,
        constants: &'a TileConstants<'a>,
    ) -> Self {
        GatherTiles {
            painter,
            constants,
            cell: PhantomData,
        }
    }

    /// The footprints in the cells by the kernel.
    fn draw(&self, tile: SurfaceTile, cells: &mut [C]) -> Coverage {
        let mut coverage = Coverage::default();
        let Ok(mut target) = CellTarget::new(cells, tile.window) else {
            unreachable!("the tile's memory has just been made for its window")
        };
        let drawn = tile.list.iter();
        for footprint in drawn.flat_map(|index| &tile.footprints[*index as usize]) {
            coverage += self.painter.draw(footprint, &mut target);
        }
        coverage
    }

    /// The same by vectors; `None`, and anything in the cells, where they cannot.
    fn draw_on_vectors(&self, tile: SurfaceTile, cells: &mut [C]) -> Option<Coverage> {
        let (window, columns) = (tile.window, usize::from(tile.window.columns()));
        let gather = &self.constants.gather;
        let mut take =
            |attributes: &Attributes, [x, y]: [u16; 2], weights: &[i64], depths: &[i64]| {
                let [x, y] = [x - window.first[0], y - window.first[1]].map(usize::from);
                let samples = weights.iter().zip(depths);
                for (cell, (weight, depth)) in cells[y * columns + x..].iter_mut().zip(samples) {
                    if *weight > 0 {
                        let sample = Sample {
                            weight: *weight as u32,
                            depth: *depth as u32,
                            attributes,
                        };
                        cell.add(gather, &sample);
                    }
                }
            };
        self.gather(tile, Gather::Samples(&mut take))
    }

    /// Hands the samples of the footprints to whoever gathers them; `None` where vectors cannot.
    fn gather(&self, tile: SurfaceTile, gather: Gather) -> Option<Coverage> {
        let (numbers, choice) = self.constants.numbers?;
        let task = GatherTask {
            numbers,
            tile,
            record: &|footprint, window, cells| match CellTarget::new(cells, window) {
                Ok(mut target) => self.painter.draw(footprint, &mut target),
                Err(_) => Coverage::default(),
            },
            gather,
            counts: self.constants.counts,
        };
        task.paint(choice)
    }
}

impl<C: HostCell> SurfaceTiles for GatherTiles<'_, C> {
    fn paint(
        &self,
        scratch: &mut SurfaceScratch,
        tile: SurfaceTile,
        resolved: &mut [Resolved],
    ) -> (Coverage, usize) {
        let window = tile.window;
        if C::IS_SUM && self.constants.numbers.is_some() {
            let sums = scratch.sums.get_or_insert_default();
            sums.open(window);
            if let Some(coverage) = self.gather(tile, Gather::Sums(sums)) {
                self.constants.resolve(window, sums.cells(), resolved);
                return (coverage, 0);
            }
        }
        let cells = scratch.cells::<C>(window.pixels());
        let on_vectors = self.draw_on_vectors(tile, cells);
        let coverage = on_vectors.unwrap_or_else(|| {
            cells.fill(C::EMPTY);
            self.draw(tile, cells)
        });
        let merged = cells.iter().filter(|cell| cell.merges() > 0).count();
        self.constants
            .resolve(window, cells.iter().cloned(), resolved);
        (coverage, merged)
    }
}
