//! From options to what the engines need: scene, camera, rules, threads.

use super::Failure;
use super::args::{AntialiasChoice, OrbitChoice, Size, Vector, ViewOptions};
use super::progress::Progress;
use anyhow::anyhow;
use splatline_sim::camera::Camera;
use splatline_sim::cameras;
use splatline_sim::framing::{Frame, USUAL_FOV, orbited};
use splatline_sim::hybrid::spacing;
use splatline_sim::rules::{Antialias, Rules};
use splatline_sim::scene::{self, LoadOptions, Scene};
use std::num::NonZero;
use std::path::Path;
use std::time::Instant;

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
    /// Seconds that loading and classifying took.
    pub prepare_s: f64,
}

impl View {
    /// Loads the scene and places the camera.
    pub fn from_options(options: &ViewOptions) -> Result<View, Failure> {
        let started = Instant::now();
        let progress = Progress::spinner(format!("loading {}", options.scene.display()));
        let light = options.light.map(|Vector(direction)| direction);
        let load_options = LoadOptions {
            transfer: options.transfer.clone(),
            light,
        };
        let (scene, notes) = scene::load_with_notes(&options.scene, &load_options)?;
        let camera = camera(options, scene.up, || {
            Frame::of_scene(&scene, options.up.map(|Vector(up)| up))
        })?;
        drop(progress);
        for note in notes {
            super::complain(&format!("{}: {note}\n", scene.name));
        }
        let rules = rules(options, &scene);
        Ok(View {
            scene,
            camera,
            rules,
            prepare_s: started.elapsed().as_secs_f64(),
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

/// The camera of the options, or one that shows the whole scene. `up` is used where the options do not say.
pub fn camera(
    options: &ViewOptions,
    up: [f64; 3],
    frame: impl FnOnce() -> Frame,
) -> Result<Camera, Failure> {
    let camera = match (&options.camera, options.eye, options.target) {
        (Some(path), ..) => camera_from_file(path, options)?,
        (None, Some(Vector(eye)), Some(Vector(target))) => {
            camera_from_eye(eye, target, up, options)?
        }
        _ => framed(&frame(), options)?,
    };
    Ok(match options.zoom {
        Some(factor) => camera.zoomed(factor)?,
        None => camera,
    })
}

fn camera_from_file(path: &Path, options: &ViewOptions) -> Result<Camera, Failure> {
    let size = options.size.map(|size| [size.width, size.height]);
    let pose = cameras::choose(cameras::load(path, size)?, options.image.as_deref())
        .map_err(|problem| anyhow!("camera file '{}' {problem}", path.display()))?;
    for note in &pose.notes {
        super::complain(&format!("{}: {note}\n", pose.name));
    }
    let camera = pose.camera;
    match options.size {
        Some(size) => Ok(camera.resized(size.width, size.height)?),
        None => Ok(camera),
    }
}

fn camera_from_eye(
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    options: &ViewOptions,
) -> Result<Camera, Failure> {
    let Size { width, height } = options.size.unwrap_or(USUAL_SIZE);
    let up = options.up.map_or(up, |Vector(up)| up);
    let fov = options.fov.unwrap_or(USUAL_FOV);
    let eye = match options.orbit {
        Some(OrbitChoice(orbit)) => orbited(eye, target, up, orbit),
        None => eye,
    };
    Camera::look_at(eye, target, up, fov, width, height).map_err(|error| {
        Failure::Usage(format!("--eye, --target and --up make no camera: {error}"))
    })
}

/// The whole scene, and a line that tells by which rule.
fn framed(frame: &Frame, options: &ViewOptions) -> Result<Camera, Failure> {
    let Size { width, height } = options.size.unwrap_or(USUAL_SIZE);
    let fov = options.fov.unwrap_or(USUAL_FOV);
    let orbit = options.orbit.map(|OrbitChoice(orbit)| orbit);
    let camera = frame
        .camera(orbit, fov, width, height)
        .map_err(|error| Failure::Usage(format!("the scene cannot be framed: {error}")))?;
    super::say(&format!("{}\n", frame.describe(fov)));
    Ok(camera)
}

/// The number of threads asked for, or one per processor.
pub fn threads(asked: Option<usize>) -> usize {
    asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get))
}
