//! Scenes with their cameras: captured ones, where their data is at hand, and synthetic ones.

use anyhow::{Context, Result};
use splatline_sim::camera::Camera;
use splatline_sim::scene::points::{self, spheres};
use splatline_sim::scene::{self, Scene, synthetic};
use std::path::{Path, PathBuf};

/// A scene, seen.
#[derive(Clone)]
pub struct Seen {
    /// Its name.
    pub name: &'static str,
    /// The scene.
    pub scene: Scene,
    /// The camera.
    pub camera: Camera,
}

/// The scenes of whole pictures.
pub const SCENES: [&str; 5] = ["guitar", "playbot", "lion", "aneurism", "deep stack"];

/// The named of [`SCENES`] in square pictures of so many pixels a side; the names of those whose data is not at hand go to `missing`.
pub fn scenes(
    names: &[&'static str],
    size: usize,
    missing: &mut Vec<&'static str>,
) -> Result<Vec<Seen>> {
    let mut seen = Vec::new();
    for name in names {
        let found = match *name {
            "guitar" => guitar(size)?,
            "playbot" => playbot()?,
            "lion" => lion(size)?,
            "aneurism" => aneurism(size)?,
            _ => Some(deep_stack(size)),
        };
        match found {
            Some((scene, camera)) => seen.push(Seen {
                name,
                scene,
                camera: resized(camera, size),
            }),
            None => missing.push(*name),
        }
    }
    Ok(seen)
}

/// The same view in a square picture of another size.
fn resized(camera: Camera, size: usize) -> Camera {
    let scale = size as f64 / camera.height as f64;
    let shift = (camera.width as f64 * scale - size as f64) / 2.0;
    Camera {
        fx: camera.fx * scale,
        fy: camera.fy * scale,
        cx: camera.cx * scale - shift,
        cy: camera.cy * scale,
        width: size,
        height: size,
        ..camera
    }
}

/// The shared data's file, where it exists.
fn shared(path: &str) -> Option<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../../shared/data");
    let path = Path::new(folder).join(path);
    path.exists().then_some(path)
}

/// The captured guitar from close up.
fn guitar(size: usize) -> Result<Option<(Scene, Camera)>> {
    let Some(file) = shared("gaussians/guitar.ply") else {
        return Ok(None);
    };
    let scene = scene::load(&file, &Default::default())?;
    let (eye, target) = ([2.2, -1.2, 0.5], [0.1, -1.2, 0.1]);
    let camera = Camera::look_at(eye, target, [0.0, -1.0, 0.0], 50.0, size, size);
    Ok(Some((scene, camera.context("the guitar's camera")?)))
}

/// The captured scene with harmonics.
pub fn playbot() -> Result<Option<(Scene, Camera)>> {
    let Some(file) = shared("gaussians/playbot_lod4.ply") else {
        return Ok(None);
    };
    let scene = scene::load(&file, &Default::default())?;
    let camera = scene.default_camera(640, 480);
    Ok(Some((scene, camera)))
}

/// The scanned lion as round volume splats.
fn lion(size: usize) -> Result<Option<(Scene, Camera)>> {
    let Some(file) = shared("points/lion_takanawa.ply") else {
        return Ok(None);
    };
    let scene = spheres::as_spheres(&points::load(&file)?, spheres::LION_DEVIATION);
    let (eye, target) = ([4.11, 3.88, -0.16], [-2.89, 3.88, -1.16]);
    let camera = Camera::look_at(eye, target, scene.up, 45.0, size, size);
    Ok(Some((scene, camera.context("the lion's camera")?)))
}

fn aneurism(size: usize) -> Result<Option<(Scene, Camera)>> {
    let Some(file) = shared("volumes/aneurism.nhdr") else {
        return Ok(None);
    };
    let scene = scene::load(&file, &Default::default())?;
    let camera = scene.default_camera(size, size);
    Ok(Some((scene, camera)))
}

/// Twenty thousand large, nearly transparent splats.
fn deep_stack(size: usize) -> (Scene, Camera) {
    let scene = synthetic::deep_stack(1);
    let camera = scene.default_camera(size, size);
    (scene, camera)
}
