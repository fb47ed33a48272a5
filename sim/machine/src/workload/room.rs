//! How much memory a picture's workload takes, counted from its footprints before any of it is made.
//!
//! A scene of a million splats that each fill the screen is a small file and a workload of terabytes.

use super::{Pair, Tile, WorkloadRow};
use crate::host_memory::{self, TooLarge};
use splatline::footprint::Footprint;
use splatline::setup::Cull;

/// Copies of a row while it is gathered by tile, put together and grouped for the lanes.
const COPIES: u64 = 3;
/// Bytes of a tile beside its pairs: its lists, before and after (150 were measured).
const TILE_BYTES: u64 = 160;

/// Refuses a workload that does not fit into memory.
pub fn room_for(
    footprints: &[Result<Footprint, Cull>],
    viewport: [usize; 2],
    tile: [u16; 2],
) -> Result<(), TooLarge> {
    const FIX: &str = "give a smaller --size, larger tiles or a farther camera";
    let bytes = bytes(footprints, viewport, tile);
    host_memory::room_for(bytes, "the tiles' lists and rows", FIX)
}

fn bytes(footprints: &[Result<Footprint, Cull>], viewport: [usize; 2], tile: [u16; 2]) -> u64 {
    let [columns, rows] = tile.map(u64::from);
    let [width, height] = viewport.map(|pixels| pixels as u64);
    let tiles = width.div_ceil(columns) * height.div_ceil(rows);
    let mut bytes = tiles * (TILE_BYTES + size_of::<Tile>() as u64);
    for print in footprints.iter().flatten() {
        let tiles = |axis: usize, size: u64| {
            let [first, end] = [print.first, print.end].map(|pixel| u64::from(pixel[axis]));
            end.div_ceil(size).saturating_sub(first / size)
        };
        let (across, down) = (tiles(0, columns), tiles(1, rows));
        let height = u64::from(print.end[1].saturating_sub(print.first[1]));
        let each = across * height * size_of::<WorkloadRow>() as u64
            + across * down * size_of::<Pair>() as u64;
        bytes = bytes.saturating_add(COPIES * each);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::DesignChoice;
    use crate::fixed::{self, Options};
    use crate::rules::Compositing;
    use crate::scene::synthetic;
    use crate::workload::extract_from;
    use splatline::format::Traversal;

    /// Not below what is really made, and not absurdly above it.
    #[test]
    fn the_estimate_bounds_the_workload() {
        let scene = synthetic::random_gaussians(500, 3, 2.0);
        let camera = synthetic::camera(96, 64);
        let design = DesignChoice::named("lean18").unwrap();
        for tile in [[8, 8], [16, 16], [64, 3]] {
            let options = Options {
                rules: &scene.natural_rules,
                compositing: Compositing::FrontToBack,
                design: &design,
                traversal: Traversal::Box,
            };
            let footprints = fixed::footprints(&scene, &camera, &options);
            let made = extract_from(&footprints, &camera, &options, tile);
            let made =
                made.rows.len() * size_of::<WorkloadRow>() + made.pairs.len() * size_of::<Pair>();
            let estimated = bytes(&footprints, [96, 64], tile) as usize;
            assert!((made..10 * made).contains(&estimated), "{made} {estimated}");
        }
    }
}
