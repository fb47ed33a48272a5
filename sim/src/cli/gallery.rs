//! `splatline gallery`: exhibits of the papers' systems as pictures and numbers on one page.

use super::args::{Collection, GalleryOptions};
use super::compare::create_folder;
use super::progress::Progress;
use super::setup::write;
use super::{Failure, say};
use splatline_sim::gallery::{Exhibit, surface};
use splatline_sim::picture::Depth;
use std::fmt::Write;

pub fn run(options: &GalleryOptions) -> Result<(), Failure> {
    create_folder(&options.output)?;
    let progress = Progress::new(1);
    let (name, title, exhibits) = match options.collection {
        Collection::Surface => {
            progress.doing("surface exhibits".to_owned());
            (
                "surface",
                "Gallery: surface splats",
                surface::surface(&options.data)?,
            )
        }
    };
    drop(progress);
    for (file, picture) in exhibits.iter().flat_map(|exhibit| &exhibit.pictures) {
        picture.write_png(&options.output.join(format!("{file}.png")), Depth::Eight)?;
    }
    let page = page(name, title, &exhibits);
    write(&options.output.join("README.md"), page.as_bytes())?;
    say(&exhibits.iter().map(numbers_as_text).collect::<String>());
    Ok(())
}

/// The whole page; pictures lie beside it.
fn page(name: &str, title: &str, exhibits: &[Exhibit]) -> String {
    let mut page = format!(
        "# {title}\n\nPrinted by `cargo run --release -- gallery {name} -o docs/gallery/{name}`. Errors are fixed point (`standard24`, `spans`) minus \
         the double-precision reference, in units of 1.0. Pictures are shown over white.\n"
    );
    for exhibit in exhibits {
        let Exhibit {
            name,
            equation,
            caption,
            ..
        } = exhibit;
        let _ = write!(page, "\n## {name}\n\nSource: {equation}.\n\n{caption}\n\n");
        for (file, _) in &exhibit.pictures {
            let _ = writeln!(page, "![{file}]({file}.png)");
        }
        page.push_str("\n| number | value |\n|---|---|\n");
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

/// Whole numbers as they are, decibels with two places, anything else with about four significant digits.
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
