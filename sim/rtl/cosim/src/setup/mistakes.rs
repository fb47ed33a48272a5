//! Setup units with one mistake each, in every stage: does the comparison with the kernel notice it?

use super::bench::{LONG, SetupLoad, run};
use super::circuit::{SetupSpec, library};
use super::exact::exact;
use super::loads::{captured, synthetic};
use super::model::SetupModel;
use super::program::{SetupProgram, program, units};
use super::vectors::difference;
use crate::mutants::{Mutant, mutant};
use crate::switch::{MistakeNumber, SwitchedCircuit, expect_no_difference};
use anyhow::{Context, Result};
use splatline::format::{Lean18, RuntimeWidths, Widths};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const CORE: &str = "setup_core.sv";
const EYE: &str = "setup_difference.sv";
const PACK: &str = "setup_pack.sv";
const UNIT: &str = "setup_unit.sv";
const TABLES: &str = "splatline_tables.sv";

/// The mistakes.
#[rustfmt::skip]
pub const MISTAKES: [Mutant; 51] = [
    mutant("mantissas truncated", CORE, "34'sd1 <<< slot21.drop", "34'sd0 <<< slot21.drop"),
    mutant("mantissas' last bits kept", CORE, "-(34'sd2 <<< slot21.drop)", "-34'sd2"),
    mutant("carry of a mantissa dropped", CORE, "assign carried22 = rounded22[32]", "assign carried22 = 1'b0 && rounded22[32]"),
    mutant("negative powers of two not carried", CORE, "rounded22[33] && !rounded22[31] && rounded22[32:1]", "1'b0 && rounded22[32:1]"),
    mutant("0 keeps its exponent", CORE, "if (nothing22)", "if (1'b0)"),
    mutant("terms rounded down", CORE, "moved16[0] && !slot16.down", "1'b0 && !slot16.down"),
    mutant("alignment does not saturate", CORE, "if (overflow16)", "if (1'b0)"),
    mutant("alignment saturates a bit late", CORE, "> 20'sd63", "> 20'sd64"),
    mutant("shifts of 64 and more wrap", CORE, "shift13 > 19'sd64 ? 7'd127", "1'b0 ? 7'd127"),
    mutant("sums wrap", CORE, "sum18[67:63] == {5{sum18[63]}}", "1'b1"),
    mutant("unit of the first term alone", CORE, "slot12.last || slot12.base != 0 ?", "1'b1 ?"),
    mutant("unit without the fourth term", CORE, "slot10.last ? unit10 : unit9", "unit10"),
    mutant("terms of 0 count for the unit", CORE, "length8 == 0 ? -18'sd98304", "1'b0 ? -18'sd98304"),
    mutant("sums go on from the last one", CORE, "slot17.first ? (slot17.addend", "1'b0 ? (slot17.addend"),
    mutant("addends left out", CORE, "(slot17.addend ?", "(1'b0 ?"),
    mutant("terms taken off are added", CORE, "slot17.subtracted ?", "1'b0 ?"),
    mutant("terms negated too late", CORE, "product_sign4) ^ negated4", "product_sign4)"),
    mutant("roots of odd powers", CORE, "assign even2 = a_exponent2[0]", "assign even2 = 1'b1"),
    mutant("a root's rest a bit short", CORE, "even2 ? a2[22:7]", "even2 ? {a2[22:8], 1'b0}"),
    mutant("a reciprocal's rest a bit short", CORE, "a2[21:0], 1'b0}", "a2[21:1], 2'b0}"),
    mutant("the other limit picked", CORE, "slot3.pick == 2'd1 ? a3[63]", "slot3.pick == 2'd1 ? !a3[63]"),
    mutant("one flag for all", CORE, "flags[slot3.flag]", "flags[1]"),
    mutant("leading bit's power one off", CORE, "a_exponent2} + 34'sd30", "a_exponent2} + 34'sd29"),
    mutant("plain terms without their sign's effect", CORE, "plain_sign4 ? -plain4 : plain4", "plain4"),
    mutant("a unit without its step", CORE, "largest9 - step9", "largest9"),
    mutant("negative factors", CORE, "right3[33] ? -right3 : right3", "right3"),
    mutant("both sides of the records one", CORE, "records[{side, slot0.a[3:1]}]", "records[{1'b0, slot0.a[3:1]}]"),
    mutant("difference a bit coarser", EYE, "top - 16'sd60", "top - 16'sd59"),
    mutant("the eye does not count for the unit", EYE, "top_z > eye_top ? top_z : eye_top", "top_z"),
    mutant("the eye's second coordinate for its third", EYE, "turn_eye_y ? eye_y : eye_z", "eye_y"),
    mutant("components of -2^31", EYE, "32'h80000001 : value", "32'h80000000 : value"),
    mutant("the last coordinate does not count", EYE, "phase == 2 || phase == 3 ? together |", "phase == 2 ? together |"),
    mutant("difference not normalised", EYE, "drop <= $signed({9'd0, together_length})", "drop <= 16'sd1 + $signed({9'd0, together_length})"),
    mutant("the near plane itself is drawn", PACK, "same = a_leading == b_leading && a == b;", "same = 1'b0;"),
    mutant("behind the eye", PACK, "(perspective && (depth1[63] || depth_nothing))", "1'b0"),
    mutant("the far plane ignored", PACK, "far2 ? 3'd2 :", ""),
    mutant("the key a bit off", PACK, "depth_normal[61:24]", "depth_normal[62:25]"),
    mutant("halves of opacities go up", PACK, "peak_fixed2[0] && peak_half2", "1'b0"),
    mutant("opacities do not saturate", PACK, "peak_even >> (splatline_pkg::PEAK + 4) != 0 ?", "1'b0 ?"),
    mutant("halves of colours go up", PACK, "(value[26-COLOUR:0] != 0 || shaded[0])", "1'b1"),
    mutant("extents without their slack", PACK, "{11'd0, extent[63:10]}", "65'd0"),
    mutant("a column too few", PACK, "64'sh80000000;\n    high_v", "64'sh7fffffff;\n    high_v"),
    mutant("a row too many", PACK, "extent_v2 + 64'sh7fffffff", "extent_v2 - 64'sh80000001"),
    mutant("boxes beyond the viewport", PACK, "value > $signed({16'd0, limit}) ? limit :", ""),
    mutant("centres a bit too far out", PACK, "beyond(u2, 7'd58)", "beyond(u2, 7'd59)"),
    mutant("degenerate ones drawn", PACK, "degenerate2 ? 3'd4 :", ""),
    mutant("reasons in another order", PACK, "far2 ? 3'd2 : range ? 3'd3 :", "range ? 3'd3 : far2 ? 3'd2 :"),
    mutant("conic's unit of two coefficients", PACK, "largest0 > conic_exponent0 ? largest0 : conic_exponent0", "largest0"),
    mutant("results overwritten under back-pressure", UNIT, "&& pending[!round[0]]", "&& 1'b0"),
    mutant("a round's records of the next", UNIT, "load_side <= !load_side;", "load_side <= load_side;"),
    mutant("an entry of the reciprocals", TABLES, "9'd77: setup_entry = {32'd", "9'd77: setup_entry = {32'd1"),
];

/// The mistakes' judge: one circuit with all of them that have a choice, and what it sets up.
pub struct SetupJudge {
    loads: Vec<SetupLoad>,
    circuit: SwitchedCircuit,
    units: PathBuf,
    /// Where `units` lies.
    _beside: TempDir,
}

impl SetupJudge {
    /// Builds the circuit, in which the unit without a mistake must agree.
    pub fn new() -> Result<SetupJudge> {
        let beside = tempfile::tempdir()?;
        let of_units = SetupSpec {
            program: units,
            ..spec(None, &MISTAKES)
        };
        let judge = SetupJudge {
            loads: judges()?,
            circuit: SwitchedCircuit::new(
                "setup_files.txt",
                &MISTAKES,
                |folder, mistake, choices| library(folder, &spec(mistake, choices)),
            )?,
            units: library(beside.path(), &of_units)?,
            _beside: beside,
        };
        expect_no_difference(judge.judged(judge.circuit.library(), 0)?)?;
        Ok(judge)
    }

    /// What the comparison says of a mistake: its first difference, or nothing if it survives. Of one that has no effect: that all arguments show none.
    pub fn verdict(&self, mistake: &Mutant) -> Result<Option<String>> {
        self.circuit.judged(mistake, |library, number| {
            if number == 0 {
                return self.compared(library, number);
            }
            let word = self.judged(library, number)?;
            if word.is_some() || !WITHOUT_EFFECT.contains(&mistake.name) {
                return Ok(word);
            }
            let word = difference(&self.units, number, &WIDTHS, 1)?;
            Ok(word.or(Some(NO_EFFECT.to_owned())))
        })
    }

    /// By packets, and then by what no packet shows.
    fn judged(&self, library: &Path, number: MistakeNumber) -> Result<Option<String>> {
        let word = self.compared(library, number)?;
        if word.is_some() {
            return Ok(word);
        }
        let word = difference(&self.units, number, &WIDTHS, UNITS_STEP)?;
        Ok(word.map(|word| format!("units: {word}")))
    }

    fn compared(&self, library: &Path, number: MistakeNumber) -> Result<Option<String>> {
        first_difference(library, number, program, &self.loads, &[0, LONG])
    }
}

/// What the comparison with the kernel says first of a circuit of [`WIDTHS`] with this program, by each load and each of these pauses.
pub(super) fn first_difference(
    library: &Path,
    number: MistakeNumber,
    program: SetupProgram,
    loads: &[SetupLoad],
    pauses: &[u64],
) -> Result<Option<String>> {
    let design = RuntimeWidths::new(WIDTHS).ok();
    let design = design.context("widths out of range")?;
    for load in loads {
        for pauses in pauses {
            let mut model = SetupModel::with_mistake(library, 1, number)?;
            let found = run(&mut model, design, program, load, *pauses).map_or_else(
                |error| Some(format!("{error:#}")),
                |findings| {
                    let first = findings.first_difference?;
                    Some(format!("{}: {first}", load.name))
                },
            );
            if found.is_some() {
                return Ok(found);
            }
        }
    }
    Ok(None)
}

/// Of so many mantissas one goes through the cores' units alone.
const UNITS_STEP: usize = 1024;

/// Mistakes that the design has no number to show, as docs/setup-unit.md argues; of the arguments that the reason leaves, all are drawn.
const WITHOUT_EFFECT: [&str; 1] = ["a reciprocal's rest a bit short"];
const NO_EFFECT: &str = "changes nothing: roots of all 262,144 arguments are the kernel's";

/// The design that is mutated.
pub(super) const WIDTHS: Widths = Lean18::WIDTHS;

fn spec<'a>(mistake: Option<&'a Mutant>, choices: &'a [Mutant]) -> SetupSpec<'a> {
    SetupSpec {
        mistake,
        choices,
        ..SetupSpec::new("lean18", &WIDTHS, 2)
    }
}

/// What the mistakes are judged by.
pub fn judges() -> Result<Vec<SetupLoad>> {
    let (captured, _) = captured(400)?;
    // The quickest to show a mistake first.
    Ok([exact(300, 1), synthetic(400, 1), captured].concat())
}
