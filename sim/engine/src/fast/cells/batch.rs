//! Several footprints of a tile at once: first the cells of all, then their pixels.
//!
//! The way from a row's radial index to the seed of its first pixel is 200 cycles long. One footprint alone would wait for it; the rows of the
//! next ones fill the time.

use super::fused::{FusedPixels, FusedSplatNumbers};
use super::parts::{CellParts, MANY};
use super::tile::Cell;
use crate::fast::lanes::fused::Fused;
use crate::fast::painter::CHECK_INTERVAL;
use splatline::draw::Coverage;
use splatline::raster::{RowConstants, Window};

/// What a footprint's rows in a tile and its pixels are computed from.
#[derive(Clone, Copy, Debug, Default)]
pub struct CellFootprint {
    pub rows: RowConstants<i64>,
    pub numbers: FusedSplatNumbers,
}

/// Gives what is needed, within a window, of the footprint that a list begins with; nothing if vectors cannot draw it.
pub type Prepare<'a> = dyn Fn(&[u32], &Window) -> Option<CellFootprint> + 'a;

/// What is left of a footprint when its cells have been listed.
#[derive(Clone, Copy, Debug, Default)]
struct Listed {
    numbers: FusedSplatNumbers,
    /// Second difference of the radial index.
    second: i64,
    /// Where its cells end in the list.
    end: usize,
}

/// Memory for the footprints of a tile, used again and again.
pub struct Batch<const DEEP: bool> {
    parts: CellParts<DEEP>,
    listed: [Listed; CHECK_INTERVAL],
}

impl<const DEEP: bool> Batch<DEEP> {
    /// Nothing.
    #[inline(always)]
    pub fn new() -> Self {
        Batch {
            parts: CellParts::new(),
            listed: [Listed::default(); CHECK_INTERVAL],
        }
    }

    /// Lists the cells of as many footprints from the list's start as there is room for, and returns their number: 0 if vectors cannot
    /// draw the first one. `live` is the part of the tile's window that is painted.
    #[inline(always)]
    pub fn fill<L: Fused>(
        &mut self,
        lanes: L,
        list: &[u32],
        prepare: &Prepare,
        window: &Window,
        live: &Window,
    ) -> usize {
        self.parts.clear();
        let mut count = 0;
        for listed in &mut self.listed {
            if self.parts.count >= MANY {
                break;
            }
            let Some(CellFootprint { rows, numbers }) = prepare(&list[count..], live) else {
                break;
            };
            if !self.parts.fill(lanes, &rows, window) {
                break;
            }
            *listed = Listed {
                numbers,
                second: rows.second,
                end: self.parts.count,
            };
            count += 1;
        }
        count
    }

    /// Paints the first `count` footprints that have been listed.
    #[inline(always)]
    pub fn paint<L: Fused, const STOP_BEFORE: bool>(
        &self,
        path: &FusedPixels<L, STOP_BEFORE, DEEP>,
        count: usize,
        tile: &mut [Cell],
    ) -> Coverage {
        let mut first = 0;
        let mut counts = [path.lanes.wide_splat(0); 2];
        for listed in self.listed.iter().take(count) {
            let colours = path.splat_words(&listed.numbers, listed.second);
            for part in self.parts.range(first, listed.end) {
                if let Some(cell) = tile.get_mut(part.cell()) {
                    path.paint(&colours, &part, cell, &mut counts);
                }
            }
            first = listed.end;
        }
        let [covered, live] = counts.map(|words| path.lanes.sum(words));
        Coverage {
            visited: self.parts.visited,
            covered,
            finished: covered - live,
        }
    }
}
