//! The images' design: `Micro16`, or what a feature makes of it for comparison.

use splatline::format::{Design, Micro16, Widths};

/// `Micro16` in this image's form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Firmware16;

impl Firmware16 {
    /// Widths of the design.
    pub const WIDTHS: Widths = {
        let mut widths = Micro16::WIDTHS;
        if cfg!(feature = "two-part") {
            widths.position = 48;
        }
        if cfg!(feature = "plain") {
            (widths.table, widths.interpolation) = (10, 0);
        }
        widths
    };
}

impl Design for Firmware16 {
    type Lane = i32;
    const FIXED: Option<Widths> = Some(Firmware16::WIDTHS);
}
