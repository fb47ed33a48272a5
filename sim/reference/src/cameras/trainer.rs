//! `cameras.json` as the 3D Gaussian trainer leaves it beside its scenes: `rotation` and `position` take the camera
//! (right, down, forward) to the world; the pictures are undistorted and centred.

use super::lens::{Distortion, Lens};
use super::{CameraPose, Read, inverted, photograph};
use anyhow::{Result, anyhow};
use serde::Deserialize;

#[derive(Deserialize)]
struct TrainerCamera {
    #[serde(default)]
    img_name: String,
    id: Option<i64>,
    width: u64,
    height: u64,
    position: [f64; 3],
    rotation: [[f64; 3]; 3],
    fx: f64,
    fy: f64,
}

/// All cameras of a file.
pub(super) fn parse(text: &str) -> Read {
    let entries: Vec<TrainerCamera> =
        serde_json::from_str(text).map_err(|error| anyhow!("is no cameras.json: {error}"))?;
    let posed = |(index, entry): (usize, &TrainerCamera)| {
        pose(entry).map_err(|what| anyhow!("camera {index}: {what}"))
    };
    entries.iter().enumerate().map(posed).collect()
}

fn pose(entry: &TrainerCamera) -> Result<CameraPose> {
    let column = |k: usize| entry.rotation.map(|row| row[k]);
    let (rotation, translation) = inverted([column(0), column(1), column(2)], entry.position);
    let lens = Lens {
        size: [entry.width, entry.height],
        focal: [entry.fx, entry.fy],
        principal: [entry.width, entry.height].map(|side| side as f64 / 2.0),
        distortion: Distortion::default(),
    };
    let name = if entry.img_name.is_empty() {
        entry.id.unwrap_or_default().to_string()
    } else {
        entry.img_name.clone()
    };
    let pose = photograph(name, lens, ("rotation", rotation), translation)?;
    Ok(CameraPose { lens: None, ..pose })
}
