//! The camera of a capture, moved to where what is seen of the scene fills the picture.
//!
//! A splat within the picture obeys four bounds, one a side: with the camera's axes, `x - t z <= x0 - t z0` on the
//! right for an eye at (x0, z0) and a picture of half width t at distance 1. So the farthest splat of each side gives
//! the eye in closed form. Trained scenes have floaters: faint or few, far from the rest. A side's fence stands beyond
//! what holds most of the opacity, and who is outside does not count.

use super::MARGIN;
use crate::camera::Camera;
use crate::scene::{Scene, Splat};
use crate::vector::{self, Vector};

/// Share of the opacity that lies beyond a side before its fence.
const BEYOND: f64 = 0.01;
/// Distance of the fence from there, as a part of the picture.
const FENCE: f64 = 0.25;
/// Standard deviations of a splat that are to be seen.
const SEEN: f64 = 2.0;
/// Splats that a fence is measured by.
const SAMPLES: usize = 1 << 16;

/// How far a splat reaches right, left, down and up, each along the normal of the picture's side.
struct Sides([Vector; 4]);

impl Sides {
    fn reach(&self, camera: &Camera, splat: &Splat) -> [f64; 4] {
        let place = camera.to_camera(splat.centre);
        let axes = splat
            .axes
            .map(|axis| vector::transform(&camera.rotation, axis));
        self.0.map(|side| {
            let spread = axes.map(|axis| vector::dot(side, axis));
            vector::dot(side, place) + SEEN * vector::length(spread)
        })
    }

    /// How far a splat may reach at each side.
    fn fences(&self, camera: &Camera, scene: &Scene, middle: Vector) -> [f64; 4] {
        let every = scene.splats.len() / SAMPLES + 1;
        let samples: Vec<([f64; 4], f64)> = scene
            .splats
            .iter()
            .step_by(every)
            .map(|splat| (self.reach(camera, splat), splat.weight))
            .collect();
        let beyond = BEYOND * samples.iter().map(|sample| sample.1).sum::<f64>();
        let depth = camera.to_camera(middle)[2];
        let most = [0, 1, 2, 3].map(|side| {
            let mut along: Vec<(f64, f64)> = samples
                .iter()
                .map(|(reach, weight)| (reach[side], *weight))
                .collect();
            along.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
            let mut passed = 0.0;
            let inside = along.iter().find(|(_, weight)| {
                passed += weight;
                passed > beyond
            });
            inside.map_or(f64::INFINITY, |(reach, _)| *reach)
        });
        [0, 1, 2, 3].map(|side| {
            // The picture's extent where the middle lies.
            let across = most[side & 2] + most[side | 1] - 2.0 * self.0[side][2] * depth;
            most[side] + FENCE * across
        })
    }
}

/// The camera moved, and how many splats stay outside; the camera as it is where a scene has no extent.
pub(super) fn filled(camera: Camera, scene: &Scene, middle: Vector) -> (Camera, usize) {
    let half = [
        camera.width as f64 / (2.0 * camera.fx * MARGIN),
        camera.height as f64 / (2.0 * camera.fy * MARGIN),
    ];
    let sides = Sides([
        [1.0, 0.0, -half[0]],
        [-1.0, 0.0, -half[0]],
        [0.0, 1.0, -half[1]],
        [0.0, -1.0, -half[1]],
    ]);
    let fences = sides.fences(&camera, scene, middle);
    let mut farthest = [f64::NEG_INFINITY; 4];
    let (mut nearest, mut outside) = (f64::INFINITY, 0);
    for splat in &scene.splats {
        let reach = sides.reach(&camera, splat);
        if (0..4).any(|side| reach[side] > fences[side]) {
            outside += 1;
            continue;
        }
        farthest = [0, 1, 2, 3].map(|side| farthest[side].max(reach[side]));
        nearest = nearest.min(camera.to_camera(splat.centre)[2]);
    }
    let [right, left, down, up] = farthest;
    let depth = -((right + left) / (2.0 * half[0])).max((down + up) / (2.0 * half[1]));
    let eye = [(right - left) / 2.0, (down - up) / 2.0, depth];
    let free = nearest - depth;
    if !(vector::is_finite(eye) && free > 0.0) {
        return (camera, 0);
    }
    let moved = Camera {
        translation: vector::subtract(camera.translation, eye),
        near: camera.near.min(0.1 * free),
        ..camera
    };
    (moved, outside)
}
