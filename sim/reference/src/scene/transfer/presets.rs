//! Built-in transfer functions of the classic volumes, chosen by file name, and a ramp for all others.
//!
//! Extinctions are moderate: the peak opacity of one splat is `extinction * volume / (2 pi sigma^2 area)`, about a
//! quarter of the extinction per voxel, so even the densest material lets some ten voxels contribute.

use super::{GradientPoint, Shading, Transfer, ValuePoint};

/// Below this part of the data's range the generic ramp shows nothing: background and noise live there.
const RAMP_START: f64 = 0.25;
/// Largest extinction of the generic ramp, per voxel.
const RAMP_PEAK: f64 = 0.15;

impl Transfer {
    /// The preset for a file name without folders and extension, if there is one.
    pub fn preset(stem: &str) -> Option<Transfer> {
        match stem {
            "brainsmall" => Some(brainsmall()),
            "aneurism" => Some(aneurism()),
            "fuel" => Some(fuel()),
            "nucleon" => Some(nucleon()),
            "headsq" => Some(headsq()),
            _ => None,
        }
    }

    /// A ramp from blue over white to orange and from transparent to moderately dense, over the data's range.
    pub fn ramp(least: f64, greatest: f64, spacing: f64) -> Transfer {
        let range = (greatest - least).max(f64::MIN_POSITIVE);
        let at = |part: f64| least + part * range;
        let point = |part: f64, colour: [f64; 3], density: f64| {
            value(at(part), colour, RAMP_PEAK * density / spacing)
        };
        let first = point(RAMP_START, [0.25, 0.40, 0.85], 0.0);
        let values = vec![
            first,
            point(0.6, [0.95, 0.93, 0.88], 0.3),
            point(1.0, [1.0, 0.55, 0.20], 1.0),
        ];
        Transfer {
            values,
            gradients: Vec::new(),
            shading: Shading::default(),
        }
    }
}

fn value(at: f64, colour: [f64; 3], extinction: f64) -> ValuePoint {
    ValuePoint {
        at,
        colour,
        extinction,
    }
}

fn gradient(at: f64, multiplier: f64) -> GradientPoint {
    GradientPoint { at, multiplier }
}

/// MR head: a veil of skin and skull, the brain within it clearly visible.
fn brainsmall() -> Transfer {
    Transfer {
        values: vec![
            value(10.0, [0.80, 0.45, 0.35], 0.0),
            value(26.0, [0.90, 0.52, 0.40], 0.018),
            value(46.0, [0.95, 0.62, 0.52], 0.020),
            value(60.0, [0.98, 0.74, 0.64], 0.12),
            value(85.0, [1.00, 0.88, 0.78], 0.26),
            value(110.0, [1.00, 0.95, 0.85], 0.08),
            value(200.0, [1.00, 0.98, 0.92], 0.05),
        ],
        gradients: Vec::new(),
        shading: Shading {
            surface: 8.0,
            ..Shading::default()
        },
    }
}

/// Contrast-filled arteries: nothing else is shown.
fn aneurism() -> Transfer {
    Transfer {
        values: vec![
            value(60.0, [0.75, 0.15, 0.10], 0.0),
            value(120.0, [0.90, 0.30, 0.18], 0.12),
            value(255.0, [1.00, 0.75, 0.55], 0.25),
        ],
        gradients: Vec::new(),
        shading: Shading {
            surface: 30.0,
            ..Shading::default()
        },
    }
}

/// Injected fuel: a thin blue cloud around a hot core.
fn fuel() -> Transfer {
    Transfer {
        values: vec![
            value(4.0, [0.20, 0.35, 0.90], 0.0),
            value(30.0, [0.25, 0.55, 0.95], 0.04),
            value(90.0, [0.95, 0.85, 0.40], 0.08),
            value(180.0, [1.00, 0.50, 0.15], 0.20),
            value(255.0, [1.00, 0.25, 0.10], 0.30),
        ],
        gradients: Vec::new(),
        shading: Shading {
            surface: 10.0,
            ..Shading::default()
        },
    }
}

/// Nucleon: nested shells of probability.
fn nucleon() -> Transfer {
    Transfer {
        values: vec![
            value(40.0, [0.20, 0.40, 0.90], 0.0),
            value(60.0, [0.25, 0.55, 0.95], 0.05),
            value(90.0, [0.30, 0.80, 0.80], 0.02),
            value(140.0, [0.95, 0.85, 0.40], 0.06),
            value(200.0, [1.00, 0.45, 0.15], 0.25),
            value(250.0, [1.00, 0.25, 0.10], 0.30),
        ],
        gradients: Vec::new(),
        shading: Shading {
            surface: 8.0,
            ..Shading::default()
        },
    }
}

/// CT head (air 0, soft tissue near 1,100, bone above 1,400; spacing 3.2 mm): a veil of skin over the skull.
fn headsq() -> Transfer {
    Transfer {
        values: vec![
            value(400.0, [0.95, 0.50, 0.35], 0.0),
            value(800.0, [0.95, 0.55, 0.40], 0.006),
            value(1200.0, [0.95, 0.55, 0.40], 0.004),
            value(1350.0, [1.00, 0.90, 0.80], 0.015),
            value(1900.0, [1.00, 0.97, 0.90], 0.10),
            value(3900.0, [1.00, 1.00, 0.97], 0.12),
        ],
        gradients: vec![
            gradient(20.0, 0.0),
            gradient(80.0, 0.5),
            gradient(160.0, 1.0),
        ],
        shading: Shading {
            surface: 60.0,
            ..Shading::default()
        },
    }
}
