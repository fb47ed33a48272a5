//! Cameras from points of view and from files: what is accepted, what is refused and how the refusal reads.

use splatline_reference::camera::{Camera, DEFAULT_FAR, DEFAULT_NEAR, MAX_SIZE};
use splatline_reference::vector;

fn sample() -> Camera {
    let (eye, up) = ([0.0, -5.0, -8.0], [0.0, -1.0, 0.0]);
    Camera::look_at(eye, [0.0; 3], up, 60.0, 320, 240).unwrap()
}

/// A camera file with one field replaced.
fn file_with(field: &str, value: serde_json::Value) -> String {
    let mut file: serde_json::Value = serde_json::from_str(&sample().to_json()).unwrap();
    file[field] = value;
    file.to_string()
}

#[test]
fn look_at_puts_the_target_in_the_middle_and_up_at_the_top() {
    let camera = sample();
    let target = camera.to_camera([0.0; 3]);
    assert!(target[0].abs() < 1e-12 && target[1].abs() < 1e-12);
    assert!((target[2] - 89.0_f64.sqrt()).abs() < 1e-12);
    let above = camera.to_camera([0.0, -1.0, 0.0]);
    assert!(above[1] < -0.5, "y points down in the picture");
    let right = camera.to_camera([1.0, 0.0, 0.0]);
    assert!((right[0] - 1.0).abs() < 1e-12);
    assert!((camera.fy - 120.0 * 3.0_f64.sqrt()).abs() < 1e-9);
    assert_eq!((camera.fx, camera.cx, camera.cy), (camera.fy, 160.0, 120.0));
    for (computed, expected) in camera.eye().into_iter().zip([0.0, -5.0, -8.0]) {
        assert!((computed - expected).abs() < 1e-12);
    }
    assert!((vector::dot(camera.forward(), [0.0, 5.0, 8.0]) - 89.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn look_at_refuses_views_without_a_direction() {
    let look = |eye, target, up, fov, width, height| {
        Camera::look_at(eye, target, up, fov, width, height)
            .unwrap_err()
            .field
    };
    let (o, y, z) = ([0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    assert_eq!(look(z, z, y, 60.0, 8, 8), Some("target"));
    assert_eq!(look([1e308; 3], [-1e308; 3], y, 60.0, 8, 8), Some("target"));
    assert_eq!(look(o, z, [0.0, 0.0, -2.0], 60.0, 8, 8), Some("up"));
    assert_eq!(look(o, z, o, 60.0, 8, 8), Some("up"));
    assert_eq!(look([f64::NAN; 3], z, y, 60.0, 8, 8), Some("eye"));
    for fov in [0.0, -1.0, 180.0, f64::NAN, f64::INFINITY] {
        assert_eq!(look(o, z, y, fov, 8, 8), Some("fov"), "{fov}");
    }
    assert_eq!(look(o, z, y, 1e-320, 8, 8), Some("fx"));
    assert_eq!(look(o, z, y, 60.0, 0, 8), Some("width"));
    assert_eq!(look(o, z, y, 60.0, 8, MAX_SIZE + 1), Some("height"));
    // Far from the origin and with a long up vector all is well.
    let (far, ahead, long) = ([1e6, 0.0, 0.0], [1e6, 0.0, 1e-3], [0.0, 1e300, 0.0]);
    assert!(Camera::look_at(far, ahead, long, 60.0, 8, 8).is_ok());
}

#[test]
fn json_keeps_the_camera_and_fills_in_the_optional_fields() {
    let camera = Camera {
        near: 0.5,
        far: 9.0,
        orthographic: true,
        ..sample()
    };
    assert_eq!(Camera::from_json_str(&camera.to_json()).unwrap(), camera);
    let short = r#"{"width": 4, "height": 3, "fx": 2, "fy": 2.5, "cx": 2, "cy": 1.5,
                    "world_to_camera": [1,0,0,7, 0,1,0,8, 0,0,1,9, 0,0,0,1]}"#;
    let camera = Camera::from_json_str(short).unwrap();
    assert_eq!(
        (camera.near, camera.far, camera.orthographic),
        (DEFAULT_NEAR, DEFAULT_FAR, false)
    );
    assert_eq!(camera.translation, [7.0, 8.0, 9.0]);
}

#[test]
fn unsound_files_are_refused_by_field() {
    use serde_json::json;
    let mirrored = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    let scaled = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1];
    let column_major = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1];
    let cases = [
        ("width", json!(0)),
        ("height", json!(16385)),
        ("height", json!(u64::MAX)),
        ("fx", json!(0.0)),
        ("fy", json!(-3.0)),
        ("near", json!(0.0)),
        ("far", json!(0.001)),
        ("world_to_camera", json!([1, 2, 3])),
        ("world_to_camera", json!(mirrored)),
        ("world_to_camera", json!(scaled)),
        ("world_to_camera", json!(column_major)),
    ];
    for (field, value) in cases {
        let error = Camera::from_json_str(&file_with(field, value.clone())).unwrap_err();
        assert_eq!(error.field, Some(field), "{field} = {value}: {error}");
        assert!(error.to_string().contains(field));
    }
    for (field, value) in [
        ("fx", json!("wide")),
        ("width", json!(-4)),
        ("ortographic", json!(true)),
    ] {
        let error = Camera::from_json_str(&file_with(field, value))
            .unwrap_err()
            .to_string();
        assert!(error.contains("not a camera"), "{error}");
    }
    assert!(Camera::from_json_str(&sample().to_json().replace("0.01", "1e999")).is_err());
}

#[test]
fn errors_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("view.json");
    let refused = || {
        let refused = Camera::corrected_from_json_file(&path);
        refused.unwrap_err().to_string()
    };
    let missing = refused();
    assert!(
        missing.contains("view.json") && missing.contains("cannot be opened"),
        "{missing}"
    );
    std::fs::write(&path, file_with("fx", serde_json::json!(0))).unwrap();
    let expected = format!(
        "camera file '{}': 'fx' is 0, but must be positive and finite (in pixels)",
        path.display()
    );
    assert_eq!(refused(), expected);
    std::fs::write(&path, vec![b' '; 2 << 20]).unwrap();
    assert!(refused().contains("at most"));
}

#[test]
fn resizing_scales_the_intrinsics() {
    let camera = sample();
    let resized = camera.resized(160, 60).unwrap();
    assert_eq!((resized.fx, resized.fy), (camera.fx / 2.0, camera.fy / 4.0));
    assert_eq!((resized.cx, resized.cy), (80.0, 30.0));
    assert_eq!(resized.rotation, camera.rotation);
    assert_eq!(camera.resized(0, 60).unwrap_err().field, Some("width"));
}

/// A rotation about a slant axis, its entries rounded to a step.
fn rounded_rotation(step: f64) -> [[f64; 3]; 3] {
    let (eye, target, up) = ([1.3, -2.1, 0.7], [0.2, 0.4, 3.0], [0.1, -1.0, 0.3]);
    let rotation = Camera::look_at(eye, target, up, 50.0, 8, 8)
        .unwrap()
        .rotation;
    rotation.map(|row| row.map(|entry| (entry / step).round() * step))
}

fn file_of(rotation: [[f64; 3]; 3], translation: [f64; 3]) -> String {
    let row = |i: usize| {
        let [a, b, c] = rotation[i];
        [a, b, c, translation[i]]
    };
    let matrix = [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]].concat();
    file_with("world_to_camera", serde_json::json!(matrix))
}

#[test]
fn rounded_rotations_become_rotations_seen_from_the_same_eye() {
    for (step, translation) in [
        (1e-5, [0.3, -0.2, 5.0]),
        (1e-6, [4.5e5, 5.8e6, 300.0]),
        (2f64.powi(-24), [1.0, 2.0, 3.0]),
    ] {
        let given = rounded_rotation(step);
        let text = file_of(given, translation);
        let (camera, change) = Camera::corrected_from_json_str(&text).unwrap();
        let products = |i: usize, j: usize| vector::dot(camera.rotation[i], camera.rotation[j]);
        for (i, j) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
            let expected = if i == j { 1.0 } else { 0.0 };
            assert!((products(i, j) - expected).abs() < 1e-15, "{step}: {i} {j}");
        }
        assert!(change > 0.05 * step && change <= step, "{step}: {change}");
        // The eye is where the matrix of the file maps to 0.
        let eye = camera.eye();
        let back = vector::add(vector::transform(&given, eye), translation);
        let scale = translation.iter().fold(1.0, |m: f64, t| m.max(t.abs()));
        assert!(vector::length(back) < 4e-15 * scale, "{step}: {back:?}");
        // Nearest: no small turn of it is nearer to the matrix of the file.
        let distance = |rotation: &[[f64; 3]; 3]| -> f64 {
            let pairs = rotation.iter().flatten().zip(given.iter().flatten());
            pairs.map(|(a, b)| (a - b) * (a - b)).sum()
        };
        for axis in 0..3 {
            for angle in [-0.1 * step, 0.1 * step] {
                let mut turned = camera.rotation;
                let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
                for row in &mut turned {
                    let (a, b) = (row[p], row[q]);
                    (row[p], row[q]) = (a - angle * b, b + angle * a);
                }
                assert!(distance(&turned) > distance(&camera.rotation), "{step}");
            }
        }
    }
    let (_, change) = Camera::corrected_from_json_str(&sample().to_json()).unwrap();
    assert_eq!(change, 0.0);
}

#[test]
fn far_from_a_rotation_is_refused() {
    let text = file_of(rounded_rotation(1e-3), [0.0; 3]);
    let error = Camera::from_json_str(&text).unwrap_err();
    assert!(error.to_string().contains("is not a rotation"), "{error}");
}
