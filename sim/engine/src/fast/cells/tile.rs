//! A tile's pixels as vectors read them: neighbours together, their words in the form that the pixel path computes with.
//!
//! A vector is always one cell. So none crosses a line of the cache, and what one splat stored is what the next one loads; runs
//! that begin anywhere would split most loads and stores in two and find half of a word still on its way to the cache.

use crate::fast::tile::{TILE, extent};
use core::ops::BitAnd;
use splatline::blend::{FINISHED, Pixel};
use splatline::raster::Window;

/// Columns of a cell. Wider ones would be emptier: a run of an ordinary splat has ten pixels.
pub const COLUMNS: usize = 8;

/// Pixels of a tile.
pub const AREA: usize = TILE[0] as usize * TILE[1] as usize;

/// Cells from one side of a tile to the other.
pub const CELLS_OF_ROW: usize = TILE[0] as usize / COLUMNS;

const _: () = assert!(CELLS_OF_ROW.is_power_of_two() && (TILE[0] as usize).is_multiple_of(COLUMNS));

/// A word of a pixel.
pub trait CellWord: Copy + Default + PartialEq + BitAnd<Output = Self> + Send {
    /// The most significant bit: the mark of a finished pixel, which no product sees.
    const MARK: Self;
}

impl CellWord for u64 {
    const MARK: u64 = 1 << 63;
}

impl CellWord for u32 {
    const MARK: u32 = 1 << 31;
}

/// `N` pixels of one or more rows, column by column: transmittances, and sums of red, green and blue.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct PixelGroup<W, const N: usize> {
    pub light: [W; N],
    pub colour: [[W; N]; 3],
}

/// A cell of any size.
pub trait TileGroup: Copy + Send {
    type Word: CellWord;
    const ROWS: usize;
    /// All pixels alike.
    fn filled(words: [Self::Word; 4]) -> Self;
    /// Transmittance, red, green and blue of the pixel in this column and row, modulo the cell's.
    fn get(&self, x: usize, y: usize) -> [Self::Word; 4];
    /// The inverse of `get`.
    fn set(&mut self, x: usize, y: usize, words: [Self::Word; 4]);
    /// Have all its pixels finished?
    fn is_finished(&self) -> bool;
}

impl<W: CellWord, const N: usize> TileGroup for PixelGroup<W, N> {
    type Word = W;
    const ROWS: usize = N / COLUMNS;

    #[inline(always)]
    fn filled([light, colour @ ..]: [W; 4]) -> Self {
        PixelGroup {
            light: [light; N],
            colour: colour.map(|sum| [sum; N]),
        }
    }

    #[inline(always)]
    fn get(&self, x: usize, y: usize) -> [W; 4] {
        let pixel = x % COLUMNS * Self::ROWS + y % Self::ROWS;
        let [red, green, blue] = self.colour.map(|plane| plane[pixel]);
        [self.light[pixel], red, green, blue]
    }

    #[inline(always)]
    fn set(&mut self, x: usize, y: usize, [light, colour @ ..]: [W; 4]) {
        let pixel = x % COLUMNS * Self::ROWS + y % Self::ROWS;
        self.light[pixel] = light;
        for (plane, sum) in self.colour.iter_mut().zip(colour) {
            plane[pixel] = sum;
        }
    }

    #[inline(always)]
    fn is_finished(&self) -> bool {
        let all = self.light.iter().fold(W::MARK, |all, light| all & *light);
        all != W::default()
    }
}

/// How the kernel's pixels are written as words.
pub trait PixelFormat: Copy + Send {
    type Word: CellWord;
    /// Transmittance, red, green and blue.
    fn words(&self, pixel: Pixel) -> [Self::Word; 4];
    /// Can vectors go on with this pixel, whatever they add to it? If not, `words` may be wrong.
    fn holds(&self, pixel: Pixel) -> bool;
    /// The inverse of `words`.
    fn pixel(&self, words: [Self::Word; 4]) -> Pixel;
}

/// The cells of one tile, kept from tile to tile by a thread.
#[derive(Clone, Debug)]
pub struct CellTile<C, F> {
    cells: Box<[C]>,
    window: Window,
    format: F,
    /// The pixels instead, once the kernel's painter has made of one what the format cannot hold: colours far outside theirs.
    spilled: Option<Vec<Pixel>>,
}

impl<C: TileGroup, F: PixelFormat<Word = C::Word>> CellTile<C, F> {
    /// Memory for a tile, empty.
    pub fn new(format: F) -> Self {
        CellTile {
            cells: vec![C::filled(format.words(Pixel::default())); AREA / COLUMNS / C::ROWS].into(),
            window: Window {
                first: [0; 2],
                end: [0; 2],
            },
            format,
            spilled: None,
        }
    }

    /// Makes it the transparent pixels of `window`, which is at most a [`TILE`], in this format.
    #[inline(always)]
    pub fn open(&mut self, window: Window, clear: Pixel, format: F) {
        self.window = window;
        self.format = format;
        self.spilled = None;
        let [columns, rows] = extent(&self.window);
        let words = format.words(clear);
        let [_, red, green, blue] = words;
        // Nothing that a vector finds beyond the tile counts as a pixel.
        let beyond = [C::Word::MARK, red, green, blue];
        let lines = self.cells.chunks_exact_mut(CELLS_OF_ROW).enumerate();
        for (line, cells) in lines.take(rows.div_ceil(C::ROWS)) {
            cells.fill(C::filled(words));
            for y in (line * C::ROWS..).take(C::ROWS) {
                let first = if y < rows { columns } else { 0 };
                (first..TILE[0].into()).for_each(|x| cells[x / COLUMNS].set(x, y, beyond));
            }
        }
    }

    /// The tile's part of the screen.
    pub fn window(&self) -> Window {
        self.window
    }

    /// The cells, counted along the rows from the tile's first; `None` if only the kernel's painter can go on.
    #[inline(always)]
    pub fn cells(&mut self) -> Option<&mut [C]> {
        self.spilled.is_none().then_some(&mut self.cells)
    }

    /// Have all its pixels finished?
    #[inline(always)]
    pub fn is_finished(&self) -> bool {
        if let Some(pixels) = &self.spilled {
            return pixels
                .iter()
                .all(|pixel| pixel.transmittance & FINISHED != 0);
        }
        let lines = extent(&self.window)[1].div_ceil(C::ROWS);
        let mut cells = self.cells.iter().take(lines * CELLS_OF_ROW);
        cells.all(C::is_finished)
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
        if !pixels.iter().all(|pixel| self.format.holds(*pixel)) {
            self.spilled = Some(pixels.into());
            return;
        }
        let columns = extent(&self.window)[0].max(1);
        for (y, pixels) in pixels.chunks_exact(columns).enumerate() {
            let cells = &mut self.cells[y / C::ROWS * CELLS_OF_ROW..];
            for (x, pixel) in pixels.iter().enumerate() {
                cells[x / COLUMNS].set(x, y, self.format.words(*pixel));
            }
        }
    }

    /// Writes the tile's rows as pixels.
    #[inline(always)]
    pub fn copy<'p>(&self, rows: impl Iterator<Item = &'p mut [Pixel]>) {
        if let Some(pixels) = &self.spilled {
            let from = pixels.chunks_exact(extent(&self.window)[0].max(1));
            rows.zip(from)
                .for_each(|(row, from)| row.copy_from_slice(from));
            return;
        }
        for (y, row) in rows.enumerate() {
            let cells = self.cells[y / C::ROWS * CELLS_OF_ROW..].iter();
            for (cell, pixels) in cells.zip(row.chunks_mut(COLUMNS)) {
                for (x, pixel) in pixels.iter_mut().enumerate() {
                    *pixel = self.format.pixel(cell.get(x, y));
                }
            }
        }
    }
}
