//! answer.html: an answer as a page in the report's style. Limits and margins, what was looked at, the machine as a
//! block diagram with the bytes that each unit moves, where cycles go, energy and traffic by unit, and what a change of
//! each knob would do.

use super::answer::{Answer, Found, Standing};
use super::answer_text::units_of;
use super::detail::{Detail, Knob};
use super::evaluator::Reached;
use super::formats::{self, FormatRow};
use super::limits::{Limit, are_held};
use super::refusal;
use crate::machine::config::Config;
use crate::machine::timing::Timing;
use crate::report::chart::{Anchor, Axis, Chart};
use crate::report::html::{Column, escape, headline_of, html_table, section, table_of};
use crate::report::labels::Rectangle;
use crate::report::machine::sections;
use crate::report::shell::Shell;
use crate::report::table::count;
use serde_json::Value;

/// Width of the diagram and of the scatter: what a telephone shows without scrolling.
const WIDTH: f64 = 380.0;

/// Attojoules of a millijoule.
const MILLI: f64 = 1e15;

/// The page. `note` is what is to be known of the area.
pub fn page(title: &str, answer: &Answer, detail: Option<&Detail>, note: &str) -> String {
    let facts = format!(
        "<p class=\"facts\">{} machines simulated and {} designs drawn, on {} of {} frames.</p>\n",
        answer.points, answer.designs, answer.frames[0], answer.frames[1]
    );
    let mut body = String::new();
    if !answer.ruled_out.is_empty() {
        let text = escape(&refusal::text(&answer.ruled_out));
        body += &section("No machine can hold it", &format!("<pre>{text}</pre>"));
    }
    if let Some(first) = answer.found.first() {
        body += &headline(first);
        let title = if answer.holds {
            "Limits and what is left of them"
        } else {
            "Limits: no machine was found that holds all of them"
        };
        body += &section(title, &limits(answer));
        body += &section("What was looked at", &looked_at(answer));
        if !answer.formats.is_empty() {
            body += &section("In floating-point formats", &in_formats(answer));
        }
        if let Some(detail) = detail {
            body += &of_machine(first, detail);
        }
        body += &section("Widths", &widths(first));
    }
    let clock = answer.found.first().map(|found| &found.reached.pace.clock);
    let clock = clock.map_or(String::new(), |clock| {
        format!("{} MHz: {}. ", clock.mhz, clock.of)
    });
    let notes = clock + note;
    body += &section(
        "What it rests on",
        &format!("<p class=\"read\">{}</p>", escape(&notes)),
    );
    Shell::still("splatline: the cheapest machine", title, &facts, &body).html()
}

fn headline(found: &Found) -> String {
    let (reached, pace) = (&found.reached, &found.reached.pace);
    let error = reached.error.map(|error| format!("{:.2e}", error.max_abs));
    let megabytes = pace.bytes_per_frame as f64 / 1e6;
    headline_of(&[
        ("frames a second", format!("{:.1}", pace.frames_per_s)),
        ("LUT in all", count(reached.cost().round() as u64)),
        ("mJ a frame", format!("{:.3}", reached.millijoules)),
        ("MB a frame", format!("{megabytes:.2}")),
        ("largest error", error.unwrap_or("-".to_owned())),
    ])
}

/// A narrow table.
const SHORT: &str = " class=\"short\"";

fn limits(answer: &Answer) -> String {
    let columns: [Column<&Standing>; 6] = [
        ("limit", &|one| one.limit.quantity.name().to_owned()),
        ("bound", &|one| one.limit.quantity.show(one.limit.bound)),
        ("reached", &|one| one.limit.quantity.show(one.value)),
        ("left", &|one| format!("{:.1} %", 100.0 * one.slack)),
        ("of", &|one| escape(&one.limit.of)),
        ("LUT in all without it", &|one| {
            let without = one.cost_without.map(|cost| format!("{cost:.0}"));
            without.unwrap_or("-".to_owned())
        }),
    ];
    table_of(SHORT, &[0], &columns, &answer.standings)
}

/// Where a plot lies that has so much room for numbers on its left, and its lower edge.
fn plot(left: f64) -> (Rectangle, f64) {
    let frame = Rectangle::new([left, 34.0], [WIDTH - left - 14.0, 220.0]);
    let base = frame.top + frame.height;
    (frame, base)
}

/// Cost against frames a second of every machine that was simulated.
fn looked_at(answer: &Answer) -> String {
    let (frame, base) = plot(52.0);
    let rates = answer.looked_at.iter().map(|one| one.pace.frames_per_s);
    let costs = answer.looked_at.iter().map(Reached::cost);
    let limits = answer.standings.iter().map(|standing| &standing.limit);
    let limits: Vec<Limit> = limits.cloned().collect();
    let across = Axis::of_values(costs, 100.0, frame.across());
    let up = Axis::of_values(rates, 0.01, frame.upwards());
    let label = "area and frames a second of all machines";
    let mut chart = Chart::new(WIDTH, base + 46.0, label);
    chart.rows(&frame, &up, &up.ticks(5));
    chart.columns(&frame, &across, &across.ticks(4));
    chart.names(&frame, "LUT in all", "frames a second");
    for one in &answer.looked_at {
        let (cost, rate) = (one.cost(), one.pace.frames_per_s);
        let (class, holds) = if are_held(&limits, one) {
            ("class=\"mark s2\"", "holds all limits")
        } else {
            ("class=\"mark s5\" opacity=\"0.45\"", "misses a limit")
        };
        let words = format!("{cost:.0} LUT in all, {rate:.1} frames a second: {holds}");
        chart.disc((across.at(cost), up.at(rate)), 3.0, class, &words);
    }
    if let Some(first) = answer.found.first() {
        let reached = &first.reached;
        let place = (across.at(reached.cost()), up.at(reached.pace.frames_per_s));
        chart.disc(place, 6.0, "class=\"mark s0\"", "the answer");
    }
    format!(
        "<p class=\"read\">Red is the answer, green holds all limits, grey misses one. What could not be better was not simulated.</p>\n\
         <div class=\"diagram\">{}</div>",
        chart.finish()
    )
}

/// PSNR against the transistors of a lane: formats, and every fixed design that was drawn.
fn in_formats(answer: &Answer) -> String {
    let (frame, base) = plot(64.0);
    let psnr = |row: &FormatRow| row.error.map_or(0.0, |error| error.psnr_db());
    let of_formats = || {
        answer
            .formats
            .iter()
            .map(|row| [psnr(row), row.transistors as f64])
    };
    let all = || of_formats().chain(answer.fixed_lanes.iter().copied());
    let finite = || all().map(|[x, _]| x).filter(|x| x.is_finite());
    let range = [
        finite().fold(0.0, f64::min),
        finite().fold(10.0, f64::max) + 5.0,
    ];
    let across = Axis::linear(range, frame.across());
    let up = Axis::of_values(all().map(|[_, y]| y), 10.0, frame.upwards());
    let label = "error and transistors of a lane by format";
    let mut chart = Chart::new(WIDTH, base + 46.0, label);
    chart.rows(&frame, &up, &up.ticks(5));
    chart.columns(&frame, &across, &across.ticks(5));
    chart.names(&frame, "PSNR, dB", "transistors a lane");
    for [x, y] in answer.fixed_lanes.iter().filter(|[x, _]| x.is_finite()) {
        let words = format!("fixed: {x:.1} dB, {y:.0} transistors a lane");
        let place = (across.at(*x), up.at(*y));
        chart.disc(place, 2.5, "class=\"mark s5\" opacity=\"0.45\"", &words);
    }
    for (row, [x, y]) in answer.formats.iter().zip(of_formats()) {
        let place = (across.at(x.min(range[1])), up.at(y));
        let class = if row.holds {
            "class=\"mark s2\""
        } else {
            "class=\"mark s0\""
        };
        let words = format!("{}: {x:.1} dB, {y:.0} transistors a lane", row.format);
        chart.disc(place, 5.0, class, &words);
        chart.text((place.0 - 8.0, place.1), Anchor::End, "", row.format);
    }
    let (headings, lines) = formats::table(&answer.formats);
    let escaped = |line: &Vec<String>| line.iter().map(|cell| escape(cell)).collect();
    format!(
        "<p class=\"read\">{}. Green holds all limits, red misses one, grey are fixed designs of the search. {}.</p>\n<div class=\"diagram\">{}</div>\n{}",
        escape(&formats::verdict(&answer.formats)),
        escape(formats::NOTE),
        chart.finish(),
        html_table(SHORT, &[0], &headings, lines.iter().map(escaped))
    )
}

fn of_machine(found: &Found, detail: &Detail) -> String {
    let machine = &found.machine;
    let mut text = section("The machine", &diagram(&detail.timing, machine));
    text += &sections(&detail.timing, &detail.watched, machine);
    text += &section("Energy by unit", &energy(detail));
    text += &section("Traffic", &traffic(&detail.timing));
    text + &section(
        "What a change of one setting would do",
        &knobs(&detail.knobs),
    )
}

/// A unit: its name in the accounts, and for people; bytes that it reads and writes.
type Stage = (&'static str, &'static str, u64, u64);

/// The units in the order of the data, with all bytes of the picture on their arrows.
fn stages(timing: &Timing) -> [Stage; 9] {
    let bytes = &timing.bytes;
    let (sorted, splats) = (
        bytes.sort_moved / 2,
        bytes.splats_read + bytes.harmonics_read,
    );
    let read_by_sort = sorted + bytes.sorted_read;
    [
        ("fetch", "fetch of splats", splats, 0),
        ("setup", "geometry setup", 0, 0),
        ("binning", "binning", 0, bytes.packets_written),
        ("sort", "sort", read_by_sort, sorted),
        ("packet_fetch", "fetch of packets", bytes.packets_read, 0),
        ("splat_setup", "splat setup", 0, 0),
        ("row_generator", "row generator", 0, 0),
        ("lanes", "lanes and blend", 0, 0),
        ("write_back", "write-back", 0, bytes.pixels_written),
    ]
}

/// All bytes on the diagram's arrows.
pub(super) fn bytes_shown(timing: &Timing) -> u64 {
    let moved = stages(timing).map(|(.., read, written)| read + written);
    moved.iter().sum()
}

/// Units from top to bottom, each with the part of the time in which it works, and the memory beside them.
fn diagram(timing: &Timing, machine: &Config) -> String {
    let stages = stages(timing);
    let (step, box_height, left, box_width) = (44.0, 30.0, 6.0, 190.0);
    let height = step * stages.len() as f64 + 8.0;
    let label = "units of the machine and the bytes between them and the memory";
    let mut chart = Chart::new(WIDTH, height, label);
    let memory = Rectangle::new([318.0, 6.0], [56.0, height - 22.0]);
    chart.bar(&memory, "class=\"frame\" fill=\"none\"", "memory");
    chart.text((346.0, height / 2.0), Anchor::Middle, "", "memory");
    for (place, (unit, name, read, written)) in stages.iter().copied().enumerate() {
        let top = 6.0 + step * place as f64;
        let unit = timing.units.get(unit);
        let (busy, instances) = unit.map_or((0.0, 1), |unit| (unit.utilisation, unit.instances));
        let whole = Rectangle::new([left, top], [box_width, box_height]);
        let worked = Rectangle {
            width: box_width * busy.clamp(0.0, 1.0),
            ..whole
        };
        let times = if instances > 1 {
            format!(" x {instances}")
        } else {
            String::new()
        };
        let words = format!("{name}{times}: {:.1} % of the time at work", 100.0 * busy);
        chart.bar(&worked, "fill=\"#2f6fde\" fill-opacity=\"0.3\"", &words);
        chart.bar(&whole, "class=\"frame\" fill=\"none\"", &words);
        let middle = top + box_height / 2.0;
        let [start, end] = [left + 8.0, left + box_width - 6.0].map(|x| (x, middle));
        let (whose, share) = (format!("{name}{times}"), format!("{:.0} %", 100.0 * busy));
        chart.text(start, Anchor::Start, "", &whose);
        chart.text(end, Anchor::End, "", &share);
        if place + 1 < stages.len() {
            let x = left + box_width / 2.0;
            arrow(&mut chart, [(x, top + box_height), (x, top + step)]);
        }
        let (from, to) = (left + box_width, memory.left);
        let both = read > 0 && written > 0;
        let shift = if both { 7.0 } else { 0.0 };
        let below = if both { 9.0 } else { -8.0 };
        let transfers = [
            (read, middle - shift, [to, from], -8.0),
            (written, middle + shift, [from, to], below),
        ];
        for (bytes, y, ends, words) in transfers {
            if bytes > 0 {
                let place = ((from + to) / 2.0, y + words);
                let megabytes = format!("{:.2} MB", bytes as f64 / 1e6);
                arrow(&mut chart, ends.map(|x| (x, y)));
                chart.text(place, Anchor::Middle, "", &megabytes);
            }
        }
    }
    let words = format!(
        "{}, {} bytes read and {} written a cycle at most. \
         Blue is the part of the time in which a unit works; the arrows' bytes add up to {:.2} MB a frame.",
        units_of(machine),
        machine.read_bandwidth,
        machine.write_bandwidth,
        bytes_shown(timing) as f64 / 1e6
    );
    format!(
        "<p class=\"read\">{}</p>\n<div class=\"diagram\">{}</div>",
        escape(&words),
        chart.finish()
    )
}

/// A line with a head at its end, along one axis.
fn arrow(chart: &mut Chart, [from, to]: [(f64, f64); 2]) {
    chart.line(&[from, to], "leader");
    let (dx, dy) = ((to.0 - from.0).signum(), (to.1 - from.1).signum());
    let back = |side: f64| {
        if to.0 == from.0 {
            (to.0 + side, to.1 - 5.0 * dy)
        } else {
            (to.0 - 5.0 * dx, to.1 + side)
        }
    };
    chart.line(&[back(-4.0), to, back(4.0)], "leader");
}

fn energy(detail: &Detail) -> String {
    let all = detail.energy.attojoules.max(1);
    let share = |attojoules: u64| format!("{:.1} %", 100.0 * attojoules as f64 / all as f64);
    let millijoules = |attojoules: u64| format!("{:.4}", attojoules as f64 / MILLI);
    let columns: [Column<(&str, u64, Option<u64>)>; 4] = [
        ("unit", &|(unit, ..)| escape(&unit.replace('_', " "))),
        ("mJ a frame", &|(_, own, _)| millijoules(*own)),
        ("of all", &|(_, own, _)| share(*own)),
        ("in the memory", &|(.., dram)| {
            dram.map_or_else(String::new, millijoules)
        }),
    ];
    let units = detail.energy.units.iter();
    let units = units.map(|unit| (unit.unit, unit.attojoules, Some(unit.dram_attojoules)));
    let rows = units.chain([("all", all, None)]);
    let note = escape(&detail.energy.of);
    table_of(SHORT, &[0], &columns, rows) + &format!("\n<p class=\"read\">{note}</p>")
}

fn traffic(timing: &Timing) -> String {
    let bytes = &timing.bytes;
    let all = bytes.all().max(1) as f64;
    let share = |moved: u64| format!("{:.1} %", 100.0 * moved as f64 / all);
    let megabytes = |moved: u64| format!("{:.3}", moved as f64 / 1e6);
    let kinds = [
        ("splats read", bytes.splats_read),
        ("harmonics read", bytes.harmonics_read),
        ("packets and lists written", bytes.packets_written),
        ("sort, read and written", bytes.sort_moved),
        ("sorted splats read", bytes.sorted_read),
        ("packets and lists read", bytes.packets_read),
        ("pixels written", bytes.pixels_written),
    ];
    let columns: [Column<(&str, u64)>; 3] = [
        ("what", &|(name, _)| (*name).to_owned()),
        ("MB a frame", &|(_, moved)| megabytes(*moved)),
        ("of all", &|(_, moved)| share(*moved)),
    ];
    let moving = kinds.into_iter().filter(|(_, moved)| *moved > 0);
    let mut text = table_of(SHORT, &[0], &columns, moving);
    if let Some(memory) = &timing.memory {
        let counts = &memory.counts;
        text += &format!(
            "\n<p class=\"read\">{}: {} bursts read and {} written; {} found their row open, {} an idle bank and {} another row \
             (bank conflicts); {} turns of the bus, {} refreshes.</p>",
            escape(memory.part),
            count(counts.reads),
            count(counts.writes),
            count(counts.row_hits),
            count(counts.row_misses),
            count(counts.row_conflicts),
            count(counts.turnarounds),
            count(counts.refreshes)
        );
    }
    text
}

fn knobs(knobs: &[Knob]) -> String {
    let part = |part: f64| format!("{:+.1} %", 100.0 * part);
    let columns: [Column<&Knob>; 6] = [
        ("setting", &|knob| escape(&knob.setting.replace('_', " "))),
        ("change", &|knob| {
            escape(&format!("{} to {}", knob.from, knob.to))
        }),
        ("LUT in all", &|knob| part(knob.cost)),
        ("frames a second", &|knob| part(knob.frames_per_s)),
        ("energy", &|knob| part(knob.energy)),
        ("holds all limits", &|knob| {
            if knob.holds { "yes" } else { "no" }.to_owned()
        }),
    ];
    table_of(SHORT, &[0], &columns, knobs)
}

fn widths(found: &Found) -> String {
    let columns: [Column<(&String, &Value)>; 2] = [
        ("quantity", &|(name, _)| (*name).clone()),
        ("bits", &|(_, bits)| bits.to_string()),
    ];
    table_of(SHORT, &[0], &columns, &found.design.widths)
}
