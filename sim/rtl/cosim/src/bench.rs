//! The bench: drives tiles through the verilated primitive, with or without back-pressure, and counts cycles.

use crate::model::{Inputs, Missing, Model, Outputs};
use crate::package::table;
use crate::workload::Tile;
use splatline::blend::{FINISHED, Pixel};
use splatline::footprint::Footprint;
use splatline::footprint::packet::Layout;
use splatline::format::{Rounding, Widths};
use splatline::math::shift_unsigned;
use splatline::rules::Rules;

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
pub struct Outcome {
    /// The window's pixels, row by row, in the kernel's words.
    pub pixels: Vec<Pixel>,
    /// Cycles from the first packet's to the last packet's last pixel; 0 without packets.
    pub raster_cycles: u64,
}

/// A circuit with its rules and footprint table loaded.
pub struct Bench {
    model: Model,
    layout: Layout,
    idle: Inputs,
    random: u64,
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

    /// Draws a tile. The error says which handshake the circuit did not answer.
    pub fn draw(
        &mut self,
        tile: &Tile,
        footprints: &[Footprint],
        pauses: Pauses,
    ) -> Result<Outcome, String> {
        let [first_column, first_row] = tile.window.first;
        let [last_column, last_row] = tile.window.last;
        let offer = Inputs {
            tile_valid: 1,
            first_column,
            first_row,
            last_column,
            last_row,
            ..self.idle
        };
        self.wait("tile_ready", pauses, &offer, |out| out.tile_ready == 1)?;
        let raster_cycles = self.packets(tile, footprints, pauses)?;
        let finish = Inputs {
            finish_valid: 1,
            ..self.idle
        };
        self.wait("finish_ready", pauses, &finish, |out| out.finish_ready == 1)?;
        let count = usize::from(last_column - first_column) * usize::from(last_row - first_row);
        let mut pixels = Vec::with_capacity(count);
        while pixels.len() < count {
            let ready = !self.chance(pauses.pixels);
            let take = Inputs {
                pixel_ready: ready.into(),
                ..self.idle
            };
            let out = self.wait("pixel_valid", Pauses::default(), &take, |out| {
                out.pixel_valid == 1
            })?;
            if ready {
                pixels.push(pixel(&out));
            }
        }
        Ok(Outcome {
            pixels,
            raster_cycles,
        })
    }

    fn packets(
        &mut self,
        tile: &Tile,
        footprints: &[Footprint],
        pauses: Pauses,
    ) -> Result<u64, String> {
        let mut started = None;
        for index in &tile.list {
            while self.chance(pauses.packets) {
                let idle = self.idle;
                self.tick(&idle, pauses);
            }
            let packet = self.layout.encode(&footprints[*index as usize]);
            let offer = Inputs {
                packet_valid: 1,
                packet,
                ..self.idle
            };
            self.wait("packet_ready", pauses, &offer, |out| out.packet_ready == 1)?;
            started.get_or_insert(self.model.cycles());
        }
        let idle = self.idle;
        self.wait("raster_idle", pauses, &idle, |out| out.raster_idle == 1)?;
        Ok(started.map_or(0, |started| self.model.cycles() - started))
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
        self.model.tick(&Inputs {
            lanes_enable: lanes_enable.into(),
            ..*inputs
        })
    }

    /// True in `share` of 256 cases (SplitMix64).
    fn chance(&mut self, share: u8) -> bool {
        if share == 0 {
            return false;
        }
        (crate::workload::split_mix(&mut self.random) >> 56) < u64::from(share)
    }
}

/// The rules at the design's widths, as `Blend::new` brings them there.
fn rule_inputs(widths: &Widths, rules: &Rules) -> Inputs {
    let round = |value: u32, bits: u8| {
        shift_unsigned(value.into(), 31 - i32::from(bits), Rounding::Nearest) as u32
    };
    Inputs {
        alpha_max: round(rules.alpha_max, widths.alpha),
        alpha_min: round(rules.alpha_min, widths.alpha),
        stop: round(rules.stop, widths.transmittance),
        stop_before: rules.stop_before.into(),
        wide_table: (rules.table_range == 4).into(),
        lanes_enable: 1,
        ..Inputs::default()
    }
}

fn pixel(out: &Outputs) -> Pixel {
    let flag = if out.finished == 1 { FINISHED } else { 0 };
    Pixel {
        colour: [out.red, out.green, out.blue],
        transmittance: out.transmittance | flag,
    }
}
