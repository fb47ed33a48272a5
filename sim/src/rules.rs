//! The named rules of blending, in double precision.
//!
//! A rule set says what a splat's peak means, which low-pass filter widens its footprint, where the footprint
//! ends and when a pixel is finished. The kernel holds its own fixed-point statement of the same rules; this
//! one is written from the papers' formulas and shares nothing with it.

use std::str::FromStr;

/// How splats are weighted, cut off and composited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Name on the command line.
    pub name: &'static str,
    /// Kernels are normalised to unit volume (EWA eq. 26-31): the peak opacity is
    /// `mass |J W| / (2 pi sqrt(det(V' + V^h)))`. Otherwise the peak is the opacity itself.
    pub normalised: bool,
    /// Variance of the isotropic low-pass filter, in square pixels.
    pub low_pass: f64,
    /// The footprint ends where the radial index reaches this value (`r < cutoff`); infinite if only `alpha_min` ends it.
    pub cutoff: f64,
    /// Opacity of one splat at one pixel is clamped to this.
    pub alpha_max: f64,
    /// Smaller opacities are skipped.
    pub alpha_min: f64,
    /// A pixel is finished when its transmittance falls to this.
    pub stop: f64,
    /// The splat that would bring the transmittance to `stop` is itself left out.
    pub stop_before: bool,
    /// `x/z` and `y/z` are clamped in the Jacobian to the widened frustum.
    pub clamp_jacobian: bool,
}

impl Rules {
    /// EWA volume splatting: normalised kernels, identity low-pass, cut-off 4.
    pub const EWA: Rules = Rules {
        name: "ewa",
        normalised: true,
        low_pass: 1.0,
        cutoff: 4.0,
        alpha_max: 1.0,
        alpha_min: 0.0,
        stop: 1e-4,
        stop_before: false,
        clamp_jacobian: false,
    };

    /// 3D Gaussian splatting: peak opacity, low-pass 0.3, opacity clamped and skipped, stop before adding.
    pub const GAUSSIAN_3D: Rules = Rules {
        name: "3dgs",
        normalised: false,
        low_pass: 0.3,
        cutoff: f64::INFINITY,
        alpha_max: 0.999,
        alpha_min: 1.0 / 255.0,
        stop: 1e-4,
        stop_before: true,
        clamp_jacobian: true,
    };
}

impl FromStr for Rules {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "ewa" => Ok(Rules::EWA),
            "3dgs" => Ok(Rules::GAUSSIAN_3D),
            other => Err(format!("unknown rules '{other}': expected 'ewa' or '3dgs'")),
        }
    }
}

/// In which order and by which operator a pixel gathers its splats (EWA 4.1, SWAN 3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Compositing {
    /// Nearest splat first, "over", finished pixels skip the rest.
    #[default]
    FrontToBack,
    /// Farthest splat first, "over"; no pixel ever finishes, so `stop` is not used.
    BackToFront,
    /// Plain summation of opacity and of opacity times colour, clamped to 1 on output.
    XRay,
}
