//! The same tile by the kernel.

use crate::workload::BenchTile;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Design, Traversal};
use splatline::kernel::{FootprintTable, entries, fill_gaussian};
use splatline::rules::{Compositing, Rules};
use splatline::target::Target;

/// The kernel with its footprint table filled, as the circuit has it before the first tile.
pub struct Golden<'a, D> {
    design: D,
    rules: &'a Rules,
    memory: Vec<u32>,
}

impl<'a, D: Design> Golden<'a, D> {
    /// Fills the table.
    pub fn new(design: D, rules: &'a Rules) -> Self {
        let widths = design.widths();
        let mut memory = vec![0; entries(&widths)];
        fill_gaussian(&mut memory, &widths, rules.table_range);
        Golden {
            design,
            rules,
            memory,
        }
    }

    /// The window's pixels, row by row, and what was visited.
    pub fn draw(&self, tile: &BenchTile, footprints: &[Footprint]) -> (Vec<Pixel>, Coverage) {
        let widths = self.design.widths();
        let table = FootprintTable::new(&self.memory, &widths, self.rules.table_range)
            .expect("the table was made for these widths");
        let painter = Painter::new(
            self.design,
            self.rules,
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
}
