//! The options of the commands that study the kernel: `stability`, `vectors`.

use super::values::{AntialiasChoice, COMPOSITINGS, TraversalChoice, design_name, one_of, size};
use crate::rules::{Compositing, Rules};
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;
use std::str::FromStr;

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
    /// Print one record's way through all formulas of docs/specification.md, with every intermediate word.
    ///
    /// The Python model of the specification tells it, so that python3 must be there.
    Explain {
        /// Folder with manifest.json and all stages
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// A record of splats, packets, runs, pixels, tile or a stage of setup, counted from 0
        #[arg(value_name = "STAGE:NUMBER")]
        record: String,
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
    /// Splats at most; behind the built-in ones come some 350 at the ends of formats
    #[arg(long, value_name = "N", default_value = "120")]
    pub splats: usize,
    /// Seed of the built-in splats
    #[arg(long, value_name = "N", default_value = "1", conflicts_with = "scene")]
    pub seed: u32,
    /// Size of the picture
    #[arg(long, value_name = "WxH", default_value = "96x64", value_parser = size)]
    pub size: [usize; 2],
    /// The built-in splats through an orthographic camera, at the ends of its depths
    #[arg(long, conflicts_with = "scene")]
    pub orthographic: bool,
    /// Stages of the other systems instead: view-dependent colour, surfaces, deep channel, points, sheets, spheres
    #[arg(long)]
    pub systems: bool,
    /// Protection against samples closer together than pixels, for the built-in splats [default: the rules' low-pass
    /// filter]
    #[arg(long, value_enum, conflicts_with = "scene")]
    pub antialias: Option<AntialiasChoice>,
    /// Rules of blending: ewa or 3dgs [default: the scene's, 3dgs for the built-in splats]
    #[arg(long, value_name = "ewa|3dgs", value_parser = Rules::from_str)]
    pub rules: Option<Rules>,
    /// Widths: classic8, micro16, lean18, standard24, deep32 or a TOML file
    #[arg(long, value_name = "NAME|file.toml", default_value = "standard24", value_parser = design_name)]
    pub design: String,
    /// How a footprint's pixels are walked [default: the design's own]
    #[arg(long, value_enum)]
    pub traversal: Option<TraversalChoice>,
    /// Order and operator of blending
    #[arg(long, value_parser = one_of(COMPOSITINGS), default_value = "front-to-back")]
    pub compositing: Compositing,
}

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
