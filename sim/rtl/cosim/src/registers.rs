//! Registers inside of multipliers and block RAM.
//!
//! A MULT18X18D of an ECP5 has registers at its inputs and at its output, a DP16KD has one behind its words. Yosys 0.23
//! uses none of them, so that a product goes a multiplier's whole way and a wire's to the register outside, and a word
//! 5.6 ns and a wire. This does on the netlist what the vendors' tools do: a register moves in where it holds nothing
//! but what a multiplier or a memory gives, or all that a multiplier takes. What is computed in which cycle stays.
//!
//! Two multipliers of a device stand in one block and share its four enables, and the output's register takes the first
//! one. So an enable has the same number everywhere: the first is that of most products, and only products of this
//! enable move in. Registers that are written alike are one enable, whatever they are called.

use crate::netlist::{Bit, Netlist, NetlistCell};
use anyhow::{Context, Result};
use std::collections::{BTreeMap, HashMap, HashSet};

/// What a multiplier and a memory are called on the ECP5.
const MULTIPLIER: &str = "MULT18X18D";
const MEMORY: &str = "DP16KD";
const REGISTER: &str = "TRELLIS_FF";

/// Bits of a factor, and of a product.
const FACTOR: usize = 18;
const PRODUCT: usize = 36;

/// A multiplier's enables.
const ENABLES: [&str; 4] = ["CE0", "CE1", "CE2", "CE3"];

/// Data width from which both of a memory's ports are one.
const PAIRED: i64 = 36;

/// A flip-flop without a reset.
struct Register {
    cell: String,
    data: Bit,
    output: u64,
    clock: Bit,
    /// The constant 1, if it is written in every cycle.
    enable: Bit,
}

/// A netlist's cells by their names.
type Cells = BTreeMap<String, NetlistCell>;

/// What is connected to what.
struct Wiring {
    /// By the net that it drives.
    registers: HashMap<u64, Register>,
    /// By the net that it is written with, if nothing else reads that: what it drives.
    behind: HashMap<u64, u64>,
    /// Nets that nobody reads have no entry.
    readers: HashMap<u64, u32>,
}

/// Registers that move in with a cell, each with its pin: one or more, all of one clock and enable.
type Pins<'a> = Vec<(String, &'a Register)>;

/// Moves registers of `top` into multipliers and memories; gives how many flip-flops there are no more.
pub fn move_in(netlist: &mut Netlist, top: &str) -> Result<u64> {
    let module = netlist.modules.get_mut(top);
    let module = module.with_context(|| format!("a netlist without {top}"))?;
    let ports = module.ports.values().flat_map(|port| &port.bits);
    let ports: Vec<u64> = ports.filter_map(Bit::net).collect();
    let cells = &mut module.cells;
    let before = cells.len();
    let wiring = Wiring::of(cells, &ports);
    let mut gone = HashSet::new();
    let first = most_frequent_enable(cells, &wiring);
    let mut enables: Vec<Bit> = first.into_iter().collect();
    for cell in cells.values_mut() {
        if cell.kind == MULTIPLIER {
            if let Some(pins) = wiring.product(cell)
                && number(&mut enables, &pins[0].1.enable) == Some(ENABLES[0])
            {
                take_words(cell, &pins, &mut gone);
                cell.set("REG_OUTPUT_CLK", "CLK0");
                cell.connect("CLK0", &pins[0].1.clock);
                cell.connect(ENABLES[0], &pins[0].1.enable);
            }
            take_factors(cell, &wiring, &mut enables);
        } else if cell.kind == MEMORY {
            take_memory_words(cell, &wiring, &mut gone);
        }
    }
    cells.retain(|name, _| !gone.contains(name));
    // Registers of factors that only multipliers read, and of enables that only those had.
    loop {
        let left = cells.len();
        let read = Wiring::of(cells, &ports).readers;
        let is_read = |cell: &NetlistCell| cell.net("Q").is_none_or(|net| read.contains_key(&net));
        cells.retain(|_, cell| cell.kind != REGISTER || is_read(cell));
        if cells.len() == left {
            break;
        }
    }
    Ok(u64::try_from(before - cells.len())?)
}

/// The pin of an enable, as long as there is one left.
fn number(enables: &mut Vec<Bit>, enable: &Bit) -> Option<&'static str> {
    let known = enables.iter().position(|known| known == enable);
    let pin = ENABLES.get(known.unwrap_or(enables.len()))?;
    if known.is_none() {
        enables.push(enable.clone());
    }
    Some(pin)
}

impl Wiring {
    fn of(cells: &Cells, ports: &[u64]) -> Wiring {
        let mut readers: HashMap<u64, u32> = HashMap::new();
        let inputs = cells.values().flat_map(NetlistCell::inputs);
        for net in inputs.chain(ports.iter().copied()) {
            *readers.entry(net).or_default() += 1;
        }
        let flip_flops = cells.iter().filter(|(_, cell)| cell.kind == REGISTER);
        let alike = written_alike(flip_flops.clone().map(|(_, cell)| cell));
        let registers = flip_flops.filter_map(|(name, cell)| register(name, cell, &alike));
        let registers = registers.map(|register| (register.output, register));
        let registers: HashMap<u64, Register> = registers.collect();
        let behind = registers.iter().filter_map(|(output, register)| {
            let data = register.data.net()?;
            (readers.get(&data) == Some(&1)).then_some((data, *output))
        });
        Wiring {
            behind: behind.collect(),
            registers,
            readers,
        }
    }

    /// The registers behind these pins. Pins that nobody reads need none.
    fn behind(&self, cell: &NetlistCell, pins: impl Iterator<Item = String>) -> Option<Pins<'_>> {
        let mut found = Vec::new();
        for name in pins {
            let net = cell.net(&name);
            if let Some(net) = net.filter(|net| self.readers.contains_key(net)) {
                found.push((name, &self.registers[self.behind.get(&net)?]));
            }
        }
        together(found)
    }

    fn product(&self, cell: &NetlistCell) -> Option<Pins<'_>> {
        self.behind(cell, (0..PRODUCT).map(|bit| format!("P{bit}")))
    }

    /// The registers before a factor's pins. Zeros need none.
    fn factor(&self, cell: &NetlistCell, side: &str) -> Option<Pins<'_>> {
        let mut found = Vec::new();
        for bit in 0..FACTOR {
            let name = format!("{side}{bit}");
            if let Some(bit) = cell.pin(&name).filter(|bit| !bit.is("0")) {
                found.push((name, self.registers.get(&bit.net()?)?));
            }
        }
        together(found)
    }
}

/// The registers, if there are any and all of them are of one clock and enable.
fn together(pins: Pins) -> Option<Pins> {
    let first = pins.first()?.1;
    let same = |other: &Register| other.clock == first.clock && other.enable == first.enable;
    pins.iter().all(|(_, other)| same(other)).then_some(pins)
}

/// The enable of most products that have registers.
fn most_frequent_enable(cells: &Cells, wiring: &Wiring) -> Option<Bit> {
    let multipliers = cells.values().filter(|cell| cell.kind == MULTIPLIER);
    let products = multipliers.filter_map(|cell| wiring.product(cell));
    let enables: Vec<&Bit> = products.map(|pins| &pins[0].1.enable).collect();
    let most = enables.iter().max_by_key(|enable| {
        let alike = enables.iter().filter(|other| other == enable).count();
        // As texts, so that of several it is always the same.
        (alike, serde_json::to_string(enable).ok())
    });
    most.map(|enable| (*enable).clone())
}

/// Lets a cell drive what the registers behind it drove.
fn take_words(cell: &mut NetlistCell, pins: &Pins, gone: &mut HashSet<String>) {
    for (name, register) in pins {
        let bits = vec![Bit::Net(register.output)];
        cell.connections.insert(name.clone(), bits);
        gone.insert(register.cell.clone());
    }
}

/// Both factors' registers move in, or none: nextpnr times no other multiplier.
fn take_factors(cell: &mut NetlistCell, wiring: &Wiring, enables: &mut Vec<Bit>) -> Option<()> {
    let mut factors = Vec::new();
    for side in ["A", "B"] {
        let pins = wiring.factor(cell, side)?;
        factors.push((side, number(enables, &pins[0].1.enable)?, pins));
    }
    for (side, enable, pins) in factors {
        cell.set(&format!("REG_INPUT{side}_CLK"), "CLK0");
        cell.set(&format!("REG_INPUT{side}_CE"), enable);
        cell.connect("CLK0", &pins[0].1.clock);
        cell.connect(enable, &pins[0].1.enable);
        for (name, register) in pins {
            cell.connect(&name, &register.data);
        }
    }
    Some(())
}

/// The registers behind a memory's ports; a wide memory has one port for reading, with the pins of both.
fn take_memory_words(cell: &mut NetlistCell, wiring: &Wiring, gone: &mut HashSet<String>) {
    let width = |name| i64::from_str_radix(cell.parameters.get(name)?, 2).ok();
    let widths = [width("DATA_WIDTH_A"), width("DATA_WIDTH_B")];
    let together = if widths.contains(&Some(PAIRED)) { 2 } else { 1 };
    for sides in ["A", "B"].chunks(together) {
        let of_side = |side| (0..FACTOR).map(move |bit| format!("DO{side}{bit}"));
        if let Some(pins) = wiring.behind(cell, sides.iter().flat_map(of_side)) {
            take_words(cell, &pins, gone);
            for side in sides {
                cell.set(&format!("REGMODE_{side}"), "OUTREG");
                cell.connect(&format!("OCE{side}"), &pins[0].1.enable);
            }
        }
    }
}

/// For each net that a flip-flop drives, the first of those that are written alike.
fn written_alike<'a>(cells: impl Iterator<Item = &'a NetlistCell>) -> HashMap<u64, u64> {
    let mut first = HashMap::new();
    let mut alike = HashMap::new();
    for cell in cells {
        if let Some(output) = cell.net("Q") {
            let pins = ["CLK", "CE", "LSR", "DI"].map(|name| cell.pin(name));
            let key = (pins, &cell.parameters);
            alike.insert(output, *first.entry(key).or_insert(output));
        }
    }
    alike
}

/// The flip-flop as one that may move, unless it has a reset, an inverted clock or enable, or begins with 1.
fn register(name: &str, cell: &NetlistCell, alike: &HashMap<u64, u64>) -> Option<Register> {
    let setting = |name, usual| cell.parameters.get(name).map_or(usual, |text| text.trim());
    let is_plain = setting("CLKMUX", "CLK") == "CLK"
        && setting("REGSET", "RESET") == "RESET"
        && cell.pin("LSR").is_none_or(|reset| reset.is("0"));
    if !is_plain {
        return None;
    }
    let enable = match setting("CEMUX", "1") {
        "1" => Bit::Constant("1".to_owned()),
        "CE" => match cell.pin("CE")? {
            Bit::Net(net) => Bit::Net(alike.get(net).copied().unwrap_or(*net)),
            constant => constant.clone(),
        },
        _ => return None,
    };
    Some(Register {
        cell: name.to_owned(),
        data: cell.pin("DI")?.clone(),
        output: cell.net("Q")?,
        clock: cell.pin("CLK")?.clone(),
        enable,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools;
    use serde_json::{from_value, json};
    use std::fs;
    use std::process::Command;

    /// A flip-flop from one net to another, with an enable or without.
    fn flip_flop(data: u64, output: u64, enable: Option<u64>) -> NetlistCell {
        let cell = json!({
            "type": REGISTER,
            "parameters": { "CEMUX": if enable.is_some() { "CE" } else { "1 " }, "CLKMUX": "CLK", "LSRMUX": "LSR", "REGSET": "RESET" },
            "port_directions": { "CLK": "input", "DI": "input", "LSR": "input", "Q": "output" },
            "connections": { "CLK": [2], "DI": [data], "LSR": ["0"], "Q": [output] },
        });
        let mut cell: NetlistCell = from_value(cell).unwrap();
        if let Some(net) = enable {
            cell.connect("CE", &Bit::Net(net));
        }
        cell
    }

    /// One bit times one bit between three registers: 10, 20 -> 11, 21 -> 30 -> 31.
    fn circuit(enables: [Option<u64>; 3]) -> Netlist {
        let [a, b, product] = enables;
        let netlist = json!({ "modules": { "top": {
            "ports": { "in": { "direction": "input", "bits": [10, 20, 40, 41] }, "out": { "direction": "output", "bits": [31] } },
            "cells": {
                "a": flip_flop(10, 11, a),
                "b": flip_flop(20, 21, b),
                "multiplier": {
                    "type": MULTIPLIER,
                    "parameters": {},
                    "port_directions": { "A0": "input", "A1": "input", "B0": "input", "P0": "output", "P1": "output" },
                    "connections": { "A0": [11], "A1": ["0"], "B0": [21], "P0": [30], "P1": [50] },
                },
                "product": flip_flop(30, 31, product),
            },
        }}});
        from_value(netlist).unwrap()
    }

    /// Multipliers with a register behind their product, those with registers before their factors, memories with one
    /// behind their words, and the flip-flops that there are no more.
    fn moved(netlist: &mut Netlist, top: &str) -> [u64; 4] {
        let flip_flops = move_in(netlist, top).unwrap();
        let [products, factors, words] = [
            ("REG_OUTPUT_CLK", "CLK0"),
            ("REG_INPUTA_CLK", "CLK0"),
            ("REGMODE_A", "OUTREG"),
        ]
        .map(|(parameter, value)| {
            let cells = netlist.modules[top].cells.values();
            let set = |cell: &&NetlistCell| {
                cell.parameters
                    .get(parameter)
                    .is_some_and(|own| own == value)
            };
            cells.filter(set).count() as u64
        });
        [products, factors, words, flip_flops]
    }

    #[test]
    fn registers_around_a_multiplier_move_in() {
        let mut netlist = circuit([Some(40), Some(41), None]);
        assert_eq!(moved(&mut netlist, "top"), [1, 1, 0, 3]);
        let cell = &netlist.modules["top"].cells["multiplier"];
        let connected = ["A0", "B0", "P0", "CE0", "CE1", "CE2"].map(|name| cell.pin(name));
        assert_eq!(json!(connected), json!([10, 20, 31, "1", 40, 41]));
        let parameters = &cell.parameters;
        assert_eq!(parameters["REG_INPUTA_CE"], "CE1");
        assert_eq!(parameters["REG_INPUTB_CE"], "CE2");
        assert_eq!(parameters["REG_OUTPUT_CLK"], "CLK0");
    }

    #[test]
    fn what_others_read_stays_beside_the_multiplier() {
        let mut netlist = circuit([None; 3]);
        let ports = &mut netlist.modules.get_mut("top").unwrap().ports;
        ports.get_mut("out").unwrap().bits = [31, 30, 21].map(Bit::Net).to_vec();
        // The product has another reader; factor b has one, too, and is in both places.
        assert_eq!(moved(&mut netlist, "top"), [0, 1, 0, 1]);
        let cells = &netlist.modules["top"].cells;
        assert!(cells.get("b").is_some() && cells.get("a").is_none());
    }

    #[test]
    fn a_register_with_a_reset_stays() {
        let mut netlist = circuit([None; 3]);
        for name in ["a", "product"] {
            let cells = &mut netlist.modules.get_mut("top").unwrap().cells;
            cells.get_mut(name).unwrap().connect("LSR", &Bit::Net(40));
        }
        assert_eq!(moved(&mut netlist, "top"), [0, 0, 0, 0]);
    }

    #[test]
    fn enables_that_are_written_alike_are_one() {
        let mut netlist = circuit([Some(60), Some(61), Some(62)]);
        let cells = &mut netlist.modules.get_mut("top").unwrap().cells;
        for (name, output) in [("x", 60), ("y", 61), ("z", 62)] {
            cells.insert(name.to_owned(), flip_flop(40, output, None));
        }
        // Two of the enables are nobody's after that.
        assert_eq!(moved(&mut netlist, "top"), [1, 1, 0, 5]);
        let cell = &netlist.modules["top"].cells["multiplier"];
        assert_eq!(cell.pin("CE1"), None);
        assert_eq!(cell.parameters["REG_INPUTB_CE"], "CE0");
    }

    /// Both netlists of a circuit, simulated gate by gate with Yosys' models of the ECP5's cells and our own of its
    /// multiplier and block RAM.
    #[test]
    #[cfg_attr(not(has_rtl), ignore = "needs Yosys and Icarus Verilog")]
    fn the_circuit_computes_the_same_in_the_same_cycles() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).display().to_string();
        let top = "registers_subject";
        let written = |module: &str| {
            format!(
                "rename {top} {module}; write_verilog -noattr {}",
                path(&format!("{module}.v"))
            )
        };
        tools::yosys(&format!(
            "read_verilog -sv delay.sv multiply.sv formal/ecp5_registers.sv; synth_ecp5 -abc9 -top {top} -json {}; {}",
            path("before.json"),
            written("registers_outside")
        ))
        .unwrap();
        let text = fs::read_to_string(path("before.json")).unwrap();
        let mut netlist: Netlist = serde_json::from_str(&text).unwrap();
        assert_eq!(moved(&mut netlist, top)[..3], [2, 2, 1]);
        let text = serde_json::to_string(&netlist).unwrap();
        fs::write(path("after.json"), text).unwrap();
        tools::yosys(&format!(
            "read_json {}; {}",
            path("after.json"),
            written("registers_inside")
        ))
        .unwrap();
        for name in ["registers_outside.v", "registers_inside.v"] {
            let text = fs::read_to_string(path(name)).unwrap();
            let text = text.replace(MULTIPLIER, "modelled_multiplier");
            fs::write(path(name), text.replace(MEMORY, "modelled_memory")).unwrap();
        }
        // Yosys finds its own files beside its program.
        let programs = std::env::var_os("PATH").unwrap();
        let cells = std::env::split_paths(&programs)
            .map(|folder| folder.join("../share/yosys/ecp5"))
            .find(|folder| folder.join("cells_sim.v").exists())
            .expect("Yosys' models of the ECP5's cells");
        let bench = tools::rtl().join("formal/ecp5_registers.sv");
        let compiled = Command::new("iverilog")
            .args(["-g2012", "-DSIMULATED", "-s", "registers_bench", "-o"])
            .args([
                path("bench"),
                path("registers_outside.v"),
                path("registers_inside.v"),
            ])
            .arg(cells.join("cells_sim.v"))
            .arg("-I")
            .arg(cells)
            .arg(bench)
            .output()
            .unwrap();
        assert!(compiled.status.success(), "{compiled:?}");
        let said = Command::new("vvp").arg(path("bench")).output().unwrap();
        let said = String::from_utf8(said.stdout).unwrap();
        assert_eq!(said.trim(), "999 cycles, 0 wrong");
    }
}
