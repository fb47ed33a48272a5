//! A tile's pixels as vectors read them: neighbours together, their words in the form that the pixel path computes with.
//!
//! A vector is always one cell. So none crosses a line of the cache, and what one splat stored is what the next one loads; runs
//! that begin anywhere would split most loads and stores in two and find half of a word still on its way to the cache.

use super::scale::{MARK, Scale};
use crate::fast::tile::{TILE, extent};
use splatline::blend::Pixel;
use splatline::raster::Window;

/// Columns of a cell. Wider ones would be emptier: a run of an ordinary splat has ten pixels.
pub const COLUMNS: usize = 8;

/// Pixels of a tile.
pub const AREA: usize = TILE[0] as usize * TILE[1] as usize;

/// Cells from one side of a tile to the other.
pub const CELLS_OF_ROW: usize = TILE[0] as usize / COLUMNS;

const _: () = assert!(CELLS_OF_ROW.is_power_of_two() && (TILE[0] as usize).is_multiple_of(COLUMNS));

/// Neighbours of a row: transmittances, and sums of red, green and blue.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Cell {
    pub light: [u64; COLUMNS],
    pub colour: [[u64; COLUMNS]; 3],
}

impl Cell {
    /// All pixels alike.
    #[inline(always)]
    fn filled([light, colour @ ..]: [u64; 4]) -> Self {
        Cell {
            light: [light; COLUMNS],
            colour: colour.map(|sum| [sum; COLUMNS]),
        }
    }

    /// Transmittance, red, green and blue of the pixel in this column, modulo the cell's.
    #[inline(always)]
    fn get(&self, x: usize) -> [u64; 4] {
        let [red, green, blue] = self.colour.map(|plane| plane[x % COLUMNS]);
        [self.light[x % COLUMNS], red, green, blue]
    }

    /// The inverse of `get`.
    #[inline(always)]
    fn set(&mut self, x: usize, [light, colour @ ..]: [u64; 4]) {
        self.light[x % COLUMNS] = light;
        for (plane, sum) in self.colour.iter_mut().zip(colour) {
            plane[x % COLUMNS] = sum;
        }
    }

    /// Have all its pixels finished?
    #[inline(always)]
    fn is_finished(&self) -> bool {
        self.light.iter().fold(MARK, |all, light| all & light) != 0
    }
}

/// The cells of one tile, kept from tile to tile by a thread.
#[derive(Clone, Debug)]
pub struct CellTile {
    cells: Box<[Cell]>,
    window: Window,
    scale: Scale,
}

impl CellTile {
    /// Memory for a tile, empty.
    pub fn new(scale: Scale) -> Self {
        CellTile {
            cells: vec![Cell::filled([0; 4]); AREA / COLUMNS].into(),
            window: Window {
                first: [0; 2],
                end: [0; 2],
            },
            scale,
        }
    }

    /// Makes it the transparent pixels of `window`, which is at most a [`TILE`], at this scale.
    #[inline(always)]
    pub fn open(&mut self, window: Window, clear: Pixel, scale: Scale) {
        self.window = window;
        self.scale = scale;
        let [columns, rows] = extent(&self.window);
        let words = scale.words(clear);
        let [_, red, green, blue] = words;
        // Nothing that a vector finds beyond the tile counts as a pixel.
        let beyond = [MARK, red, green, blue];
        for cells in self.cells.chunks_exact_mut(CELLS_OF_ROW).take(rows) {
            cells.fill(Cell::filled(words));
            (columns..TILE[0].into()).for_each(|x| cells[x / COLUMNS].set(x, beyond));
        }
    }

    /// The tile's part of the screen.
    pub fn window(&self) -> Window {
        self.window
    }

    /// The cells, counted along the rows from the tile's first.
    #[inline(always)]
    pub fn cells(&mut self) -> &mut [Cell] {
        &mut self.cells
    }

    /// The smallest window of whole cells around the pixels in work; `None` if there are none.
    #[inline(always)]
    pub fn live_window(&self) -> Option<Window> {
        let Window {
            first: [left, top],
            end: [right, _],
        } = self.window;
        let (mut columns, mut rows) = (0u8, None);
        let cells = self.cells.chunks_exact(CELLS_OF_ROW);
        for (y, row) in (top..).zip(cells.take(extent(&self.window)[1])) {
            let flags = row.iter().rev();
            let live = flags.fold(0, |live, cell| live << 1 | u8::from(!cell.is_finished()));
            if live != 0 {
                columns |= live;
                rows = Some((rows.map_or(y, |(first, _)| first), y + 1));
            }
        }
        let (first, end) = rows?;
        let width = COLUMNS as u16;
        let last = left + width * (8 - columns.leading_zeros() as u16);
        Some(Window {
            first: [left + width * columns.trailing_zeros() as u16, first],
            end: [last.min(right), end],
        })
    }

    /// The pixels as the kernel knows them, row by row.
    pub fn to_pixels(&self) -> Vec<Pixel> {
        let [columns, rows] = extent(&self.window);
        let mut pixels = vec![Pixel::default(); columns * rows];
        self.copy(pixels.chunks_exact_mut(columns.max(1)));
        pixels
    }

    /// The inverse of [`CellTile::to_pixels`].
    pub fn set_pixels(&mut self, pixels: &[Pixel]) {
        let columns = extent(&self.window)[0].max(1);
        let rows = self.cells.chunks_exact_mut(CELLS_OF_ROW);
        for (cells, pixels) in rows.zip(pixels.chunks_exact(columns)) {
            for (x, pixel) in pixels.iter().enumerate() {
                cells[x / COLUMNS].set(x, self.scale.words(*pixel));
            }
        }
    }

    /// Writes the tile's rows as pixels.
    #[inline(always)]
    pub fn copy<'p>(&self, rows: impl Iterator<Item = &'p mut [Pixel]>) {
        for (cells, row) in self.cells.chunks_exact(CELLS_OF_ROW).zip(rows) {
            for (cell, pixels) in cells.iter().zip(row.chunks_mut(COLUMNS)) {
                for (x, pixel) in pixels.iter_mut().enumerate() {
                    *pixel = self.scale.pixel(cell.get(x));
                }
            }
        }
    }
}
