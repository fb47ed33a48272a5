//! The camera's rotation as a file rounds it, seen by both engines.

use splatline_engine::camera::Camera;
use splatline_engine::rules::{Compositing, Rules};
use splatline_engine::scene::synthetic;
use splatline_engine::{design::DesignChoice, fixed, metrics};
use splatline_reference::engines::float;

/// Both engines draw what the file means: with the rotation as it stands, fixed and float were 93 dB apart.
#[test]
fn both_engines_see_the_same_view_of_a_rounded_rotation() {
    let (scene, rules) = (synthetic::random_gaussians(400, 5, 3.0), Rules::GAUSSIAN_3D);
    let turned = Camera::look_at([3.1, -2.2, -3.3], [0.0; 3], [0.1, -1.0, 0.2], 60.0, 96, 96);
    let mut rounded = turned.unwrap();
    for entry in rounded.rotation.iter_mut().flatten() {
        *entry = (*entry * 3e4).round() / 3e4;
    }
    let camera = Camera::from_json_str(&rounded.to_json()).unwrap();
    assert_ne!(camera.rotation, rounded.rotation);
    let design = DesignChoice::named("deep32").unwrap();
    let options = fixed::Options::front_to_back(&rules, &design);
    let drawn = fixed::draw(&scene, &camera, &options).picture;
    let float = float::draw(&scene, &camera, &rules, Compositing::FrontToBack);
    let errors = metrics::compare(&drawn, &float.picture).unwrap();
    let decibels = errors.colour.psnr_db;
    assert!(decibels > 120.0, "{decibels:.1} dB");
}
