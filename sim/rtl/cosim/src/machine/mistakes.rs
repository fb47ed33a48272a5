//! Machines with one mistake each between their units: does a frame notice it? Mistakes within the units are judged by their own benches.

use super::bench::{Timing, draw};
use super::circuit::{Spec, library};
use super::model::Model;
use crate::mutants::{Mutant, mutant};
use crate::order::loads::Seen;
use anyhow::Result;
use splatline::format::{Lean18, Widths};
use splatline_sim::scene::synthetic;

const MACHINE: &str = "splat_machine.sv";
const FETCH: &str = "packet_fetch.sv";
const ARBITER: &str = "read_arbiter.sv";

/// The mistakes.
#[rustfmt::skip]
pub const MISTAKES: [Mutant; 14] = [
    mutant("culled splats are stored", MACHINE, "setup_valid && cull == 0 && step == 4'(PACKET)", "setup_valid && step == 4'(PACKET)"),
    mutant("culled splats have no number", MACHINE, "number <= number + 1'b1;", "number <= number + 32'(cull == 0);"),
    mutant("a packet's last word left out", MACHINE, "cull == 0 && step != 4'(PACKET);", "cull == 0 && step != 4'(PACKET - 1);"),
    mutant("boxes end a pixel late", MACHINE, "tile_of(footprint.last_column - 16'd1, COLUMN_BITS)", "tile_of(footprint.last_column, COLUMN_BITS)"),
    mutant("tiles beyond the frame's edge", MACHINE, "place > 28'(limit) ? limit : place[15:0]", "place[15:0]"),
    mutant("an empty tile waits for a packet", MACHINE, "state <= end_place == begun ? FINISH : DRAW;", "state <= DRAW;"),
    mutant("every list begins at the first", MACHINE, "left <= end_place - begun;", "left <= end_place;"),
    mutant("red and blue exchanged", MACHINE, "{32'(colour[2*SUM+:SUM]), 32'(colour[SUM+:SUM]), 32'(colour[0+:SUM]), transmittance_word}", "{32'(colour[0+:SUM]), 32'(colour[SUM+:SUM]), 32'(colour[2*SUM+:SUM]), transmittance_word}"),
    mutant("the frame ends before its last pixel", MACHINE, "if (pixels_left == 0 && settled)", "if (settled)"),
    mutant("lists of a frame without room are drawn", MACHINE, "state <= full ? IDLE : LOOK;", "state <= LOOK;"),
    mutant("a list's words end with their fourth entry alone", FETCH, "(entry == 2'd3 || left == 1)", "entry == 2'd3"),
    mutant("entries of a word the wrong way", FETCH, "list[32*entry+:32]", "list[32*(3-entry)+:32]"),
    mutant("packets asked for without a place", FETCH, "left != 0 && free;", "left != 0;"),
    mutant("words for whoever asks now", ARBITER, "askers[answered] : '0", "chosen : '0"),
];

/// A frame small enough for every mistake, with lists that end within words, culled splats and tiles cut by the edge.
pub fn judge() -> Seen {
    Seen {
        name: "crowd",
        scene: synthetic::random_gaussians(120, 9, 4.0),
        camera: synthetic::camera(70, 45),
    }
}

/// What the frames say of a mistake, or nothing if it survives: at full speed, with pauses, twice in one machine; and one whose lists have no room.
pub fn verdict(mistake: Option<&Mutant>, seen: &Seen, room: usize) -> Result<Option<String>> {
    let folder = tempfile::tempdir()?;
    let widths: Widths = Lean18::WIDTHS;
    let spec = Spec {
        design: "lean18",
        widths: &widths,
        cores: 4,
        lanes: 4,
        mistake,
        effort: "-O1",
    };
    let model = Model::new(&library(folder.path(), &spec)?)?;
    for (latency, pauses) in [(60, 0), (9, 3)] {
        let timing = Timing { latency, pauses };
        match draw(&model, &widths, seen, timing, room, 2) {
            Err(error) => return Ok(Some(format!("{error:#}"))),
            Ok(found) if !found.agree() => {
                return Ok(Some(format!(
                    "{} of {} pixels differ, {} accesses astray",
                    found.mismatches, found.pixels, found.outcome.beyond
                )));
            }
            Ok(_) => {}
        }
    }
    let timing = Timing {
        latency: 9,
        pauses: 0,
    };
    Ok(match draw(&model, &widths, seen, timing, room - 1, 1) {
        Err(error) => Some(format!("{error:#}")),
        Ok(found) if found.outcome.full == 0 || found.outcome.beyond > 0 => {
            Some("lists without room are drawn".to_owned())
        }
        Ok(_) => None,
    })
}
