//! Cycles of whole pictures: the clock where packets never run out, for all tiles of a picture at once.
//!
//! ```text
//! footprint, nearest first -> spans of its rows, once -> pixels of every row in every tile that its box touches -> that tile's unit
//! ```
//!
//! While packets are always on offer, of the state of [`PrimitiveClock`](super::PrimitiveClock) the recurrence alone is left, with queues of constant
//! length. Rows without pixels are a branch, since the pixels' places are compared with those in flight.
//!
//! The order of tiles does not matter, so that the footprints are gone through once: rows are computed once for all tiles of a row, no lists and
//! no rows are stored, and the units of a picture stay in the second-level cache. [`PrimitiveClock`](super::PrimitiveClock), fed by the kernel's
//! rows, is the definition.

use super::spans::SpanMemory;
use super::{
    BEGINS, FRONT, Flights, PacketStamp, QUEUE, ROW, Ring, SETUP, SETUP_INTERVAL, SLOTS, SPLATS,
    TILE, Turns,
};
use crate::fast::lanes::{Doubles, Portable, VectorLevel, VectorTask, dispatch_vectors};
use rayon::prelude::*;
use splatline::footprint::Footprint;
use splatline::format::Design;
use splatline::raster::{EllipseSpans, Window};

/// Rows of a tile.
const ROWS: usize = TILE[1] as usize;

const _: () = assert!(ROWS == 32);

/// Parts of a picture for every thread, so that none waits long for another.
const PARTS: usize = 4;

/// Cycles that every tile of a picture takes by itself, row by row, as [`PrimitiveClock::idle_at`](super::PrimitiveClock::idle_at) gives them;
/// 0 without splats. A tile's splats are those whose box touches it, in the order of `footprints`.
///
/// Nothing for numbers of lanes that the circuit does not have.
pub fn picture_cycles<D: Design + Sync>(
    design: D,
    footprints: &[Footprint],
    viewport: [u16; 2],
    lanes: usize,
    choice: VectorLevel,
) -> Option<Vec<u64>> {
    match lanes {
        1 => Some(all_tiles::<D, 1>(design, footprints, viewport, choice)),
        2 => Some(all_tiles::<D, 2>(design, footprints, viewport, choice)),
        4 => Some(all_tiles::<D, 4>(design, footprints, viewport, choice)),
        8 => Some(all_tiles::<D, 8>(design, footprints, viewport, choice)),
        16 => Some(all_tiles::<D, 16>(design, footprints, viewport, choice)),
        _ => None,
    }
}

/// Cycles of one tile, a window within a block of the tile buffer, and of every splat in it.
pub fn tile_cycles<'a, D: Design>(
    design: D,
    footprints: impl Iterator<Item = &'a Footprint>,
    window: Window,
    lanes: usize,
    choice: VectorLevel,
    observe: impl FnMut(PacketStamp),
) -> Option<u64> {
    match lanes {
        1 => Some(one_tile::<D, 1>(
            design, footprints, window, choice, observe,
        )),
        2 => Some(one_tile::<D, 2>(
            design, footprints, window, choice, observe,
        )),
        4 => Some(one_tile::<D, 4>(
            design, footprints, window, choice, observe,
        )),
        8 => Some(one_tile::<D, 8>(
            design, footprints, window, choice, observe,
        )),
        16 => Some(one_tile::<D, 16>(
            design, footprints, window, choice, observe,
        )),
        _ => None,
    }
}

fn one_tile<'a, D: Design, const LANES: usize>(
    design: D,
    footprints: impl Iterator<Item = &'a Footprint>,
    window: Window,
    choice: VectorLevel,
    observe: impl FnMut(PacketStamp),
) -> u64 {
    let mut units = [BandUnit::<LANES>::new()];
    let units_of_tile = &mut units;
    let band = PictureBand {
        design,
        footprints,
        window,
        units: units_of_tile,
        observe,
    };
    band.run_on(choice);
    units[0].cycles()
}

fn all_tiles<D: Design + Sync, const LANES: usize>(
    design: D,
    footprints: &[Footprint],
    viewport: [u16; 2],
    choice: VectorLevel,
) -> Vec<u64> {
    let [columns, rows] = [0, 1].map(|axis| usize::from(viewport[axis].div_ceil(TILE[axis])));
    let threads = rayon::current_num_threads();
    let parts = if threads == 1 { 1 } else { PARTS * threads };
    let height = rows.div_ceil(parts).max(1);
    let mut units = vec![BandUnit::<LANES>::new(); columns * rows];
    let bands = units.par_chunks_mut((columns * height).max(1)).enumerate();
    bands.for_each(|(number, units)| {
        let row = |tile: usize| (tile * ROWS).min(viewport[1].into()) as u16;
        let window = Window {
            first: [0, row(number * height)],
            end: [viewport[0], row((number + 1) * height)],
        };
        let footprints = footprints
            .iter()
            .filter(|footprint| touches(footprint, &window));
        let band = PictureBand {
            design,
            footprints,
            window,
            units,
            observe: |_| (),
        };
        band.run_on(choice);
    });
    units.iter().map(BandUnit::cycles).collect()
}

fn touches(footprint: &Footprint, window: &Window) -> bool {
    let bounds = Window::of(footprint);
    !bounds.intersect(window).is_empty()
}

/// Tiles that lie within a window, to be fed with footprints in order.
struct PictureBand<'u, D, I, O, const LANES: usize> {
    design: D,
    footprints: I,
    window: Window,
    units: &'u mut [BandUnit<LANES>],
    observe: O,
}

impl<'a, D, I, O, const LANES: usize> PictureBand<'_, D, I, O, LANES>
where
    D: Design,
    I: Iterator<Item = &'a Footprint>,
    O: FnMut(PacketStamp),
{
    fn run_on(self, choice: VectorLevel) {
        if let Err(band) = dispatch_vectors(choice, self) {
            band.run(Portable);
        }
    }
}

impl<'a, D, I, O, const LANES: usize> VectorTask for PictureBand<'_, D, I, O, LANES>
where
    D: Design,
    I: Iterator<Item = &'a Footprint>,
    O: FnMut(PacketStamp),
{
    type Output = ();

    #[inline(always)]
    fn run<L: Doubles>(self, lanes: L) {
        let PictureBand {
            design,
            footprints,
            window,
            units,
            mut observe,
        } = self;
        let mut spans = SpanMemory::new(usize::from(window.end[1] - window.first[1]));
        let blocks = blocks(&window);
        for footprint in footprints {
            let bounds = Window::of(footprint);
            let visible = bounds.intersect(&window);
            if visible.is_empty() {
                if let Some(unit) = units.first_mut() {
                    observe(unit.splat(0, &[0; ROWS], &[0; ROWS], 1));
                }
                continue;
            }
            spans.fill(lanes, EllipseSpans::new(design, footprint, &window));
            for_each_tile(&visible, |tile, part| {
                let row = usize::from(part.first[1] - visible.first[1]);
                let Some((first, end)) = spans.starting_at(row) else {
                    return;
                };
                let count = usize::from(part.end[1] - part.first[1]);
                let columns = columns_from(first, &part);
                let lengths = lengths(&columns, end, &part, count);
                let [x, y] = [0, 1].map(|axis| usize::from(tile[axis]) - blocks.first[axis]);
                if let Some(unit) = units.get_mut(y * blocks.columns + x) {
                    observe(unit.splat(part.first[1], &columns, &lengths, count));
                }
            });
        }
    }
}

/// The tiles that a window touches: the first one's numbers, and how many there are in a row.
struct Blocks {
    first: [usize; 2],
    columns: usize,
}

fn blocks(window: &Window) -> Blocks {
    let first = [0, 1].map(|axis| usize::from(window.first[axis] / TILE[axis]));
    let columns = usize::from(window.end[0].div_ceil(TILE[0])) - first[0];
    Blocks { first, columns }
}

/// The tiles that a window touches, which has pixels: their numbers, and their parts of the window.
#[inline(always)]
fn for_each_tile(window: &Window, mut each: impl FnMut([u16; 2], Window)) {
    let range = |axis: usize| window.first[axis] / TILE[axis]..=(window.end[axis] - 1) / TILE[axis];
    for y in range(1) {
        for x in range(0) {
            let tile = [x, y];
            let first = [0, 1].map(|axis| window.first[axis].max(tile[axis] * TILE[axis]));
            // Not the product for the next tile, which may lie beyond 16 bits.
            let rest = [0, 1].map(|axis| TILE[axis] - first[axis] % TILE[axis]);
            let last =
                [0, 1].map(|axis| window.end[axis].min(first[axis].saturating_add(rest[axis])));
            each(tile, Window { first, end: last });
        }
    }
}

/// First columns of a tile's rows.
#[inline(always)]
fn columns_from(first: &[u16; ROWS], part: &Window) -> [u16; ROWS] {
    first.map(|first| first.max(part.first[0]))
}

/// Pixels of a tile's rows, of which the splat has `count`.
#[inline(always)]
fn lengths(first: &[u16; ROWS], end: &[u16; ROWS], part: &Window, count: usize) -> [u16; ROWS] {
    std::array::from_fn(|row| {
        let length = end[row].min(part.end[0]).saturating_sub(first[row]);
        if row < count { length } else { 0 }
    })
}

/// A primitive that draws one tile and whose packets never run out.
#[derive(Clone, Debug)]
struct BandUnit<const LANES: usize> {
    /// As in [`super::PrimitiveClock`].
    turns: Turns,
    begun: u64,
    issued: u64,
    left: u64,
    last: u64,
    splats: Ring<SPLATS>,
    slots: Ring<SLOTS>,
    moves: [Ring<{ QUEUE as usize }>; LANES],
    flights: [Flights; LANES],
}

impl<const LANES: usize> BandUnit<LANES> {
    fn new() -> Self {
        BandUnit {
            turns: Turns::new(SETUP_INTERVAL, 0),
            begun: 0,
            issued: 0,
            left: 0,
            last: 0,
            splats: Ring::NEW,
            slots: Ring::NEW,
            moves: [const { Ring::NEW }; LANES],
            flights: [const { Flights::NEW }; LANES],
        }
    }

    /// A splat whose first slot is `row`, and as many slots as it has rows in the tile, at least one; a row without pixels has length 0.
    #[inline(always)]
    fn splat(
        &mut self,
        row: u16,
        columns: &[u16; ROWS],
        lengths: &[u16; ROWS],
        count: usize,
    ) -> PacketStamp {
        let taken = self.turns.take(self.splats.free());
        let begun = self.begun.max(taken + SETUP);
        self.splats.leave(begun);
        self.begun = begun + BEGINS;
        self.issued = self.issued.max(begun + 1);
        let rows = (row..).zip(columns.iter().zip(lengths));
        for (row, (column, length)) in rows.take(count) {
            self.slot(row, *column, *length);
        }
        PacketStamp { taken, begun }
    }

    /// The next slot.
    #[inline(always)]
    fn slot(&mut self, row: u16, column: u16, length: u16) {
        let issued = self.issued.max(self.slots.free());
        self.issued = issued + 1;
        self.begun = self.begun.max(issued);
        let mut left = self.left.max(issued + ROW);
        self.last = self.last.max(left);
        if length > 0 {
            let lane = usize::from(row) % LANES;
            let (moves, flights) = (&mut self.moves[lane], &mut self.flights[lane]);
            left = left.max(moves.free());
            let moved = flights.popped.max(left + 1);
            moves.leave(moved);
            flights.pop(moved + FRONT, row, column, length);
        }
        self.slots.leave(left);
        self.left = left + 1;
    }

    /// The first cycle in which nothing is in it any more; 0 if nothing ever was.
    fn cycles(&self) -> u64 {
        let ends = self.flights.iter().map(|flights| flights.free);
        let busy = ends.fold(self.last, u64::max);
        if self.splats.count == 0 { 0 } else { busy + 2 }
    }
}
