//! The mutation check: would the co-simulation notice? Each mutant is the circuit with one small mistake; each must be caught.

use crate::check::Findings;
use crate::circuit::{self, Spec};
use crate::model::Model;
use crate::suite::{Extent, Loads, PictureLine};
use crate::switch::{MistakeNumber, SwitchedCircuit, expect_no_difference};
use anyhow::{Context, Result, ensure};
use splatline::format::{Lean18, Widths};
use std::path::{Path, PathBuf};
use std::process::Command;

/// One mistake: in `file`, the text `from` (which occurs once) becomes `to`.
#[derive(Clone, Copy, Debug)]
pub struct Mutant {
    /// What went wrong, in words.
    pub name: &'static str,
    /// The unit.
    pub file: &'static str,
    /// Text of the circuit.
    pub from: &'static str,
    /// The mistake.
    pub to: &'static str,
}

impl Mutant {
    /// The unit's text with the mistake, whose place must be there once.
    pub fn applied(&self, text: &str) -> Result<String> {
        let Mutant { file, from, to, .. } = self;
        let places = text.matches(from).count();
        ensure!(
            places == 1,
            "{file}: '{from}' occurs {places} times, not once; adapt the mutant"
        );
        Ok(text.replace(from, to))
    }
}

/// A mistake, for a list of them.
pub const fn mutant(
    name: &'static str,
    file: &'static str,
    from: &'static str,
    to: &'static str,
) -> Mutant {
    Mutant {
        name,
        file,
        from,
        to,
    }
}

/// The mistakes. The truncated root changes no pixel, since the spans' slack hides it: only the row unit's own roots show it; and what no legal
/// packet asks of the alignments only their own words do ([`crate::units`]).
pub const MUTANTS: [Mutant; 44] = [
    mutant(
        "share of the transmittance truncated",
        "blend.sv",
        "assign half10 = product10[ALPHA-1];",
        "assign half10 = 1'b0;",
    ),
    mutant(
        "colour truncated",
        "blend.sv",
        "SUM+:SUM], 1'b1} + product13",
        "SUM+:SUM], 1'b0} + product13",
    ),
    mutant(
        "opacity truncated",
        "blend.sv",
        " + OPACITY'(product6[OPACITY_SHIFT-1])",
        "",
    ),
    mutant(
        "opacities below the rules' are drawn",
        "blend.sv",
        "valid8 <= valid7 && !skipped7",
        "valid8 <= valid7",
    ),
    mutant(
        "finished pixels keep taking splats",
        "blend.sv",
        "assign transmittance_write = valid10 && !transmittance10[T+1];",
        "assign transmittance_write = valid10;",
    ),
    mutant(
        "stops a unit late",
        "blend.sv",
        "{2'b11, ~rules.minimum_transmittance}",
        "{2'b11, ~rules.minimum_transmittance} + 1'b1",
    ),
    mutant(
        "pixels in flight meet",
        "lane.sv",
        "meets[i] = been_valid[i] &&",
        "meets[i] = 1'b0 && been_valid[i] &&",
    ),
    mutant(
        "pixels a cycle too near to each other",
        "lane.sv",
        "d < INTERVAL - 1 - i",
        "d < INTERVAL - 2 - i",
    ),
    mutant(
        "runs held by pixels beyond their end",
        "lane.sv",
        " && reaches[d]",
        "",
    ),
    mutant(
        "enable of the lanes ignored",
        "splat_primitive.sv",
        "may_move = lanes_enable && state == DRAW",
        "may_move = state == DRAW",
    ),
    mutant(
        "interpolation's halves the wrong way",
        "footprint_table.sv",
        "{(KEPT - 1) {1'b1}}",
        "{(KEPT - 1) {1'b0}}",
    ),
    mutant(
        "end of the table not 0",
        "footprint_table.sv",
        "index > (1 << TABLE)",
        "1'b0",
    ),
    mutant(
        "carry dropped between halves of the radial index",
        "lane.sv",
        "at.radial <= at.radial + at.first;",
        "at.radial <= {at.radial[31:16] + at.first[31:16], at.radial[15:0] + at.first[15:0]};",
    ),
    mutant(
        "negative radial indices not clamped",
        "lane.sv",
        "at.radial[31] ? 32'd0 : at.radial",
        "at.radial",
    ),
    mutant(
        "last row off by one",
        "row_counter.sv",
        "last <= left == 16'd2",
        "last <= left == 16'd3",
    ),
    mutant(
        "first row off by one",
        "visible_box.sv",
        "row24 <= row23;",
        "row24 <= row23 + 16'd1;",
    ),
    mutant(
        "last column off by one",
        "row_generator.sv",
        "high15[63:32]}) + 33'sd1",
        "high15[63:32]})",
    ),
    mutant(
        "rows that end before they begin",
        "row_window.sv",
        "order19 && fits19",
        "fits19",
    ),
    mutant(
        "rows that end left of the window",
        "row_window.sv",
        "order19 && fits19",
        "order19",
    ),
    mutant(
        "root not interpolated",
        "row_generator.sv",
        "step8 + 33'h8000",
        "33'h8000",
    ),
    mutant(
        "root truncated",
        "row_generator.sv",
        "step8 + 33'h8000",
        "step8",
    ),
    mutant(
        "half-width not cut",
        "row_generator.sv",
        "half13[62] ? 64'sh3fff_ffff_ffff_ffff : half13",
        "half13",
    ),
    mutant(
        "jump over hidden rows one difference long",
        "splat_setup.sv",
        "mean20 <= double19 + jump_unit19",
        "mean20 <= double19 + unit19 + jump_unit19",
    ),
    mutant(
        "head of a run off by one",
        "row_generator.sv",
        "head_second27 - {1'b0, second27}",
        "head_second27",
    ),
    mutant(
        "seed's product truncated",
        "row_generator.sv",
        "slant24 <= along_rounded23[2*M:M]",
        "slant24 <= along23[2*M:M]",
    ),
    mutant(
        "slack of the spans forgotten",
        "splat_setup.sv",
        "56'd1 << 42",
        "56'd0",
    ),
    mutant(
        "no saturation",
        "align.sv",
        "if (overflow3) result",
        "if (1'b0) result",
    ),
    mutant(
        "shifts of 64 and more wrap",
        "align.sv",
        "shift1 > 16'sd64 ? 4'd15 : ",
        "",
    ),
    mutant(
        "alignment truncated",
        "align.sv",
        " + $signed({63'd0, moved3[0]})",
        "",
    ),
    mutant(
        "lowest bits of an alignment off by one",
        "align.sv",
        "shift[2:0] - 3'd1",
        "shift[2:0]",
    ),
    mutant(
        "last step of a normalisation's shift forgotten",
        "normalise.sv",
        "odd2 ? even2[M+2:1] : even2[M+1:0]",
        "even2[M+1:0]",
    ),
    mutant(
        "leading one of four taken for another",
        "splatline_math.sv",
        "bits[2] | (bits[0] & ~bits[1])",
        "bits[2] | bits[0]",
    ),
    mutant(
        "seed's distance shifted by fours alone",
        "row_generator.sv",
        "(M + 2)'(fours20 >> rest20)",
        "(M + 2)'(fours20)",
    ),
    mutant(
        "first half of a half-width's shift forgotten",
        "row_generator.sv",
        "squared3[63:32] == 0 ? squared3 << 32 : squared3",
        "squared3",
    ),
    mutant(
        "carry of a normalisation lost",
        "normalise.sv",
        "{whole2[M] | whole2[M-1], whole2[M-2:0]}",
        "whole2[M-1:0]",
    ),
    mutant(
        "halves of negative mantissas the wrong way",
        "normalise.sv",
        "moved2[0] != negative2",
        "moved2[0] || negative2",
    ),
    mutant(
        "what an opacity of 1 takes forgotten",
        "multiply.sv",
        "right[RIGHT-1] ? left",
        "1'b0 ? left",
    ),
    mutant(
        "turns of setup exchanged",
        "turn.sv",
        "(phase[0] ? in[3*BITS+:BITS] : in[2*BITS+:BITS])",
        "(phase[0] ? in[2*BITS+:BITS] : in[3*BITS+:BITS])",
    ),
    mutant(
        "packets taken out of turn",
        "splat_setup.sv",
        "INTERVAL == 1 || phase == 2'd3",
        "1'b1",
    ),
    mutant(
        "read-out clears nothing",
        "splat_primitive.sv",
        "(scan_valid && scan_moves && mine_in_scan)",
        "1'b0",
    ),
    mutant(
        "one buffer for both",
        "splat_primitive.sv",
        "side <= !side;",
        "side <= side;",
    ),
    mutant(
        "finish does not wait for the read-out",
        "splat_primitive.sv",
        "&& !packet_valid && !reading",
        "&& !packet_valid",
    ),
    mutant(
        "queue of splats does not rest",
        "fifo.sv",
        "(out_ready && RESTS == 0)",
        "out_ready",
    ),
    mutant(
        "rows issued without a place",
        "fifo.sv",
        "free <= leaves || !(claimed == PLACES[INDEX:0] || (claim && claimed == (INDEX + 1)'(PLACES - 1)))",
        "free <= 1'b1",
    ),
];

/// The circuit that is mutated.
const DESIGN: &str = "lean18";
const LANES: usize = 4;
const WIDTHS: Widths = Lean18::WIDTHS;

/// The mistakes' judge: one circuit with all of them that have a choice, and workloads.
pub struct MutantJudge {
    loads: Vec<Loads>,
    circuit: SwitchedCircuit,
}

impl MutantJudge {
    /// Builds the circuit, and sets the quick suite's workloads up for all rules; without a mistake they must agree.
    pub fn new() -> Result<MutantJudge> {
        let judge = MutantJudge {
            loads: Loads::all(DESIGN, Extent::Quick)?,
            circuit: SwitchedCircuit::new("files.txt", &MUTANTS, build)?,
        };
        expect_no_difference(judge.drawn(judge.circuit.library(), 0)?)?;
        Ok(judge)
    }

    /// What the suite says of a mutant: its first difference, or nothing if it survives.
    pub fn verdict(&self, mutant: &Mutant) -> Result<Option<String>> {
        self.circuit
            .judged(mutant, |library, number| self.drawn(library, number))
    }

    fn drawn(&self, library: &Path, number: MistakeNumber) -> Result<Option<String>> {
        for loads in &self.loads {
            let model = Model::with_mistake(library, circuit::NAME, 1, number)?;
            let mut bench = loads.bench_around(model);
            let mut lines = loads.check(&mut bench, LANES);
            if let Some(line) = lines.find(|line| !line.findings.agree()) {
                let Findings {
                    first_difference, ..
                } = line.findings;
                return Ok(Some(first_difference.unwrap_or_default()));
            }
            // What goes wrong between tiles alone shows where one is drawn while another is read out.
            let model = Model::with_mistake(library, circuit::NAME, 1, number)?;
            let pictures = loads.pictures(&mut loads.bench_around(model), LANES)?;
            let worst = pictures.iter().find(|line| !line.cycles.agree());
            if let Some(line) = worst {
                let PictureLine {
                    workload, cycles, ..
                } = line;
                return Ok(Some(format!("picture of {workload}: {cycles:?}")));
            }
        }
        Ok(None)
    }
}

/// The circuit with one mistake, or with choices of these.
fn build(folder: &Path, mistake: Option<&Mutant>, choices: &[Mutant]) -> Result<PathBuf> {
    let spec = Spec {
        mistake,
        choices,
        effort: "-O1",
        ..Spec::new(DESIGN, &WIDTHS, LANES)
    };
    spec.library(folder)
}

/// Standard output of a command that succeeded.
pub fn run(command: &mut Command) -> Result<String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command
        .output()
        .with_context(|| format!("cannot run {name}: is it installed?"))?;
    ensure!(
        output.status.success(),
        "{name} failed:\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
