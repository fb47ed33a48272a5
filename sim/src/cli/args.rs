//! The options of every command. Names are stable: scripts and notebooks depend on them.

use super::info;
use super::machine_args;
use super::output;
use super::page;
use super::shell;
use super::study_args;
pub use super::view_args::*;
use crate::design;
use crate::hybrid::Points;
use crate::picture::{Backdrop, Depth};
use crate::rules::Compositing;
use crate::surface::LAYERS;
use crate::texture::coefficients::Method;
use clap::{Args, Parser, Subcommand, ValueEnum};
use splatline::format::Traversal;
use std::path::PathBuf;
use std::str::FromStr;

const EXAMPLES: &str = "\
Examples:
  splatline
      the demo: an embedded MR head, four designs against float; writes out/report.html
  splatline render guitar.ply --eye 5.5,-2.1,0.2 --target 0.1,-2.1,0.1 --up 0,-1,0 -o guitar.png
      one picture through the fixed-point kernel
  splatline compare guitar.ply --camera camera.json -o out
      pictures, error map and a report of speed against error
  splatline footprints guitar.ply -o footprints.csv
      where every splat lands, for use elsewhere

Exit codes: 0, 1 for bad input, 2 for bad usage.";

const RENDER_EXAMPLES: &str = "\
Examples:
  splatline render guitar.splat -o guitar.png
  splatline render guitar.ply --camera camera.json --design lean18 --traversal box -o guitar.png
  splatline render aneurism.nhdr --rules ewa --engine float --depth 16 --size 1024x1024 -o aneurism.png
  splatline render guitar.ply --eye -1,2,3 --target 0,0,0 --fov 50 --repeat 5 --json times.json -o guitar.png
  splatline render lion.ply --as surface --light 1,0,1 --layers 4 --edges -o lion.png      a point cloud
  splatline render dem.csv --as surface --texture dem.jpg -o dem.png      a photograph over a height field";

const COMPARE_EXAMPLES: &str = "\
Examples:
  splatline compare guitar.ply -o out
  splatline compare guitar.ply --camera camera.json --design lean18 --only -o out
  splatline compare fuel.nhdr --design my_design.toml --repeat 5 --size 800x600 -o out
  splatline compare guitar.ply --engine exact -o out      against the ray integral instead of EWA
  splatline compare lion.ply --as surface -o out          a point cloud as surface splats

Writes fixed.png, float.png, error.png, report.json and report.html.";

const FOOTPRINTS_EXAMPLES: &str = "\
Examples:
  splatline footprints guitar.ply -o footprints.csv
  splatline footprints guitar.ply --engine float --camera camera.json -o reference.csv

Columns: index,u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1,cutoff; empty fields if the splat is culled.";

/// Fixed-point splatting against a float reference.
///
/// Without a command: the demo, which draws an embedded volume with four designs and writes out/report.html.
#[derive(Debug, Parser)]
#[command(name = "splatline", version, after_help = EXAMPLES)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw a scene into a picture.
    #[command(after_help = RENDER_EXAMPLES)]
    Render(RenderOptions),
    /// Draw a scene in fixed point and in floating point and report speed against error.
    #[command(after_help = COMPARE_EXAMPLES)]
    Compare(CompareOptions),
    /// Write where every splat lands as CSV.
    #[command(after_help = FOOTPRINTS_EXAMPLES)]
    Footprints(FootprintsOptions),
    /// Write the live page: one HTML file in which a scene can be turned and the kernel's widths changed.
    #[command(after_help = page::EXAMPLES)]
    Page(page::PageOptions),
    /// Kind, count, bounds, directions and ranges of a scene, and what was dropped.
    #[command(after_help = info::EXAMPLES)]
    Info(info::InfoOptions),
    /// Cycles of a scene on a machine.
    #[command(after_help = machine_args::MODEL_EXAMPLES)]
    Model(machine_args::ModelOptions),
    /// Sweep designs and machines; Pareto front of error, cycles and area.
    #[command(after_help = machine_args::EXPLORE_EXAMPLES)]
    Explore(machine_args::ExploreOptions),
    /// Put the shards of a sweep together.
    #[command(after_help = machine_args::MERGE_EXAMPLES)]
    Merge(machine_args::MergeOptions),
    /// Find the smallest design within an error budget.
    #[command(after_help = machine_args::FIT_EXAMPLES)]
    Fit(machine_args::FitOptions),
    /// Report which units, ranges, widths and FIFO depths a scene exercises.
    #[command(after_help = machine_args::NEEDS_EXAMPLES)]
    Needs(machine_args::NeedsOptions),
    /// Write the raster phase cycle by cycle for a trace viewer.
    #[command(after_help = machine_args::TRACE_EXAMPLES)]
    Trace(machine_args::TraceOptions),
    /// Measure every stage on hard cases, against exact arithmetic and single precision.
    #[command(after_help = study_args::STABILITY_EXAMPLES)]
    Stability(study_args::StabilityOptions),
    /// Print a script by which a shell completes commands and options.
    #[command(after_help = shell::COMPLETIONS_EXAMPLES)]
    Completions(shell::CompletionsOptions),
    /// Write manual pages.
    #[command(after_help = shell::MAN_EXAMPLES)]
    Man(shell::ManOptions),
    /// Test vectors for every stage boundary: write them, or check someone else's against the kernel.
    #[command(after_help = study_args::VECTORS_EXAMPLES)]
    Vectors {
        #[command(subcommand)]
        action: study_args::VectorsAction,
    },
}

#[derive(Debug, Args)]
pub struct RenderOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    #[command(flatten)]
    pub surface: SurfaceOptions,
    #[command(flatten)]
    pub drawing: DrawingOptions,
    /// Picture to write: .png, or .npy (height x width x 4 doubles) or .exr, both premultiplied; - writes a PNG to stdout
    #[arg(short, long, value_name = "x.png", help_heading = "Output")]
    pub output: PathBuf,
}

#[derive(Debug, Args)]
pub struct CompareOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    #[command(flatten)]
    pub surface: SurfaceOptions,
    #[command(flatten)]
    pub drawing: DrawingOptions,
    #[command(flatten)]
    pub machine: machine_args::MachineOptions,
    /// Folder to write fixed.png, float.png, error.png, report.json and report.html into
    #[arg(short, long, value_name = "dir", help_heading = "Output")]
    pub output: PathBuf,
    /// Draw the chosen design only, instead of all named designs by both traversals
    #[arg(long)]
    pub only: bool,
}

#[derive(Debug, Args)]
pub struct FootprintsOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    /// Who computes the footprints: fixed or float
    #[arg(long, value_enum, default_value = "fixed")]
    pub engine: Engine,
    /// Widths: classic8, lean18, standard24, deep32 or a TOML file
    #[arg(long, value_name = "NAME|file.toml", default_value = "standard24")]
    pub design: DesignName,
    /// CSV file to write; - is stdout
    #[arg(short, long, value_name = "f.csv", help_heading = "Output")]
    pub output: PathBuf,
}

/// How a point cloud is drawn as a surface.
#[derive(Debug, Args)]
#[command(next_help_heading = "Surfaces")]
pub struct SurfaceOptions {
    /// What the scene's points are: `surface` draws a .ply or .xyz cloud or a height field (.csv) as surface splats
    #[arg(long = "as", value_name = "surface", value_enum)]
    pub kind: Option<SceneKind>,
    /// Layers of a pixel (1, 2, 3, 4 or 8), for semi-transparent surfaces and antialiased edges [default: one opaque surface]
    #[arg(long, value_name = "N", value_parser = layers, requires = "kind")]
    pub layers: Option<usize>,
    /// Depths closer than this are one surface, scene units [default: three radii]
    #[arg(long, value_name = "Z", value_parser = positive, requires = "kind")]
    pub z_threshold: Option<f64>,
    /// Antialias edges by the weight sum
    #[arg(long, requires = "kind")]
    pub edges: bool,
    /// Photograph (.png, .jpg) over a height field, north up
    #[arg(long, value_name = "photo.jpg", requires = "kind")]
    pub texture: Option<PathBuf>,
    /// How points get their colours from the texture: plain, prefiltered or optimised
    #[arg(long, value_name = "METHOD", default_value = "optimised", value_parser = Method::from_str, requires = "texture")]
    pub coefficients: Method,
    /// Distance of neighbouring heights of a height field, in units of height [default: 0.1]
    #[arg(long, value_name = "D", value_parser = positive, requires = "kind")]
    pub spacing: Option<f64>,
    /// Leaves out points that face away from the eye [default: auto; on if nothing follows]
    #[arg(long, value_enum, value_name = "WHEN", num_args = 0..=1, require_equals = true, default_value = "auto", default_missing_value = "on", hide_default_value = true, requires = "kind")]
    pub cull_backfaces: Backfaces,
    /// The same as --cull-backfaces=off
    #[arg(long, requires = "kind", conflicts_with = "cull_backfaces")]
    pub no_cull_backfaces: bool,
}

impl SurfaceOptions {
    /// Whether backs are left out, from both options.
    pub fn backfaces(&self) -> Backfaces {
        match self.no_cull_backfaces {
            true => Backfaces::Off,
            false => self.cull_backfaces,
        }
    }
}

/// When points that face away are left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backfaces {
    /// On clouds of closed surfaces whose normals point outwards
    Auto,
    /// Always
    On,
    /// Never: they are turned towards the eye
    Off,
}

/// What the points of a scene are taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SceneKind {
    /// Points of a surface
    Surface,
}

/// By what and how often it is drawn.
#[derive(Debug, Args)]
#[command(next_help_heading = "Drawing")]
pub struct DrawingOptions {
    /// fixed: the kernel; float: EWA in double precision; exact: the ray integral. `compare` always draws fixed, and
    /// against float unless this says exact
    #[arg(long, value_enum, default_value = "fixed")]
    pub engine: Engine,
    /// Widths: classic8, lean18, standard24, deep32 or a TOML file
    #[arg(long, value_name = "NAME|file.toml", default_value = "standard24")]
    pub design: DesignName,
    /// How a footprint's pixels are walked [default: the design's own]
    #[arg(long, value_enum)]
    pub traversal: Option<TraversalChoice>,
    /// Which samples of a volume become points, gathered in depth ranges; needs --antialias swan
    #[arg(long, value_enum)]
    pub points: Option<PointsChoice>,
    /// Phases per pixel and axis of --traversal stamp, as a power of two
    #[arg(long, value_name = "N", default_value = "3", value_parser = clap::value_parser!(u8).range(0..=6))]
    pub phase_bits: u8,
    /// Order and operator of blending
    #[arg(long, value_enum, default_value = "front-to-back")]
    pub compositing: CompositingChoice,
    /// Bits per channel of the PNG files
    #[arg(long, value_name = "8|16", help_heading = "Output", default_value = "8", value_parser = depth)]
    pub depth: Depth,
    /// Colour behind the picture in PNG files: black, white, #rrggbb or three numbers from 0 to 1 [default: black]
    #[arg(long, value_name = "COLOUR", help_heading = "Output", value_parser = colour)]
    pub background: Option<Colour>,
    /// PNG files with straight alpha instead of a background
    #[arg(long, help_heading = "Output", conflicts_with = "background")]
    pub alpha: bool,
    /// Threads [default: all processors]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    pub threads: Option<usize>,
    /// Draw N times and report median times
    #[arg(long, value_name = "N", default_value = "1", value_parser = at_least_one)]
    pub repeat: usize,
    /// Also write the report as JSON to this file; - is stdout
    #[arg(long, value_name = "r.json", help_heading = "Output")]
    pub json: Option<PathBuf>,
}

impl SurfaceOptions {
    /// The files that are read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        output::files([self.texture.as_ref()])
    }
}

impl DrawingOptions {
    /// What PNG files show behind the picture.
    pub fn backdrop(&self) -> Backdrop {
        match (self.alpha, self.background) {
            (true, _) => Backdrop::Transparent,
            (false, Some(Colour(colour))) => Backdrop::Colour(colour),
            (false, None) => Backdrop::default(),
        }
    }

    /// The files that are read.
    pub fn inputs(&self) -> Option<PathBuf> {
        output::design_file(&self.design)
    }
}

/// Who draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Engine {
    /// The fixed-point kernel
    Fixed,
    /// EWA in double precision
    Float,
    /// The ray integral in double precision, without the affine approximation
    Exact,
}

impl Engine {
    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Engine::Fixed => "fixed",
            Engine::Float => "float",
            Engine::Exact => "exact",
        }
    }
}

/// How the kernel walks a footprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TraversalChoice {
    /// Every pixel of the bounding box, as in the papers
    Box,
    /// Only the pixels of each row inside the ellipse
    Spans,
    /// Samples closer together than pixels by copying a precomputed footprint, others by spans; needs --antialias swan
    Stamp,
}

/// Which samples become points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PointsChoice {
    /// Those closer together than pixels
    Auto,
    /// All
    All,
    /// None
    None,
}

impl From<PointsChoice> for Points {
    fn from(choice: PointsChoice) -> Self {
        match choice {
            PointsChoice::Auto => Points::Auto,
            PointsChoice::All => Points::All,
            PointsChoice::None => Points::None,
        }
    }
}

impl From<TraversalChoice> for Traversal {
    fn from(choice: TraversalChoice) -> Self {
        match choice {
            TraversalChoice::Box => Traversal::Box,
            // Beyond the points, stamped drawings walk spans.
            TraversalChoice::Spans | TraversalChoice::Stamp => Traversal::Spans,
        }
    }
}

/// Order and operator of blending.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CompositingChoice {
    /// Nearest splat first, finished pixels skip the rest
    FrontToBack,
    /// Farthest splat first
    BackToFront,
    /// Plain summation
    #[value(name = "x-ray")]
    XRay,
}

impl From<CompositingChoice> for Compositing {
    fn from(choice: CompositingChoice) -> Self {
        match choice {
            CompositingChoice::FrontToBack => Compositing::FrontToBack,
            CompositingChoice::BackToFront => Compositing::BackToFront,
            CompositingChoice::XRay => Compositing::XRay,
        }
    }
}

/// The name of a design, or of a TOML file that holds one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DesignName(pub String);

impl FromStr for DesignName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if design::NAMES.contains(&text) || text.ends_with(".toml") {
            return Ok(DesignName(text.to_owned()));
        }
        Err(format!(
            "expected one of {} or a file that ends in .toml",
            design::NAMES.join(", ")
        ))
    }
}

/// Red, green and blue, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour(pub [f64; 3]);

fn colour(text: &str) -> Result<Colour, String> {
    let expected =
        "expected black, white, #rrggbb or three numbers from 0 to 1, for example 1,0.5,0";
    if let Some(digits) = text.strip_prefix('#') {
        let value = u32::from_str_radix(digits, 16)
            .ok()
            .filter(|_| digits.len() == 6);
        let value = value.ok_or(expected)?;
        return Ok(Colour(
            [16, 8, 0].map(|shift| f64::from((value >> shift) & 255) / 255.0),
        ));
    }
    match text {
        "black" => Ok(Colour([0.0; 3])),
        "white" => Ok(Colour([1.0; 3])),
        _ => match text.parse() {
            Ok(Vector(parts)) if parts.iter().all(|part| (0.0..=1.0).contains(part)) => {
                Ok(Colour(parts))
            }
            _ => Err(expected.to_owned()),
        },
    }
}

pub fn number(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if f64::is_finite(value) => Ok(value),
        _ => Err(format!("'{text}' is not a finite number")),
    }
}

fn layers(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if LAYERS.contains(&count) => Ok(count),
        _ => Err(format!(
            "expected one of {}",
            LAYERS.map(|count| count.to_string()).join(", ")
        )),
    }
}

pub fn positive(text: &str) -> Result<f64, String> {
    match number(text)? {
        value if value > 0.0 => Ok(value),
        _ => Err("must be larger than 0".to_owned()),
    }
}

fn depth(text: &str) -> Result<Depth, String> {
    match text {
        "8" => Ok(Depth::Eight),
        "16" => Ok(Depth::Sixteen),
        _ => Err("expected 8 or 16".to_owned()),
    }
}

/// Counts of threads and runs; the upper bound keeps a slip of the finger from asking for a million threads.
fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if (1..=1024).contains(&count) => Ok(count),
        _ => Err("expected a whole number from 1 to 1024".to_owned()),
    }
}
