//! Tiles through the primitive: the next one is drawn while the last is read out, with back-pressure at every
//! interface.

use super::stamps::Stamps;
use super::words::{self, Roots};
use super::workload::{self, BenchTile, BenchWorkload};
use crate::bench::{Bench, Channels, Item, Pressure};
use crate::circuit::PRIMITIVE;
use crate::rules::write_rules;
use crate::scenes::{Seen, scenes};
use crate::simulation::Simulation;
use crate::unit::{Circuit, Extent, Findings, Load, Loads, Missing};
use anyhow::Result;
use splatline::blend::{FINISHED, Pixel};
use splatline::draw::Coverage;
use splatline::footprint::Footprint;
use splatline::footprint::packet::Layout;
use splatline::format::Traversal;
use splatline::rules::{Compositing, Rules as KernelRules};
use splatline::target::Target;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{TableMemory, kernel_rules};
use splatline_sim::machine::primitive::Intervals;
use splatline_sim::rules::Rules;

/// The numbers of lanes that tests draw with.
pub const LANES: [u32; 2] = [1, 4];

/// At full speed; with packets that come late and nothing else, so that cycles can still be compared; with
/// back-pressure everywhere.
const PRESSURES: [Pressure; 3] = [pressure(0, 0, 0), pressure(200, 0, 0), pressure(80, 60, 90)];

const fn pressure(packets: u8, lanes: u8, pixels: u8) -> Pressure {
    Pressure {
        inside: lanes,
        retracts: false,
        ..Pressure::new([packets, packets, pixels], 0, 0)
    }
}

/// Footprints and tiles under rules.
pub struct PrimitiveLoad {
    /// The kernel's.
    pub rules: KernelRules,
    /// Footprints and tiles.
    pub workload: BenchWorkload,
}

/// The primitive of a design with some lanes.
pub fn circuit(design: &str, lanes: u32, intervals: Intervals) -> Result<Circuit> {
    let circuit = Circuit::new(&PRIMITIVE, design, lanes)?.with("SETUP_INTERVAL", intervals.setup);
    Ok(circuit.with("ROW_INTERVAL", intervals.rows))
}

/// The primitive of a design with one lane, as small as it gets.
pub fn small(design: &str) -> Result<Circuit> {
    Ok(circuit(design, 1, Intervals::SMALL)?.with("ADDED_BITS", 0))
}

/// The primitive of a design with four lanes and as few multipliers as wide products take.
pub fn few_multipliers(design: &str) -> Result<Circuit> {
    let intervals = Intervals { setup: 8, rows: 1 };
    Ok(circuit(design, 4, intervals)?.with("WIDE_MULTIPLIERS", 3))
}

impl Load for PrimitiveLoad {
    const WAYS: usize = PRESSURES.len();

    /// Scenes and random packets; and random packets by rules that skip what is faint inside of a footprint. Those of
    /// scenes skip nothing there: `3dgs` ends a footprint where it becomes faint, and `ewa` draws what is there.
    fn all(circuit: &Circuit, extent: Extent, missing: &mut Missing) -> Result<Loads<Self>> {
        let design = &circuit.design;
        let widths = &design.widths;
        let quick = extent == Extent::Quick;
        let [random, faint] = extent.of([1_200, 600], [40_000, 20_000]);
        let [size, deep] = extent.of([256, 64], [512, 128]);
        // Of all sizes over a small picture, and a few in one most of whose tiles have none.
        let crowd = Seen::random("crowd", (2_000, 9, 4.0), [150, 100]);
        let sparse = Seen::random("sparse", (20, 9, 4.0), [480, 320]);
        let mut seen = vec![crowd, sparse, workload::hard()?];
        seen.extend(scenes(&["deep stack"], deep, missing)?);
        seen.extend(scenes(&["guitar", "lion"], size, missing)?);
        let mut loads = Vec::new();
        let mut load = |name: &str, rules_name: &str, rules: &Rules, mut workload| {
            if quick {
                shorten(&mut workload);
            }
            let rules = kernel_rules(rules);
            let load = PrimitiveLoad { rules, workload };
            loads.push((format!("{name}, {rules_name}"), load));
        };
        for (of, rules) in [("3dgs", &Rules::GAUSSIAN_3D), ("ewa", &Rules::EWA)] {
            let many = workload::random(widths, random, 20, 7);
            load("random packets", of, rules, many);
            let lone = workload::random(widths, random / 4, 1, 8);
            load("random packets", of, rules, lone);
            let vast = workload::vast(widths, random / 4, 10);
            load("vast packets", of, rules, vast);
            for seen in &seen {
                let picture = workload::picture(seen, design, rules);
                load(seen.name, of, rules, picture);
            }
        }
        let skipping = Rules {
            alpha_min: Rules::GAUSSIAN_3D.alpha_min,
            ..Rules::EWA
        };
        let faint = workload::random(widths, faint, 20, 9);
        load("random packets", "ewa, faint skipped", &skipping, faint);
        Ok(loads)
    }

    fn compare(&self, circuit: &Circuit, mut bench: Bench, pressure: usize) -> Result<Findings> {
        let design = &circuit.design;
        let widths = &design.widths;
        let pressure = &PRESSURES[pressure];
        write_rules(&mut bench, widths, &self.rules);
        let difference = words::first_difference(&mut bench, widths.mantissa);
        if difference.is_some() {
            return Ok(Findings {
                first_difference: difference,
                ..Findings::default()
            });
        }
        let layout = Layout::new(widths, Traversal::Spans);
        let (tiles, footprints) = (&self.workload.tiles, &self.workload.footprints);
        let items = tiles.iter().map(|tile| item(&layout, tile, footprints));
        let items: Vec<Item> = items.collect();
        let (pixels, coverage) = draw(design, &self.rules, tiles, footprints)?;
        let window: &[_] = &["first_column", "first_row", "end_column", "end_row"];
        let of_pixel: &[_] = &["finished", "transmittance", "red", "green", "blue"];
        // Tiles, packets and ends of tiles in, pixels out.
        let sources: [(_, &[_]); 3] = [("tile", window), ("packet", &["packet"]), ("finish", &[])];
        let mut channels = Channels::new(&bench.circuit, &sources, ("pixel", of_pixel));
        channels.enable = Some(bench.circuit.port("lanes_enable"));
        let mut watch = PrimitiveWatch {
            circuit,
            timed: (pressure.inside == 0).then_some(0),
            workload: &self.workload,
            tile: 0,
            stamps: Stamps::default(),
            raster_cycles: 0,
            roots: Roots::default(),
            enabled: true,
        };
        let check = |number: usize, answer: &[Vec<u32>]| {
            let (got, expected) = (pixel(answer), pixels[number]);
            (got != expected).then(|| {
                let place = place(tiles, number);
                format!("{place}: the kernel has {expected:x?}, the circuit {got:x?}")
            })
        };
        let observe = |circuit: &Simulation, channels: &Channels, cycle| {
            watch.observe(circuit, channels, cycle)
        };
        let mut findings = bench.run(&channels, &items, pressure, check, observe)?;
        let splats = tiles.iter().map(|tile| tile.list.len() as u64).sum();
        findings.counts = vec![
            ("tiles", tiles.len() as u64),
            ("splats", splats),
            ("visited", coverage.visited),
            ("covered", coverage.covered),
            ("roots", watch.roots.compared),
            ("splats timed", watch.timed.unwrap_or(0)),
            ("raster cycles", watch.raster_cycles),
        ];
        Ok(findings)
    }
}

/// The quick extent's limits: pairs of splat and tile, tiles.
const QUICK: (usize, usize) = (6_000, 200);

/// Keeps tiles spread over the workload until the limits are reached.
fn shorten(workload: &mut BenchWorkload) {
    let (mut pairs, mut tiles) = (0, Vec::new());
    // A stride coprime to every number of tiles that occurs visits them all, far apart from each other.
    let count = workload.tiles.len();
    for i in 0..count.min(QUICK.1) {
        let tile = &workload.tiles[i * 37 % count];
        if tiles.is_empty() || pairs + tile.list.len() <= QUICK.0 {
            pairs += tile.list.len();
            tiles.push(tile.clone());
        }
    }
    workload.tiles = tiles;
}

/// A tile in one lane: its window, its packets, its end.
fn item(layout: &Layout, tile: &BenchTile, footprints: &[Footprint]) -> Item {
    let [first, end] = [tile.window.first, tile.window.end];
    let window = [first[0], first[1], end[0], end[1]].map(|place| vec![place.into()]);
    let mut offers = vec![(0, window.to_vec())];
    for index in &tile.list {
        let packet = layout.encode(&footprints[*index as usize]);
        offers.push((1, vec![packet.to_vec()]));
    }
    offers.push((2, Vec::new()));
    Item {
        lanes: vec![offers],
        answers: tile.size().iter().product::<usize>() as u64,
    }
}

/// The pixel that the read-out offers.
pub fn pixel(answer: &[Vec<u32>]) -> Pixel {
    let [finished, transmittance, red, green, blue] = [0, 1, 2, 3, 4].map(|i| answer[i][0]);
    let flag = if finished == 1 { FINISHED } else { 0 };
    Pixel {
        colour: [red, green, blue],
        transmittance: transmittance | flag,
    }
}

/// The pixels of tiles by the kernel, tile by tile and row by row, and what was visited.
pub fn draw(
    design: &DesignChoice,
    rules: &KernelRules,
    tiles: &[BenchTile],
    footprints: &[Footprint],
) -> Result<(Vec<Pixel>, Coverage)> {
    let widths = &design.widths;
    let table = TableMemory::new(widths, rules);
    let order = Compositing::FrontToBack;
    let mut drawn = Vec::new();
    let mut coverage = Coverage::default();
    for tile in tiles {
        let painter = table.painter(design.in_fields(), order, Traversal::Spans);
        let [columns, rows] = tile.size();
        let mut pixels = vec![Pixel::clear(widths); columns * rows];
        let mut target = Target::new(&mut pixels, tile.window, columns)?;
        for index in &tile.list {
            coverage += painter.draw(&footprints[*index as usize], &mut target);
        }
        drawn.extend(pixels);
    }
    Ok((drawn, coverage))
}

/// What is looked at in every cycle.
struct PrimitiveWatch<'a> {
    circuit: &'a Circuit,
    /// Splats whose handshakes were compared, if they can be.
    timed: Option<u64>,
    workload: &'a BenchWorkload,
    /// The tile that is being drawn.
    tile: usize,
    stamps: Stamps,
    raster_cycles: u64,
    roots: Roots,
    /// Were the lanes allowed to move in the cycle before?
    enabled: bool,
}

impl PrimitiveWatch<'_> {
    fn observe(&mut self, circuit: &Simulation, channels: &Channels, cycle: u64) -> Option<String> {
        let mut difference = self.roots.note(circuit);
        if !self.enabled && circuit.read("lanes_popped") != 0 {
            let held = format!("a lane took a run in cycle {cycle}, while lanes were held");
            difference = Some(held);
        }
        self.enabled = channels.enable.is_some_and(|enable| circuit.is(enable));
        let [tile, packet, finish] = [0, 1, 2].map(|source: usize| &channels.sources[source]);
        if tile.moves(circuit) {
            self.stamps = Stamps::default();
            return difference;
        }
        let Some(tile) = self.workload.tiles.get(self.tile) else {
            return difference;
        };
        let packets = tile.list.len();
        self.stamps.note(circuit, packet, cycle, packets);
        if finish.moves(circuit) {
            self.raster_cycles += self.stamps.raster_cycles();
            if let Some(timed) = &mut self.timed {
                *timed += packets as u64;
                let stamps = &self.stamps;
                let other = stamps.difference(self.circuit, tile, self.workload);
                difference = difference.or(other.map(|word| format!("tile {}, {word}", self.tile)));
            }
            self.tile += 1;
        }
        difference
    }
}

/// Tile and pixel of an answer.
fn place(tiles: &[BenchTile], number: usize) -> String {
    let mut places = tiles.iter().enumerate().flat_map(|(index, tile)| {
        let [first, end] = [tile.window.first, tile.window.end];
        let row = move |y| (first[0]..end[0]).map(move |x| (index, x, y));
        (first[1]..end[1]).flat_map(row)
    });
    let (index, x, y) = places.nth(number).unwrap_or_default();
    format!("tile {index}, pixel ({x}, {y})")
}
