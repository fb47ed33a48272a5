//! Tests of the camera readers: one view written in every form, and files damaged at every byte.

use super::*;
use std::path::PathBuf;

/// Looks from (1, 2, -5) at the origin with -y up; 64 x 48 pixels.
fn view() -> Camera {
    Camera::look_at([1.0, 2.0, -5.0], [0.0; 3], [0.0, -1.0, 0.0], 50.0, 64, 48).unwrap()
}

/// w, x, y, z of a rotation without a half turn.
fn quaternion(r: &[Vector; 3]) -> [f64; 4] {
    let w = 0.5 * (1.0 + r[0][0] + r[1][1] + r[2][2]).sqrt();
    let part = |a: f64, b: f64| (a - b) / (4.0 * w);
    [
        w,
        part(r[2][1], r[1][2]),
        part(r[0][2], r[2][0]),
        part(r[1][0], r[0][1]),
    ]
}

fn colmap_text(camera: &str) -> [(&'static str, String); 2] {
    let view = view();
    let [w, x, y, z] = quaternion(&view.rotation);
    let [tx, ty, tz] = view.translation;
    let images = format!(
        "# a comment\n7 {w} {x} {y} {z} {tx} {ty} {tz} 3 sub/a picture.png\n1 2 -1\n8 {w} {x} {y} {z} 0 0 0 3 b.png\n\n"
    );
    [
        ("cameras.txt", format!("# cameras\n3 {camera}\n")),
        ("images.txt", images),
    ]
}

fn colmap_binary() -> [(&'static str, Vec<u8>); 2] {
    let view = view();
    let mut cameras = 1u64.to_le_bytes().to_vec();
    cameras.extend([3i32, 1].map(i32::to_le_bytes).concat());
    cameras.extend([64u64, 48].map(u64::to_le_bytes).concat());
    cameras.extend(
        [view.fx, view.fy, view.cx, view.cy]
            .map(f64::to_le_bytes)
            .concat(),
    );
    let mut images = 1u64.to_le_bytes().to_vec();
    images.extend(7i32.to_le_bytes());
    let pose = [&quaternion(&view.rotation)[..], &view.translation].concat();
    images.extend(pose.iter().flat_map(|value| value.to_le_bytes()));
    images.extend(3i32.to_le_bytes());
    images.extend(b"a.png\0");
    images.extend(2u64.to_le_bytes());
    images.extend([0; 48]);
    [("cameras.bin", cameras), ("images.bin", images)]
}

/// Axes of the camera in the world, as columns of a matrix with the eye.
fn camera_to_world(signs: [f64; 3]) -> [[f64; 4]; 3] {
    let (view, eye) = (view(), view().eye());
    [0, 1, 2].map(|i| {
        let axis = |k: usize| signs[k] * view.rotation[k][i];
        [axis(0), axis(1), axis(2), eye[i]]
    })
}

fn transforms() -> String {
    let [a, b, c] = camera_to_world([1.0, -1.0, -1.0]);
    let view = view();
    serde_json::json!({
        "camera_model": "OPENCV", "w": 64, "h": 48, "fl_x": view.fx, "fl_y": view.fy, "cx": view.cx, "cy": view.cy,
        "frames": [{"file_path": "./images/a.png", "transform_matrix": [a, b, c, [0, 0, 0, 1]]}],
    })
    .to_string()
}

fn trainer() -> String {
    let rows = camera_to_world([1.0; 3]);
    let view = view();
    serde_json::json!([{
        "id": 0, "img_name": "a", "width": 64, "height": 48, "fx": view.fx, "fy": view.fy,
        "position": rows.map(|row| row[3]), "rotation": rows.map(|row| [row[0], row[1], row[2]]),
    }])
    .to_string()
}

fn assert_is_view(camera: &Camera) {
    let expected = view();
    assert_eq!((camera.width, camera.height), (64, 48));
    let numbers = |c: &Camera| {
        let rows = c.rotation.concat();
        [&rows[..], &c.translation, &[c.fx, c.fy, c.cx, c.cy]].concat()
    };
    for (found, wanted) in numbers(camera).iter().zip(numbers(&expected)) {
        assert!((found - wanted).abs() < 1e-9, "{camera:?}\n{expected:?}");
    }
}

fn folder_of(files: &[(&str, Vec<u8>)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

fn as_bytes(files: [(&'static str, String); 2]) -> Vec<(&'static str, Vec<u8>)> {
    files.map(|(name, text)| (name, text.into_bytes())).to_vec()
}

fn pinhole() -> String {
    let view = view();
    format!(
        "PINHOLE 64 48 {} {} {} {}",
        view.fx, view.fy, view.cx, view.cy
    )
}

#[test]
fn every_form_gives_the_same_camera() {
    let text = folder_of(&as_bytes(colmap_text(&pinhole())));
    let poses = load(text.path(), None).unwrap();
    assert_eq!(poses.len(), 2);
    for name in ["sub/a picture.png", "a picture.png", "a picture"] {
        let pose = choose(poses.clone(), Some(name)).unwrap();
        assert_is_view(&pose.camera);
        assert!(pose.notes.is_empty());
    }
    assert_eq!(load(&text.path().join("images.txt"), None).unwrap(), poses);
    let binary = folder_of(&colmap_binary());
    assert_is_view(
        &choose(load(binary.path(), None).unwrap(), None)
            .unwrap()
            .camera,
    );
    for (name, text) in [
        ("transforms.json", transforms()),
        ("cameras.json", trainer()),
    ] {
        let folder = folder_of(&[(name, text.into_bytes())]);
        let poses = load(&folder.path().join(name), None).unwrap();
        assert_is_view(&choose(poses, Some("a")).unwrap().camera);
    }
    let own = folder_of(&[("c.json", view().to_json().into_bytes())]);
    assert_is_view(&load(&own.path().join("c.json"), None).unwrap()[0].camera);
}

#[test]
fn a_model_lies_in_the_usual_subfolder_as_well() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("sparse/0");
    std::fs::create_dir_all(&inner).unwrap();
    for (name, bytes) in colmap_binary() {
        std::fs::write(inner.join(name), bytes).unwrap();
    }
    assert_eq!(load(folder.path(), None).unwrap().len(), 1);
}

#[test]
fn one_of_several_has_to_be_chosen() {
    let text = folder_of(&as_bytes(colmap_text(&pinhole())));
    let poses = load(text.path(), None).unwrap();
    let message = choose(poses.clone(), None).unwrap_err();
    assert_eq!(
        message,
        "holds 2 cameras: choose one by --image NAME (sub/a picture.png, b.png)"
    );
    let message = choose(poses, Some("c")).unwrap_err();
    assert_eq!(
        message,
        "holds no camera called 'c': it has sub/a picture.png, b.png"
    );
}

#[test]
fn distortion_is_told() {
    let notes = |camera: &str| {
        let folder = folder_of(&as_bytes(colmap_text(camera)));
        load(folder.path(), None).map(|poses| poses[0].notes.concat())
    };
    assert_eq!(notes("SIMPLE_RADIAL 64 48 50 32 24 0").unwrap(), "");
    let printed = notes("SIMPLE_RADIAL 64 48 50 32 24 0.1").unwrap();
    // The corner is 40 pixels from the middle: 0.1 * 0.8^2 of them.
    assert!(
        printed.contains("distortion of up to 2.6 pixels"),
        "{printed}"
    );
    assert!(
        notes("OPENCV 64 48 50 50 32 24 0 0 0 0.01")
            .unwrap()
            .contains("distortion")
    );
    // The corner's angle is atan(0.8) of 50 pixels instead of 0.8: 6.3 pixels less.
    let fisheye = notes("OPENCV_FISHEYE 64 48 50 50 32 24 0 0 0 0").unwrap();
    assert!(
        fisheye.contains("distortion of up to 6.3 pixels"),
        "{fisheye}"
    );
    let refused = notes("SPHERICAL 64 48 50").unwrap_err().to_string();
    assert!(
        refused.contains("cameras.txt line 2: the model 'SPHERICAL' is unknown"),
        "{refused}"
    );
    let text = transforms().replacen("\"w\":64", "\"w\":64,\"k1\":0.1", 1);
    let folder = folder_of(&[("transforms.json", text.into_bytes())]);
    let poses = load(&folder.path().join("transforms.json"), None).unwrap();
    assert!(poses[0].notes[0].contains("distortion"));
}

#[test]
fn a_field_of_view_and_a_size_make_a_lens() {
    let [a, b, c] = camera_to_world([1.0, -1.0, -1.0]);
    let angle = 2.0 * (32.0 / view().fx).atan();
    let text = serde_json::json!({
        "camera_angle_x": angle,
        "frames": [{"file_path": "a", "transform_matrix": [a, b, c, [0, 0, 0, 1]]}],
    });
    let folder = folder_of(&[("t.json", text.to_string().into_bytes())]);
    let path = folder.path().join("t.json");
    assert_is_view(&load(&path, Some([64, 48])).unwrap()[0].camera);
    let message = load(&path, None).unwrap_err().to_string();
    assert!(
        message.contains("frame 0: w and h are not there: give --size WxH"),
        "{message}"
    );
}

/// A cut file is refused, or holds fewer cameras where lines end; nothing panics.
#[test]
fn damaged_files_are_refused() {
    let check = |files: &[(&str, Vec<u8>)], read: &str, may_shrink: bool| {
        let folder = folder_of(files);
        let path: PathBuf = folder.path().join(read);
        let whole = load(&path, None).unwrap().len();
        for (name, bytes) in files {
            let target = folder.path().join(name);
            let end = bytes.trim_ascii_end().len();
            for length in 0..end {
                std::fs::write(&target, &bytes[..length]).unwrap();
                match load(&path, None) {
                    Ok(poses) => {
                        assert!(may_shrink && poses.len() <= whole, "{name} cut at {length}")
                    }
                    Err(error) => assert!(error.file.is_some(), "{error}"),
                }
                let mut changed = bytes.clone();
                changed[length] ^= 0x80;
                std::fs::write(&target, changed).unwrap();
                let _ = load(&path, None);
            }
            std::fs::write(&target, bytes).unwrap();
        }
    };
    check(&colmap_binary(), "images.bin", false);
    check(&as_bytes(colmap_text(&pinhole())), "images.txt", true);
    check(
        &[("transforms.json", transforms().into_bytes())],
        "transforms.json",
        false,
    );
    check(
        &[("cameras.json", trainer().into_bytes())],
        "cameras.json",
        false,
    );
}
