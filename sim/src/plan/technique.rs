//! How a scene becomes a picture, as data: what decides which of the papers' systems draw it.

use super::text;
use crate::camera::Camera;
use crate::hybrid::Hybrid;
use crate::reference::sphere::Shape;
use crate::rules::{Compositing, Rules};
use crate::scene::Scene;
use crate::sheets::{SheetKind, SheetPlan};
use crate::surface::Style;
use anyhow::{Result, anyhow};
use serde::{Deserialize, Serialize};
use splatline::blend::deep::{Channel, ChannelRounding, Representation, WIDTH_RANGE};

/// How a scene of its kind is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Technique {
    /// Volume splats.
    Splats(SplatTechnique),
    /// Points of a surface.
    Surface(Style),
}

/// How volume splats are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SplatTechnique {
    /// Rules of blending.
    #[serde(deserialize_with = "text::rules")]
    pub rules: Rules,
    /// Order and operator of blending.
    #[serde(default)]
    pub compositing: Compositing,
    /// How splats become pixels.
    #[serde(default)]
    pub method: SplatMethod,
}

/// How splats become pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SplatMethod {
    /// Affine footprints, composited one by one.
    #[default]
    Composited,
    /// Points and stamps for samples closer together than pixels, footprints for the others.
    Points(Hybrid),
    /// Footprints are added in sheet buffers, and the sheets composited.
    Sheets(SheetBuffers),
    /// Affine footprints, composited through an alpha channel of its own width.
    DeepAlpha(AlphaChannel),
    /// Projected spheres of the first axis' length.
    Spheres(Shape),
}

/// Sheet buffers of one thickness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SheetBuffers {
    /// How the scene is cut.
    pub kind: SheetKind,
    /// Thickness of a slab, scene units.
    pub thickness: f64,
}

/// What an alpha channel keeps in how many bits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AlphaChannel {
    /// What is kept.
    #[serde(with = "RepresentationName")]
    pub representation: Representation,
    /// Bits of a word.
    pub bits: u8,
    /// What becomes of the bits below a result.
    #[serde(with = "RoundingName")]
    pub rounding: ChannelRounding,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Representation", rename_all = "kebab-case")]
enum RepresentationName {
    Opacity,
    Transmittance,
    OpticalDepth,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "ChannelRounding", rename_all = "kebab-case")]
enum RoundingName {
    Nearest,
    Truncate,
    Dither,
}

impl SplatMethod {
    /// Does the footprints' traversal change the work? Points, stamps and spheres have one traversal only.
    pub fn has_traversals(&self) -> bool {
        !matches!(self, SplatMethod::Points(_) | SplatMethod::Spheres(_))
    }
}

impl SheetBuffers {
    /// The sheets of a scene in a view.
    pub fn plan(&self, scene: &Scene, camera: &Camera) -> SheetPlan {
        SheetPlan::new(self.kind, self.thickness, scene, camera)
    }
}

impl AlphaChannel {
    /// The same for the kernel.
    pub fn in_kernel(&self) -> Result<Channel> {
        let (least, most) = WIDTH_RANGE;
        Channel::new(self.representation, self.rounding, self.bits).map_err(|_| {
            anyhow!(
                "alpha channel of {} bits: allowed are {least} to {most}",
                self.bits
            )
        })
    }
}
