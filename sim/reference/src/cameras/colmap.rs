//! COLMAP models, text and binary: `cameras` with the lenses, `images` with quaternion (w, x, y, z) and translation from world to
//! camera; axes are right, down, forward as ours. The points of a model are not read.

use super::lens::{Distortion, Lens};
use super::{CameraPose, Read, photograph};
use crate::input;
use crate::scene::rotation_matrix;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Lens models in the order of their numbers: name, number of parameters, how many of them are focal lengths, and what follows the principal point.
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
        bytes.map_err(|error| format!("{file} cannot be read: {error}"))
    };
    let (cameras, images) = (read("cameras")?, read("images")?);
    if binary {
        binary_images(&images, &binary_cameras(&cameras)?)
    } else {
        text_images(
            &text(&images, "images.txt")?,
            &text_cameras(&text(&cameras, "cameras.txt")?)?,
        )
    }
}

fn text(bytes: &[u8], file: &str) -> Result<String, String> {
    String::from_utf8(bytes.to_vec()).map_err(|_| format!("{file} is no text: fetch it again"))
}

type Lenses = BTreeMap<i64, Lens>;

fn text_cameras(text: &str) -> Result<Lenses, String> {
    let mut lenses = Lenses::new();
    for (number, line) in lines(text) {
        let wrong = |what: &str| format!("cameras.txt line {number}: {what}");
        let words: Vec<&str> = line.split_whitespace().collect();
        let [id, model, width, height, parameters @ ..] = &words[..] else {
            return Err(wrong("expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS"));
        };
        let known = MODELS.iter().find(|(name, ..)| name == model);
        let known = known.ok_or_else(|| {
            wrong(&format!(
                "the model '{model}' is unknown; undistort to PINHOLE"
            ))
        })?;
        let whole = |word: &str| {
            word.parse()
                .map_err(|_| wrong(&format!("'{word}' is no whole number")))
        };
        let parameters: Result<Vec<f64>, String> = parameters
            .iter()
            .map(|word| {
                word.parse()
                    .map_err(|_| wrong(&format!("'{word}' is no number")))
            })
            .collect();
        let id: u64 = whole(id)?;
        let lens = lens(known, [whole(width)?, whole(height)?], &parameters?)
            .map_err(|what| wrong(&what))?;
        lenses.insert(id as i64, lens);
    }
    Ok(lenses)
}

fn text_images(text: &str, lenses: &Lenses) -> Read {
    let mut poses = Vec::new();
    // Every image has a line of points after it, which may be empty.
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.starts_with('#'));
    while let Some((index, line)) = lines.next() {
        if line.trim().is_empty() && poses.is_empty() {
            continue;
        }
        let wrong = |what: String| format!("images.txt line {}: {what}", index + 1);
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.is_empty() {
            continue;
        }
        let [_, numbers @ ..] = &words[..] else {
            continue;
        };
        if numbers.len() < 9 {
            let expected = "expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, and a line of points after each";
            return Err(wrong(expected.to_owned()));
        }
        let mut pose = [0.0; 7];
        for (value, word) in pose.iter_mut().zip(numbers) {
            *value = word
                .parse()
                .map_err(|_| wrong(format!("'{word}' is no number")))?;
        }
        let camera = numbers[7]
            .parse()
            .map_err(|_| wrong(format!("'{}' is no camera", numbers[7])))?;
        let name = numbers[8..].join(" ");
        poses.push(posed(name, pose, camera, lenses).map_err(wrong)?);
        lines.next();
    }
    Ok(poses)
}

/// Lines that are neither empty nor comments, with their numbers.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = (1..).zip(text.lines());
    numbered.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'))
}

/// A cursor over a binary file.
struct ColmapBytes<'a> {
    rest: &'a [u8],
    file: &'static str,
}

impl ColmapBytes<'_> {
    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let cut = || format!("{} ends too early: fetch it again", self.file);
        let (taken, rest) = self.rest.split_first_chunk::<N>().ok_or_else(cut)?;
        self.rest = rest;
        Ok(*taken)
    }

    fn double(&mut self) -> Result<f64, String> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    fn int(&mut self) -> Result<i64, String> {
        Ok(i32::from_le_bytes(self.array()?).into())
    }

    fn long(&mut self) -> Result<u64, String> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    /// A name up to its zero byte.
    fn name(&mut self) -> Result<String, String> {
        let end = self.rest.iter().position(|byte| *byte == 0);
        let end = end.ok_or_else(|| format!("{} ends within a name: fetch it again", self.file))?;
        let name = String::from_utf8_lossy(&self.rest[..end]).into_owned();
        self.rest = &self.rest[end + 1..];
        Ok(name)
    }

    fn skip(&mut self, bytes: u64) -> Result<(), String> {
        let cut = || format!("{} ends too early: fetch it again", self.file);
        let bytes = usize::try_from(bytes).map_err(|_| cut())?;
        self.rest = self.rest.get(bytes..).ok_or_else(cut)?;
        Ok(())
    }

    fn finish(&self) -> Result<(), String> {
        match self.rest.len() {
            0 => Ok(()),
            left => Err(format!(
                "{}: {left} bytes are left over after the last record",
                self.file
            )),
        }
    }
}

fn binary_cameras(bytes: &[u8]) -> Result<Lenses, String> {
    let mut bytes = ColmapBytes {
        rest: bytes,
        file: "cameras.bin",
    };
    let mut lenses = Lenses::new();
    for _ in 0..bytes.long()? {
        let id = bytes.int()?;
        let number = bytes.int()?;
        let known = usize::try_from(number)
            .ok()
            .and_then(|number| MODELS.get(number));
        let known = known.ok_or_else(|| {
            format!(
                "cameras.bin, camera {id}: the lens model {number} is unknown; undistort to PINHOLE"
            )
        })?;
        let size = [bytes.long()?, bytes.long()?];
        let parameters: Result<Vec<f64>, String> = (0..known.1).map(|_| bytes.double()).collect();
        let lens = lens(known, size, &parameters?)
            .map_err(|what| format!("cameras.bin, camera {id}: {what}"))?;
        lenses.insert(id, lens);
    }
    bytes.finish()?;
    Ok(lenses)
}

fn binary_images(bytes: &[u8], lenses: &Lenses) -> Read {
    let mut bytes = ColmapBytes {
        rest: bytes,
        file: "images.bin",
    };
    let mut poses = Vec::new();
    for _ in 0..bytes.long()? {
        let id = bytes.int()?;
        let mut pose = [0.0; 7];
        for value in &mut pose {
            *value = bytes.double()?;
        }
        let camera = bytes.int()?;
        let name = bytes.name()?;
        // Points of the picture: two doubles and a number each.
        let points = bytes.long()?;
        bytes.skip(points.saturating_mul(24))?;
        let wrong = |what: String| format!("images.bin, image {id}: {what}");
        poses.push(posed(name, pose, camera, lenses).map_err(wrong)?);
    }
    bytes.finish()?;
    Ok(poses)
}

fn lens(
    (name, count, focals, model): &(&str, usize, usize, ColmapModel),
    size: [u64; 2],
    p: &[f64],
) -> Result<Lens, String> {
    if p.len() != *count {
        return Err(format!(
            "{name} has {count} parameters, but there are {}",
            p.len()
        ));
    }
    let rest = &p[focals + 2..];
    let at = |k: usize| rest.get(k).copied().unwrap_or(0.0);
    let distortion = match model {
        ColmapModel::Polynomial => Distortion::Polynomial {
            radial: [at(0), at(1), at(4), at(5), at(6), at(7)],
            tangential: [at(2), at(3)],
        },
        ColmapModel::Fisheye => Distortion::Fisheye {
            radial: [at(0), at(1), at(2), at(3)],
            tangential: [0.0; 2],
            prism: [0.0; 2],
        },
        ColmapModel::ThinPrism => Distortion::Fisheye {
            radial: [at(0), at(1), at(4), at(5)],
            tangential: [at(2), at(3)],
            prism: [at(6), at(7)],
        },
        ColmapModel::FieldOfView => Distortion::FieldOfView(at(0)),
    };
    Ok(Lens {
        size,
        focal: [p[0], p[focals - 1]],
        principal: [p[*focals], p[focals + 1]],
        distortion,
    })
}

/// The lens of a model's name.
#[cfg(test)]
pub(super) fn lens_of(model: &str, size: [u64; 2], parameters: &[f64]) -> Result<Lens, String> {
    let known = MODELS.iter().find(|(name, ..)| *name == model);
    lens(known.ok_or("unknown")?, size, parameters)
}

fn posed(
    name: String,
    [w, x, y, z, tx, ty, tz]: [f64; 7],
    camera: i64,
    lenses: &Lenses,
) -> Result<CameraPose, String> {
    let lens = lenses
        .get(&camera)
        .ok_or_else(|| format!("there is no camera {camera} in the file of cameras"))?;
    let finite = [w, x, y, z].iter().all(|part| part.is_finite());
    let rotation = rotation_matrix([w, x, y, z]).filter(|_| finite);
    let rotation = rotation.ok_or("its quaternion is zero or not finite")?;
    photograph(name, *lens, ("QW QX QY QZ", rotation), [tx, ty, tz])
}
