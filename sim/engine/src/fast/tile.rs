//! How large a tile is.

use splatline::raster::Window;

/// Columns and rows of a tile. The columns are a multiple of the rasterizer's [`BLOCK`](splatline::raster::BLOCK), so
/// that every run that starts at a tile's edge is seeded there. Smaller tiles would lie in the first-level cache, but
/// cut more splats in two, whose rows and place in a list cost more than a way to the second level.
pub const TILE: [u16; 2] = [64, 64];

/// Rows of a tile.
pub(in crate::fast) const ROWS: usize = TILE[1] as usize;

/// Words of a list by rows: a vector may reach beyond the last one.
pub(in crate::fast) const ROOM: usize = ROWS + 8;

/// Columns and rows of a window that is at most a [`TILE`].
#[inline(always)]
pub(in crate::fast) fn extent(window: &Window) -> [usize; 2] {
    [0, 1].map(|axis: usize| {
        let side = window.end[axis] - window.first[axis];
        usize::from(side.min(TILE[axis]))
    })
}
