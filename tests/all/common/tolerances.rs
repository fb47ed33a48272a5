//! The one table of tolerances: what each design may differ from double precision at each stage boundary.
//!
//! The stages of setup have bounds of their own for each splat (`tests/all/setup_against_double.rs`), those of
//! docs/error-analysis.md.

use splatline::format::Widths;

/// Bounds for one design.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Radial index inside the footprint, absolute, against the packet's own coefficients.
    pub radial: f64,
}

/// Bounds that follow from the widths.
pub fn of(widths: &Widths) -> Tolerance {
    let unit = |bits: u8| f64::from(-i32::from(bits)).exp2();
    let mantissa = unit(widths.mantissa);
    Tolerance {
        // dx is held to 2^-(mantissa - 1) of the half-width. In units of r: BLOCK^2 / 32 of the second difference, one
        // a pixel of the first, two of the seed.
        radial: 128.0 * mantissa + 66.0 * unit(widths.radial),
    }
}
