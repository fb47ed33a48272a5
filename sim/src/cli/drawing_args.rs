//! How a scene is drawn: the options that every command that draws has, and those of the commands that write pictures.

use super::values::{
    COMPOSITINGS, ELLIPSES, INDICES, POINTS, REPRESENTATIONS, ROUNDINGS, SHEETS, TraversalChoice,
    at_least_one, colour, depth, design_name, one_of, positive,
};
use super::view_args::{PathOptions, ViewOptions};
use crate::fast::lanes::VectorLevel;
use crate::hybrid::Points;
use crate::picture::{Backdrop, Depth};
use crate::plan::{Effort, Engine};
use crate::reference::sphere::Index;
use crate::rules::Compositing;
use crate::sheets::SheetKind;
use crate::vector::Vector;
use clap::Args;
use splatline::blend::deep::{ChannelRounding, Representation};
use std::path::PathBuf;
use std::str::FromStr;

/// Which pixels, in which order.
#[derive(Debug, Args)]
#[command(next_help_heading = "Drawing")]
pub struct WorkOptions {
    /// Widths: classic8, micro16, lean18, standard24, deep32 or a TOML file
    #[arg(
        long,
        value_name = "NAME|file.toml",
        default_value = "standard24",
        value_parser = design_name,
        conflicts_with = "from"
    )]
    pub design: String,
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
    #[command(flatten)]
    pub technique: TechniqueOptions,
}

/// How splats become pixels, where affine footprints are not composited one by one.
#[derive(Debug, Args)]
pub struct TechniqueOptions {
    /// Which samples become points, gathered in depth ranges; needs --antialias swan
    #[arg(long, help_heading = "Techniques", value_parser = one_of(POINTS), conflicts_with_all = ["from", "sheets", "deep_alpha", "spheres"])]
    pub points: Option<Points>,
    /// Phases per pixel and axis of --traversal stamp, as a power of two
    #[arg(long, help_heading = "Techniques", value_name = "N", default_value = "3", conflicts_with = "from", value_parser = clap::value_parser!(u8).range(0..=6))]
    pub phase_bits: u8,
    /// Adds the splats of a slab in a sheet buffer, and composites the sheets
    #[arg(long, help_heading = "Techniques", value_parser = one_of(SHEETS), conflicts_with_all = ["from", "deep_alpha", "spheres"])]
    pub sheets: Option<SheetKind>,
    /// Thickness of a slab, scene units [default: the samples' spacing]
    #[arg(long, help_heading = "Techniques", value_name = "T", value_parser = positive, requires = "sheets")]
    pub sheet_thickness: Option<f64>,
    /// Composites through an alpha channel of its own width that keeps this
    #[arg(long, help_heading = "Techniques", value_parser = one_of(REPRESENTATIONS), conflicts_with_all = ["from", "spheres"])]
    pub deep_alpha: Option<Representation>,
    /// Bits of the deep alpha channel, 8 to 32
    #[arg(long, help_heading = "Techniques", value_name = "N", default_value = "24", requires = "deep_alpha", value_parser = clap::value_parser!(u8).range(8..=32))]
    pub alpha_bits: u8,
    /// What becomes of the bits below the deep alpha channel's last
    #[arg(long, help_heading = "Techniques", value_parser = one_of(ROUNDINGS), default_value = "nearest", requires = "deep_alpha")]
    pub alpha_rounding: ChannelRounding,
    /// Draws splats as spheres of their first axis' length, outlined by this ellipse
    #[arg(long, help_heading = "Techniques", value_parser = one_of(ELLIPSES), conflicts_with = "from")]
    pub spheres: Option<bool>,
    /// How a pixel's place inside a sphere's outline becomes a radial index
    #[arg(long, help_heading = "Techniques", value_parser = one_of(INDICES), default_value = "affine", requires = "spheres")]
    pub sphere_index: Index,
}

impl TechniqueOptions {
    /// Is a method other than points asked for?
    pub fn is_another_method(&self) -> bool {
        self.sheets.is_some() || self.deep_alpha.is_some() || self.spheres.is_some()
    }
}

/// Frames, of every scene by every camera, and how they are drawn.
#[derive(Debug, Args)]
pub struct FrameOptions {
    #[command(flatten)]
    pub view: ViewOptions,
    /// Further scenes, each seen whole or by the same camera
    #[arg(value_name = "MORE", conflicts_with = "from")]
    pub more: Vec<PathBuf>,
    #[command(flatten)]
    pub path: PathOptions,
    #[command(flatten)]
    pub work: WorkOptions,
}

/// By what and how often it is drawn.
#[derive(Debug, Args)]
#[command(next_help_heading = "Drawing")]
pub struct DrawingOptions {
    /// fixed: the kernel; float: EWA in double precision; exact: the ray integral. `compare` always draws fixed, and
    /// against float unless this says exact
    #[arg(long, value_enum, default_value = "fixed", conflicts_with = "from")]
    pub engine: Engine,
    #[command(flatten)]
    pub work: WorkOptions,
    /// Bits per channel of the PNG files
    #[arg(long, value_name = "8|16", help_heading = "Output", default_value = "8", value_parser = depth)]
    pub depth: Depth,
    /// Colour behind the picture in PNG files: black, white, #rrggbb or three numbers from 0 to 1 [default: black]
    #[arg(long, value_name = "COLOUR", help_heading = "Output", value_parser = colour)]
    pub background: Option<Vector>,
    /// PNG files with straight alpha instead of a background
    #[arg(long, help_heading = "Output", conflicts_with = "background")]
    pub alpha: bool,
    /// Threads [default: all processors]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    pub threads: Option<usize>,
    /// Vectors of the engine fixed: avx2, avx512 or portable; the picture is the same [default: the best of this
    /// processor]
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
            (false, Some(colour)) => Backdrop::Colour(colour),
            (false, None) => Backdrop::default(),
        }
    }

    /// The same for pictures whose report is not kept: nothing is counted, so that hidden splats cost less.
    pub fn effort_of_pictures(&self) -> Effort {
        Effort {
            counts: self.json.is_some(),
            ..self.effort()
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
