//! A scan as round splats: enough of a scene to count pixels and cycles of the volume splats' datapath with.
//!
//! Each point becomes an opaque sphere, drawn with the cut-off and the low-pass filter of the rules `ewa`. Normals and
//! tangent planes do not matter to how many pixels a footprint of two pixels' radius has.

use super::SurfaceScene;
use crate::rules::Rules;
use crate::scene::{Scene, Splat};

/// Half the spacing of the scanned lion, scene units: the spheres of neighbouring points meet.
pub const LION_DEVIATION: f64 = 0.0035;

/// The cut-off and low-pass filter of `ewa`, with the points' own opacity.
pub const RULES: Rules = Rules {
    normalised: false,
    ..Rules::EWA
};

/// The cloud's points as spheres of this standard deviation, scene units.
pub fn as_spheres(cloud: &SurfaceScene, deviation: f64) -> Scene {
    let points = cloud.points.iter();
    let splats = points.map(|point| Splat::sphere(point.centre, deviation, point.colour));
    Scene {
        up: cloud.up,
        ..Scene::of_splats(&cloud.name, RULES, splats.collect())
    }
}
