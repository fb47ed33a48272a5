//! Tests of bounds and default cameras.

use super::super::tests::{load_plain, shared_data};
use super::super::{demo, synthetic::random_gaussians};
use super::*;

/// Pixel coordinates of a place, and its depth.
fn project(camera: &Camera, place: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = camera.to_camera(place);
    [
        camera.fx * x / z + camera.cx,
        camera.fy * y / z + camera.cy,
        z,
    ]
}

/// Is a place seen?
pub(crate) fn is_in_view(camera: &Camera, place: [f64; 3]) -> bool {
    let [u, v, depth] = project(camera, place);
    depth > camera.near
        && (0.0..camera.width as f64).contains(&u)
        && (0.0..camera.height as f64).contains(&v)
}

/// Part of the splats' centres that lie within the picture.
fn part_in_view(scene: &Scene, camera: &Camera) -> f64 {
    let seen = scene.splats.iter();
    let seen = seen.filter(|splat| is_in_view(camera, splat.centre));
    seen.count() as f64 / scene.splats.len() as f64
}

#[test]
fn look_at_shows_the_target_in_the_middle_with_up_upwards() {
    let camera = look_at(
        [1.0, 2.0, -9.0],
        [3.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        60.0,
        320,
        240,
    );
    let [u, v, depth] = project(&camera, [3.0, 1.0, 0.0]);
    assert!((u - 160.0).abs() < 1e-9 && (v - 120.0).abs() < 1e-9 && depth > 0.0);
    let [_, above, _] = project(&camera, [3.0, 0.5, 0.0]);
    assert!(above < 120.0, "up (-y) is towards row 0");
    let [right, _, _] = project(&camera, [3.5, 1.0, 0.0]);
    assert!(
        right > 160.0,
        "looking along +z with -y up, +x is on the right"
    );
    assert!((camera.fy - 120.0 / 30f64.to_radians().tan()).abs() < 1e-9);
}

#[test]
fn bounds_hold_all_centres() {
    let mut scene = random_gaussians(3, 1, 1.0);
    let places = [[1.0, 5.0, -1.0], [2.0, 4.0, 0.0], [3.0, 3.0, 7.0]];
    for (splat, place) in scene.splats.iter_mut().zip(places) {
        splat.centre = place;
    }
    let bounds = scene.bounds().unwrap();
    let corners = [bounds.least, bounds.greatest];
    assert_eq!(corners, [[1.0, 3.0, -1.0], [3.0, 5.0, 7.0]]);
    assert_eq!(bounds.centre(), [2.0, 4.0, 3.0]);
    assert_eq!(bounds.extents(), [2.0, 2.0, 8.0]);
    scene.splats.clear();
    assert_eq!(scene.bounds(), None);
    let rotation = scene.default_camera(10, 10).rotation;
    assert!(rotation.iter().flatten().all(|entry| entry.is_finite()));
}

#[test]
fn stray_splats_do_not_push_the_camera_away() {
    let mut scene = random_gaussians(1000, 1, 1.0);
    scene.name = "capture.ply".to_string();
    let near = scene.default_camera(64, 64);
    for splat in scene.splats.iter_mut().take(10) {
        splat.centre = [1e6, -1e6, 1e6];
    }
    let far = scene.default_camera(64, 64);
    let moved = vector::subtract(near.translation, far.translation);
    assert!(vector::length(moved) < 0.2, "moved by {moved:?}");
}

#[test]
fn a_single_splat_can_be_looked_at() {
    let mut scene = random_gaussians(1, 1, 1.0);
    for name in ["one.ply", "random:1:1"] {
        scene.name = name.to_string();
        let camera = scene.default_camera(64, 48);
        assert!(camera.translation.iter().all(|part| part.is_finite()));
    }
}

#[test]
fn default_cameras_show_the_scenes() {
    let demo = demo().unwrap();
    let camera = demo.default_camera(512, 512);
    assert_eq!(camera.rotation, vector::diagonal([1.0; 3]));
    let part = part_in_view(&demo, &camera);
    assert!(part > 0.99, "{part}");
    let random = random_gaussians(1000, 1, 1.0);
    assert!(part_in_view(&random, &random.default_camera(512, 512)) > 0.75);
}

#[test]
#[cfg_attr(not(has_data), ignore = "needs the shared data")]
fn default_cameras_show_captured_scenes() {
    for file in [
        "gaussians/guitar.ply",
        "gaussians/playbot_lod4.ply",
        "golden/tiny.ply",
        "volumes/headsq.nhdr",
    ] {
        let path = shared_data(file);
        let scene = load_plain(&path);
        let part = part_in_view(&scene, &scene.default_camera(640, 480));
        println!("{file}: {part}");
        assert!(part > 0.85, "{file}: {part} in view");
    }
}
