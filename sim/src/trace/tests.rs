//! Each trace is read back by a reader that shares nothing with its writer, and must tell the same as the events.

use super::*;
use crate::machine::config::Config;
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::simulate_observed;
use crate::machine::workload::{TableOptions, read_table};
use std::collections::HashMap;

fn events(first: u32, last: u32, words: &[&str]) -> Vec<Event> {
    let mut table = String::from("u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1\n");
    for splat in 0..12 {
        let (x, y) = (4 + 5 * (splat % 4), 4 + 4 * (splat % 3));
        table.push_str(&format!(
            "{x},{y},{splat},0.5,0.1,0.6,{},{},{},{}\n",
            x - 3,
            y - 3,
            x + 3,
            y + 3
        ));
    }
    let mut config = Config::default();
    let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
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
    simulate_observed(
        &workload,
        &LaneWork::new(&workload, LaneShape::from(&config)),
        &config,
        &mut recorder,
    );
    recorder.into_events()
}

fn sets() -> [Vec<Event>; 3] {
    [
        events(0, 11, &[]),
        events(
            3,
            5,
            &["lanes=4", "layout=rows", "raster_units=2", "tile_width=8"],
        ),
        events(20, 30, &["lanes=2", "layout=quad"]),
    ]
}

#[test]
fn only_the_splats_asked_for_are_recorded() {
    let [all, some, none] = sets();
    let splats = |events: &[Event]| {
        let mut splats: Vec<u32> = events
            .iter()
            .map(|event| event.splat)
            .filter(|splat| *splat != u32::MAX)
            .collect();
        splats.sort();
        splats.dedup();
        splats
    };
    assert_eq!(splats(&all), (0..12).collect::<Vec<_>>());
    assert_eq!(splats(&some), [3, 4, 5]);
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
        let mut stages: HashMap<(String, String), (u64, Option<u64>)> = HashMap::new();
        let (mut known, mut retired) = (HashMap::new(), 0);
        for line in lines {
            let words: Vec<&str> = line.split('\t').collect();
            match words[0] {
                "C=" => now = words[1].parse().unwrap(),
                "C" => now += words[1].parse::<u64>().unwrap(),
                "I" => assert!(
                    known
                        .insert(words[1].to_owned(), words[2].to_owned())
                        .is_none()
                ),
                "L" => assert!(known.contains_key(words[1])),
                "S" => assert!(
                    stages
                        .insert((words[1].to_owned(), words[3].to_owned()), (now, None))
                        .is_none()
                ),
                "E" => {
                    stages
                        .get_mut(&(words[1].to_owned(), words[3].to_owned()))
                        .unwrap()
                        .1 = Some(now)
                }
                "R" => retired += 1,
                other => panic!("unknown command {other}"),
            }
        }
        assert_eq!(retired, known.len());
        assert!(
            stages
                .values()
                .all(|(start, end)| end.is_some_and(|end| end > *start))
        );
        let shown = [
            Stage::Fetch,
            Stage::Setup,
            Stage::Rows,
            Stage::Lanes,
            Stage::Blend,
        ];
        for stage in shown {
            let (_, letter) = name_of(stage);
            let of_stage = || events.iter().filter(|event| event.stage == stage);
            let first = stages
                .iter()
                .filter(|((_, name), _)| name == letter)
                .map(|(_, (start, _))| *start)
                .min();
            assert_eq!(first, of_stage().map(|event| event.start).min(), "{letter}");
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
            let unit: u32 = scope
                .identifier
                .strip_prefix("raster_")
                .unwrap()
                .parse()
                .unwrap();
            for item in &scope.items {
                let ::vcd::ScopeItem::Var(var) = item else {
                    continue;
                };
                names.insert(var.code, (unit, var.reference.clone()));
            }
        }
        let mut values: HashMap<(u32, String), u64> = HashMap::new();
        let mut now = 0;
        let check = |now: u64, values: &HashMap<(u32, String), u64>| {
            for ((unit, name), value) in values
                .iter()
                .filter(|((_, name), _)| name.ends_with("_items"))
            {
                let of = |event: &&Event| {
                    event.unit == *unit
                        && format!("{}_{}_items", name_of(event.stage).0, event.lane) == *name
                };
                let open = events
                    .iter()
                    .filter(of)
                    .filter(|event| event.start <= now && now < event.end)
                    .count();
                assert_eq!(*value, open as u64, "{name} at {now}");
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
        assert!(
            values
                .iter()
                .filter(|((_, name), _)| name.ends_with("_items"))
                .all(|(_, value)| *value == 0)
        );
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
            match entry["ph"].as_str().unwrap() {
                "M" => {}
                "X" => read.push((
                    number("pid"),
                    category,
                    number("ts"),
                    number("ts") + number("dur"),
                )),
                "b" => assert!(open.insert(number("id"), number("ts")).is_none()),
                "e" => read.push((
                    number("pid"),
                    category,
                    open.remove(&number("id")).unwrap(),
                    number("ts"),
                )),
                other => panic!("unknown phase {other}"),
            }
        }
        assert!(open.is_empty());
        let mut expected: Vec<_> = events
            .iter()
            .map(|e| {
                (
                    u64::from(e.unit),
                    name_of(e.stage).0.to_owned(),
                    e.start,
                    e.end,
                )
            })
            .collect();
        read.sort();
        expected.sort();
        assert_eq!(read, expected);
    }
}
