//! Lane work: what the lanes do for every row, given their number and layout. Depends on nothing else of the machine.
//!
//! The definitions of the layouts are in `docs/hardware-model.md`, section 1. One [`Band`] is what the lanes take from
//! their FIFO in one piece: a row, or the two rows of a quad.

use super::config::{Binning, Config, LaneLayout, Termination};
use super::workload::{Mask, Pair, Tile, Workload, WorkloadRow, mask, part_of};
use rayon::prelude::*;
use std::ops::Range;

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
        LaneShape {
            lanes: config.lanes,
            layout: config.layout,
            termination: config.pixel_termination,
            binning: config.binning,
        }
    }
}

impl LaneShape {
    /// Columns that the lanes advance per group.
    pub fn stride(&self) -> u32 {
        match self.layout {
            LaneLayout::Run | LaneLayout::Aligned => self.lanes,
            LaneLayout::Quad => (self.lanes / 2).max(1),
            LaneLayout::Rows => 1,
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

/// A workload as the lanes see it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LaneWork {
    /// Bands of all pairs.
    pub bands: Vec<Band>,
    /// Pairs of all tiles.
    pub pairs: Vec<PairWork>,
    /// All tiles.
    pub tiles: Vec<Tile>,
    /// Tiles in a row of the screen; 0 if that is not known.
    pub columns: u32,
    /// Fragments that a surface unit normalises of each tile; nothing without one.
    pub resolved: Vec<u32>,
}

impl LaneWork {
    /// Bytes of its lists.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.bands) + size_of_val(&*self.pairs) + size_of_val(&*self.tiles)
    }

    /// Groups every row of `workload` for lanes of this shape. `lanes` must be at most 64.
    pub fn new(workload: &Workload, shape: LaneShape) -> LaneWork {
        let tiles = (0..workload.tiles.len()).into_par_iter();
        let parts = tiles.map(|tile| one_tile(workload, shape, tile));
        let parts: Vec<LaneWork> = parts.collect();
        let mut work = LaneWork {
            bands: Vec::with_capacity(parts.iter().map(|part| part.bands.len()).sum()),
            pairs: Vec::with_capacity(workload.pairs.len()),
            tiles: Vec::with_capacity(parts.len()),
            columns: workload.columns,
            resolved: (workload.surface.as_ref()).map_or(Vec::new(), |work| work.resolved.clone()),
        };
        for part in parts {
            let base = work.bands.len() as u32;
            work.pairs.extend(part.pairs.iter().map(|pair| PairWork {
                bands_end: base + pair.bands_end,
                ..*pair
            }));
            work.bands.extend(part.bands);
            let pairs_end = work.pairs.len() as u32;
            let tiles = part.tiles.into_iter();
            work.tiles
                .extend(tiles.map(|tile| Tile { pairs_end, ..tile }));
        }
        work
    }

    /// The numbers of a tile's pairs.
    pub fn pairs_in(&self, tile: usize) -> Range<usize> {
        part_of(&self.tiles, tile, |tile| tile.pairs_end)
    }
}

fn one_tile(workload: &Workload, shape: LaneShape, number: usize) -> LaneWork {
    let tile = &workload.tiles[number];
    let mut work = LaneWork::default();
    let mut finished_after = u32::MAX;
    for (count, index) in (1..).zip(workload.pairs_in(number)) {
        let pair = &workload.pairs[index];
        if pair.visits || shape.binning == Binning::Box {
            one_pair(&mut work, shape, pair, workload.rows_of(index));
        }
        if count == tile.finished_after {
            finished_after = work.pairs.len() as u32;
        }
    }
    work.tiles.push(Tile {
        finished_after,
        ..*tile
    });
    work
}

fn one_pair(work: &mut LaneWork, shape: LaneShape, of: &Pair, rows: &[WorkloadRow]) {
    let mut pair = PairWork {
        splat: of.splat,
        rows: rows.len() as u16,
        ..PairWork::default()
    };
    let mut rest = rows;
    let mut y = of.first_row;
    // Rows without work for the lanes are charged to the next band that has some, which changes no time of any unit.
    let mut empty_rows = 0;
    while !rest.is_empty() {
        let quad = shape.layout == LaneLayout::Quad;
        let tall = if quad && y.is_multiple_of(2) { 2 } else { 1 };
        let (now, later) = rest.split_at(tall.min(rest.len()));
        let (mut band, visited) = grouped(shape, now);
        pair.add(&band, visited, now);
        band.y = if quad { y / 2 } else { y };
        y += now.len() as u8;
        rest = later;
        band.rows = empty_rows + now.len() as u8;
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
    fn add(&mut self, band: &Band, visited: Mask, rows: &[WorkloadRow]) {
        self.groups += u16::from(band.groups);
        self.skipped += u16::from(band.skipped);
        for row in rows {
            let count = |pixels: Mask| (pixels & visited).count_ones() as u16;
            self.visited += count(row.visited());
            self.covered += count(row.covered);
            self.live += count(row.covered & row.open);
        }
    }
}

/// The groups of one band, and the columns that lie in a visited one.
fn grouped(shape: LaneShape, rows: &[WorkloadRow]) -> (Band, Mask) {
    let pixels = rows.iter().fold(0, |all, row| all | row.visited());
    let wanted = match shape.termination {
        Termination::Discard => pixels,
        Termination::Skip => rows.iter().fold(0, |all, row| all | row.open),
    };
    let (mut band, mut visited) = (Band::default(), 0);
    if pixels == 0 {
        return (band, visited);
    }
    let columns = shape.stride();
    let (low, end) = (pixels.trailing_zeros(), 64 - pixels.leading_zeros());
    let start = match shape.layout {
        LaneLayout::Run => low,
        _ => low - low % columns,
    };
    (band.first, band.last) = (start as u8, end as u8);
    for column in (start..end).step_by(columns as usize) {
        let group = mask(column, columns);
        if wanted & group != 0 {
            band.groups += 1;
            visited |= group;
        } else {
            band.skipped += 1;
        }
    }
    (band, visited)
}
