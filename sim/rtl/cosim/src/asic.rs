//! Area and clock of the units in the standard cells of any Liberty file: `rtl -- area asic LIBERTY [WORDS]`.
//!
//! Yosys maps a circuit module by module, so that each unit's share can be told. Memories stay whole and are counted in
//! bits, since on a chip a compiler of memories makes them. A gate equivalent is the area of the library's smallest
//! NAND of two inputs: the figure that can be compared across nodes. The longest path of a module is abc's, between its
//! ports and registers, with the loads of the cells and without wires: a circuit that is laid out is slower. `asic.csv`
//! beside this folder is what it printed for primitives of four lanes in SKY130's cells (sky130_fd_sc_hd, typical
//! corner).

use crate::circuit::{Circuit, MACHINE, PRIMITIVE, set};
use crate::netlist::Netlist;
use crate::tools::{json, yosys};
use anyhow::{Context, Result, ensure};
use flate2::read::GzDecoder;
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::ops::AddAssign;
use std::path::Path;

/// Square micrometres that a gate of 28 nm takes, all included: 0.66 mm2 for 1.14 million gates and 120 KB of memory,
/// as arXiv 2604.10223 prints for its processor. Memories are in it, so it is an upper bound.
const GATE_28NM: f64 = 0.66e6 / 1.14e6;

/// abc's script: the best mapping for delay, buffers for high fan-out, and the longest path with loads.
const MAPPING: &str = "strash; &get -n; &fraig -x; &put; scorr; dc2; strash; &get -n; &dch -f; &nf; &put; buffer -c; topo; stime -p\n";

/// What is read of a Liberty file, and paths.
#[derive(Clone)]
struct Library {
    /// What each cell takes; of a circuit's modules, their longest paths.
    cells: BTreeMap<String, ModuleCost>,
    /// Area of the smallest NAND of two inputs.
    gate: f64,
}

impl Library {
    /// Areas and registers of all cells. A Liberty file is groups in braces,
    /// `cell (name) { area : 3.75; ff (IQ, IQ_N) { ... } }`, of which a cell's area comes before any other in it.
    fn parse(text: &str) -> Result<Library> {
        let mut cells = BTreeMap::new();
        let mut cell = String::new();
        for line in text.lines().map(str::trim) {
            if let Some(name) = group(line, "cell") {
                cells.insert(name.clone(), ModuleCost::default());
                cell = name;
            }
            let Some(found) = cells.get_mut(&cell) else {
                continue;
            };
            if let Some(area) = attribute(line, "area")
                && found.area == 0.0
            {
                let area = area.parse();
                found.area = area.with_context(|| format!("area of cell {cell}"))?;
            }
            found.flip_flops |= u64::from(group(line, "ff").is_some());
        }
        let gates = cells.iter().filter(|(name, _)| is_nand2(name));
        let gate = gates.map(|(_, cell)| cell.area).reduce(f64::min);
        let gate = gate.context("the library names no NAND of two inputs (nand2)")?;
        ensure!(gate > 0.0, "the library's NAND of two inputs has no area");
        Ok(Library { cells, gate })
    }

    /// The longest paths of modules in abc's log.
    fn add_paths(&mut self, log: &str) -> Result<()> {
        let mut module = String::new();
        for line in log.lines() {
            if let Some((_, rest)) = line.split_once("Extracting gate netlist of module `") {
                let name = rest.split('\'').next().unwrap_or_default();
                module = name.trim_start_matches('\\').to_owned();
            }
            if let Some((_, rest)) = line.split_once("Delay =") {
                let delay = rest.trim_start().split(' ').next().unwrap_or_default();
                let cost = self.cells.entry(module.clone()).or_default();
                cost.path = cost.path.max(delay.parse()?);
            }
        }
        Ok(())
    }

    /// Adds up by unit what a cell contains, and what it takes; a library's cell is no unit. (Yosys' statistics would
    /// do, but release 0.23 writes them as broken JSON for more than one module.)
    fn cost<'a>(&self, netlist: &'a Netlist, kind: &'a str, units: &mut Units<'a>) -> ModuleCost {
        let mut sum = self.cells.get(kind).copied().unwrap_or_default();
        let Some(module) = netlist.modules.get(kind) else {
            return sum;
        };
        for cell in module.cells.values() {
            sum += self.cost(netlist, &cell.kind, units);
            sum.memory_bits += cell.memory_bits().unwrap_or(0);
        }
        let unit = units.entry(readable(kind)).or_default();
        unit.0 += 1;
        unit.1 += sum;
        sum
    }
}

/// `nand2` in any case, but none with an inverted input (`nand2b`).
fn is_nand2(name: &str) -> bool {
    let name = name.to_lowercase();
    let rest = name.split_once("nand2");
    rest.is_some_and(|(_, rest)| !rest.starts_with('b'))
}

/// The name of a group of this kind that begins in the line.
fn group(line: &str, kind: &str) -> Option<String> {
    let rest = line.strip_prefix(kind)?.trim_start().strip_prefix('(')?;
    let (name, _) = rest.split_once(')')?;
    let name = name.trim_matches(|c: char| c == '"' || c.is_whitespace());
    Some(name.to_owned())
}

fn attribute<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    let value = line.strip_prefix(name)?.trim_start().strip_prefix(':')?;
    Some(value.trim_matches(|c: char| c == ';' || c == '"' || c.is_whitespace()))
}

/// What a module takes with all that it contains.
#[derive(Clone, Copy, Default)]
struct ModuleCost {
    area: f64,
    flip_flops: u64,
    memory_bits: u64,
    /// Longest path within one module, picoseconds.
    path: f64,
}

impl AddAssign for ModuleCost {
    fn add_assign(&mut self, part: ModuleCost) {
        self.area += part.area;
        self.flip_flops += part.flip_flops;
        self.memory_bits += part.memory_bits;
        self.path = self.path.max(part.path);
    }
}

/// Instances of a unit, and what they take.
type Units<'a> = BTreeMap<&'a str, (u64, ModuleCost)>;

/// A module's name without Yosys' parameters: `$paramod$0b1f...\delay` and `$paramod\align\BITS=s32'...` are `delay`
/// and `align`.
fn readable(module: &str) -> &str {
    let (first, rest) = module.split_once('\\').unwrap_or((module, ""));
    let name = rest.split('\\').next().filter(|name| !name.is_empty());
    name.unwrap_or(first)
}

/// Prints what a circuit takes in the cells of a Liberty file, by unit.
pub fn report(liberty: &Path, circuits: &[Circuit]) -> Result<()> {
    let bytes = fs::read(liberty).with_context(|| liberty.display().to_string())?;
    let text = if bytes.starts_with(&[0x1f, 0x8b]) {
        let mut text = String::new();
        GzDecoder::new(bytes.as_slice()).read_to_string(&mut text)?;
        text
    } else {
        String::from_utf8(bytes)?
    };
    let library = Library::parse(&text).with_context(|| liberty.display().to_string())?;
    println!(
        "circuit,unit,instances,area_um2,gate_equivalents,flip_flops,memory_bits,path_ns,area_28nm_mm2_scaled"
    );
    for circuit in circuits {
        let mut library = library.clone();
        let netlist = mapped(circuit, &mut library, &text)?;
        print!("{}", lines(circuit, &library, &netlist));
    }
    Ok(())
}

/// One line a unit, with what it contains; units within units are lines of their own too.
fn lines(circuit: &Circuit, library: &Library, netlist: &Netlist) -> String {
    let mut units = Units::new();
    library.cost(netlist, circuit.unit.top, &mut units);
    let mut units: Vec<_> = units.into_iter().collect();
    units.sort_by(|one, other| other.1.1.area.total_cmp(&one.1.1.area));
    let line = |(unit, (instances, cost)): (&str, (u64, ModuleCost))| {
        let gates = cost.area / library.gate;
        format!(
            "{circuit},{unit},{instances},{:.0},{gates:.0},{},{},{:.2},{:.3}\n",
            cost.area,
            cost.flip_flops,
            cost.memory_bits,
            cost.path / 1000.0,
            gates * GATE_28NM / 1e6,
        )
    };
    units.into_iter().map(line).collect()
}

/// Synthesises a circuit into the library's cells; adds its modules' longest paths to them.
fn mapped(circuit: &Circuit, library: &mut Library, liberty: &str) -> Result<Netlist> {
    let folder = tempfile::tempdir()?;
    let path = |name: &str| folder.path().join(name);
    let words = |name: &str| path(name).display().to_string();
    fs::write(path("cells.lib"), liberty)?;
    fs::write(path("mapping.abc"), MAPPING)?;
    let read = circuit.read_command(folder.path())?;
    let top = circuit.unit.top;
    let mut parameters = circuit.parameters.clone();
    if [PRIMITIVE, MACHINE].contains(circuit.unit) {
        // A memory has as many words as it needs.
        parameters.push(("BLOCK_WORDS", 0));
    }
    let (cells, mapping) = (words("cells.lib"), words("mapping.txt"));
    let (netlist, script) = (words("netlist.json"), words("mapping.abc"));
    yosys(&format!(
        "{read}; {}synth -top {top} -run begin:fine; opt -fast -full; opt -undriven -fine; techmap; opt -fast; abc -fast; opt -fast; \
         dfflibmap -liberty {cells}; tee -q -o {mapping} abc -liberty {cells} -script {script}; \
         opt_clean; write_json {netlist}",
        set(top, &parameters)
    ))?;
    library.add_paths(&fs::read_to_string(path("mapping.txt"))?)?;
    json(&path("netlist.json"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIBERTY: &str = r#"
library ("small") {
  cell ("lib_nand2_1") { 
    area : 3.5000000000;
    pin ("A") { area : 99; }
  }
  cell ("lib_nand2b_1") {
    area : 2.0;
  }
  cell (DFF) {
    area : 20;
    ff ("IQ","IQ_N") {
      next_state : "D";
    }
  }
}
"#;

    #[test]
    fn a_library_gives_areas_registers_and_its_gate() {
        let library = Library::parse(LIBERTY).unwrap();
        assert_eq!(library.gate, 3.5);
        let cell = |name| (library.cells[name].area, library.cells[name].flip_flops);
        assert_eq!(cell("DFF"), (20.0, 1));
        assert_eq!(cell("lib_nand2_1"), (3.5, 0));
        assert!(Library::parse("library (none) { }").is_err());
    }

    /// A top of two lanes with a gate, a register and a memory each, and a gate of its own.
    #[test]
    fn units_are_added_up_with_what_they_contain() {
        let mut library = Library::parse(LIBERTY).unwrap();
        let text = r#"{"modules": {
            "top": {"ports": {}, "cells": {
                "a": {"type": "$paramod$0123\\lane", "parameters": {}},
                "b": {"type": "$paramod$0123\\lane", "parameters": {}},
                "c": {"type": "lib_nand2_1", "parameters": {}}}},
            "$paramod$0123\\lane": {"ports": {}, "cells": {
                "a": {"type": "lib_nand2_1", "parameters": {}},
                "b": {"type": "DFF", "parameters": {}},
                "c": {"type": "$mem_v2", "parameters": {"SIZE": "00100000", "WIDTH": "0101"}}}}}}"#;
        let log = "1. Extracting gate netlist of module `$paramod$0123\\lane' to `x'..\nABC: Delay =   281.93 ps\n";
        library.add_paths(log).unwrap();
        let netlist = serde_json::from_str(text).unwrap();
        let mut units = Units::new();
        let all = library.cost(&netlist, "top", &mut units);
        assert_eq!(all.area, 2.0 * (3.5 + 20.0) + 3.5);
        assert_eq!(
            (all.flip_flops, all.memory_bits, all.path),
            (2, 320, 281.93)
        );
        assert_eq!(units["lane"].0, 2);
        assert_eq!(units["lane"].1.area, 47.0);
    }

    #[test]
    fn names_lose_their_parameters() {
        assert_eq!(readable("$paramod$0b1f\\delay"), "delay");
        assert_eq!(readable("$paramod\\align\\BITS=s32'0100"), "align");
        assert_eq!(readable("splat_primitive"), "splat_primitive");
    }
}
