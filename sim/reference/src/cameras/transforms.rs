//! `transforms.json` of nerfstudio, instant-ngp and Blender's scenes: `transform_matrix` takes the camera to the world,
//! the camera's axes being right, up, back. Lenses are stated once or per frame, as focal lengths or as a field of
//! view.
//!
//! Poses are taken as they stand. Nerfstudio trains in a space of its own (dataparser_transforms.json), so a scene
//! exported from there has to be exported with its poses.

use super::lens::{Distortion, Lens, Projection};
use super::{CameraPose, Read, inverted, photograph};
use anyhow::{Result, anyhow, bail, ensure};
use serde::Deserialize;
use serde_json::{Map, Value};

#[derive(Deserialize)]
struct TransformsFile {
    camera_model: Option<String>,
    #[serde(flatten)]
    lens: TransformsLens,
    frames: Vec<TransformsFrame>,
}

#[derive(Deserialize)]
struct TransformsFrame {
    #[serde(default)]
    file_path: String,
    transform_matrix: Vec<[f64; 4]>,
    #[serde(flatten)]
    lens: TransformsLens,
}

/// What is said of a lens, by its names.
type TransformsLens = Map<String, Value>;

/// The one model that is no polynomial.
const FISHEYE: &str = "OPENCV_FISHEYE";

/// All frames of a file; `size` is the picture's where the file has none.
pub(super) fn parse(text: &str, size: Option<[usize; 2]>) -> Read {
    let file: TransformsFile =
        serde_json::from_str(text).map_err(|error| anyhow!("is no transforms.json: {error}"))?;
    let model = file.camera_model.as_deref().unwrap_or("OPENCV");
    let fisheye = match model.to_ascii_uppercase().as_str() {
        FISHEYE => true,
        "OPENCV" | "PINHOLE" | "SIMPLE_PINHOLE" | "PERSPECTIVE" | "SIMPLE_RADIAL" | "RADIAL" => {
            false
        }
        _ => {
            let shown: String = model.chars().filter(|c| !c.is_control()).take(40).collect();
            bail!("camera_model '{shown}' is unknown: undistort the pictures and export again");
        }
    };
    let posed = |(index, frame): (usize, &TransformsFrame)| {
        pose(frame, &file.lens, size, fisheye).map_err(|what| anyhow!("frame {index}: {what}"))
    };
    file.frames.iter().enumerate().map(posed).collect()
}

fn pose(
    frame: &TransformsFrame,
    of_file: &TransformsLens,
    size: Option<[usize; 2]>,
    fisheye: bool,
) -> Result<CameraPose> {
    // The frame's own, else the file's.
    let number = |name: &str| {
        let lenses = [&frame.lens, of_file].into_iter();
        let mut stated = lenses.filter_map(|lens| lens.get(name).filter(|v| !v.is_null()));
        let number = stated.next().map(|value| value.as_f64().ok_or(()));
        let number = number.transpose();
        number.map_err(|()| anyhow!("{name} is no number"))
    };
    let or_zero = |name: &str| number(name).map(Option::unwrap_or_default);
    let [width, height] = match (number("w")?, number("h")?, size) {
        (Some(w), Some(h), _) if w >= 1.0 && h >= 1.0 => [w as u64, h as u64],
        (None, None, Some(size)) => size.map(|side| side as u64),
        _ => bail!("w and h are not there: give --size WxH"),
    };
    let of_angle =
        |angle: Option<f64>, side: u64| angle.map(|angle| 0.5 * side as f64 / (0.5 * angle).tan());
    let across = number("fl_x")?.or(of_angle(number("camera_angle_x")?, width));
    let down = number("fl_y")?.or(of_angle(number("camera_angle_y")?, height));
    // Pixels are square unless the file says otherwise.
    let focal = match (across.or(down), down.or(across)) {
        (Some(across), Some(down)) => [across, down],
        _ => bail!("there is neither fl_x nor camera_angle_x"),
    };
    let principal = [
        number("cx")?.unwrap_or(width as f64 / 2.0),
        number("cy")?.unwrap_or(height as f64 / 2.0),
    ];
    let [first, second, third, ..] = frame.transform_matrix[..] else {
        let rows = frame.transform_matrix.len();
        bail!("transform_matrix has {rows} rows, but must have 4");
    };
    let column = |k: usize| [first[k], second[k], third[k]];
    // Right, up, back in the file; right, down, forward here.
    let flipped = |k: usize| column(k).map(|part| -part);
    let (rotation, translation) = inverted([column(0), flipped(1), flipped(2)], column(3));
    let mut distortion = Distortion {
        radial: [
            or_zero("k1")?,
            or_zero("k2")?,
            or_zero("k3")?,
            or_zero("k4")?,
        ],
        ..Distortion::default()
    };
    if fisheye {
        distortion.projection = Projection::Fisheye;
    } else {
        ensure!(
            distortion.radial[3] == 0.0,
            "k4 belongs to a fisheye, but camera_model is not {FISHEYE}: \
             undistort the pictures and export again"
        );
        distortion.tangential = [or_zero("p1")?, or_zero("p2")?];
    }
    let lens = Lens {
        size: [width, height],
        focal,
        principal,
        distortion,
    };
    let name = frame.file_path.trim_start_matches("./").to_owned();
    photograph(name, lens, ("transform_matrix", rotation), translation)
}
