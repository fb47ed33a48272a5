//! Scene, camera and rules as report.json states them.

use crate::camera::Camera;
use crate::rules::Rules;
use crate::scene::{Scene, SortOrder};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Counts by reason, in alphabetical order so that reports can be compared line by line.
pub type ReasonCounts = BTreeMap<String, u64>;

/// What was drawn and what was left out.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneFacts {
    /// File name without folders.
    pub name: String,
    /// Splats in the scene.
    pub splats: u64,
    /// Records that the loader left out, by reason.
    pub skipped: ReasonCounts,
    /// Splats that this camera does not show, by reason.
    pub culled: ReasonCounts,
    /// Splats of which a coordinate or colour is not finite and counts as 0; they are drawn.
    pub clamped: u64,
    /// Unit of the kernel's colours as a power of two: colours beyond its format were divided by it, and the picture was multiplied by it.
    #[serde(default)]
    pub colour_log2: i32,
    /// What its splats were sorted by; not written if it is the usual, the depth.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub order: SortOrder,
}

fn is_usual(order: &SortOrder) -> bool {
    *order == SortOrder::default()
}

impl SceneFacts {
    /// The scene's own facts and the engine's counts.
    pub fn new(scene: &Scene, culled: ReasonCounts, clamped: u64, colour_log2: i32) -> Self {
        let skipped = serde_json::to_value(scene.skipped)
            .and_then(serde_json::from_value)
            .unwrap_or_default();
        SceneFacts {
            name: scene.name.clone(),
            splats: scene.splats.len() as u64,
            skipped,
            culled,
            clamped,
            colour_log2,
            order: scene.order,
        }
    }
}

/// Reasons for culling that are a matter of the kernel's ranges and not of the view.
const BEYOND_RANGE: [(&str, &str); 2] = [
    (
        "out_of_range",
        "culled because they lie or reach too far off the screen",
    ),
    (
        "degenerate",
        "culled because their footprint has no area in the kernel's formats",
    ),
];

impl SceneFacts {
    /// What was not drawn as it was given, in one line after those that are known already: what was clamped, rescaled, and culled
    /// for range.
    /// Splats that the view simply does not show are no matter for a warning.
    pub fn warnings(&self, known: &[String]) -> Vec<String> {
        let clamped = (
            self.clamped,
            "have a number that is not finite and count as 0 there",
        );
        let culled = BEYOND_RANGE.map(|(reason, words)| {
            let count = self.culled.get(reason).copied().unwrap_or(0);
            (count, words)
        });
        let parts: Vec<String> = std::iter::once(clamped)
            .chain(culled)
            .filter(|(count, _)| *count > 0)
            .map(|(count, words)| format!("{count} {words}"))
            .collect();
        let mut lines = known.to_vec();
        if self.colour_log2 != 0 {
            let (name, unit) = (&self.name, f64::from(self.colour_log2).exp2());
            lines.push(format!(
                "{name}: colours exceed the kernel's format; they were divided by {unit} and the picture multiplied by it"
            ));
        }
        if !parts.is_empty() {
            let (name, splats) = (&self.name, self.splats);
            lines.push(format!("{name}: of {splats} splats {}", parts.join(", ")));
        }
        lines
    }
}

/// The camera in the form of a camera file, so that a report's camera can be used again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraFacts {
    /// Columns of the picture.
    pub width: usize,
    /// Rows of the picture.
    pub height: usize,
    /// Horizontal focal length in pixels.
    pub fx: f64,
    /// Vertical focal length in pixels.
    pub fy: f64,
    /// Principal point, pixels.
    pub cx: f64,
    /// Principal point, pixels.
    pub cy: f64,
    /// Row-major.
    pub world_to_camera: [f64; 16],
    /// Nearest depth drawn.
    pub near: f64,
    /// Farthest depth drawn; null if there is no limit.
    pub far: Option<f64>,
    /// Parallel projection.
    pub orthographic: bool,
}

impl From<&Camera> for CameraFacts {
    fn from(camera: &Camera) -> Self {
        let mut world_to_camera = [0.0; 16];
        for row in 0..3 {
            world_to_camera[4 * row..4 * row + 3].copy_from_slice(&camera.rotation[row]);
            world_to_camera[4 * row + 3] = camera.translation[row];
        }
        world_to_camera[15] = 1.0;
        CameraFacts {
            width: camera.width,
            height: camera.height,
            fx: camera.fx,
            fy: camera.fy,
            cx: camera.cx,
            cy: camera.cy,
            world_to_camera,
            near: camera.near,
            far: camera.far.is_finite().then_some(camera.far),
            orthographic: camera.orthographic,
        }
    }
}

/// The rules of blending, in full.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RulesFacts {
    /// `ewa` or `3dgs`.
    pub name: String,
    /// Kernels have unit volume.
    pub normalised: bool,
    /// Variance of the low-pass filter, square pixels.
    pub low_pass: f64,
    /// Peaks are multiplied by sqrt(det V' / det(V' + V^h)).
    #[serde(default)]
    pub compensated: bool,
    /// Spacing of the samples that distance scaling goes by, scene units; 0 without it.
    pub spacing: f64,
    /// Shape of footprints.
    pub kernel: String,
    /// Radial index where the footprint ends; null if only `alpha_min` ends it.
    pub cutoff: Option<f64>,
    /// Largest opacity of one splat at one pixel.
    pub alpha_max: f64,
    /// Smaller opacities are skipped.
    pub alpha_min: f64,
    /// Transmittance at which a pixel is finished.
    pub minimum_transmittance: f64,
    /// The splat that would finish the pixel is itself left out.
    pub omit_finishing: bool,
    /// The Jacobian's slopes are clamped to the widened frustum.
    pub clamp_jacobian: bool,
}

impl From<&Rules> for RulesFacts {
    fn from(rules: &Rules) -> Self {
        RulesFacts {
            name: rules.name.to_owned(),
            normalised: rules.normalised,
            low_pass: rules.low_pass,
            compensated: rules.compensated,
            spacing: rules.spacing,
            kernel: format!("{:?}", rules.kernel).to_lowercase(),
            cutoff: rules.cutoff.is_finite().then_some(rules.cutoff),
            alpha_max: rules.alpha_max,
            alpha_min: rules.alpha_min,
            minimum_transmittance: rules.minimum_transmittance,
            omit_finishing: rules.omit_finishing,
            clamp_jacobian: rules.clamp_jacobian,
        }
    }
}
