//! The generated SystemVerilog package of the kernel's tables, which are the same for every design.
//!
//! `sim/rtl/splatline_tables.sv` is this module's output; a test compares the committed file with it. Each function is
//! one memory: the row unit reads roots alone, a setup core one entry of any table per cycle. So the roots stand in
//! both, in the widths that each unit's memory has.

use crate::package::filled;
use splatline::math::{LOGARITHMS, RECIPROCALS, ROOTS};
use std::collections::BTreeMap;

/// The package's file in the folder of the RTL.
pub const FILE: &str = "splatline_tables.sv";

/// Index of the first root: an argument is normalised to 64/256 or more.
const FIRST_ROOT: usize = 64;

/// Its text. `root_entry` is sqrt(i/256), 24 fraction bits, behind the step to i + 1, as the root unit interpolates
/// them. `setup_entry` has the steps of 256 entries of the reciprocal, then of 32 of the logarithm and, from 64 entries
/// after those on, of 192 of the root; 512 after them the entries.
pub fn text() -> String {
    // Steps and entries.
    let roots = ROOTS.windows(2).map(|pair| [pair[1] - pair[0], pair[0]]);
    let reciprocals = RECIPROCALS.windows(2);
    let reciprocals = reciprocals.map(|pair| [pair[0] - pair[1], pair[0]]);
    let logarithms = LOGARITHMS.chunks_exact(2).map(|pair| [pair[0], pair[1]]);
    let of_setup = (0..).zip(reciprocals).chain((256..).zip(logarithms));
    let of_setup = of_setup.chain((256 + FIRST_ROOT..).zip(roots.clone()));
    let words = of_setup.flat_map(|(index, [step, entry])| [(index, step), (512 + index, entry)]);
    let words = BTreeMap::from_iter(words).into_iter();
    let of_setup = words.map(|(index, word)| (index, format!("32'd{word};")));
    let roots = (FIRST_ROOT..).zip(roots);
    let roots = roots.map(|(index, [step, root])| (index, format!("{{17'd{step}, 24'd{root}}};")));
    filled(
        include_str!("../templates/tables.txt"),
        &[
            (
                "roots",
                &function("root_entry", 41, "index", 8, "d0", roots),
            ),
            (
                "of_setup",
                &function("setup_entry", 32, "index", 10, "d0", of_setup),
            ),
        ],
    )
}

/// The function `name` of so many bits: the word at each place of an index of so many bits, and elsewhere another. Each
/// word comes with its semicolon, behind which may stand a comment.
pub fn function(
    name: &str,
    bits: u32,
    index: &str,
    index_bits: u32,
    elsewhere: &str,
    words: impl Iterator<Item = (usize, String)>,
) -> String {
    let words =
        words.map(|(place, word)| format!("      {index_bits}'d{place}: {name} = {word}\n"));
    format!(
        "  function automatic logic [{}:0] {name}(input logic [{}:0] {index});\n    case ({index})\n\
         {}      default: {name} = {bits}'{elsewhere};\n    endcase\n  endfunction\n\n",
        bits - 1,
        index_bits - 1,
        words.collect::<String>()
    )
}
