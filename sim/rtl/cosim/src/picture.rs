//! Whole pictures under the limits of a memory, by the circuit and by the machine's model: cycles of all tiles, one after the other.
//!
//! The memory is the model's (`docs/hardware-model.md`, section 2), clocked here beside the circuit: packets are read in order at so many
//! bytes a cycle, arrive some cycles later and wait in a queue; finished pixels are written at so many bytes a cycle. The
//! one thing that the model does not know is whether a tile's last pixel changes its word: it waits sixteen cycles where the circuit may need fewer.
//!
//! Tiles without splats never reach the circuit. This bench writes their background, as any host of the primitive should: when the channel of finished pixels
//! has nothing else to do.

use crate::bench::{Bench, pixel};
use crate::model::{Inputs, Outputs};
use crate::workload::{BenchTile, BenchWorkload};
use anyhow::{Context, Result, ensure};
use splatline::blend::Pixel;
use splatline::footprint::packet::Layout;
use splatline::format::Widths;
use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed;
use splatline_sim::machine::primitive::SETUP_INTERVAL;
use splatline_sim::machine::workload::extract_from;
use splatline_sim::machine::{Config, simulate_alone};
use splatline_sim::rules::{Compositing, Rules};
use std::collections::VecDeque;

/// A picture that takes so many times the model's cycles, and some more, will not end.
const PATIENCE: u64 = 4;

/// A memory's limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// What they are.
    pub name: &'static str,
    /// Bytes read and bytes written in a cycle.
    pub bandwidth: u32,
    /// Cycles from a request to its data.
    pub latency: u32,
    /// Packets in flight or waiting.
    pub queue: u32,
}

/// A memory that never limits, and two that do.
pub const LIMITS: [Limits; 3] = [
    Limits {
        name: "none",
        bandwidth: 4096,
        latency: 0,
        queue: 64,
    },
    Limits {
        name: "8 bytes a cycle, latency 60, 8 packets",
        bandwidth: 8,
        latency: 60,
        queue: 8,
    },
    Limits {
        name: "2 bytes a cycle, latency 200, 32 packets",
        bandwidth: 2,
        latency: 200,
        queue: 32,
    },
];

/// Cycles of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PictureCycles {
    /// By the machine's model.
    pub model: u64,
    /// By the circuit.
    pub circuit: u64,
    /// Pixels whose words differ from those of the same tiles drawn without limits by the kernel.
    pub mismatches: u64,
}

impl PictureCycles {
    /// How much more the model says than the circuit takes, as a part of 1.
    pub fn deviation(&self) -> f64 {
        self.model as f64 / self.circuit as f64 - 1.0
    }

    /// No word differs, and no more than a hundredth of the cycles.
    pub fn agree(&self) -> bool {
        self.mismatches == 0 && self.deviation().abs() <= 0.01
    }
}

/// The machine around the primitive, with a memory's limits.
pub fn machine(lanes: usize, limits: &Limits) -> Config {
    Config {
        read_bandwidth: limits.bandwidth,
        write_bandwidth: limits.bandwidth,
        latency: limits.latency,
        packet_fifo: limits.queue,
        ..Config::primitive(lanes as u32)
    }
}

/// The model's cycles of a scene's picture, by the way that `splatline model` goes: workload, lane work, raster unit.
pub fn model_cycles(
    design: &DesignChoice,
    rules: &Rules,
    workload: &BenchWorkload,
    config: &Config,
) -> Result<u64> {
    let [width, height] = workload.viewport.context("a workload from a scene")?;
    let camera = Camera::look_at(
        [0.0, 0.0, -1.0],
        [0.0; 3],
        [0.0, 1.0, 0.0],
        50.0,
        width.into(),
        height.into(),
    )
    .context("a camera of that size")?;
    let options = fixed::Options {
        rules,
        compositing: Compositing::FrontToBack,
        design,
        traversal: splatline::format::Traversal::Spans,
    };
    let footprints: Vec<_> = workload.footprints.iter().copied().map(Ok).collect();
    let tile = [config.tile_width, config.tile_height];
    let work = extract_from(&footprints, &camera, &options, tile);
    Ok(simulate_alone(&work, config).raster)
}

/// The circuit's cycles of the same picture until its last pixel is written, and its tiles' pixels; `expected` are the model's cycles.
pub fn circuit_cycles(
    bench: &mut Bench,
    widths: &Widths,
    workload: &BenchWorkload,
    config: &Config,
    expected: u64,
) -> Result<(u64, Vec<Vec<Pixel>>)> {
    let layout = &Layout::new(widths);
    let Handed {
        places,
        tiles,
        backgrounds,
    } = Handed::new(workload);
    let order = tiles.iter().flat_map(|tile| &tile.list).copied();
    let mut memory = PictureMemory::new(layout, config, order.collect());
    // The circuit clears its buffers once, after its reset: before the picture.
    // It begins in a cycle in which packets are taken, as the model does.
    let interval = SETUP_INTERVAL.into();
    while bench.step(&bench.pixel_offer(false)).tile_ready == 0
        || !bench.cycles_since_reset().is_multiple_of(interval)
    {}
    let start = bench.cycles();
    let patience = PATIENCE * expected + (1 << 20);
    let mut background = Background::new(config, &backgrounds);
    let mut drawing = CircuitDrawing {
        tiles: &tiles,
        drawn: 0,
        phase: PicturePhase::Tile,
    };
    let mut reading = Reading {
        pixel_cycles: memory.pixel_cycles,
        pixels: Vec::new(),
        written: None,
    };
    while !drawing.is_done() || reading.is_busy(&tiles) || background.is_owed() {
        let now = bench.cycles() - start;
        ensure!(now < patience, "the circuit hangs");
        background.hand_out(drawing.drawn);
        if !reading.is_busy(&tiles) {
            background.write();
        }
        let packet = memory.begin(now);
        let inputs = Inputs {
            pixel_ready: reading.is_ready(now).into(),
            ..drawing.offer(bench, workload, packet)
        };
        let out = bench.step(&inputs);
        if taken(&inputs, out.packet_ready) {
            memory.coming.pop_front();
        }
        reading.note(now, &inputs, &out);
        if drawing.note(&inputs, &out) {
            reading.pixels.push(Vec::new());
        }
    }
    let clear = |tile: &BenchTile| vec![Pixel::clear(widths); tile.size().iter().product()];
    let mut pictures: Vec<Vec<Pixel>> = workload.tiles.iter().map(clear).collect();
    for (place, pixels) in places.into_iter().zip(reading.pixels) {
        pictures[place] = pixels;
    }
    Ok((bench.cycles() - start, pictures))
}

/// A picture's tiles as they are handed out, row by row as the model does: with two buffers their order matters.
struct Handed {
    /// Tiles with splats: their places in the workload, and the tiles.
    places: Vec<usize>,
    tiles: Vec<BenchTile>,
    /// Pixels of the tiles without, and how many with splats come before them.
    backgrounds: Vec<(usize, u64)>,
}

impl Handed {
    fn new(workload: &BenchWorkload) -> Handed {
        let mut all: Vec<(usize, &BenchTile)> = workload.tiles.iter().enumerate().collect();
        all.sort_by_key(|(_, tile)| {
            let [x, y] = tile.window.first;
            [y, x]
        });
        let mut handed = Handed {
            places: Vec::new(),
            tiles: Vec::new(),
            backgrounds: Vec::new(),
        };
        for (place, tile) in all {
            if tile.list.is_empty() {
                let pixels = tile.size().iter().product::<usize>() as u64;
                handed.backgrounds.push((handed.tiles.len(), pixels));
            } else {
                handed.places.push(place);
                handed.tiles.push(tile.clone());
            }
        }
        handed
    }
}

/// The tiles without splats, written while no tile is read out.
struct Background {
    /// How many tiles with splats come before, and cycles of the write channel.
    to_come: VecDeque<(usize, u64)>,
    /// Cycles for which those handed out will keep the channel.
    owed: u64,
}

impl Background {
    fn new(config: &Config, backgrounds: &[(usize, u64)]) -> Background {
        let cycles = |pixels: u64| {
            let bytes = pixels * u64::from(config.pixel_bytes);
            bytes.div_ceil(config.write_bandwidth.into())
        };
        let tiles = backgrounds.iter();
        Background {
            to_come: tiles
                .map(|(after, pixels)| (*after, cycles(*pixels)))
                .collect(),
            owed: 0,
        }
    }

    /// Hands out the tiles whose turn comes after so many drawn ones.
    fn hand_out(&mut self, drawn: usize) {
        while let Some((_, cycles)) = self.to_come.pop_front_if(|(after, _)| *after <= drawn) {
            self.owed += cycles;
        }
    }

    fn is_owed(&self) -> bool {
        self.owed > 0 || !self.to_come.is_empty()
    }

    /// The channel's next cycle, if there is anything to write.
    fn write(&mut self) {
        self.owed = self.owed.saturating_sub(1);
    }
}

/// The side of the bench that offers tiles, packets and their ends.
struct CircuitDrawing<'a> {
    tiles: &'a [BenchTile],
    drawn: usize,
    phase: PicturePhase,
}

/// What the circuit is asked for.
enum PicturePhase {
    Tile,
    Packets(usize),
    Finish,
}

impl CircuitDrawing<'_> {
    fn is_done(&self) -> bool {
        self.drawn == self.tiles.len()
    }

    fn offer(&self, bench: &Bench, workload: &BenchWorkload, packet: Option<u32>) -> Inputs {
        match (&self.phase, packet) {
            (PicturePhase::Tile, _) => match self.tiles.get(self.drawn) {
                Some(tile) => bench.tile_offer(tile),
                None => bench.pixel_offer(false),
            },
            (PicturePhase::Packets(_), Some(packet)) => {
                bench.packet_offer(&workload.footprints[packet as usize])
            }
            (PicturePhase::Packets(_), None) => bench.pixel_offer(false),
            (PicturePhase::Finish, _) => bench.finish_offer(),
        }
    }

    /// Goes on with what the circuit answered; `true` if a tile has ended.
    fn note(&mut self, inputs: &Inputs, out: &Outputs) -> bool {
        match self.phase {
            PicturePhase::Tile if inputs.tile_valid == 1 && out.tile_ready == 1 => {
                let count = self.tiles[self.drawn].list.len();
                self.phase = packets(count);
            }
            PicturePhase::Packets(left) if taken(inputs, out.packet_ready) => {
                self.phase = packets(left - 1);
            }
            PicturePhase::Finish if out.finish_ready == 1 => {
                self.phase = PicturePhase::Tile;
                self.drawn += 1;
                return true;
            }
            _ => {}
        }
        false
    }
}

fn packets(left: usize) -> PicturePhase {
    if left == 0 {
        PicturePhase::Finish
    } else {
        PicturePhase::Packets(left)
    }
}

/// The side that takes pixels, as fast as the write channel does.
struct Reading {
    pixel_cycles: u64,
    /// Of every tile that has ended.
    pixels: Vec<Vec<Pixel>>,
    /// The cycle in which the write channel has taken the next pixel, once that is known.
    written: Option<u64>,
}

impl Reading {
    fn is_ready(&self, now: u64) -> bool {
        self.written == Some(now) || self.pixel_cycles == 1
    }

    fn is_busy(&self, tiles: &[BenchTile]) -> bool {
        let last = self
            .pixels
            .last()
            .zip(tiles.get(self.pixels.len().wrapping_sub(1)));
        last.is_some_and(|(pixels, tile)| pixels.len() < tile.size().iter().product::<usize>())
    }

    fn note(&mut self, now: u64, inputs: &Inputs, out: &Outputs) {
        if out.pixel_valid == 0 {
            self.written = None;
        } else if inputs.pixel_ready == 1 {
            self.pixels
                .last_mut()
                .into_iter()
                .for_each(|pixels| pixels.push(pixel(out)));
            self.written = Some(now + self.pixel_cycles);
        } else if self.written.is_none() {
            self.written = Some(now + self.pixel_cycles - 1);
        }
    }
}

/// Packets on their way, and the channel of finished pixels.
struct PictureMemory {
    transfer: u64,
    latency: u64,
    queue: usize,
    pixel_cycles: u64,
    /// Packets to be requested, and those requested with the cycles of their arrival.
    to_come: VecDeque<u32>,
    coming: VecDeque<(u32, u64)>,
    /// First cycle in which the next packet may be requested.
    free: u64,
}

impl PictureMemory {
    fn new(layout: &Layout, config: &Config, order: VecDeque<u32>) -> PictureMemory {
        let bytes = 4 * layout.words() as u32 + config.list_bytes;
        PictureMemory {
            transfer: bytes.div_ceil(config.read_bandwidth).into(),
            latency: config.latency.into(),
            queue: config.packet_fifo as usize,
            pixel_cycles: config.pixel_bytes.div_ceil(config.write_bandwidth).into(),
            to_come: order,
            coming: VecDeque::new(),
            free: 0,
        }
    }

    /// A cycle begins: requests a packet where there is room; gives the packet that waits.
    fn begin(&mut self, now: u64) -> Option<u32> {
        if self.free <= now
            && self.coming.len() < self.queue
            && let Some(packet) = self.to_come.pop_front()
        {
            self.free = now + self.transfer;
            self.coming.push_back((packet, self.free + self.latency));
        }
        self.coming
            .front()
            .filter(|(_, arrival)| *arrival <= now)
            .map(|(packet, _)| *packet)
    }
}

fn taken(inputs: &Inputs, packet_ready: u8) -> bool {
    inputs.packet_valid == 1 && packet_ready == 1
}
