//! Which pixels a machine tests for a splat, from the pixels that are inside its footprint.
//!
//! Rows of a pair keep what is inside and what is open; only which pixels are visited changes, and with it which rows
//! there are.

use super::Tested;
use crate::workload::{Mask, Pair, Workload, WorkloadRow, mask};

/// The same workload with the pixels that a machine tests.
pub fn tested(workload: &Workload, how: Tested) -> Workload {
    if how == Tested::Own {
        return workload.clone();
    }
    let mut changed = workload.clone();
    changed.rows.clear();
    changed.pairs.clear();
    for (number, pair) in workload.pairs.iter().enumerate() {
        let rows = workload.rows_of(number);
        let (first_row, all) = rows_tested(rows, pair.first_row, workload.tile, how);
        let visits = all.iter().any(|row| row.length > 0);
        changed.rows.extend(all);
        changed.pairs.push(Pair {
            rows_end: changed.rows.len() as u32,
            first_row,
            visits,
            ..*pair
        });
    }
    changed
}

/// First row of the tile and the rows of a pair.
fn rows_tested(
    rows: &[WorkloadRow],
    first_row: u8,
    tile: [u16; 2],
    how: Tested,
) -> (u8, Vec<WorkloadRow>) {
    let [width, height] = tile.map(u32::from);
    // The rows of the whole tile; those that the pair does not have are empty.
    let mut all = vec![WorkloadRow::default(); height as usize];
    for (place, row) in all.iter_mut().skip(first_row.into()).zip(rows) {
        *place = *row;
    }
    match how {
        Tested::Own => (first_row, rows.to_vec()),
        Tested::Tiles => {
            all.iter_mut().for_each(|row| visit(row, 0, width));
            (0, all)
        }
        Tested::Rows => {
            let kept = rows.iter().map(|row| one_more(row, width)).collect();
            (first_row, kept)
        }
        Tested::SubTiles(side) => sub_tiles(all, width, side),
    }
}

/// Widens what a row visits; what is inside and open stays.
fn visit(row: &mut WorkloadRow, first: u32, end: u32) {
    row.x = first as u8;
    row.length = (end - first) as u8;
}

/// From the first pixel inside to the last, and the next, which tells that the row is over.
fn one_more(row: &WorkloadRow, width: u32) -> WorkloadRow {
    if row.covered == 0 {
        return WorkloadRow::default();
    }
    let first = row.covered.trailing_zeros();
    let end = (64 - row.covered.leading_zeros() + 1).min(width);
    let mut kept = *row;
    kept.open &= row.covered;
    visit(&mut kept, first, end);
    kept
}

/// Squares of the tile that hold a pixel inside; from the first row of squares that has one to the last.
fn sub_tiles(mut all: Vec<WorkloadRow>, width: u32, side: u32) -> (u8, Vec<WorkloadRow>) {
    let side_rows = side.max(1) as usize;
    let bands = all.len().div_ceil(side_rows);
    let inside = |rows: &[WorkloadRow]| rows.iter().fold(0, |sum: Mask, row| sum | row.covered);
    let mut met = Vec::with_capacity(bands);
    for rows in all.chunks_mut(side_rows) {
        let columns = inside(rows);
        let hit = |square: &u32| columns & mask(square * side, side) != 0;
        let squares = 0..width.div_ceil(side.max(1));
        let first = squares.clone().find(hit);
        let last = squares.rev().find(hit);
        met.push(first.is_some());
        for row in rows {
            match (first, last) {
                (Some(first), Some(last)) => {
                    visit(row, first * side, ((last + 1) * side).min(width));
                }
                _ => *row = WorkloadRow::default(),
            }
        }
    }
    let first = met.iter().position(|met| *met).unwrap_or(0) * side_rows;
    let last = met.iter().rposition(|met| *met);
    let end = last.map_or(first, |last| ((last + 1) * side_rows).min(all.len()));
    (first as u8, all[first..end].to_vec())
}
