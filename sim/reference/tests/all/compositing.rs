//! Blending by hand: stacks of splats over one pixel, whose result can be worked out on paper.

use super::scenes::{scene_of, straight_camera};
use splatline_reference::camera::Camera;
use splatline_reference::engines::golden::rotated_axes;
use splatline_reference::engines::{compositor, float};
use splatline_reference::rules::{Compositing, Rules};
use splatline_reference::scene::{Scene, Splat};

/// One pixel, one splat per (opacity, depth): wide enough to have the peak opacity all over the pixel.
fn stack(opacities_and_depths: &[(f64, f64)]) -> (Scene, Camera) {
    let camera = Camera {
        width: 1,
        height: 1,
        cx: 0.5,
        cy: 0.5,
        ..straight_camera()
    };
    let colours = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let splat = |(index, &(weight, depth)): (usize, &(f64, f64))| Splat {
        centre: [0.0, 0.0, depth],
        axes: rotated_axes([1.0, 0.0, 0.0, 0.0], [1.0; 3]),
        weight,
        colour: colours[index % 3],
    };
    (
        scene_of(opacities_and_depths.iter().enumerate().map(splat).collect()),
        camera,
    )
}

fn pixel_of(stacked: &(Scene, Camera), rules: &Rules, compositing: Compositing) -> [f64; 4] {
    float::draw(&stacked.0, &stacked.1, rules, compositing)
        .picture
        .pixels[0]
}

fn assert_close(computed: [f64; 4], expected: [f64; 4]) {
    let close = computed
        .iter()
        .zip(expected)
        .all(|(c, e)| (c - e).abs() <= 1e-12);
    assert!(close, "{computed:?} instead of {expected:?}");
}

#[test]
fn nearer_splats_cover_farther_ones_and_ties_go_by_index() {
    let far_first = stack(&[(0.5, 3.0), (0.25, 2.0)]);
    let tied = stack(&[(0.5, 2.0), (0.25, 2.0)]);
    for order in [Compositing::FrontToBack, Compositing::BackToFront] {
        let pixel = |stacked| pixel_of(stacked, &Rules::GAUSSIAN_3D, order);
        assert_close(pixel(&far_first), [0.375, 0.25, 0.0, 0.625]);
        assert_close(pixel(&tied), [0.5, 0.125, 0.0, 0.625]);
    }
    let depths = [3.0, 2.0, 3.0, 2.0, 1.0, 2.0].map(|depth| (0.5, depth));
    let (scene, camera) = stack(&depths);
    let projected = float::footprints(&scene, &camera, &Rules::GAUSSIAN_3D);
    assert_eq!(compositor::order(&projected), [4, 1, 3, 5, 0, 2]);
}

#[test]
fn x_ray_sums_and_clamps_at_the_end() {
    let stacked = stack(&[(0.5, 3.0), (0.75, 2.0), (0.25, 1.0), (0.75, 1.5)]);
    let pixel = pixel_of(&stacked, &Rules::GAUSSIAN_3D, Compositing::XRay);
    assert_close(pixel, [1.0, 0.75, 0.25, 1.0]);
}

#[test]
fn a_finished_pixel_stops_before_or_after_its_last_splat() {
    // The second splat would leave a transmittance of 0.1 times 0.0005.
    let opaque = stack(&[(0.9, 1.0), (1.0, 2.0), (0.5, 3.0)]);
    let deeper = Rules {
        alpha_max: 0.9995,
        ..Rules::GAUSSIAN_3D
    };
    let after = Rules {
        omit_finishing: false,
        ..deeper
    };
    let never = Rules {
        minimum_transmittance: 0.0,
        ..deeper
    };
    let whole = [0.9, 0.09995, 0.000025, 1.0 - 0.000025];
    for (rules, expected, covered) in [
        (&deeper, [0.9, 0.0, 0.0, 0.9], 1),
        (&after, [0.9, 0.09995, 0.0, 0.99995], 2),
        (&never, whole, 3),
    ] {
        let drawing = float::draw(&opaque.0, &opaque.1, rules, Compositing::FrontToBack);
        assert_close(drawing.picture.pixels[0], expected);
        assert_eq!(drawing.counts.covered_pixels, covered);
    }
    assert_close(pixel_of(&opaque, &deeper, Compositing::BackToFront), whole);
}

#[test]
fn progress_reaches_the_last_row() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let (scene, camera) = (scene_of(vec![]), straight_camera());
    let most = AtomicUsize::new(0);
    let progress = |done: usize, total: usize| {
        assert_eq!(total, camera.height);
        most.fetch_max(done, Ordering::Relaxed);
    };
    let footprints = float::footprints(&scene, &camera, &Rules::EWA);
    let order = Compositing::FrontToBack;
    compositor::draw(&footprints, &camera, &Rules::EWA, order, &progress);
    assert_eq!(most.into_inner(), camera.height);
}
