//! How a scene is cut into sheets (\[EWA\] 4.1, \[SWAN\] 3), in scene units: what both engines are told.

use crate::camera::Camera;
use crate::scene::Scene;
use crate::vector;
use serde::{Deserialize, Serialize};

/// Kinds of sheets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SheetKind {
    /// The slices of the volume most perpendicular to the view.
    AxisAligned,
    /// Slabs of depth; a splat belongs to the slab that holds its centre.
    ImageAligned,
    /// Slabs of depth; a splat's kernel is cut into the slabs that it reaches.
    ImageAlignedCut,
}

impl SheetKind {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            SheetKind::AxisAligned => "axis-aligned",
            SheetKind::ImageAligned => "image-aligned, whole kernels",
            SheetKind::ImageAlignedCut => "image-aligned, cut kernels",
        }
    }
}

/// A scene's sheets in one view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetPlan {
    /// Kind.
    pub kind: SheetKind,
    /// Thickness of a slab, scene units.
    pub thickness: f64,
    /// Where slab 0 begins: a depth, or a coordinate along the facing axis.
    pub first: f64,
    /// From the eye into the scene: the sheets' axis is its largest component.
    pub direction: [f64; 3],
}

impl SheetPlan {
    /// Sheets of `thickness`; depth slabs begin one slab and a half before the nearest centre.
    pub fn new(kind: SheetKind, thickness: f64, scene: &Scene, camera: &Camera) -> SheetPlan {
        let middle = scene.bounds().map_or([0.0; 3], |bounds| bounds.centre());
        let direction = if camera.orthographic {
            camera.forward()
        } else {
            vector::subtract(middle, camera.eye())
        };
        let depths = scene.splats.iter().map(|s| camera.to_camera(s.centre)[2]);
        let nearest = depths.fold(f64::INFINITY, f64::min).max(camera.near);
        let first = match kind {
            SheetKind::AxisAligned => 0.0,
            _ if nearest.is_finite() => (nearest - 1.5 * thickness).max(0.0),
            _ => 0.0,
        };
        SheetPlan {
            kind,
            thickness,
            first,
            direction,
        }
    }
}
