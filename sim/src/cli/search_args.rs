//! Options of the commands that search designs and machines: sweep, optimize, fit, profile.

use super::drawing_args::FrameOptions;
use super::machine_args::{MachineOptions, SimulationOptions};
use super::resolve::{COMPARED, HELD_PIXEL_BYTES, NamedFrame, prices, room_for_picture};
use super::say::warn;
use super::values::{METRICS, format, one_of, positive};
use super::view_args::of_units;
use crate::explore::limits::{Limit, Quantity};
use crate::explore::subject::Subject;
use crate::plan::Engine;
use anyhow::Result;
use clap::{ArgGroup, Args};
use splatline::format::Traversal;
use std::path::PathBuf;
use std::sync::Arc;

impl SimulationOptions {
    /// What is explored, without references.
    pub fn subject(&self, frames: Vec<NamedFrame>) -> Result<Subject> {
        for frame in &frames {
            warn(&frame.prepared.setup_warnings()?);
        }
        let mut subject = subject(frames)?;
        for frame in &subject.frames {
            frame.check_machine(&subject.machine)?;
        }
        // What nobody asked for, each design of a space decides.
        let recorded = subject.frames[0].plan.entry.traversal;
        let recorded = self.frames.view.from.as_ref().map(|_| recorded);
        subject.traversal = self.frames.work.traversal.map(Traversal::from).or(recorded);
        let prices = prices(self)?;
        (subject.calibration, subject.energy) = (prices.calibration, prices.energy);
        Ok(subject)
    }
}

/// What is explored of these frames, whatever they are of.
pub fn subject(frames: Vec<NamedFrame>) -> Result<Subject> {
    let prepared = frames.into_iter().map(|frame| Arc::new(frame.prepared));
    Subject::new(prepared.collect())
}

/// Draws a subject's references if there is memory for all of them.
pub fn draw_references(subject: &mut Subject) -> Result<()> {
    let bytes = COMPARED + HELD_PIXEL_BYTES * (subject.frames.len() as u64 - 1);
    for frame in &subject.frames {
        room_for_picture(&frame.plan.camera, bytes)?;
    }
    subject.draw_references()
}

/// A limit that may be asked for: its quantity, its bound and the option's name.
pub type Asked = (Quantity, Option<f64>, &'static str);

/// The limits that are asked for.
pub fn limits_given(options: impl IntoIterator<Item = Asked>) -> Vec<Limit> {
    let limit = |(quantity, bound, of): Asked| Some(Limit::new(quantity, bound?, of));
    options.into_iter().filter_map(limit).collect()
}

#[derive(Debug, Args)]
#[command(mut_args(of_units))]
pub struct SweepOptions {
    #[command(flatten)]
    pub search: SimulationOptions,
    /// Fields and their values (TOML)
    #[arg(long, value_name = "s.toml", help_heading = "Space")]
    pub space: PathBuf,
    /// Leave the float reference out: cycles and area only
    #[arg(long, help_heading = "Space")]
    pub no_error: bool,
    /// Folder for the results
    #[arg(short, long, value_name = "dir", help_heading = "Output")]
    pub output: PathBuf,
}

#[derive(Debug, Args)]
#[command(mut_args(of_units))]
pub struct OptimizeOptions {
    #[command(flatten)]
    pub search: SimulationOptions,
    /// Fields and their values (TOML) [default: every width and the usual machines]
    #[arg(long, value_name = "s.toml", help_heading = "Space")]
    pub space: Option<PathBuf>,
    #[command(flatten)]
    pub limits: LimitOptions,
    #[command(flatten)]
    pub formats: FormatOptions,
    /// Folder for answer.html, answer.json, and design.toml and machine.toml of the answer
    #[arg(short, long, value_name = "dir", help_heading = "Output")]
    pub output: Option<PathBuf>,
}

/// What stands beside the answer.
#[derive(Debug, Default, Args)]
pub struct FormatOptions {
    /// Floating-point formats beside the fixed design, with error, area and energy: fp32, fp16, bfloat16, fp8-fp16,
    /// e5m2-fp16, fp8
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', value_parser = format())]
    pub formats: Vec<Engine>,
}

/// The group of all limits.
pub const LIMITS: &str = "limits";

/// What the pictures must hold.
#[derive(Debug, Default, Args)]
pub struct ErrorLimits {
    /// Largest error of a colour at most, units of 1.0
    #[arg(long, value_name = "E", value_parser = positive, group = LIMITS)]
    pub max_error: Option<f64>,
    /// Error that 99 % of the samples of colours do not exceed, in the worst frame, units of 1.0
    #[arg(long, value_name = "E", value_parser = positive, group = LIMITS)]
    pub p99: Option<f64>,
    /// Mean FLIP of the worst frame at most, 0 to 1, at 67 pixels per degree
    #[arg(long, value_name = "F", value_parser = positive, group = LIMITS)]
    pub flip: Option<f64>,
    /// PSNR of the colours at least
    #[arg(long, value_name = "dB", value_parser = positive, group = LIMITS)]
    pub psnr: Option<f64>,
}

impl ErrorLimits {
    /// All of them, of which --max-error is about a quantity.
    pub fn asked(&self, of_error: Quantity) -> [Asked; 4] {
        [
            (of_error, self.max_error, "--max-error"),
            (Quantity::Percentile99, self.p99, "--p99"),
            (Quantity::Flip, self.flip, "--flip"),
            (Quantity::PsnrDb, self.psnr, "--psnr"),
        ]
    }
}

/// What the answer must hold.
#[derive(Debug, Default, Args)]
#[group(id = LIMITS, multiple = true, required = true)]
#[command(next_help_heading = "Limits (at least one; --part adds what it holds)")]
pub struct LimitOptions {
    /// Frames a second at least, of the slowest frame
    #[arg(long, value_name = "N", value_parser = positive, group = LIMITS)]
    pub fps: Option<f64>,
    #[command(flatten)]
    pub errors: ErrorLimits,
    /// Look-up tables at most
    #[arg(long, value_name = "N", group = LIMITS)]
    pub lut: Option<u32>,
    /// Multipliers at most
    #[arg(long, value_name = "N", group = LIMITS)]
    pub dsp: Option<u32>,
    /// Kilobits of block memory at most
    #[arg(long, value_name = "kbit", group = LIMITS)]
    pub bram: Option<u32>,
    /// What the memory moves, both directions together: the machine's channels are no wider
    #[arg(long, value_name = "MB/s", value_parser = positive, group = LIMITS)]
    pub bandwidth: Option<f64>,
    /// Energy of the most expensive frame at most; an estimate by --energy's table
    #[arg(long, value_name = "mJ", value_parser = positive, group = LIMITS)]
    pub max_energy: Option<f64>,
}

#[derive(Debug, Args)]
#[command(group = ArgGroup::new(LIMITS).required(true).multiple(true))]
pub struct FitOptions {
    #[command(flatten)]
    pub frames: FrameOptions,
    #[command(flatten)]
    pub errors: ErrorLimits,
    /// Which error --max-error limits, if not the largest
    #[arg(long, value_parser = one_of(METRICS), default_value = "largest")]
    pub metric: Quantity,
    #[command(flatten)]
    pub formats: FormatOptions,
    /// Design file to write
    #[arg(short, long, value_name = "file.toml", help_heading = "Output")]
    pub output: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct ProfileOptions {
    #[command(flatten)]
    pub frames: FrameOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
    /// Also find the smallest widths within this error (as `splatline fit` does)
    #[arg(long, value_name = "E", value_parser = positive)]
    pub max_error: Option<f64>,
    /// Also write the answer as JSON
    #[arg(long, value_name = "n.json")]
    pub json: Option<PathBuf>,
    /// Also write workload statistics as a page: histograms of tiles, splats and pixels, key bits, reuse between frames
    #[arg(long, value_name = "w.html")]
    pub html: Option<PathBuf>,
}
