//! A camera path: many cameras, one frame each.
//!
//! Cameras come from whatever file holds several (COLMAP, transforms.json, cameras.json), in its order, or from key
//! frames in TOML, between which eye, target and field of view follow a Catmull-Rom spline, which passes through every
//! key and turns no corners:
//!
//! ```toml
//! frames = 100            # 1 to 100000, spread evenly over the keys
//! [[key]]
//! eye = [5.5, -2.1, 0.2]
//! target = [0.1, -2.1, 0.1]
//! up = [0.0, -1.0, 0.0]   # left out: the scene's
//! fov = 50.0              # degrees, left out: 45
//! ```

use crate::camera::Camera;
use crate::cameras;
use crate::framing::USUAL_FOV;
use crate::input::{self, line_of};
use crate::vector::Vector;
use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::path::Path;

/// Frames of a path at most: more than an hour of pictures.
const MOST_FRAMES: usize = 100_000;

/// Where frames come from.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraPath {
    /// A file's cameras by name.
    Cameras(Vec<(String, Camera)>),
    /// Key frames.
    Keys(KeyFrames),
}

/// The file of key frames.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeyFrames {
    #[serde(skip)]
    file: String,
    frames: usize,
    key: Vec<CameraKey>,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraKey {
    eye: Vector,
    target: Vector,
    up: Option<Vector>,
    fov: Option<f64>,
}

/// A path and what its file says that is not drawn, each once.
pub type LoadedPath = (CameraPath, BTreeSet<String>);

/// Reads a path. `size` is used where a file of cameras has none, and replaces the size that it has.
pub fn load(file: &Path, size: Option<[usize; 2]>) -> Result<LoadedPath> {
    let shown = file.display().to_string();
    if file
        .extension()
        .is_some_and(|extension| extension == "toml")
    {
        let text =
            input::text(file, input::SETTINGS).with_context(|| format!("cannot read '{shown}'"))?;
        return Ok((CameraPath::Keys(keys(&shown, &text)?), BTreeSet::new()));
    }
    let mut notes = BTreeSet::new();
    let mut named = Vec::new();
    for pose in cameras::load(file, size)? {
        notes.extend(pose.notes);
        let camera = match size {
            Some([width, height]) => {
                let resized = pose.camera.resized(width, height);
                resized.with_context(|| format!("camera path '{shown}', {}", pose.name))?
            }
            None => pose.camera,
        };
        named.push((pose.name, camera));
    }
    ensure!(!named.is_empty(), "camera path '{shown}' holds no cameras");
    Ok((CameraPath::Cameras(named), notes))
}

/// Key frames from the text of their file.
fn keys(file: &str, text: &str) -> Result<KeyFrames> {
    let mut keys: KeyFrames =
        toml::from_str(text).with_context(|| format!("{file}: not a camera path"))?;
    if !(1..=MOST_FRAMES).contains(&keys.frames) {
        let line = line_of(text, &["frames"]);
        bail!(
            "{file}:{line}: frames = {}: allowed are 1 to {MOST_FRAMES}",
            keys.frames
        );
    }
    file.clone_into(&mut keys.file);
    ensure!(
        !keys.key.is_empty(),
        "{file}: no [[key]]: a path needs one or more"
    );
    Ok(keys)
}

impl CameraPath {
    /// Its cameras by name; what key frames leave open is taken from the scene and from the picture asked for.
    pub fn cameras(&self, up: Vector, size: [usize; 2]) -> Result<Vec<(String, Camera)>> {
        match self {
            CameraPath::Cameras(named) => Ok(named.clone()),
            CameraPath::Keys(keys) => (0..keys.frames)
                .map(|frame| {
                    let name = format!("frame {}", frame + 1);
                    let camera = keys.camera(frame, up, size);
                    let place = || format!("camera path '{}', {name}", keys.file);
                    Ok((name.clone(), camera.with_context(place)?))
                })
                .collect(),
        }
    }
}

impl KeyFrames {
    fn camera(&self, frame: usize, up: Vector, [width, height]: [usize; 2]) -> Result<Camera> {
        let last = self.key.len() - 1;
        let at = match self.frames {
            1 => 0.0,
            frames => frame as f64 * last as f64 / (frames - 1) as f64,
        };
        let from = (at.floor() as usize).min(last.saturating_sub(1));
        let part = at - from as f64;
        // The ends have no neighbour beyond them: they are their own.
        let key = |offset: usize| self.key[(from + offset).saturating_sub(1).min(last)];
        let four: [CameraKey; 4] = std::array::from_fn(key);
        let spline = |of: fn(&CameraKey) -> Vector| -> Vector {
            std::array::from_fn(|axis| catmull_rom(four.map(|key| of(&key)[axis]), part))
        };
        let ups = four.map(|key| key.up.unwrap_or(up));
        let up = std::array::from_fn(|axis| ups[1][axis] * (1.0 - part) + ups[2][axis] * part);
        let fov = catmull_rom(four.map(|key| key.fov.unwrap_or(USUAL_FOV)), part);
        let (eye, target) = (spline(|key| key.eye), spline(|key| key.target));
        Ok(Camera::look_at(eye, target, up, fov, width, height)?)
    }
}

/// From the second value to the third, with the slopes of their neighbours.
fn catmull_rom([before, from, to, after]: [f64; 4], t: f64) -> f64 {
    let [a, b] = [(to - before) / 2.0, (after - from) / 2.0];
    let (square, cube) = (t * t, t * t * t);
    from * (2.0 * cube - 3.0 * square + 1.0)
        + a * (cube - 2.0 * square + t)
        + to * (3.0 * square - 2.0 * cube)
        + b * (cube - square)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "frames = 5\n[[key]]\neye = [4.0, 0.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\nfov = 40.0\n\
                        [[key]]\neye = [0.0, 0.0, 4.0]\ntarget = [0.0, 0.0, 0.0]\nup = [0.0, 1.0, 0.0]\nfov = 60.0\n\
                        [[key]]\neye = [-4.0, 0.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n";

    #[test]
    fn frames_pass_through_the_keys_and_lie_between_them() {
        let path = CameraPath::Keys(keys("p.toml", TEXT).unwrap());
        let cameras = path.cameras([0.0, 1.0, 0.0], [64, 48]).unwrap();
        assert_eq!(cameras.len(), 5);
        let eye = |frame: usize| cameras[frame].1.eye();
        for (frame, expected) in [
            (0, [4.0, 0.0, 0.0]),
            (2, [0.0, 0.0, 4.0]),
            (4, [-4.0, 0.0, 0.0]),
        ] {
            let apart: f64 = (0..3)
                .map(|axis| (eye(frame)[axis] - expected[axis]).abs())
                .sum();
            assert!(apart < 1e-9, "{frame}: {:?}", eye(frame));
        }
        assert!(eye(1)[0] > 0.0 && eye(1)[2] > 0.0);
        let focal = |frame: usize| cameras[frame].1.fx;
        assert!(
            focal(0) > focal(1) && focal(1) > focal(2),
            "40 to 60 degrees"
        );
        assert_eq!(cameras[4].0, "frame 5");
    }

    #[test]
    fn one_key_stands_still() {
        let text = "frames = 3\n[[key]]\neye = [4.0, 0.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n";
        let path = CameraPath::Keys(keys("p.toml", text).unwrap());
        let cameras = path.cameras([0.0, 1.0, 0.0], [8, 8]).unwrap();
        assert!(cameras.iter().all(|(_, camera)| *camera == cameras[0].1));
    }

    #[test]
    fn wrong_keys_are_refused_by_name_and_line() {
        let printed = |text: &str| format!("{:#}", keys("p.toml", text).unwrap_err());
        let zero = printed(&TEXT.replace("frames = 5", "frames = 0"));
        assert_eq!(zero, "p.toml:1: frames = 0: allowed are 1 to 100000");
        assert!(printed(&TEXT.replacen("target", "tarket", 1)).contains("tarket"));
        assert!(printed("frames = 2\nkey = []\n").contains("needs one or more"));
        let path =
            CameraPath::Keys(keys("p.toml", &TEXT.replace("fov = 40.0", "fov = 400.0")).unwrap());
        let message = format!("{:#}", path.cameras([0.0, 1.0, 0.0], [8, 8]).unwrap_err());
        assert!(
            message.contains("'p.toml', frame 1") && message.contains("fov"),
            "{message}"
        );
    }
}
