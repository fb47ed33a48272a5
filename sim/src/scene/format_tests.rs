//! One scene in several formats, written by others: the pictures agree within each format's own precision.

use super::tests::{load_plain, shared_data};
use super::*;
use crate::framing::{Frame, USUAL_FOV};
use crate::metrics::compare;
use crate::reference::float;
use crate::rules::Compositing;

/// The same view of a scene that is turned by 180 degrees around z, as glTF's axes are against the trainers'.
fn turned(camera: &Camera) -> Camera {
    Camera {
        rotation: camera.rotation.map(|[x, y, z]| [-x, -y, z]),
        ..camera.clone()
    }
}

/// PSNR of the scene's picture in each file, and the least that the format's steps allow here.
///
/// `docs/results/formats.md` is this test's output.
#[test]
#[ignore = "needs captured data in ../shared/data"]
fn pictures_of_one_scene_agree_between_formats() {
    let files = [
        (
            "gaussians/playbot_lod4.ply",
            "formats/playbot_lod4.compressed.ply",
            35.0,
        ),
        (
            "gaussians/playbot_lod4.ply",
            "formats/playbot_lod4_v4.spz",
            35.0,
        ),
        (
            "gaussians/playbot_lod4.ply",
            "formats/playbot_lod4.sog",
            35.0,
        ),
        (
            "gaussians/playbot_lod4.ply",
            "formats/playbot_lod4_sog/meta.json",
            35.0,
        ),
        (
            "gaussians/playbot_lod4.ply",
            "formats/playbot_lod4.glb",
            100.0,
        ),
        ("gaussians/guitar.ply", "gaussians/guitar.splat", 35.0),
        ("gaussians/guitar.ply", "gaussians/guitar_v3.spz", 35.0),
    ];
    println!(
        "| scene | as | splats | PSNR of the picture, dB | largest error |\n|---|---|---|---|---|"
    );
    for (plain, other, least) in files {
        let (Some(plain), Some(other)) = (shared_data(plain), shared_data(other)) else {
            panic!("{plain} or {other} is not at hand");
        };
        let (a, b) = (load_plain(&plain), load_plain(&other));
        let camera = Frame::of_scene(&a, None)
            .camera(None, USUAL_FOV, 320, 240)
            .unwrap();
        let camera_b = if b.up == a.up {
            camera.clone()
        } else {
            turned(&camera)
        };
        let draw = |scene: &Scene, camera: &Camera| {
            float::draw(scene, camera, &Rules::GAUSSIAN_3D, Compositing::FrontToBack).picture
        };
        let errors = compare(&draw(&b, &camera_b), &draw(&a, &camera))
            .unwrap()
            .colour;
        println!(
            "| {} | {} | {} | {:.2} | {:.4} |",
            a.name,
            other
                .strip_prefix(other.parent().unwrap().parent().unwrap())
                .unwrap()
                .display(),
            b.splats.len(),
            errors.psnr_db,
            errors.max_abs
        );
        assert!(
            errors.psnr_db > least,
            "{}: {}",
            other.display(),
            errors.psnr_db
        );
    }
}
