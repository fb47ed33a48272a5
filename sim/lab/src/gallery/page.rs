//! The gallery's page: one contact sheet per exhibit and its numbers beside it, as Markdown.

use super::Exhibit;
use splatline_sim::picture::Picture;
use std::fmt::Write;

/// Pictures in a row of a contact sheet of so many: few in one row, the others so that the last row is full if it can be.
fn columns(pictures: usize) -> usize {
    match pictures {
        0..=5 => pictures.max(1),
        _ if pictures.is_multiple_of(3) => 3,
        _ => 4,
    }
}

/// Pixels between pictures.
const GAP: usize = 4;

/// An exhibit's pictures on one sheet, row by row, on black; none if there are none.
pub fn sheet(exhibit: &Exhibit) -> Option<Picture> {
    let sizes = exhibit
        .pictures
        .iter()
        .map(|(_, picture)| (picture.width, picture.height));
    let cell = sizes.reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))?;
    let (width, height) = (cell.0 + GAP, cell.1 + GAP);
    let columns = columns(exhibit.pictures.len());
    let rows = exhibit.pictures.len().div_ceil(columns);
    let mut sheet = Picture::new(columns * width - GAP, rows * height - GAP);
    sheet.pixels.fill([0.0, 0.0, 0.0, 1.0]);
    for (index, (_, picture)) in exhibit.pictures.iter().enumerate() {
        let (x0, y0) = (index % columns * width, index / columns * height);
        for (y, row) in picture.pixels.chunks_exact(picture.width).enumerate() {
            let start = (y0 + y) * sheet.width + x0;
            for (out, [r, g, b, _]) in sheet.pixels[start..].iter_mut().zip(row) {
                *out = [*r, *g, *b, 1.0];
            }
        }
    }
    Some(sheet)
}

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

/// The pictures' names in the order of the sheet.
fn legend(exhibit: &Exhibit) -> String {
    let names: Vec<&str> = exhibit
        .pictures
        .iter()
        .map(|(name, _)| name.as_str())
        .collect();
    let rows: Vec<String> = names
        .chunks(columns(names.len()))
        .map(|row| row.join(" | "))
        .collect();
    format!("From the left, row by row: {}.", rows.join("; "))
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
        let sheet = sheet(&exhibit).unwrap();
        assert_eq!((sheet.width, sheet.height), (3 + GAP + 3, 2));
        assert_eq!(
            markdown("Kernels", "splatline-lab gallery kernels", &[exhibit]),
            "# Kernels\n\nPrinted by `splatline-lab gallery kernels`.\n\n## plane\n\n[SWAN] 4.3. A plane.\n\n\
             ![plane](plane.png)\n\nFrom the left, row by row: none | swan.\n\n| measurement | value |\n|---|---|\n\
             | error | 0.5000 dB |\n| bias | -2.0e-6 |\n"
        );
    }
}
