//! The same tile by the kernel.

use crate::workload::Tile;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Design, Traversal};
use splatline::kernel::{FootprintTable, entries, fill_gaussian};
use splatline::rules::{Compositing, Rules};
use splatline::target::Target;

/// The window's pixels, row by row, and what was visited.
pub fn draw<D: Design>(
    design: D,
    rules: &Rules,
    tile: &Tile,
    footprints: &[Footprint],
) -> (Vec<Pixel>, Coverage) {
    let widths = design.widths();
    let mut memory = vec![0; entries(&widths)];
    fill_gaussian(&mut memory, &widths, rules.table_range);
    let table = FootprintTable::new(&memory, &widths, rules.table_range)
        .expect("the table was made for these widths");
    let painter = Painter::new(
        design,
        rules,
        table,
        Compositing::FrontToBack,
        Traversal::Spans,
    );
    let [columns, rows] = tile.size();
    let mut pixels = vec![Pixel::clear(&widths); columns * rows];
    let mut target = Target::new(&mut pixels, tile.window, columns)
        .expect("the memory was made for this window");
    let mut coverage = Coverage::default();
    for index in &tile.list {
        coverage += painter.draw(&footprints[*index as usize], &mut target);
    }
    (pixels, coverage)
}
