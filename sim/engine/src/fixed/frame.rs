//! What all drawings of the kernel share: lists of tiles, tiles drawn side by side, and pixels made a picture.
//!
//! A drawing differs from another in what a pixel holds, in what order a tile meets its splats, and in what paints them. All of them cut the
//! screen into a [`Grid`], list each tile's splats, paint the tiles on all cores and join them; the picture is the same whatever the tiles.

use crate::camera::Camera;
use crate::fast::TILE;
use crate::fast::order::{Grid, Key, part_length, tile_lists};
use crate::fast::setup::Outcome;
use crate::picture::Picture;
use crate::rules::Compositing;
use rayon::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::Coverage;
use splatline::footprint::Footprint;
use splatline::format::Widths;
use splatline::kernel::{FootprintTable, entries, fill};
use splatline::raster::Window;
use splatline::rules as kernel;
use splatline::target::Target;

/// What stands for a splat when splats are ordered.
pub(super) trait DepthOrdered: Sync {
    /// Its footprint, if it has one.
    fn footprint(&self) -> Option<&Footprint>;
}

impl DepthOrdered for Footprint {
    fn footprint(&self) -> Option<&Footprint> {
        Some(self)
    }
}

impl DepthOrdered for Outcome {
    fn footprint(&self) -> Option<&Footprint> {
        self.as_ref().ok()
    }
}

/// For every tile the footprints whose box touches it, in drawing order.
pub(super) struct TileLists {
    grid: Grid,
    lists: Vec<Vec<u32>>,
}

impl TileLists {
    /// By depth, nearest first (farthest first for back to front), ties by index.
    pub(super) fn by_depth(
        splats: &[impl DepthOrdered],
        compositing: Compositing,
        viewport: [u16; 2],
    ) -> Self {
        let mut tiles = TileLists::by_key(splats, viewport, &|_, footprint| footprint.depth);
        if compositing == Compositing::BackToFront {
            tiles.lists.iter_mut().for_each(|list| list.reverse());
        }
        tiles
    }

    /// By a key of a splat's index and footprint, at most 48 bits, the smallest first, ties by index.
    pub(super) fn by_key(
        splats: &[impl DepthOrdered],
        viewport: [u16; 2],
        key: &(dyn Fn(u32, &Footprint) -> u64 + Sync),
    ) -> Self {
        let grid = Grid::new(viewport, TILE);
        let part = part_length(splats.len());
        let keys = |(number, splats): (usize, &[_])| keys(splats, (number * part) as u32, key);
        let parts = splats.par_chunks(part).enumerate().map(keys).collect();
        let lists = tile_lists(&grid, parts);
        TileLists { grid, lists }
    }
}

/// Keys of the splats that have a footprint, numbered from `start`.
fn keys(
    splats: &[impl DepthOrdered],
    start: u32,
    key: &dyn Fn(u32, &Footprint) -> u64,
) -> Vec<Key> {
    let numbered = splats.iter().zip(start..);
    let keys = numbered.filter_map(|(splat, index)| {
        let footprint = splat.footprint()?;
        let bounds = Window::of(footprint);
        (!bounds.is_empty()).then(|| Key {
            depth: key(index, footprint),
            index,
            bounds,
        })
    });
    keys.collect()
}

/// The footprint table's entries for the rules' kernel.
pub fn table_entries(widths: &Widths, rules: &kernel::Rules) -> Vec<u32> {
    let mut memory = vec![0; entries(widths)];
    fill(&mut memory, widths, rules.table_range, rules.kernel);
    memory
}

/// The table over [`table_entries`].
pub fn table<'a>(memory: &'a [u32], widths: &Widths, rules: &kernel::Rules) -> FootprintTable<'a> {
    match FootprintTable::new(memory, widths, rules.table_range) {
        Ok(table) => table,
        Err(_) => unreachable!("the entries have been made for these widths"),
    }
}

/// What paints a tile: a thread's scratch memory, the tile's window, its list and its rows of the frame.
type PaintTile<'a, P, S, Answer> =
    dyn Fn(&mut S, Window, &[u32], &mut [&mut [P]]) -> Answer + Sync + 'a;

/// Every tile on some core: `paint` is given a thread's scratch memory, the tile's window, its list and its rows of the frame. The tiles'
/// answers are in the order of the tiles.
///
/// Not inlined, so that a profiler can tell it from the rest, and given functions behind references: fifty drawings share one compiled copy of what
/// spreads the work, at the price of a call for each tile.
#[inline(never)]
pub(super) fn paint_frame<P: Clone + Send, S, Answer: Send>(
    clear: P,
    tiles: &TileLists,
    scratch: &(dyn Fn() -> S + Sync),
    paint: &PaintTile<P, S, Answer>,
) -> (Vec<P>, Vec<Answer>) {
    let [width, height] = tiles.grid.viewport().map(usize::from);
    let mut frame = vec![clear; width * height];
    let answers = tiles
        .grid
        .split(&mut frame)
        .into_par_iter()
        .zip(&tiles.lists)
        .enumerate()
        .with_max_len(1)
        .map_init(scratch, |scratch, (tile, (mut rows, list))| {
            paint(scratch, tiles.grid.window(tile), list, &mut rows)
        })
        .collect();
    (frame, answers)
}

/// The same with each tile in memory of its own, row by row, which is then copied into the frame.
pub(super) fn paint_apart<P: Clone + Send + Sync, Answer: Send>(
    clear: P,
    tiles: &TileLists,
    paint: impl Fn(Window, &[u32], &mut [P]) -> Answer + Sync,
) -> (Vec<P>, Vec<Answer>) {
    paint_frame(clear.clone(), tiles, &|| (), &|(), window, list, rows| {
        let columns = usize::from(window.end[0] - window.first[0]);
        let mut pixels = vec![clear.clone(); columns * rows.len()];
        let answer = paint(window, list, &mut pixels);
        for (row, painted) in rows.iter_mut().zip(pixels.chunks_exact(columns)) {
            row.clone_from_slice(painted);
        }
        answer
    })
}

/// Paints every tile by `paint`, which is given the tile's footprints in drawing order, and joins the tiles.
pub(super) fn paint_tiles(
    widths: &Widths,
    tiles: &TileLists,
    paint: impl Fn(&[u32], &mut Target) -> Coverage + Sync,
) -> (Vec<Pixel>, Coverage) {
    let clear = Pixel::clear(widths);
    let (pixels, parts) = paint_apart(clear, tiles, |window, list, pixels| {
        let columns = usize::from(window.end[0] - window.first[0]);
        let Ok(mut target) = Target::new(pixels, window, columns) else {
            unreachable!("the tile's memory has just been made for its window")
        };
        paint(list, &mut target)
    });
    (pixels, total(parts))
}

/// What all tiles touched.
pub(super) fn total(parts: Vec<Coverage>) -> Coverage {
    parts
        .into_iter()
        .fold(Coverage::default(), |mut sum, part| {
            sum += part;
            sum
        })
}

/// Colour and 1 - T in units of 1.0, colours multiplied by the unit that they were divided by.
pub(super) fn to_picture(
    pixels: &[Pixel],
    camera: &Camera,
    widths: &Widths,
    colour_log2: i32,
) -> Picture {
    let convert = converter(widths, colour_log2);
    let mut picture = Picture::new(camera.width, camera.height);
    let chunks = picture.pixels.par_chunks_mut(CONVERTED);
    chunks
        .zip(pixels.par_chunks(CONVERTED))
        .for_each(|(out, pixels)| {
            out.iter_mut()
                .zip(pixels)
                .for_each(|(out, pixel)| *out = convert(pixel));
        });
    picture
}

/// Pixels converted by one task.
const CONVERTED: usize = 16384;

/// Gives a pixel's colour and 1 - T in units of 1.0. The units are powers of two, so that products with their inverses are exact.
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
