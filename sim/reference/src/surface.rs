//! How a picture of surfaces is made: what both engines need to know besides scene and camera.

use crate::vector::Vector;
use serde::{Deserialize, Serialize};

/// tau of SURF 7.
pub const USUAL_EDGE: f64 = 0.4;

/// Numbers of layers that the fixed engine is compiled for.
pub const LAYERS: [usize; 5] = [1, 2, 3, 4, 8];

/// What a pixel keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Buffer {
    /// One surface: accumulate, replace or discard by depth (SURF 4).
    Accumulation,
    /// At most so many surfaces: the layered A-buffer (SURF 6).
    Layers(usize),
}

/// The choices of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Style {
    /// What a pixel keeps.
    pub buffer: Buffer,
    /// Depth differences up to this belong to one surface, scene units.
    pub threshold: f64,
    /// Variance of the low-pass filter, square pixels.
    pub low_pass: f64,
    /// A footprint ends at this radial index; 2 is SURF's 1 on r/2.
    pub cutoff: f64,
    /// Weight sum at which a pixel counts as covered; none switches edge antialiasing off.
    pub edge: Option<f64>,
    /// Direction towards the light in the scene's axes; none shows colours as they are.
    pub light: Option<Vector>,
    /// Leave out points whose normal points away from the eye, instead of turning it.
    pub cull_backfaces: bool,
}

impl Style {
    /// Opaque surfaces as SURF draws them, unlit, without edge antialiasing.
    pub fn opaque(threshold: f64) -> Style {
        Style {
            buffer: Buffer::Accumulation,
            threshold,
            low_pass: 1.0,
            cutoff: 2.0,
            edge: None,
            light: None,
            cull_backfaces: false,
        }
    }

    /// At most `count` layers and antialiased edges.
    pub fn layered(threshold: f64, count: usize) -> Style {
        Style {
            buffer: Buffer::Layers(count),
            edge: Some(USUAL_EDGE),
            ..Style::opaque(threshold)
        }
    }
}
