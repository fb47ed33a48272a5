//! One scene in several formats, written by others: how far their pictures are from that of the scene itself.
//!
//! Both engines would see the same difference, so the float reference draws.

use super::{ResultPage, opening, table};
use anyhow::{Result, ensure};
use splatline_sim::camera::Camera;
use splatline_sim::framing::{FramingInput, USUAL_FOV};
use splatline_sim::metrics::{ChannelError, compare};
use splatline_sim::picture::Picture;
use splatline_sim::reference::float;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{LoadOptions, Scene, load};
use std::path::Path;

const SIZE: [usize; 2] = [320, 240];
/// Scenes, and files of them by other people's writers: splat-transform 2.7, and the scenes' authors.
const FILES: [(&str, &[&str]); 2] = [
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
        let scene = load(&data.join(name), &LoadOptions::default())?;
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

/// Bytes of a file, or of those in a folder.
fn size(path: &Path) -> Result<u64> {
    if !path.is_dir() {
        return Ok(path.metadata()?.len());
    }
    let sizes =
        std::fs::read_dir(path)?.map(|entry| -> Result<u64> { Ok(entry?.metadata()?.len()) });
    sizes.sum()
}

/// The page.
pub fn page(data: &Path) -> Result<ResultPage> {
    let mut rows = Vec::new();
    for (name, files) in FILES {
        let original = Original::load(data, name)?;
        for file in files {
            // What is measured is the format's precision, and not the order that its file asks for.
            let other = Scene {
                order: original.scene.order,
                ..load(&data.join(file), &LoadOptions::default())?
            };
            let error = original.difference(&other, &original.camera_of(&other))?;
            let bytes = size(&data.join(file))? as f64 / other.splats.len() as f64;
            rows.push(vec![
                original.scene.name.clone(),
                other.name.clone(),
                format!("{bytes:.1}"),
                format!("{:.2}", error.psnr_db),
                format!("{:.4}", error.max_abs),
            ]);
        }
    }
    let headings = [
        "scene",
        "file",
        "bytes per splat",
        "PSNR of the picture, dB",
        "largest error",
    ];
    let [width, height] = SIZE;
    let text = format!(
        "{}PSNR of the float reference's picture ({width} x {height}, the automatic camera) against that of the scene itself, for files \
         written by splat-transform 2.7 and by the scenes' authors. Large errors are single pixels in which two splats that lie closer than a \
         step of the format change places.\n\n{}",
        opening("One scene in several formats"),
        table(&headings, &rows),
    );
    Ok(ResultPage {
        file: "formats.md",
        text,
    })
}
