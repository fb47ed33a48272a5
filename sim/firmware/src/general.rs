//! A strip by the kernel's general painter with widths in fields and 64-bit lanes: what the image's own must equal.
//! Host only.

use crate::design::Firmware16;
use crate::fixed_picture::FixedMemory;
use crate::scene::{COLUMNS, RULES, STRIP, STRIP_PIXELS};
use crate::table::ENTRIES;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::format::{RuntimeWidths, Traversal};
use splatline::kernel::FootprintTable;
use splatline::raster::Window;
use splatline::rules::Compositing;
use splatline::target::Target;

/// Draws the footprints in memory into a strip of its own.
pub fn draw_strip(memory: &FixedMemory, first_row: u16) -> (Vec<Pixel>, Coverage) {
    let widths = Firmware16::WIDTHS;
    let design = RuntimeWidths::new(widths).expect("the widths are checked at compile time");
    let table = FootprintTable::new(&ENTRIES, &widths, RULES.table_range).expect("made for them");
    let order = Compositing::FrontToBack;
    let painter = Painter::new(design, &RULES, table, order, Traversal::Spans);
    let window = Window {
        first: [0, first_row],
        end: [COLUMNS, first_row + STRIP],
    };
    let mut strip = vec![Pixel::clear(&widths); STRIP_PIXELS];
    let mut target = Target::new(&mut strip, window, COLUMNS.into()).expect("of the strip's size");
    let mut coverage = Coverage::default();
    for number in memory.order.iter() {
        if let Some(footprint) = memory.footprints.get(number) {
            coverage += painter.draw(footprint, &mut target);
        }
    }
    (strip, coverage)
}
