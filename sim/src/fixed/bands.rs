//! Bands of rows for compositing units that keep more per pixel than a [`Pixel`](splatline::blend::Pixel) or need
//! their splats in another order than depth.

use rayon::prelude::*;
use splatline::footprint::Footprint;
use splatline::format::Widths;
use splatline::kernel::{FootprintTable, entries, fill_gaussian};
use splatline::raster::Window;

/// Rows of a band. Any number gives the same picture.
const ROWS: u16 = 16;

/// Draws all bands of `viewport` side by side; `draw` gets a window and returns its pixels, row by row.
pub fn draw_bands<Pixel: Send + Clone>(
    viewport: [u16; 2],
    draw: impl Fn(Window) -> Vec<Pixel> + Sync,
) -> Vec<Pixel> {
    let bands = viewport[1].div_ceil(ROWS);
    let parts: Vec<Vec<Pixel>> = (0..bands)
        .into_par_iter()
        .map(|band| {
            let first = band * ROWS;
            let last = first.saturating_add(ROWS).min(viewport[1]);
            draw(Window {
                first: [0, first],
                last: [viewport[0], last],
            })
        })
        .collect();
    parts.concat()
}

/// Pixels of a window.
pub fn area(window: &Window) -> usize {
    let side = |axis: usize| usize::from(window.last[axis].saturating_sub(window.first[axis]));
    side(0) * side(1)
}

/// Does the footprint's box reach into the window's rows?
pub fn touches(footprint: &Footprint, window: &Window) -> bool {
    footprint.first[1] < window.last[1] && footprint.last[1] > window.first[1]
}

/// Calls `work` with the Gaussian's footprint table for these widths.
pub fn with_table<T>(widths: &Widths, range: u8, work: impl FnOnce(FootprintTable) -> T) -> T {
    let mut memory = vec![0; entries(widths)];
    fill_gaussian(&mut memory, widths, range);
    match FootprintTable::new(&memory, widths, range) {
        Ok(table) => work(table),
        Err(_) => unreachable!("the table has just been made for these widths"),
    }
}
