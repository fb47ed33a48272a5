//! One scene in several formats: how far their pictures are from that of the scene itself.
//!
//! Five scenes are written to every format that can hold them, by the writers here, and read back by the readers; captured ones are also
//! there in files by other people's writers. Both engines would see the same difference, so the float reference draws.

mod trained;
mod writers;

use super::{ResultPage, opening, table};
use anyhow::{Context, Result, ensure};
use splatline_sim::camera::Camera;
use splatline_sim::framing::{FramingInput, USUAL_FOV};
use splatline_sim::metrics::{ChannelError, compare};
use splatline_sim::picture::Picture;
use splatline_sim::reference::float;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{LoadOptions, Scene, load};
use std::path::Path;
use writers::WRITERS;

const SIZE: [usize; 2] = [320, 240];
/// The scenes: two captures and one of a trainer's tests in the shared data, two that are generated.
const SCENES: [&str; 5] = [
    "gaussians/playbot_lod4.ply",
    "gaussians/guitar.ply",
    "golden/tiny.ply",
    "random:5000",
    "deep-stack",
];
/// Files of the same scenes by other people's writers: splat-transform 2.7, and the scenes' authors.
const OTHERS: [(&str, &[&str]); 2] = [
    (
        "gaussians/playbot_lod4.ply",
        &[
            "formats/playbot_lod4.compressed.ply",
            "formats/playbot_lod4_v4.spz",
            "formats/playbot_lod4.sog",
            "formats/playbot_lod4_sog",
            "formats/playbot_lod4.glb",
        ],
    ),
    (
        "gaussians/guitar.ply",
        &["gaussians/guitar.splat", "gaussians/guitar_v3.spz"],
    ),
];

/// A scene, a camera, and what it shows.
struct Original {
    scene: Scene,
    camera: Camera,
    picture: Picture,
}

impl Original {
    fn load(data: &Path, name: &str) -> Result<Original> {
        let path = if name.contains('/') {
            data.join(name)
        } else {
            name.into()
        };
        let scene = load(&path, &LoadOptions::default())?;
        let [width, height] = SIZE;
        let camera = FramingInput::of_scene(&scene, None).camera(None, USUAL_FOV, width, height)?;
        let picture = draw(&scene, &camera);
        Ok(Original {
            scene,
            camera,
            picture,
        })
    }

    /// The difference of the picture of another form of the scene, drawn by `camera`.
    fn difference(&self, other: &Scene, camera: &Camera) -> Result<ChannelError> {
        ensure!(
            other.splats.len() == self.scene.splats.len(),
            "{} has {} splats, {} has {}",
            other.name,
            other.splats.len(),
            self.scene.name,
            self.scene.splats.len()
        );
        Ok(compare(&draw(other, camera), &self.picture)?.colour)
    }

    /// The same view of a scene that stands the other way up, as glTF's axes are against the trainers'.
    fn camera_of(&self, other: &Scene) -> Camera {
        if other.up == self.scene.up {
            return self.camera.clone();
        }
        Camera {
            rotation: self.camera.rotation.map(|[x, y, z]| [-x, -y, z]),
            ..self.camera.clone()
        }
    }
}

fn draw(scene: &Scene, camera: &Camera) -> Picture {
    float::draw(scene, camera, &Rules::GAUSSIAN_3D, Compositing::FrontToBack).picture
}

fn decibels(error: &ChannelError) -> String {
    if error.psnr_db.is_finite() {
        format!("{:.2}", error.psnr_db)
    } else {
        "equal".to_owned()
    }
}

/// Every scene in every format that is written here.
fn written(originals: &[Original]) -> Result<String> {
    let folder = std::env::temp_dir().join(format!("splatline-formats-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let mut rows = Vec::new();
    for original in originals {
        for writer in &WRITERS {
            rows.push(
                row(original, writer, &folder)
                    .with_context(|| format!("{} as {}", original.scene.name, writer.name))?,
            );
        }
    }
    std::fs::remove_dir_all(&folder)?;
    let headings = [
        "scene",
        "format",
        "bytes per splat",
        "PSNR of the picture, dB",
        "largest error",
        "what is rounded",
    ];
    Ok(table(&headings, &rows))
}

fn row(original: &Original, writer: &writers::Writer, folder: &Path) -> Result<Vec<String>> {
    let scene = &original.scene;
    let named = |cells: [String; 4]| {
        let first = [scene.name.clone(), writer.name.to_owned()];
        [&first[..], &cells[..]].concat()
    };
    let Some(file) = writer.write(scene, folder)? else {
        let none = || "-".to_owned();
        return Ok(named([none(), none(), none(), writer.refusal.to_owned()]));
    };
    let bytes = size(&file)?;
    let again = load(&file, &LoadOptions::default())?;
    let error = original.difference(&again, &original.camera)?;
    Ok(named([
        format!("{:.1}", bytes as f64 / scene.splats.len() as f64),
        decibels(&error),
        format!("{:.4}", error.max_abs),
        writer.rounding.to_owned(),
    ]))
}

/// Bytes of a file, or of those in a folder.
fn size(path: &Path) -> Result<u64> {
    if !path.is_dir() {
        return Ok(path.metadata()?.len());
    }
    let sizes =
        std::fs::read_dir(path)?.map(|entry| -> Result<u64> { Ok(entry?.metadata()?.len()) });
    sizes.sum()
}

/// The files by other people's writers.
fn others(data: &Path, originals: &[Original]) -> Result<String> {
    let mut rows = Vec::new();
    for (name, files) in OTHERS {
        let place = SCENES.iter().position(|scene| *scene == name);
        let original = place.and_then(|place| originals.get(place));
        let original = original.context("a file of a scene that is not drawn")?;
        for file in files {
            // What is measured is the format's precision, and not the order that its file asks for.
            let other = Scene {
                order: original.scene.order,
                ..load(&data.join(file), &LoadOptions::default())?
            };
            let error = original.difference(&other, &original.camera_of(&other))?;
            rows.push(vec![
                original.scene.name.clone(),
                other.name.clone(),
                decibels(&error),
                format!("{:.4}", error.max_abs),
            ]);
        }
    }
    let headings = ["scene", "file", "PSNR of the picture, dB", "largest error"];
    Ok(table(&headings, &rows))
}

/// The page.
pub fn page(data: &Path) -> Result<ResultPage> {
    let originals = SCENES.map(|name| Original::load(data, name));
    let originals: Vec<Original> = originals.into_iter().collect::<Result<_>>()?;
    let [width, height] = SIZE;
    let text = format!(
        "{}PSNR of the float reference's picture ({width} x {height}, the automatic camera) against that of the scene itself.\n\n\
         ## Written here and read back\n\n\
         By small writers that exist for this page (`sim/lab/src/results/formats/writers.rs`): each rounds to the format's own steps and does\n\
         nothing clever, so that what is left is the format's precision. The deep stack, whose many faint splats lie over each other,\n\
         differs by the same 52 dB in all formats of 8-bit opacity, whatever else they round.\n\n\
         {}\n\
         ## Written by others\n\n\
         By splat-transform 2.7 and by the scenes' authors.\n\n\
         {}\n\
         Large errors are single pixels in which two splats that lie closer than a step of the format change places.\n",
        opening("One scene in several formats"),
        written(&originals)?,
        others(data, &originals)?,
    );
    Ok(ResultPage {
        file: "formats.md",
        text,
    })
}
