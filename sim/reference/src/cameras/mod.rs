//! Cameras that others wrote: one or many per file, each with a name to choose it by.
//!
//! | what | recognised by | convention |
//! |---|---|---|
//! | our camera file, or a report.json | JSON with `world_to_camera` or `camera` | [`Camera`] |
//! | COLMAP, text and binary | a folder with `cameras` and `images`, or one of these files | `colmap` |
//! | nerfstudio, Blender | JSON with `frames` | `transforms` |
//! | the 3D Gaussian trainer | JSON that is a list | `trainer` |
//!
//! All but the first come from photographs, whose lenses may bend straight lines. A camera here is a pinhole:
//! distortion is never left out in silence, but told with the pixels by which it moves the picture's corners
//! ([`CameraPose::notes`]), and photographs are undistorted by [`CameraPose::lens`].

mod colmap;
pub mod lens;
mod trainer;
mod transforms;

#[cfg(test)]
mod tests;

use crate::camera::{Camera, CameraError};
use crate::input;
use crate::vector::{self, Vector};
use anyhow::anyhow;
use lens::Lens;
use std::path::Path;

/// A camera and what it is called in its file.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPose {
    /// The picture's name.
    pub name: String,
    /// From where.
    pub camera: Camera,
    /// By how much an entry of its rotation was corrected.
    pub correction: f64,
    /// What the file calls that rotation.
    pub rotation_field: &'static str,
    /// What the file says that is not drawn.
    pub notes: Vec<String>,
    /// Of photographs, with what it bends.
    pub lens: Option<Lens>,
}

/// What a reader gives: problems are plain sentences, [`load`] puts the file before them.
type Read = anyhow::Result<Vec<CameraPose>>;

/// Names listed where one has to be chosen.
const LISTED: usize = 5;

/// All cameras of a file or folder. `size` is used where a file has none.
pub fn load(path: &Path, size: Option<[usize; 2]>) -> Result<Vec<CameraPose>, CameraError> {
    let wrong = |problem: anyhow::Error| CameraError::whole(problem.to_string()).in_file(path);
    if let Some(folder) = colmap::folder(path) {
        return colmap::load(&folder).map_err(wrong);
    }
    let listed = ["transforms.json", "cameras.json"].map(|name| path.join(name));
    if let Some(file) = listed.iter().find(|file| file.is_file()) {
        return load(file, size);
    }
    if path.is_dir() {
        let problem = "is a folder and not a regular file, and holds no cameras and images (.txt or .bin) of COLMAP, also in sparse/0: name a file";
        return Err(CameraError::whole(problem.to_owned()).in_file(path));
    }
    // What cannot be read is left to our own reader, whose messages name the fields.
    let text = input::text(path, input::TABLE).unwrap_or_default();
    if text.trim_start().starts_with('[') {
        return trainer::parse(&text).map_err(wrong);
    }
    if serde_json::from_str::<HasFrames>(&text).is_ok() {
        return transforms::parse(&text, size).map_err(wrong);
    }
    Ok(vec![own(path)?])
}

fn own(path: &Path) -> Result<CameraPose, CameraError> {
    let (camera, correction) = Camera::corrected_from_json_file(path)?;
    let name = path.file_name().unwrap_or_default();
    Ok(CameraPose {
        name: name.to_string_lossy().into_owned(),
        camera,
        correction,
        rotation_field: "world_to_camera",
        notes: Vec::new(),
        lens: None,
    })
}

/// What tells nerfstudio's files.
#[derive(serde::Deserialize)]
struct HasFrames {
    #[serde(rename = "frames")]
    _frames: serde::de::IgnoredAny,
}

/// The one pose there is, or the one of that name: the whole name, the file's name without folders, or without its
/// extension.
pub fn choose(poses: Vec<CameraPose>, name: Option<&str>) -> Result<CameraPose, String> {
    let names: Vec<&str> = poses
        .iter()
        .map(|pose| pose.name.as_str())
        .take(LISTED)
        .collect();
    let listed = names.join(", ");
    let more = if poses.len() > LISTED { ", ..." } else { "" };
    let Some(wanted) = name else {
        let count = poses.len();
        let mut poses = poses.into_iter();
        return match (poses.next(), poses.next()) {
            (Some(only), None) => Ok(only),
            _ => Err(format!(
                "holds {count} cameras: choose one by --image NAME ({listed}{more})"
            )),
        };
    };
    for level in 0..3 {
        let is_wanted = |pose: &&CameraPose| {
            let path = Path::new(&pose.name);
            let tails = [Some(path.as_os_str()), path.file_name(), path.file_stem()];
            tails[level].is_some_and(|tail| tail == wanted)
        };
        let matching: Vec<&CameraPose> = poses.iter().filter(is_wanted).collect();
        match matching[..] {
            [one] => return Ok(one.clone()),
            [] => {}
            _ => {
                let count = matching.len();
                return Err(format!(
                    "holds {count} cameras called '{wanted}': give the name in full"
                ));
            }
        }
    }
    Err(format!(
        "holds no camera called '{wanted}': it has {listed}{more}"
    ))
}

/// A photograph's camera, checked and corrected as every camera is; `rotation` and `translation` take the world to it.
fn photograph(
    name: String,
    lens: Lens,
    (rotation_field, rotation): (&'static str, [Vector; 3]),
    translation: Vector,
) -> anyhow::Result<CameraPose> {
    let [width, height] = lens
        .size
        .map(|side| usize::try_from(side).unwrap_or(usize::MAX));
    let camera = Camera {
        fy: lens.focal[1],
        cx: lens.principal[0],
        cy: lens.principal[1],
        rotation,
        translation,
        ..Camera::centred(width, height, lens.focal[0])
    };
    let sound = camera.sound().map_err(|error| match error.field {
        Some(field) => anyhow!("{field} {}", error.problem),
        None => anyhow!(error.problem),
    });
    let (camera, correction) = sound?;
    Ok(CameraPose {
        name,
        camera,
        correction,
        rotation_field,
        notes: lens.note().into_iter().collect(),
        lens: Some(lens),
    })
}

/// From a camera's axes and place in the world to what takes the world to the camera; `axes` are its columns, of
/// length 1 but for the six digits that files write.
fn inverted(axes: [Vector; 3], place: Vector) -> ([Vector; 3], Vector) {
    let axes = axes.map(|axis| {
        let length = vector::length(axis);
        if length > 0.0 && (length - 1.0).abs() < 1e-3 {
            vector::scale(1.0 / length, axis)
        } else {
            axis
        }
    });
    let translation = vector::scale(-1.0, vector::transform(&axes, place));
    (axes, translation)
}
