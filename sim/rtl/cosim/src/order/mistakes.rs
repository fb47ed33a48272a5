//! Sorters and binnings with one mistake each: does the comparison notice it?

use super::bench::{MEMORIES, OrderLoad, run};
use super::circuit::library;
use super::loads::hard;
use super::model::OrderModel;
use crate::mutants::{Mutant, mutant};
use anyhow::Result;

const SORT: &str = "depth_sort.sv";
const BINS: &str = "tile_binning.sv";
const ORDER: &str = "splat_order.sv";
const STREAM: &str = "memory_stream.sv";

/// The mistakes.
#[rustfmt::skip]
pub const MISTAKES: [Mutant; 26] = [
    mutant("places read while they change", SORT, "follows <= (moving && waiting_digit == moving_digit) || (moved && waiting_digit == moved_digit)", "follows <= 1'b0"),
    mutant("places read while the last but one changes", SORT, "follows <= (moving && waiting_digit == moving_digit) || (moved && waiting_digit == moved_digit)", "follows <= moving && waiting_digit == moving_digit"),
    mutant("places read while the last one changes", SORT, "follows <= (moving && waiting_digit == moving_digit) || (moved && waiting_digit == moved_digit)", "follows <= moved && waiting_digit == moved_digit"),
    mutant("every place follows the one before", SORT, "follows <= (moving && waiting_digit == moving_digit) || (moved && waiting_digit == moved_digit)", "follows <= moving"),
    mutant("the place after the last one's, whatever the digit", SORT, "next_place <= moving && waiting_digit == moving_digit ? after : moved_after", "next_place <= moving ? after : moved_after"),
    mutant("a pass for a digit that all share is forgotten elsewhere", SORT, "if (counter == count) same_for_all <= 1;", "if (counter + 1'b1 >= count) same_for_all <= 1;"),
    mutant("a pass left out", SORT, "pass == PASS_BITS'(PASSES - 1) ? DONE", "pass == PASS_BITS'(PASSES - 2) ? DONE"),
    mutant("regions not exchanged", SORT, "side <= !side;", "side <= side;"),
    mutant("regions exchanged without a pass", SORT, "state <= same_for_all ? SETTLE : BEGIN;", "state <= same_for_all ? SETTLE : BEGIN; side <= side ^ same_for_all;"),
    mutant("counts of the picture before", SORT, "      CLEAR: begin\n        changes = 1;", "      CLEAR: begin\n        changes = 0;"),
    mutant("sums that count a value itself", SORT, "changed = sum;", "changed = sum + counter;"),
    mutant("splats counted by the digit before", SORT, "digit(key, PASS_BITS'(step - 1'b1))}", "digit(key, PASS_BITS'(step))}"),
    mutant("a pass does not wait for what was written", SORT, "      if (settled) begin", "      if (1'b1) begin"),
    mutant("the first pass does not wait for what was written", SORT, "&& !summing && !summed && settled)", "&& !summing && !summed)"),
    mutant("splats moved without being written", SORT, "assign moves = !moving || write_ready;", "assign moves = 1'b1;"),
    mutant("a splat too few moved", SORT, "if (left == 1) begin", "if (left == 2) begin"),
    mutant("tiles of the picture before", BINS, "      CLEAR: begin\n        changes = 1;", "      CLEAR: begin\n        changes = 0;"),
    mutant("a box's last column left out", BINS, "assign last_column = column == last;", "assign last_column = column + 1'b1 == last;"),
    mutant("a box's last row left out", BINS, "assign last_row = row == last_of_rows;", "assign last_row = row + 1'b1 >= last_of_rows;"),
    mutant("rows begin at the screen's edge", BINS, "column <= last_column ? first :", "column <= last_column ? 12'd0 :"),
    mutant("rows of tiles one too long", BINS, "tile_of_row <= tile_of_row + TILE_BITS'(tile_columns);", "tile_of_row <= tile_of_row + TILE_BITS'(tile_columns) + 1'b1;"),
    mutant("places of the first tile written twice", BINS, "changes = entered && moves;", "changes = entered && moves && entered_tile != 0;"),
    mutant("entries at the wrong number of a word", BINS, "4'd1 << counter[1:0]", "4'd1 << ~counter[1:0]"),
    mutant("a splat walks on while an entry waits", BINS, "assign moves = counts || !entered || write_ready;", "assign moves = 1'b1;"),
    mutant("lists filled before splats are sorted", ORDER, "started && sort_done && counted && !listing", "started && counted && !listing"),
    mutant("words asked for without a place", STREAM, "assign read_valid = left != 0 && free;", "assign read_valid = left != 0;"),
];

/// What the comparison says of a mistake, or nothing if it survives.
pub fn verdict(mistake: Option<&Mutant>, loads: &[OrderLoad]) -> Result<Option<String>> {
    let folder = tempfile::tempdir()?;
    let model = OrderModel::new(&library(folder.path(), 8, mistake, "-O1")?)?;
    for (index, load) in loads.iter().enumerate() {
        for timing in MEMORIES {
            match run(&model, load, timing, index as u32 + 1) {
                Err(error) => return Ok(Some(format!("{}: {error:#}", load.name))),
                Ok(findings) if !findings.agree() => {
                    return Ok(Some(format!(
                        "{}: {} splats out of order, {} entries wrong",
                        load.name, findings.out_of_order, findings.listed_wrong
                    )));
                }
                Ok(_) => {}
            }
        }
    }
    Ok(None)
}

/// What the mistakes are judged by.
pub fn judges() -> Vec<OrderLoad> {
    hard()
}
