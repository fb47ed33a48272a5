//! Options of the commands about one machine, simulate and trace, and what every command says of a machine.

use super::drawing_args::{FrameOptions, WorkOptions};
use super::resolve::PlanRequest;
use super::values::{FAMILIES, one_of, positive, size};
use super::view_args::{ViewOptions, of_units};
use crate::machine::area::Family;
use clap::Args;
use std::path::PathBuf;

/// Which machine.
#[derive(Debug, Args)]
#[command(next_help_heading = "Machine")]
pub struct MachineOptions {
    /// Machine: primitive-1 to primitive-16 (the circuit of sim/rtl), machine-1 to machine-16 (with setup, sorter and
    /// binning before it), or a TOML file; what that leaves out keeps its default
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
    /// A part by name, for example xc7a100t: its family, what it holds and what its memory moves; docs/files.md lists
    /// them
    #[arg(long, value_name = "NAME", conflicts_with = "family")]
    pub part: Option<String>,
    /// Parts of your own (TOML, as docs/files.md shows), beside those that ship
    #[arg(long, value_name = "file.toml", requires = "part")]
    pub parts: Option<PathBuf>,
}

/// What is drawn, on which machine it is simulated, and what that takes.
#[derive(Debug, Args)]
pub struct SimulationOptions {
    #[command(flatten)]
    pub frames: FrameOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
    #[command(flatten)]
    pub area: AreaOptions,
    /// Picojoules of every action (TOML) instead of the 45 nm figures that ship; energy is an estimate, and the report
    /// says what it leaves out
    #[arg(long, value_name = "file.toml", help_heading = "Energy")]
    pub energy: Option<PathBuf>,
}

impl SimulationOptions {
    /// What they ask of units that draw affine footprints one by one.
    pub fn request(&self) -> PlanRequest<'_> {
        PlanRequest::of_frames(&self.frames)
            .on(&self.machine)
            .by_units()
    }
}

#[derive(Debug, Args)]
#[command(mut_args(of_units))]
pub struct ModelOptions {
    #[command(flatten)]
    pub simulation: SimulationOptions,
    /// Footprints of another rasterizer (CSV) instead of a scene
    #[arg(long, help_heading = "Surfaces", value_name = "f.csv", conflicts_with_all = ["scene", "camera_path", "turntable"])]
    pub footprints: Option<PathBuf>,
    /// With --footprints: size of the screen [default: up to the largest x1 and y1]
    #[arg(long, help_heading = "Surfaces", value_name = "WxH", value_parser = size, requires = "footprints")]
    pub screen: Option<[usize; 2]>,
    /// With --footprints: radial index at which footprints end that have no cut-off in the table
    #[arg(long, help_heading = "Surfaces", value_name = "r", requires = "footprints", value_parser = positive)]
    pub cutoff: Option<f64>,
    /// Compare with machines of others, reimplemented from their papers, on the same splats: pixels tested, products,
    /// cycles, bytes, energy
    #[arg(long, help_heading = "Machine", conflicts_with_all = ["footprints", "machine", "set", "design", "traversal"])]
    pub machines: bool,
    /// Folder to write timing.json, timing.html, machine.toml and action_counts.yaml into
    #[arg(short, long, value_name = "dir", help_heading = "Output")]
    pub output: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(mut_args(of_units))]
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
