//! Built-in transfer functions of the classic volumes, chosen by file name, and a ramp for all others. The former are
//! files like those that `--transfer` reads, to begin with for functions of one's own.
//!
//! Extinctions are moderate: the peak opacity of one splat is `extinction * volume / (2 pi sigma^2 area)`, about a
//! quarter of the extinction per voxel, so even the densest material lets some ten voxels contribute.

use super::{Shading, Transfer, ValuePoint};

/// Below this part of the data's range the generic ramp shows nothing: background and noise live there.
const RAMP_START: f64 = 0.25;
/// Largest extinction of the generic ramp, per voxel.
const RAMP_PEAK: f64 = 0.15;

impl Transfer {
    /// The preset for a file name without folders and extension, if there is one.
    pub fn preset(stem: &str) -> Option<Transfer> {
        let text = match stem {
            "brainsmall" => include_str!("presets/brainsmall.toml"),
            "aneurism" => include_str!("presets/aneurism.toml"),
            "fuel" => include_str!("presets/fuel.toml"),
            "nucleon" => include_str!("presets/nucleon.toml"),
            "headsq" => include_str!("presets/headsq.toml"),
            _ => return None,
        };
        Some(Transfer::from_toml(text).expect("a test reads all presets"))
    }

    /// A ramp from blue over white to orange and from transparent to moderately dense, over the data's range.
    pub fn ramp(least: f64, greatest: f64, spacing: f64) -> Transfer {
        let range = (greatest - least).max(f64::MIN_POSITIVE);
        let point = |part: f64, colour: [f64; 3], density: f64| ValuePoint {
            at: least + part * range,
            colour,
            extinction: RAMP_PEAK * density / spacing,
        };
        Transfer {
            values: vec![
                point(RAMP_START, [0.25, 0.40, 0.85], 0.0),
                point(0.6, [0.95, 0.93, 0.88], 0.3),
                point(1.0, [1.0, 0.55, 0.20], 1.0),
            ],
            gradients: Vec::new(),
            shading: Shading::default(),
        }
    }
}
