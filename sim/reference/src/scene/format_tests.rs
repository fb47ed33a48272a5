//! One scene in several formats, written by others: the pictures agree within each format's own precision.

use super::tests::{load_plain, shared_data};
use super::*;
use crate::engines::float;
use crate::framing::{FramingInput, USUAL_FOV};
use crate::metrics::compare;
use crate::rules::Compositing;
use std::path::{Path, PathBuf};

/// The same view of a scene that is turned by 180 degrees around z, as glTF's axes are against the trainers'.
fn turned(camera: &Camera) -> Camera {
    Camera {
        rotation: camera.rotation.map(|[x, y, z]| [-x, -y, z]),
        ..camera.clone()
    }
}

/// A file, the same scene in another form, and the least PSNR that the other form's steps allow.
type FormatPair = (PathBuf, PathBuf, f64);

/// What lies in the shared data.
fn at_hand() -> Vec<FormatPair> {
    let pairs = [
        (
            "gaussians/playbot_lod4.ply",
            "formats/playbot_lod4.compressed.ply",
            50.0,
        ),
        (
            "gaussians/playbot_lod4.ply",
            "formats/playbot_lod4_v4.spz",
            45.0,
        ),
        (
            "gaussians/playbot_lod4.ply",
            "formats/playbot_lod4.sog",
            50.0,
        ),
        (
            "gaussians/playbot_lod4.ply",
            "formats/playbot_lod4_sog",
            50.0,
        ),
        (
            "gaussians/playbot_lod4.ply",
            "formats/playbot_lod4.glb",
            100.0,
        ),
        ("gaussians/guitar.ply", "gaussians/guitar.splat", 50.0),
        ("gaussians/guitar.ply", "gaussians/guitar_v3.spz", 50.0),
    ];
    pairs
        .map(|(plain, other, least)| (shared_data(plain), shared_data(other), least))
        .to_vec()
}

/// What other people's writers made of the captured scenes, in the folder of the environment's FORMATS: NAME.ext or
/// NAME_anything.ext.
fn further() -> Vec<FormatPair> {
    let Some(folder) = std::env::var_os("FORMATS") else {
        return Vec::new();
    };
    let scenes = [
        "gaussians/playbot_lod4.ply",
        "gaussians/guitar.ply",
        "golden/tiny.ply",
    ];
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    let pair = |file: PathBuf| {
        let name = file.file_name()?.to_str()?.to_owned();
        let of = |scene: &&str| {
            let stem = Path::new(scene)
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy();
            name.strip_prefix(&*stem)
                .is_some_and(|rest| rest.starts_with(['.', '_']))
        };
        let scene = shared_data(scenes.iter().find(|scene| of(scene))?);
        Some((scene, file, 35.0))
    };
    files.into_iter().filter_map(pair).collect()
}

/// PSNR of the scene's picture in each file; docs/results/accuracy.md says it of more files.
#[test]
#[cfg_attr(not(has_formats), ignore = "needs the shared data")]
fn pictures_of_one_scene_agree_between_formats() {
    println!(
        "| scene | file | splats | PSNR of the picture, dB | largest error |\n|---|---|---|---|---|"
    );
    for (plain, other, least) in at_hand().into_iter().chain(further()) {
        let a = load_plain(&plain);
        // What is measured is the format's precision, and not the order that its file asks for.
        let b = Scene {
            order: a.order,
            ..load_plain(&other)
        };
        let camera = FramingInput::of_scene(&a, None)
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
            other.file_name().unwrap().to_string_lossy(),
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
