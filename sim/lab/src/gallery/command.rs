//! `splatline-lab gallery`: exhibits of the papers' systems as pictures and numbers, one page per collection.

use super::{Exhibit, deep, kernels, page, sheet, surface, texture};
use clap::{Args, ValueEnum};
use splatline_sim::cli::create_folder;
use splatline_sim::cli::write;
use splatline_sim::cli::{Failure, print_result};
use splatline_sim::picture::Depth;
use splatline_sim::progress::ProgressMeter;
use std::path::{Path, PathBuf};

/// What the help ends with.
pub const GALLERY_EXAMPLES: &str = "\
Examples:
  splatline-lab gallery all -o docs/gallery
  splatline-lab gallery surface -o docs/gallery/surface
  splatline-lab gallery kernels -o docs/gallery/kernels
  splatline-lab gallery kernels --only antialias -o out

Groups of kernels: shapes, antialias, spheres, hybrid, stamps; of deep: alpha, sheets; of texture: checkerboard, terrain, warp, plane.";

/// What is drawn, and where to.
#[derive(Debug, Args)]
pub struct GalleryOptions {
    /// Which collection
    #[arg(value_enum)]
    pub collection: Collection,
    /// One group of the collection only
    #[arg(long, value_name = "GROUP")]
    pub only: Option<String>,
    /// Folder that holds the data sets, such as volumes/aneurism.nhdr
    #[arg(long, value_name = "dir", default_value = "../shared/data")]
    pub data: PathBuf,
    /// Folder to write README.md and the pictures into
    #[arg(short, long, value_name = "dir")]
    pub output: PathBuf,
}

/// A collection of exhibits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Collection {
    /// Surface splats, layers, edges, deferred shading
    Surface,
    /// Kernels, antialiasing, spheres, hybrid points, stamps
    Kernels,
    /// Deep alpha channel, sheet buffers
    Deep,
    /// Texture coefficients, height field with photograph, warped depth images
    Texture,
    /// All of them, each in a folder of its name
    All,
}

impl Collection {
    /// The collections that are pages of their own.
    pub const PAGES: [Collection; 4] = [
        Collection::Surface,
        Collection::Kernels,
        Collection::Deep,
        Collection::Texture,
    ];

    /// Name on the command line and of the folder in docs/gallery.
    pub fn name(self) -> &'static str {
        match self {
            Collection::Surface => "surface",
            Collection::Kernels => "kernels",
            Collection::Deep => "deep",
            Collection::Texture => "texture",
            Collection::All => "all",
        }
    }

    /// The page's heading.
    pub fn title(self) -> &'static str {
        match self {
            Collection::Surface => "Gallery: surface splats",
            Collection::Kernels => {
                "Gallery: kernels, antialiasing, hybrid points, spheres and stamps"
            }
            Collection::Deep => "Gallery: deep alpha and sheet buffers",
            Collection::Texture => "Gallery: texture and image warping",
            Collection::All => "Gallery",
        }
    }
}

/// Makes the collections asked for.
pub fn run(options: &GalleryOptions) -> Result<(), Failure> {
    if options.collection != Collection::All {
        return make(options, options.collection, &options.output);
    }
    if options.only.is_some() {
        return Err(Failure::Usage(
            "--only needs one collection, not all".to_owned(),
        ));
    }
    for collection in Collection::PAGES {
        make(options, collection, &options.output.join(collection.name()))?;
    }
    Ok(())
}

/// Makes one collection and its page in a folder.
fn make(options: &GalleryOptions, collection: Collection, folder: &Path) -> Result<(), Failure> {
    let groups = chosen_groups(options, collection)?;
    create_folder(folder)?;
    let progress = ProgressMeter::new(groups.len());
    let mut exhibits = Vec::new();
    for group in groups {
        progress.doing(format!("{group} exhibits"));
        exhibits.extend(match collection {
            Collection::Surface => surface::surface(&options.data)?,
            Collection::Kernels => kernels::some(&options.data, group),
            Collection::Deep => deep_group(&options.data, group, folder)?,
            Collection::Texture => texture::some(&options.data, group)?,
            Collection::All => Vec::new(),
        });
        progress.advance();
    }
    drop(progress);
    store(options, collection, folder, &exhibits)
}

/// A group that brings files of its own: a plot, a table.
fn deep_group(data: &Path, group: &str, folder: &Path) -> Result<Vec<Exhibit>, Failure> {
    let group = deep::some(data, group);
    for (name, text) in &group.files {
        write(&folder.join(name), text.as_bytes())?;
    }
    Ok(group.exhibits)
}

/// The groups of a collection that are asked for.
fn chosen_groups(
    options: &GalleryOptions,
    collection: Collection,
) -> Result<Vec<&'static str>, Failure> {
    let groups: &[&str] = match collection {
        Collection::Surface => &["surface"],
        Collection::Kernels => &kernels::NAMES,
        Collection::Deep => &deep::NAMES,
        Collection::Texture => &texture::NAMES,
        Collection::All => &[],
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
fn store(
    options: &GalleryOptions,
    collection: Collection,
    folder: &Path,
    exhibits: &[Exhibit],
) -> Result<(), Failure> {
    for exhibit in exhibits {
        if let Some(sheet) = sheet::sheet(exhibit) {
            let file: PathBuf = folder.join(page::file(exhibit));
            sheet.write_png(&file, Depth::Eight)?;
        }
    }
    let (name, title) = (collection.name(), collection.title());
    let only = options
        .only
        .as_ref()
        .map_or(String::new(), |only| format!(" --only {only}"));
    let command = format!(
        "cargo run --release -p splatline-lab -- gallery {name}{only} -o docs/gallery/{name}"
    );
    let text = page::markdown(title, &command, exhibits);
    write(&folder.join("README.md"), text.as_bytes())?;
    print_result(&text)?;
    Ok(())
}
