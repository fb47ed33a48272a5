//! The named rules of blending, in fixed point: what a peak means, where a footprint ends, when a pixel is finished.

use crate::kernel::Kernel;
use crate::math::SoftFloat;

/// Where a footprint ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cutoff {
    /// At a constant radial index, r < c, UQ4.28 (\[EWA\] 7.1.2: c = 4).
    Radial(u32),
    /// Where the opacity falls below [`Rules::alpha_min`]: c = 2 ln(peak / alpha_min).
    Opacity,
}

/// How splats are weighted, cut off and composited. Constant for a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rules {
    /// Kernels of unit volume: the peak opacity is weight |J W| / (2 pi sqrt(det(V' + V^h))) (\[EWA\] eq. 26-31).
    /// Otherwise the weight is the peak opacity.
    pub normalised: bool,
    /// Variance of the low-pass filter V^h = h I in square pixels; 0 switches it off.
    pub low_pass: SoftFloat,
    /// The peak opacity is multiplied by sqrt(det V' / det(V' + V^h)), so that the low-pass filter adds no opacity:
    /// what Mip-Splatting and the antialiased mode of gsplat train with. Not for normalised kernels, which keep their
    /// volume by themselves.
    pub compensated: bool,
    /// Distance scaling (\[SWAN\] 4.3): spacing of the samples in scene units; 0 switches it off. Usually instead of a
    /// low-pass.
    pub spacing: SoftFloat,
    /// Shape of all footprints.
    pub kernel: Kernel,
    /// End of a footprint.
    pub cutoff: Cutoff,
    /// Opacity of one splat at one pixel is clamped to this, UQ1.31.
    pub alpha_max: u32,
    /// Smaller opacities are skipped, UQ1.60: fine enough to be compared with an opacity before it is rounded.
    pub alpha_min: u64,
    /// A pixel is finished when its transmittance is at most this, UQ1.60.
    pub minimum_transmittance: u64,
    /// The splat that would bring the transmittance to `minimum_transmittance` is itself left out.
    pub omit_finishing: bool,
    /// x/z and y/z are clamped in the Jacobian to [`RatioLimits`](crate::view::RatioLimits).
    pub clamp_jacobian: bool,
    /// Base-2 logarithm of the end of the footprint table: 2 for cut-offs up to 4, 4 for all others.
    pub table_range: u8,
}

/// Fraction bits of [`Rules::alpha_min`] and [`Rules::minimum_transmittance`].
pub const THRESHOLD: u32 = 60;

/// `numerator / denominator` with so many fraction bits, rounded to nearest.
const fn ratio(numerator: u64, denominator: u64, fraction: u32) -> u64 {
    let denominator = denominator as u128;
    ((((numerator as u128) << fraction) + denominator / 2) / denominator) as u64
}

impl Rules {
    /// EWA volume splatting: normalised kernels, identity low-pass, cut-off 4.
    pub const EWA: Rules = Rules {
        normalised: true,
        low_pass: SoftFloat {
            mantissa: 1 << 30,
            exponent: -30,
        },
        compensated: false,
        spacing: SoftFloat::ZERO,
        kernel: Kernel::Gaussian,
        cutoff: Cutoff::Radial(4 << 28),
        alpha_max: ratio(1, 1, 31) as u32,
        alpha_min: 0,
        minimum_transmittance: ratio(1, 10_000, THRESHOLD),
        omit_finishing: false,
        clamp_jacobian: false,
        table_range: 2,
    };

    /// Surface splatting: identity low-pass, cut-off 1 on r/2 (SURF 4). The weights of a pixel are divided by their
    /// sum, so nothing is clamped, skipped or finished.
    pub const SURFACE: Rules = Rules {
        normalised: false,
        cutoff: Cutoff::Radial(2 << 28),
        minimum_transmittance: 0,
        ..Rules::EWA
    };

    /// 3D Gaussian splatting: peak opacity, low-pass 0.3, opacity at least 1/255, stop before adding; at most 0.999, as
    /// gsplat has it (the authors' own rasterizer has 0.99).
    pub const GAUSSIAN_3D: Rules = Rules {
        normalised: false,
        low_pass: SoftFloat {
            mantissa: 1_288_490_189,
            exponent: -32,
        }, // 0.3
        compensated: false,
        spacing: SoftFloat::ZERO,
        kernel: Kernel::Gaussian,
        cutoff: Cutoff::Opacity,
        alpha_max: ratio(999, 1000, 31) as u32,
        alpha_min: ratio(1, 255, THRESHOLD),
        minimum_transmittance: ratio(1, 10_000, THRESHOLD),
        omit_finishing: true,
        clamp_jacobian: true,
        table_range: 4,
    };

    /// The largest radial index at which a footprint ends, UQ4.28.
    #[inline(always)]
    pub fn end(&self) -> u32 {
        match self.cutoff {
            Cutoff::Radial(cutoff) => cutoff.min(self.kernel.end()),
            Cutoff::Opacity => self.kernel.end(),
        }
    }

    /// The same rules with footprints of another shape, up to its end.
    pub const fn with_kernel(self, kernel: Kernel) -> Rules {
        match kernel {
            Kernel::Gaussian => Rules { kernel, ..self },
            _ => Rules {
                kernel,
                cutoff: Cutoff::Radial(kernel.end()),
                table_range: kernel.table_range(),
                ..self
            },
        }
    }
}

/// In which order and by which operator a pixel gathers its splats (\[EWA\] 4.1, \[SWAN\] 3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compositing {
    /// Nearest splat first, "over"; finished pixels skip the rest.
    FrontToBack,
    /// Farthest splat first, "over"; no pixel finishes.
    BackToFront,
    /// Plain summation of opacity and of opacity times colour.
    XRay,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_the_nearest() {
        for (numerator, denominator) in [
            (0, 7),
            (1, 255),
            (999, 1000),
            (1, 10_000),
            (1, 1),
            (2, 3),
            (5, 8),
        ] {
            for fraction in [1, 2, 31, THRESHOLD] {
                let twice = 2
                    * u128::from(ratio(numerator, denominator, fraction))
                    * u128::from(denominator);
                let exact = 2 * (u128::from(numerator) << fraction);
                assert!(
                    twice + u128::from(denominator) >= exact
                        && twice <= exact + u128::from(denominator)
                );
            }
        }
    }
}
