//! Machines with one mistake each between their units: does a frame notice it? Mistakes within the units are judged by their own benches.

use super::bench::{MEMORIES, MachineFindings, draw};
use super::circuit::{MachineSpec, library};
use super::model::MachineModel;
use crate::mutants::{Mutant, mutant};
use crate::order::loads::{Seen, ordered};
use crate::switch::{MistakeNumber, SwitchedCircuit, expect_no_difference};
use anyhow::Result;
use splatline::format::{Lean18, Widths};
use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::scene::synthetic;
use std::path::Path;

const MACHINE: &str = "splat_machine.sv";
const FETCH: &str = "packet_fetch.sv";
const ARBITER: &str = "read_arbiter.sv";
const FINDER: &str = "tile_finder.sv";
const BACKGROUND: &str = "tile_background.sv";

/// The mistakes.
#[rustfmt::skip]
pub const MISTAKES: [Mutant; 24] = [
    mutant("culled splats are waited for", MACHINE, "(cull != 0 || (sorts && sort_ready))", "sorts && sort_ready"),
    mutant("culled splats have no number", MACHINE, "number <= number + 1'b1;", "number <= number + 32'(cull == 0);"),
    mutant("a packet's last word left out", MACHINE, "cull == 0 && step != 4'(PACKET);", "cull == 0 && step != 4'(PACKET - 1);"),
    mutant("boxes end a pixel late", MACHINE, "tile_of(footprint.end_column - 16'd1, COLUMN_BITS)", "tile_of(footprint.end_column, COLUMN_BITS)"),
    mutant("tiles beyond the frame's edge", FINDER, "place > 28'(limit) ? limit : place[15:0]", "place[15:0]"),
    mutant("an empty tile waits for a packet", FINDER, "(list == 0) != (EMPTY != 0)", "(EMPTY != 0) && list != 0"),
    mutant("every list begins at the first", FINDER, "assign list = end_place - begun;", "assign list = end_place;"),
    mutant("a list begins where the tile before began", FINDER, "begun <= end_place;", "if (list == 0) begun <= end_place;"),
    mutant("tiles of the picture before", FINDER, "{tile, column, row, first, row_first, begun} <= 0;", "{tile, column, row, first, begun} <= 0;"),
    mutant("rows of tiles as wide as their tiles would be", FINDER, "        first <= row_first + (32'(columns) << ROW_BITS);", ""),
    mutant("the lowest tiles as high as the others", FINDER, "({16'd0, window.end_row - window.first_row} << COLUMN_BITS)", "32'd1 << (COLUMN_BITS + ROW_BITS)"),
    mutant("both hear the end that one asked for", MACHINE, ".answered(!finder_asks)", ".answered(1'b1)"),
    mutant("a tile is read out to where the next one belongs", MACHINE, "pixels <= drawn_first;", "pixels <= found_first;"),
    mutant("background over tiles with splats", BACKGROUND, ".EMPTY(1)", ".EMPTY(0)"),
    mutant("background beyond the frame's edge", BACKGROUND, "(COLUMN_BITS + 1)'(window.end_column - window.first_column)", "(COLUMN_BITS + 1)'(1 << COLUMN_BITS)"),
    mutant("background is lost where a pixel is written", MACHINE, "background_ready = write_ready && !pixel_valid;", "background_ready = write_ready;"),
    mutant("the frame ends before its background", MACHINE, "if ((pixel_valid || background_valid) && write_ready) pixels_left", "if (pixels_left > 32'd1024 || ((pixel_valid || background_valid) && write_ready)) pixels_left"),
    mutant("red and blue exchanged", MACHINE, "{32'(colour[2*SUM+:SUM]), 32'(colour[SUM+:SUM]), 32'(colour[0+:SUM]), transmittance_word}", "{32'(colour[0+:SUM]), 32'(colour[SUM+:SUM]), 32'(colour[2*SUM+:SUM]), transmittance_word}"),
    mutant("the frame ends before its last pixel", MACHINE, "if (pixels_left == 0 && settled)", "if (settled)"),
    mutant("lists of a frame without room are drawn", MACHINE, "state <= full ? IDLE : TILE;", "state <= TILE;"),
    mutant("a list's words end with their fourth entry alone", FETCH, "(entry == 2'd3 || left == 1)", "entry == 2'd3"),
    mutant("entries of a word the wrong way", FETCH, "list[32*entry+:32]", "list[{~entry, 5'd0}+:32]"),
    mutant("packets asked for without a place", FETCH, "left != 0 && free;", "left != 0;"),
    mutant("words for whoever asks now", ARBITER, "askers[answered] : '0", "chosen : '0"),
];

/// A scene that mistakes are judged by, and its list entries.
pub struct MachineCase {
    /// The scene.
    pub seen: Seen,
    /// List entries.
    pub room: usize,
    /// Which of its tiles have none.
    pub empty: Vec<bool>,
}

/// Frames small enough for every mistake: a crowd with lists that end within words, culled splats and tiles cut by the edge; a few splats among
/// tiles without any, of which some are at the edges; a single row of pixels, whose many tiles are looked up while those without splats are
/// written; and one tile alone with more splats than wait for it, behind which no word is on its way when its pixels begin to leave.
pub fn judges() -> Result<Vec<MachineCase>> {
    let crowd = Seen {
        name: "crowd",
        scene: synthetic::random_gaussians(120, 9, 4.0),
        camera: synthetic::camera(70, 45),
    };
    let sparse = Seen {
        name: "sparse",
        scene: synthetic::random_gaussians(7, 5, 2.0),
        camera: synthetic::camera(200, 100),
    };
    let row = Seen {
        name: "row",
        scene: synthetic::random_gaussians(40, 3, 0.5),
        camera: row_of(2_000),
    };
    let tile = Seen {
        name: "tile",
        scene: synthetic::random_gaussians(300, 4, 20.0),
        camera: synthetic::camera(32, 32),
    };
    let design = DesignChoice::load("lean18")?;
    let case = |seen: Seen| {
        let lists = ordered(&seen, &design).1.lists;
        MachineCase {
            seen,
            room: lists.iter().map(Vec::len).sum(),
            empty: lists.iter().map(Vec::is_empty).collect(),
        }
    };
    Ok([crowd, sparse, row, tile].map(case).into())
}

/// A picture of one row that is as wide as a scene: the vertical focal length alone is so small that every splat meets it.
fn row_of(columns: usize) -> Camera {
    let camera = synthetic::camera(columns, columns);
    Camera {
        fy: 1.0,
        cy: 0.5,
        height: 1,
        ..camera
    }
}

/// The mistakes' judge: one machine with all of them that have a choice, and the frames.
pub struct MachineJudge {
    cases: Vec<MachineCase>,
    circuit: SwitchedCircuit,
}

impl MachineJudge {
    /// Builds the machine, which must draw the frames without a mistake.
    pub fn new() -> Result<MachineJudge> {
        let judge = MachineJudge {
            cases: judges()?,
            circuit: SwitchedCircuit::new(
                "machine_files.txt",
                &MISTAKES,
                |folder, mistake, choices| library(folder, &spec(mistake, choices)),
            )?,
        };
        expect_no_difference(judge.drawn(judge.circuit.library(), 0)?)?;
        Ok(judge)
    }

    /// What the frames say of a mistake, or nothing if it survives.
    pub fn verdict(&self, mistake: &Mutant) -> Result<Option<String>> {
        let drawn = |library: &Path, number| self.drawn(library, number);
        self.circuit.judged(mistake, drawn)
    }

    fn drawn(&self, library: &Path, number: MistakeNumber) -> Result<Option<String>> {
        let model = MachineModel::with_mistake(library, number)?;
        for case in &self.cases {
            let word = judged(&model, &spec(None, &[]), case);
            let word = word.unwrap_or_else(|error| Some(format!("{error:#}")));
            if let Some(word) = word {
                return Ok(Some(format!("{}: {word}", case.seen.name)));
            }
        }
        Ok(None)
    }
}

/// The design that is mutated.
const WIDTHS: Widths = Lean18::WIDTHS;

fn spec<'a>(mistake: Option<&'a Mutant>, choices: &'a [Mutant]) -> MachineSpec<'a> {
    MachineSpec {
        mistake,
        choices,
        ..MachineSpec::new("lean18", &WIDTHS, 2, 4)
    }
}

/// What a case's frames say, or nothing if all are as they should be.
fn judged(model: &MachineModel, spec: &MachineSpec, case: &MachineCase) -> Result<Option<String>> {
    for timing in MEMORIES {
        let found = draw(model, spec, &case.seen, timing, case.room, 2)?;
        if let Some(word) = different(&found) {
            return Ok(Some(word));
        }
    }
    judged_once(model, spec, case)
}

/// The same of a single frame, since one that is said to be whole too early is so by the time a second one ends; and of one whose lists have no room.
pub fn judged_once(
    model: &MachineModel,
    spec: &MachineSpec,
    case: &MachineCase,
) -> Result<Option<String>> {
    let MachineCase { seen, room, .. } = case;
    let found = draw(model, spec, seen, MEMORIES[2], *room, 1)?;
    if let Some(word) = different(&found) {
        return Ok(Some(word));
    }
    let found = draw(model, spec, seen, MEMORIES[0], room - 1, 1)?;
    let refused = found.outcome.full == 1 && found.outcome.beyond == 0;
    Ok((!refused).then(|| "lists without room are drawn".to_owned()))
}

fn different(found: &MachineFindings) -> Option<String> {
    let word = format!(
        "{} of {} pixels differ, {} accesses astray",
        found.mismatches, found.pixels, found.outcome.beyond
    );
    (!found.agree()).then_some(word)
}
