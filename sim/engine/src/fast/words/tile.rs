//! A tile's pixels as words of a [`PixelPath`]: planes in every row, so that adjacent pixels are a vector.
//!
//! Four planes of single precision are transmittance, red, green and blue. Of two planes of 64 bits the first has the
//! transmittance, with its mark, above blue, the second green above red: 32 bits each, as the kernel has them.

use super::path::PixelPath;
use super::single::WHOLE;
use crate::fast::lanes::Lanes;
use crate::fast::painter::Start;
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
pub const MARK: i64 = i64::MIN;

/// One row's planes. The spare columns hold finished pixels.
pub type Row<W> = <W as PixelWord>::Row;

/// What a pixel is made of.
pub trait PixelWord: Copy {
    /// One row's planes.
    type Row: Clone + std::fmt::Debug;
    /// A row of finished pixels.
    const FINISHED: Self::Row;
    /// The largest sum that it holds.
    const LARGEST_SUM: u32;
    /// Sets the pixel of a column.
    fn set(row: &mut Self::Row, x: usize, pixel: Pixel);
    /// The pixel of a column.
    fn pixel(row: &Self::Row, x: usize) -> Pixel;
}

impl PixelWord for i64 {
    type Row = [[i64; STRIDE]; 2];
    const FINISHED: Self::Row = [[MARK; STRIDE], [0; STRIDE]];
    const LARGEST_SUM: u32 = u32::MAX;

    #[inline(always)]
    fn set(row: &mut Self::Row, x: usize, pixel: Pixel) {
        let [red, green, blue] = pixel.colour.map(i64::from);
        row[0][x] = i64::from(pixel.transmittance) << 32 | blue;
        row[1][x] = green << 32 | red;
    }

    #[inline(always)]
    fn pixel(row: &Self::Row, x: usize) -> Pixel {
        let [first, second] = [row[0][x], row[1][x]];
        Pixel {
            colour: [second as u32, (second >> 32) as u32, first as u32],
            transmittance: (first >> 32) as u32,
        }
    }
}

impl PixelWord for f32 {
    type Row = [[f32; STRIDE]; 4];
    const FINISHED: Self::Row = [[-0.0; STRIDE], [0.0; STRIDE], [0.0; STRIDE], [0.0; STRIDE]];
    const LARGEST_SUM: u32 = 1 << 23;

    #[inline(always)]
    fn set(row: &mut Self::Row, x: usize, pixel: Pixel) {
        let light = pixel.transmittance() as f32;
        row[0][x] = if pixel.is_finished() { -light } else { light };
        for (plane, sum) in row[1..].iter_mut().zip(pixel.colour) {
            plane[x] = sum as f32 + WHOLE;
        }
    }

    #[inline(always)]
    fn pixel(row: &Self::Row, x: usize) -> Pixel {
        // A unit is the last bit: no conversion, which saturates one by one.
        let integer = |number: f32| number.to_bits().wrapping_sub(WHOLE.to_bits());
        let [light, red, green, blue] = [row[0][x], row[1][x], row[2][x], row[3][x]];
        let mark = if light.is_sign_negative() {
            FINISHED
        } else {
            0
        };
        Pixel {
            colour: [integer(red), integer(green), integer(blue)],
            transmittance: integer(light.abs() + WHOLE) | mark,
        }
    }
}

/// The planes of one tile, kept from tile to tile by a thread.
#[derive(Clone, Debug)]
pub struct WordTile<W: PixelWord> {
    rows: Box<[Row<W>; ROWS]>,
    /// A bit for each pixel of a row that had not finished when it was last looked at.
    live: [i64; ROOM],
    window: Window,
    overflowed: bool,
}

impl<W: PixelWord> Default for WordTile<W> {
    fn default() -> Self {
        WordTile {
            rows: Box::new([W::FINISHED; ROWS]),
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
        // Nothing that a vector finds beyond the tile counts as a pixel.
        let mut transparent = W::FINISHED;
        (0..columns).for_each(|x| W::set(&mut transparent, x, clear));
        self.rows[..rows].fill(transparent);
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

    /// The pixels of some rows that had not finished when they were last looked at: a bit for each.
    #[inline(always)]
    pub fn live<L: Lanes>(&self, lanes: L, first: usize) -> L::Word {
        lanes.read(&self.live, first % ROWS)
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
            .all(|row| (0..COLUMNS).all(|x| W::pixel(row, x).is_finished()))
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
            for (x, pixel) in pixels.iter().enumerate().take(COLUMNS) {
                W::set(row, x, *pixel);
            }
        }
    }

    /// Writes the tile's rows as pixels, one after the other.
    pub fn copy(&self, to: &mut [Pixel]) {
        let columns = extent(&self.window)[0].max(1);
        for (row, to) in self.rows.iter().zip(to.chunks_exact_mut(columns)) {
            for (x, pixel) in to.iter_mut().enumerate().take(COLUMNS) {
                *pixel = W::pixel(row, x);
            }
        }
    }
}
