//! Value change dump (IEEE 1364): for every raster unit, stage and lane, how many items are in it and which splat
//! entered last.

use super::name_of;
use crate::machine::observe::{Event, Stage};
use ::vcd::{IdCode, SimulationCommand, TimescaleUnit, Value, Writer};
use std::collections::{BTreeMap, BTreeSet};
use std::io;

/// Unit, stage and lane.
type VcdPlace = (u32, Stage, u32);

/// What changes at a place in a cycle: items that come or go, and the splat that came last.
type Change = (i64, Option<u32>);

pub fn dump(events: &[Event]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut writer = Writer::new(&mut bytes);
    let signals = header(&mut writer, events)?;
    let mut changes: BTreeMap<u64, BTreeMap<VcdPlace, Change>> = BTreeMap::new();
    for event in events {
        let place = (event.unit, event.stage, event.lane);
        let mut at = |cycle: u64, items: i64, splat: Option<u32>| {
            let change = changes.entry(cycle).or_default().entry(place).or_default();
            *change = (change.0 + items, splat.or(change.1));
        };
        at(event.start, 1, Some(event.splat));
        at(event.end, -1, None);
    }
    let first = changes.keys().next().copied().unwrap_or(0);
    writer.timestamp(first)?;
    writer.begin(SimulationCommand::Dumpvars)?;
    for [items, splat] in signals.values() {
        writer.change_vector(*items, [Value::V0])?;
        writer.change_vector(*splat, [Value::X])?;
    }
    writer.end()?;
    let mut items: BTreeMap<VcdPlace, i64> = BTreeMap::new();
    for (cycle, places) in changes {
        if cycle > first {
            writer.timestamp(cycle)?;
        }
        for (place, (moved, splat)) in places {
            let [of_items, of_splat] = signals[&place];
            if moved != 0 {
                let now = items.entry(place).or_default();
                *now += moved;
                writer.change_vector(of_items, bits(*now as u32))?;
            }
            if let Some(splat) = splat {
                writer.change_vector(of_splat, bits(splat))?;
            }
        }
    }
    Ok(bytes)
}

/// Declares the signals of every place: its items and its splat.
fn header(
    writer: &mut Writer<&mut Vec<u8>>,
    events: &[Event],
) -> io::Result<BTreeMap<VcdPlace, [IdCode; 2]>> {
    writer.comment("one cycle is 1 ns; a write-back's splat is 4294967295")?;
    writer.timescale(1, TimescaleUnit::NS)?;
    let place = |event: &Event| (event.unit, event.stage, event.lane);
    let places: BTreeSet<VcdPlace> = events.iter().map(place).collect();
    let units: BTreeSet<u32> = places.iter().map(|(unit, ..)| *unit).collect();
    let mut signals = BTreeMap::new();
    for unit in units {
        writer.add_module(&format!("raster_{unit}"))?;
        for place in places.iter().filter(|(of, ..)| *of == unit) {
            let (_, stage, lane) = place;
            let (name, _) = name_of(*stage);
            let items = writer.add_wire(32, &format!("{name}_{lane}_items"))?;
            let splat = writer.add_wire(32, &format!("{name}_{lane}_splat"))?;
            signals.insert(*place, [items, splat]);
        }
        writer.upscope()?;
    }
    writer.enddefinitions()?;
    Ok(signals)
}

/// The bits of a number from its highest one.
fn bits(number: u32) -> impl Iterator<Item = Value> {
    let count = (u32::BITS - number.leading_zeros()).max(1);
    (0..count)
        .rev()
        .map(move |bit| Value::from(number >> bit & 1 == 1))
}
