//! A camera that looks at a point, for scenes that come without one.

use crate::camera::Camera;
use crate::vector;

/// A pinhole camera at `eye` looking at `target`; rows of the rotation are right, down, forward.
///
/// The default cameras never look along `up` and never stand at their target, so this cannot fail.
pub(super) fn look_at(
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    vertical_degrees: f64,
    width: usize,
    height: usize,
) -> Camera {
    let unit = |v| vector::unit(v).unwrap_or([f64::NAN; 3]);
    let forward = unit(vector::subtract(target, eye));
    let right = unit(vector::cross(forward, up));
    let down = vector::cross(forward, right);
    let rotation = [right, down, forward];
    let focal = height as f64 / 2.0 / (vertical_degrees.to_radians() / 2.0).tan();
    Camera {
        rotation,
        translation: rotation.map(|row| -(row[0] * eye[0] + row[1] * eye[1] + row[2] * eye[2])),
        // The usual near plane, but always well before the target of a tiny scene, which would vanish behind it.
        near: f64::min(0.01, vector::length(vector::subtract(target, eye)) / 100.0),
        far: f64::INFINITY,
        ..Camera::centred(width, height, focal)
    }
}
