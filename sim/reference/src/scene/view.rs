//! Where a scene lies and a camera that shows it.

use super::{Scene, Weight, synthetic};
use crate::camera::Camera;
use crate::vector;

/// Part of the splats that may lie outside the robust bounds on each side: captures have stray splats far away.
const STRAY_PART: f64 = 0.02;
/// Distance of the default camera from the centre of a capture, in largest robust extents, and its field of view.
const CAPTURE_DISTANCE: f64 = 1.25;
const CAPTURE_DEGREES: f64 = 50.0;
/// The same for a volume.
const VOLUME_DISTANCE: f64 = 2.0;
const VOLUME_DEGREES: f64 = 30.0;

/// An axis-aligned box, scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least coordinates.
    pub least: [f64; 3],
    /// Greatest coordinates.
    pub greatest: [f64; 3],
}

impl Bounds {
    /// The box of some places when the `outermost` part on each side of each axis is left out; nothing of nothing.
    pub fn around(
        places: impl Iterator<Item = [f64; 3]> + Clone,
        outermost: f64,
    ) -> Option<Bounds> {
        let mut bounds = Bounds {
            least: [0.0; 3],
            greatest: [0.0; 3],
        };
        for axis in 0..3 {
            let mut along: Vec<f64> = places.clone().map(|place| place[axis]).collect();
            let last = along.len().checked_sub(1)?;
            let rank = (last as f64 * outermost) as usize;
            bounds.least[axis] = *along.select_nth_unstable_by(rank, f64::total_cmp).1;
            bounds.greatest[axis] = *along.select_nth_unstable_by(last - rank, f64::total_cmp).1;
        }
        Some(bounds)
    }

    /// The middle of the box; halved first, so that the sum does not overflow.
    pub fn centre(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.least[axis] / 2.0 + self.greatest[axis] / 2.0)
    }

    /// Side lengths.
    pub fn extents(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.greatest[axis] - self.least[axis])
    }
}

impl Scene {
    /// The box of all splats' centres; none for a scene without splats.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::around(self.splats.iter().map(|splat| splat.centre), 0.0)
    }

    /// Is it a capture? Its view fills the picture; made scenes keep theirs from version to version.
    pub fn is_capture(&self) -> bool {
        self.weight == Weight::Opacity && !synthetic::is_synthetic(&self.name)
    }

    /// The view that figures in `docs` are taken from, close enough that outer parts may be cut off; the command line
    /// frames by [`crate::framing::FramingInput`], which looks the same way and shows all.
    ///
    /// Volumes are seen along +z from twice the largest extent with 30 degrees. Captures are seen across their
    /// thinner horizontal side, without stray splats counting. Synthetic scenes have [`synthetic::camera`].
    pub fn default_camera(&self, width: usize, height: usize) -> Camera {
        if synthetic::is_synthetic(&self.name) {
            return synthetic::camera(width, height);
        }
        let centres = self.splats.iter().map(|splat| splat.centre);
        let (stray, distance, degrees) = match self.weight {
            Weight::Mass => (0.0, VOLUME_DISTANCE, VOLUME_DEGREES),
            Weight::Opacity => (STRAY_PART, CAPTURE_DISTANCE, CAPTURE_DEGREES),
        };
        // A scene without splats is shown as a unit cube at the origin would be.
        let (centre, extents) = Bounds::around(centres, stray)
            .map_or(([0.0; 3], [1.0; 3]), |bounds| {
                (bounds.centre(), bounds.extents())
            });
        let distance = distance * largest(extents);
        let mut eye = centre;
        match self.weight {
            Weight::Mass => eye[2] -= distance,
            Weight::Opacity => eye[across(self.up, |axis| extents[axis])] += distance,
        }
        look_at(eye, centre, self.up, degrees, width, height)
    }
}

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
        translation: vector::scale(-1.0, vector::transform(&rotation, eye)),
        // The usual near plane, but always well before the target of a tiny scene, which would vanish behind it.
        near: f64::min(0.01, vector::length(vector::subtract(target, eye)) / 100.0),
        far: f64::INFINITY,
        ..Camera::centred(width, height, focal)
    }
}

/// The axis with the smallest extent among those that are not up.
pub(crate) fn across(up: [f64; 3], extent: impl Fn(usize) -> f64) -> usize {
    let vertical = (0..3).max_by(|&a, &b| up[a].abs().total_cmp(&up[b].abs()));
    let horizontal = (0..3).filter(|&axis| Some(axis) != vertical);
    let smallest = horizontal.min_by(|&a, &b| extent(a).total_cmp(&extent(b)));
    smallest.unwrap_or(0)
}

/// The largest extent, 1 for a single point.
fn largest(extents: [f64; 3]) -> f64 {
    let largest = extents.into_iter().fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

#[cfg(test)]
#[path = "view_tests.rs"]
pub(crate) mod tests;
