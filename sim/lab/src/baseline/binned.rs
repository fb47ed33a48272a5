//! What the rasterizers by tiles do before their pixels: footprints, keys, a list of footprints for each tile; and the time that each takes.

use super::BaselineDrawing;
use super::scene::{BaselineFootprint, BoxExtent, FloatScene, depth_key};
use rayon::prelude::*;
use splatline_sim::fast::order::{Grid, Key, tile_lists};
use splatline_sim::fixed::Times;
use std::time::Instant;

/// Draws the scene by `raster`, which gets the tiles, the footprints and each tile's list in depth order. The caller's rayon pool decides
/// the number of threads.
pub(super) fn draw_binned(
    scene: &FloatScene,
    extent: BoxExtent,
    tile: [u16; 2],
    raster: impl FnOnce(&Grid, &[Option<BaselineFootprint>], &[Vec<u32>]) -> Vec<[f32; 4]>,
) -> BaselineDrawing {
    let started = Instant::now();
    let footprints = scene.footprints(extent);
    let set_up_at = started.elapsed().as_secs_f64();
    let grid = Grid::new(scene.viewport, tile);
    let threads = rayon::current_num_threads();
    let part = footprints.len().div_ceil(threads).max(1);
    let parts: Vec<Vec<Key>> = footprints
        .par_chunks(part)
        .enumerate()
        .map(|(number, footprints)| keys(footprints, number * part))
        .collect();
    let lists = tile_lists(&grid, parts);
    let sorted_at = started.elapsed().as_secs_f64();
    let frame = raster(&grid, &footprints, &lists);
    BaselineDrawing {
        frame,
        times: Times {
            setup: set_up_at,
            sort: sorted_at - set_up_at,
            raster: started.elapsed().as_secs_f64() - sorted_at,
        },
    }
}

/// What orders the splats that are seen, numbered from `start`.
fn keys(footprints: &[Option<BaselineFootprint>], start: usize) -> Vec<Key> {
    let numbered = footprints.iter().zip(start as u32..);
    numbered
        .filter_map(|(footprint, index)| {
            footprint.as_ref().map(|footprint| Key {
                depth: depth_key(footprint.depth).into(),
                index,
                bounds: footprint.bounds,
            })
        })
        .collect()
}
