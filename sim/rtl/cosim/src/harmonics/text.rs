//! `sim/rtl/harmonics_program.sv`: the program as a circuit reads it.

use super::program::{RightFactor, Target};
use super::schedule::{LOADS, PlacedTerm, Schedule, schedule};
use crate::tools::rtl;
use anyhow::Result;
use std::fmt::Write;
use std::path::PathBuf;

/// Bits of a slot.
const SLOT: usize = 56;

const HEAD: &str = "\
// Program of the harmonics unit's basis: written by `rtl -- package` from sim/rtl/cosim/harmonics_program.txt; do not edit.
//
// A slot, from its lowest bit: left register (6), right register (6), target (6), constant (31), and a bit each: right is a register, left is clamped to 4, quotient
// by 2^16, subtracted, first of its sum, to a register, to a harmonic. `end_place` is a degree's last place; a `gap` has no term.
module harmonics_program (
    input logic clk,
    input logic [6:0] place,
    input logic [2:0] degree,
    output logic [55:0] slot,
    output logic [6:0] end_place,
    output logic gap
);
";

/// Where it is committed.
pub fn path() -> PathBuf {
    rtl().join("harmonics_program.sv")
}

/// The file's text.
pub fn text() -> Result<String> {
    let schedule = schedule()?;
    let mut text = HEAD.to_owned();
    // Writing to a String cannot fail.
    text += "  always_comb begin\n    case (degree)\n";
    let [lower @ .., highest] = schedule.ends;
    for (degree, end) in lower.iter().enumerate() {
        let _ = writeln!(text, "      3'd{degree}: end_place = 7'd{end};");
    }
    let _ = writeln!(
        text,
        "      default: end_place = 7'd{highest};\n    endcase\n  end"
    );
    let gaps = schedule.places.iter().enumerate().skip(LOADS);
    let gaps: Vec<String> = gaps
        .filter(|place| place.1.is_none())
        .map(|place| format!("7'd{}", place.0))
        .collect();
    let _ = writeln!(
        text,
        "  always_comb begin\n    case (place)\n      {}: gap = 1;\n      default: gap = 0;\n    endcase\n  end",
        gaps.join(", ")
    );
    text += "  always_ff @(posedge clk) begin\n    case (place)\n";
    for (place, slot) in schedule.places.iter().enumerate() {
        let (bits, words) = match slot {
            None if place < LOADS => {
                let target = schedule.number(schedule.registers[place])?;
                (
                    bits(&[(target, 12), (1, 51), (1, 53), (1, 54)]),
                    format!("{} = direction", schedule.registers[place]),
                )
            }
            None => continue,
            Some(placed) => (encoded(&schedule, placed)?, words(placed)),
        };
        let _ = writeln!(
            text,
            "      7'd{place}: slot <= {SLOT}'h{bits:014x};  // {words}"
        );
    }
    let _ = writeln!(
        text,
        "      default: slot <= {SLOT}'d0;\n    endcase\n  end\nendmodule"
    );
    Ok(text)
}

fn bits(fields: &[(usize, usize)]) -> u64 {
    fields
        .iter()
        .fold(0, |bits, (value, place)| bits | (*value as u64) << place)
}

fn encoded(schedule: &Schedule, placed: &PlacedTerm) -> Result<u64> {
    let term = placed.term;
    let right = match term.right {
        RightFactor::Register(name) => (schedule.number(name)?, true),
        _ => (0, false),
    };
    let target = match term.target {
        Target::Register(name) => schedule.number(name)?,
        Target::Harmonic(index) => index,
        Target::Nothing => 0,
    };
    let flags = [
        right.1,
        matches!(term.right, RightFactor::Root(..)),
        matches!(term.right, RightFactor::Halves(_)),
        term.negated,
        placed.first,
        matches!(term.target, Target::Register(_)),
        matches!(term.target, Target::Harmonic(_)),
    ];
    let flags = flags
        .iter()
        .rev()
        .fold(0, |bits, flag| bits << 1 | usize::from(*flag));
    Ok(bits(&[
        (schedule.number(term.left)?, 0),
        (right.0, 6),
        (target, 12),
        (term.right.constant() as usize, 18),
        (flags, 49),
    ]))
}

/// The term in words, as a comment.
fn words(placed: &PlacedTerm) -> String {
    let term = placed.term;
    let right = match term.right {
        RightFactor::Register(name) => format!("({name})"),
        RightFactor::Halves(number) if number % 2 == 0 => format!("{}", number / 2),
        RightFactor::Halves(number) => format!("{number} / 2"),
        RightFactor::Root(numerator, denominator) => {
            format!("root({numerator} / {denominator} pi)")
        }
    };
    let sign = match (placed.first, term.negated) {
        (true, false) => "",
        (true, true) => "-",
        (false, false) => "+ ",
        (false, true) => "- ",
    };
    let target = match term.target {
        Target::Register(name) => format!(" = {name}"),
        Target::Harmonic(index) => format!(" = Y_{index}"),
        Target::Nothing => String::new(),
    };
    format!("{sign}({}) {right}{target}", term.left)
}
