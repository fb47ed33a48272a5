//! Lanes that advance together over the bands of a tile, and the interlock that keeps a pixel from being read before it
//! is written (`docs/hardware-model.md` section 2); the row generator's steps beside them.

use super::accounts::{Account, Cause, Fifo};
use super::lanes::Band;

/// What a visit to a group of pixels takes.
#[derive(Clone, Copy, Debug)]
pub struct VisitCosts {
    /// Cycles a group.
    pub stretch: u64,
    /// Columns a cycle.
    pub stride: u64,
    /// From reading a pixel to writing it.
    pub blend_latency: u64,
}

/// A run in flight, for the read-after-write interlock.
#[derive(Clone, Copy, Debug)]
struct PacketInFlight {
    first: u8,
    last: u8,
    start: u64,
    /// When its last group's pixels can be read again.
    settled: u64,
}

/// Lanes that advance together: all of them, or one lane that owns its rows.
#[derive(Clone, Debug)]
pub struct Sequencer {
    pub account: Account,
    pub fifo: Fifo,
    rows: Vec<RowFlights>,
}

/// The runs in flight on one row of the tile, or on one pair of rows with quads.
#[derive(Clone, Debug, Default)]
struct RowFlights {
    /// When the last of them has settled; they settle in the order in which they came.
    settled: u64,
    flights: Vec<PacketInFlight>,
}

/// Flights of a row beyond which those that have settled are thrown out.
const MANY_FLIGHTS: usize = 16;

impl Sequencer {
    /// Idle, before a tile of so many rows.
    pub fn new(fifo: u32, rows: usize) -> Sequencer {
        Sequencer {
            account: Account::default(),
            fifo: Fifo::new(fifo),
            rows: vec![RowFlights::default(); rows],
        }
    }

    /// No pixel of another tile is in flight here.
    pub fn begin_tile(&mut self) {
        self.rows.iter_mut().for_each(|row| row.settled = 0);
    }

    /// Holds the band until a buffer is free and no pixel meets one in flight, then visits it; gives the first cycle.
    #[inline(always)]
    pub fn visit(&mut self, band: &Band, buffer: u64, costs: &VisitCosts) -> u64 {
        self.account.wait(Cause::TileBuffer, buffer);
        let free = self.held_until(band, costs);
        self.account.wait(Cause::Hazard, free);
        let start = self.account.at();
        let cycles = u64::from(band.groups) * costs.stretch;
        self.account.work(cycles);
        let settled = start + cycles - costs.stretch + costs.blend_latency;
        let row = &mut self.rows[usize::from(band.y)];
        row.settled = settled;
        row.flights.push(PacketInFlight {
            first: band.first,
            last: band.last,
            start,
            settled,
        });
        start
    }

    /// The interlock: see the document for the rule.
    #[inline(always)]
    fn held_until(&mut self, band: &Band, costs: &VisitCosts) -> u64 {
        let now = self.account.at();
        let row = &mut self.rows[usize::from(band.y)];
        if row.settled <= now {
            row.flights.clear();
            return now;
        }
        if row.flights.len() > MANY_FLIGHTS {
            row.flights.retain(|flight| flight.settled > now);
        }
        // Those that have settled hold nothing back.
        let mut until = now;
        for flight in &row.flights {
            if flight.first >= band.last || band.first >= flight.last {
                continue;
            }
            let ahead = u64::from(band.first)
                .saturating_sub(flight.first.into())
                .div_ceil(costs.stride);
            let behind = u64::from(flight.first).saturating_sub(band.first.into()) / costs.stride;
            let groups = ahead + u64::from(band.skipped);
            let pixelwise = (flight.start + costs.blend_latency + groups * costs.stretch)
                .saturating_sub(behind * costs.stretch);
            until = until.max(pixelwise.min(flight.settled));
        }
        until
    }
}

/// Counts the row generator's steps over the rows of one pair.
pub struct Steps {
    at_once: u32,
    /// Rows that the last step has made and no band has taken.
    spare: u32,
}

impl Steps {
    /// Before the first row.
    pub fn new(at_once: u32) -> Steps {
        Steps { at_once, spare: 0 }
    }

    /// Steps begun for the next so many rows.
    #[inline(always)]
    pub fn make(&mut self, rows: u8) -> u64 {
        let rows = u32::from(rows);
        if rows <= self.spare {
            self.spare -= rows;
            return 0;
        }
        let missing = rows - self.spare;
        // Most often one step is enough; the division is for tall gaps.
        let steps = if missing <= self.at_once {
            1
        } else {
            missing.div_ceil(self.at_once)
        };
        self.spare = steps * self.at_once - missing;
        steps.into()
    }
}
