//! A tile's pixels as the fused path keeps them: one plane of 64-bit words per quantity, at the scales of the fused products.

use super::scale::Scale;
use crate::fast::tile::TILE;
use splatline::blend::{FINISHED, Pixel};
use splatline::raster::Window;

/// Columns that a vector may reach beyond the tile's last pixel.
const SPARE: usize = 8;

/// Words from one plane of a row to the next.
pub const STRIDE: usize = TILE[0] as usize + SPARE;

/// One row: transmittance, red, green, blue. The spare columns hold finished pixels.
pub type Row = [[u64; STRIDE]; 4];

/// The mark of a finished pixel, which no fused product sees.
pub const MARK: u64 = 1 << 63;

/// The planes of one tile, kept from tile to tile by a thread.
#[derive(Clone, Debug)]
pub struct Tile {
    rows: Box<[Row; TILE[1] as usize]>,
    window: Window,
    scale: Scale,
}

impl Tile {
    /// Memory for a tile, empty.
    pub fn new(scale: Scale) -> Self {
        Tile {
            rows: Box::new([[[0; STRIDE]; 4]; TILE[1] as usize]),
            window: Window {
                first: [0; 2],
                last: [0; 2],
            },
            scale,
        }
    }

    /// Makes it the transparent pixels of `window`, which is at most a [`TILE`].
    pub fn open(&mut self, window: Window, clear: Pixel) {
        self.window = window;
        let (columns, rows) = (self.columns(), self.rows());
        let words = self.scale.words(clear);
        for row in self.rows.iter_mut().take(rows) {
            for (plane, word) in row.iter_mut().zip(words) {
                plane.fill(word);
            }
            // Nothing that a vector finds beyond the tile counts as a pixel.
            row[0][columns..].fill(MARK);
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

    /// The rows from row `y` of the screen on.
    #[inline(always)]
    pub fn rows_from(&mut self, y: u16) -> &mut [Row] {
        let row = y.wrapping_sub(self.window.first[1]) % TILE[1];
        &mut self.rows[usize::from(row)..]
    }

    /// Have all its pixels finished?
    #[inline(always)]
    pub fn is_finished(&self) -> bool {
        self.rows[..self.rows()]
            .iter()
            .all(|row| row[0].iter().fold(MARK, |all, t| all & t) != 0)
    }

    /// The pixels as the kernel knows them, row by row.
    pub fn to_pixels(&self) -> Vec<Pixel> {
        let columns = self.columns();
        let mut pixels = vec![Pixel::default(); columns * self.rows()];
        for (row, y) in pixels.chunks_exact_mut(columns.max(1)).zip(0..) {
            self.copy_row(y, row);
        }
        pixels
    }

    /// The inverse of [`Tile::to_pixels`].
    pub fn set_pixels(&mut self, pixels: &[Pixel]) {
        let columns = self.columns().max(1);
        for (row, pixels) in self.rows.iter_mut().zip(pixels.chunks_exact(columns)) {
            for (x, pixel) in pixels.iter().enumerate() {
                for (plane, word) in row.iter_mut().zip(self.scale.words(*pixel)) {
                    plane[x] = word;
                }
            }
        }
    }

    /// Writes the tile's row `y`, counted from its first, as pixels.
    #[inline(always)]
    pub fn copy_row(&self, y: usize, to: &mut [Pixel]) {
        let Some([transmittance, red, green, blue]) = self.rows.get(y) else {
            return;
        };
        let scale = self.scale;
        let colours = red.iter().zip(green).zip(blue);
        for ((pixel, transmittance), ((r, g), b)) in to.iter_mut().zip(transmittance).zip(colours) {
            let mark = if transmittance & MARK == 0 {
                0
            } else {
                FINISHED
            };
            *pixel = Pixel {
                colour: [*r, *g, *b].map(|sum| (sum >> scale.sum) as u32),
                transmittance: ((transmittance & !MARK) >> scale.transmittance) as u32 | mark,
            };
        }
    }
}
