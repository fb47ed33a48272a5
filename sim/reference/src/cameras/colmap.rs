//! COLMAP models, text and binary: `cameras` with the lenses, `images` with quaternion (w, x, y, z) and translation
//! from world to camera; axes are right, down, forward as ours. The points of a model are not read.

use super::lens::{Distortion, Lens, Projection};
use super::{CameraPose, Read, photograph};
use crate::input;
use crate::scene::bytes::{Reader, nothing_left};
use crate::scene::rotation_matrix;
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Lens models in the order of their numbers: name, number of parameters, how many of them are focal lengths, and what
/// follows the principal point.
const MODELS: [(&str, usize, usize, ColmapModel); 11] = [
    ("SIMPLE_PINHOLE", 3, 1, ColmapModel::Polynomial),
    ("PINHOLE", 4, 2, ColmapModel::Polynomial),
    ("SIMPLE_RADIAL", 4, 1, ColmapModel::Polynomial),
    ("RADIAL", 5, 1, ColmapModel::Polynomial),
    ("OPENCV", 8, 2, ColmapModel::Polynomial),
    ("OPENCV_FISHEYE", 8, 2, ColmapModel::Fisheye),
    ("FULL_OPENCV", 12, 2, ColmapModel::Polynomial),
    ("FOV", 5, 2, ColmapModel::FieldOfView),
    ("SIMPLE_RADIAL_FISHEYE", 4, 1, ColmapModel::Fisheye),
    ("RADIAL_FISHEYE", 5, 1, ColmapModel::Fisheye),
    ("THIN_PRISM_FISHEYE", 12, 2, ColmapModel::ThinPrism),
];

/// Meaning of a model's last parameters.
#[derive(Clone, Copy, PartialEq)]
enum ColmapModel {
    /// k1, k2, p1, p2, k3 to k6.
    Polynomial,
    /// k1 to k4.
    Fisheye,
    /// k1, k2, p1, p2, k3, k4, sx1, sy1.
    ThinPrism,
    /// The width of the field.
    FieldOfView,
}

/// The folder of a model: the one named, its `sparse/0` or `sparse`, or that of a file named.
pub(super) fn folder(path: &Path) -> Option<PathBuf> {
    let holds = |folder: &Path| {
        ["images.bin", "images.txt"]
            .iter()
            .any(|name| folder.join(name).is_file())
    };
    if path.is_dir() {
        let places = [
            path.to_path_buf(),
            path.join("sparse/0"),
            path.join("sparse"),
        ];
        return places.into_iter().find(|place| holds(place));
    }
    let stem = path.file_stem()?.to_str()?;
    let extension = path.extension()?.to_str()?;
    let is_part = ["images", "cameras"].contains(&stem) && ["txt", "bin"].contains(&extension);
    let parent = path.parent().filter(|_| is_part)?;
    holds(parent).then(|| parent.to_path_buf())
}

/// All images of a model.
pub(super) fn load(folder: &Path) -> Read {
    let binary = folder.join("images.bin").is_file();
    let read = |name: &str| {
        let file = format!("{name}.{}", if binary { "bin" } else { "txt" });
        let bytes = input::bytes(&folder.join(&file), input::TABLE);
        bytes.map_err(|error| anyhow!("{file} cannot be read: {error}"))
    };
    let (cameras, images) = (read("cameras")?, read("images")?);
    if binary {
        return binary_images(&images, &binary_cameras(&cameras)?);
    }
    let cameras = text_cameras(&text(cameras, "cameras.txt")?)?;
    text_images(&text(images, "images.txt")?, &cameras)
}

fn text(bytes: Vec<u8>, file: &str) -> Result<String> {
    String::from_utf8(bytes).map_err(|_| anyhow!("{file} is no text: fetch it again"))
}

type Lenses = BTreeMap<i64, Lens>;

fn text_cameras(text: &str) -> Result<Lenses> {
    let named = |(number, line): (usize, &str)| {
        text_camera(line).map_err(|what| anyhow!("cameras.txt line {number}: {what}"))
    };
    let lines = (1..).zip(text.lines());
    let said = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    said.map(named).collect()
}

pub(super) fn text_camera(line: &str) -> Result<(i64, Lens)> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [id, model, width, height, parameters @ ..] = &words[..] else {
        bail!("expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS");
    };
    let known = MODELS.iter().find(|(name, ..)| name == model);
    let known =
        known.with_context(|| format!("the model '{model}' is unknown; undistort to PINHOLE"))?;
    let size = [
        parsed(width, "whole number")?,
        parsed(height, "whole number")?,
    ];
    let parameters = parameters.iter().map(|word| parsed(word, "number"));
    let parameters: Vec<f64> = parameters.collect::<Result<_>>()?;
    let id: u64 = parsed(id, "whole number")?;
    Ok((id as i64, lens(known, size, &parameters)?))
}

fn parsed<T: FromStr>(word: &str, kind: &str) -> Result<T> {
    word.parse().map_err(|_| anyhow!("'{word}' is no {kind}"))
}

fn text_images(text: &str, lenses: &Lenses) -> Read {
    let mut poses = Vec::new();
    let mut lines = (1..)
        .zip(text.lines())
        .filter(|(_, line)| !line.starts_with('#'));
    while let Some((number, line)) = lines.next() {
        if line.trim().is_empty() {
            continue;
        }
        let pose = text_image(line, lenses);
        poses.push(pose.map_err(|what| anyhow!("images.txt line {number}: {what}"))?);
        // Every image has a line of points after it, which may be empty.
        lines.next();
    }
    Ok(poses)
}

fn text_image(line: &str, lenses: &Lenses) -> Result<CameraPose> {
    let words: Vec<&str> = line.split_whitespace().collect();
    ensure!(
        words.len() >= 10,
        "expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, and a line of points after each"
    );
    let mut pose = [0.0; 7];
    for (value, word) in pose.iter_mut().zip(&words[1..]) {
        *value = parsed(word, "number")?;
    }
    posed(
        words[9..].join(" "),
        pose,
        parsed(words[8], "camera")?,
        lenses,
    )
}

fn binary_cameras(bytes: &[u8]) -> Result<Lenses> {
    const FILE: &str = "cameras.bin";
    let mut reader = Reader::new(bytes);
    let mut lenses = Lenses::new();
    for _ in 0..reader.little::<u64, _>(FILE)? {
        let (id, number): (i32, i32) = (reader.little(FILE)?, reader.little(FILE)?);
        let known = usize::try_from(number).ok();
        let known = known
            .and_then(|number| MODELS.get(number))
            .with_context(|| {
                format!(
                    "{FILE}, camera {id}: the lens model {number} is unknown; undistort to PINHOLE"
                )
            })?;
        let size = [reader.little(FILE)?, reader.little(FILE)?];
        let parameters: Result<Vec<f64>> = (0..known.1).map(|_| reader.little(FILE)).collect();
        let lens = lens(known, size, &parameters?);
        lenses.insert(
            id.into(),
            lens.map_err(|what| anyhow!("{FILE}, camera {id}: {what}"))?,
        );
    }
    nothing_left(reader.remaining(), FILE, "record", "fetch it again")?;
    Ok(lenses)
}

fn binary_images(bytes: &[u8], lenses: &Lenses) -> Read {
    const FILE: &str = "images.bin";
    let mut reader = Reader::new(bytes);
    let mut poses = Vec::new();
    for _ in 0..reader.little::<u64, _>(FILE)? {
        let id: i32 = reader.little(FILE)?;
        let mut pose = [0.0; 7];
        for value in &mut pose {
            *value = reader.little(FILE)?;
        }
        let camera: i32 = reader.little(FILE)?;
        let name = String::from_utf8_lossy(reader.up_to_zero(FILE)?);
        let posed = posed(name.into_owned(), pose, camera.into(), lenses);
        poses.push(posed.map_err(|what| anyhow!("{FILE}, image {id}: {what}"))?);
        // Points of the picture: two doubles and a number each.
        let points = reader.little(FILE)?;
        reader.records(points, 24, FILE)?;
    }
    nothing_left(reader.remaining(), FILE, "record", "fetch it again")?;
    Ok(poses)
}

fn lens(
    (name, count, focals, model): &(&str, usize, usize, ColmapModel),
    size: [u64; 2],
    p: &[f64],
) -> Result<Lens> {
    ensure!(
        p.len() == *count,
        "{name} has {count} parameters, but there are {}",
        p.len()
    );
    let rest = &p[focals + 2..];
    let at = |k: usize| rest.get(k).copied().unwrap_or(0.0);
    let straight = Distortion::default();
    let distortion = match model {
        ColmapModel::Polynomial => Distortion {
            radial: [at(0), at(1), at(4), 0.0],
            divisor: [at(5), at(6), at(7)],
            tangential: [at(2), at(3)],
            ..straight
        },
        ColmapModel::Fisheye => Distortion {
            projection: Projection::Fisheye,
            radial: [at(0), at(1), at(2), at(3)],
            ..straight
        },
        ColmapModel::ThinPrism => Distortion {
            projection: Projection::Fisheye,
            radial: [at(0), at(1), at(4), at(5)],
            tangential: [at(2), at(3)],
            prism: [at(6), at(7)],
            ..straight
        },
        ColmapModel::FieldOfView => Distortion {
            projection: Projection::FieldOfView(at(0)),
            ..straight
        },
    };
    Ok(Lens {
        size,
        focal: [p[0], p[focals - 1]],
        principal: [p[*focals], p[focals + 1]],
        distortion,
    })
}

fn posed(
    name: String,
    [w, x, y, z, tx, ty, tz]: [f64; 7],
    camera: i64,
    lenses: &Lenses,
) -> Result<CameraPose> {
    let lens = lenses
        .get(&camera)
        .with_context(|| format!("there is no camera {camera} in the file of cameras"))?;
    let finite = [w, x, y, z].iter().all(|part| part.is_finite());
    let rotation = rotation_matrix([w, x, y, z]).filter(|_| finite);
    let rotation = rotation.context("its quaternion is zero or not finite")?;
    photograph(name, *lens, ("QW QX QY QZ", rotation), [tx, ty, tz])
}
