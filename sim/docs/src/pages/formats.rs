//! One scene in several formats, written by others: how far their pictures are from that of the scene itself.
//!
//! Both engines would see the same difference, so the float reference draws.

use super::Page;
use crate::table::Table;
use crate::views::View;
use anyhow::{Result, ensure};
use splatline_sim::camera::Camera;
use splatline_sim::framing::{FramingInput, USUAL_FOV};
use splatline_sim::metrics::compare;
use splatline_sim::rules::Rules;
use splatline_sim::scene::{LoadOptions, Scene, load};
use std::path::Path;

const SIZE: [usize; 2] = [320, 240];

/// Scenes, and files of them by splat-transform 2.7 and by the scenes' authors.
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

pub fn add(page: &mut Page, data: &Path) -> Result<()> {
    let [width, height] = SIZE;
    let mut table = Table::new("scene | file | bytes a splat | PSNR dB | largest error");
    for (name, files) in FILES {
        let scene = load(&data.join(name), &LoadOptions::default())?;
        let camera = FramingInput::of_scene(&scene, None).camera(None, USUAL_FOV, width, height)?;
        let view = View {
            rules: Rules::GAUSSIAN_3D,
            ..View::new("original", scene, camera)
        };
        let picture = view.reference();
        for file in files {
            let path = data.join(file);
            let mut other = View {
                scene: load(&path, &LoadOptions::default())?,
                ..view.clone()
            };
            let splats = other.scene.splats.len();
            ensure!(
                splats == view.scene.splats.len(),
                "{file} has {splats} splats, {name} has not"
            );
            other.camera = camera_of(&other.scene, &view);
            // What is measured is the format's precision, and not the order that its file asks for.
            other.scene.order = view.scene.order;
            let error = compare(&other.reference(), &picture)?.colour;
            table.push([
                view.scene.name.clone(),
                other.scene.name.clone(),
                format!("{:.1}", bytes(&path)? as f64 / splats as f64),
                format!("{:.2}", error.psnr_db),
                format!("{:.4}", error.max_abs),
            ]);
        }
    }
    page.add("## One scene in several formats");
    page.add(format!(
        "PSNR of the float reference's picture ({width} x {height}, the automatic camera) against that of the scene itself, for files written by splat-transform 2.7 and \
         by the scenes' authors. Large errors are single pixels in which two splats that lie closer than a step of the format change places."
    ));
    page.add(table.markdown());
    Ok(())
}

/// The same view of a scene that stands the other way up, as glTF's axes are against the trainers'.
fn camera_of(other: &Scene, view: &View) -> Camera {
    if other.up == view.scene.up {
        return view.camera.clone();
    }
    Camera {
        rotation: view.camera.rotation.map(|[x, y, z]| [-x, -y, z]),
        ..view.camera.clone()
    }
}

/// Bytes of a file, or of those in a folder.
fn bytes(path: &Path) -> Result<u64> {
    if !path.is_dir() {
        return Ok(path.metadata()?.len());
    }
    let sizes =
        std::fs::read_dir(path)?.map(|entry| -> Result<u64> { Ok(entry?.metadata()?.len()) });
    sizes.sum()
}
