//! The generated SystemVerilog package of the setup unit: the microprogram, the addresses of its constants.
//!
//! `sim/rtl/<design>/splatline_setup_pkg.sv` is this module's output; a test compares the committed files with it.

use super::assemble::{Operand, Pick, Program, Table, Term, Unit, Value, constant};
use super::program::{SetupProgram, faint_bits, low_bits};
use super::schedule::{LATENCY, LOAD_AHEAD};
use crate::tables::function;
use anyhow::{Result, ensure};
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

/// The fields of a term's slot in the order of `setup_types.svh`, first the most significant: name, bits, value. With a direction there are more words
/// than 16.
fn fields(program: &Program, index: usize, term: usize) -> Result<Vec<(&'static str, u32, i64)>> {
    let operation = &program.operations[index];
    let slot = &operation.terms[term];
    let factor = |factor| match factor {
        Operand::Value(value) => Some(registers(program, value)),
        Operand::Input(item) => Some([item.into(), 0]),
        Operand::Constant(_) | Operand::None => None,
    };
    let [a, a_turn] = factor(slot.a).unwrap_or_default();
    let [b, b_turn] = factor(slot.other).or(factor(slot.b)).unwrap_or_default();
    let [place, place_turn] = registers(program, index);
    let round = program.places[index].time / program.round;
    let is_constant = |factor| matches!(factor, Operand::Constant(_)).into();
    let (base, step) = match operation.unit {
        Unit::Below(bits) => (0, 2 * PLAIN - bits),
        Unit::First(step) if operation.terms[0].plain => (1, step + PLAIN),
        Unit::First(step) => (1, step),
        Unit::At(exponent) => (2, exponent),
    };
    let addend = operation.addend.filter(|_| term == 0);
    let next = operation.terms.get(term + 1);
    Ok(vec![
        ("round", 4, round as i64),
        ("a_input", 1, matches!(slot.a, Operand::Input(_)).into()),
        ("a_constant", 1, is_constant(slot.a)),
        ("a", 8, a),
        ("a_turn", 4, a_turn),
        ("b_constant", 1, is_constant(slot.b)),
        ("b", 8, b),
        ("b_turn", 4, b_turn),
        (
            "constant",
            6,
            constant(operation, term)?.unwrap_or(0) as i64,
        ),
        ("lookup", 2, slot.table as i64),
        ("entry", 1, slot.entry.into()),
        ("power", 1, slot.power.into()),
        ("plain", 1, slot.plain.into()),
        ("offset", 8, offset(slot)),
        ("pick", 2, slot.pick as i64),
        ("by_flag", 1, slot.flag.is_some().into()),
        ("flag", 2, slot.flag.unwrap_or(0).into()),
        ("negated", 1, slot.before.into()),
        ("subtracted", 1, slot.after.into()),
        ("down", 1, slot.floor.into()),
        ("first", 1, (term == 0 && !operation.follows).into()),
        ("again", 1, slot.again.into()),
        ("last", 1, next.is_none_or(|next| next.again).into()),
        ("base", 2, base),
        ("step", 7, step.into()),
        ("addend", 1, addend.is_some().into()),
        ("start", 6, addend.unwrap_or(0) as i64),
        ("normal", 1, operation.bits.is_some().into()),
        ("drop", 5, i64::from(31 - operation.bits.unwrap_or(31))),
        ("spare", 6, 32 - i64::from(operation.below)),
        ("extended", 1, operation.long.into()),
        ("write", 1, next.is_none().into()),
        ("place", 8, place),
        ("place_turn", 4, place_turn),
        ("out", 1, 0),
        ("word", 4 + u32::from(program.directs()), 0),
    ])
}

/// A result's first register, and the highest number of those that splats take in turn.
fn registers(program: &Program, value: Value) -> [i64; 2] {
    let place = program.places[value];
    [place.register as i64, place.copies as i64 - 1]
}

/// Bits by which a plain term stands higher in the core than its exponent says: those of a mantissa.
const PLAIN: i32 = 31;

/// The types of a program.
fn types(program: &Program) -> Result<String> {
    let mut text = TYPES.to_owned();
    if program.directs() {
        for (without, with) in [
            ("logic [3:0] word;", "logic [4:0] word;"),
            ("DIRECTS = 1'b0;", "DIRECTS = 1'b1;"),
        ] {
            ensure!(text.contains(without), "setup_types.svh has no '{without}'");
            text = text.replace(without, with);
        }
    }
    Ok(text)
}

/// The text of a design's package with this program.
pub fn text(name: &str, widths: &Widths, program: &SetupProgram) -> Result<String> {
    ensure!(
        widths.colour <= 26,
        "there is no setup unit for design '{name}': colour = {}: it must be at most 26",
        widths.colour
    );
    for (field, bits) in [("mantissa", widths.mantissa), ("view", widths.view)] {
        ensure!(
            (17..=31).contains(&bits),
            "there is no setup unit for design '{name}': {field} = {bits}: it must be from 17 to 31"
        );
    }
    let program = program.assembled(widths)?;
    let slot_bits = fields(&program, 0, 0)?.iter().map(|field| field.1).sum();
    let head = format!(
        "// Design {name}: the setup unit's program. Generated by `cargo run -p splatline-rtl --example rtl -- package`; do not edit.\n\
         package splatline_setup_pkg;\n\n"
    );
    let parameters = parameters(widths, &program, slot_bits);
    let parts = [
        head,
        parameters,
        types(&program)?,
        microcode(&program, slot_bits)?,
    ];
    Ok(parts.concat() + "endpackage\n")
}

/// The parameters of a program whose slots have so many bits.
fn parameters(widths: &Widths, program: &Program, slot_bits: u32) -> String {
    let (position, mantissa) = (widths.position, widths.mantissa);
    let (low, faint, round) = (low_bits(widths), faint_bits(widths), program.round);
    let axis_drop = 31 - axis_bits(widths);
    let turned = u32::from(is_turned(mantissa));
    let (out_round, out_last) = (program.exit_round, program.last_exit());
    let registers = registers_of(program).map(|(address, name)| {
        let name = name.to_uppercase();
        format!("  localparam int {name} = {address};\n")
    });
    format!(
        "  localparam int POSITION = {position};  // magnitude bits of a difference to the eye
  localparam int LOW = {low};  // those of its low part
  localparam int FAINT = {faint};  // those of a position that are below its centre's rounding; 0: it comes in two words
  localparam int MANTISSA = {mantissa};  // magnitude bits of a mantissa
  localparam int AXIS_DROP = {axis_drop};  // bits of an axis' components that are 0
  localparam int TURNED = {turned};  // do axes come turned?
  localparam int ROUND = {round};  // cycles of a round
  localparam int LATENCY = {LATENCY};  // cycles from a sum's last slot to its use
  localparam int LOAD_AHEAD = {LOAD_AHEAD};  // cycles before a round's end from which its records are full
  localparam int OUT_ROUND = {out_round};  // round in which a splat's results come
  localparam int OUT_LAST = {out_last};  // the last slot with one of them
  localparam int FIRST_REGISTER = {FIRST_REGISTER};  // address of the first number outside the cores
{}  localparam int SLOT_BITS = {slot_bits};\n\n",
        registers.collect::<String>()
    )
}

/// The slot that is issued in each cycle of a round, as a function.
fn microcode(program: &Program, slot_bits: u32) -> Result<String> {
    let mut words = Vec::new();
    for (cycle, slot) in program.slots().into_iter().enumerate() {
        let (index, term) = slot.unwrap_or_default();
        let mut fields = fields(program, index, term)?;
        let mut names = Vec::new();
        match slot {
            Some(_) => names.push(program.operations[index].name.clone()),
            None => fields.iter_mut().for_each(|field| field.2 = 0),
        }
        if let Some(exit) = program.exits.iter().find(|exit| exit.cycle == cycle) {
            let [register, turn] = registers(program, exit.value);
            for (name, _, field) in &mut fields {
                match *name {
                    "b" => *field = register,
                    "b_turn" => *field = turn,
                    "out" => *field = 1,
                    "word" => *field = exit.word as i64,
                    _ => {}
                }
            }
            names.push(format!("out: {}", program.operations[exit.value].name));
        }
        if !names.is_empty() {
            let word = fields.iter().fold(0u128, |word, (_, bits, field)| {
                word << bits | (*field as u128 & ((1 << bits) - 1))
            });
            let names = names.join("; ");
            words.push((cycle, format!("{slot_bits}'h{word:x};  // {names}")));
        }
    }
    let head = "  // The slot that is issued in each cycle of a round.\n".to_owned();
    let words = words.into_iter();
    Ok(head + &function("microcode", slot_bits, "cycle", 8, "h0", words))
}

/// What the core adds to the factors' exponents: tables have those of their own. A root's rest stands 8 bits higher in the core, 7 where its exponent is even;
/// a first factor whose exponent does not count gives `-PLAIN`.
fn offset(slot: &Term) -> i64 {
    let table = match (slot.table, slot.entry) {
        (Table::None, _) => 0,
        (Table::Reciprocal, true) => -59,
        (Table::Reciprocal, false) => -81,
        (Table::Root, true) => -8,
        (Table::Root, false) => -32,
        (Table::Logarithm, true) => PLAIN - 32,
        (Table::Logarithm, false) => PLAIN - 46,
    };
    let picks = slot.pick != Pick::None;
    let without = i32::from(slot.power || picks) - i32::from(slot.plain);
    (table + i32::from(slot.doubled) + without * PLAIN).into()
}
