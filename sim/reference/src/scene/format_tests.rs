//! One scene in several formats, written by others: the pictures agree within each format's own precision.

use super::tests::{load_plain, shared_data};
use super::*;
use crate::engines::float;
use crate::framing::{FramingInput, USUAL_FOV};
use crate::metrics::compare;
use crate::rules::Compositing;

/// The same view of a scene that is turned by 180 degrees around z, as glTF's axes are against the trainers'.
fn turned(camera: &Camera) -> Camera {
    Camera {
        rotation: camera.rotation.map(|[x, y, z]| [-x, -y, z]),
        ..camera.clone()
    }
}

/// A file, the same scene in another form, and the least PSNR that the other form's steps allow.
const PAIRS: [(&str, &str, f64); 7] = [
    ("playbot_lod4", "formats/playbot_lod4.compressed.ply", 50.0),
    ("playbot_lod4", "formats/playbot_lod4_v4.spz", 45.0),
    ("playbot_lod4", "formats/playbot_lod4.sog", 50.0),
    ("playbot_lod4", "formats/playbot_lod4_sog", 50.0),
    ("playbot_lod4", "formats/playbot_lod4.glb", 100.0),
    ("guitar", "gaussians/guitar.splat", 50.0),
    ("guitar", "gaussians/guitar_v3.spz", 50.0),
];

/// PSNR of the scene's picture in each file; docs/results/accuracy.md says it of more files.
#[test]
#[cfg_attr(not(has_formats), ignore = "needs the shared data")]
fn pictures_of_one_scene_agree_between_formats() {
    for (plain, other, least) in PAIRS {
        let a = load_plain(&shared_data(&format!("gaussians/{plain}.ply")));
        // What is measured is the format's precision, and not the order that its file asks for.
        let b = Scene {
            order: a.order,
            ..load_plain(&shared_data(other))
        };
        let frame = FramingInput::of_scene(&a, None);
        let camera = frame.camera(None, USUAL_FOV, 320, 240).unwrap();
        let camera_b = if b.up == a.up {
            camera.clone()
        } else {
            turned(&camera)
        };
        let draw = |scene: &Scene, camera: &Camera| {
            float::draw(scene, camera, &Rules::GAUSSIAN_3D, Compositing::FrontToBack).picture
        };
        let errors = compare(&draw(&b, &camera_b), &draw(&a, &camera)).unwrap();
        let found = errors.colour.psnr_db;
        println!("{other}: {} splats, {found:.2} dB", b.splats.len());
        assert!(found > least, "{other}: {found}");
    }
}
