//! The warping equation between two cameras, written out (McMillan 1997; \[HYBRID\] 3): where a pixel of a depth image is seen by another
//! camera. The counterpart of [`crate::texture::warp`], which goes through space and the ordinary projection.

use crate::camera::Camera;
use crate::vector::{Vector, dot};

/// Screen position and depth in `to` of the place that `from` sees at `place` and `depth`.
///
/// With R = W' W^T the relative rotation and c = d' - R d the relative translation: t' = R t + c.
pub fn reproject(from: &Camera, place: [f64; 2], depth: f64, to: &Camera) -> ([f64; 2], f64) {
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
