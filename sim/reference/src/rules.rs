//! The named rules of blending, in double precision.
//!
//! A rule set says what a splat's peak means, which low-pass filter widens its footprint, where the footprint
//! ends and when a pixel is finished. The kernel holds its own fixed-point statement of the same rules; this
//! one is written from the papers' formulas and shares nothing with it.

use crate::metrics::finite_or_null;
use serde::{Deserialize, Deserializer, Serialize, de};
use std::str::FromStr;

/// One of the names that there are. An alias, since serde would borrow the text of what is called a reference.
pub type RulesName = &'static str;

/// How splats are weighted, cut off and composited.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rules {
    /// Name on the command line; `surf` for what reports say of surfaces.
    #[serde(deserialize_with = "known_name")]
    pub name: RulesName,
    /// Kernels are normalised to unit volume (EWA eq. 26-31): the peak opacity is
    /// `mass |J W| / (2 pi sqrt(det(V' + V^h)))`. Otherwise the peak is the opacity itself.
    pub normalised: bool,
    /// Variance of the isotropic low-pass filter, in square pixels.
    pub low_pass: f64,
    /// The peak is multiplied by sqrt(det V' / det(V' + V^h)), so that the filter adds no opacity (Mip-Splatting, eq.
    /// 9; gsplat's antialiased mode). Not for normalised kernels, which keep their volume.
    #[serde(default)]
    pub compensated: bool,
    /// Distance scaling (\[SWAN\] 4.3): spacing of the samples in scene units; 0 switches it off.
    pub spacing: f64,
    /// Shape of all footprints.
    pub kernel: Kernel,
    /// The footprint ends where the radial index reaches this value (`r < cutoff`); infinite, null in JSON, if only
    /// `alpha_min` ends it.
    #[serde(deserialize_with = "finite_or_null::deserialize")]
    pub cutoff: f64,
    /// Opacity of one splat at one pixel is clamped to this.
    pub alpha_max: f64,
    /// Smaller opacities are skipped.
    pub alpha_min: f64,
    /// A pixel is finished when its transmittance falls to this.
    pub minimum_transmittance: f64,
    /// The splat that would bring the transmittance to `minimum_transmittance` is itself left out.
    pub omit_finishing: bool,
    /// `x/z` and `y/z` are clamped in the Jacobian to the widened frustum.
    pub clamp_jacobian: bool,
}

fn known_name<'de, D: Deserializer<'de>>(from: D) -> Result<&'static str, D::Error> {
    match String::deserialize(from)?.as_str() {
        "surf" => Ok("surf"),
        name => name
            .parse()
            .map(|rules: Rules| rules.name)
            .map_err(de::Error::custom),
    }
}

impl Rules {
    /// EWA volume splatting: normalised kernels, identity low-pass, cut-off 4.
    pub const EWA: Rules = Rules {
        name: "ewa",
        normalised: true,
        low_pass: 1.0,
        compensated: false,
        spacing: 0.0,
        kernel: Kernel::Gaussian,
        cutoff: 4.0,
        alpha_max: 1.0,
        alpha_min: 0.0,
        minimum_transmittance: 1e-4,
        omit_finishing: false,
        clamp_jacobian: false,
    };

    /// 3D Gaussian splatting as gsplat releases it: peak opacity, low-pass 0.3, opacity clamped and skipped, stop
    /// before adding.
    pub const GAUSSIAN_3D: Rules = Rules {
        name: "3dgs",
        normalised: false,
        low_pass: 0.3,
        compensated: false,
        spacing: 0.0,
        kernel: Kernel::Gaussian,
        cutoff: f64::INFINITY,
        alpha_max: 0.999,
        alpha_min: 1.0 / 255.0,
        minimum_transmittance: 1e-4,
        omit_finishing: true,
        clamp_jacobian: true,
    };

    /// The same as the first trainer (Kerbl et al.) draws it: opacities of at most 0.99.
    pub const INRIA: Rules = Rules {
        name: "inria",
        alpha_max: 0.99,
        ..Rules::GAUSSIAN_3D
    };

    /// The named rules.
    pub const ALL: [Rules; 3] = [Rules::EWA, Rules::GAUSSIAN_3D, Rules::INRIA];
}

/// Shape of a footprint over the radial index, of unit variance per axis and peak 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kernel {
    /// exp(-r/2), up to the rules' cut-off.
    #[default]
    Gaussian,
    /// Line integral of the cubic spline of Crawfis and Max.
    Cubic,
    /// Quadratic (Epanechnikov): 1 - r/6.
    Quadratic,
    /// Constant up to r = 4.
    Disc,
}

/// How a picture is protected against samples closer together than pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Antialias {
    /// Not at all.
    None,
    /// Low-pass filter of this variance in square pixels (\[EWA\] 5.2).
    Ewa(f64),
    /// The low-pass filter of this variance, and opacities compensated for it: as antialiased models are trained.
    Mip(f64),
    /// Distance scaling for samples this far apart in scene units (\[SWAN\] 4.3).
    Swan(f64),
}

impl Rules {
    /// The same rules with footprints of another shape, up to its end.
    pub fn with_kernel(self, kernel: Kernel) -> Rules {
        let cutoff = kernel.end().unwrap_or(self.cutoff);
        Rules {
            kernel,
            cutoff,
            ..self
        }
    }

    /// The same rules with another protection against aliasing.
    pub fn with_antialias(self, antialias: Antialias) -> Rules {
        let (low_pass, spacing) = match antialias {
            Antialias::None => (0.0, 0.0),
            Antialias::Ewa(variance) | Antialias::Mip(variance) => (variance, 0.0),
            Antialias::Swan(spacing) => (0.0, spacing),
        };
        Rules {
            low_pass,
            compensated: matches!(antialias, Antialias::Mip(_)),
            spacing,
            ..self
        }
    }
}

impl Compositing {
    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Compositing::FrontToBack => "front-to-back",
            Compositing::BackToFront => "back-to-front",
            Compositing::XRay => "x-ray",
        }
    }
}

impl FromStr for Rules {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let named = Rules::ALL.into_iter().find(|rules| rules.name == name);
        named.ok_or_else(|| {
            format!(
                "unknown rules '{name}': expected one of {}",
                Rules::ALL.map(|rules| rules.name).join(", ")
            )
        })
    }
}

/// In which order and by which operator a pixel gathers its splats (EWA 4.1, SWAN 3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Compositing {
    /// Nearest splat first, "over", finished pixels skip the rest.
    #[default]
    FrontToBack,
    /// Farthest splat first, "over"; no pixel ever finishes, so `minimum_transmittance` is not used.
    BackToFront,
    /// Plain summation of opacity and of opacity times colour, clamped to 1 on output.
    XRay,
}
