//! A tile's pixels as the fused path keeps them: eight neighbours of a row together, as 64-bit words at the scales of the fused products.
//!
//! A vector is always one [`Cell`]. So none crosses a line of the cache, and what one splat stored is what the next one loads; runs
//! that begin anywhere would split most loads and stores in two and find half of a word still on its way to the cache.

use super::scale::Scale;
use crate::fast::tile::TILE;
use splatline::blend::{FINISHED, Pixel};
use splatline::raster::Window;

/// Pixels of a cell.
pub const CELL: usize = 8;

/// Cells of a tile's row.
pub const CELLS_OF_ROW: usize = TILE[0] as usize / CELL;

/// Cells of a tile.
pub const CELLS: usize = CELLS_OF_ROW * TILE[1] as usize;

const _: () = assert!(CELLS.is_power_of_two() && (TILE[0] as usize).is_multiple_of(CELL));

/// The mark of a finished pixel, which no fused product sees.
pub const MARK: u64 = 1 << 63;

/// Eight pixels of a row: transmittances, and sums of red, green and blue.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Cell {
    pub light: [u64; CELL],
    pub colour: [[u64; CELL]; 3],
}

/// The cells of one tile, kept from tile to tile by a thread.
#[derive(Clone, Debug)]
pub struct Tile {
    cells: Box<[Cell; CELLS]>,
    window: Window,
    scale: Scale,
}

impl Tile {
    /// Memory for a tile, empty.
    pub fn new(scale: Scale) -> Self {
        let empty = Cell {
            light: [0; CELL],
            colour: [[0; CELL]; 3],
        };
        Tile {
            cells: Box::new([empty; CELLS]),
            window: Window {
                first: [0; 2],
                last: [0; 2],
            },
            scale,
        }
    }

    /// Makes it the transparent pixels of `window`, which is at most a [`TILE`], at this scale.
    #[inline(always)]
    pub fn open(&mut self, window: Window, clear: Pixel, scale: Scale) {
        self.window = window;
        self.scale = scale;
        let (columns, rows) = (self.columns(), self.rows());
        let [light, colour @ ..] = self.scale.words(clear);
        let clear = Cell {
            light: [light; CELL],
            colour: colour.map(|sum| [sum; CELL]),
        };
        for row in self.cells.chunks_exact_mut(CELLS_OF_ROW).take(rows) {
            row.fill(clear);
            // Nothing that a vector finds beyond the tile counts as a pixel.
            for x in columns..TILE[0].into() {
                row[x / CELL].light[x % CELL] = MARK;
            }
        }
    }

    /// The tile's part of the screen.
    pub fn window(&self) -> Window {
        self.window
    }

    fn columns(&self) -> usize {
        usize::from(self.window.last[0] - self.window.first[0]).min(TILE[0].into())
    }

    fn rows(&self) -> usize {
        usize::from(self.window.last[1] - self.window.first[1]).min(TILE[1].into())
    }

    /// The cell of this number, counted along the rows from the tile's first.
    #[inline(always)]
    pub fn cell(&mut self, number: usize) -> &mut Cell {
        &mut self.cells[number % CELLS]
    }

    /// Have all its pixels finished?
    #[inline(always)]
    pub fn is_finished(&self) -> bool {
        let mut cells = self.cells.iter().take(self.rows() * CELLS_OF_ROW);
        cells.all(|cell| cell.light.iter().fold(MARK, |all, light| all & light) != 0)
    }

    /// The pixels as the kernel knows them, row by row.
    pub fn to_pixels(&self) -> Vec<Pixel> {
        let columns = self.columns();
        let mut pixels = vec![Pixel::default(); columns * self.rows()];
        self.copy(pixels.chunks_exact_mut(columns.max(1)));
        pixels
    }

    /// The inverse of [`Tile::to_pixels`].
    pub fn set_pixels(&mut self, pixels: &[Pixel]) {
        let columns = self.columns().max(1);
        let rows = self.cells.chunks_exact_mut(CELLS_OF_ROW);
        for (row, pixels) in rows.zip(pixels.chunks_exact(columns)) {
            for (x, pixel) in pixels.iter().enumerate() {
                let (cell, k) = (&mut row[x / CELL], x % CELL);
                let [light, red, green, blue] = self.scale.words(*pixel);
                cell.light[k] = light;
                cell.colour[0][k] = red;
                cell.colour[1][k] = green;
                cell.colour[2][k] = blue;
            }
        }
    }

    /// Writes the tile's rows as pixels.
    #[inline(always)]
    pub fn copy<'p>(&self, rows: impl Iterator<Item = &'p mut [Pixel]>) {
        for (cells, row) in self.cells.chunks_exact(CELLS_OF_ROW).zip(rows) {
            for (cell, pixels) in cells.iter().zip(row.chunks_mut(CELL)) {
                let words = self.pixels(cell);
                match pixels.first_chunk_mut() {
                    Some(pixels) => *pixels = words,
                    None => pixels.copy_from_slice(&words[..pixels.len()]),
                }
            }
        }
    }

    /// A cell's pixels.
    #[inline(always)]
    fn pixels(&self, cell: &Cell) -> [Pixel; CELL] {
        let Scale {
            sum, transmittance, ..
        } = self.scale;
        std::array::from_fn(|k| {
            let light = cell.light[k];
            let mark = if light & MARK == 0 { 0 } else { FINISHED };
            Pixel {
                colour: cell.colour.map(|plane| (plane[k] >> sum) as u32),
                transmittance: ((light & !MARK) >> transmittance) as u32 | mark,
            }
        })
    }
}
