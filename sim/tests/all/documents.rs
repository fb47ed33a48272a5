//! Documents that state facts of the code are held against it.

use splatline_sim::design::DesignChoice;
use splatline_sim::machine::config::FIELDS;

/// The table of widths in docs/number-formats.md is that of the named designs.
#[test]
fn number_formats_list_the_designs_widths() {
    let text = include_str!("../../../docs/number-formats.md");
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

/// Every key of a machine and every width of a design stands in docs/files.md.
#[test]
fn the_page_of_files_lists_every_key() {
    let text = include_str!("../../../docs/files.md");
    for field in FIELDS {
        let row = text
            .lines()
            .find(|line| line.starts_with(&format!("| `[{}]` |", field.section)));
        let row =
            row.unwrap_or_else(|| panic!("docs/files.md lacks the section {}", field.section));
        assert!(
            row.contains(&format!("`{}`", field.key)),
            "docs/files.md lacks {}",
            field.path()
        );
    }
    for (width, ..) in splatline::format::WIDTH_RANGES {
        assert!(
            text.contains(&format!("`{width}`")),
            "docs/files.md lacks {width}"
        );
    }
}
