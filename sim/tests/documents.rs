//! Documents that state facts of the code are held against it.

use splatline_sim::design::DesignChoice;

/// The table of widths in docs/number-formats.md is that of the named designs.
#[test]
fn number_formats_list_the_designs_widths() {
    let text = include_str!("../../docs/number-formats.md");
    for design in DesignChoice::all() {
        let numbers: Vec<String> = design.widths.numbers().iter().map(u8::to_string).collect();
        let rounding = design.resolved().rounding;
        let row = format!(
            "| `{}` | {} | {rounding} |",
            design.name,
            numbers.join(" | ")
        );
        assert!(
            text.contains(&row),
            "docs/number-formats.md lacks the row\n{row}"
        );
    }
}
