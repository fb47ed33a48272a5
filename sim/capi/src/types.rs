//! Plain structs with documented Q-formats, and their conversions to and from the kernel's types.

use crate::status::Error;
use fixed::types::{I2F30, I32F32, U4F28};
use splatline::blend::BlendConstants;
use splatline::footprint::{Conic, Footprint, Ldl};
use splatline::format::{Rounding, RuntimeWidths, Traversal, Widths};
use splatline::kernel::Kernel;
use splatline::math::{Extended, SoftFloat};
use splatline::raster::Window;
use splatline::rules::{Compositing, Cutoff, Rules};
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Eye, Projection, RatioLimits, View};

/// Every pixel of the bounding box by conic forward differencing.
pub const SPLATLINE_TRAVERSAL_BOX: u32 = 0;
/// Only each row's span, by LDL forward differencing.
pub const SPLATLINE_TRAVERSAL_SPANS: u32 = 1;

/// Nearest splat first, "over"; finished pixels skip the rest.
pub const SPLATLINE_FRONT_TO_BACK: u32 = 0;
/// Farthest splat first, "over".
pub const SPLATLINE_BACK_TO_FRONT: u32 = 1;
/// Plain summation.
pub const SPLATLINE_XRAY: u32 = 2;

/// Columns and rows of a viewport are at most this.
pub const SPLATLINE_LARGEST_VIEWPORT: u32 = 32768;

/// A design: how many bits every quantity has. Ranges in brackets.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplatlineWidths {
    /// Magnitude bits of a splat's difference to the eye and of the rotation by which it gets to camera space [8, 60].
    pub position: u8,
    /// Magnitude bits of mantissas from camera space to the centre [8, 31].
    pub view: u8,
    /// Magnitude bits of the mantissas of setup and row seeds [8, 31].
    pub mantissa: u8,
    /// Fraction bits of a footprint's centre, in pixels [2, 24].
    pub subpixel: u8,
    /// Fraction bits of the radial index [8, 44].
    pub radial: u8,
    /// Base-2 logarithm of the number of intervals of the footprint table [2, 14].
    pub table: u8,
    /// Bits of the interpolator's multiplier, 0 for no interpolation [0, 20].
    pub interpolation: u8,
    /// Fraction bits of a footprint table entry [4, 28].
    pub weight: u8,
    /// Fraction bits of a footprint's peak opacity [4, 28].
    pub peak: u8,
    /// Fraction bits of a splat's opacity at a pixel [4, 28].
    pub alpha: u8,
    /// Fraction bits of the pixel's transmittance [4, 30].
    pub transmittance: u8,
    /// Fraction bits of a splat's colour [4, 28].
    pub colour: u8,
    /// Fraction bits of the pixel's accumulated colour [4, 27].
    pub accumulator: u8,
    /// Rounding in the pixel path: 0 to nearest (halves up), 1 truncation, 2 to nearest (halves to even).
    pub rounding: u8,
}

/// `mantissa * 2^exponent`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatlineSoftFloat {
    /// Signed mantissa of at most 31 bits of magnitude.
    pub mantissa: i32,
    /// Power of two.
    pub exponent: i32,
}

/// `mantissa * 2^exponent` with more bits.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatlineExtended {
    /// Signed mantissa.
    pub mantissa: i64,
    /// Power of two.
    pub exponent: i32,
}

/// A vector in scene units: `mantissa[i] * 2^exponent`; the largest component should use 31 bits.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatlineAxis {
    /// Components.
    pub mantissa: [i32; 3],
    /// Power of two, -512 to 511 (others are clamped).
    pub exponent: i32,
}

/// A volume splat: a Gaussian whose variance is the sum of its axes' outer products.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplatlineSplat {
    /// Centre in scene units: a number of its own for each coordinate, such as a float's mantissa and exponent.
    pub centre: [SplatlineSoftFloat; 3],
    /// Three axes, each one standard deviation long.
    pub axes: [SplatlineAxis; 3],
    /// Peak opacity, or extinction times volume in square scene units under normalised rules. Negative counts as 0.
    pub weight: SplatlineSoftFloat,
    /// Linear red, green, blue, UQ4.28.
    pub colour: [u32; 3],
}

/// The camera. Camera space is x right, y down, z forward; pixel (i, j) is sampled at (i + 0.5, j + 0.5).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplatlineView {
    /// World-to-camera rotation, row-major, Q1.30.
    pub rotation: [i32; 9],
    /// What the rotation has beyond its 30 fraction bits, units of 2^-60, magnitude at most 2^29.
    pub rotation_rest: [i32; 9],
    /// The eye in the scene: `eye[i] * 2^eye_exponent`, scene units. Magnitudes above 2^60 lose their low bits.
    pub eye: [i64; 3],
    /// Power of two of the eye's coordinates.
    pub eye_exponent: i32,
    /// Focal lengths in pixels (orthographic: pixels per scene unit), positive.
    pub focal: [SplatlineSoftFloat; 2],
    /// Principal point in pixels, Q31.32.
    pub principal: [i64; 2],
    /// Splats with z <= near are culled; scene units.
    pub near_depth: SplatlineExtended,
    /// Splats with z >= far are culled; scene units.
    pub far_depth: SplatlineExtended,
    /// Smallest x/z and y/z in the Jacobian under rules that clamp them, Q31.32.
    pub ratio_low: [i64; 2],
    /// Largest x/z and y/z, Q31.32.
    pub ratio_high: [i64; 2],
    /// Columns and rows, at most SPLATLINE_LARGEST_VIEWPORT.
    pub viewport: [u16; 2],
    /// 0 perspective, 1 orthographic.
    pub orthographic: u32,
}

/// Rules of blending. `splatline_rules` gives the named ones.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplatlineRules {
    /// Variance of the low-pass filter in square pixels; mantissa 0 switches it off.
    pub low_pass: SplatlineSoftFloat,
    /// 1: kernels of unit volume; 0: the weight is the peak opacity.
    pub normalised: u32,
    /// 1: a footprint ends where its opacity falls below alpha_min; 0: at `cutoff`.
    pub cutoff_by_opacity: u32,
    /// Radial index at which a footprint ends, UQ4.28.
    pub cutoff: u32,
    /// Opacities are clamped to this, UQ1.31.
    pub alpha_max: u32,
    /// Smaller opacities are skipped, UQ1.60.
    pub alpha_min: u64,
    /// A pixel is finished when its transmittance is at most this, UQ1.60.
    pub minimum_transmittance: u64,
    /// 1: the splat that would bring the transmittance to `minimum_transmittance` is left out.
    pub omit_finishing: u32,
    /// 1: x/z and y/z are clamped in the Jacobian.
    pub clamp_jacobian: u32,
    /// Base-2 logarithm of the end of the footprint table: 2 for cut-offs up to 4, 4 for others.
    pub table_range: u32,
    /// 1: the peak opacity is multiplied by sqrt(det V' / det(V' + V^h)), as antialiased models of 3D Gaussians are
    /// trained.
    pub compensated: u32,
}

/// Rules brought to a design's widths: what a circuit compares with. `splatline_blend_constants` gives them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatlineBlendConstants {
    /// Splats are skipped where peak times kernel is less, before it is rounded: UQ4.(peak + weight).
    pub opacity_min: u64,
    /// Opacities are clamped to this, UQ1.alpha.
    pub alpha_max: u32,
    /// A pixel is finished when its transmittance is at most this, UQ1.transmittance.
    pub minimum_transmittance: u32,
    /// 1: the splat that would bring the transmittance to `minimum_transmittance` is left out.
    pub omit_finishing: u32,
}

/// A projected splat: what setup hands to the rasterizer.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatlineFootprint {
    /// Centre in pixels, Q27.subpixel.
    pub centre: [i64; 2],
    /// Sort key: depth in scene units as a number of 48 bits that grows with it.
    pub depth: u64,
    /// First column and row of the bounding box.
    pub first: [u16; 2],
    /// One past the last column and row.
    pub end: [u16; 2],
    /// A = Vyy / det, per square pixel.
    pub horizontal: SplatlineSoftFloat,
    /// 1 / A, square pixels.
    pub squared_width: SplatlineSoftFloat,
    /// S = Vxy / Vyy, pixels per row.
    pub shear: SplatlineSoftFloat,
    /// C = 1 / Vyy, per square pixel.
    pub vertical: SplatlineSoftFloat,
    /// Conic a, b, c, per square pixel: mantissas.
    pub conic_mantissa: [i32; 3],
    /// Conic: power of two of all three.
    pub conic_exponent: i32,
    /// The footprint is r < cutoff, UQ4.28.
    pub cutoff: u32,
    /// Opacity at the centre (r = 0), UQ4.peak.
    pub opacity: u32,
    /// Linear red, green, blue, UQ4.colour.
    pub colour: [u32; 3],
}

/// Columns and rows `first .. end`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatlineWindow {
    /// First column and row.
    pub first: [u16; 2],
    /// One past the last column and row.
    pub end: [u16; 2],
}

/// One pixel of a target.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplatlinePixel {
    /// Linear red, green, blue, premultiplied, UQ4.accumulator.
    pub colour: [u32; 3],
    /// Transmittance, UQ1.transmittance; bit 31 marks a pixel that takes no more splats.
    pub transmittance: u32,
}

impl From<SoftFloat> for SplatlineSoftFloat {
    fn from(value: SoftFloat) -> Self {
        SplatlineSoftFloat {
            mantissa: value.mantissa,
            exponent: value.exponent,
        }
    }
}

impl From<SplatlineSoftFloat> for SoftFloat {
    fn from(value: SplatlineSoftFloat) -> Self {
        SoftFloat {
            mantissa: value.mantissa,
            exponent: value.exponent,
        }
    }
}

impl From<&Widths> for SplatlineWidths {
    fn from(widths: &Widths) -> Self {
        SplatlineWidths {
            position: widths.position,
            view: widths.view,
            mantissa: widths.mantissa,
            subpixel: widths.subpixel,
            radial: widths.radial,
            table: widths.table,
            interpolation: widths.interpolation,
            weight: widths.weight,
            peak: widths.peak,
            alpha: widths.alpha,
            transmittance: widths.transmittance,
            colour: widths.colour,
            accumulator: widths.accumulator,
            rounding: match widths.rounding {
                Rounding::Nearest => 0,
                Rounding::Truncate => 1,
                Rounding::NearestEven => 2,
            },
        }
    }
}

impl SplatlineWidths {
    pub(crate) fn widths(&self) -> Result<Widths, Error> {
        let widths = Widths {
            position: self.position,
            view: self.view,
            mantissa: self.mantissa,
            subpixel: self.subpixel,
            radial: self.radial,
            table: self.table,
            interpolation: self.interpolation,
            weight: self.weight,
            peak: self.peak,
            alpha: self.alpha,
            transmittance: self.transmittance,
            colour: self.colour,
            accumulator: self.accumulator,
            rounding: match self.rounding {
                0 => Rounding::Nearest,
                1 => Rounding::Truncate,
                2 => Rounding::NearestEven,
                _ => return Err(Error::Value),
            },
        };
        widths.check().map_err(|_| Error::Widths)?;
        Ok(widths)
    }

    pub(crate) fn design(&self) -> Result<RuntimeWidths, Error> {
        RuntimeWidths::new(self.widths()?).map_err(|_| Error::Widths)
    }
}

impl From<&SplatlineSplat> for VolumeSplat {
    fn from(splat: &SplatlineSplat) -> Self {
        VolumeSplat {
            centre: splat.centre.map(SoftFloat::from),
            axes: splat.axes.map(|axis| Axis {
                mantissa: axis.mantissa,
                exponent: axis.exponent,
            }),
            weight: splat.weight.into(),
            colour: splat.colour.map(U4F28::from_bits),
        }
    }
}

impl From<&VolumeSplat> for SplatlineSplat {
    fn from(splat: &VolumeSplat) -> Self {
        SplatlineSplat {
            centre: splat.centre.map(SplatlineSoftFloat::from),
            axes: splat.axes.map(|axis| SplatlineAxis {
                mantissa: axis.mantissa,
                exponent: axis.exponent,
            }),
            weight: splat.weight.into(),
            colour: splat.colour.map(U4F28::to_bits),
        }
    }
}

impl From<&View> for SplatlineView {
    fn from(view: &View) -> Self {
        let [a, b, c] = view.rotation.map(|row| row.map(I2F30::to_bits));
        let [p, q, r] = view.pose.rotation_rest;
        let joined = |[[a, b, c], [d, e, f], [g, h, i]]: [[i32; 3]; 3]| [a, b, c, d, e, f, g, h, i];
        SplatlineView {
            rotation: joined([a, b, c]),
            rotation_rest: joined([p, q, r]),
            eye: view.pose.position,
            eye_exponent: view.pose.exponent,
            focal: view.focal.map(SplatlineSoftFloat::from),
            principal: view.principal.map(I32F32::to_bits),
            near_depth: view.near.into(),
            far_depth: view.far.into(),
            ratio_low: view.limits.low.map(I32F32::to_bits),
            ratio_high: view.limits.high.map(I32F32::to_bits),
            viewport: view.viewport,
            orthographic: (view.projection == Projection::Orthographic).into(),
        }
    }
}

impl From<Extended> for SplatlineExtended {
    fn from(number: Extended) -> Self {
        SplatlineExtended {
            mantissa: number.value,
            exponent: number.exponent,
        }
    }
}

impl SplatlineView {
    pub(crate) fn view(&self) -> Result<View, Error> {
        let fits = |size: &u16| u32::from(*size) <= SPLATLINE_LARGEST_VIEWPORT;
        if !self.viewport.iter().all(fits) {
            return Err(Error::Value);
        }
        let rows =
            |entries: &[i32; 9]| [0, 3, 6].map(|row| [0, 1, 2].map(|column| entries[row + column]));
        Ok(View {
            rotation: rows(&self.rotation).map(|row| row.map(I2F30::from_bits)),
            pose: Eye {
                position: self.eye,
                exponent: self.eye_exponent,
                rotation_rest: rows(&self.rotation_rest),
            },
            focal: self.focal.map(SoftFloat::from),
            principal: self.principal.map(I32F32::from_bits),
            near: self.near_depth.into(),
            far: self.far_depth.into(),
            viewport: self.viewport,
            projection: if flag(self.orthographic)? {
                Projection::Orthographic
            } else {
                Projection::Perspective
            },
            limits: RatioLimits {
                low: self.ratio_low.map(I32F32::from_bits),
                high: self.ratio_high.map(I32F32::from_bits),
            },
        })
    }
}

impl From<SplatlineExtended> for Extended {
    fn from(number: SplatlineExtended) -> Self {
        Extended {
            value: number.mantissa,
            exponent: number.exponent,
        }
    }
}

impl From<BlendConstants> for SplatlineBlendConstants {
    fn from(constants: BlendConstants) -> Self {
        SplatlineBlendConstants {
            opacity_min: constants.opacity_min,
            alpha_max: constants.alpha_max,
            minimum_transmittance: constants.minimum_transmittance,
            omit_finishing: constants.omit_finishing.into(),
        }
    }
}

impl From<&Rules> for SplatlineRules {
    fn from(rules: &Rules) -> Self {
        SplatlineRules {
            low_pass: rules.low_pass.into(),
            normalised: rules.normalised.into(),
            cutoff_by_opacity: (rules.cutoff == Cutoff::Opacity).into(),
            cutoff: match rules.cutoff {
                Cutoff::Radial(cutoff) => cutoff,
                Cutoff::Opacity => 0,
            },
            alpha_max: rules.alpha_max,
            alpha_min: rules.alpha_min,
            minimum_transmittance: rules.minimum_transmittance,
            omit_finishing: rules.omit_finishing.into(),
            clamp_jacobian: rules.clamp_jacobian.into(),
            table_range: rules.table_range.into(),
            compensated: rules.compensated.into(),
        }
    }
}

impl SplatlineRules {
    pub(crate) fn rules(&self) -> Result<Rules, Error> {
        if self.table_range > 4 {
            return Err(Error::Value);
        }
        Ok(Rules {
            normalised: flag(self.normalised)?,
            low_pass: self.low_pass.into(),
            compensated: flag(self.compensated)?,
            // The C interface draws Gaussians with a low-pass filter only.
            spacing: SoftFloat::ZERO,
            kernel: Kernel::Gaussian,
            cutoff: if flag(self.cutoff_by_opacity)? {
                Cutoff::Opacity
            } else {
                Cutoff::Radial(self.cutoff)
            },
            alpha_max: self.alpha_max,
            alpha_min: self.alpha_min,
            minimum_transmittance: self.minimum_transmittance,
            omit_finishing: flag(self.omit_finishing)?,
            clamp_jacobian: flag(self.clamp_jacobian)?,
            table_range: self.table_range as u8,
        })
    }
}

impl From<&Footprint> for SplatlineFootprint {
    fn from(footprint: &Footprint) -> Self {
        let Footprint { ldl, conic, .. } = footprint;
        SplatlineFootprint {
            centre: footprint.centre,
            depth: footprint.depth,
            first: footprint.first,
            end: footprint.end,
            horizontal: ldl.horizontal.into(),
            squared_width: ldl.squared_width.into(),
            shear: ldl.shear.into(),
            vertical: ldl.vertical.into(),
            conic_mantissa: conic.mantissa,
            conic_exponent: conic.exponent,
            cutoff: footprint.cutoff,
            opacity: footprint.opacity,
            colour: footprint.colour,
        }
    }
}

impl From<&SplatlineFootprint> for Footprint {
    fn from(footprint: &SplatlineFootprint) -> Self {
        Footprint {
            depth: footprint.depth,
            centre: footprint.centre,
            first: footprint.first,
            end: footprint.end,
            ldl: Ldl {
                horizontal: footprint.horizontal.into(),
                squared_width: footprint.squared_width.into(),
                shear: footprint.shear.into(),
                vertical: footprint.vertical.into(),
            },
            conic: Conic {
                mantissa: footprint.conic_mantissa,
                exponent: footprint.conic_exponent,
            },
            cutoff: footprint.cutoff,
            opacity: footprint.opacity,
            colour: footprint.colour,
        }
    }
}

impl From<&SplatlineWindow> for Window {
    fn from(window: &SplatlineWindow) -> Self {
        Window {
            first: window.first,
            end: window.end,
        }
    }
}

pub(crate) fn traversal(choice: u32) -> Result<Traversal, Error> {
    match choice {
        SPLATLINE_TRAVERSAL_BOX => Ok(Traversal::Box),
        SPLATLINE_TRAVERSAL_SPANS => Ok(Traversal::Spans),
        _ => Err(Error::Value),
    }
}

pub(crate) fn compositing(choice: u32) -> Result<Compositing, Error> {
    match choice {
        SPLATLINE_FRONT_TO_BACK => Ok(Compositing::FrontToBack),
        SPLATLINE_BACK_TO_FRONT => Ok(Compositing::BackToFront),
        SPLATLINE_XRAY => Ok(Compositing::XRay),
        _ => Err(Error::Value),
    }
}

fn flag(value: u32) -> Result<bool, Error> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(Error::Value),
    }
}
