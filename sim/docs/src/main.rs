//! What prints splatline's documentation: `cargo run --release -p splatline-docs -- results` and `... gallery` print
//! `docs/results` and `docs/gallery`. Nobody needs it to use the simulator, so it is a program of its own, outside the
//! workspace's default members.
//!
//! ```text
//! views (scenes and cameras) -> what the commands run -> pages (tables as Markdown and CSV) -> docs/results
//! ```
//!
//! [`bars`] has what must be reached, [`rasterizer`] what speed is compared with, [`gallery`] every system's plans as
//! pictures.

mod bars;
mod gallery;
mod pages;
mod rasterizer;
mod table;
mod views;

use anyhow::Result;
use clap::{Args, Parser, Subcommand, ValueEnum};
use gallery::{GALLERY_EXAMPLES, GalleryOptions};
use pages::check::differences;
use pages::{Page, accuracy, machines, packet, picture, speed, systems, widths};
use splatline_sim::cli::{create_folder, finish, print_result, write};
use splatline_sim::fast::lanes::VectorLevel;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Prints splatline's documentation.
#[derive(Debug, Parser)]
#[command(name = "splatline-docs", version)]
struct Program {
    #[command(subcommand)]
    command: PageCommand,
}

#[derive(Debug, Subcommand)]
enum PageCommand {
    /// Draw every plan of a folder, with its figures beside the pictures.
    #[command(after_help = GALLERY_EXAMPLES)]
    Gallery(GalleryOptions),
    /// Measure the figures that the documentation states and write its pages.
    #[command(after_help = RESULTS_EXAMPLES)]
    Results(ResultsOptions),
    /// Draw the pictures of README and pages: results/demo.png and pictures/trained.png.
    Pictures {
        /// Folder of the scenes.
        #[arg(long, value_name = "DIR", default_value = "../shared/data")]
        data: PathBuf,
        /// Folder of the pages.
        #[arg(short, long, value_name = "DIR", default_value = "docs")]
        output: PathBuf,
    },
}

const RESULTS_EXAMPLES: &str = "\
Examples:
  splatline-docs results -o docs/results
  splatline-docs results --only accuracy -o /tmp/results
  splatline-docs results --only speed --vectors avx2 -o /tmp/results
  splatline-docs results --check --only packet";

#[derive(Debug, Args)]
struct ResultsOptions {
    /// Folder of the scenes (with gaussians, volumes and golden in it).
    #[arg(long, value_name = "DIR", default_value = "../shared/data")]
    data: PathBuf,
    /// Folder of the pages.
    #[arg(short, long, value_name = "DIR", default_value = "docs/results")]
    output: PathBuf,
    /// Only the pages named.
    #[arg(long, value_enum, value_name = "PAGE")]
    only: Vec<PageName>,
    /// Vectors of the page of times: avx2, avx512 or portable [default: avx2 and avx512, where the processor has them]
    #[arg(long, value_name = "LEVEL", value_parser = <VectorLevel as std::str::FromStr>::from_str)]
    vectors: Vec<VectorLevel>,
    /// Print the pages again and compare them with those in the folder instead of writing there; times are not compared
    #[arg(long)]
    check: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PageName {
    /// Designs against float, independent data, colours, file formats.
    Accuracy,
    /// Bit layout of the footprint packet.
    Packet,
    /// Every system of the papers: where it is, and its error.
    Systems,
    /// Error against width, stage by stage.
    Widths,
    /// Throughput, machines of others, where work and energy go, memories.
    Machines,
    /// How fast the kernel draws on this machine, which must have nothing else to do; printed only where it is named.
    Speed,
}

fn main() -> ExitCode {
    let code = finish(match Program::parse().command {
        PageCommand::Gallery(options) => gallery::run(&options),
        PageCommand::Results(options) => results(&options),
        PageCommand::Pictures { data, output } => pictures(&data, &output),
    });
    code.into()
}

fn results(options: &ResultsOptions) -> Result<()> {
    if options.check {
        return check(options);
    }
    create_folder(&options.output)?;
    for name in requested(options) {
        let page = print(name, options)?;
        page.write(&options.output)?;
        print_result(&page.files[0].1)?;
    }
    Ok(())
}

fn pictures(data: &Path, output: &Path) -> Result<()> {
    for (file, picture) in [
        ("results/demo.png", picture::demo(300)?),
        ("pictures/trained.png", picture::trained(data, 256)?),
    ] {
        let file = output.join(file);
        create_folder(file.parent().unwrap_or(output))?;
        write(&file, picture.to_png()?)?;
        print_result(&format!("{}\n", file.display()))?;
    }
    Ok(())
}

fn requested(options: &ResultsOptions) -> impl Iterator<Item = PageName> {
    let pages = PageName::value_variants().iter().copied();
    pages.filter(|page| {
        let by_itself = options.only.is_empty() && *page != PageName::Speed;
        by_itself || options.only.contains(page)
    })
}

fn print(name: PageName, options: &ResultsOptions) -> Result<Page> {
    let data = &options.data;
    match name {
        PageName::Accuracy => accuracy::page(data),
        PageName::Packet => Ok(packet::page()),
        PageName::Systems => systems::page(),
        PageName::Widths => widths::page(data),
        PageName::Machines => machines::page(data),
        PageName::Speed => speed::page(data, &levels(options)),
    }
}

/// The levels asked for; else what most people's processors have and what this one has beyond it, arrays only where
/// there is nothing else.
fn levels(options: &ResultsOptions) -> Vec<VectorLevel> {
    if !options.vectors.is_empty() {
        return options.vectors.clone();
    }
    let levels = VectorLevel::levels().into_iter();
    let mut levels: Vec<VectorLevel> = levels.map(|level| level.1).collect();
    levels.truncate(levels.len().saturating_sub(1).max(1));
    levels
}

/// Prints the pages again and compares them with the committed ones.
fn check(options: &ResultsOptions) -> Result<()> {
    let mut found = Vec::new();
    for name in requested(options).filter(|name| *name != PageName::Speed) {
        found.extend(differences(&print(name, options)?, &options.output));
    }
    print_result(&format!("{} differences\n", found.len()))?;
    if found.is_empty() {
        return Ok(());
    }
    Err(anyhow::anyhow!(
        "pages that are no longer true:\n{}",
        found.join("\n")
    ))
}
