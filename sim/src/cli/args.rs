//! The options of every command. Names are stable: scripts and notebooks depend on them.

use super::bake;
use super::drawing_args::DrawingOptions;
use super::info;
use super::machine_args;
use super::maps::Map;
use super::page;
use super::photos::Split;
use super::search_args;
use super::shell;
use super::values::design_name;
use super::verification_args;
use super::view_args::{PathOptions, ViewOptions};
use crate::plan::Engine;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  splatline
      the demo: an embedded MR head, five designs against float; writes out/report.html
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
  splatline render dem.csv --as surface --texture dem.jpg -o dem.png      a photograph over a height field
  splatline render guitar.ply --maps depth,normal,count,id -o guitar.exr      guitar.depth.exr and so on beside it
  splatline render demo --sheets image-aligned -o sheets.png      sheet buffers
  splatline render deep-stack --deep-alpha transmittance --alpha-bits 16 -o deep.png
  splatline render random:2000 --spheres exact --sphere-index ray -o spheres.png
  splatline render sphere --as surface --flatten 1024 -o flat.png      volume kernels, thin along the normal
  splatline render checkerboard --as texture --eye 0,-1.5,0.4 --target 0,0,0 --up 0,0,1 -o plane.png
  splatline render hills --as surface --texture checkerboard -o hills.png
  splatline render --plan sim/plans/05-sheets.toml -o sheets.png
  splatline render guitar.ply --camera-path keys.toml --json frames.json -o frames/guitar.png
      a picture a frame: frames/guitar-0001.png and so on, and one report over all
  splatline render guitar.ply --turntable 60 --animation turning.png -o frames/guitar.png
  splatline render scene.ply --camera-path sparse/0 -o frames/scene.png
      frames called after their pictures: frames/scene-IMG_0001.png and so on
  splatline render scene.ply --camera sparse/0 --image IMG_0001.jpg --distort -o scene.png";

const COMPARE_EXAMPLES: &str = "\
Examples:
  splatline compare guitar.ply -o out
  splatline compare guitar.ply --camera camera.json --design lean18 --only -o out
  splatline compare fuel.nhdr --design my_design.toml --repeat 5 --size 800x600 -o out
  splatline compare guitar.ply --engine exact -o out      against the ray integral instead of EWA
  splatline compare lion.ply --as surface -o out          a point cloud as surface splats
  splatline compare guitar.ply --camera-path keys.toml -o out
      every frame in a folder of its own, the chosen design alone, and frames.json and frames.html over all
  splatline compare scene.ply --camera sparse/0 --photos images --formats -o out
      every eighth photograph of a COLMAP model against float, fixed widths and float formats: photos.json and photos.html

Writes fixed.png, float.png, error.png, report.json and report.html.";

const FOOTPRINTS_EXAMPLES: &str = "\
Examples:
  splatline footprints guitar.ply -o footprints.csv
  splatline footprints guitar.ply --engine float --camera camera.json -o reference.csv

Columns: index,u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1,opacity,cutoff; empty fields if the splat is culled.";

/// Fixed-point splatting against a float reference.
///
/// Without a command: the demo, which draws an embedded volume with five designs and writes out/report.html.
#[derive(Debug, Parser)]
#[command(name = "splatline", version, after_help = EXAMPLES)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Most memory to take; what would take more is refused before it begins [default: what the machine, the process's
    /// limits and its control group leave]
    #[arg(long, global = true, value_name = "MB", help_heading = "Limits", value_parser = clap::value_parser!(u64).range(1..))]
    pub memory: Option<u64>,
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
    /// Write a scene for a microcontroller's flash: pruned, 24 bytes a splat, as Rust constants or a file.
    #[command(after_help = bake::EXAMPLES)]
    Bake(bake::BakeOptions),
    /// Write the live page: one HTML file in which a scene can be turned and the kernel's widths changed.
    #[command(after_help = page::EXAMPLES)]
    Page(page::PageOptions),
    /// Kind, count, bounds, directions and ranges of a scene, and what was dropped.
    #[command(after_help = info::EXAMPLES)]
    Info(info::InfoOptions),
    /// Simulate a scene on a machine: cycles, memory traffic, energy and area.
    #[command(alias = "model", after_help = machine_args::MODEL_EXAMPLES)]
    Simulate(machine_args::ModelOptions),
    /// Sweep designs and machines; Pareto front of error, cycles, area and energy.
    #[command(after_help = search_args::SWEEP_EXAMPLES)]
    Sweep(search_args::SweepOptions),
    /// Find the cheapest design and machine that hold limits on speed, error, area, memory and energy.
    #[command(after_help = search_args::OPTIMIZE_EXAMPLES)]
    Optimize(search_args::OptimizeOptions),
    /// Find the smallest design within an error budget.
    #[command(after_help = search_args::FIT_EXAMPLES)]
    Fit(search_args::FitOptions),
    /// Report which units, ranges, widths and FIFO depths a scene exercises.
    #[command(alias = "needs", after_help = search_args::PROFILE_EXAMPLES)]
    Profile(search_args::ProfileOptions),
    /// Write the raster phase cycle by cycle for a trace viewer.
    #[command(after_help = machine_args::TRACE_EXAMPLES)]
    Trace(machine_args::TraceOptions),
    /// Measure every stage on hard cases, against exact arithmetic and single precision.
    #[command(after_help = verification_args::STABILITY_EXAMPLES)]
    Stability(verification_args::StabilityOptions),
    /// Print a script by which a shell completes commands and options.
    #[command(after_help = shell::COMPLETIONS_EXAMPLES)]
    Completions(shell::CompletionsOptions),
    /// Write manual pages.
    #[command(after_help = shell::MAN_EXAMPLES)]
    Man(shell::ManOptions),
    /// Test vectors for every stage boundary: write them, or check someone else's against the kernel.
    #[command(after_help = verification_args::VECTORS_EXAMPLES)]
    Vectors {
        #[command(subcommand)]
        action: verification_args::VectorsAction,
    },
}

#[derive(Debug, Args)]
pub struct RenderOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    #[command(flatten)]
    pub path: PathOptions,
    #[command(flatten)]
    pub drawing: DrawingOptions,
    /// Picture to write: .png, or .npy (height x width x 4 doubles) or .exr, both premultiplied; - writes a PNG to
    /// stdout
    #[arg(short, long, value_name = "x.png", help_heading = "Output")]
    pub output: PathBuf,
    /// Also write maps beside the picture, in its format, in double precision: depth, alpha, normal, count, first, id
    #[arg(
        long,
        value_name = "LIST",
        help_heading = "Output",
        value_enum,
        value_delimiter = ',',
        hide_possible_values = true,
        conflicts_with_all = ["camera_path", "turntable"]
    )]
    pub maps: Vec<Map>,
    /// Also write all frames as one animated PNG, 15 a second
    #[arg(long, value_name = "x.png", help_heading = "Output")]
    pub animation: Option<PathBuf>,
    /// Draw through the lens of --camera, as its photographs are
    #[arg(long, help_heading = "Camera", requires = "camera", conflicts_with_all = ["maps", "zoom"])]
    pub distort: bool,
}

#[derive(Debug, Args)]
pub struct CompareOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    #[command(flatten)]
    pub path: PathOptions,
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
    /// Also draw in fp32, fp16, bfloat16, fp8 and mixes of fp8 and fp16, every operation rounded, and report how far
    /// each is from the reference
    #[arg(long)]
    pub formats: bool,
    #[command(flatten)]
    pub photographs: PhotoArgs,
}

/// What is drawn against photographs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Photographs")]
pub struct PhotoArgs {
    /// Photographs (.png, .jpg) of the views of --camera: PSNR, SSIM and FLIP of what is drawn against them
    #[arg(long, value_name = "DIR", conflicts_with_all = ["from", "turntable"])]
    pub photos: Option<PathBuf>,
    /// Views that are compared: test (every eighth), train (the others), all, or N for every Nth
    #[arg(
        long,
        value_name = "WHICH",
        default_value = "test",
        requires = "photos"
    )]
    pub split: Split,
    /// Masks of the photographs: what is black in them counts in none of the pictures
    #[arg(long, value_name = "DIR", requires = "photos")]
    pub masks: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct FootprintsOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    /// Who computes the footprints: fixed or float
    #[arg(long, value_enum, default_value = "fixed", conflicts_with = "from")]
    pub engine: Engine,
    /// Widths: classic8, micro16, lean18, standard24, deep32 or a TOML file
    #[arg(
        long,
        value_name = "NAME|file.toml",
        default_value = "standard24",
        value_parser = design_name,
        conflicts_with = "from"
    )]
    pub design: String,
    /// CSV file to write; - is stdout
    #[arg(short, long, value_name = "f.csv", help_heading = "Output")]
    pub output: PathBuf,
}
