//! The footprint packet's bit layout, printed from the kernel's own table.

use super::{ResultPage, opening, table};
use splatline::footprint::packet::{Layout, VERSION};
use splatline_sim::design::DesignChoice;

/// The page: one table with the offsets of every design.
pub fn page() -> ResultPage {
    let mut text = opening("The footprint packet");
    text.push_str(&format!(
        "Layout version {VERSION}. Fields follow each other without padding, least significant bit first, in 32-bit words. `offset:width` in bits; fraction \
         bits behind a point. Signed fields are two's complement. A mantissa `m` and its exponent `e` stand for m 2^e.\n\n"
    ));
    let designs = DesignChoice::all();
    let layouts: Vec<Layout> = designs
        .iter()
        .map(|design| Layout::new(&design.widths))
        .collect();
    let mut headings = vec!["field", "signed"];
    headings.extend(designs.iter().map(|design| design.name.as_str()));
    let mut rows = Vec::new();
    for index in 0..layouts[0].fields().len() {
        let first = layouts[0].fields()[index];
        let mut row = vec![
            first.name.to_owned(),
            if first.signed { "yes" } else { "" }.to_owned(),
        ];
        row.extend(layouts.iter().map(|layout| {
            let field = layout.fields()[index];
            format!("{}:{}.{}", field.offset, field.width, field.fraction)
        }));
        rows.push(row);
    }
    let mut total = vec!["bits (words)".to_owned(), String::new()];
    total.extend(
        layouts
            .iter()
            .map(|layout| format!("{} ({})", layout.bits(), layout.words())),
    );
    rows.push(total);
    text.push_str(&table(&headings, &rows));
    ResultPage {
        file: "packet.md",
        text,
    }
}
