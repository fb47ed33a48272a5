//! Each trace is read back by a reader that shares nothing with its writer, and must tell the same as the events.

use super::*;
use crate::machine::config::Config;
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::simulate_observed;
use crate::machine::workload::{TableOptions, read_table};
use std::collections::{BTreeSet, HashMap};

fn events(first: u32, last: u32, words: &str) -> Vec<Event> {
    let mut table = String::from("u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1\n");
    for splat in 0..12 {
        let (x, y) = (4 + 5 * (splat % 4), 4 + 4 * (splat % 3));
        let [left, top, right, bottom] = [x - 3, y - 3, x + 3, y + 3];
        table += &format!("{x},{y},{splat},0.5,0.1,0.6,{left},{top},{right},{bottom}\n");
    }
    let mut config = Config::default();
    let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
    config.set_words(&words).unwrap();
    let options = TableOptions {
        viewport: [24, 16],
        tile: [config.tile_width, config.tile_height],
        traversal: splatline::format::Traversal::Spans,
        cutoff: Some(4.0),
        packet_bytes: 48,
    };
    let workload = read_table(&table, &options).unwrap();
    let mut recorder = Recorder::new(first, last);
    let work = LaneWork::new(&workload, LaneShape::from(&config));
    simulate_observed(&workload, &work, &config, &mut recorder);
    recorder.into_events()
}

fn sets() -> [Vec<Event>; 3] {
    [
        events(0, 11, ""),
        events(3, 5, "lanes=4 layout=rows raster_units=2 tile_width=8"),
        events(20, 30, "lanes=2 layout=quad"),
    ]
}

#[test]
fn only_the_splats_asked_for_are_recorded() {
    let [all, some, none] = sets();
    let splats = |events: &[Event]| -> BTreeSet<u32> {
        let splats = events.iter().map(|event| event.splat);
        splats.filter(|splat| *splat != u32::MAX).collect()
    };
    assert_eq!(splats(&all), (0..12).collect());
    assert_eq!(splats(&some), (3..6).collect());
    assert!(none.is_empty());
    assert!(some.iter().any(|event| event.stage == Stage::WriteBack));
}

/// Instructions with the cycles of their stages: reads what Konata's format description says.
#[test]
fn kanata_reads_back() {
    for events in sets() {
        let text = kanata::log(&events);
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("Kanata\t0004"));
        let mut now = 0u64;
        let mut stages: HashMap<(&str, &str), (u64, Option<u64>)> = HashMap::new();
        let (mut known, mut retired) = (BTreeSet::new(), 0);
        for line in lines {
            let words: Vec<&str> = line.split('\t').collect();
            let stage = || (words[1], words[3]);
            match words[0] {
                "C=" => now = words[1].parse().unwrap(),
                "C" => now += words[1].parse::<u64>().unwrap(),
                "I" => assert!(known.insert(words[1]), "{line}"),
                "L" => assert!(known.contains(words[1]), "{line}"),
                "S" => assert!(stages.insert(stage(), (now, None)).is_none(), "{line}"),
                "E" => stages.get_mut(&stage()).unwrap().1 = Some(now),
                "R" => retired += 1,
                other => panic!("unknown command {other}"),
            }
        }
        assert_eq!(retired, known.len());
        let mut times = stages.values();
        assert!(times.all(|(start, end)| end.is_some_and(|end| end > *start)));
        use Stage::{Blend, Fetch, Lanes, Rows, Setup};
        for stage in [Fetch, Setup, Rows, Lanes, Blend] {
            let (_, letter) = name_of(stage);
            let shown = stages.iter().filter(|((_, name), _)| *name == letter);
            let begun = events.iter().filter(|event| event.stage == stage);
            let first = begun.map(|event| event.start).min();
            assert_eq!(shown.map(|(_, (start, _))| *start).min(), first, "{letter}");
        }
    }
}

/// Replays the changes and compares with the number of events that are open in every cycle.
#[test]
fn vcd_reads_back() {
    for events in sets() {
        let text = vcd::dump(&events).unwrap();
        let mut parser = ::vcd::Parser::new(&text[..]);
        let header = parser.parse_header().unwrap();
        assert_eq!(header.timescale, Some((1, ::vcd::TimescaleUnit::NS)));
        let mut names = HashMap::new();
        for scope in &header.items {
            let ::vcd::ScopeItem::Scope(scope) = scope else {
                continue;
            };
            let unit = scope.identifier.strip_prefix("raster_").unwrap();
            let unit: u32 = unit.parse().unwrap();
            for item in &scope.items {
                let ::vcd::ScopeItem::Var(var) = item else {
                    continue;
                };
                names.insert(var.code, (unit, var.reference.clone()));
            }
        }
        let mut values: HashMap<(u32, String), u64> = HashMap::new();
        let mut now = 0;
        let items = |((_, name), _): &(&(u32, String), &u64)| name.ends_with("_items");
        let check = |now: u64, values: &HashMap<(u32, String), u64>| {
            for ((unit, name), value) in values.iter().filter(items) {
                let open = events.iter().filter(|event| {
                    let place = format!("{}_{}_items", name_of(event.stage).0, event.lane);
                    let there = event.unit == *unit && place == *name;
                    there && event.start <= now && now < event.end
                });
                assert_eq!(*value, open.count() as u64, "{name} at {now}");
            }
        };
        for command in parser {
            match command.unwrap() {
                ::vcd::Command::Timestamp(time) => {
                    check(now, &values);
                    now = time;
                }
                ::vcd::Command::ChangeVector(code, bits) => {
                    let value = bits.iter().fold(0, |value, bit| {
                        value * 2 + u64::from(bit == ::vcd::Value::V1)
                    });
                    values.insert(names[&code].clone(), value);
                }
                _ => {}
            }
        }
        check(now, &values);
        assert!(values.iter().filter(items).all(|(_, value)| *value == 0));
    }
}

#[test]
fn perfetto_reads_back() {
    for events in sets() {
        let whole: serde_json::Value = serde_json::from_str(&perfetto::trace(&events)).unwrap();
        let entries = whole["traceEvents"].as_array().unwrap();
        let mut open: HashMap<u64, u64> = HashMap::new();
        let mut read: Vec<(u64, String, u64, u64)> = Vec::new();
        for entry in entries {
            let number = |key: &str| entry[key].as_u64().unwrap();
            let category = entry["cat"].as_str().unwrap_or("").to_owned();
            let [start, end] = match entry["ph"].as_str().unwrap() {
                "X" => [number("ts"), number("ts") + number("dur")],
                "e" => [open.remove(&number("id")).unwrap(), number("ts")],
                "b" => {
                    assert!(open.insert(number("id"), number("ts")).is_none());
                    continue;
                }
                "M" => continue,
                other => panic!("unknown phase {other}"),
            };
            read.push((number("pid"), category, start, end));
        }
        assert!(open.is_empty());
        let event = |e: &Event| {
            let category = name_of(e.stage).0.to_owned();
            (u64::from(e.unit), category, e.start, e.end)
        };
        let mut expected: Vec<_> = events.iter().map(event).collect();
        read.sort();
        expected.sort();
        assert_eq!(read, expected);
    }
}
