//! A tile's pixels as 64-bit words: one plane per quantity in every row, so that adjacent pixels are a vector.

use crate::fast::lanes::words::PixelWords;
use crate::fast::tile::{TILE, extent};
use splatline::blend::{FINISHED, Pixel};
use splatline::raster::Window;

/// Columns that a vector may reach beyond the tile's last pixel.
const SPARE: usize = 8;

/// Words from one plane of a row to the next.
const STRIDE: usize = TILE[0] as usize + SPARE;

/// Columns and rows of a tile.
const COLUMNS: usize = TILE[0] as usize;
const ROWS: usize = TILE[1] as usize;

/// The mark of a finished pixel: the transmittance's most significant bit, which no product sees.
pub const MARK: u64 = 1 << 63;

/// One row: transmittance, red, green, blue. The spare columns hold finished pixels.
pub type PixelRow = [[u64; STRIDE]; 4];

/// The planes of one tile, kept from tile to tile by a thread.
#[derive(Clone, Debug)]
pub struct WordTile {
    rows: Box<[PixelRow; ROWS]>,
    /// A bit for each pixel of a row that had not finished when it was last looked at.
    live: [u64; ROWS],
    window: Window,
}

impl WordTile {
    /// Memory for a tile, empty.
    pub fn new() -> Self {
        WordTile {
            rows: Box::new([[[0; STRIDE]; 4]; ROWS]),
            live: [0; ROWS],
            window: Window {
                first: [0; 2],
                end: [0; 2],
            },
        }
    }

    /// Makes it the transparent pixels of `window`, which is at most a [`TILE`].
    pub fn open(&mut self, window: Window, clear: Pixel) {
        self.window = window;
        let [columns, rows] = extent(&self.window);
        let of_row = u64::MAX >> (COLUMNS - columns).min(63);
        self.live = std::array::from_fn(|y| if y < rows { of_row } else { 0 });
        for row in self.rows.iter_mut().take(rows) {
            for (plane, value) in row.iter_mut().zip(words(clear)) {
                plane.fill(value);
            }
            // Nothing that a vector finds beyond the tile counts as a pixel.
            row[0][columns..].fill(MARK);
        }
    }

    /// The tile's part of the screen.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Row `y` of the screen.
    #[inline(always)]
    pub fn row(&mut self, y: u16) -> &mut PixelRow {
        let row = y.wrapping_sub(self.window.first[1]) % TILE[1];
        &mut self.rows[usize::from(row)]
    }

    /// The pixels of row `y` of the screen that had not finished when they were last looked at.
    #[inline(always)]
    pub fn live(&self, y: u16) -> u64 {
        self.live[usize::from(y.wrapping_sub(self.window.first[1]) % TILE[1])]
    }

    /// Looks which pixels have finished.
    #[inline(always)]
    pub fn look<L: PixelWords>(&mut self, lanes: L) {
        for (row, live) in self.rows.iter().zip(&mut self.live) {
            // A finished row stays finished.
            if *live == 0 {
                continue;
            }
            let mut marked = 0;
            for x in (0..COLUMNS).step_by(L::WIDE) {
                let flags = lanes.flags(lanes.marked(lanes.read(&row[0], x)));
                marked |= u64::from(flags) << x;
            }
            *live = !marked;
        }
    }

    /// The smallest window around the pixels that had not finished when they were last looked at; `None` if there are none.
    #[inline(always)]
    pub fn live_window(&self) -> Option<Window> {
        let first = self.live.iter().position(|live| *live != 0)?;
        let last = self.live.iter().rposition(|live| *live != 0)? + 1;
        let columns = self.live.iter().fold(0, |all, live| all | live);
        let [left, top] = self.window.first;
        Some(Window {
            first: [left + columns.trailing_zeros() as u16, top + first as u16],
            end: [
                left + (64 - columns.leading_zeros()) as u16,
                top + last as u16,
            ],
        })
    }

    /// Have all its pixels finished?
    #[inline(always)]
    pub fn is_finished(&self) -> bool {
        self.rows[..extent(&self.window)[1]]
            .iter()
            .all(|row| row[0].iter().fold(MARK, |all, word| all & word) != 0)
    }

    /// The pixels as the kernel knows them, row by row.
    pub fn to_pixels(&self) -> Vec<Pixel> {
        let mut pixels = vec![Pixel::default(); extent(&self.window).iter().product()];
        self.copy(&mut pixels);
        pixels
    }

    /// The inverse of [`WordTile::to_pixels`].
    pub fn set_pixels(&mut self, pixels: &[Pixel]) {
        let columns = extent(&self.window)[0].max(1);
        for (row, pixels) in self.rows.iter_mut().zip(pixels.chunks_exact(columns)) {
            for (x, pixel) in pixels.iter().enumerate() {
                for (plane, value) in row.iter_mut().zip(words(*pixel)) {
                    plane[x] = value;
                }
            }
        }
    }

    /// Writes the tile's rows as pixels, one after the other.
    pub fn copy(&self, to: &mut [Pixel]) {
        let columns = extent(&self.window)[0].max(1);
        for (row, to) in self.rows.iter().zip(to.chunks_exact_mut(columns)) {
            let [light, red, green, blue] = row;
            let colours = red.iter().zip(green).zip(blue);
            for ((pixel, light), ((r, g), b)) in to.iter_mut().zip(light).zip(colours) {
                *pixel = Pixel {
                    colour: [*r as u32, *g as u32, *b as u32],
                    transmittance: *light as u32 | (light >> 32) as u32 & FINISHED,
                };
            }
        }
    }
}

impl Default for WordTile {
    fn default() -> Self {
        Self::new()
    }
}

/// A pixel's words in the order of the planes.
fn words(pixel: Pixel) -> [u64; 4] {
    let [r, g, b] = pixel.colour.map(u64::from);
    let mark = u64::from(pixel.transmittance & FINISHED) << 32;
    let light = u64::from(pixel.transmittance & !FINISHED);
    [light | mark, r, g, b]
}
