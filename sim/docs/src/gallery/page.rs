//! The gallery's page: the contact sheet of each exhibit and its numbers beside it, as Markdown.

use super::Exhibit;
use super::sheet::label;
use std::fmt::Write;

/// File name of an exhibit's sheet.
pub fn file(exhibit: &Exhibit) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '-'
        }
    };
    let stem: String = exhibit.name.chars().map(plain).collect();
    format!("{stem}.png")
}

/// The page. `command` is what printed it.
pub fn markdown(title: &str, command: &str, exhibits: &[Exhibit]) -> String {
    let mut page = format!("# {title}\n\nPrinted by `{command}`.\n");
    for exhibit in exhibits {
        let _ = write!(
            page,
            "\n## {}\n\n{}. {}\n",
            exhibit.name, exhibit.equation, exhibit.caption
        );
        if !exhibit.pictures.is_empty() {
            let _ = write!(
                page,
                "\n![{}]({})\n\n{}\n",
                exhibit.name,
                file(exhibit),
                legend(exhibit)
            );
        }
        if !exhibit.numbers.is_empty() {
            page.push_str("\n| measurement | value |\n|---|---|\n");
        }
        for (what, value, unit) in &exhibit.numbers {
            let _ = writeln!(
                page,
                "| {what} | {} |",
                format!("{} {unit}", shown(*value)).trim_end()
            );
        }
    }
    page
}

/// The pictures' names in the order of the sheet, for those who cannot see it.
fn legend(exhibit: &Exhibit) -> String {
    let names = exhibit.pictures.iter().map(|(name, _)| label(name, 1));
    format!("Pictures: {}.", names.collect::<Vec<_>>().join("; "))
}

/// Four digits that count; small numbers with an exponent.
fn shown(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 1e-3 => format!("{value:.1e}"),
        size if size < 10.0 => format!("{value:.4}"),
        size if size < 1000.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use splatline_sim::picture::Picture;

    #[test]
    fn a_page_names_its_command_and_shows_numbers_beside_pictures() {
        let exhibit = Exhibit {
            name: "plane".to_owned(),
            equation: "[SWAN] 4.3",
            caption: "A plane.".to_owned(),
            pictures: vec![
                ("none".to_owned(), Picture::new(3, 2)),
                ("swan".to_owned(), Picture::new(2, 2)),
            ],
            numbers: vec![
                ("error".to_owned(), 0.5, "dB".to_owned()),
                ("bias".to_owned(), -2e-6, String::new()),
            ],
        };
        assert_eq!(
            markdown("Kernels", "splatline-docs gallery kernels", &[exhibit]),
            "# Kernels\n\nPrinted by `splatline-docs gallery kernels`.\n\n## plane\n\n[SWAN] 4.3. A plane.\n\n\
             ![plane](plane.png)\n\nPictures: none; swan.\n\n| measurement | value |\n|---|---|\n\
             | error | 0.5000 dB |\n| bias | -2.0e-6 |\n"
        );
    }
}
