//! The order in which tiles are drawn. No picture depends on it; what a packet cache finds does.

use super::config::TileWalk;

/// The tiles of a screen with so many columns of them, in this order; `columns` 0 is one row.
pub(super) fn sequence(order: TileWalk, columns: u32, tiles: usize) -> Vec<usize> {
    let columns = match columns {
        0 => tiles.max(1),
        columns => columns as usize,
    };
    let rows = tiles.div_ceil(columns);
    let side = columns.max(rows).next_power_of_two() as u64;
    let key = |tile: usize| -> u64 {
        let [x, y] = [(tile % columns) as u64, (tile / columns) as u64];
        match order {
            TileWalk::Raster => tile as u64,
            TileWalk::Serpentine if y % 2 == 1 => (y + 1) * columns as u64 - 1 - x,
            TileWalk::Serpentine => tile as u64,
            TileWalk::Morton => spread(x) | spread(y) << 1,
            TileWalk::Hilbert => along_hilbert(x, y, side),
        }
    };
    let mut all: Vec<usize> = (0..tiles).collect();
    if order != TileWalk::Raster {
        all.sort_by_cached_key(|tile| key(*tile));
    }
    all
}

/// The bits of a number with a zero after each.
fn spread(number: u64) -> u64 {
    (0..32).fold(0, |all, bit| all | (number >> bit & 1) << (2 * bit))
}

/// How far along Hilbert's curve over `side` x `side` tiles a tile lies.
fn along_hilbert(mut x: u64, mut y: u64, side: u64) -> u64 {
    let mut distance = 0;
    let mut half = side / 2;
    while half > 0 {
        let [right, low] = [u64::from(x & half > 0), u64::from(y & half > 0)];
        distance += half * half * ((3 * right) ^ low);
        // Each quarter is the curve itself, turned so that its ends meet its neighbours'.
        if low == 0 {
            if right == 1 {
                (x, y) = (side - 1 - x, side - 1 - y);
            }
            (x, y) = (y, x);
        }
        half /= 2;
    }
    distance
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [TileWalk; 4] = [
        TileWalk::Raster,
        TileWalk::Serpentine,
        TileWalk::Morton,
        TileWalk::Hilbert,
    ];

    #[test]
    fn every_order_has_every_tile_once() {
        for (columns, tiles) in [
            (1, 1),
            (5, 15),
            (8, 64),
            (7, 3),
            (0, 4),
            (3, 30),
            (120, 8_160),
        ] {
            for order in ALL {
                let mut all = sequence(order, columns, tiles);
                all.sort_unstable();
                assert!(all.into_iter().eq(0..tiles), "{order:?} {columns} {tiles}");
            }
        }
    }

    /// Serpentine and, over a square of a power of two, Hilbert only ever step to a neighbour.
    #[test]
    fn curves_step_to_neighbours() {
        for order in [TileWalk::Serpentine, TileWalk::Hilbert] {
            for steps in sequence(order, 16, 256).windows(2) {
                let apart = |axis: fn(usize) -> usize| axis(steps[0]).abs_diff(axis(steps[1]));
                assert_eq!(
                    apart(|tile| tile % 16) + apart(|tile| tile / 16),
                    1,
                    "{order:?}"
                );
            }
        }
        assert_eq!(sequence(TileWalk::Morton, 4, 8), [0, 1, 4, 5, 2, 3, 6, 7]);
    }
}
