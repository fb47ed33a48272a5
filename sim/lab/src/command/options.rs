//! The lab's command line.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Measures and prints splatline's own documentation.
#[derive(Debug, Parser)]
#[command(name = "splatline-lab", version)]
pub struct Lab {
    #[command(subcommand)]
    pub command: LabCommand,
}

#[derive(Debug, Subcommand)]
pub enum LabCommand {
    /// Draw the exhibits that show each system, with their numbers beside the pictures.
    #[command(after_help = GALLERY_EXAMPLES)]
    Gallery(GalleryOptions),
    /// Measure every figure that the documentation states and write its pages.
    #[command(after_help = RESULTS_EXAMPLES)]
    Results(ResultsOptions),
    /// Print how long the host crates are, by folder and without tests, beside an earlier commit.
    #[command(after_help = LINES_EXAMPLES)]
    Lines(LinesOptions),
}

pub const LINES_EXAMPLES: &str = "\
Examples:
  splatline-lab lines
  splatline-lab lines --before v0.1.0      at the repository's root";

#[derive(Debug, Args)]
pub struct LinesOptions {
    /// The commit to compare with
    #[arg(long, value_name = "COMMIT", default_value = "HEAD")]
    pub before: String,
}

pub const RESULTS_EXAMPLES: &str = "\
Examples:
  splatline-lab results -o docs/results
  splatline-lab results --only golden -o /tmp/results";
pub const GALLERY_EXAMPLES: &str = "\
Examples:
  splatline-lab gallery all -o docs/gallery
  splatline-lab gallery surface -o docs/gallery/surface
  splatline-lab gallery kernels -o docs/gallery/kernels
  splatline-lab gallery kernels --only antialias -o out

Groups of kernels: shapes, antialias, spheres, hybrid, stamps; of deep: alpha, sheets; of texture: checkerboard, terrain, warp, plane.";

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

#[derive(Debug, Args)]
pub struct ResultsOptions {
    /// Folder of the scenes (with gaussians, volumes and golden in it).
    #[arg(long, value_name = "DIR", default_value = "../shared/data")]
    pub data: PathBuf,
    /// Folder to write the pages to.
    #[arg(short, long, value_name = "DIR", default_value = "docs/results")]
    pub output: PathBuf,
    /// Only the pages named.
    #[arg(long, value_enum, value_name = "PAGE")]
    pub only: Vec<ResultsPage>,
    /// Print the pages again and compare them with those in the folder, timings left out, instead of writing there
    #[arg(long)]
    pub check: bool,
}

/// Pages of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ResultsPage {
    /// Fixed point against float on scenes.
    Accuracy,
    /// One scene in several formats.
    Formats,
    /// Both engines against independent data.
    Golden,
    /// View-dependent colours in fixed point against double precision.
    Colour,
    /// Bit layout of the footprint packet.
    Packet,
    /// Cycles: throughput, designs.
    Hardware,
    /// Every system of the papers: where it is, and its error in its exhibits.
    Systems,
    /// Error against width, stage by stage, with 16-bit floats beside.
    Widths,
    /// Machines of others, where work, bytes and energy go, memory parts.
    Machines,
}
