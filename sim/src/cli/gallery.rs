//! `splatline gallery`: exhibits of the papers' systems as pictures and numbers on one page.

use super::compare::create_folder;
use super::progress::Progress;
use super::setup::write;
use super::study_args::{Collection, GalleryOptions};
use super::{Failure, say};
use splatline_sim::gallery::{Exhibit, deep, kernels, page, surface};
use splatline_sim::picture::Depth;

pub fn run(options: &GalleryOptions) -> Result<(), Failure> {
    let groups = chosen_groups(options)?;
    create_folder(&options.output)?;
    let progress = Progress::new(groups.len());
    let mut exhibits = Vec::new();
    for group in groups {
        progress.doing(format!("{group} exhibits"));
        exhibits.extend(match options.collection {
            Collection::Surface => surface::surface(&options.data)?,
            Collection::Kernels => kernels::some(&options.data, group),
            Collection::Deep => deep_group(options, group)?,
        });
        progress.advance();
    }
    drop(progress);
    store(options, &exhibits)
}

/// A group that brings files of its own: a plot, a table.
fn deep_group(options: &GalleryOptions, group: &str) -> Result<Vec<Exhibit>, Failure> {
    let group = deep::some(&options.data, group);
    for (name, text) in &group.files {
        write(&options.output.join(name), text.as_bytes())?;
    }
    Ok(group.exhibits)
}

/// The groups of a collection that are asked for.
fn chosen_groups(options: &GalleryOptions) -> Result<Vec<&'static str>, Failure> {
    let groups: &[&str] = match options.collection {
        Collection::Surface => &["surface"],
        Collection::Kernels => &kernels::NAMES,
        Collection::Deep => &deep::NAMES,
    };
    match &options.only {
        None => Ok(groups.to_vec()),
        Some(only) => match groups.iter().find(|group| *group == only) {
            Some(group) => Ok(vec![group]),
            None => {
                let groups = groups.join(", ");
                Err(Failure::Usage(format!(
                    "--only '{only}': expected one of {groups}"
                )))
            }
        },
    }
}

/// One contact sheet per exhibit and a page that shows them with their numbers.
fn store(options: &GalleryOptions, exhibits: &[Exhibit]) -> Result<(), Failure> {
    for exhibit in exhibits {
        if let Some(sheet) = page::sheet(exhibit) {
            let file = options.output.join(page::file(exhibit));
            sheet.write_png(&file, Depth::Eight)?;
        }
    }
    let (name, title) = match options.collection {
        Collection::Surface => ("surface", "Gallery: surface splats"),
        Collection::Kernels => (
            "kernels",
            "Gallery: kernels, antialiasing, hybrid points, spheres and stamps",
        ),
        Collection::Deep => ("deep", "Gallery: deep alpha and sheet buffers"),
    };
    let only = options
        .only
        .as_ref()
        .map_or(String::new(), |only| format!(" --only {only}"));
    let command = format!("cargo run --release -- gallery {name}{only} -o docs/gallery/{name}");
    let text = page::markdown(title, &command, exhibits);
    write(&options.output.join("README.md"), text.as_bytes())?;
    say(&text);
    Ok(())
}
