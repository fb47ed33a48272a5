//! The scenes and cameras that results are measured on (DESIGN section 7).

use anyhow::{Context, Result};
use splatline_sim::camera::Camera;
use splatline_sim::scene::{LoadOptions, Scene, load};
use std::path::Path;

/// A scene, its camera and its name in tables.
#[derive(Clone, Debug)]
pub struct CapturedView {
    /// Name in tables.
    pub name: &'static str,
    /// The scene.
    pub scene: Scene,
    /// The camera.
    pub camera: Camera,
}

struct ViewEntry {
    name: &'static str,
    file: &'static str,
    /// Eye, target and vertical field of view in degrees; the scene's own camera if absent.
    pose: Option<([f64; 3], [f64; 3], f64)>,
}

const ENTRIES: [ViewEntry; 5] = [
    ViewEntry {
        name: "guitar close-up",
        file: "gaussians/guitar.ply",
        pose: Some(([2.2, -1.2, 0.5], [0.1, -1.2, 0.1], 50.0)),
    },
    ViewEntry {
        name: "playbot_lod4",
        file: "gaussians/playbot_lod4.ply",
        pose: Some(([2.2, -1.4, 2.2], [0.0, -0.45, 0.0], 45.0)),
    },
    ViewEntry {
        name: "brainsmall",
        file: "volumes/brainsmall.nhdr",
        pose: None,
    },
    ViewEntry {
        name: "aneurism",
        file: "volumes/aneurism.nhdr",
        pose: None,
    },
    ViewEntry {
        name: DEEP_STACK,
        file: "deep-stack",
        pose: None,
    },
];

/// Name of the stack of 20,000 faint splats.
pub const DEEP_STACK: &str = "deep stack";

/// Loads every view whose scene lies under `data`, `size` pixels square.
pub fn load_all(data: &Path, size: usize) -> Result<Vec<CapturedView>> {
    ENTRIES
        .iter()
        .map(|entry| load_view(entry, data, size))
        .collect()
}

fn load_view(entry: &ViewEntry, data: &Path, size: usize) -> Result<CapturedView> {
    let path = if entry.name == DEEP_STACK {
        entry.file.into()
    } else {
        data.join(entry.file)
    };
    let scene = load(&path, &LoadOptions::default())?;
    let camera = match entry.pose {
        None => scene.default_camera(size, size),
        Some((eye, target, degrees)) => {
            Camera::look_at(eye, target, [0.0, -1.0, 0.0], degrees, size, size)
                .with_context(|| format!("the camera of {}", entry.name))?
        }
    };
    Ok(CapturedView {
        name: entry.name,
        scene,
        camera,
    })
}
