//! Kanata 0004, the log format of Konata: one "instruction" per splat-tile pair.
//!
//! Stages of a pair overlap (its first row is in the lanes while its last is being generated), so each stage is drawn
//! in a lane of its own, from the first cycle of the pair's first item to the end of its last. A pair retires when its
//! last pixel is blended. The thread of a pair is its raster unit.

use super::name_of;
use crate::machine::observe::{Event, Stage};
use std::collections::BTreeMap;

/// One pair: unit, tile, splat.
type TracedPair = (u32, u32, u32);

/// First and one past the last cycle of every stage of a pair.
type TracedStages = BTreeMap<Stage, (u64, u64)>;

pub fn log(events: &[Event]) -> String {
    let mut pairs: BTreeMap<TracedPair, TracedStages> = BTreeMap::new();
    let of_pairs = |event: &&Event| event.stage != Stage::WriteBack;
    for event in events.iter().filter(of_pairs) {
        let pair = (event.unit, event.tile, event.splat);
        let stages = pairs.entry(pair).or_default();
        let times = (event.start, event.end);
        let (start, end) = stages.entry(event.stage).or_insert(times);
        (*start, *end) = ((*start).min(event.start), (*end).max(event.end));
    }
    let mut order: Vec<(TracedPair, TracedStages)> = pairs.into_iter().collect();
    let begin = |stages: &TracedStages| stages.values().map(|(start, _)| *start).min().unwrap_or(0);
    order.sort_by_key(|(pair, stages)| (begin(stages), *pair));

    // Lines by cycle; within a cycle ends come before starts, and a pair's head before its stages.
    let mut lines: Vec<(u64, u8, String)> = Vec::new();
    for (id, ((unit, tile, splat), stages)) in order.iter().enumerate() {
        let start = begin(stages);
        let mut end = start;
        lines.push((start, 1, format!("I\t{id}\t{splat}\t{unit}")));
        lines.push((start, 1, format!("L\t{id}\t0\tsplat {splat} tile {tile}")));
        for (stage, (from, to)) in stages {
            let lane = *stage as u32;
            let (_, letter) = name_of(*stage);
            // A stage that takes no time still shows for one cycle.
            let to = (*to).max(from + 1);
            lines.push((*from, 2, format!("S\t{id}\t{lane}\t{letter}")));
            lines.push((to, 0, format!("E\t{id}\t{lane}\t{letter}")));
            end = end.max(to);
        }
        lines.push((end, 3, format!("R\t{id}\t{id}\t0")));
    }
    lines.sort_by_key(|(cycle, rank, _)| (*cycle, *rank));

    let mut text = String::from("Kanata\t0004\n");
    let mut now = lines.first().map_or(0, |(cycle, ..)| *cycle);
    text += &format!("C=\t{now}\n");
    for (cycle, _, line) in lines {
        if cycle > now {
            text += &format!("C\t{}\n", cycle - now);
            now = cycle;
        }
        text.push_str(&line);
        text.push('\n');
    }
    text
}
