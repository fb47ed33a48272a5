//! What is looked at and from where: the options that every command about a scene has.

use super::args::{number, positive};
use super::output;
use crate::framing::Orbit;
use crate::rules::{Kernel, Rules};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::str::FromStr;

/// Largest width and height of a picture.
pub const LARGEST_SIDE: usize = 16_384;

/// What is looked at and from where.
#[derive(Debug, Args)]
pub struct ViewOptions {
    /// Scene: 3D Gaussians, a volume or one of demo, random:COUNT[:SEED], deep-stack; - reads stdin. docs/formats.md lists the formats
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Camera: our JSON file or a report.json, a COLMAP folder, transforms.json or cameras.json; without it and without --eye the whole scene is shown
    #[arg(long, value_name = "FILE", help_heading = "Camera", conflicts_with_all = ["eye", "target", "up", "fov", "orbit"])]
    pub camera: Option<PathBuf>,
    /// Which camera of a file that holds several, by its picture's name
    #[arg(
        long,
        value_name = "NAME",
        help_heading = "Camera",
        requires = "camera"
    )]
    pub image: Option<String>,
    /// Position of the camera
    #[arg(
        long,
        value_name = "x,y,z",
        help_heading = "Camera",
        allow_hyphen_values = true,
        requires = "target"
    )]
    pub eye: Option<Vector>,
    /// Point in the middle of the picture
    #[arg(
        long,
        value_name = "x,y,z",
        help_heading = "Camera",
        allow_hyphen_values = true,
        requires = "eye"
    )]
    pub target: Option<Vector>,
    /// Direction that is up in the picture [default: the scene's]
    #[arg(
        long,
        value_name = "x,y,z",
        help_heading = "Camera",
        allow_hyphen_values = true
    )]
    pub up: Option<Vector>,
    /// Vertical field of view in degrees [default: 45]
    #[arg(long, value_name = "deg", help_heading = "Camera", value_parser = field_of_view)]
    pub fov: Option<f64>,
    /// Turn around up (counter-clockwise seen from above) and rise over the horizon, degrees
    #[arg(
        long,
        value_name = "az,el",
        help_heading = "Camera",
        allow_hyphen_values = true
    )]
    pub orbit: Option<OrbitChoice>,
    /// Enlarge the picture about its middle
    #[arg(long, value_name = "Z", help_heading = "Camera", value_parser = positive)]
    pub zoom: Option<f64>,
    /// Size of the picture [default: the camera file's, or 512x512]
    #[arg(long, value_name = "WxH", help_heading = "Camera")]
    pub size: Option<Size>,
    /// Rules of blending: ewa or 3dgs [default: what the kind of scene is meant for]
    #[arg(long, value_name = "ewa|3dgs", help_heading = "Splats", value_parser = Rules::from_str)]
    pub rules: Option<Rules>,
    /// Protection against samples closer together than pixels [default: the rules' low-pass filter]
    #[arg(long, help_heading = "Splats", value_enum)]
    pub antialias: Option<AntialiasChoice>,
    /// Shape of footprints
    #[arg(long, help_heading = "Splats", value_enum, default_value = "gaussian")]
    pub kernel: KernelChoice,
    /// Transfer function of a volume (TOML)
    #[arg(long, value_name = "file.toml", help_heading = "Splats")]
    pub transfer: Option<PathBuf>,
    /// Direction towards the light that shades a volume
    #[arg(
        long,
        value_name = "x,y,z",
        help_heading = "Splats",
        allow_hyphen_values = true
    )]
    pub light: Option<Vector>,
}

impl ViewOptions {
    /// The files that are read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let mut inputs = output::files([self.camera.as_ref(), self.transfer.as_ref()]);
        inputs.push(self.scene.clone());
        inputs
    }
}

/// Protection against aliasing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AntialiasChoice {
    /// No low-pass filter
    None,
    /// The low-pass filter of the rules
    Ewa,
    /// Distance scaling by the volume's sample spacing, without a low-pass filter
    Swan,
}

/// Shape of footprints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum KernelChoice {
    /// exp(-r/2)
    Gaussian,
    /// Footprint of the cubic spline of Crawfis and Max
    Cubic,
    /// 1 - r/6 (Epanechnikov)
    Quadratic,
    /// Constant
    Disc,
}

impl From<KernelChoice> for Kernel {
    fn from(choice: KernelChoice) -> Self {
        match choice {
            KernelChoice::Gaussian => Kernel::Gaussian,
            KernelChoice::Cubic => Kernel::Cubic,
            KernelChoice::Quadratic => Kernel::Quadratic,
            KernelChoice::Disc => Kernel::Disc,
        }
    }
}

/// Three finite numbers parted by commas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector(pub [f64; 3]);

impl FromStr for Vector {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts: Vec<f64> = text
            .split(',')
            .map(|part| number(part.trim()))
            .collect::<Result<_, _>>()?;
        let count = parts.len();
        let three = <[f64; 3]>::try_from(parts)
            .map_err(|_| format!("expected x,y,z but found {count} numbers"))?;
        Ok(Vector(three))
    }
}

/// Azimuth and elevation in degrees, parted by a comma.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitChoice(pub Orbit);

impl FromStr for OrbitChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (azimuth, elevation) = text
            .split_once(',')
            .ok_or("expected az,el in degrees, for example 30,15")?;
        let elevation = number(elevation.trim())?;
        if elevation.abs() > 89.0 {
            return Err("the elevation must lie between -89 and 89 degrees".to_owned());
        }
        Ok(OrbitChoice(Orbit {
            azimuth: number(azimuth.trim())?,
            elevation,
        }))
    }
}

/// Columns and rows, 1 to [`LARGEST_SIDE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (width, height) = text
            .split_once(['x', 'X'])
            .ok_or("expected WxH, for example 640x480")?;
        Ok(Size {
            width: side(width)?,
            height: side(height)?,
        })
    }
}

fn side(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(side) if (1..=LARGEST_SIDE).contains(&side) => Ok(side),
        _ => Err(format!(
            "width and height must be whole numbers from 1 to {LARGEST_SIDE}, not '{text}'"
        )),
    }
}

fn field_of_view(text: &str) -> Result<f64, String> {
    match number(text)? {
        degrees if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("the field of view must lie between 0 and 180 degrees".to_owned()),
    }
}
