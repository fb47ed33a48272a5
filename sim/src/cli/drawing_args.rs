//! How a scene is drawn: the options that every command that draws has, and those of the commands that write pictures.

use super::values::{
    COMPOSITINGS, Colour, DesignName, ENGINES, POINTS, TraversalChoice, at_least_one, colour,
    depth, one_of,
};
use crate::fast::lanes::VectorLevel;
use crate::hybrid::Points;
use crate::picture::{Backdrop, Depth};
use crate::plan::{Effort, Engine};
use crate::rules::Compositing;
use clap::Args;
use std::path::PathBuf;
use std::str::FromStr;

/// Which pixels, in which order.
#[derive(Debug, Args)]
#[command(next_help_heading = "Drawing")]
pub struct WorkOptions {
    /// Widths: classic8, lean18, standard24, deep32 or a TOML file
    #[arg(
        long,
        value_name = "NAME|file.toml",
        default_value = "standard24",
        conflicts_with = "from"
    )]
    pub design: DesignName,
    /// How a footprint's pixels are walked [default: the design's own]
    #[arg(long, value_enum, conflicts_with = "from")]
    pub traversal: Option<TraversalChoice>,
    /// Order and operator of blending
    #[arg(
        long,
        value_parser = one_of(COMPOSITINGS),
        default_value = "front-to-back",
        conflicts_with = "from"
    )]
    pub compositing: Compositing,
}

/// By what and how often it is drawn.
#[derive(Debug, Args)]
#[command(next_help_heading = "Drawing")]
pub struct DrawingOptions {
    /// fixed: the kernel; float: EWA in double precision; exact: the ray integral. `compare` always draws fixed, and
    /// against float unless this says exact
    #[arg(long, value_parser = one_of(ENGINES), default_value = "fixed", conflicts_with = "from")]
    pub engine: Engine,
    #[command(flatten)]
    pub work: WorkOptions,
    /// Which samples of a volume become points, gathered in depth ranges; needs --antialias swan
    #[arg(long, value_parser = one_of(POINTS), conflicts_with = "from")]
    pub points: Option<Points>,
    /// Phases per pixel and axis of --traversal stamp, as a power of two
    #[arg(long, value_name = "N", default_value = "3", conflicts_with = "from", value_parser = clap::value_parser!(u8).range(0..=6))]
    pub phase_bits: u8,
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
    /// Vectors of the engine fixed: avx2, avx512 or portable; the picture is the same [default: the best of this processor]
    #[arg(long, value_name = "LEVEL", value_parser = <VectorLevel as FromStr>::from_str)]
    pub vectors: Option<VectorLevel>,
    /// Draw N times and report median times
    #[arg(long, value_name = "N", default_value = "1", value_parser = at_least_one)]
    pub repeat: usize,
    /// Also write the report as JSON to this file; - is stdout
    #[arg(long, value_name = "r.json", help_heading = "Output")]
    pub json: Option<PathBuf>,
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

    /// What of this computer drawing may take.
    pub fn effort(&self) -> Effort {
        Effort {
            vectors: self.vectors,
            ..Effort::new(self.threads, self.repeat)
        }
    }
}
