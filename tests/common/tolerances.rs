//! The one table of tolerances: what each design may differ from double precision at each stage boundary.
//!
//! A value kept to m bits is off by at most 2^-m, relatively; a stage multiplies that by the number of rounded
//! operations before it. "Shape" is for splats whose projected axes do not cancel (axis along the viewing
//! ray): there the relative error of a column grows with the cancellation, which the test bounds separately.

use splatline::format::Widths;

/// Bounds for one design.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    pub name: &'static str,
    /// Camera space, scene units.
    pub camera: f64,
    /// Centre, pixels, for centres within 1000 pixels.
    pub centre: f64,
    /// Columns of M, relative to the longest axis on the screen.
    pub columns: f64,
    /// Variance, determinant and conic, relative to the largest entry.
    pub shape: f64,
    /// Radial index inside the footprint, absolute, against the packet's own coefficients.
    pub radial: f64,
}

/// Bounds that follow from the widths.
pub fn of(name: &'static str, widths: &Widths) -> Tolerance {
    let unit = |bits: u8| f64::from(-i32::from(bits)).exp2();
    let view = unit(widths.view.min(30));
    let mantissa = unit(widths.mantissa);
    Tolerance {
        name,
        camera: 16.0 * view + 1e-15,
        centre: 4000.0 * unit(widths.view) + 2000.0 * view + unit(widths.subpixel),
        columns: 16.0 * mantissa + 8.0 * view,
        shape: 64.0 * mantissa + 32.0 * view,
        // dx is held to 2^-(mantissa - 1) of the half-width. In units of r: BLOCK^2 / 32 of the second difference, one a pixel of the
        // first, two of the seed.
        radial: 128.0 * mantissa + 66.0 * unit(widths.radial),
    }
}
