//! Which blocks of 8 x 8 pixels still have a pixel in work, and whether a box touches one: by sums over the blocks
//! above and to the left.

use super::spheres::{Numbers, TOGETHER};
use crate::fast::TILE;
use splatline::blend::{FINISHED, Pixel};
use splatline::raster::Window;

/// Columns and rows of a block, a power of two. A tile's blocks are the bits of a word.
const BLOCK: usize = 8;

const SIDE: usize = TILE[0] as usize / BLOCK;
const _: () = assert!(SIDE == 8 && TILE[0] == TILE[1]);

/// The blocks of a frame.
#[derive(Clone, Debug, Default)]
pub struct LiveBlocks {
    /// A bit for each block of a tile, row by row.
    pub tiles: Vec<u64>,
    /// How many live blocks lie above and to the left of each corner.
    sums: Vec<u32>,
    columns: usize,
    rows: usize,
}

impl LiveBlocks {
    /// All of a viewport's blocks.
    pub fn open(&mut self, viewport: [u16; 2]) {
        let count = |axis: usize| usize::from(viewport[axis].div_ceil(TILE[axis]));
        self.tiles.clear();
        self.tiles.resize(count(0) * count(1), u64::MAX);
        (self.columns, self.rows) = (count(0) * SIDE, count(1) * SIDE);
        self.sum();
    }

    /// The blocks of boxes of pixels within the viewport, or one more on a side.
    #[inline(always)]
    pub fn of_boxes(&self, bounds: &[Numbers; 4]) -> [[u16; TOGETHER]; 4] {
        const UNIT: f32 = 1.0 / BLOCK as f32;
        // The last bits of a sum with it are a number rounded to nearest.
        const WHOLE: f32 = (1 << 23) as f32;
        let last = [self.columns as f32, self.rows as f32];
        let mut blocks = [[0; TOGETHER]; 4];
        for (axis, last) in last.into_iter().enumerate() {
            for k in 0..TOGETHER {
                let first = (bounds[axis][k] * UNIT).max(0.5) - 0.5;
                let end = (bounds[axis + 2][k] * UNIT + 0.5).min(last);
                blocks[axis][k] = (first + WHOLE).to_bits() as u16;
                blocks[axis + 2][k] = (end + WHOLE).to_bits() as u16;
            }
        }
        blocks
    }

    /// Brings the sums up to date with the tiles.
    pub fn sum(&mut self) {
        let width = self.columns + 1;
        self.sums.clear();
        self.sums.resize(width * (self.rows + 1), 0);
        for y in 0..self.rows {
            let tiles = &self.tiles[y / SIDE * (self.columns / SIDE)..];
            let mut row = 0;
            for x in 0..self.columns {
                let bit = y % SIDE * SIDE + x % SIDE;
                row += (tiles[x / SIDE] >> bit & 1) as u32;
                let above = self.sums[y * width + x + 1];
                self.sums[(y + 1) * width + x + 1] = above + row;
            }
        }
    }

    /// Is a block within these columns and rows (left, top, right, bottom) live?
    #[inline(always)]
    pub fn any(&self, bounds: &[u16; 4]) -> bool {
        let [left, top, right, bottom] = bounds.map(usize::from);
        if left >= right || top >= bottom {
            return false;
        }
        let width = self.columns + 1;
        let sum = |x: usize, y: usize| self.sums.get(y * width + x).copied().unwrap_or_default();
        let inside = sum(right, bottom) + sum(left, top);
        inside != sum(left, bottom) + sum(right, top)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.tiles.capacity() * size_of::<u64>() + self.sums.capacity() * size_of::<u32>()
    }
}

/// A tile's blocks that have a pixel in work.
pub fn live_blocks(window: &Window, pixels: &[Pixel]) -> u64 {
    let columns = usize::from(window.columns()).max(1);
    let mut live = 0;
    for (y, row) in pixels.chunks(columns).enumerate() {
        for (x, block) in row.chunks(BLOCK).enumerate() {
            let all = block
                .iter()
                .fold(FINISHED, |all, pixel| all & pixel.transmittance);
            let in_work = u64::from(all & FINISHED == 0);
            live |= in_work << (y / BLOCK % SIDE * SIDE + x % SIDE);
        }
    }
    live
}
