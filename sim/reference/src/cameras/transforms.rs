//! `transforms.json` of nerfstudio, instant-ngp and Blender's scenes: `transform_matrix` takes the camera to the world,
//! the camera's axes being right, up, back. Lenses are stated once or per frame, as focal lengths or as a field of
//! view.
//!
//! Poses are taken as they stand. Nerfstudio trains in a space of its own (dataparser_transforms.json), so a scene
//! exported from there has to be exported with its poses.

use super::lens::{Distortion, Lens};
use super::{CameraPose, Read, inverted, photograph};
use anyhow::{Result, anyhow, bail, ensure};
use serde::Deserialize;

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

#[derive(Clone, Deserialize)]
struct TransformsLens {
    w: Option<f64>,
    h: Option<f64>,
    fl_x: Option<f64>,
    fl_y: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    camera_angle_x: Option<f64>,
    camera_angle_y: Option<f64>,
    k1: Option<f64>,
    k2: Option<f64>,
    k3: Option<f64>,
    k4: Option<f64>,
    p1: Option<f64>,
    p2: Option<f64>,
}

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
        pose(frame, &frame.lens.or(&file.lens), size, fisheye)
            .map_err(|what| anyhow!("frame {index}: {what}"))
    };
    file.frames.iter().enumerate().map(posed).collect()
}

impl TransformsLens {
    /// The frame's own fields, else the file's.
    fn or(&self, file: &TransformsLens) -> TransformsLens {
        TransformsLens {
            w: self.w.or(file.w),
            h: self.h.or(file.h),
            fl_x: self.fl_x.or(file.fl_x),
            fl_y: self.fl_y.or(file.fl_y),
            cx: self.cx.or(file.cx),
            cy: self.cy.or(file.cy),
            camera_angle_x: self.camera_angle_x.or(file.camera_angle_x),
            camera_angle_y: self.camera_angle_y.or(file.camera_angle_y),
            k1: self.k1.or(file.k1),
            k2: self.k2.or(file.k2),
            k3: self.k3.or(file.k3),
            k4: self.k4.or(file.k4),
            p1: self.p1.or(file.p1),
            p2: self.p2.or(file.p2),
        }
    }
}

fn pose(
    frame: &TransformsFrame,
    lens: &TransformsLens,
    size: Option<[usize; 2]>,
    fisheye: bool,
) -> Result<CameraPose> {
    let [width, height] = match (lens.w, lens.h, size) {
        (Some(w), Some(h), _) if w >= 1.0 && h >= 1.0 => [w as u64, h as u64],
        (None, None, Some(size)) => size.map(|side| side as u64),
        _ => bail!("w and h are not there: give --size WxH"),
    };
    let of_angle =
        |angle: Option<f64>, side: u64| angle.map(|angle| 0.5 * side as f64 / (0.5 * angle).tan());
    let across = lens.fl_x.or(of_angle(lens.camera_angle_x, width));
    let down = lens.fl_y.or(of_angle(lens.camera_angle_y, height));
    // Pixels are square unless the file says otherwise.
    let focal = match (across.or(down), down.or(across)) {
        (Some(across), Some(down)) => [across, down],
        _ => bail!("there is neither fl_x nor camera_angle_x"),
    };
    let principal = [
        lens.cx.unwrap_or(width as f64 / 2.0),
        lens.cy.unwrap_or(height as f64 / 2.0),
    ];
    let [first, second, third, ..] = frame.transform_matrix[..] else {
        let rows = frame.transform_matrix.len();
        bail!("transform_matrix has {rows} rows, but must have 4");
    };
    let column = |k: usize| [first[k], second[k], third[k]];
    // Right, up, back in the file; right, down, forward here.
    let flipped = |k: usize| column(k).map(|part| -part);
    let (rotation, translation) = inverted([column(0), flipped(1), flipped(2)], column(3));
    let at = |value: Option<f64>| value.unwrap_or(0.0);
    let radial = [lens.k1, lens.k2, lens.k3, lens.k4].map(at);
    let tangential = [lens.p1, lens.p2].map(at);
    let distortion = if fisheye {
        Distortion::Fisheye {
            radial,
            tangential: [0.0; 2],
            prism: [0.0; 2],
        }
    } else {
        let [k1, k2, k3, k4] = radial;
        ensure!(
            k4 == 0.0,
            "k4 belongs to a fisheye, but camera_model is not {FISHEYE}: \
             undistort the pictures and export again"
        );
        Distortion::Polynomial {
            radial: [k1, k2, k3, 0.0, 0.0, 0.0],
            tangential,
        }
    };
    let lens = Lens {
        size: [width, height],
        focal,
        principal,
        distortion,
    };
    let name = frame.file_path.trim_start_matches("./").to_owned();
    photograph(name, lens, ("transform_matrix", rotation), translation)
}
