//! Value change dump (IEEE 1364): for every raster unit, stage and lane, how many items are in it and which splat entered last.

use super::name_of;
use crate::machine::observe::{Event, Stage};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Unit, stage and lane.
type VcdPlace = (u32, Stage, u32);

/// The dump of some events.
pub fn dump(events: &[Event]) -> String {
    let places: BTreeSet<VcdPlace> = events
        .iter()
        .map(|event| (event.unit, event.stage, event.lane))
        .collect();
    let numbers: BTreeMap<VcdPlace, usize> = places
        .iter()
        .zip(0..)
        .map(|(place, number)| (*place, number))
        .collect();
    let mut text = header(&numbers);
    // Items that come or go, and the splat that came last, by cycle and place.
    let mut changes: BTreeMap<u64, BTreeMap<usize, (i64, Option<u32>)>> = BTreeMap::new();
    for event in events {
        let number = numbers[&(event.unit, event.stage, event.lane)];
        let come = changes
            .entry(event.start)
            .or_default()
            .entry(number)
            .or_default();
        come.0 += 1;
        come.1 = Some(event.splat);
        changes
            .entry(event.end)
            .or_default()
            .entry(number)
            .or_default()
            .0 -= 1;
    }
    let mut items = vec![0i64; numbers.len()];
    let first = changes.keys().next().copied().unwrap_or(0);
    // Writing to a String cannot fail.
    let _ = writeln!(text, "#{first}\n$dumpvars");
    for number in 0..numbers.len() {
        let _ = writeln!(text, "b0 {}\nbx {}", code(2 * number), code(2 * number + 1));
    }
    text.push_str("$end\n");
    for (cycle, places) in changes {
        if cycle > first {
            let _ = writeln!(text, "#{cycle}");
        }
        for (number, (change, splat)) in places {
            if change != 0 {
                items[number] += change;
                let _ = writeln!(text, "b{:b} {}", items[number], code(2 * number));
            }
            if let Some(splat) = splat {
                let _ = writeln!(text, "b{splat:b} {}", code(2 * number + 1));
            }
        }
    }
    text
}

fn header(numbers: &BTreeMap<VcdPlace, usize>) -> String {
    let mut text = String::from(
        "$comment one cycle is 1 ns; a write-back's splat is 4294967295 $end\n$timescale 1 ns $end\n",
    );
    let mut unit = None;
    for ((of, stage, lane), number) in numbers {
        if unit != Some(of) {
            if unit.is_some() {
                text.push_str("$upscope $end\n");
            }
            let _ = writeln!(text, "$scope module raster_{of} $end");
            unit = Some(of);
        }
        let (name, _) = name_of(*stage);
        let _ = writeln!(
            text,
            "$var wire 32 {} {name}_{lane}_items $end",
            code(2 * number)
        );
        let _ = writeln!(
            text,
            "$var wire 32 {} {name}_{lane}_splat $end",
            code(2 * number + 1)
        );
    }
    if unit.is_some() {
        text.push_str("$upscope $end\n");
    }
    text.push_str("$enddefinitions $end\n");
    text
}

/// A signal's identifier: digits to base 94 from '!' to '~'.
fn code(mut number: usize) -> String {
    let mut code = String::new();
    loop {
        code.push((b'!' + (number % 94) as u8) as char);
        number /= 94;
        if number == 0 {
            return code;
        }
    }
}
