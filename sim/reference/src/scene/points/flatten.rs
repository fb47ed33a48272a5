//! Points of a surface as volume kernels that are thin along the normal (\[EWA\] 6.4), whose limit is the surface
//! kernel.
//!
//! A sheet's integral along a ray grows with its obliquity and a surface's weight does not. Masses are therefore
//! w 2 pi r^2 cos(normal, ray), which makes a kernel as high from every side, and depend on the camera.

use super::{SurfacePoint, SurfaceScene};
use crate::camera::Camera;
use crate::rules::Rules;
use crate::scene::{Scene, Splat};
use crate::vector;

/// Where surface kernels end: SURF's 1 on r/2.
const CUTOFF: f64 = 2.0;

/// Volume kernels of the points, their axis along the normal divided by `factor`.
pub fn flattened(points: &SurfaceScene, camera: &Camera, factor: f64) -> Scene {
    let splat = |point: &SurfacePoint| {
        let radius = vector::length(point.frame[0]);
        let ray = camera.ray(camera.to_camera(point.centre));
        let normal = vector::transform(&camera.rotation, point.normal);
        let cosine = vector::dot(normal, ray).abs() / vector::length(ray);
        Splat {
            centre: point.centre,
            axes: [
                point.frame[0],
                point.frame[1],
                vector::scale(radius / factor, point.normal),
            ],
            weight: point.weight * std::f64::consts::TAU * radius * radius * cosine,
            colour: point.colour,
        }
    };
    let splats = points.points.iter().map(splat).collect();
    Scene {
        up: points.up,
        ..Scene::of_splats(&points.name, rules(), splats)
    }
}

/// EWA with the cut-off of surface kernels.
pub fn rules() -> Rules {
    Rules {
        cutoff: CUTOFF,
        ..Rules::EWA
    }
}
