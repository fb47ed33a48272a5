//! `splatline gallery`: the exhibits of one room as pictures and a page in Markdown.

use super::args::{GalleryOptions, Room};
use super::compare::create_folder;
use super::setup::write;
use super::{Failure, say};
use splatline_sim::gallery::{self, Exhibit};
use splatline_sim::picture::Depth;
use std::fmt::Write;

pub fn run(options: &GalleryOptions) -> Result<(), Failure> {
    create_folder(&options.output)?;
    let (stem, title, exhibits) = match options.room {
        Room::Surface => (
            "surface",
            "Surface splats",
            gallery::surface::surface(options.data.as_deref())?,
        ),
    };
    for (file, picture) in exhibits.iter().flat_map(|exhibit| &exhibit.pictures) {
        picture.write_png(&options.output.join(format!("{file}.png")), Depth::Eight)?;
    }
    let page = page(stem, title, &exhibits);
    write(&options.output.join(format!("{stem}.md")), page.as_bytes())?;
    say(&exhibits.iter().map(numbers_as_text).collect::<String>());
    Ok(())
}

/// The whole page; pictures are named relative to it.
fn page(stem: &str, title: &str, exhibits: &[Exhibit]) -> String {
    let mut page = format!(
        "# {title}\n\nPrinted by `cargo run --release -- gallery {stem} --data DIR -o docs/gallery`, where DIR holds the scanned clouds. \
         Errors are fixed point (`standard24`, `spans`) minus float in units of 1.0.\n"
    );
    for exhibit in exhibits {
        let _ = write!(
            page,
            "\n## {}\n\nSource: {}.\n\n{}\n\n",
            exhibit.name, exhibit.equation, exhibit.caption
        );
        for (file, _) in &exhibit.pictures {
            let _ = write!(page, "![{file}]({file}.png) ");
        }
        page.push_str("\n\n| number | value |\n|---|---|\n");
        for (name, value, unit) in &exhibit.numbers {
            let _ = writeln!(page, "| {name} | {} |", quantity(*value, unit));
        }
    }
    page
}

fn numbers_as_text(exhibit: &Exhibit) -> String {
    let mut text = format!("{}\n", exhibit.name);
    for (name, value, unit) in &exhibit.numbers {
        let _ = writeln!(text, "  {name}: {}", quantity(*value, unit));
    }
    text
}

/// Whole numbers as they are, decibels with two places, anything else with four significant digits.
fn quantity(value: f64, unit: &str) -> String {
    let number = match unit {
        "dB" if value.is_infinite() => "identical".to_owned(),
        "dB" => format!("{value:.2}"),
        _ if value.fract() == 0.0 && value.abs() < 1e12 => format!("{value:.0}"),
        _ if (0.01..1e6).contains(&value.abs()) => format!("{value:.4}"),
        _ => format!("{value:.3e}"),
    };
    match (unit, value.is_infinite()) {
        ("", _) | (_, true) => number,
        _ => format!("{number} {unit}"),
    }
}
