//! Trace events in JSON, as Perfetto and Chrome read them: a process per raster unit, a track per stage and lane.
//!
//! Fetches overlap in flight, as do blends; they are asynchronous slices with an identifier each, all others are
//! complete slices.

use super::name_of;
use crate::machine::observe::{Event, Stage};
use serde_json::{Value, json};
use std::collections::BTreeSet;

pub fn trace(events: &[Event]) -> String {
    let mut entries: Vec<Value> = Vec::new();
    let units: BTreeSet<u32> = events.iter().map(|event| event.unit).collect();
    let tracks: BTreeSet<(u32, Stage, u32)> = events
        .iter()
        .map(|event| (event.unit, event.stage, event.lane))
        .collect();
    for unit in units {
        entries.push(json!({"ph": "M", "name": "process_name", "pid": unit, "args": {"name": format!("raster unit {unit}")}}));
    }
    for (unit, stage, lane) in tracks {
        let name = if stage == Stage::Lanes {
            format!("lanes {lane}")
        } else {
            name_of(stage).0.to_owned()
        };
        entries.push(json!({"ph": "M", "name": "thread_name", "pid": unit, "tid": track(stage, lane), "args": {"name": name}}));
    }
    for (id, event) in events.iter().enumerate() {
        slice(id, event, &mut entries);
    }
    let whole = json!({"displayTimeUnit": "ns", "otherData": {"unit": "1 us is one clock cycle"}, "traceEvents": entries});
    format!("{whole}\n")
}

fn track(stage: Stage, lane: u32) -> u32 {
    stage as u32 * 100 + lane
}

fn slice(id: usize, event: &Event, entries: &mut Vec<Value>) {
    let (unit, stage, start, end) = (event.unit, event.stage, event.start, event.end);
    let (category, _) = name_of(stage);
    let args = json!({"tile": event.tile, "splat": event.splat, "row": event.row});
    let name = if stage == Stage::WriteBack {
        format!("tile {}", event.tile)
    } else {
        format!("splat {}", event.splat)
    };
    let tid = track(stage, event.lane);
    if matches!(stage, Stage::Fetch | Stage::Blend) {
        let end_of = |phase: &str, time: u64| json!({"ph": phase, "name": name, "cat": category, "id": id, "pid": unit, "tid": tid, "ts": time, "args": args});
        entries.push(end_of("b", start));
        entries.push(end_of("e", end));
    } else {
        entries.push(json!({"ph": "X", "name": name, "cat": category, "pid": unit, "tid": tid, "ts": start, "dur": end - start, "args": args}));
    }
}
