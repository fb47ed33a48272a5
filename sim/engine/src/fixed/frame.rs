//! What all drawings of the kernel share: lists of tiles, tiles drawn side by side, and pixels made a picture.
//!
//! A drawing differs from another in what a pixel holds, in what order a tile meets its splats, and in what paints
//! them. All of them cut the screen into a [`Grid`], list each tile's splats, paint the tiles on all cores and join
//! them; the picture is the same whatever the tiles.

use crate::fast::TILE;
use crate::fast::order::{Grid, Key, part_length, tile_lists};
use crate::picture::Picture;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::footprint::Footprint;
use splatline::format::Widths;
use splatline::raster::Window;

/// For every tile the footprints whose box touches it, in drawing order.
pub(super) struct TileLists {
    grid: Grid,
    pub(super) lists: Vec<Vec<u32>>,
}

impl TileLists {
    /// By a key of a footprint and its index, at most 48 bits, the smallest first, ties by index.
    pub(super) fn by_key(
        footprints: &[Footprint],
        viewport: [u16; 2],
        key: &(dyn Fn(u32, &Footprint) -> u64 + Sync),
    ) -> Self {
        let grid = Grid::new(viewport, TILE);
        let length = part_length(footprints.len());
        let keys = |(part, footprints): (usize, &[Footprint])| {
            let numbered = footprints.iter().zip((part * length) as u32..);
            let keys = numbered.map(|(footprint, index)| Key {
                depth: key(index, footprint),
                index,
                bounds: Window::of(footprint),
            });
            keys.filter(|key| !key.bounds.is_empty()).collect()
        };
        let parts = footprints.par_chunks(length).enumerate().map(keys);
        let lists = tile_lists(&grid, parts.collect());
        TileLists { grid, lists }
    }
}

/// What paints a tile: see [`paint_apart`].
type PaintTile<'a, P, Answer> = dyn Fn(Window, &[u32], &mut [P]) -> Answer + Sync + 'a;

/// Every tile on some core, in memory of its own, row by row, which is then copied into the frame: `paint` is given the
/// tile's window, its list and its pixels. The tiles' answers are in the order of the tiles.
///
/// Not inlined, so that a profiler can tell it from the rest.
#[inline(never)]
pub(super) fn paint_apart<P: Clone + Send + Sync, Answer: Send>(
    clear: P,
    tiles: &TileLists,
    paint: &PaintTile<P, Answer>,
) -> (Vec<P>, Vec<Answer>) {
    let [width, height] = tiles.grid.viewport().map(usize::from);
    let mut frame = vec![clear.clone(); width * height];
    let rows = tiles.grid.split(&mut frame).into_par_iter();
    let work = rows.zip(&tiles.lists).enumerate().with_max_len(1);
    let answers = work.map(|(tile, (rows, list))| {
        let window = tiles.grid.window(tile);
        let mut pixels = vec![clear.clone(); window.pixels()];
        let answer = paint(window, list, &mut pixels);
        for (row, painted) in rows
            .into_iter()
            .zip(pixels.chunks_exact(window.columns().into()))
        {
            row.clone_from_slice(painted);
        }
        answer
    });
    let answers = answers.collect();
    (frame, answers)
}

/// A picture of pixels of any kind, each converted to colour and 1 - T in units of 1.0.
pub(super) fn to_picture<P: Sync>(
    pixels: &[P],
    viewport: [u16; 2],
    convert: impl Fn(&P) -> [f64; 4] + Sync,
) -> Picture {
    let [width, height] = viewport.map(usize::from);
    let mut picture = Picture::new(width, height);
    let places = picture.pixels.par_iter_mut().with_min_len(CONVERTED);
    (places.zip(pixels)).for_each(|(out, pixel)| *out = convert(pixel));
    picture
}

/// Pixels converted by one task.
const CONVERTED: usize = 16384;

/// Gives a pixel's colour and 1 - T in units of 1.0. The units are powers of two, so that products with their inverses
/// are exact.
pub fn converter(
    widths: &Widths,
    colour_log2: i32,
) -> impl Fn(&Pixel) -> [f64; 4] + Send + Sync + use<> {
    let colour_unit = f64::from(colour_log2 - i32::from(widths.accumulator)).exp2();
    let opaque = f64::from(-i32::from(widths.transmittance)).exp2();
    move |pixel| {
        let [r, g, b] = pixel.colour.map(|c| f64::from(c) * colour_unit);
        [r, g, b, 1.0 - f64::from(pixel.transmittance()) * opaque]
    }
}
