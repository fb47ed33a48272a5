//! The options of the commands that study the kernel: `gallery`, `results`, `stability`, `vectors`.

use super::args::{CompositingChoice, DesignName, Size, TraversalChoice};
use clap::{Args, Subcommand, ValueEnum};
use splatline_sim::rules::Rules;
use std::path::PathBuf;
use std::str::FromStr;

pub const RESULTS_EXAMPLES: &str = "\
Examples:
  splatline results --data ../shared/data -o docs/results
  splatline results --data ../shared/data --only golden -o /tmp/results";
pub const VECTORS_EXAMPLES: &str = "\
Examples:
  splatline vectors export out/vectors --design lean18
  splatline vectors export out/guitar --scene guitar.ply --splats 1000 --size 256x256
  splatline vectors verify out/vectors      after a bench has written its own runs.hex, pixels.hex or tile.hex there";
pub const GALLERY_EXAMPLES: &str = "\
Examples:
  splatline gallery all -o docs/gallery
  splatline gallery surface -o docs/gallery/surface
  splatline gallery kernels -o docs/gallery/kernels
  splatline gallery kernels --only antialias -o out

Groups of kernels: shapes, antialias, spheres, hybrid, stamps; of deep: alpha, sheets; of texture: checkerboard, terrain, warp, plane.";

#[derive(Debug, Subcommand)]
pub enum VectorsAction {
    /// Write one $readmemh file per stage and manifest.json.
    Export(VectorsExportOptions),
    /// Compute everything anew from DIR's splats and name the first difference; stages without a file are left out.
    Verify {
        /// Folder with manifest.json, splats.hex and the stages to check
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
}

#[derive(Debug, Args)]
pub struct VectorsExportOptions {
    /// Folder to write into
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Scene to take the first splats of, seen whole [default: built-in random splats and hard cases]
    #[arg(long, value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// Splats at most
    #[arg(long, value_name = "N", default_value = "144")]
    pub splats: usize,
    /// Seed of the built-in splats
    #[arg(long, value_name = "N", default_value = "1", conflicts_with = "scene")]
    pub seed: u32,
    /// Size of the picture
    #[arg(long, value_name = "WxH", default_value = "96x64")]
    pub size: Size,
    /// Rules of blending: ewa or 3dgs [default: the scene's, 3dgs for the built-in splats]
    #[arg(long, value_name = "ewa|3dgs", value_parser = Rules::from_str)]
    pub rules: Option<Rules>,
    /// Widths: classic8, lean18, standard24, deep32 or a TOML file
    #[arg(long, value_name = "NAME|file.toml", default_value = "standard24")]
    pub design: DesignName,
    /// How a footprint's pixels are walked [default: the design's own]
    #[arg(long, value_enum)]
    pub traversal: Option<TraversalChoice>,
    /// Order and operator of blending
    #[arg(long, value_enum, default_value = "front-to-back")]
    pub compositing: CompositingChoice,
}

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

pub const STABILITY_EXAMPLES: &str = "\
Examples:
  splatline stability
  splatline stability --markdown docs/stability.md
  splatline stability --quick --json stability.json";

#[derive(Debug, Args)]
pub struct StabilityOptions {
    /// A short stack of splats instead of 100,000, and small scenes
    #[arg(long)]
    pub quick: bool,
    /// Only the sections named
    #[arg(long, value_enum, value_name = "SECTION")]
    pub only: Vec<StabilitySection>,
    /// Seed of the scenes
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// JSON file to write as well
    #[arg(long, value_name = "s.json")]
    pub json: Option<PathBuf>,
    /// Markdown page to write; the summary alone is then printed
    #[arg(long, value_name = "s.md")]
    pub markdown: Option<PathBuf>,
}

/// Sections of the stability suite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StabilitySection {
    /// Sixteen splats a case, stage by stage, against exact arithmetic.
    Cases,
    /// Whole scenes of the kinds that people have.
    Scenes,
}

#[derive(Debug, Args)]
pub struct ResultsOptions {
    /// Folder of the scenes (with gaussians, volumes and golden in it).
    #[arg(long, value_name = "DIR")]
    pub data: PathBuf,
    /// Folder to write the pages to.
    #[arg(short, long, value_name = "DIR", default_value = "docs/results")]
    pub output: PathBuf,
    /// Only the pages named.
    #[arg(long, value_enum, value_name = "PAGE")]
    pub only: Vec<ResultsPage>,
}

/// Pages of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ResultsPage {
    /// Fixed point against float on scenes.
    Accuracy,
    /// Both engines against independent data.
    Golden,
    /// Bit layout of the footprint packet.
    Packet,
    /// Cycles: throughput, designs.
    Hardware,
    /// Cycles and area of lane layouts.
    Layouts,
    /// How fast the kernel draws on the host, against single-precision rasterizers.
    Host,
    /// How fast comparing, sweeping and simulating are.
    Speed,
    /// Every system of the papers: where it is, and its error in its exhibits.
    Systems,
}
