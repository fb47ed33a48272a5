//! The bench: drives tiles through the verilated primitive, with or without back-pressure, and counts cycles.

use crate::model::{Inputs, Missing, Model, Outputs, RESET_CYCLES};
use crate::package::table;
use crate::roots::Roots;
use crate::stamps::Stamps;
use crate::workload::BenchTile;
use splatline::blend::{Blend, FINISHED, Pixel};
use splatline::footprint::Footprint;
use splatline::footprint::packet::Layout;
use splatline::format::Widths;
use splatline::rules::Rules;
use splatline_sim::machine::primitive::SETUP_INTERVAL;

/// Cycles within which a handshake must answer; beyond it the circuit hangs.
const PATIENCE: u32 = 1 << 22;

/// Pauses at the interfaces: in how many of 256 cycles each of them is held back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pauses {
    /// No packet is offered.
    pub packets: u8,
    /// The lanes must wait.
    pub lanes: u8,
    /// No pixel of the read-out is taken.
    pub pixels: u8,
}

/// What a tile gave.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchOutcome {
    /// The window's pixels, row by row, in the kernel's words.
    pub pixels: Vec<Pixel>,
    /// In which cycle everything happened.
    pub stamps: Stamps,
    /// The row unit's roots.
    pub roots: Roots,
    /// A rule of the interfaces that the circuit broke, in words.
    pub broken: Option<String>,
}

/// A circuit with its rules and footprint table loaded.
pub struct Bench {
    model: Model,
    layout: Layout,
    idle: Inputs,
    random: u64,
    stamps: Stamps,
    roots: Roots,
    /// Were the lanes allowed to move in the cycle before?
    enabled: bool,
    broken: Option<String>,
    /// Cycles between two packets for which the circuit is built.
    pub setup_interval: u32,
}

impl Bench {
    /// The primitive of a named design, ready for tiles under `rules`.
    pub fn new(
        design: &str,
        widths: &Widths,
        lanes: usize,
        rules: &Rules,
        seed: u32,
    ) -> Result<Bench, Missing> {
        let model = Model::new(design, lanes, seed)?;
        Ok(Self::around(model, widths, rules, seed))
    }

    /// The same around a circuit that exists already.
    pub fn around(model: Model, widths: &Widths, rules: &Rules, seed: u32) -> Bench {
        let mut bench = Bench {
            model,
            layout: Layout::new(widths),
            idle: rule_inputs(widths, rules),
            random: u64::from(seed) + 1,
            stamps: Stamps::default(),
            roots: Roots::default(),
            enabled: true,
            broken: None,
            setup_interval: SETUP_INTERVAL,
        };
        for (index, entry) in table(widths, rules).iter().enumerate() {
            let inputs = Inputs {
                table_valid: 1,
                table_index: index as u32,
                table_low: entry.low,
                table_step: entry.step,
                ..bench.idle
            };
            bench.model.tick(&inputs);
        }
        bench
    }

    /// Cycles simulated so far.
    pub fn cycles(&self) -> u64 {
        self.model.cycles()
    }

    /// Of these, those since the reset with which the circuit began.
    pub fn cycles_since_reset(&self) -> u64 {
        self.model.cycles() - RESET_CYCLES
    }

    /// Inputs that offer a tile.
    pub(crate) fn tile_offer(&self, tile: &BenchTile) -> Inputs {
        let [first_column, first_row] = tile.window.first;
        let [end_column, end_row] = tile.window.end;
        Inputs {
            tile_valid: 1,
            first_column,
            first_row,
            end_column,
            end_row,
            ..self.idle
        }
    }

    /// Inputs that offer a packet.
    pub(crate) fn packet_offer(&self, footprint: &Footprint) -> Inputs {
        Inputs {
            packet_valid: 1,
            packet: self.layout.encode(footprint),
            ..self.idle
        }
    }

    /// Inputs that end a tile.
    pub(crate) fn finish_offer(&self) -> Inputs {
        Inputs {
            finish_valid: 1,
            ..self.idle
        }
    }

    /// Inputs that take the read-out's pixel, or let it wait.
    pub(crate) fn pixel_offer(&self, ready: bool) -> Inputs {
        Inputs {
            pixel_ready: ready.into(),
            ..self.idle
        }
    }

    /// Draws a tile. The error says which handshake the circuit did not answer.
    pub fn draw(
        &mut self,
        tile: &BenchTile,
        footprints: &[Footprint],
        pauses: Pauses,
    ) -> Result<BenchOutcome, String> {
        let offer = self.tile_offer(tile);
        self.wait("tile_ready", pauses, &offer, |out| out.tile_ready == 1)?;
        self.stamps = Stamps {
            setup_interval: self.setup_interval,
            ..Stamps::default()
        };
        self.roots = Roots::default();
        self.packets(tile, footprints, pauses)?;
        let stamps = std::mem::take(&mut self.stamps);
        let roots = std::mem::take(&mut self.roots);
        let finish = self.finish_offer();
        self.wait("finish_ready", pauses, &finish, |out| out.finish_ready == 1)?;
        let count = tile.size().iter().product();
        let mut pixels = Vec::with_capacity(count);
        while pixels.len() < count {
            let ready = !self.chance(pauses.pixels);
            let take = self.pixel_offer(ready);
            let out = self.wait("pixel_valid", Pauses::default(), &take, |out| {
                out.pixel_valid == 1
            })?;
            if ready {
                pixels.push(pixel(&out));
            }
        }
        Ok(BenchOutcome {
            pixels,
            stamps,
            roots,
            broken: self.broken.take(),
        })
    }

    fn packets(
        &mut self,
        tile: &BenchTile,
        footprints: &[Footprint],
        pauses: Pauses,
    ) -> Result<(), String> {
        for index in &tile.list {
            while self.chance(pauses.packets) {
                let idle = self.idle;
                self.tick(&idle, pauses);
            }
            let offer = self.packet_offer(&footprints[*index as usize]);
            self.stamps.offered.push(self.model.cycles());
            self.wait("packet_ready", pauses, &offer, |out| out.packet_ready == 1)?;
            self.stamps.taken.push(self.model.cycles() - 1);
        }
        let idle = self.idle;
        self.wait("raster_idle", pauses, &idle, |out| out.raster_idle == 1)?;
        self.stamps.idle_at = self.model.cycles() - 1;
        Ok(())
    }

    /// Repeats the inputs until the circuit answers.
    fn wait(
        &mut self,
        what: &str,
        pauses: Pauses,
        inputs: &Inputs,
        answered: impl Fn(&Outputs) -> bool,
    ) -> Result<Outputs, String> {
        for _ in 0..PATIENCE {
            let out = self.tick(inputs, pauses);
            if answered(&out) {
                return Ok(out);
            }
        }
        Err(format!("the circuit hangs: no {what} in {PATIENCE} cycles"))
    }

    fn tick(&mut self, inputs: &Inputs, pauses: Pauses) -> Outputs {
        let lanes_enable = !self.chance(pauses.lanes);
        self.step(&Inputs {
            lanes_enable: lanes_enable.into(),
            ..*inputs
        })
    }

    /// One cycle; notes the handshakes inside the circuit.
    pub(crate) fn step(&mut self, inputs: &Inputs) -> Outputs {
        let now = self.model.cycles();
        let out = self.model.tick(inputs);
        self.stamps.note(now, &out);
        self.roots.note(&out);
        if !self.enabled && out.lanes_popped != 0 {
            let broken = format!("a lane took a run in cycle {now}, while lanes were held");
            self.broken.get_or_insert(broken);
        }
        self.enabled = inputs.lanes_enable == 1;
        out
    }

    /// True in `share` of 256 cases (SplitMix64).
    fn chance(&mut self, share: u8) -> bool {
        if share == 0 {
            return false;
        }
        (crate::workload::split_mix(&mut self.random) >> 56) < u64::from(share)
    }
}

/// The rules at the design's widths, by the kernel's own constants.
fn rule_inputs(widths: &Widths, rules: &Rules) -> Inputs {
    let constants = Blend::new(widths, rules).constants();
    Inputs {
        alpha_max: constants.alpha_max,
        least: constants.opacity_min,
        minimum_transmittance: constants.minimum_transmittance,
        omit_finishing: constants.omit_finishing.into(),
        wide_table: (rules.table_range == 4).into(),
        lanes_enable: 1,
        ..Inputs::default()
    }
}

/// The pixel that the read-out offers.
pub(crate) fn pixel(out: &Outputs) -> Pixel {
    let flag = if out.finished == 1 { FINISHED } else { 0 };
    Pixel {
        colour: [out.red, out.green, out.blue],
        transmittance: out.transmittance | flag,
    }
}
