//! From options to what the engines need: scene, camera, rules, threads, and a check of the output's folder.

use super::Failure;
use super::args::{AntialiasChoice, Size, USUAL_FOV, Vector, ViewOptions};
use anyhow::{Context, anyhow};
use splatline_sim::camera::{Camera, NOTABLE_CORRECTION};
use splatline_sim::hybrid::spacing;
use splatline_sim::memory;
use splatline_sim::rules::{Antialias, Rules};
use splatline_sim::scene::{self, LoadOptions, Scene};
use std::num::NonZero;
use std::path::Path;

/// Where neither a camera file nor `--size` says otherwise.
const USUAL_SIZE: Size = Size {
    width: 512,
    height: 512,
};

/// What is looked at, from where and under which rules.
pub struct View {
    pub scene: Scene,
    pub camera: Camera,
    pub rules: Rules,
    /// What was changed on the way in; for reports and stderr.
    pub warnings: Vec<String>,
}

impl View {
    /// Loads the scene and places the camera.
    pub fn from_options(options: &ViewOptions) -> Result<View, Failure> {
        let light = options.light.map(|Vector(direction)| direction);
        let load_options = LoadOptions {
            transfer: options.transfer.clone(),
            light,
        };
        let scene = scene::load(&options.scene, &load_options)?;
        let (camera, warnings) = camera_or(options, scene.up, |size| {
            scene.default_camera(size.width, size.height)
        })?;
        let rules = rules(options, &scene);
        Ok(View {
            scene,
            camera,
            rules,
            warnings,
        })
    }
}

/// The rules asked for, with the kernel and the protection against aliasing asked for.
fn rules(options: &ViewOptions, scene: &Scene) -> Rules {
    let rules = options.rules.unwrap_or(scene.natural_rules);
    let rules = rules.with_kernel(options.kernel.into());
    match options.antialias {
        None | Some(AntialiasChoice::Ewa) => rules,
        Some(AntialiasChoice::None) => rules.with_antialias(Antialias::None),
        Some(AntialiasChoice::Swan) => rules.with_antialias(Antialias::Swan(spacing(scene))),
    }
}

/// The camera of the options, or the scene's own, and what had to be corrected. `up` is used where the options do not say.
pub fn camera_or(
    options: &ViewOptions,
    up: [f64; 3],
    default: impl FnOnce(Size) -> Camera,
) -> Result<(Camera, Vec<String>), Failure> {
    if let Some(path) = &options.camera {
        let (camera, change) = Camera::corrected_from_json_file(path)?;
        let camera = match options.size {
            Some(size) => camera.resized(size.width, size.height)?,
            None => camera,
        };
        return Ok((camera, correction(path, change)));
    }
    Ok((placed_camera(options, up, default)?, Vec::new()))
}

/// What to say about a rotation that was corrected.
fn correction(path: &Path, change: f64) -> Vec<String> {
    if change <= NOTABLE_CORRECTION {
        return Vec::new();
    }
    let file = path.display();
    vec![format!(
        "camera file '{file}': 'world_to_camera' is a rotation only nearly; the nearest one is used, which changes entries by up to {change:.1e}"
    )]
}

/// The camera of `--eye` and `--target`, or the scene's own.
fn placed_camera(
    options: &ViewOptions,
    up: [f64; 3],
    default: impl FnOnce(Size) -> Camera,
) -> Result<Camera, Failure> {
    let size = options.size.unwrap_or(USUAL_SIZE);
    let (Some(Vector(eye)), Some(Vector(target))) = (options.eye, options.target) else {
        return sound_camera(default(size), &options.scene.display().to_string());
    };
    let up = options.up.map_or(up, |Vector(up)| up);
    let fov = options.fov.unwrap_or(USUAL_FOV);
    Camera::look_at(eye, target, up, fov, size.width, size.height).map_err(|error| {
        Failure::Usage(format!("--eye, --target and --up make no camera: {error}"))
    })
}

/// An automatic camera, unless the scene's coordinates are so large that it cannot be placed: their squares overflow beyond 1e154.
pub fn sound_camera(camera: Camera, scene: &str) -> Result<Camera, Failure> {
    if camera.is_sound() {
        return Ok(camera);
    }
    Err(anyhow!(
        "{scene}: its coordinates are too large or too far apart to place a camera: remove what lies far outside, or scale the scene"
    )
    .into())
}

/// Refuses a picture of which so many bytes a pixel do not fit into memory.
pub fn room_for_picture(camera: &Camera, bytes: u64) -> Result<(), Failure> {
    let (width, height) = (camera.width, camera.height);
    let bytes = bytes.saturating_mul(width as u64 * height as u64);
    let what = format!("a picture of {width}x{height}");
    memory::room_for(bytes, &what, "give a smaller --size")?;
    Ok(())
}

/// Bytes of a pixel while a picture is drawn and written: 47 were measured, 53 for a surface.
pub const DRAWN: u64 = 64;
/// While two are compared: both, the error map and their files; 79 were measured, 138 for a surface in eight layers, whose reference
/// keeps every fragment.
pub const COMPARED: u64 = 192;

/// The number of threads asked for, or one per processor.
pub fn threads(asked: Option<usize>) -> usize {
    asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get))
}

/// Fails before the work and not after it if the output's folder does not exist.
pub fn check_folder_of(file: &Path) -> Result<(), Failure> {
    if file.is_dir() {
        return Err(anyhow!(
            "cannot write '{}': it is a folder; name a file in it",
            file.display()
        )
        .into());
    }
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            let (file, folder) = (file.display(), folder.display());
            Err(anyhow!("cannot write '{file}': the folder '{folder}' does not exist").into())
        }
        _ => Ok(()),
    }
}

/// Writes bytes whole; the error names the file.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    splatline_sim::atomic::write(path, bytes)
        .with_context(|| format!("cannot write '{}'", path.display()))?;
    Ok(())
}
