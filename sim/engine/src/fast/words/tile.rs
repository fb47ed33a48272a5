//! A tile's pixels as words of a [`PixelPath`]: one plane per quantity in every row, so that adjacent pixels are a
//! vector.

use super::path::PixelPath;
use super::single::WHOLE;
use crate::fast::painter::Start;
use crate::fast::rows;
use crate::fast::tile::{ROOM, ROWS, TILE, extent};
use splatline::blend::{FINISHED, Pixel};
use splatline::raster::Window;

/// Columns that a vector may reach beyond the tile's last pixel.
const SPARE: usize = 16;

/// Words from one plane of a row to the next.
const STRIDE: usize = TILE[0] as usize + SPARE;

/// Columns of a tile.
const COLUMNS: usize = TILE[0] as usize;

/// The mark of a finished pixel: the transmittance's most significant bit, which no product sees.
pub const MARK: u64 = 1 << 63;

/// One row: transmittance, red, green, blue. The spare columns hold finished pixels.
pub type Row<W> = [[W; STRIDE]; 4];

/// What holds a pixel's transmittance or one of its sums.
pub trait PixelWord: Copy {
    /// A finished pixel's transmittance.
    const FINISHED: Self;
    /// The largest sum that it holds.
    const LARGEST_SUM: u32;
    /// The kernel's transmittance with its mark.
    fn of_light(light: u32) -> Self;
    /// A sum of the kernel's.
    fn of_sum(sum: u32) -> Self;
    /// The inverse of `of_light`.
    fn light(self) -> u32;
    /// The inverse of `of_sum`.
    fn sum(self) -> u32;
}

impl PixelWord for u64 {
    const FINISHED: u64 = MARK;
    const LARGEST_SUM: u32 = u32::MAX;

    fn of_light(light: u32) -> u64 {
        u64::from(light & FINISHED) << 32 | u64::from(light & !FINISHED)
    }
    fn of_sum(sum: u32) -> u64 {
        sum.into()
    }
    fn light(self) -> u32 {
        self as u32 | (self >> 32) as u32 & FINISHED
    }
    fn sum(self) -> u32 {
        self as u32
    }
}

impl PixelWord for f32 {
    const FINISHED: f32 = -0.0;
    const LARGEST_SUM: u32 = 1 << 23;

    fn of_light(light: u32) -> f32 {
        let number = (light & !FINISHED) as f32;
        if light & FINISHED == 0 {
            number
        } else {
            -number
        }
    }
    fn of_sum(sum: u32) -> f32 {
        sum as f32 + WHOLE
    }
    fn light(self) -> u32 {
        let mark = if self.is_sign_negative() { FINISHED } else { 0 };
        (self.abs() + WHOLE).sum() | mark
    }
    fn sum(self) -> u32 {
        // A unit is the last bit: no conversion, which saturates one by one.
        self.to_bits().wrapping_sub(WHOLE.to_bits())
    }
}

/// The planes of one tile, kept from tile to tile by a thread.
#[derive(Clone, Debug)]
pub struct WordTile<W> {
    rows: Box<[Row<W>; ROWS]>,
    /// A bit for each pixel of a row that had not finished when it was last looked at.
    live: [i64; ROOM],
    window: Window,
    overflowed: bool,
}

impl<W: PixelWord> Default for WordTile<W> {
    fn default() -> Self {
        WordTile {
            rows: Box::new([[[W::FINISHED; STRIDE]; 4]; ROWS]),
            live: [0; ROOM],
            overflowed: false,
            window: Window {
                first: [0; 2],
                end: [0; 2],
            },
        }
    }
}

impl<W: PixelWord> WordTile<W> {
    /// Makes it the transparent pixels of `window`, which is at most a [`TILE`].
    pub fn open(&mut self, window: Window, clear: Pixel) {
        self.window = window;
        self.overflowed = false;
        let [columns, rows] = extent(&self.window);
        let of_row = u64::MAX >> (COLUMNS - columns).min(63);
        self.live = std::array::from_fn(|y| if y < rows { of_row as i64 } else { 0 });
        for row in self.rows.iter_mut().take(rows) {
            for (plane, value) in row.iter_mut().zip(words(clear)) {
                plane.fill(value);
            }
            // Nothing that a vector finds beyond the tile counts as a pixel.
            row[0][columns..].fill(W::FINISHED);
        }
    }

    /// Opens it for painting: with transparent pixels, or with those of nearer footprints.
    pub fn start(&mut self, window: Window, clear: Pixel, start: Start, pixels: &[Pixel]) {
        self.open(window, clear);
        if start == Start::Resumed {
            self.set_pixels(pixels);
        }
    }

    /// Has a pixel been set whose sums it does not hold?
    pub fn has_overflowed(&self) -> bool {
        self.overflowed
    }

    /// The tile's part of the screen.
    pub fn window(&self) -> Window {
        self.window
    }

    /// All rows of the tile.
    #[inline(always)]
    pub fn rows(&mut self) -> &mut [Row<W>; ROWS] {
        &mut self.rows
    }

    /// The pixels of eight rows that had not finished when they were last looked at: a bit for each.
    #[inline(always)]
    pub fn live(&self, first: usize) -> &[i64; 8] {
        rows::window(&self.live, first)
    }

    /// Looks which pixels have finished: a bit for each of a row.
    #[inline(always)]
    pub fn look(&mut self, path: &impl PixelPath<Word = W>) {
        for (row, live) in self.rows.iter().zip(&mut self.live) {
            // A finished row stays finished.
            if *live != 0 {
                *live = !path.finished(row) as i64;
            }
        }
    }

    /// Of these bounds, which are the screen's, the rows with pixels that had not finished when they were last looked
    /// at, from the first to the last; `None` if there are none.
    #[inline(always)]
    pub fn live_rows(&self, bounds: &Window) -> Option<Window> {
        let seen = bounds.intersect(&self.window);
        if seen.is_empty() {
            return None;
        }
        let [x, y] = [0, 1].map(|axis| usize::from(seen.first[axis] - self.window.first[axis]));
        let columns = u64::MAX >> ((64 - seen.columns()) % 64) << (x % 64);
        let rows = self.live.get(y..y + usize::from(seen.rows()))?;
        let is_live = |live: &i64| *live as u64 & columns != 0;
        let before = rows.iter().position(is_live)? as u16;
        let behind = rows.iter().rev().position(is_live)? as u16;
        Some(Window {
            first: [seen.first[0], seen.first[1] + before],
            end: [seen.end[0], seen.end[1] - behind],
        })
    }

    /// The smallest window around the pixels that had not finished when they were last looked at; `None` if there are
    /// none.
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
            .all(|row| row[0].iter().all(|word| word.light() & FINISHED != 0))
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
        let mut sums = pixels.iter().flat_map(|pixel| pixel.colour);
        self.overflowed |= sums.any(|sum| sum > W::LARGEST_SUM);
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
                    colour: [r.sum(), g.sum(), b.sum()],
                    transmittance: light.light(),
                };
            }
        }
    }
}

/// A pixel's words in the order of the planes.
fn words<W: PixelWord>(pixel: Pixel) -> [W; 4] {
    let [r, g, b] = pixel.colour.map(W::of_sum);
    [W::of_light(pixel.transmittance), r, g, b]
}
