//! From options to what the engines need: scene, camera, rules, threads, and a check of the output's folder.

use super::Failure;
use super::args::{Size, USUAL_FOV, Vector, ViewOptions};
use super::engines;
use anyhow::{Context, anyhow};
use splatline_sim::camera::Camera;
use splatline_sim::rules::Rules;
use splatline_sim::scene::Scene;
use std::num::NonZero;
use std::path::Path;

/// Where neither a camera file nor `--size` says otherwise.
const USUAL_SIZE: Size = Size { width: 512, height: 512 };

/// What is looked at, from where and under which rules.
pub struct View {
    pub scene: Scene,
    pub camera: Camera,
    pub rules: Rules,
}

impl View {
    /// Loads the scene and places the camera.
    pub fn from_options(options: &ViewOptions) -> Result<View, Failure> {
        let light = options.light.map(|Vector(direction)| direction);
        let scene = engines::load_scene(&options.scene, options.transfer.as_deref(), light)?;
        let camera = camera(options, &scene)?;
        let rules = options.rules.unwrap_or(scene.natural_rules);
        Ok(View { scene, camera, rules })
    }
}

fn camera(options: &ViewOptions, scene: &Scene) -> Result<Camera, Failure> {
    if let Some(path) = &options.camera {
        let camera = engines::camera_from_file(path)?;
        return match options.size {
            Some(size) => Ok(engines::resized_camera(&camera, size)?),
            None => Ok(camera),
        };
    }
    let size = options.size.unwrap_or(USUAL_SIZE);
    let (Some(Vector(eye)), Some(Vector(target))) = (options.eye, options.target) else {
        return Ok(engines::default_camera(scene, size)?);
    };
    let up = options.up.map_or(scene.up, |Vector(up)| up);
    let fov = options.fov.unwrap_or(USUAL_FOV);
    engines::camera_looking_at(eye, target, up, fov, size)
        .map_err(|error| Failure::Usage(format!("--eye, --target and --up make no camera: {error:#}")))
}

/// The number of threads asked for, or one per processor.
pub fn threads(asked: Option<usize>) -> usize {
    asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get))
}

/// Fails before the work and not after it if the output's folder does not exist.
pub fn check_folder_of(file: &Path) -> Result<(), Failure> {
    if file.is_dir() {
        return Err(anyhow!("cannot write '{}': it is a folder; name a file in it", file.display()).into());
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
    splatline_sim::atomic::write(path, bytes).with_context(|| format!("cannot write '{}'", path.display()))?;
    Ok(())
}
