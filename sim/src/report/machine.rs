//! timing.html: where a machine's cycles go, as pictures: a bar per unit with its stalls by cause, lanes and rows over time, cycles per tile over the
//! screen, and the machine's roofline.
//!
//! One file without a script; every mark has its number as a title. What is drawn is watched in a simulation of its own, so that the timing that is
//! reported is never slowed by it.

use super::html::escape;
use crate::machine::accounts::CAUSES;
use crate::machine::config::Config;
use crate::machine::lanes::LaneWork;
use crate::machine::observe::{Event, Observer, Stage};
use crate::machine::simulate_observed;
use crate::machine::timing::Timing;
use crate::machine::workload::Workload;
use std::fmt::Write;

const WIDTH: f64 = 760.0;
const LEFT: f64 = 120.0;

/// Columns of the picture of time.
const SLOTS: usize = 120;

/// Stages whose work is drawn over time.
const WATCHED: [(Stage, &str, &str); 3] = [
    (Stage::Rows, "row generator", "#b8651b"),
    (Stage::Lanes, "lanes", "#2f6fde"),
    (Stage::WriteBack, "write-back", "#3a8f4d"),
];

/// Colours of the causes of stalls, in the order of [`CAUSES`].
const COLOURS: [&str; CAUSES.len()] = [
    "#d1495b", "#edae49", "#b8651b", "#7a5195", "#66a182", "#8d96a3", "#ef5675", "#00798c",
    "#a05195", "#30638e", "#5c940d",
];

/// What a simulation shows of tiles and time.
pub struct Watched {
    /// Cycles that the lanes were at a tile: from its first group to its last.
    pub tiles: Vec<u64>,
    /// Cycles of work in each slot of time, by stage of `WATCHED`.
    pub slots: [Vec<u64>; 3],
    /// Cycles of a slot.
    pub slot: u64,
    first: Vec<u64>,
}

impl Watched {
    /// Of a machine whose raster phase takes so many cycles.
    fn new(tiles: usize, raster: u64) -> Watched {
        Watched {
            tiles: vec![0; tiles],
            slots: std::array::from_fn(|_| vec![0; SLOTS]),
            slot: raster.div_ceil(SLOTS as u64).max(1),
            first: vec![u64::MAX; tiles],
        }
    }

    /// Adds the cycles of an event to the slots that it lies in.
    fn spread(&mut self, stage: usize, start: u64, end: u64) {
        let mut from = start;
        while from < end {
            let place = (from / self.slot) as usize;
            let until = end.min((from / self.slot + 1) * self.slot);
            if let Some(slot) = self.slots[stage].get_mut(place) {
                *slot += until - from;
            }
            from = until;
        }
    }
}

impl Observer for Watched {
    const WATCHES: bool = true;

    fn event(&mut self, event: Event) {
        let tile = event.tile as usize;
        if event.stage == Stage::Lanes && tile < self.tiles.len() {
            self.first[tile] = self.first[tile].min(event.start);
            self.tiles[tile] = self.tiles[tile].max(event.end - self.first[tile]);
        }
        let watched = WATCHED.iter().position(|(stage, ..)| *stage == event.stage);
        if let Some(stage) = watched {
            self.spread(stage, event.start, event.end);
        }
    }
}

/// Simulates once more and watches.
pub fn watch(workload: &Workload, work: &LaneWork, config: &Config, timing: &Timing) -> Watched {
    let mut watched = Watched::new(work.tiles.len(), timing.raster);
    simulate_observed(workload, work, config, &mut watched);
    watched
}

/// A plot with its heading and the name of its file.
pub struct Plot {
    /// Heading.
    pub title: &'static str,
    /// Name without an ending.
    pub file: &'static str,
    /// The picture, as it stands in a page.
    pub svg: String,
}

impl Plot {
    /// The picture as a file of its own.
    pub fn alone(&self) -> String {
        let head = "<svg xmlns=\"http://www.w3.org/2000/svg\" color=\"#6b7280\" ";
        let style = "<style>text{fill:currentColor;font:12px system-ui,sans-serif}</style>";
        let named = self.svg.replacen("<svg ", head, 1);
        named.replacen('>', &format!(">{style}"), 1)
    }
}

/// All plots of a machine's cycles.
pub fn plots(timing: &Timing, watched: &Watched, columns: u32, config: &Config) -> [Plot; 4] {
    let plot = |title, file, svg| Plot { title, file, svg };
    [
        plot("Where each unit's cycles go", "stalls", accounts(timing)),
        plot(
            "Work over the raster phase",
            "time",
            over_time(timing, watched),
        ),
        plot(
            "Cycles of the lanes per tile",
            "tiles",
            heat_map(watched, columns),
        ),
        plot("Roofline", "roofline", roofline(timing, config)),
    ]
}

/// The page.
pub fn page(
    name: &str,
    timing: &Timing,
    watched: &Watched,
    columns: u32,
    config: &Config,
) -> String {
    let name = escape(name);
    let section = |Plot { title, svg, .. }: Plot| {
        format!("<h2>{title}</h2>\n<div class=\"scroll\">{svg}</div>\n")
    };
    let plots = plots(timing, watched, columns, config);
    let sections: String = plots.into_iter().map(section).collect();
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{name}: cycles</title>\n<style>{}</style>\n</head>\n<body>\n<h1>{name}: {} cycles</h1>\n{sections}</body>\n</html>\n",
        super::frames::STYLE,
        timing.total
    )
}

/// A stacked bar per unit: busy, stalls by cause, idle.
fn accounts(timing: &Timing) -> String {
    let (step, bar, top) = (24.0, 16.0, 20.0);
    let width = WIDTH - LEFT - 10.0;
    let mut marks = String::new();
    let mut used = vec![("busy", "#2f6fde")];
    for (row, (unit, time)) in timing.units.iter().enumerate() {
        let all = (time.instances * timing.total).max(1) as f64;
        let y = top + step * row as f64;
        let mut x = LEFT;
        // Writing to a String cannot fail.
        let _ = write!(
            marks,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{unit}</text>",
            LEFT - 6.0,
            y + 12.0
        );
        let stalls = CAUSES
            .iter()
            .zip(COLOURS)
            .filter_map(|((_, cause), colour)| Some((*cause, colour, *time.stalled.get(cause)?)));
        for (what, colour, cycles) in std::iter::once(("busy", "#2f6fde", time.busy)).chain(stalls)
        {
            let length = width * cycles as f64 / all;
            let part = 100.0 * cycles as f64 / all;
            let _ = write!(
                marks,
                "<rect x=\"{x:.2}\" y=\"{y}\" width=\"{length:.2}\" height=\"{bar}\" fill=\"{colour}\"><title>{unit}: {what} {cycles} cycles, {part:.2} %</title></rect>"
            );
            x += length;
            if !used.iter().any(|(known, _)| *known == what) {
                used.push((what, colour));
            }
        }
        let _ = write!(
            marks,
            "<rect x=\"{LEFT}\" y=\"{y}\" width=\"{width}\" height=\"{bar}\" fill=\"none\" stroke=\"currentColor\" stroke-opacity=\".3\"/>"
        );
    }
    let base = top + step * timing.units.len() as f64 + 10.0;
    let (words, height) = legend(&used, base);
    svg(
        base + height + 6.0,
        &format!("{marks}{words}"),
        "busy, stalled and idle cycles of every unit",
    )
}

/// Coloured squares with their words, and the height of their lines: a line is full where the picture ends.
fn legend(entries: &[(&str, &str)], top: f64) -> (String, f64) {
    let (mut x, mut y) = (LEFT, top);
    let mut text = String::new();
    for (word, colour) in entries {
        let width = 24.0 + 7.0 * word.len() as f64;
        if x > LEFT && x + width > WIDTH {
            (x, y) = (LEFT, y + LEGEND_LINE);
        }
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "<rect x=\"{x:.0}\" y=\"{y}\" width=\"10\" height=\"10\" fill=\"{colour}\"/><text x=\"{:.0}\" y=\"{}\">{word}</text>",
            x + 14.0,
            y + 10.0
        );
        x += width;
    }
    (text, y + LEGEND_LINE - top)
}

/// Between the tops of two lines of a legend.
const LEGEND_LINE: f64 = 18.0;

/// Busy part of the stages over the raster phase.
fn over_time(timing: &Timing, watched: &Watched) -> String {
    let (height, top) = (180.0, 14.0);
    let base = height - 34.0;
    let across = (WIDTH - LEFT - 10.0) / SLOTS as f64;
    let mut lines = String::new();
    for ((_, name, colour), slots) in WATCHED.iter().zip(&watched.slots) {
        let unit = match *name {
            "lanes" => "lanes",
            "row generator" => "row_generator",
            _ => "write_back",
        };
        let instances = timing
            .units
            .get(unit)
            .map_or(1, |unit| unit.instances.max(1));
        let all = (watched.slot * instances) as f64;
        let point = |(slot, cycles): (usize, &u64)| {
            let part = (*cycles as f64 / all).min(1.0);
            format!(
                "{:.1},{:.1} ",
                LEFT + across * (slot as f64 + 0.5),
                base - (base - top) * part
            )
        };
        let points: String = slots.iter().enumerate().map(point).collect();
        // Writing to a String cannot fail.
        let _ = write!(
            lines,
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"><title>{name}</title></polyline>"
        );
    }
    let names: Vec<(&str, &str)> = WATCHED
        .iter()
        .map(|(_, name, colour)| (*name, *colour))
        .collect();
    let axes = format!(
        "<text x=\"{0}\" y=\"{1}\" text-anchor=\"end\">100 %</text><text x=\"{0}\" y=\"{base}\" text-anchor=\"end\">0</text>\
         <path d=\"M{LEFT} {top}V{base}H{2}\" fill=\"none\" stroke=\"currentColor\" stroke-opacity=\".4\"/><text x=\"{2}\" y=\"{3}\" text-anchor=\"end\">{4} cycles</text>",
        LEFT - 6.0,
        top + 8.0,
        WIDTH - 10.0,
        base + 14.0,
        timing.raster
    );
    // Three words, one line.
    let (words, _) = legend(&names, base + 18.0);
    svg(
        height,
        &format!("{axes}{lines}{words}"),
        "part of each stage that works, over the raster phase",
    )
}

/// The screen, a square for each tile.
fn heat_map(watched: &Watched, columns: u32) -> String {
    let tiles = watched.tiles.len();
    let columns = if columns == 0 {
        tiles.max(1)
    } else {
        columns as usize
    };
    let rows = tiles.div_ceil(columns).max(1);
    let side = (WIDTH - 20.0) / columns as f64;
    let most = watched.tiles.iter().copied().max().unwrap_or(0).max(1);
    let mut marks = String::new();
    for (tile, cycles) in watched.tiles.iter().enumerate() {
        let [x, y] = [tile % columns, tile / columns];
        // The root, so that tiles of a tenth of the most can still be seen.
        let shade = (*cycles as f64 / most as f64).sqrt();
        // Writing to a String cannot fail.
        let _ = write!(
            marks,
            "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{side:.2}\" height=\"{side:.2}\" fill=\"#c2410c\" fill-opacity=\"{shade:.3}\"><title>tile {x}, {y}: {cycles} cycles</title></rect>",
            10.0 + side * x as f64,
            10.0 + side * y as f64
        );
    }
    let height = side * rows as f64 + 44.0;
    let words = format!(
        "<text x=\"10\" y=\"{:.0}\">full colour: {most} cycles</text>",
        height - 10.0
    );
    svg(height, &format!("{marks}{words}"), "cycles of every tile")
}

/// Pixels a cycle against bytes a pixel, both logarithmic: under the lanes' roof and the channels' slope.
fn roofline(timing: &Timing, config: &Config) -> String {
    let (height, top) = (260.0, 14.0);
    let base = height - 34.0;
    let pixels = timing.pixels.live.max(1) as f64;
    let lanes = f64::from(config.lanes * config.raster_units) / f64::from(config.stretch());
    // A part needs a clock, so that its bytes a cycle are known.
    let channels = config.channel_bytes_per_cycle(config.clock_mhz.into());
    let moved = timing.memory.as_ref().map(|memory| memory.bytes_moved);
    let bytes = moved.unwrap_or(timing.bytes.all()).max(1) as f64 / pixels;
    let reached = pixels / timing.total.max(1) as f64;
    let x =
        |value: f64| LEFT + (WIDTH - LEFT - 20.0) * ((value.log10() + 3.0) / 6.0).clamp(0.0, 1.0);
    let y = |value: f64| base - (base - top) * ((value.log10() + 3.0) / 6.0).clamp(0.0, 1.0);
    let ridge = channels / lanes;
    let roof = format!(
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}\" fill=\"none\" stroke=\"currentColor\"><title>{lanes} pixels a cycle; {channels} bytes a cycle</title></path>",
        x(1e-3),
        y(lanes),
        x(ridge),
        y(lanes),
        x(1e3),
        y(channels / 1e3)
    );
    let bound = lanes.min(channels / bytes);
    let point = format!(
        "<circle cx=\"{0:.1}\" cy=\"{1:.1}\" r=\"5\" fill=\"#2f6fde\"><title>{bytes:.3} bytes a pixel, {reached:.4} pixels a cycle of {bound:.4}</title></circle>\
         <text x=\"{2:.1}\" y=\"{3:.1}\">{bytes:.2} bytes a live pixel, {reached:.3} pixels a cycle: {4:.1} % of the roof</text>",
        x(bytes),
        y(reached),
        x(bytes).min(WIDTH - 420.0) + 8.0,
        y(reached) + 18.0,
        100.0 * reached / bound
    );
    let mut ticks = String::new();
    for power in -3..=3 {
        let value = 10f64.powi(power);
        // Writing to a String cannot fail.
        let _ = write!(
            ticks,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{value}</text><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{value}</text>",
            x(value),
            base + 14.0,
            LEFT - 6.0,
            y(value) + 4.0
        );
    }
    let names = format!(
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">bytes a live pixel</text><text x=\"4\" y=\"{}\">pixels a cycle</text>",
        WIDTH - 20.0,
        base + 30.0,
        top + 120.0
    );
    svg(
        height,
        &format!("{ticks}{names}{roof}{point}"),
        "pixels a cycle against bytes a pixel",
    )
}

fn svg(height: f64, marks: &str, label: &str) -> String {
    format!(
        "<svg viewBox=\"0 0 {WIDTH} {height:.0}\" width=\"{WIDTH}\" height=\"{height:.0}\" role=\"img\" aria-label=\"{label}\">{marks}</svg>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::DesignChoice;
    use crate::fixed::Options;
    use crate::machine::lanes::LaneShape;
    use crate::machine::simulate;
    use crate::machine::workload::extract;
    use crate::rules::Compositing;
    use crate::scene::synthetic;

    /// The slots hold all the lanes' cycles, and no tile took more than the phase.
    #[test]
    fn what_is_drawn_adds_up() {
        let scene = synthetic::random_gaussians(300, 2, 2.0);
        let camera = synthetic::camera(48, 40);
        let design = DesignChoice::named("standard24").unwrap();
        let options = Options {
            rules: &scene.natural_rules,
            compositing: Compositing::FrontToBack,
            design: &design,
            traversal: design.traversal,
        };
        let workload = extract(&scene, &camera, &options, [16, 16]);
        let config = Config::default();
        let work = LaneWork::new(&workload, LaneShape::from(&config));
        let timing = simulate(&workload, &work, &config);
        let watched = watch(&workload, &work, &config, &timing);
        assert_eq!(
            watched.slots[1].iter().sum::<u64>(),
            timing.units["lanes"].busy
        );
        assert_eq!(
            watched.slots[0].iter().sum::<u64>(),
            timing.units["row_generator"].busy
        );
        assert_eq!((watched.tiles.len(), workload.columns), (9, 3));
        assert!(watched.tiles.iter().all(|cycles| *cycles <= timing.raster));
        assert!(watched.tiles.iter().any(|cycles| *cycles > 0));
        let page = page("<random>", &timing, &watched, workload.columns, &config);
        for part in [
            "&lt;random&gt;: ",
            "lanes: busy ",
            "tile 2, 2: ",
            "bytes a live pixel",
            "<title>write-back",
        ] {
            assert!(page.contains(part), "{part}");
        }
        assert!(!page.contains("NaN") && !page.contains("inf"));
        assert_eq!(page.matches("<svg").count(), 4);
        // Alone each is a picture that a page of Markdown can show: named, with its own style, every element closed.
        for plot in plots(&timing, &watched, workload.columns, &config) {
            let alone = plot.alone();
            assert!(alone.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
            assert!(
                alone.contains("<style>text{") && alone.ends_with("</svg>"),
                "{}",
                plot.file
            );
            for element in ["svg", "text", "title", "rect", "circle", "polyline"] {
                let begin = format!("<{element}");
                let opened = alone.matches(&begin).count();
                let closed = alone.matches(&format!("</{element}>")).count();
                let empty = alone.split(&begin).skip(1);
                let empty = empty
                    .filter(|rest| rest.split('>').next().is_some_and(|tag| tag.ends_with('/')));
                assert_eq!(opened, closed + empty.count(), "{} {element}", plot.file);
            }
        }
        // The bar of every unit ends where its cycles do, and the roofline's point is under its roof.
        let roof = plots(&timing, &watched, workload.columns, &config);
        let percent = roof[3].svg.split(" % of the roof").next().unwrap();
        let percent: f64 = percent.rsplit(' ').next().unwrap().parse().unwrap();
        assert!(percent > 0.0 && percent <= 100.0, "{percent}");
    }

    #[test]
    fn a_legend_stays_within_the_picture() {
        let words: Vec<(&str, &str)> = CAUSES.iter().map(|(_, word)| (*word, "#000")).collect();
        let (text, height) = legend(&words, 100.0);
        assert!(height > LEGEND_LINE, "one line: {height}");
        let ends = words.iter().map(|(word, _)| {
            let at = text.find(&format!(">{word}</text>")).unwrap();
            let x = text[..at].rsplit("<text x=\"").next().unwrap();
            x.split('"').next().unwrap().parse::<f64>().unwrap() + 7.0 * word.len() as f64
        });
        assert!(ends.fold(0.0, f64::max) <= WIDTH);
    }
}
