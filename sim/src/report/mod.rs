//! What a run tells people: report.json for scripts, report.html for eyes, the same table as text.
//!
//! [`Report`] is the whole of report.json and the only source of the other forms, so that no number can differ between
//! them. It is read back for its plan, which stays JSON here because plans are made of what comes later in the data
//! flow; what a machine counted is counted again rather than believed. Errors are in units of 1.0, times in seconds,
//! pixels are counted once per splat that visits them.
//! JSON knows neither infinity nor NaN: the PSNR of identical pictures is `null` beside `"identical": true`.

pub(crate) mod chart;
pub mod error_map;
pub(crate) mod facts;
pub(crate) mod formats;
pub(crate) mod frames;
pub(crate) mod html;
pub mod machine;
pub(crate) mod labels;
pub(crate) mod photos;
pub(crate) mod plot;
pub mod png;
pub(crate) mod scale;
pub(crate) mod shell;
pub(crate) mod table;
pub(crate) mod viewer;

pub use chart::alone;

use crate::camera::Camera;
use crate::design::ResolvedDesign;
use crate::flip::PIXELS_PER_DEGREE;
use crate::input::Refused;
use crate::machine::clock::Throughput;
use crate::machine::timing::Timing;
use crate::metrics::{ChannelError, compare_and_look};
use crate::picture::Picture;
use crate::rules::Rules;
use crate::systems::SystemVerdict;
use error_map::ErrorMap;
use facts::SceneFacts;
use serde::{Deserialize, Serialize};

/// Written into every report.json; the number rises when a field changes its meaning or goes away.
pub const FORMAT: &str = "splatline-report/1";

/// The contents of report.json.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`FORMAT`].
    pub format: String,
    /// What drew the picture: `fixed`, `float` or `exact`.
    pub engine: String,
    /// What it was compared with: `float` or `exact`; null if nothing was compared.
    pub reference: Option<String>,
    /// The fully resolved design: every width, also those that were left to a default. Null for a float engine.
    pub design: Option<ResolvedDesign>,
    /// `box` or `spans`; null for a float engine.
    pub traversal: Option<String>,
    /// What was drawn.
    pub scene: SceneFacts,
    /// What was not drawn as it was given: every line of warning that went to stderr.
    pub warnings: Vec<String>,
    /// From where; the form of a camera file.
    pub camera: Camera,
    /// Under which rules.
    pub rules: Rules,
    /// `front-to-back`, `back-to-front` or `x-ray`.
    pub compositing: String,
    /// Null if nothing was compared.
    pub error: Option<ErrorFacts>,
    /// Which systems of the papers the picture exercises; `error` is that of all of them together.
    pub systems: Vec<SystemVerdict>,
    /// How the colours of error.png are to be read; null if nothing was compared.
    pub error_map: Option<ScaleFacts>,
    /// Cycles of the hardware model (total, phases, accounts per unit); null if it was not run, and for a float engine.
    #[serde(skip_deserializing)]
    pub cycles: Option<Timing>,
    /// What those cycles are by the machine's clock: frames a second, milliseconds a frame, bytes a second; null
    /// without cycles.
    #[serde(skip_deserializing)]
    pub pace: Option<Throughput>,
    /// Work of the rasterizer; null for a float engine, which counts no visits.
    pub pixels: Option<PixelCounts>,
    /// Time on this machine.
    pub host: HostTimes,
    /// The sweep of designs and traversals; empty if only one was drawn.
    pub table: Vec<ReportRow>,
    /// Floating-point datapaths on the same picture, if they were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub formats: Vec<FormatRow>,
    /// Everything that decided the picture, so that `--from` can draw it again: a [`crate::plan::Plan`].
    pub plan: serde_json::Value,
}

/// Errors per channel group.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorFacts {
    /// Red, green and blue together.
    pub rgb: ChannelError,
    /// Alpha.
    pub alpha: ChannelError,
    /// Mean FLIP of the colours, 0 to 1.
    pub flip: f64,
    /// Pixels per degree of the visual field that it is for.
    pub flip_pixels_per_degree: f64,
}

/// The colour scale of error.png: position `asinh(error / knee) / asinh(limit / knee)`, dark at 0, cool towards -1
/// (fixed is darker), warm towards 1 (fixed is brighter). See [`error_map`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScaleFacts {
    /// The error of full colour; 0 for identical pictures.
    pub limit: f64,
    /// Where the scale turns from linear to logarithmic; 0 for identical pictures.
    pub knee: f64,
    /// `1 / limit`; null for identical pictures.
    pub magnification: Option<f64>,
    /// Of the pixels that differ, the percentile at which the scale ends.
    pub percentile: f64,
    /// Pixels that differ by more, drawn in full colour.
    pub outliers: usize,
    /// The largest of them.
    pub largest: f64,
}

/// Work of the rasterizer, each pixel counted once per splat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelCounts {
    /// Inside the footprint.
    pub covered: u64,
    /// Stepped over by the traversal.
    pub visited: u64,
}

/// Seconds on this machine, medians over `repeat` runs, taken field by field; `convert_s` is what the total has beyond
/// the other stages, so that they add up to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HostTimes {
    /// Projection and footprint set-up.
    pub setup_s: f64,
    /// Sorting by depth.
    pub sort_s: f64,
    /// Rasterizing and blending.
    pub raster_s: f64,
    /// Bringing the scene into the kernel's formats and the pixels into a picture; all of it for an engine that does
    /// not tell its stages apart.
    pub convert_s: f64,
    /// Loading, classifying and texturing the scene before it was drawn; done once, and no part of the total.
    pub prepare_s: f64,
    /// All of the drawing by the wall clock.
    pub total_s: f64,
    /// How many runs the medians are over.
    pub repeat: usize,
    /// Threads the engine was given.
    pub threads: usize,
}

/// A floating-point datapath, every operation rounded, against the reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FormatRow {
    /// `fp32`, `fp16` or `bfloat16`.
    pub engine: String,
    /// Its errors.
    pub error: ErrorFacts,
    /// Transistors of the arithmetic of a lane, an estimate.
    pub transistors: u64,
    /// Energy of a pixel in the lane and in the tile's buffer, picojoules, an estimate.
    pub pj_per_pixel: f64,
}

/// One line of the speed-against-error sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReportRow {
    /// Name of the design.
    pub design: String,
    /// `box` or `spans`.
    pub traversal: String,
    /// Error of red, green and blue.
    pub error: ChannelError,
    /// Mean FLIP of the colours.
    pub flip: f64,
    /// Pixels that the traversal stepped over.
    pub visited: u64,
    /// Pixels inside the footprints.
    pub covered: u64,
    /// Their ratio, 1 at best; null if nothing was covered.
    pub visited_per_covered: Option<f64>,
    /// Cycles of the hardware model; null if it was not run.
    pub cycles: Option<u64>,
    /// Time on this machine.
    pub host: HostTimes,
}

impl Report {
    /// The text of report.json.
    pub fn to_json(&self) -> serde_json::Result<String> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        Ok(text)
    }

    /// Name of the design in words.
    pub fn design_name(&self) -> &str {
        let design = self.design.as_ref();
        design.map_or("unnamed", |design| &design.name)
    }
}

impl PixelCounts {
    /// Visited over covered, 1 at best; nothing if nothing was covered.
    pub fn ratio(&self) -> Option<f64> {
        (self.covered > 0).then(|| self.visited as f64 / self.covered as f64)
    }
}

impl ErrorFacts {
    /// Of a picture against its reference; fails if they are not of one size.
    pub fn between(picture: &Picture, reference: &Picture) -> Result<ErrorFacts, Refused> {
        let (errors, flip) = compare_and_look(picture, reference)?;
        Ok(ErrorFacts {
            rgb: errors.colour,
            alpha: errors.alpha,
            flip,
            flip_pixels_per_degree: PIXELS_PER_DEGREE,
        })
    }
}

impl From<&ErrorMap> for ScaleFacts {
    fn from(map: &ErrorMap) -> Self {
        ScaleFacts {
            limit: map.scale.limit,
            knee: map.scale.knee,
            percentile: scale::PERCENTILE,
            outliers: map.scale.outliers,
            largest: map.scale.largest,
            magnification: map.magnification(),
        }
    }
}

impl HostTimes {
    /// Medians, field by field, of one entry per run.
    pub fn median_of(runs: &[HostTimes]) -> HostTimes {
        let of = |field: fn(&HostTimes) -> f64| median(runs.iter().map(field).collect());
        let [setup_s, sort_s, raster_s] = [of(|t| t.setup_s), of(|t| t.sort_s), of(|t| t.raster_s)];
        let total_s = of(|t| t.total_s);
        HostTimes {
            setup_s,
            sort_s,
            raster_s,
            convert_s: (total_s - (setup_s + sort_s + raster_s)).max(0.0),
            prepare_s: 0.0,
            total_s,
            repeat: runs.len(),
            threads: runs.first().map_or(0, |t| t.threads),
        }
    }
}

/// The middle value, or the mean of the two in the middle; 0 of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else {
        return 0.0;
    };
    (values[last / 2] + values[last.div_ceil(2)]) / 2.0
}

#[cfg(test)]
pub mod tests;
