//! The values that options have, as they are written on the command line.

use crate::design;
use crate::explore::limits::Quantity;
use crate::framing::Orbit;
use crate::hybrid::Points;
use crate::machine::area::Family;
use crate::picture::Depth;
use crate::plan::Engine;
use crate::plan::measure::count_of_threads_or_runs;
use crate::reference::sphere::Index;
use crate::rules::{Antialias, Compositing, Kernel};
use crate::sheets::SheetKind;
use crate::surface::LAYERS;
use crate::vector::Vector;
use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use splatline::blend::deep::{ChannelRounding, Representation};
use splatline::format::Traversal;

/// Largest width and height of a picture.
pub const LARGEST_SIDE: usize = 16_384;

/// What an option may be: the word, what the help says of it, and the value.
pub type Choices<T> = [(&'static str, &'static str, T)];

/// Reads one of these words.
pub fn one_of<T>(choices: &'static Choices<T>) -> impl TypedValueParser<Value = T>
where
    T: Clone + Send + Sync + 'static,
{
    let words = choices
        .iter()
        .map(|(word, about, _)| PossibleValue::new(*word).help(*about));
    PossibleValuesParser::new(words).try_map(|found| {
        let chosen = choices.iter().find(|(word, ..)| *word == found);
        chosen
            .map(|(.., value)| value.clone())
            .ok_or("no such word")
    })
}

/// Who draws in a floating-point format.
pub fn format() -> impl TypedValueParser<Value = Engine> {
    let words = Engine::FORMATS.iter().filter_map(Engine::to_possible_value);
    PossibleValuesParser::new(words).try_map(|found| Engine::from_str(&found, false))
}

/// Which samples become points.
pub const POINTS: &Choices<Points> = &[
    ("auto", "Those closer together than pixels", Points::Auto),
    ("all", "All", Points::All),
    ("none", "None", Points::None),
];

/// How a scene is cut into sheets.
pub const SHEETS: &Choices<SheetKind> = &[
    (
        "axis-aligned",
        "Slices along the axis that is closest to the view",
        SheetKind::AxisAligned,
    ),
    (
        "image-aligned",
        "Slabs of depth, each splat in one of them",
        SheetKind::ImageAligned,
    ),
    (
        "image-aligned-cut",
        "Slabs of depth into which splats are cut",
        SheetKind::ImageAlignedCut,
    ),
];

/// What a deep alpha channel keeps.
pub const REPRESENTATIONS: &Choices<Representation> = &[
    ("opacity", "A", Representation::Opacity),
    ("transmittance", "1 - A", Representation::Transmittance),
    (
        "optical-depth",
        "-log2(1 - A)",
        Representation::OpticalDepth,
    ),
];

/// What becomes of the bits below a channel's last.
pub const ROUNDINGS: &Choices<ChannelRounding> = &[
    ("nearest", "To nearest", ChannelRounding::Nearest),
    ("truncate", "Cut off", ChannelRounding::Truncate),
    (
        "dither",
        "Up with the probability of the dropped part",
        ChannelRounding::Dither,
    ),
];

/// Outlines of projected spheres, by whether they are exact.
pub const ELLIPSES: &Choices<bool> = &[
    ("affine", "First order in radius over distance", false),
    ("exact", "Where the tangent cone meets the picture", true),
];

/// How a place inside a sphere's outline becomes a radial index.
pub const INDICES: &Choices<Index> = &[
    ("affine", "In proportion to the radius", Index::Affine),
    (
        "perspective",
        "Corrected for perspective, exact in the middle of the picture",
        Index::Perspective,
    ),
    (
        "ray",
        "Distance of the pixel's ray from the centre",
        Index::Ray,
    ),
];

/// Order and operator of blending.
pub const COMPOSITINGS: &Choices<Compositing> = &[
    (
        "front-to-back",
        "Nearest splat first, finished pixels skip the rest",
        Compositing::FrontToBack,
    ),
    (
        "back-to-front",
        "Farthest splat first",
        Compositing::BackToFront,
    ),
    ("x-ray", "Plain summation", Compositing::XRay),
];

/// Shapes of footprints.
pub const KERNELS: &Choices<Kernel> = &[
    ("gaussian", "exp(-r/2)", Kernel::Gaussian),
    (
        "cubic",
        "Footprint of the cubic spline of Crawfis and Max",
        Kernel::Cubic,
    ),
    ("quadratic", "1 - r/6 (Epanechnikov)", Kernel::Quadratic),
    ("disc", "Constant", Kernel::Disc),
];

/// Families of FPGAs.
pub const FAMILIES: &Choices<Family> = &[
    ("xilinx7", "Xilinx 7 series", Family::Xilinx7),
    ("ecp5", "Lattice ECP5", Family::Ecp5),
    ("ice40", "Lattice iCE40", Family::Ice40),
];

/// Which error a budget is about.
pub const METRICS: &Choices<Quantity> = &[
    ("largest", "Largest absolute error", Quantity::LargestError),
    ("rms", "Root mean square error", Quantity::RmsError),
];

/// How the kernel walks a footprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TraversalChoice {
    /// Every pixel of the bounding box, as in the papers
    Box,
    /// Only the pixels of each row inside the ellipse
    Spans,
    /// Samples closer together than pixels by copying a precomputed footprint, others by spans; needs --antialias swan
    Stamp,
}

impl From<TraversalChoice> for Traversal {
    fn from(choice: TraversalChoice) -> Self {
        match choice {
            TraversalChoice::Box => Traversal::Box,
            // Beyond the points, stamped drawings walk spans.
            TraversalChoice::Spans | TraversalChoice::Stamp => Traversal::Spans,
        }
    }
}

/// The name of a design, or of a TOML file that holds one.
pub fn design_name(text: &str) -> Result<String, String> {
    if design::NAMES.contains(&text) || text.ends_with(".toml") {
        return Ok(text.to_owned());
    }
    Err(format!(
        "expected one of {} or a file that ends in .toml",
        design::NAMES.join(", ")
    ))
}

/// Red, green and blue, 0 to 1.
pub fn colour(text: &str) -> Result<Vector, String> {
    let expected =
        "expected black, white, #rrggbb or three numbers from 0 to 1, for example 1,0.5,0";
    if let Some(digits) = text.strip_prefix('#') {
        let value = u32::from_str_radix(digits, 16)
            .ok()
            .filter(|_| digits.len() == 6);
        let value = value.ok_or(expected)?;
        return Ok([16, 8, 0].map(|shift| f64::from((value >> shift) & 255) / 255.0));
    }
    match text {
        "black" => Ok([0.0; 3]),
        "white" => Ok([1.0; 3]),
        _ => match vector(text) {
            Ok(parts) if parts.iter().all(|part| (0.0..=1.0).contains(part)) => Ok(parts),
            _ => Err(expected.to_owned()),
        },
    }
}

pub fn number(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if f64::is_finite(value) => Ok(value),
        _ => Err(format!("'{text}' is not a finite number")),
    }
}

pub fn layers(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if LAYERS.contains(&count) => Ok(count),
        _ => Err(format!(
            "expected one of {}",
            LAYERS.map(|count| count.to_string()).join(", ")
        )),
    }
}

pub fn positive(text: &str) -> Result<f64, String> {
    match number(text)? {
        value if value > 0.0 => Ok(value),
        _ => Err("must be larger than 0".to_owned()),
    }
}

pub fn depth(text: &str) -> Result<Depth, String> {
    match text {
        "8" => Ok(Depth::Eight),
        "16" => Ok(Depth::Sixteen),
        _ => Err("expected 8 or 16".to_owned()),
    }
}

/// Counts of threads and runs.
pub fn at_least_one(text: &str) -> Result<usize, String> {
    count_of_threads_or_runs(text.parse().unwrap_or(0))
}

/// Protection against aliasing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AntialiasChoice {
    /// No low-pass filter
    None,
    /// The low-pass filter of the rules
    Ewa,
    /// The low-pass filter, and opacities compensated for it, as antialiased models are trained (gsplat, Mip-Splatting)
    #[value(alias = "antialiased")]
    Mip,
    /// Distance scaling by the volume's sample spacing, without a low-pass filter
    Swan,
}

impl AntialiasChoice {
    /// With this variance of the filter, or spacing of the samples.
    pub fn with(self, variance: f64, spacing: impl FnOnce() -> f64) -> Antialias {
        match self {
            AntialiasChoice::None => Antialias::None,
            AntialiasChoice::Ewa => Antialias::Ewa(variance),
            AntialiasChoice::Mip => Antialias::Mip(variance),
            AntialiasChoice::Swan => Antialias::Swan(spacing()),
        }
    }
}

/// Three finite numbers parted by commas.
pub fn vector(text: &str) -> Result<Vector, String> {
    let parts: Vec<f64> = text
        .split(',')
        .map(|part| number(part.trim()))
        .collect::<Result<_, _>>()?;
    let count = parts.len();
    Vector::try_from(parts).map_err(|_| format!("expected x,y,z but found {count} numbers"))
}

/// Azimuth and elevation in degrees, parted by a comma.
pub fn orbit(text: &str) -> Result<Orbit, String> {
    let (azimuth, elevation) = text
        .split_once(',')
        .ok_or("expected az,el in degrees, for example 30,15")?;
    let elevation = number(elevation.trim())?;
    if elevation.abs() > 89.0 {
        return Err("the elevation must lie between -89 and 89 degrees".to_owned());
    }
    Ok(Orbit {
        azimuth: number(azimuth.trim())?,
        elevation,
    })
}

/// Columns and rows, 1 to [`LARGEST_SIDE`].
pub fn size(text: &str) -> Result<[usize; 2], String> {
    let (width, height) = text
        .split_once(['x', 'X'])
        .ok_or("expected WxH, for example 640x480")?;
    Ok([side(width)?, side(height)?])
}

fn side(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(side) if (1..=LARGEST_SIDE).contains(&side) => Ok(side),
        _ => Err(format!(
            "width and height must be whole numbers from 1 to {LARGEST_SIDE}, not '{text}'"
        )),
    }
}

pub fn field_of_view(text: &str) -> Result<f64, String> {
    match number(text)? {
        degrees if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("the field of view must lie between 0 and 180 degrees".to_owned()),
    }
}

/// When points that face away are left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backfaces {
    /// On clouds of closed surfaces whose normals point outwards
    Auto,
    /// Always
    On,
    /// Never: they are turned towards the eye
    Off,
}

/// What the points of a scene are taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SceneKind {
    /// Points of a surface
    Surface,
    /// Texels of a photograph (.png, .jpg) on a plane
    Texture,
}
