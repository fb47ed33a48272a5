//! A tile's pixels while it is painted: one plane per quantity, so that adjacent pixels are a vector.

use splatline::blend::{FINISHED, Pixel};
use splatline::raster::Window;

/// Columns and rows of a tile. The columns are a multiple of the rasterizer's [`BLOCK`](splatline::raster::BLOCK), so that every run
/// that starts at a tile's edge is seeded there. Smaller tiles would lie in the first-level cache, but cut more splats in two, whose rows
/// and place in a list cost more than a way to the second level.
pub const TILE: [u16; 2] = [64, 64];

/// Columns and rows of a window that is at most a [`TILE`].
#[inline(always)]
pub(in crate::fast) fn extent(window: &Window) -> [usize; 2] {
    [0, 1].map(|axis: usize| {
        let side = window.end[axis] - window.first[axis];
        usize::from(side.min(TILE[axis]))
    })
}

/// Columns that a vector may reach beyond the tile's last pixel.
const SPARE: usize = 16;

/// Words from one plane of a row to the next.
pub const STRIDE: usize = TILE[0] as usize + SPARE;

/// One row: transmittance, red, green, blue. The spare columns hold finished pixels.
pub type TileRow = [[u32; STRIDE]; 4];

/// The planes of one tile, kept from tile to tile by a thread.
#[derive(Clone, Debug)]
pub struct PlaneTile {
    rows: Box<[TileRow; TILE[1] as usize]>,
    window: Window,
}

impl PlaneTile {
    /// Memory for a tile, empty.
    pub fn new() -> Self {
        PlaneTile {
            rows: Box::new([[[0; STRIDE]; 4]; TILE[1] as usize]),
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
        for row in self.rows.iter_mut().take(rows) {
            for (plane, value) in row.iter_mut().zip(words(clear)) {
                plane.fill(value);
            }
            // Nothing that a vector finds beyond the tile counts as a pixel.
            row[0][columns..].fill(FINISHED);
        }
    }

    /// The tile's part of the screen.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Row `y` of the screen.
    #[inline(always)]
    pub fn row(&mut self, y: u16) -> &mut TileRow {
        let row = y.wrapping_sub(self.window.first[1]) % TILE[1];
        &mut self.rows[usize::from(row)]
    }

    /// The planes of row `y`, counted from the tile's first.
    #[inline(always)]
    pub fn planes(&self, y: usize) -> &TileRow {
        &self.rows[y % usize::from(TILE[1])]
    }

    /// Have all its pixels finished?
    #[inline(always)]
    pub fn is_finished(&self) -> bool {
        self.rows[..extent(&self.window)[1]]
            .iter()
            .all(|row| row[0].iter().fold(FINISHED, |all, t| all & t) != 0)
    }

    /// The pixels as the kernel knows them, row by row.
    pub fn to_pixels(&self) -> Vec<Pixel> {
        let [columns, rows] = extent(&self.window);
        let mut pixels = vec![Pixel::default(); columns * rows];
        for (row, y) in pixels.chunks_exact_mut(columns.max(1)).zip(0..) {
            self.copy_row(y, row);
        }
        pixels
    }

    /// The inverse of [`PlaneTile::to_pixels`].
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

    /// Writes the tile's row `y`, counted from its first, as pixels.
    #[inline(always)]
    pub fn copy_row(&self, y: usize, to: &mut [Pixel]) {
        let Some([transmittance, red, green, blue]) = self.rows.get(y) else {
            return;
        };
        let colours = red.iter().zip(green).zip(blue);
        for ((pixel, transmittance), ((r, g), b)) in to.iter_mut().zip(transmittance).zip(colours) {
            *pixel = Pixel {
                colour: [*r, *g, *b],
                transmittance: *transmittance,
            };
        }
    }
}

impl Default for PlaneTile {
    fn default() -> Self {
        Self::new()
    }
}

/// A pixel's words in the order of the planes.
fn words(pixel: Pixel) -> [u32; 4] {
    let [r, g, b] = pixel.colour;
    [pixel.transmittance, r, g, b]
}
