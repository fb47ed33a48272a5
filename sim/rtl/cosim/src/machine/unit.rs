//! A scene's records in a memory image, through the machine, and the frame that it leaves there: every pixel against
//! the kernel's, cycles against the model's.

use super::image::{MemoryImage, kernel_frame, pixel_word, places};
use super::loads::{MachineLoad, ROW, add_harmonics, gaps, small};
use crate::bench::Bench;
use crate::circuit::MACHINE;
use crate::memory::{Memory, MemoryTiming, timing};
use crate::rules::write_rules;
use crate::scenes::{SCENES, Seen, scenes};
use crate::setup::constants::constants;
use crate::setup::enlarged;
use crate::setup::program::{ProgramKind, SetupProgram};
use crate::setup::unit::write_constants;
use crate::simulation::Simulation;
use crate::unit::{Circuit, Extent, Findings, Load, Loads, Missing};
use anyhow::{Context, Result, bail, ensure};
use splatline::blend::Pixel;
use splatline_sim::machine::{Config, simulate_alone};

/// Cycles in which a harmonics unit with one and with two multipliers makes a colour, by the degree
/// (`rtl -- compare harmonics`).
const HARMONICS_CYCLES: [[u32; 5]; 2] = [[14, 22, 52, 95, 153], [14, 16, 34, 56, 93]];

/// Places of setup's queue where packets wait for colours (`setup_unit.sv`).
const WAITING_FOR_COLOURS: u32 = 32;

/// Cycles without an access to the memory after which the machine hangs.
const PATIENCE: u64 = 1 << 18;

/// A memory, and frames in a row, of which the last counts: what one leaves behind must not reach the next. A single
/// one shows whether it is said to be whole too early. A memory of usual latency at full speed; slow and narrow; with
/// pauses, whose cycles no model counts, twice and once; and lists without room.
const TIMINGS: [(MemoryTiming, u32); 5] = [
    (timing([60, 0], 16, false), 2),
    (timing([300, 0], 4, false), 2),
    (timing([13, 3], 16, false), 2),
    (timing([13, 3], 16, false), 1),
    (timing([60, 0], 16, true), 1),
];

/// The machine of a design with so many cores of setup and lanes.
pub fn circuit(design: &str, cores: u32, lanes: u32) -> Result<Circuit> {
    Ok(Circuit::new(&MACHINE, design, lanes)?.with("CORES", cores))
}

/// The machine with a unit of so many multipliers that makes its splats' colours.
pub fn with_harmonics(machine: Circuit, multipliers: u32) -> Circuit {
    let program = SetupProgram::new(ProgramKind::Filter).with_direction();
    machine.with(HARMONICS, multipliers).with_program(program)
}

/// The parameter that says how many multipliers make colours, if any do.
const HARMONICS: &str = "HARMONICS";

/// The machine as the model clocks it.
fn config(circuit: &Circuit) -> Result<Config> {
    let program = circuit.program.assembled(&circuit.design.widths)?;
    let [lanes, cores] = [0, 1].map(|place: usize| circuit.parameters[place].1);
    // Every core of setup takes a splat in a round of the program, and each group hands on a cycle later what it
    // was told.
    Ok(Config {
        setup_units: cores,
        setup_interval: program.round as u32,
        setup_latency: program.latency() as u32 + cores.div_ceil(4),
        ..Config::machine(lanes)
    })
}

/// The model's cycles: all, geometry, raster.
fn modelled(circuit: &Circuit, load: &MachineLoad, memory: &MemoryTiming) -> Result<[u64; 3]> {
    let mut config = Config {
        latency: memory.latency as u32,
        read_bandwidth: memory.bytes,
        write_bandwidth: memory.bytes,
        ..config(circuit)?
    };
    if let (Some(harmonics), Some(multipliers)) = (&load.harmonics, circuit.parameter(HARMONICS)) {
        let cycles = HARMONICS_CYCLES[multipliers as usize - 1];
        config.harmonics_bytes = 16 * harmonics[0].colours.len() as u32;
        config.harmonics_cycles = cycles[usize::from(harmonics[0].degree)];
        config.bin_fifo = WAITING_FOR_COLOURS;
    }
    let timing = simulate_alone(&load.workload, &config);
    Ok([timing.total, timing.geometry, timing.raster])
}

impl Load for MachineLoad {
    const WAYS: usize = TIMINGS.len();

    fn all(circuit: &Circuit, extent: Extent, missing: &mut Missing) -> Result<Loads<MachineLoad>> {
        let (mut seen, apart) = match extent {
            Extent::Quick => (small(), 1_200),
            Extent::Full => (scenes(&SCENES, 128, missing)?, u64::MAX),
        };
        if circuit.program.directs {
            seen.push(gaps());
            for (degree, seen) in (1..).zip(&mut seen) {
                add_harmonics(seen, degree);
            }
        }
        // Distance scaling replaces the low-pass filter, without which no splat of the row is high enough to meet it.
        if circuit.program.kind == ProgramKind::DistanceScaling {
            seen.retain(|seen| seen.name != ROW);
        }
        let load = |seen: Seen| (seen.name.to_owned(), MachineLoad::new(seen, circuit, apart));
        Ok(seen.into_iter().map(load).collect())
    }

    fn compare(&self, circuit: &Circuit, mut bench: Bench, pressure: usize) -> Result<Findings> {
        let (timing, frames) = TIMINGS[pressure];
        let (scene, rules) = (&self.scene, &self.scene.rules);
        let design = &circuit.design;
        let widths = &design.widths;
        let constants = constants(circuit, &scene.view, rules)?;
        write_constants(&mut bench, &constants);
        write_rules(&mut bench, widths, rules);
        // The tile buffers are cleared once.
        (0..1_100).for_each(|_| bench.cycle());
        let room = self.lists.entries() - usize::from(timing.full);
        let image = MemoryImage::new(widths, self, room)?;
        bench.set(&image.places);
        let mut simulation = bench.circuit;
        let mut memory = Memory::new(&simulation, image.words, timing);
        let mut phases = [0; 4];
        for _ in 0..frames {
            let drawn = draw(&mut simulation, &mut memory, self, &mut phases);
            drawn.with_context(|| format!("after {phases:?} cycles"))?;
        }
        // What was written last is on its way for a while.
        (0..=timing.latency).for_each(|_| memory.cycle(&mut simulation));
        let full = simulation.read("full") == 1;
        let expected = kernel_frame(design, self)?;
        let [all, geometry, raster] = modelled(circuit, self, &timing)?;
        let mut findings = Findings {
            // Without room for the lists there is no frame.
            compared: if full { 0 } else { expected.len() as u64 },
            cycles: phases.iter().sum(),
            ..Findings::default()
        };
        // Of the memory at full speed alone: a sum over memories of several speeds tells nothing about any of them.
        if pressure == 0 {
            let clear = pixel_word(&Pixel::clear(widths));
            let painted = expected.iter().filter(|pixel| **pixel != clear).count();
            let beyond = enlarged(widths, &scene.view, rules, &scene.splats);
            findings.counts = vec![
                ("splats", scene.splats.len() as u64),
                ("seen", simulation.read("visible")),
                ("beyond k", beyond as u64),
                ("painted", painted as u64),
                ("entries", simulation.read("entries")),
                ("geometry", phases[0]),
                ("geometry, model", geometry),
                ("sort", phases[1]),
                ("lists", phases[2]),
                ("raster", phases[3]),
                ("raster, model", raster),
                ("all, model", all),
            ];
        }
        let timed = timing.pauses == 0 && all.abs_diff(findings.cycles) >= self.apart;
        let timed = timed.then(|| format!("{} cycles, {all} by the model", findings.cycles));
        findings.first_difference = memory.astray(full);
        if findings.first_difference.is_none() && !full {
            let size = scene.view.viewport.map(usize::from);
            let drawn = difference(&expected, &memory.words[image.frame..], size);
            findings.first_difference = timed.or(drawn);
        }
        Ok(findings)
    }
}

/// Draws a frame; counts the cycles of geometry, sort, lists and raster.
fn draw(
    circuit: &mut Simulation,
    memory: &mut Memory,
    load: &MachineLoad,
    phases: &mut [u64; 4],
) -> Result<()> {
    let [begins, phase, listing] = circuit.ports(["begins", "phase", "listing"]);
    *phases = [0; 4];
    circuit.set(begins, 1);
    memory.cycle(circuit);
    circuit.set(begins, 0);
    // A circuit that goes on reading and writing hangs as well.
    let work = 1_000 * load.seen.scene.splats.len() + 1_100 * load.lists.entries();
    let pixels = load.seen.camera.width * load.seen.camera.height;
    for _ in 0..PATIENCE + (work + 16 * pixels) as u64 {
        memory.settle(circuit);
        let now = circuit.get(phase);
        let lists = circuit.is(listing);
        memory.edge(circuit);
        match now {
            0 => return Ok(()),
            1 => phases[0] += 1,
            2 if lists => phases[2] += 1,
            2 => phases[1] += 1,
            _ => phases[3] += 1,
        }
        ensure!(memory.idle < PATIENCE, "the machine hangs");
    }
    bail!("the machine hangs")
}

/// The first pixel with another word than the kernel's.
fn difference(expected: &[[u32; 4]], got: &[[u32; 4]], size: [usize; 2]) -> Option<String> {
    let mut pixels = places(size).zip(expected).zip(got);
    let ((place, wanted), got) = pixels.find(|((_, wanted), got)| wanted != got)?;
    let at = [place % size[0], place / size[0]];
    Some(format!("pixel {at:?}: {got:x?}, not {wanted:x?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The preset's setup is the program's, for as many cores as take a splat in its interval.
    #[test]
    fn the_models_machine_has_the_programs_latency() {
        let preset = Config::machine(4);
        let of_cores = |cores| config(&circuit("lean18", cores, 4).unwrap()).unwrap();
        let cores = of_cores(1).setup_interval.div_ceil(preset.setup_interval);
        assert_eq!(of_cores(cores).setup_latency, preset.setup_latency);
    }
}
