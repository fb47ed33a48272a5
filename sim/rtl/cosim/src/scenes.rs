//! Scenes with their cameras: captured ones, where their data is at hand, and synthetic ones.

use crate::unit::Missing;
use anyhow::{Context, Result};
use splatline_sim::camera::Camera;
use splatline_sim::scene::points::{self, spheres};
use splatline_sim::scene::{self, Scene, synthetic};
use std::path::Path;

/// A scene, seen.
pub struct Seen {
    pub name: &'static str,
    pub scene: Scene,
    pub camera: Camera,
}

impl Seen {
    /// So many random Gaussians by a seed and a size, in a picture of so many columns and rows.
    pub fn random(name: &'static str, of: (usize, u64, f64), pixels: [usize; 2]) -> Seen {
        Seen {
            name,
            scene: synthetic::random_gaussians(of.0, of.1, of.2),
            camera: synthetic::camera(pixels[0], pixels[1]),
        }
    }
}

/// The scenes of whole pictures: captured ones, the lion scanned as round volume splats, and twenty thousand large,
/// nearly transparent splats.
pub const SCENES: [&str; 5] = ["guitar", "playbot", "lion", "aneurism", "deep stack"];

/// The named of [`SCENES`] in square pictures of so many pixels a side; the names of those whose data is not at hand go
/// to `missing`.
pub fn scenes(names: &[&'static str], size: usize, missing: &mut Missing) -> Result<Vec<Seen>> {
    let mut all = Vec::new();
    for name in names {
        match seen(name, size)? {
            Some(seen) => all.push(seen),
            None => missing.push(*name),
        }
    }
    Ok(all)
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

/// A scene with its camera for so many pixels a side, by a name of [`SCENES`]; nothing where its data is missing.
fn seen(name: &'static str, size: usize) -> Result<Option<Seen>> {
    let shared = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../../shared/data");
    let file = Path::new(shared).join(match name {
        "guitar" => "gaussians/guitar.ply",
        "playbot" => "gaussians/playbot_lod4.ply",
        "lion" => "points/lion_takanawa.ply",
        _ => "volumes/aneurism.nhdr",
    });
    let scene = match name {
        "deep stack" => synthetic::deep_stack(1),
        _ if !file.exists() => return Ok(None),
        "lion" => spheres::as_spheres(&points::load(&file)?, spheres::LION_DEVIATION),
        _ => scene::load(&file, &Default::default())?,
    };
    let looking = |eye, target, up, degrees| Camera::look_at(eye, target, up, degrees, size, size);
    let camera = match name {
        // From close up.
        "guitar" => looking([2.2, -1.2, 0.5], [0.1, -1.2, 0.1], [0.0, -1.0, 0.0], 50.0),
        "lion" => looking([4.11, 3.88, -0.16], [-2.89, 3.88, -1.16], scene.up, 45.0),
        "playbot" => Ok(resized(scene.default_camera(640, 480), size)),
        _ => Ok(scene.default_camera(size, size)),
    };
    let camera = camera.with_context(|| format!("the camera of {name}"))?;
    Ok(Some(Seen {
        name,
        scene,
        camera,
    }))
}
