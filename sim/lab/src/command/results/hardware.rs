//! The pages about the machine: throughput and designs.
//!
//! Scenes that lie in the data folder are measured; a scene that is missing is named in the tables as not measured.

use super::{designs, throughput};
use anyhow::Result;
use splatline_sim::camera::Camera;
use splatline_sim::cli::write;
use splatline_sim::cli::{Failure, print_result};
use splatline_sim::progress::ProgressMeter;
use splatline_sim::rules::Rules;
use splatline_sim::scene::points::{self, spheres};
use splatline_sim::scene::{self, LoadOptions, Scene};
use std::path::Path;

/// The scan that is drawn as spheres.
const LION: &str = "points/lion_takanawa.ply";

/// Columns and rows of every picture.
const SIZE: usize = 512;

/// A scene as it is measured.
pub struct HardwareScene {
    pub name: &'static str,
    pub scene: Scene,
    pub camera: Camera,
    pub rules: Rules,
}

/// Where a captured scene is seen from.
struct Viewpoint {
    name: &'static str,
    file: &'static str,
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    fov: f64,
}

const GUITAR: &str = "gaussians/guitar.ply";
const PLAYBOT: &str = "gaussians/playbot_lod4.ply";

/// The captured scenes. The first three are y-down, the last z-up.
const PLACES: [Viewpoint; 4] = [
    seen("guitar", GUITAR, [5.5, -2.1, 0.2], [0.1, -2.1, 0.1], 50.0),
    seen(
        "guitar, close",
        GUITAR,
        [2.2, -1.2, 0.5],
        [0.1, -1.2, 0.1],
        50.0,
    ),
    seen(
        "playbot",
        PLAYBOT,
        [2.2, -1.4, 2.2],
        [0.0, -0.45, 0.0],
        45.0,
    ),
    Viewpoint {
        up: [0.0, 0.0, 1.0],
        ..seen(
            "lion",
            LION,
            [4.11, 3.88, -0.16],
            [-2.89, 3.88, -1.16],
            45.0,
        )
    },
];

/// A place in a captured scene of which -y is up.
const fn seen(
    name: &'static str,
    file: &'static str,
    eye: [f64; 3],
    target: [f64; 3],
    fov: f64,
) -> Viewpoint {
    Viewpoint {
        name,
        file,
        eye,
        target,
        up: [0.0, -1.0, 0.0],
        fov,
    }
}

/// Writes the tables of throughput and designs into `output`.
pub fn run(data: &Path, output: &Path) -> Result<(), Failure> {
    let (subjects, missing) = subjects(data)?;
    let progress = ProgressMeter::new(subjects.len());
    let tables = throughput::measure(&subjects, &progress)?;
    drop(progress);
    let text = throughput::text(&tables, &missing);
    write(&output.join("throughput.md"), text.as_bytes())?;
    print_result(&text)?;
    designs::write_all(subjects, output)
}

/// The scenes at hand, and the names of those that are not.
pub fn subjects(data: &Path) -> Result<(Vec<HardwareScene>, Vec<&'static str>)> {
    let mut subjects = vec![demo()?];
    let mut missing = Vec::new();
    for place in &PLACES {
        match subject(data, place)? {
            Some(subject) => subjects.push(subject),
            None => missing.push(place.name),
        }
    }
    Ok((subjects, missing))
}

fn demo() -> Result<HardwareScene> {
    let scene = scene::demo()?;
    let (camera, rules) = (scene.default_camera(SIZE, SIZE), scene.natural_rules);
    Ok(HardwareScene {
        name: "MR head (demo)",
        scene,
        camera,
        rules,
    })
}

/// A captured scene, unless its file is missing.
fn subject(data: &Path, place: &Viewpoint) -> Result<Option<HardwareScene>> {
    let path = data.join(place.file);
    if !path.exists() {
        return Ok(None);
    }
    let (scene, rules) = if place.file == LION {
        let cloud = points::load(&path)?;
        (
            spheres::as_spheres(&cloud, spheres::LION_DEVIATION),
            spheres::RULES,
        )
    } else {
        let scene = scene::load(&path, &LoadOptions::default())?;
        let rules = scene.natural_rules;
        (scene, rules)
    };
    let camera = Camera::look_at(place.eye, place.target, place.up, place.fov, SIZE, SIZE)?;
    Ok(Some(HardwareScene {
        name: place.name,
        scene,
        camera,
        rules,
    }))
}
