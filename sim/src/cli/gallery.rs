//! `splatline gallery`: exhibits of the papers' systems as pictures and numbers on one page.

use super::args::{Collection, GalleryOptions};
use super::progress::Progress;
use super::setup::write;
use super::{Failure, say};
use anyhow::Context;
use splatline_sim::gallery::{Exhibit, kernels, page};
use splatline_sim::picture::Depth;

pub fn run(options: &GalleryOptions) -> Result<(), Failure> {
    let groups: &[&str] = match options.collection {
        Collection::Kernels => &kernels::NAMES,
    };
    if let Some(only) = &options.only
        && !groups.contains(&only.as_str())
    {
        let groups = groups.join(", ");
        return Err(Failure::Usage(format!(
            "--only '{only}': expected one of {groups}"
        )));
    }
    std::fs::create_dir_all(&options.output)
        .with_context(|| format!("cannot make the folder '{}'", options.output.display()))?;
    let chosen = groups
        .iter()
        .filter(|name| options.only.as_ref().is_none_or(|only| only == *name));
    let chosen: Vec<&&str> = chosen.collect();
    let progress = Progress::new(chosen.len());
    let mut exhibits = Vec::new();
    for name in chosen {
        progress.doing(format!("{name} exhibits"));
        exhibits.extend(match options.collection {
            Collection::Kernels => kernels::some(&options.data, name),
        });
        progress.advance();
    }
    drop(progress);
    store(options, &exhibits)
}

fn store(options: &GalleryOptions, exhibits: &[Exhibit]) -> Result<(), Failure> {
    for exhibit in exhibits {
        if let Some(sheet) = page::sheet(exhibit) {
            let file = options.output.join(format!("{}.png", exhibit.name));
            sheet.write_png(&file, Depth::Eight)?;
        }
    }
    let name = match options.collection {
        Collection::Kernels => "kernels",
    };
    let only = options
        .only
        .as_ref()
        .map_or(String::new(), |only| format!(" --only {only}"));
    let command = format!("cargo run --release -- gallery {name}{only} -o docs/gallery/{name}");
    let title = match options.collection {
        Collection::Kernels => "Gallery: kernels, antialiasing, hybrid points, spheres and stamps",
    };
    let text = page::markdown(title, &command, exhibits);
    write(&options.output.join("README.md"), text.as_bytes())?;
    say(&text);
    Ok(())
}
