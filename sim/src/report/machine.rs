//! timing.html: where a machine's cycles go, as pictures: a bar per unit with its stalls by cause, lanes and rows over
//! time, cycles per tile over the screen, and the machine's roofline.
//!
//! A page without a script; every mark has its number as a title. What is drawn is watched in a simulation of its own,
//! so that the timing that is reported is never slowed by it.

use super::chart::{Anchor, Axis, Chart};
use super::html::section;
use super::labels::Rectangle;
use super::shell::Shell;
use super::table::count;
use crate::machine::accounts::CAUSES;
use crate::machine::config::Config;
use crate::machine::lanes::LaneWork;
use crate::machine::observe::{Event, Observer, Stage};
use crate::machine::simulate_observed;
use crate::machine::timing::Timing;
use crate::machine::workload::Workload;

const WIDTH: f64 = 760.0;
const LEFT: f64 = 120.0;
const TOP: f64 = 34.0;

/// The frame of a chart between the names of units and the right edge.
fn frame(height: f64) -> Rectangle {
    Rectangle::new([LEFT, TOP], [WIDTH - LEFT - 20.0, height])
}

/// Columns of the picture of time.
const SLOTS: usize = 120;

/// Stages whose work is drawn over time.
const WATCHED: [(Stage, &str, &str); 3] = [
    (Stage::Rows, "row_generator", "s1"),
    (Stage::Lanes, "lanes", "s3"),
    (Stage::WriteBack, "write_back", "s2"),
];

/// Colour of work.
const BUSY: &str = "#2f6fde";

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
    /// Tiles in a row of the screen.
    columns: u32,
    first: Vec<u64>,
}

impl Watched {
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
    let mut watched = Watched {
        tiles: vec![0; work.tiles.len()],
        slots: std::array::from_fn(|_| vec![0; SLOTS]),
        slot: timing.raster.div_ceil(SLOTS as u64).max(1),
        columns: workload.columns,
        first: vec![u64::MAX; work.tiles.len()],
    };
    simulate_observed(workload, work, config, &mut watched);
    watched
}

/// A chart with its heading and the name of its file.
pub struct Plot {
    /// Heading.
    pub title: &'static str,
    /// Name without an ending.
    pub file: &'static str,
    /// The picture, as it stands in a page.
    pub svg: String,
}

/// All charts of a machine's cycles.
pub fn plots(timing: &Timing, watched: &Watched, config: &Config) -> [Plot; 4] {
    let plot = |title, file, svg| Plot { title, file, svg };
    let tile = [config.tile_width, config.tile_height];
    let (time, tiles) = (over_time(timing, watched), heat_map(watched, tile));
    [
        plot("Where each unit's cycles go", "stalls", accounts(timing)),
        plot("Work over the raster phase", "time", time),
        plot("Cycles of the lanes per tile", "tiles", tiles),
        plot("Roofline", "roofline", roofline(timing, config)),
    ]
}

/// The same as sections of a page.
pub fn sections(timing: &Timing, watched: &Watched, config: &Config) -> String {
    let in_section = |Plot { title, svg, .. }: Plot| {
        section(title, &format!("<div class=\"scroll\">{svg}</div>"))
    };
    plots(timing, watched, config).map(in_section).concat()
}

/// All cycles, and those of the phases.
pub fn phases(timing: &Timing) -> String {
    let [total, geometry, sort, raster] =
        [timing.total, timing.geometry, timing.sort, timing.raster].map(count);
    format!("{total} cycles: geometry {geometry}, sort {sort}, raster {raster}.")
}

/// The page.
pub fn page(name: &str, timing: &Timing, watched: &Watched, config: &Config) -> String {
    let sections = sections(timing, watched, config);
    let phases = phases(timing);
    let facts = format!("<p class=\"facts\">{phases} Point at a mark for its number.</p>\n");
    Shell::still("splatline: cycles of the machine", name, &facts, &sections).html()
}

/// A stacked bar per unit: busy, stalls by cause, idle.
fn accounts(timing: &Timing) -> String {
    let (step, bar) = (24.0, 16.0);
    let area = frame(step * timing.units.len() as f64);
    let base = TOP + area.height + 10.0;
    let fill = |colour: &str| format!("fill=\"{colour}\"");
    let mut used = vec![("busy", fill(BUSY))];
    for time in timing.units.values() {
        for ((_, cause), colour) in CAUSES.iter().zip(COLOURS) {
            let is_new = !used.iter().any(|(known, _)| known == cause);
            if is_new && time.stalled.contains_key(cause) {
                used.push((*cause, fill(colour)));
            }
        }
    }
    let legend: Vec<(&str, &str)> = used
        .iter()
        .map(|(word, fill)| (*word, fill.as_str()))
        .collect();
    // Drawn twice, since its height is the picture's.
    let height = Chart::new(0.0, 0.0, "").legend(&legend, &area, base);
    let label = "busy, stalled and idle cycles of every unit";
    let mut chart = Chart::new(WIDTH, base + height, label);
    for (row, (unit, time)) in timing.units.iter().enumerate() {
        let all = (time.instances * timing.total).max(1) as f64;
        let mut part = Rectangle {
            top: TOP + step * row as f64,
            height: bar,
            ..area
        };
        chart.text((LEFT - 6.0, part.top + bar / 2.0), Anchor::End, "", unit);
        for (what, fill) in &used {
            let cycles = match *what {
                "busy" => time.busy,
                cause => time.stalled.get(cause).copied().unwrap_or(0),
            };
            if cycles == 0 {
                continue;
            }
            let share = cycles as f64 / all;
            part.width = area.width * share;
            let words = format!("{unit}: {what} {cycles} cycles, {:.2} %", 100.0 * share);
            chart.bar(&part, fill, &words);
            part.left += part.width;
        }
        let whole = Rectangle {
            top: part.top,
            height: bar,
            ..area
        };
        let words = format!("{unit}: idle {} cycles", time.idle);
        chart.bar(&whole, "class=\"frame\" fill=\"none\"", &words);
    }
    chart.legend(&legend, &area, base);
    chart.finish()
}

/// Busy part of the stages over the raster phase.
fn over_time(timing: &Timing, watched: &Watched) -> String {
    let area = frame(170.0);
    let base = TOP + area.height;
    let label = "part of each stage that works, over the raster phase";
    let mut chart = Chart::new(WIDTH, base + 56.0, label);
    let across = Axis::linear([0.0, timing.raster as f64], area.across());
    let up = Axis::linear([0.0, 100.0], area.upwards());
    chart.rows(&area, &up, &up.ticks(4));
    chart.columns(&area, &across, &across.ticks(8));
    chart.names(&area, "cycles", "busy, %");
    for (place, ((_, unit, class), slots)) in WATCHED.iter().zip(&watched.slots).enumerate() {
        let instances = timing.units.get(unit);
        let instances = instances.map_or(1, |unit| unit.instances.max(1));
        let all = (watched.slot * instances) as f64;
        let point = |(slot, cycles): (usize, &u64)| {
            let middle = watched.slot as f64 * (slot as f64 + 0.5);
            let share = (*cycles as f64 / all).min(1.0);
            (
                across.at(middle.min(timing.raster as f64)),
                up.at(100.0 * share),
            )
        };
        chart.curve(slots.iter().enumerate().map(point), class, unit);
        let x = LEFT + area.width - 260.0 + [0.0, 110.0, 170.0][place];
        chart.text((x, TOP - 16.0), Anchor::Start, class, unit);
    }
    chart.finish()
}

/// The screen, a rectangle for each tile, of its proportions.
fn heat_map(watched: &Watched, tile: [u16; 2]) -> String {
    let tiles = watched.tiles.len();
    let columns = match watched.columns {
        0 => tiles.max(1),
        columns => columns as usize,
    };
    let rows = tiles.div_ceil(columns).max(1);
    let width = (WIDTH - 20.0) / columns as f64;
    let [across, down] = tile.map(|side| f64::from(side.max(1)));
    let side = width * down / across;
    let most = watched.tiles.iter().copied().max().unwrap_or(0).max(1);
    let height = side * rows as f64 + 44.0;
    let mut chart = Chart::new(WIDTH, height, "cycles of every tile");
    for (tile, cycles) in watched.tiles.iter().enumerate() {
        let [x, y] = [tile % columns, tile / columns];
        // The root, so that tiles of a tenth of the most can still be seen.
        let shade = (*cycles as f64 / most as f64).sqrt();
        let corner = [10.0 + width * x as f64, 10.0 + side * y as f64];
        let area = Rectangle::new(corner, [width, side]);
        let colour = format!("fill=\"#c2410c\" fill-opacity=\"{shade:.3}\"");
        chart.bar(&area, &colour, &format!("tile {x}, {y}: {cycles} cycles"));
    }
    let words = format!("full colour: {most} cycles");
    chart.text((10.0, height - 14.0), Anchor::Start, "", &words);
    chart.finish()
}

/// Pixels a cycle against bytes a pixel, both logarithmic: under the lanes' roof and the channels' slope.
fn roofline(timing: &Timing, config: &Config) -> String {
    let area = frame(230.0);
    let base = TOP + area.height;
    let pixels = timing.pixels.live.max(1) as f64;
    let lanes = f64::from(config.lanes * config.raster_units) / f64::from(config.stretch());
    // A part needs a clock, so that its bytes a cycle are known.
    let channels = config.channel_bytes_per_cycle(config.clock_mhz.into());
    let moved = timing.memory.as_ref().map(|memory| memory.bytes_moved);
    let bytes = moved.unwrap_or(timing.bytes.all()).max(1) as f64 / pixels;
    let reached = pixels / timing.total.max(1) as f64;
    let range = [-3.0, 3.0];
    let x = Axis::decades(range, area.across());
    let y = Axis::decades(range, area.upwards());
    let point = |across: f64, up: f64| {
        let [across, up] = [across, up].map(|value| value.clamp(1e-3, 1e3));
        (x.at(across), y.at(up))
    };
    let mut chart = Chart::new(WIDTH, base + 50.0, "pixels a cycle against bytes a pixel");
    let powers: Vec<f64> = (-3..=3).map(|power| 10f64.powi(power)).collect();
    chart.rows(&area, &y, &powers);
    chart.columns(&area, &x, &powers);
    chart.names(&area, "bytes a live pixel", "pixels a cycle");
    let roof = [
        point(1e-3, lanes),
        point(channels / lanes, lanes),
        point(1e3, channels / 1e3),
    ];
    let words = format!("{lanes} pixels a cycle; {channels} bytes a cycle");
    chart.curve(roof.into_iter(), "s5", &words);
    let bound = lanes.min(channels / bytes);
    let words = format!("{bytes:.3} bytes a pixel, {reached:.4} pixels a cycle of {bound:.4}");
    let place = point(bytes, reached);
    chart.disc(place, 5.0, "class=\"mark s3\"", &words);
    let words = format!(
        "{bytes:.2} bytes a live pixel, {reached:.3} pixels a cycle: {:.1} % of the roof",
        100.0 * reached / bound
    );
    // Above the frame, where neither a roof nor the edge of the picture is in the way.
    let above = (LEFT + area.width, TOP - 16.0);
    chart.text(above, Anchor::End, "", &words);
    chart.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::DesignChoice;
    use crate::fixed::Options;
    use crate::machine::lanes::LaneShape;
    use crate::machine::simulate;
    use crate::machine::workload::extract;
    use crate::report::chart::text_width;
    use crate::scene::synthetic;

    /// The slots hold all the lanes' cycles, and no tile took more than the phase.
    #[test]
    fn what_is_drawn_adds_up() {
        let scene = synthetic::random_gaussians(300, 2, 2.0);
        let camera = synthetic::camera(48, 40);
        let design = DesignChoice::named("standard24").unwrap();
        let options = Options::front_to_back(&scene.natural_rules, &design);
        let workload = extract(&scene, &camera, &options, [16, 16]).unwrap();
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
        let page = page("<random>", &timing, &watched, &config);
        for part in [
            "&lt;random&gt;</h1>",
            "lanes: busy ",
            "tile 2, 2: ",
            "bytes a live pixel",
            "<title>write_back",
        ] {
            assert!(page.contains(part), "{part}");
        }
        assert!(!page.contains("NaN") && !page.contains("inf"));
        assert_eq!(page.matches("<svg").count(), 4);
        // Tiles of 16 x 16 are squares, those of twice the width have twice the width.
        let shape = |tile_width| {
            let config = Config {
                tile_width,
                ..config
            };
            let plots = plots(&timing, &watched, &config);
            let attribute = |name: &str| {
                let (_, rest) = plots[2].svg.split_once("<rect").unwrap();
                let (_, rest) = rest.split_once(&format!(" {name}=\"")).unwrap();
                rest.split('"').next().unwrap().parse::<f64>().unwrap()
            };
            attribute("width") / attribute("height")
        };
        assert!((shape(16) - 1.0).abs() < 1e-3 && (shape(32) - 2.0).abs() < 1e-3);
        // The bar of every unit ends where its cycles do, and the roofline's point is under its roof.
        let roof = plots(&timing, &watched, &config);
        let percent = roof[3].svg.split(" % of the roof").next().unwrap();
        let percent: f64 = percent.rsplit(' ').next().unwrap().parse().unwrap();
        assert!(percent > 0.0 && percent <= 100.0, "{percent}");
        // Its words lie above the frame and end with it, so that no line crosses them.
        let words = roof[3]
            .svg
            .split("<text")
            .find(|text| text.contains("of the roof"));
        let (words, _) = words.unwrap().split_once("</text>").unwrap();
        assert!(words.contains("text-anchor=\"end\""), "{words}");
        let (place, words) = words.split_once('>').unwrap();
        let end: f64 = place.split('"').nth(3).unwrap().parse().unwrap();
        assert!(end <= WIDTH && end > text_width(words), "{place}");
    }
}
