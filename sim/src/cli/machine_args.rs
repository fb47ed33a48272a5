//! Options of the commands about the machine: model, explore, merge, fit, needs, trace.

use super::args::{CompositingChoice, DesignName, Size, TraversalChoice, ViewOptions};
use clap::Args;
use std::path::PathBuf;

pub const MODEL_EXAMPLES: &str = "\
Examples:
  splatline model guitar.ply
  splatline model guitar.ply --machine machine.toml --set lanes=4 --set layout=rows -o out
  splatline model --footprints f.csv --screen 512x512 --cutoff 4
      the workload of another rasterizer; columns as `splatline footprints` writes them, optionally cutoff and tiles

With -o: timing.json and machine.toml, the resolved configuration.";

/// Which machine.
#[derive(Debug, Args)]
pub struct MachineOptions {
    /// Machine (TOML); what it leaves out keeps its default
    #[arg(long, value_name = "file.toml")]
    pub machine: Option<PathBuf>,
    /// Change one field of the machine; may be given more than once
    #[arg(long, value_name = "key=value")]
    pub set: Vec<String>,
}

/// Which pixels, in which order.
#[derive(Debug, Args)]
pub struct WorkOptions {
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
pub struct ModelOptions {
    #[command(flatten)]
    pub view: Option<ViewOptions>,
    /// Footprints of another rasterizer (CSV) instead of a scene
    #[arg(long, value_name = "f.csv", conflicts_with = "scene")]
    pub footprints: Option<PathBuf>,
    /// With --footprints: size of the screen [default: up to the largest x1 and y1]
    #[arg(long, value_name = "WxH", requires = "footprints")]
    pub screen: Option<Size>,
    /// With --footprints: radial index at which a footprint without a cut-off of its own ends
    #[arg(long, value_name = "r", default_value_t = 4.0)]
    pub cutoff: f64,
    #[command(flatten)]
    pub work: WorkOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
    /// Simulate N times and report the median speed
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeat: u32,
    /// Folder to write timing.json and machine.toml into
    #[arg(short, long, value_name = "dir")]
    pub output: Option<PathBuf>,
}
