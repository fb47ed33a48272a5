//! Traces of the raster phase for the viewers that hardware people use.
//!
//! | format | opens in | what it shows |
//! |---|---|---|
//! | [`kanata`] | Konata | one line per splat-tile pair, with its stages as in a pipeline diagram |
//! | [`vcd`] | GTKWave, Surfer | per unit and stage how many items are in it and which splat came last |
//! | [`perfetto`] | ui.perfetto.dev | one track per unit and stage, one slice per item |
//!
//! Requests to a memory part go to the simulators of DRAM instead ([`requests`]).
//!
//! One cycle is one time unit: a cycle in Kanata, 1 ns in VCD, 1 microsecond in Perfetto. Only splats from a first to a
//! last number are recorded; the machine is simulated whole, so that what is recorded is what happens in the whole
//! picture.

pub mod kanata;
pub mod perfetto;
pub mod requests;
pub mod vcd;

use crate::machine::observe::{Event, Observer, Stage};

/// Name of a stage, and the letter that Konata shows.
pub fn name_of(stage: Stage) -> (&'static str, &'static str) {
    match stage {
        Stage::Fetch => ("fetch", "F"),
        Stage::Setup => ("splat_setup", "S"),
        Stage::Rows => ("row_generator", "R"),
        Stage::Lanes => ("lanes", "L"),
        Stage::Blend => ("blend", "B"),
        Stage::WriteBack => ("write_back", "W"),
    }
}

/// Keeps the events of some splats, and the write-backs of the tiles that they touch.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    first: u32,
    last: u32,
    events: Vec<Event>,
}

impl Recorder {
    /// Records splats `first ..= last`.
    pub fn new(first: u32, last: u32) -> Recorder {
        Recorder {
            first,
            last,
            events: Vec::new(),
        }
    }

    /// The events in the order of their first cycles.
    pub fn into_events(self) -> Vec<Event> {
        let mut events = self.events;
        events.sort_by_key(|event| (event.start, event.unit, event.stage, event.lane, event.end));
        events
    }
}

impl Observer for Recorder {
    const WATCHES: bool = true;

    fn event(&mut self, event: Event) {
        let wanted = match event.stage {
            // A write-back comes after all other events of its tile and unit.
            Stage::WriteBack => {
                let mut latest = self.events.iter().rev();
                latest.any(|other| other.tile == event.tile)
            }
            _ => (self.first..=self.last).contains(&event.splat),
        };
        if wanted {
            self.events.push(event);
        }
    }
}

#[cfg(test)]
mod tests;
