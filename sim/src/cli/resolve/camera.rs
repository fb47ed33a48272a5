//! From options to a camera: a file's, one between eye and target, or one that shows the whole scene.

use crate::camera::{Camera, CameraError, NOTABLE_CORRECTION};
use crate::cameras::{self, CameraPose};
use crate::cli::say::{print_error, print_result, usage};
use crate::cli::view_args::CameraArgs;
use crate::framing::{Ball, FramingInput, USUAL_FOV, orbited};
use crate::scene::Scene;
use anyhow::{Error, Result, anyhow, ensure};
use std::path::Path;

/// Where neither a camera file nor `--size` says otherwise.
pub(super) const USUAL_SIZE: [usize; 2] = [512, 512];

/// The camera of the options, or one that shows the whole scene (a capture that is `filling` fills the picture), and
/// what had to be corrected. `up` is used where the options do not say.
pub(super) fn camera(
    options: &CameraArgs,
    up: [f64; 3],
    scene: &Path,
    frame: impl FnOnce() -> FramingInput,
    filling: Option<&Scene>,
) -> Result<(Camera, Vec<String>)> {
    let (camera, warnings) = match (&options.file, options.eye, options.target) {
        (Some(path), ..) => {
            let pose = pose_of(path, options.size, options.image.as_deref())?;
            for note in &pose.notes {
                print_error(&format!("{}: {note}\n", pose.name));
            }
            with_size(path, pose, options)?
        }
        (None, Some(eye), Some(target)) => (camera_from_eye(eye, target, up, options)?, Vec::new()),
        _ => match trained_camera(scene, options)? {
            Some(found) => found,
            None => (framed(&frame(), filling, scene, options)?, Vec::new()),
        },
    };
    let camera = match options.zoom {
        Some(factor) => camera.zoomed(factor)?,
        None => camera,
    };
    Ok((camera, warnings))
}

/// A camera of a file that may hold several.
pub fn pose_of(path: &Path, size: Option<[usize; 2]>, image: Option<&str>) -> Result<CameraPose> {
    let chosen = cameras::choose(cameras::load(path, size)?, image);
    chosen.map_err(|problem| anyhow!("camera file '{}' {problem}", path.display()))
}

/// The first camera that a trainer's folder was trained with, where nothing is said about the view.
fn trained_camera(scene: &Path, options: &CameraArgs) -> Result<Option<(Camera, Vec<String>)>> {
    let file = scene.join("cameras.json");
    let is_said = options.orbit.is_some() || options.fov.is_some() || options.up.is_some();
    if is_said || !file.is_file() {
        return Ok(None);
    }
    let poses = cameras::load(&file, None)?;
    let count = poses.len();
    let Some(first) = poses.into_iter().next() else {
        return Ok(None);
    };
    print_result(&format!(
        "camera: {}, the first of {count} in cameras.json; --camera {} --image NAME takes another\n",
        first.name,
        scene.display()
    ))?;
    with_size(&file, first, options).map(Some)
}

/// A file's camera with the picture's size that is asked for; a rotation that was corrected, and what that size
/// stretches, are told.
fn with_size(path: &Path, pose: CameraPose, options: &CameraArgs) -> Result<(Camera, Vec<String>)> {
    let (camera, change, field) = (pose.camera, pose.correction, pose.rotation_field);
    let mut warnings = Vec::new();
    if change > NOTABLE_CORRECTION {
        warnings.push(format!(
            "camera file '{}': '{field}' is a rotation only nearly; the nearest one is used, which changes entries by up to {change:.1e}",
            path.display()
        ));
    }
    let Some([width, height]) = options.size else {
        return Ok((camera, warnings));
    };
    let across = width as f64 / camera.width as f64;
    let down = height as f64 / camera.height as f64;
    if (across / down - 1.0).abs() > 0.01 {
        warnings.push(format!(
            "--size {width}x{height} has another aspect than the camera's {}x{}: the picture is stretched by {:.3} across",
            camera.width,
            camera.height,
            across / down
        ));
    }
    Ok((camera.resized(width, height)?, warnings))
}

fn camera_from_eye(
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    options: &CameraArgs,
) -> Result<Camera> {
    let [width, height] = options.size.unwrap_or(USUAL_SIZE);
    let up = options.up.unwrap_or(up);
    let fov = options.fov.unwrap_or(USUAL_FOV);
    let eye = match options.orbit {
        Some(orbit) => orbited(eye, target, up, orbit),
        None => eye,
    };
    Camera::look_at(eye, target, up, fov, width, height)
        .map_err(|error| usage(format!("--eye, --target and --up make no camera: {error}")))
}

/// An automatic camera, unless the scene's coordinates are so large that it cannot be placed: their squares overflow
/// beyond 1e154.
pub fn sound_camera(camera: Camera, scene: &str) -> Result<Camera> {
    ensure!(camera.is_sound(), too_large(scene));
    Ok(camera)
}

fn too_large(scene: &str) -> Error {
    anyhow!(
        "{scene}: its coordinates are too large or too far apart to place a camera: remove what lies far outside, or scale the scene"
    )
}

/// The whole scene, or as much as fills the picture with `filling`, and a line that tells by which rule.
fn framed(
    frame: &FramingInput,
    filling: Option<&Scene>,
    scene: &Path,
    options: &CameraArgs,
) -> Result<Camera> {
    let [width, height] = options.size.unwrap_or(USUAL_SIZE);
    let fov = options.fov.unwrap_or(USUAL_FOV);
    let scene = scene.display().to_string();
    let place = |frame: &FramingInput| frame.camera(options.orbit, fov, width, height);
    let camera = match place(frame) {
        Ok(camera) => sound_camera(camera, &scene)?,
        Err(error) => return Err(why_not_framed(error, frame, &scene, place)),
    };
    let (camera, outside) = match filling {
        Some(splats) => frame.filled(camera, splats),
        None => (camera, 0),
    };
    let mut described = frame.describe(fov);
    if outside > 0 {
        described += &format!("; {outside} outlying splats do not count");
    }
    print_result(&format!("{described}\n"))?;
    Ok(camera)
}

/// Whose fault it is: of the scene if a ball of usual size can be framed, of the options otherwise.
fn why_not_framed(
    error: CameraError,
    frame: &FramingInput,
    scene: &str,
    place: impl Fn(&FramingInput) -> Result<Camera, CameraError>,
) -> Error {
    let usual = FramingInput {
        ball: Ball {
            centre: [0.0; 3],
            radius: 1.0,
            strays: 0,
        },
        ..frame.clone()
    };
    match place(&usual) {
        Ok(_) => too_large(scene),
        Err(_) => usage(format!("the scene cannot be framed: {error}")),
    }
}
