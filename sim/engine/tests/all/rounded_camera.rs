//! The camera's rotation as a file rounds it, seen by both engines.

use splatline_engine::camera::Camera;
use splatline_engine::scene::synthetic;

fn file_of(rotation: [[f64; 3]; 3], translation: [f64; 3]) -> String {
    let row = |i: usize| {
        let [a, b, c] = rotation[i];
        [a, b, c, translation[i]]
    };
    let matrix = [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]].concat();
    let mut file: serde_json::Value =
        serde_json::from_str(&synthetic::camera(96, 96).to_json()).unwrap();
    file["world_to_camera"] = serde_json::json!(matrix);
    file.to_string()
}

/// Both engines draw what the file means: with the rotation as it stands, fixed and float were 93 dB apart.
#[test]
fn both_engines_see_the_same_view_of_a_rounded_rotation() {
    use splatline_engine::rules::{Compositing, Rules};
    use splatline_engine::{design::DesignChoice, fixed, metrics};
    use splatline_reference::engines::float;
    let scene = synthetic::random_gaussians(400, 5, 3.0);
    let exact = synthetic::camera(96, 96);
    let turned = Camera::look_at([3.1, -2.2, -3.3], [0.0; 3], [0.1, -1.0, 0.2], 60.0, 96, 96);
    let turned = turned.unwrap();
    let rotation = turned
        .rotation
        .map(|row| row.map(|entry| (entry * 3e4).round() / 3e4));
    let text = serde_json::from_str::<serde_json::Value>(&file_of(rotation, turned.translation));
    let mut file = text.unwrap();
    for (field, value) in [
        ("fx", exact.fx),
        ("fy", exact.fy),
        ("cx", 48.0),
        ("cy", 48.0),
    ] {
        file[field] = serde_json::json!(value);
    }
    (file["width"], file["height"]) = (serde_json::json!(96), serde_json::json!(96));
    let camera = Camera::from_json_str(&file.to_string()).unwrap();
    let design = DesignChoice::named("deep32").unwrap();
    let options = fixed::Options::front_to_back(&Rules::GAUSSIAN_3D, &design);
    let drawn = fixed::draw(&scene, &camera, &options).picture;
    let float = float::draw(
        &scene,
        &camera,
        &Rules::GAUSSIAN_3D,
        Compositing::FrontToBack,
    );
    let errors = metrics::compare(&drawn, &float.picture).unwrap();
    assert!(
        errors.colour.psnr_db > 120.0,
        "{:.1} dB",
        errors.colour.psnr_db
    );
}
