//! Lane work: what the lanes do for every row, given their number and layout. Depends on nothing else of the machine.
//!
//! The definitions of the layouts are in `docs/hardware-model.md`, section 1. One [`Band`] is what the lanes take from their FIFO
//! in one piece: a row, or the two rows of a quad.

use super::config::{Binning, Config, LaneLayout, Termination};
use super::workload::{Mask, Workload, WorkloadRow, mask};
use rayon::prelude::*;

/// What lane work depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LaneShape {
    /// Pixel lanes.
    pub lanes: u32,
    /// Their layout.
    pub layout: LaneLayout,
    /// What happens to finished pixels.
    pub termination: Termination,
    /// Which pairs exist.
    pub binning: Binning,
}

impl From<&Config> for LaneShape {
    fn from(config: &Config) -> Self {
        let Config {
            lanes,
            layout,
            pixel_termination,
            binning,
            ..
        } = *config;
        LaneShape {
            lanes,
            layout,
            termination: pixel_termination,
            binning,
        }
    }
}

/// One piece of work for the lanes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Band {
    /// Row of the tile, or number of the row pair with quads.
    pub y: u8,
    /// Rows that the generator makes for it, with those before it that have no work for the lanes.
    pub rows: u8,
    /// First column, moved down to the group's first.
    pub first: u8,
    /// One past the last column.
    pub last: u8,
    /// Groups that the lanes visit; 0 if there is nothing to visit.
    pub groups: u8,
    /// Groups between its first and last that are not visited: finished, or between the two runs of a quad.
    pub skipped: u8,
}

/// One splat-tile pair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PairWork {
    /// The splat, by its number in the scene.
    pub splat: u32,
    /// One past its last band.
    pub bands_end: u32,
    /// Sum of its bands' groups.
    pub groups: u16,
    /// Sum of its bands' skipped groups.
    pub skipped: u16,
    /// Pixels that lanes visit.
    pub visited: u16,
    /// Of these, pixels inside the footprint.
    pub covered: u16,
    /// Of these, pixels that had not finished.
    pub live: u16,
    /// Rows.
    pub rows: u16,
    /// Bands with work for the lanes.
    pub runs: u16,
}

/// One tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileWork {
    /// One past its last pair.
    pub pairs_end: u32,
    /// Pairs after which all its pixels have finished; `u32::MAX` if they never do.
    pub finished_after: u32,
    /// Pixels to write back.
    pub pixels: u32,
}

/// A workload as the lanes see it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LaneWork {
    /// Bands of all pairs.
    pub bands: Vec<Band>,
    /// Pairs of all tiles.
    pub pairs: Vec<PairWork>,
    /// All tiles.
    pub tiles: Vec<TileWork>,
    /// Tiles in a row of the screen; 0 if that is not known.
    pub columns: u32,
    /// Fragments that a surface unit normalises of each tile; nothing without one.
    pub resolved: Vec<u32>,
}

impl LaneWork {
    /// Groups every row of `workload` for lanes of this shape. `lanes` must be at most 64.
    pub fn new(workload: &Workload, shape: LaneShape) -> LaneWork {
        let parts: Vec<LaneWork> = (0..workload.tiles.len())
            .into_par_iter()
            .map(|tile| one_tile(workload, shape, tile))
            .collect();
        let mut work = LaneWork {
            bands: Vec::with_capacity(parts.iter().map(|part| part.bands.len()).sum()),
            pairs: Vec::with_capacity(workload.pairs.len()),
            tiles: Vec::with_capacity(parts.len()),
            columns: workload.columns,
            resolved: (workload.surface.as_ref()).map_or(Vec::new(), |work| work.resolved.clone()),
        };
        for (part, tile) in parts.into_iter().zip(&workload.tiles) {
            let base = work.bands.len() as u32;
            let finished_after = part
                .tiles
                .first()
                .map_or(u32::MAX, |tile| tile.finished_after);
            work.pairs.extend(part.pairs.iter().map(|pair| PairWork {
                bands_end: base + pair.bands_end,
                ..*pair
            }));
            work.bands.extend(part.bands);
            let pairs_end = work.pairs.len() as u32;
            work.tiles.push(TileWork {
                pairs_end,
                finished_after,
                pixels: tile.pixels,
            });
        }
        work
    }
}

fn one_tile(workload: &Workload, shape: LaneShape, tile: usize) -> LaneWork {
    let mut work = LaneWork::default();
    let start = if tile == 0 {
        0
    } else {
        workload.tiles[tile - 1].pairs_end as usize
    };
    let end = workload.tiles[tile].pairs_end as usize;
    let mut first_row = if start == 0 {
        0
    } else {
        workload.pairs[start - 1].rows_end as usize
    };
    let mut finished_after = u32::MAX;
    for (index, pair) in workload.pairs[start..end].iter().enumerate() {
        let rows = &workload.rows[first_row..pair.rows_end as usize];
        first_row = pair.rows_end as usize;
        if pair.visits || shape.binning == Binning::Box {
            one_pair(&mut work, shape, pair.splat, pair.first_row, rows);
        }
        if index as u32 + 1 == workload.tiles[tile].finished_after {
            finished_after = work.pairs.len() as u32;
        }
    }
    work.tiles.push(TileWork {
        pairs_end: 0,
        finished_after,
        pixels: 0,
    });
    work
}

fn one_pair(
    work: &mut LaneWork,
    shape: LaneShape,
    splat: u32,
    first_row: u8,
    rows: &[WorkloadRow],
) {
    let mut pair = PairWork {
        splat,
        rows: rows.len() as u16,
        ..PairWork::default()
    };
    let mut rest = rows;
    let mut y = first_row;
    // Rows without work for the lanes are charged to the next band that has some, which changes no time of any unit.
    let mut empty_rows = 0;
    while !rest.is_empty() {
        let quad = shape.layout == LaneLayout::Quad;
        let tall = if quad && y.is_multiple_of(2) { 2 } else { 1 };
        let (now, later) = rest.split_at(tall.min(rest.len()));
        let grouped = Grouped::new(shape, now);
        pair.add(&grouped, now);
        let mut band = grouped.band(if quad { y / 2 } else { y }, now.len() as u8);
        y += band.rows;
        rest = later;
        band.rows += empty_rows;
        empty_rows = band.rows;
        pair.runs += u16::from(band.groups > 0);
        if band.groups > 0 || rest.is_empty() {
            work.bands.push(band);
            empty_rows = 0;
        }
    }
    pair.bands_end = work.bands.len() as u32;
    work.pairs.push(pair);
}

impl PairWork {
    fn add(&mut self, grouped: &Grouped, rows: &[WorkloadRow]) {
        self.groups += u16::from(grouped.groups);
        self.skipped += u16::from(grouped.skipped);
        for row in rows {
            let count = |pixels: Mask| (pixels & grouped.visited).count_ones() as u16;
            self.visited += count(row.visited());
            self.covered += count(row.covered);
            self.live += count(row.covered & row.open);
        }
    }
}

/// The groups of one band.
struct Grouped {
    first: u8,
    last: u8,
    groups: u8,
    skipped: u8,
    /// Columns that lie in a visited group.
    visited: Mask,
}

impl Grouped {
    fn new(shape: LaneShape, rows: &[WorkloadRow]) -> Grouped {
        let pixels = rows.iter().fold(0, |all, row| all | row.visited());
        let wanted = match shape.termination {
            Termination::Discard => pixels,
            Termination::Skip => rows.iter().fold(0, |all, row| all | row.open),
        };
        let mut grouped = Grouped {
            first: 0,
            last: 0,
            groups: 0,
            skipped: 0,
            visited: 0,
        };
        if pixels == 0 {
            return grouped;
        }
        let columns = match shape.layout {
            LaneLayout::Run | LaneLayout::Aligned => shape.lanes,
            LaneLayout::Quad => shape.lanes / 2,
            LaneLayout::Rows => 1,
        };
        let (low, end) = (pixels.trailing_zeros(), 64 - pixels.leading_zeros());
        let start = if shape.layout == LaneLayout::Run {
            low
        } else {
            low - low % columns
        };
        grouped.first = start as u8;
        grouped.last = end as u8;
        for column in (start..end).step_by(columns as usize) {
            let group = mask(column, columns);
            if wanted & group != 0 {
                grouped.groups += 1;
                grouped.visited |= group;
            } else {
                grouped.skipped += 1;
            }
        }
        grouped
    }

    fn band(&self, y: u8, rows: u8) -> Band {
        let Grouped {
            first,
            last,
            groups,
            skipped,
            ..
        } = *self;
        Band {
            y,
            rows,
            first,
            last,
            groups,
            skipped,
        }
    }
}
