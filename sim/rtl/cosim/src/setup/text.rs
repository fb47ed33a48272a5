//! The generated SystemVerilog package of the setup unit: the microprogram, the addresses of its constants.
//!
//! `sim/rtl/<design>/splatline_setup_pkg.sv` is this module's output; a test compares the committed files with it.

use super::assemble::{Exit, Fields, LATENCY, LOAD_AHEAD, Operand, Program, Value};
use super::program::{SetupProgram, faint_bits, low_bits};
use crate::mutation::replaced;
use crate::package::filled;
use crate::tables::function;
use anyhow::{Context, Result, ensure};
use splatline::format::Widths;
use splatline::setup::axis_bits;
use splatline_sim::machine::area::setup::is_turned;

/// The slot's type.
const TYPES: &str = include_str!("../../../setup_types.svh");

/// Numbers that stand in registers, from this address on.
const FIRST_REGISTER: u8 = 64;
/// Their names; behind those of every program the rotation's entries as they are, by which a direction is turned back.
const REGISTERS: [&str; 24] = [
    "eye_x", "eye_y", "eye_z", "flags", "near", "far", "axis_xx", "axis_xy", "axis_xz", "axis_yx",
    "axis_yy", "axis_yz", "axis_zx", "axis_zy", "axis_zz", "back_xx", "back_xy", "back_xz",
    "back_yx", "back_yy", "back_yz", "back_zx", "back_zy", "back_zz",
];

/// Registers that every program has; the rotation's begin behind them.
const OF_EVERY_PROGRAM: usize = 15;

/// Addresses and names of a program's registers.
pub fn registers_of(program: &Program) -> impl Iterator<Item = (u8, &str)> {
    let count = [OF_EVERY_PROGRAM, REGISTERS.len()][usize::from(program.directs())];
    (FIRST_REGISTER..).zip(REGISTERS).take(count)
}

/// The fields of a slot in their order, first the most significant: name and bits.
fn layout(types: &str) -> Result<Vec<(&str, u32)>> {
    let (slot, _) = types.split_once("} slot_t;").context("no slot_t")?;
    let mut fields = Vec::new();
    for (field, _) in slot.lines().filter_map(|line| line.split_once(';')) {
        let (kind, name) = field.rsplit_once(' ').context("a field without a type")?;
        let high = kind.split_once('[').map_or("0", |(_, high)| high);
        fields.push((name, 1 + high.trim_end_matches(":0]").parse::<u32>()?));
    }
    Ok(fields)
}

/// The fields of a term's slot.
fn fields(program: &Program, index: usize, term: usize) -> Fields {
    let slot = &program.operations[index].terms[term];
    let factor = |factor| match factor {
        Operand::Value(value) => Some(registers(program, value)),
        Operand::Input(item) => Some([item.into(), 0]),
        Operand::Constant | Operand::None => None,
    };
    let [a, a_turn] = factor(slot.a).unwrap_or_default();
    let [b, b_turn] = factor(slot.other).or(factor(slot.b)).unwrap_or_default();
    let [place, place_turn] = registers(program, index);
    let round = program.operations[index].time / program.round;
    let is_constant = |factor| (factor == Operand::Constant).into();
    let mut fields = slot.fields.clone();
    fields.extend([
        ("round", round as i64),
        ("a_input", matches!(slot.a, Operand::Input(_)).into()),
        ("a_constant", is_constant(slot.a)),
        ("a", a),
        ("a_turn", a_turn),
        ("b_constant", is_constant(slot.b)),
        ("b", b),
        ("b_turn", b_turn),
        ("place", place),
        ("place_turn", place_turn),
    ]);
    fields
}

/// A result's first register, and the highest number of those that splats take in turn.
fn registers(program: &Program, value: Value) -> [i64; 2] {
    let operation = &program.operations[value];
    [operation.register as i64, operation.copies as i64 - 1]
}

/// The types of a program.
fn types(program: &Program) -> Result<String> {
    if !program.directs() {
        return Ok(TYPES.to_owned());
    }
    let types = replaced(TYPES, "logic [3:0] word;", "logic [4:0] word;")?;
    replaced(&types, "DIRECTS = 1'b0;", "DIRECTS = 1'b1;")
}

/// The text of a design's package with this program.
pub fn text(name: &str, widths: &Widths, program: &SetupProgram) -> Result<String> {
    for (field, bits, range, words) in [
        ("colour", widths.colour, 0..=26, "at most 26"),
        ("mantissa", widths.mantissa, 17..=31, "from 17 to 31"),
        ("view", widths.view, 17..=31, "from 17 to 31"),
    ] {
        ensure!(
            range.contains(&bits),
            "there is no setup unit for design '{name}': {field} = {bits}: it must be {words}"
        );
    }
    let program = program.assembled(widths)?;
    let types = types(&program)?;
    let layout = layout(&types)?;
    let slot_bits = layout.iter().map(|(_, bits)| bits).sum();
    let registers = registers_of(&program).map(|(address, name)| {
        let name = name.to_uppercase();
        format!("  localparam int {name} = {address};\n")
    });
    Ok(filled(
        include_str!("../../templates/setup_package.txt"),
        &[
            ("name", &name),
            ("position", &widths.position),
            ("low", &low_bits(widths)),
            ("faint", &faint_bits(widths)),
            ("mantissa", &widths.mantissa),
            ("axis_drop", &(31 - axis_bits(widths))),
            ("turned", &u32::from(is_turned(widths.mantissa))),
            ("round", &program.round),
            ("latency", &LATENCY),
            ("load_ahead", &LOAD_AHEAD),
            ("out_round", &(program.latency() / program.round)),
            ("out_last", &(program.latency() % program.round)),
            ("first_register", &FIRST_REGISTER),
            ("registers", &registers.collect::<String>()),
            ("slot_bits", &slot_bits),
            ("microcode", &microcode(&program, &layout, slot_bits)?),
            ("types", &types),
        ],
    ))
}

/// The slot that is issued in each cycle of a round, as a function.
fn microcode(program: &Program, layout: &[(&str, u32)], slot_bits: u32) -> Result<String> {
    let mut words = Vec::new();
    for (cycle, slot) in program.slots().into_iter().enumerate() {
        let (mut slot_fields, mut names) = (Fields::new(), Vec::new());
        if let Some((index, term)) = slot {
            slot_fields = fields(program, index, term);
            names.push(program.operations[index].name.clone());
        }
        let leaves = |exit: &&Exit| exit.time % program.round == cycle;
        if let Some(exit) = program.exits.iter().find(leaves) {
            let [b, b_turn] = registers(program, exit.value);
            let word = exit.word as i64;
            slot_fields.extend([("b", b), ("b_turn", b_turn), ("out", 1), ("word", word)]);
            names.push(format!("out: {}", program.operations[exit.value].name));
        }
        if !names.is_empty() {
            let mut word = 0u128;
            for (name, bits) in layout {
                let field = slot_fields.remove(name).unwrap_or(0);
                let fits = field >> bits == 0 || field >> (bits - 1) == -1;
                ensure!(fits, "slot_t: {name} = {field} needs more than {bits} bits");
                word = word << bits | (field as u128 & ((1 << bits) - 1));
            }
            ensure!(slot_fields.is_empty(), "slot_t has no {slot_fields:?}");
            let names = names.join("; ");
            words.push((cycle, format!("{slot_bits}'h{word:x};  // {names}")));
        }
    }
    let words = words.into_iter();
    Ok(function("microcode", slot_bits, "cycle", 8, "h0", words))
}
