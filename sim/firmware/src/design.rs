//! A design of one's own: `Firmware16`.
//!
//! Widths are chosen so that every product of the pixel path fits 32 bits, which a Cortex-M0 multiplies in one
//! instruction (a 64-bit product is a library call there):
//!
//! | product | bits |
//! |---|---|
//! | peak UQ4.15 x kernel UQ1.13 | 32 |
//! | transmittance UQ1.16 x opacity UQ1.15 | 32 |
//! | share UQ1.16 x colour UQ4.10 | 31 |
//! | table step UQ0.13 x position 8 | 21 |

use splatline::format::{Design, Rounding, Widths};

/// 16-bit alpha channel, 16-bit mantissas, 32-bit products.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Firmware16;

impl Firmware16 {
    /// Widths of the design.
    pub const WIDTHS: Widths = Widths {
        view: 24,
        mantissa: 15,
        subpixel: 12,
        radial: 27,
        table: 7,
        interpolation: 17,
        weight: 14,
        peak: 14,
        alpha: 15,
        transmittance: 16,
        colour: 10,
        accumulator: 26,
        rounding: Rounding::Nearest,
    };
}

impl Design for Firmware16 {
    type Lane = i32;
    #[inline(always)]
    fn widths(&self) -> Widths {
        const {
            assert!(Firmware16::WIDTHS.check().is_ok());
            Firmware16::WIDTHS
        }
    }
}
