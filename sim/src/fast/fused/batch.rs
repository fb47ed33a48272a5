//! Several footprints of a tile at once: first the cells of all, then their pixels.
//!
//! The way from a row's radial index to the seed of its first pixel is 200 cycles long. One footprint alone would wait for it; the rows of the
//! next ones fill the time.

use super::cells::Parts;
use super::pixels::{Brush, PixelPath};
use super::tile::Tile;
use crate::fast::lanes::fused::Fused;
use crate::fast::paint::CHECK_INTERVAL;
use splatline::draw::Coverage;
use splatline::raster::{RowConstants, Window};

/// How many footprints ahead memory is asked for: lists name them in an order that no cache foresees.
const AHEAD: usize = 4;

/// What a footprint's rows and pixels are computed from, in every tile.
#[derive(Clone, Copy, Debug)]
pub struct Prepared {
    pub rows: RowConstants<i64>,
    pub brush: Brush,
}

/// Memory for the footprints of a tile, used again and again.
pub struct Batch<const DEEP: bool> {
    parts: Parts<DEEP>,
    /// Where each footprint's cells end in the list.
    ends: [usize; CHECK_INTERVAL],
}

impl<const DEEP: bool> Batch<DEEP> {
    /// Nothing.
    #[inline(always)]
    pub fn new() -> Self {
        Batch {
            parts: Parts::new(),
            ends: [0; CHECK_INTERVAL],
        }
    }

    /// Lists the cells of as many footprints from the list's start as there is room for, and returns their number: 0 if vectors cannot
    /// draw the first one.
    #[inline(always)]
    pub fn fill<L: Fused>(
        &mut self,
        lanes: L,
        prepared: &[Option<Prepared>],
        list: &[u32],
        window: &Window,
    ) -> usize {
        self.parts.clear();
        let mut listed = 0;
        for (index, end) in list.iter().zip(&mut self.ends) {
            if let Some(next) = list.get(listed + AHEAD) {
                lanes.fetch(&prepared[*next as usize]);
            }
            let Some(Prepared { rows, .. }) = &prepared[*index as usize] else {
                break;
            };
            if self.parts.is_full() || !self.parts.fill(lanes, &rows.within(window), window) {
                break;
            }
            *end = self.parts.count();
            listed += 1;
        }
        listed
    }

    /// Paints the footprints that have been listed, which are these.
    #[inline(always)]
    pub fn paint<L: Fused, const STOP_BEFORE: bool>(
        &self,
        path: &PixelPath<L, STOP_BEFORE, DEEP>,
        prepared: &[Option<Prepared>],
        list: &[u32],
        tile: &mut Tile,
        coverage: &mut Coverage,
    ) {
        let mut first = 0;
        for (index, end) in list.iter().zip(self.ends) {
            if let Some(Prepared { rows, brush }) = &prepared[*index as usize] {
                let colours = path.colours(brush, rows.second);
                for part in self.parts.range(first, end) {
                    path.paint(&colours, &part, tile.cell(part.cell()), coverage);
                }
            }
            first = end;
        }
    }
}
