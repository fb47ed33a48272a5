//! Harmonics units with one mistake each: does the comparison notice it?

use super::bench::{HarmonicsLoad, PAUSES, run};
use super::circuit::{HarmonicsSpec, library};
use super::loads::{captured, synthetic};
use super::model::HarmonicsModel;
use crate::mutants::{Mutant, mutant};
use crate::switch::{MistakeNumber, SwitchedCircuit, expect_no_difference};
use anyhow::Result;
use std::path::Path;

const UNIT: &str = "harmonics_unit.sv";
const TERM: &str = "harmonics_term.sv";
const PROGRAM: &str = "harmonics_program.sv";

/// The mistakes.
#[rustfmt::skip]
pub const MISTAKES: [Mutant; 41] = [
    mutant("terms truncated", TERM, "carry9 <= negative8 ? !(half8 && rest8) : half8;", "carry9 <= negative8;"),
    mutant("halves of negative terms away from 0", TERM, "!(half8 && rest8)", "!half8"),
    mutant("a quarter not seen behind a half", TERM, "|product8[29:15]", "|product8[28:15]"),
    mutant("a colour's terms rounded by the bit below", TERM, "wide8 ? product8[15]", "wide8 ? product8[14]"),
    mutant("sign of a register forgotten", TERM, "left5[LEFT-1] ^ right5[RIGHT-1]", "right5[RIGHT-1]"),
    mutant("subtraction forgotten", TERM, " ^ negated5;", ";"),
    mutant("magnitudes by the ones' complement", TERM, "-left5[LEFT-2:0]", "~left5[LEFT-2:0]"),
    mutant("polynomials not clamped", UNIT, "clamped4 && left4[35:32] !=", "1'b0 && left4[35:32] !="),
    mutant("directions not clamped", UNIT, "loads[4] && right4[31]", "1'b0 && right4[31]"),
    mutant("directions below -1 taken for 1", UNIT, "{right4[34:31], 1'b1, 30'd0}", "{4'd0, 1'b1, 30'd0}"),
    mutant("products of 64 bits do not wrap", UNIT, "wide10 ? sum10[35:34] : {2{sum10[33]}}", "sum10[35:34]"),
    mutant("multiples wrap", UNIT, "wide10 ? sum10[35:34] : {2{sum10[33]}}", "{2{sum10[33]}}"),
    mutant("a sum runs on into the next", UNIT, "basis[9] && !firsts[9]", "basis[9]"),
    mutant("colours' terms mixed with a sum's", UNIT, "if (sums[9]) {colour12", "if (1'b1) {colour12"),
    mutant("a channel's sum two terms back", UNIT, "| (colour12 &", "| (colour11 &"),
    mutant("a colour runs on into the next splat's", UNIT, "sums[9] && !bases[9]", "sums[9]"),
    mutant("base forgotten", UNIT, " | {4'd0, sums[3] && bases[3], 28'd0}", ""),
    mutant("sign of a harmonic lost", UNIT, "({y3[31], y3} &", "({1'b0, y3} &"),
    mutant("sign of a coefficient lost", UNIT, "{{3{outside3[31]}}, outside3}", "{3'd0, outside3}"),
    mutant("colours truncated", UNIT, "colour10[12] | lost10", "colour10[12]"),
    mutant("the last bit that is cut off not seen", UNIT, "colour10[11:0] != 0", "colour10[11:1] != 0"),
    mutant("colours below 0 not clamped", UNIT, "colour10[51] ? 32'd0 :", ""),
    mutant("colours from 16 on not clamped", UNIT, "high10 ? 32'hffff_ffff :", ""),
    mutant("colours from 16 to 32 not clamped", UNIT, "colour10[50:44] != 0", "colour10[50:45] != 0"),
    mutant("a coefficient too few", UNIT, "3'd2: coefficients = 5'd8;", "3'd2: coefficients = 5'd7;"),
    mutant("y and z exchanged", UNIT, "place[1] ? direction[95:64] : place[0] ? direction[63:32]", "place[1] ? direction[63:32] : place[0] ? direction[95:64]"),
    mutant("degree of the splat before", UNIT, "if (place == 0) splat_degree", "if (place == 2) splat_degree"),
    mutant("one bank for all harmonics", UNIT, "{bank10, target10[4:0]}", "{1'b0, target10[4:0]}"),
    mutant("harmonics overwritten that are still read", UNIT, "!loading || (splat_valid && !full[bank])", "!loading || splat_valid"),
    mutant("both use the multiplier", UNIT, " && !(MULTIPLIERS == 1 && basis_issues);", ";"),
    mutant("words taken a channel early", UNIT, "colour_may && channel == 2'd2", "colour_may && channel == 2'd1"),
    mutant("a colour overwritten before it is taken", UNIT, "&& channel == 0 && pending)", "&& 1'b0)"),
    mutant("a colour that waits is not forgotten by a reset", UNIT, "if (rst) colour_valid <= 0;", ""),
    mutant("banks stay full in a reset", UNIT, "      full <= 0;\n", ""),
    mutant("a splat goes on where a reset found it", UNIT, "{place, bank, index,", "{bank, index,"),
    mutant("a word's index survives a reset", UNIT, "bank, index, channel,", "bank, channel,"),
    mutant("a colour on its way survives a reset", UNIT, "if (rst) {basis, sums} <= 0;", ""),
    mutant("a degree ends before its last harmonic", PROGRAM, "3'd3: end_place = 7'd55;", "3'd3: end_place = 7'd54;"),
    mutant("a constant's lowest bit", PROGRAM, "56'ha5406d8aa1001d", "56'ha5406d8aa5001d"),
    mutant("a multiple of 5 for one of 7", PROGRAM, "7'd43: slot <= 56'h58001c", "7'd43: slot <= 56'h580014"),
    mutant("a product's register for another", PROGRAM, "7'd72: slot <= 56'h620000000241dc", "7'd72: slot <= 56'h620000000241da"),
];

/// The mistakes' judge: a circuit with all of them that have a choice, and what it is given.
pub struct HarmonicsJudge {
    loads: Vec<HarmonicsLoad>,
    circuit: SwitchedCircuit,
}

impl HarmonicsJudge {
    /// Builds the circuit, in which the unit without a mistake must agree.
    pub fn new() -> Result<HarmonicsJudge> {
        let judge = HarmonicsJudge {
            loads: judges()?,
            circuit: SwitchedCircuit::new(
                "harmonics_files.txt",
                &MISTAKES,
                |folder, mistake, choices| {
                    let spec = HarmonicsSpec {
                        mistake,
                        choices,
                        ..HarmonicsSpec::new(1)
                    };
                    library(folder, &spec)
                },
            )?,
        };
        expect_no_difference(judge.compared(judge.circuit.library(), 0)?)?;
        Ok(judge)
    }

    /// What the comparison says of a mistake: its first difference, or nothing if it survives.
    pub fn verdict(&self, mistake: &Mutant) -> Result<Option<String>> {
        self.circuit
            .judged(mistake, |library, number| self.compared(library, number))
    }

    fn compared(&self, library: &Path, number: MistakeNumber) -> Result<Option<String>> {
        for pauses in &PAUSES {
            for load in &self.loads {
                let mut model = HarmonicsModel::with_mistake(library, 1, number)?;
                let found = run(&mut model, load, pauses, 1).map_or_else(
                    |error| Some(format!("{error:#}")),
                    |findings| Some(format!("{}: {}", load.name, findings.first_difference?)),
                );
                if found.is_some() {
                    return Ok(found);
                }
            }
        }
        Ok(None)
    }
}

/// What the mistakes are judged by, and the short run of the tests.
pub fn judges() -> Result<Vec<HarmonicsLoad>> {
    let mut loads = synthetic(240, 1);
    loads.extend(captured(100)?);
    Ok(loads)
}
