//! `sim/rtl/harmonics_program.sv`: the program as a circuit reads it.

use super::program::{RightFactor, Target, Term};
use super::schedule::{Schedule, schedule};
use anyhow::Result;

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

/// The file in the folder of the RTL.
pub const FILE: &str = "harmonics_program.sv";

/// The file's text.
pub fn text() -> Result<String> {
    let schedule = schedule()?;
    let [lower @ .., highest] = schedule.ends;
    let ends = lower.iter().enumerate();
    let ends = ends.map(|(degree, end)| format!("      3'd{degree}: end_place = 7'd{end};\n"));
    let (mut gaps, mut slots) = (Vec::new(), String::new());
    for (place, term) in schedule.places.iter().enumerate() {
        match term {
            Some(term) => {
                let (word, words) = (encoded(&schedule, term)?, words(term));
                slots += &format!("      7'd{place}: slot <= {SLOT}'h{word:014x};  // {words}\n");
            }
            None => gaps.push(format!("7'd{place}")),
        }
    }
    Ok(format!(
        "{HEAD}  always_comb begin
    case (degree)
{}      default: end_place = 7'd{highest};
    endcase
  end
  always_comb begin
    case (place)
      {}: gap = 1;
      default: gap = 0;
    endcase
  end
  always_ff @(posedge clk) begin
    case (place)
{slots}      default: slot <= {SLOT}'d0;
    endcase
  end
endmodule
",
        ends.collect::<String>(),
        gaps.join(", ")
    ))
}

fn encoded(schedule: &Schedule, term: &Term) -> Result<u64> {
    let right = match term.right {
        RightFactor::Register(name) => schedule.number(name)?,
        _ => 0,
    };
    let target = match term.target {
        Target::Register(name) => schedule.number(name)?,
        Target::Harmonic(index) => index,
        Target::Nothing => 0,
    };
    let fields = [
        (schedule.number(term.left)?, 6),
        (right, 6),
        (target, 6),
        (term.right.constant() as usize, 31),
        (matches!(term.right, RightFactor::Register(_)).into(), 1),
        (matches!(term.right, RightFactor::Root(..)).into(), 1),
        (
            matches!(term.right, RightFactor::Halves(_) | RightFactor::Axis).into(),
            1,
        ),
        (term.negated.into(), 1),
        (term.first.into(), 1),
        (matches!(term.target, Target::Register(_)).into(), 1),
        (matches!(term.target, Target::Harmonic(_)).into(), 1),
    ];
    let fields = fields.iter().rev();
    Ok(fields.fold(0, |word, (value, bits)| word << bits | *value as u64))
}

/// The term in words, as a comment.
fn words(term: &Term) -> String {
    let right = match term.right {
        RightFactor::Register(name) => format!("({name})"),
        RightFactor::Halves(number) if number % 2 == 0 => format!("{}", number / 2),
        RightFactor::Halves(number) => format!("{number} / 2"),
        RightFactor::Root(above, below) => format!("root({above} / {below} pi)"),
        RightFactor::Axis => "direction".to_owned(),
    };
    let sign = match (term.first, term.negated) {
        (true, false) => "",
        (true, true) => "-",
        (false, false) => "+ ",
        (false, true) => "- ",
    };
    match term.target {
        Target::Register(name) if term.right == RightFactor::Axis => format!("{name} = {right}"),
        Target::Register(name) => format!("{sign}({}) {right} = {name}", term.left),
        Target::Harmonic(index) => format!("{sign}({}) {right} = Y_{index}", term.left),
        Target::Nothing => format!("{sign}({}) {right}", term.left),
    }
}
