//! What is looked at and from where: the options that every command about a scene has.

use super::values::{
    AntialiasChoice, Backfaces, KERNELS, SceneKind, field_of_view, layers, one_of, orbit, positive,
    size, vector,
};
use crate::framing::Orbit;
use crate::rules::{Kernel, Rules};
use crate::texture::coefficients::Method;
use crate::vector::Vector;
use clap::{Arg, Args};
use std::path::PathBuf;
use std::str::FromStr;

/// What is looked at and from where.
#[derive(Debug, Args)]
pub struct ViewOptions {
    /// Scene: 3D Gaussians, a volume or one of demo, random:COUNT[:SEED], deep-stack; - reads stdin. With --as surface
    /// also sphere, glass and hills, with --as texture checkerboard. docs/formats.md lists the formats
    #[arg(value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// Draw what a plan (TOML) or a report.json states: its scene, camera, technique, design and machine
    #[arg(long, visible_alias = "plan", value_name = "plan.toml|report.json", conflicts_with_all = ["scene", "camera", "eye", "target", "up", "fov", "orbit", "zoom", "size", "rules",
        "antialias", "low_pass", "sh_degree", "kernel", "transfer", "light", "kind"])]
    pub from: Option<PathBuf>,
    #[command(flatten)]
    pub camera: CameraArgs,
    #[command(flatten)]
    pub splats: SplatArgs,
    #[command(flatten)]
    pub surface: SurfaceArgs,
}

/// From where it is looked at.
#[derive(Debug, Args)]
#[command(next_help_heading = "Camera")]
pub struct CameraArgs {
    /// Camera: our JSON file or a report.json, a COLMAP folder, transforms.json or cameras.json; without it and without
    /// --eye the whole scene is shown
    #[arg(id = "camera", long = "camera", value_name = "FILE", conflicts_with_all = ["eye", "target", "up", "fov", "orbit"])]
    pub file: Option<PathBuf>,
    /// Which camera of a file that holds several, by its picture's name
    #[arg(long, value_name = "NAME", requires = "camera")]
    pub image: Option<String>,
    /// Position of the camera
    #[arg(long, value_name = "x,y,z", value_parser = vector, requires = "target")]
    pub eye: Option<Vector>,
    /// Point in the middle of the picture
    #[arg(long, value_name = "x,y,z", value_parser = vector, requires = "eye")]
    pub target: Option<Vector>,
    /// Direction that is up in the picture [default: the scene's]
    #[arg(long, value_name = "x,y,z", value_parser = vector)]
    pub up: Option<Vector>,
    /// Vertical field of view in degrees [default: 45]
    #[arg(long, value_name = "deg", value_parser = field_of_view)]
    pub fov: Option<f64>,
    /// Turn around up (counter-clockwise seen from above) and rise over the horizon, degrees
    #[arg(long, value_name = "az,el", value_parser = orbit)]
    pub orbit: Option<Orbit>,
    /// Enlarge the picture about its middle
    #[arg(long, value_name = "Z", value_parser = positive)]
    pub zoom: Option<f64>,
    /// Size of the picture [default: the camera file's, or 512x512]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[usize; 2]>,
}

/// How splats are read and blended.
#[derive(Debug, Args)]
#[command(next_help_heading = "Splats")]
pub struct SplatArgs {
    /// Rules of blending: ewa; 3dgs as gsplat draws; inria, whose opacities end at 0.99 [default: what the kind of
    /// scene is meant for]
    #[arg(long, value_name = "ewa|3dgs|inria", value_parser = Rules::from_str)]
    pub rules: Option<Rules>,
    /// Protection against samples closer together than pixels [default: the rules' low-pass filter]
    #[arg(long, value_enum)]
    pub antialias: Option<AntialiasChoice>,
    /// Variance of the low-pass filter, square pixels [default: the rules': 1 of ewa, 0.3 of the others]
    #[arg(long, value_name = "V", value_parser = positive)]
    pub low_pass: Option<f64>,
    /// Spherical harmonics up to this degree only
    #[arg(long, value_name = "0..4", value_parser = clap::value_parser!(u8).range(0..=4))]
    pub sh_degree: Option<u8>,
    /// Shape of footprints
    #[arg(long, value_parser = one_of(KERNELS), default_value = "gaussian")]
    pub kernel: Kernel,
    /// Transfer function of a volume (TOML)
    #[arg(long, value_name = "file.toml", conflicts_with = "kind")]
    pub transfer: Option<PathBuf>,
    /// Direction towards the light that shades a volume
    #[arg(long, value_name = "x,y,z", value_parser = vector)]
    pub light: Option<Vector>,
}

/// Many views in one command.
#[derive(Debug, Default, Args)]
pub struct PathOptions {
    /// Many cameras, a frame each: a COLMAP folder, transforms.json, cameras.json, or key frames (TOML, as
    /// docs/files.md shows)
    #[arg(long, value_name = "FILE", help_heading = "Camera",
        conflicts_with_all = ["from", "camera", "image", "eye", "target", "up", "fov", "orbit", "zoom"])]
    pub camera_path: Option<PathBuf>,
    /// Once around the scene in so many frames, each of which has room for the whole
    #[arg(long, value_name = "N", help_heading = "Camera", conflicts_with_all = ["from", "camera_path"],
        value_parser = clap::value_parser!(u32).range(2..=3600))]
    pub turntable: Option<u32>,
}

impl PathOptions {
    /// Are there several cameras?
    pub fn is_path(&self) -> bool {
        self.camera_path.is_some() || self.turntable.is_some()
    }
}

/// Options of surfaces.
const OF_SURFACES: [&str; 5] = [
    "layers",
    "z_threshold",
    "edges",
    "cull_backfaces",
    "depth_image_from",
];

/// The help of what draws splats one by one does not list the techniques that it always refuses.
pub fn of_units(arg: Arg) -> Arg {
    let is_technique = arg.get_help_heading() == Some("Techniques");
    let makes_points = ["flatten", "depth_image_from"].contains(&arg.get_id().as_str());
    arg.hide(is_technique && !makes_points)
}

/// That of what draws volume splats alone has no options of surfaces.
pub fn of_volumes(arg: Arg) -> Arg {
    let is_beyond = OF_SURFACES.contains(&arg.get_id().as_str());
    arg.hide(is_beyond)
}

/// How a point cloud is drawn as a surface.
#[derive(Debug, Args)]
#[command(next_help_heading = "Surfaces")]
pub struct SurfaceArgs {
    /// What the scene is: `surface` draws a .ply, .xyz, .obj, .las or .laz cloud or a height field (.csv) as surface
    /// splats, `texture` the texels of a picture (.png, .jpg) as samples on the ground
    #[arg(long = "as", value_name = "surface|texture", value_enum)]
    pub kind: Option<SceneKind>,
    /// Layers of a pixel (1, 2, 3, 4 or 8), for semi-transparent surfaces and antialiased edges [default: one opaque
    /// surface]
    #[arg(long, value_name = "N", value_parser = layers, requires = "kind")]
    pub layers: Option<usize>,
    /// Depths closer than this are one surface, scene units [default: three radii]
    #[arg(long, value_name = "Z", value_parser = positive, requires = "kind")]
    pub z_threshold: Option<f64>,
    /// Antialias edges by the weight sum
    #[arg(long, requires = "kind")]
    pub edges: bool,
    /// Photograph (.png, .jpg) over a height field, north up
    #[arg(long, value_name = "photo.jpg", requires = "kind")]
    pub texture: Option<PathBuf>,
    /// How points get their colours from the texture: plain, prefiltered or optimised
    #[arg(long, value_name = "METHOD", default_value = "optimised", value_parser = Method::from_str, requires = "texture")]
    pub coefficients: Method,
    /// Distance of neighbouring heights of a height field, in units of height [default: 0.1]
    #[arg(long, value_name = "D", value_parser = positive, requires = "kind")]
    pub spacing: Option<f64>,
    /// Draws the points as volume kernels whose axis along the normal is divided by S
    #[arg(long, value_name = "S", help_heading = "Techniques", value_parser = positive, requires = "kind")]
    pub flatten: Option<f64>,
    /// Draws the pixels of a depth image that this camera takes of the surface, warped to the view
    #[arg(
        long,
        value_name = "camera.json",
        help_heading = "Techniques",
        requires = "kind",
        conflicts_with = "flatten"
    )]
    pub depth_image_from: Option<PathBuf>,
    /// Leaves out points that face away from the eye [default: auto; on if nothing follows]
    #[arg(long, value_enum, value_name = "WHEN", num_args = 0..=1, require_equals = true, default_value = "auto", default_missing_value = "on", hide_default_value = true, requires = "kind")]
    pub cull_backfaces: Backfaces,
}
