//! Options of the commands about the machine: model, explore, merge, fit, needs, trace.

use super::drawing_args::WorkOptions;
use super::values::{FAMILIES, METRICS, PictureSize, one_of, positive, shard};
use super::view_args::{MoreScenes, PathOptions, ViewOptions};
use crate::explore::fit::Metric;
use crate::explore::sweep::Shard;
use crate::machine::area::Family;
use clap::Args;
use std::path::PathBuf;

pub const MODEL_EXAMPLES: &str = "\
Examples:
  splatline model guitar.ply
  splatline model guitar.ply --machine machine.toml --set lanes=4 --set layout=rows -o out
  splatline model guitar.ply --machine primitive-4      the raster unit of sim/rtl, with four lanes
  splatline model guitar.ply --set clock_mhz=100 --set overlap_frames=2 --part xc7a100t
      frames a second at that clock, and how much of the part it takes
  splatline model guitar.ply --camera-path keys.toml --size 1920x1080      worst frame, 95th percentile, mean
  splatline model guitar.ply playbot.ply -o out                           the same over several scenes
  splatline model guitar.ply --set memory_part=ddr3-1600-x16 --set clock_mhz=100      a real memory part behind one port
  splatline model guitar.ply --machines                 beside machines of others, reimplemented from their papers
  splatline model --footprints f.csv --screen 512x512
      the workload of another rasterizer; columns as `splatline footprints` writes them, optionally tiles

With -o: timing.json; timing.html with its plots; machine.toml, the resolved configuration; action_counts.yaml, what was done how often, for Accelergy.";

/// Which machine.
#[derive(Debug, Args)]
#[command(next_help_heading = "Machine")]
pub struct MachineOptions {
    /// Machine: primitive-1 to primitive-16 (the circuit of sim/rtl), machine-1 to machine-16 (with setup, sorter and binning before it), or a TOML file; what that leaves out keeps its default
    #[arg(long, value_name = "NAME|file.toml")]
    pub machine: Option<PathBuf>,
    /// Change one field of the machine; may be given more than once
    #[arg(long, value_name = "key=value")]
    pub set: Vec<String>,
}

/// What area is counted in.
#[derive(Debug, Args)]
#[command(next_help_heading = "Area")]
pub struct AreaOptions {
    /// FPGA whose resources the area estimate counts
    #[arg(long, value_parser = one_of(FAMILIES), default_value = "xilinx7")]
    pub family: Family,
    /// Prices of your own (TOML); what the file leaves out is that of its `family`
    #[arg(long, value_name = "file.toml", conflicts_with = "family")]
    pub calibration: Option<PathBuf>,
    /// A part by name, for example xc7a100t: its family, what it holds and what its memory moves; docs/files.md lists them
    #[arg(long, value_name = "NAME", conflicts_with = "family")]
    pub part: Option<String>,
    /// Parts of your own (TOML, as docs/files.md shows), beside those that ship
    #[arg(long, value_name = "file.toml", requires = "part")]
    pub parts: Option<PathBuf>,
}

/// What energy is counted in.
#[derive(Debug, Args)]
#[command(next_help_heading = "Energy")]
pub struct EnergyOptions {
    /// Picojoules of every action (TOML) instead of the 45 nm figures that ship; energy is an estimate, and the report says what it leaves out
    #[arg(long, value_name = "file.toml")]
    pub energy: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct ModelOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    #[command(flatten)]
    pub more: MoreScenes,
    #[command(flatten)]
    pub path: PathOptions,
    /// Footprints of another rasterizer (CSV) instead of a scene
    #[arg(long, value_name = "f.csv", conflicts_with_all = ["scene", "camera_path"])]
    pub footprints: Option<PathBuf>,
    /// With --footprints: size of the screen [default: up to the largest x1 and y1]
    #[arg(long, value_name = "WxH", requires = "footprints")]
    pub screen: Option<PictureSize>,
    /// With --footprints: radial index at which footprints end that have no cut-off in the table
    #[arg(long, value_name = "r", requires = "footprints", value_parser = positive)]
    pub cutoff: Option<f64>,
    #[command(flatten)]
    pub work: WorkOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
    #[command(flatten)]
    pub area: AreaOptions,
    #[command(flatten)]
    pub energy: EnergyOptions,
    /// Compare with machines of others, reimplemented from their papers, on the same splats: pixels tested, products, cycles, bytes, energy
    #[arg(long, conflicts_with_all = ["footprints", "machine", "set", "design", "traversal"])]
    pub machines: bool,
    /// Simulate N times and report the median speed
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeat: u32,
    /// Folder to write timing.json, timing.html, machine.toml and action_counts.yaml into
    #[arg(short, long, value_name = "dir", help_heading = "Output")]
    pub output: Option<PathBuf>,
}

pub const EXPLORE_EXAMPLES: &str = "\
Examples:
  splatline explore guitar.ply --size 1920x1080 --fps 60 --part xc7a100t --max-error 0.004
      the cheapest design and machine that hold all of it, the next three, and what binds
  splatline explore guitar.ply playbot.ply --fps 60 --lut 63000 --dsp 240 --psnr 50 --set clock_mhz=100 -o out
  splatline explore guitar.ply --space space.toml -o out
  splatline explore guitar.ply --space space.toml --shard 3/8 -o out      one of eight machines
  splatline merge out -o out                                              puts the shards together

A space:
  sample = \"grid\"                  # or \"latin\" with count = 200 and seed = 1
  [design]
  base = [\"lean18\", \"standard24\"]
  mantissa = { from = 14, to = 24, step = 2 }
  [machine]
  lanes = [1, 2, 4]
  layout = [\"run\", \"rows\"]

With a limit the space is searched and not swept; without one an interrupted sweep goes on where it stopped. Writes points.csv (or points-3-of-8.csv), and when all points are
there front.csv and front.html.";

#[derive(Debug, Args)]
pub struct ExploreOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    #[command(flatten)]
    pub more: MoreScenes,
    #[command(flatten)]
    pub path: PathOptions,
    #[command(flatten)]
    pub work: WorkOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
    /// Fields and their values (TOML) [with a limit: every width and the usual machines]
    #[arg(long, value_name = "s.toml", required_unless_present = "limits")]
    pub space: Option<PathBuf>,
    #[command(flatten)]
    pub limits: LimitOptions,
    /// Run part i of n only
    #[arg(long, value_name = "i/n", value_parser = shard, default_value = "1/1")]
    pub shard: Shard,
    #[command(flatten)]
    pub area: AreaOptions,
    #[command(flatten)]
    pub energy: EnergyOptions,
    /// Leave the float reference out: cycles and area only
    #[arg(long)]
    pub no_error: bool,
    /// Folder for the results; with a limit: answer.json, design.toml and machine.toml of the answer
    #[arg(
        short,
        long,
        value_name = "dir",
        help_heading = "Output",
        required_unless_present = "limits"
    )]
    pub output: Option<PathBuf>,
}

/// What the answer must hold. With any of these, `explore` searches for the cheapest point instead of sweeping.
#[derive(Debug, Default, Args)]
#[group(id = "limits", multiple = true)]
#[command(
    next_help_heading = "Limits (each asks for the cheapest point that holds them; --part adds what it holds)"
)]
pub struct LimitOptions {
    /// Frames a second at least, of the slowest frame
    #[arg(long, value_name = "N", value_parser = positive)]
    pub fps: Option<f64>,
    /// Largest error of a colour at most, units of 1.0
    #[arg(long, value_name = "E", value_parser = positive)]
    pub max_error: Option<f64>,
    /// PSNR of the colours at least
    #[arg(long, value_name = "dB", value_parser = positive)]
    pub psnr: Option<f64>,
    /// Look-up tables at most
    #[arg(long, value_name = "N")]
    pub lut: Option<u32>,
    /// Multipliers at most
    #[arg(long, value_name = "N")]
    pub dsp: Option<u32>,
    /// Kilobits of block memory at most
    #[arg(long, value_name = "kbit")]
    pub bram: Option<u32>,
    /// What the memory moves, both directions together: the machine's channels are no wider
    #[arg(long, value_name = "MB/s", value_parser = positive)]
    pub bandwidth: Option<f64>,
    /// Energy of the most expensive frame at most; an estimate by --energy's table
    #[arg(long, value_name = "mJ", value_parser = positive)]
    pub max_energy: Option<f64>,
}

#[derive(Debug, Args)]
pub struct MergeOptions {
    /// Folders with points.csv or points-i-of-n.csv of one sweep
    #[arg(value_name = "DIR", required = true)]
    pub folders: Vec<PathBuf>,
    /// Merge although points are missing
    #[arg(long)]
    pub partial: bool,
    /// Folder for points.csv, front.csv and front.html
    #[arg(short, long, value_name = "dir", help_heading = "Output")]
    pub output: PathBuf,
}

pub const FIT_EXAMPLES: &str = "\
Examples:
  splatline fit guitar.ply --max-error 0.004          largest error of any pixel, 1/255
  splatline fit guitar.ply --max-error 1e-3 --metric rms -o fitted.toml
  splatline fit guitar.ply playbot.ply --max-error 0.004      one design for both
  splatline model guitar.ply --design fitted.toml             the design that was found, in any command";

#[derive(Debug, Args)]
pub struct FitOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    #[command(flatten)]
    pub more: MoreScenes,
    #[command(flatten)]
    pub path: PathOptions,
    #[command(flatten)]
    pub work: WorkOptions,
    /// Error that the design may have, colours, in units of 1.0
    #[arg(long, value_name = "E", value_parser = positive)]
    pub max_error: f64,
    /// Which error
    #[arg(long, value_parser = one_of(METRICS), default_value = "largest")]
    pub metric: Metric,
    /// Design file to write
    #[arg(short, long, value_name = "file.toml", help_heading = "Output")]
    pub output: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct NeedsOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    #[command(flatten)]
    pub more: MoreScenes,
    #[command(flatten)]
    pub path: PathOptions,
    #[command(flatten)]
    pub work: WorkOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
    /// Also find the smallest widths within this error (as `splatline fit` does)
    #[arg(long, value_name = "E", value_parser = positive)]
    pub max_error: Option<f64>,
    /// Also write the answer as JSON
    #[arg(long, value_name = "n.json")]
    pub json: Option<PathBuf>,
}

pub const TRACE_EXAMPLES: &str = "\
Examples:
  splatline trace guitar.ply --format kanata --first 100 --last 140 -o trace.kanata      for Konata
  splatline trace guitar.ply --format vcd --set lanes=4 -o trace.vcd                     for GTKWave or Surfer
  splatline trace guitar.ply --format perfetto -o trace.json                             for ui.perfetto.dev
  splatline trace guitar.ply --format dramsim3 --set memory_part=ddr3-1600-x16 --set clock_mhz=100 -o requests.txt
      what a memory is asked for, in the whole picture; --format ramulator2 for Ramulator 2";

#[derive(Debug, Args)]
pub struct TraceOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    #[command(flatten)]
    pub work: WorkOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
    /// Format of the trace
    #[arg(long, value_enum)]
    pub format: TraceFormat,
    /// First splat to record, by its number in the scene
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub first: u32,
    /// Last splat to record [default: 255 after the first]
    #[arg(long, value_name = "N")]
    pub last: Option<u32>,
    /// File to write
    #[arg(short, long, value_name = "file", help_heading = "Output")]
    pub output: PathBuf,
}

/// Formats of traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum TraceFormat {
    /// Konata
    Kanata,
    /// GTKWave, Surfer
    Vcd,
    /// ui.perfetto.dev
    Perfetto,
    /// Requests of the whole picture to the machine's memory part, for Ramulator 2 (LoadStoreTrace)
    Ramulator2,
    /// The same for DRAMsim3
    Dramsim3,
}

pub const MERGE_EXAMPLES: &str = "\
Examples:
  splatline merge out -o out
  splatline merge node1 node2 node3 -o all";

pub const NEEDS_EXAMPLES: &str = "\
Examples:
  splatline needs guitar.ply
  splatline needs guitar.ply --max-error 0.004 --json needs.json
  splatline needs guitar.ply playbot.ply --json needs.json";
