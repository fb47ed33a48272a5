//! How samples become points or splats (\[HYBRID\] 2 and 4), said once for both engines.

use crate::metrics::median;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// Which samples are drawn as points, by the picture's one circular footprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Points {
    /// Those closer together than pixels (beyond the distance k).
    #[default]
    Auto,
    /// All; magnified samples then leave holes.
    All,
    /// None: all are splats.
    None,
}

/// How points are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Hybrid {
    /// Which samples are points.
    pub points: Points,
    /// Points within this depth range (scene units) are summed before they are composited; none: each is composited.
    pub depth_range: Option<f64>,
    /// Points are stamped at `2^bits` phases per pixel and axis; none: by the traversal `spans`.
    pub phase_bits: Option<u8>,
}

/// Standard deviation of a volume's kernels, in voxels, by which a spacing follows from a deviation.
pub(crate) const DEVIATION_PER_SPACING: f64 = 0.82;

/// The standard deviation of a scene's kernels taken as spheres: the median over the splats of their volume's cube
/// root.
///
/// 0 for a scene without splats.
pub fn deviation(scene: &Scene) -> f64 {
    let mut deviations: Vec<f64> = scene
        .splats
        .iter()
        .map(|splat| {
            let [a, b, c] = splat.axes.map(crate::vector::length);
            (a * b * c).cbrt()
        })
        .collect();
    median(&mut deviations).unwrap_or(0.0)
}

/// The distance between samples that belongs to the kernels' deviation: a volume's voxel spacing.
pub fn spacing(scene: &Scene) -> f64 {
    deviation(scene) / DEVIATION_PER_SPACING
}
