//! The textbook: what many open CPU rasterizers do, without anything that makes the fastest of them fast.
//!
//! After the rasterizer of 3D Gaussian splatting: every splat is entered for each 16 x 16 tile that its bounding box touches, under the key
//! (tile, depth); the entries are sorted at once; each tile walks its entries front to back and evaluates conic and `exp` at the pixels
//! of tile and box. Pixels finish early, and so does a tile when all of its pixels have. [`BoxExtent`] says which box: the customary square
//! of three sigmas, or the smaller one of the cut-off.

use super::BaselineDrawing;
use super::scene::{BaselineFootprint, BoxExtent, FloatScene, depth_key};
use rayon::prelude::*;
use splatline::raster::Window;
use splatline_sim::fast::order::Grid;
use splatline_sim::fixed::Times;
use std::time::Instant;

const TILE: u16 = 16;
const AREA: usize = TILE as usize * TILE as usize;

/// Draws the scene; the caller's rayon pool decides the number of threads.
pub fn draw(scene: &FloatScene, extent: BoxExtent) -> BaselineDrawing {
    let started = Instant::now();
    let footprints = scene.footprints(extent);
    let set_up_at = started.elapsed().as_secs_f64();
    let grid = Grid::new(scene.viewport, [TILE; 2]);
    let entries = sorted_entries(&grid, &footprints);
    let starts = tile_starts(&entries, grid.len());
    let sorted_at = started.elapsed().as_secs_f64();
    let frame = raster(scene, &grid, &footprints, &entries, &starts);
    BaselineDrawing {
        frame,
        times: Times {
            setup: set_up_at,
            sort: sorted_at - set_up_at,
            raster: started.elapsed().as_secs_f64() - sorted_at,
        },
    }
}

/// Tile and depth, and the splat's number.
type TextbookEntry = (u64, u32);

fn sorted_entries(grid: &Grid, footprints: &[Option<BaselineFootprint>]) -> Vec<TextbookEntry> {
    let mut entries = Vec::new();
    for (footprint, index) in footprints.iter().zip(0..) {
        let Some(footprint) = footprint else { continue };
        let depth = u64::from(depth_key(footprint.depth));
        grid.touched(&footprint.bounds, |tile| {
            entries.push(((tile as u64) << 32 | depth, index));
        });
    }
    entries.par_sort_unstable();
    entries
}

/// Where each tile's entries begin, and the end of the last.
fn tile_starts(entries: &[TextbookEntry], tiles: usize) -> Vec<usize> {
    let mut starts = Vec::with_capacity(tiles + 1);
    for (number, (key, _)) in entries.iter().enumerate() {
        let tile = (key >> 32) as usize;
        while starts.len() <= tile {
            starts.push(number);
        }
    }
    starts.resize(tiles + 1, entries.len());
    starts
}

/// Every tile on some core. Not inlined, so that a profiler can tell it from the rest.
#[inline(never)]
fn raster(
    scene: &FloatScene,
    grid: &Grid,
    footprints: &[Option<BaselineFootprint>],
    entries: &[TextbookEntry],
    starts: &[usize],
) -> Vec<[f32; 4]> {
    let [width, height] = scene.viewport.map(usize::from);
    let mut frame = vec![[0.0, 0.0, 0.0, 1.0]; width * height];
    grid.split(&mut frame)
        .into_par_iter()
        .enumerate()
        .for_each(|(tile, mut rows)| {
            let list = &entries[starts[tile]..starts[tile + 1]];
            let splats = list
                .iter()
                .filter_map(|(_, index)| footprints[*index as usize].as_ref());
            let pixels = paint_tile(scene, grid.window(tile), splats);
            for (row, pixels) in rows.iter_mut().zip(pixels.chunks_exact(TILE.into())) {
                row.copy_from_slice(&pixels[..row.len()]);
            }
        });
    frame
}

/// Colour and transmittance of a tile's pixels.
fn paint_tile<'a>(
    scene: &FloatScene,
    window: Window,
    splats: impl Iterator<Item = &'a BaselineFootprint>,
) -> [[f32; 4]; AREA] {
    let mut pixels = [[0.0, 0.0, 0.0, 1.0]; AREA];
    let mut finished = [false; AREA];
    let area =
        usize::from(window.end[0] - window.first[0]) * usize::from(window.end[1] - window.first[1]);
    let mut left = area;
    // Under rules that skip by opacity no radial index ends a footprint.
    let end = scene.cutoff;
    for splat in splats {
        let part = splat.bounds.intersect(&window);
        let [a, b, c] = splat.conic;
        for y in part.first[1]..part.end[1] {
            let dy = f32::from(y) + 0.5 - splat.centre[1];
            for x in part.first[0]..part.end[0] {
                let place = usize::from(y - window.first[1]) * usize::from(TILE)
                    + usize::from(x - window.first[0]);
                if finished[place] {
                    continue;
                }
                let dx = f32::from(x) + 0.5 - splat.centre[0];
                let radial = a * dx * dx + 2.0 * b * dx * dy + c * dy * dy;
                if !(radial >= 0.0 && radial < end) {
                    continue;
                }
                let alpha = scene.alpha_max.min(splat.peak * (-0.5 * radial).exp());
                if alpha < scene.alpha_min {
                    continue;
                }
                let pixel = &mut pixels[place];
                let rest = pixel[3] * (1.0 - alpha);
                let stop = rest <= scene.stop;
                if stop {
                    finished[place] = true;
                    left -= 1;
                    if scene.omit_finishing {
                        continue;
                    }
                }
                let share = pixel[3] * alpha;
                for (sum, colour) in pixel.iter_mut().zip(splat.colour) {
                    *sum += share * colour;
                }
                pixel[3] = rest;
            }
        }
        if left == 0 {
            break;
        }
    }
    pixels
}
