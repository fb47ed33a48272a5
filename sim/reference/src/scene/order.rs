//! What splats are sorted by.
//!
//! Trainers sort by the depth along the view, which is one subtraction and a row of the rotation. Sorted by the
//! distance from the eye, a scene does not change its order when the camera turns where it stands; glTF's extension
//! lets a file say which of the two it was made for.

use crate::camera::Camera;
use crate::vector;
use serde::{Deserialize, Serialize};

/// What splats are sorted by, nearest first. Equal ones stay in the order of the scene.
///
/// Spheres, sheets and gathered points go by the depth whatever the scene says: they need differences of depths, not
/// only their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SortOrder {
    /// Depth along the view: z of camera space.
    #[default]
    Depth,
    /// Distance of the centre from the eye. A parallel projection has no eye: there it is the depth again.
    Distance,
}

impl SortOrder {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            SortOrder::Depth => "depth",
            SortOrder::Distance => "distance",
        }
    }

    /// The number that a splat with this centre is sorted by, scene units.
    pub fn place(self, camera: &Camera, centre: [f64; 3]) -> f64 {
        let position = camera.to_camera(centre);
        match self {
            SortOrder::Distance if !camera.orthographic => vector::length(position),
            _ => position[2],
        }
    }
}
