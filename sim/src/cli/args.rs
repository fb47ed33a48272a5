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

/// Fixed-point splatting against a float reference.
///
/// Without a command: the demo, which draws an embedded volume with five designs and writes out/report.html.
#[derive(Debug, Parser)]
#[command(name = "splatline", version, after_help = include_str!("help/splatline.txt"))]
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
    #[command(after_help = include_str!("help/render.txt"))]
    Render(RenderOptions),
    /// Draw a scene in fixed point and in floating point and report speed against error.
    #[command(after_help = include_str!("help/compare.txt"))]
    Compare(CompareOptions),
    /// Write where every splat lands as CSV.
    #[command(after_help = include_str!("help/footprints.txt"))]
    Footprints(FootprintsOptions),
    /// Write a scene for a microcontroller's flash: pruned, 24 bytes a splat, as Rust constants or a file.
    #[command(after_help = include_str!("help/bake.txt"))]
    Bake(bake::BakeOptions),
    /// Write the live page: one HTML file in which a scene can be turned and the kernel's widths changed.
    #[command(after_help = include_str!("help/page.txt"))]
    Page(page::PageOptions),
    /// Kind, count, bounds, directions and ranges of a scene, and what was dropped.
    #[command(after_help = include_str!("help/info.txt"))]
    Info(info::InfoOptions),
    /// Simulate a scene on a machine: cycles, memory traffic, energy and area.
    #[command(alias = "model", after_help = include_str!("help/simulate.txt"))]
    Simulate(machine_args::ModelOptions),
    /// Sweep designs and machines; Pareto front of error, cycles, area and energy.
    #[command(after_help = include_str!("help/sweep.txt"))]
    Sweep(search_args::SweepOptions),
    /// Find the cheapest design and machine that hold limits on speed, error, area, memory and energy.
    #[command(after_help = include_str!("help/optimize.txt"))]
    Optimize(search_args::OptimizeOptions),
    /// Find the smallest design within an error budget.
    #[command(after_help = include_str!("help/fit.txt"))]
    Fit(search_args::FitOptions),
    /// Report which units, ranges, widths and FIFO depths a scene exercises.
    #[command(alias = "needs", after_help = include_str!("help/profile.txt"))]
    Profile(search_args::ProfileOptions),
    /// Write the raster phase cycle by cycle for a trace viewer.
    #[command(after_help = include_str!("help/trace.txt"))]
    Trace(machine_args::TraceOptions),
    /// Measure every stage on hard cases, against exact arithmetic and single precision.
    #[command(after_help = include_str!("help/stability.txt"))]
    Stability(verification_args::StabilityOptions),
    /// Print a script by which a shell completes commands and options.
    #[command(after_help = include_str!("help/completions.txt"))]
    Completions(shell::CompletionsOptions),
    /// Write manual pages.
    #[command(after_help = include_str!("help/man.txt"))]
    Man(shell::ManOptions),
    /// Test vectors for every stage boundary: write them, or check someone else's against the kernel.
    #[command(after_help = include_str!("help/vectors.txt"))]
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
    #[arg(
        long,
        value_name = "x.png",
        help_heading = "Output",
        requires = "PathOptions"
    )]
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
    #[arg(long, value_name = "DIR", conflicts_with_all = ["from", "turntable", "alpha"])]
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
