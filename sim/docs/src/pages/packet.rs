//! The footprint packet's bit layout, printed from the kernel's own table.

use super::Page;
use crate::table::Table;
use splatline::footprint::packet::{Layout, VERSION};
use splatline_sim::design::DesignChoice;

/// The page: one table with the offsets of every design.
pub fn page() -> Page {
    let mut page = Page::new("packet", "The footprint packet");
    page.add(format!(
        "Layout version {VERSION}. Fields follow each other without padding, least significant bit first, in 32-bit words. `offset:width` in bits; fraction \
         bits behind a point. Signed fields are two's complement. A mantissa `m` and its exponent `e` stand for m 2^e. A packet has what its design's traversal reads (`classic8`: `box`). What sorts has the depth beside the packet (`Layout::with_depth` puts it in)."
    ));
    let designs = DesignChoice::all();
    let layouts: Vec<Layout> = designs
        .iter()
        .map(|design| Layout::new(&design.widths, design.traversal))
        .collect();
    let names: Vec<&str> = designs.iter().map(|design| design.name.as_str()).collect();
    let mut table = Table::new(&format!("field | signed | {}", names.join(" | ")));
    for (index, first) in layouts[0].fields().iter().enumerate() {
        let signed = if first.signed { "yes" } else { "" };
        let places = layouts.iter().map(|layout| {
            let field = layout.fields()[index];
            match field.width {
                0 => String::new(),
                width => format!("{}:{}.{}", field.offset, width, field.fraction),
            }
        });
        table.push_behind(&[first.name, signed], places);
    }
    let sizes = layouts
        .iter()
        .map(|layout| format!("{} ({})", layout.bits(), layout.words()));
    table.push_behind(&["bits (words)", ""], sizes);
    page.add(table.markdown());
    page
}
