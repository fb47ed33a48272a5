//! From options to what the engines need: scene, camera, rules, threads.

use super::Failure;
use super::args::{AntialiasChoice, OrbitChoice, Size, Vector, ViewOptions};
use super::progress::Progress;
use super::say;
use crate::camera::{Camera, CameraError, NOTABLE_CORRECTION};
use crate::cameras::{self, Pose};
use crate::framing::{Ball, Frame, USUAL_FOV, orbited};
use crate::hybrid::spacing;
use crate::memory;
use crate::rules::{Antialias, Rules};
use crate::scene::{self, LoadOptions, Scene};
use anyhow::anyhow;
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
    /// What is drawn.
    pub scene: Scene,
    /// From where.
    pub camera: Camera,
    /// How it blends.
    pub rules: Rules,
    /// What was changed on the way in; for reports and stderr.
    pub warnings: Vec<String>,
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
        let (camera, warnings) = camera(options, scene.up, || {
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
            warnings,
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

/// The camera of the options, or one that shows the whole scene, and what had to be corrected. `up` is used where the options do not say.
pub fn camera(
    options: &ViewOptions,
    up: [f64; 3],
    frame: impl FnOnce() -> Frame,
) -> Result<(Camera, Vec<String>), Failure> {
    let (camera, warnings) = match (&options.camera, options.eye, options.target) {
        (Some(path), ..) => camera_from_file(path, options)?,
        (None, Some(Vector(eye)), Some(Vector(target))) => {
            (camera_from_eye(eye, target, up, options)?, Vec::new())
        }
        _ => (framed(&frame(), options)?, Vec::new()),
    };
    let camera = match options.zoom {
        Some(factor) => camera.zoomed(factor)?,
        None => camera,
    };
    Ok((camera, warnings))
}

fn camera_from_file(path: &Path, options: &ViewOptions) -> Result<(Camera, Vec<String>), Failure> {
    let size = options.size.map(|size| [size.width, size.height]);
    let pose = cameras::choose(cameras::load(path, size)?, options.image.as_deref())
        .map_err(|problem| anyhow!("camera file '{}' {problem}", path.display()))?;
    for note in &pose.notes {
        super::complain(&format!("{}: {note}\n", pose.name));
    }
    let warnings = correction(path, &pose);
    let camera = match options.size {
        Some(size) => pose.camera.resized(size.width, size.height)?,
        None => pose.camera,
    };
    Ok((camera, warnings))
}

/// What to say about a rotation that was corrected.
fn correction(path: &Path, pose: &Pose) -> Vec<String> {
    let (change, field) = (pose.correction, pose.rotation_field);
    if change <= NOTABLE_CORRECTION {
        return Vec::new();
    }
    let file = path.display();
    vec![format!(
        "camera file '{file}': '{field}' is a rotation only nearly; the nearest one is used, which changes entries by up to {change:.1e}"
    )]
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

/// An automatic camera, unless the scene's coordinates are so large that it cannot be placed: their squares overflow beyond 1e154.
pub fn sound_camera(camera: Camera, scene: &str) -> Result<Camera, Failure> {
    match camera.is_sound() {
        true => Ok(camera),
        false => Err(too_large(scene)),
    }
}

fn too_large(scene: &str) -> Failure {
    anyhow!(
        "{scene}: its coordinates are too large or too far apart to place a camera: remove what lies far outside, or scale the scene"
    )
    .into()
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

/// The whole scene, and a line that tells by which rule.
fn framed(frame: &Frame, options: &ViewOptions) -> Result<Camera, Failure> {
    let Size { width, height } = options.size.unwrap_or(USUAL_SIZE);
    let fov = options.fov.unwrap_or(USUAL_FOV);
    let orbit = options.orbit.map(|OrbitChoice(orbit)| orbit);
    let scene = options.scene.display().to_string();
    let place = |frame: &Frame| frame.camera(orbit, fov, width, height);
    let camera = match place(frame) {
        Ok(camera) => sound_camera(camera, &scene)?,
        Err(error) => return Err(why_not_framed(error, frame, &scene, place)),
    };
    say(&format!("{}\n", frame.describe(fov)))?;
    Ok(camera)
}

/// Whose fault it is: of the scene if a ball of usual size can be framed, of the options otherwise.
fn why_not_framed(
    error: CameraError,
    frame: &Frame,
    scene: &str,
    place: impl Fn(&Frame) -> Result<Camera, CameraError>,
) -> Failure {
    let usual = Frame {
        ball: Ball {
            centre: [0.0; 3],
            radius: 1.0,
            strays: 0,
        },
        ..frame.clone()
    };
    match place(&usual) {
        Ok(_) => too_large(scene),
        Err(_) => Failure::Usage(format!("the scene cannot be framed: {error}")),
    }
}

/// The number of threads asked for, or one per processor.
pub fn threads(asked: Option<usize>) -> usize {
    asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get))
}
