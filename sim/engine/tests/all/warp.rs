//! Depth images and textured planes drawn from elsewhere as points and splats.

use super::kernels::draw_hybrid;
use splatline_engine::camera::Camera;
use splatline_engine::design::DesignChoice;
use splatline_engine::fixed::{HybridFacts, Options};
use splatline_engine::hybrid::{Hybrid, Points, spacing};
use splatline_engine::metrics::compare;
use splatline_engine::picture::Picture;
use splatline_engine::rules::{Antialias, Rules};
use splatline_engine::scene::Scene;
use splatline_engine::scene::points::synthetic::{Paint, scene, sphere};
use splatline_engine::surface::Style;
use splatline_engine::texture::Texture;
use splatline_engine::texture::warp::{DEPTH_RANGE, DepthImage, textured_plane};
use splatline_engine::vector::{Vector, dot};
use splatline_reference::engines as reference;

fn camera(eye: [f64; 3], size: usize) -> Camera {
    Camera::look_at(eye, [0.0; 3], [0.0, 0.0, 1.0], 40.0, size, size).unwrap()
}

/// A ball seen from the front.
fn ball(camera: &Camera) -> (DepthImage, Picture) {
    let points = sphere([0.0; 3], 1.0, 6000, Paint::opaque([0.8, 0.5, 0.2]));
    let ball = scene("ball", points);
    let drawing = reference::surface::draw(&ball, camera, &Style::opaque(3.0 * ball.radius));
    (DepthImage::of_drawing(&drawing, camera), drawing.picture)
}

/// The rules by which samples are drawn: peak opacities, distance scaling by the samples' spacing.
fn rules(samples: &Scene) -> Rules {
    samples
        .natural_rules
        .with_antialias(Antialias::Swan(spacing(samples)))
}

/// The choice of points and splats for samples of a surface.
fn hybrid(samples: &Scene, points: Points) -> Hybrid {
    Hybrid {
        points,
        depth_range: Some(DEPTH_RANGE * spacing(samples)),
        phase_bits: None,
    }
}

/// The warping equation between two cameras, written out (McMillan 1997; \[HYBRID\] 3), where the samples go through
/// space and the ordinary projection: screen position and depth in `to` of the place that `from` sees at `place` and
/// `depth`.
///
/// With R = W' W^T the relative rotation and c = d' - R d the relative translation: t' = R t + c.
fn reproject(from: &Camera, place: [f64; 2], depth: f64, to: &Camera) -> ([f64; 2], f64) {
    let relative: [Vector; 3] = to
        .rotation
        .map(|row| from.rotation.map(|other| dot(row, other)));
    let [x, y] = [
        (place[0] - from.cx) / from.fx,
        (place[1] - from.cy) / from.fy,
    ];
    let seen = if from.orthographic {
        [x, y, depth]
    } else {
        [x * depth, y * depth, depth]
    };
    let turned = |axis: usize| {
        let offset = to.translation[axis] - dot(relative[axis], from.translation);
        dot(relative[axis], seen) + offset
    };
    let [x, y, z] = [0, 1, 2].map(turned);
    let scale = if to.orthographic { 1.0 } else { z };
    ([to.fx * x / scale + to.cx, to.fy * y / scale + to.cy], z)
}

fn draw(samples: &Scene, camera: &Camera, points: Points) -> (Picture, HybridFacts, Picture) {
    let design = DesignChoice::named("standard24").unwrap();
    let (rules, hybrid) = (rules(samples), hybrid(samples, points));
    let options = Options::front_to_back(&rules, &design);
    let (drawn, facts) = draw_hybrid(samples, camera, options, &hybrid).unwrap();
    let float = reference::hybrid::draw(samples, camera, &rules, &hybrid).picture;
    (drawn, facts, float)
}

#[test]
fn samples_land_where_the_warping_equation_says() {
    let from = camera([0.3, -4.0, 1.0], 48);
    let (image, _) = ball(&from);
    let samples = image.samples("ball");
    let seen: Vec<(usize, f64)> = image
        .pixels
        .iter()
        .enumerate()
        .filter_map(|(index, pixel)| pixel.map(|(_, depth)| (index, depth)))
        .collect();
    assert!(seen.len() == samples.splats.len() && seen.len() > 800);
    let mut parallel = camera([3.0, -2.0, 0.5], 48);
    (parallel.orthographic, parallel.fx, parallel.fy) = (true, 20.0, 20.0);
    for to in [&from, &camera([1.5, -5.0, 2.0], 64), &parallel] {
        for ((index, depth), sample) in seen.iter().zip(&samples.splats) {
            let place = [(index % 48) as f64 + 0.5, (index / 48) as f64 + 0.5];
            let (expected, z) = reproject(&from, place, *depth, to);
            let position = to.to_camera(sample.centre);
            let scale = if to.orthographic { 1.0 } else { position[2] };
            let found = [
                to.fx * position[0] / scale + to.cx,
                to.fy * position[1] / scale + to.cy,
            ];
            assert!((position[2] - z).abs() < 1e-9);
            assert!((0..2).all(|k: usize| (found[k] - expected[k]).abs() < 1e-9));
        }
    }
}

/// Seen from where it was taken, the depth image is the picture again; no sample lies nearer than its neighbours'
/// spacing there.
#[test]
fn a_depth_image_seen_by_its_own_camera_is_the_picture() {
    let from = camera([0.0, -4.0, 1.0], 64);
    let (image, picture) = ball(&from);
    let (found, ..) = draw(&image.samples("ball"), &from, Points::Auto);
    let middle = |picture: &Picture| picture.pixels[32 * 64 + 32];
    let pairs = middle(&found).into_iter().zip(middle(&picture));
    pairs.for_each(|(a, b)| assert!((a - b).abs() < 0.03, "{a} {b}"));
    assert!(found.pixels[0][3] == 0.0);
}

#[test]
fn near_samples_stay_splats_and_far_ones_become_points() {
    let (image, _) = ball(&camera([0.0, -4.0, 1.0], 64));
    let samples = image.samples("ball");
    let shares = [2.4, 20.0].map(|distance: f64| {
        let eye = [0.24 * distance, -0.93 * distance, 0.27 * distance];
        let (drawn, facts, float) = draw(&samples, &camera(eye, 64), Points::Auto);
        let errors = compare(&drawn, &float).unwrap();
        for group in [errors.colour, errors.alpha] {
            assert!(
                group.psnr_db >= 60.0 && group.bias.abs() <= 5e-4,
                "{group:?}"
            );
        }
        // The ball is closed where it was seen.
        assert!(float.pixels[32 * 64 + 32][3] > 0.95);
        facts.points as f64 / facts.drawn as f64
    });
    assert_eq!(shares, [0.0, 1.0]);
}

#[test]
fn a_texture_on_a_plane_keeps_its_corners() {
    let texture = Texture::from_pattern(8, 4, |u, v| [u / 8.0, v / 4.0, 0.5]);
    let plane = textured_plane(
        "plane",
        &texture,
        [0.0; 3],
        [[4.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
    );
    assert_eq!(plane.splats.len(), 32);
    assert_eq!(plane.splats[0].centre, [0.25, 0.25, 0.0]);
    assert_eq!(plane.splats[31].centre, [3.75, 1.75, 0.0]);
    assert_eq!(plane.splats[31].colour, [7.5 / 8.0, 3.5 / 4.0, 0.5]);
    assert!((spacing(&plane) - 0.5).abs() < 1e-12);
}

#[test]
fn a_depth_image_of_nothing_has_no_samples_and_draws_nothing() {
    let from = camera([0.0, -4.0, 1.0], 8);
    let empty = DepthImage {
        camera: from.clone(),
        pixels: vec![None; 64],
    };
    let samples = empty.samples("nothing");
    assert!(samples.splats.is_empty());
    let float = reference::hybrid::draw(
        &samples,
        &from,
        &rules(&samples),
        &hybrid(&samples, Points::Auto),
    );
    assert!(float.picture.pixels.iter().all(|pixel| *pixel == [0.0; 4]));
}
