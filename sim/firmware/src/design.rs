//! A design of one's own: `Firmware16`.
//!
//! Widths are chosen so that every product of the pixel path fits 32 bits, which a Cortex-M0 multiplies in one
//! instruction (a 64-bit product is a library call there):
//!
//! | product | bits |
//! |---|---|
//! | peak UQ4.14 x kernel UQ1.14 | 32 |
//! | transmittance UQ1.16 x opacity UQ1.15 | 31 |
//! | share UQ1.16 x colour UQ4.10 | 30 |
//! | table step UQ0.11 x position 17 | 28 |
//! | row seed: 15-bit mantissas | 31 |
//!
//! The accumulated colour has as many fraction bits as share and colour together: nothing is rounded there, and nothing shifted. 17
//! bits of position leave a half-word for the table's slope. Lanes end where the position ends (20 + 4 = 7 + 17 bits), so that nothing is
//! shifted there either.

use splatline::format::{Design, Rounding, Widths};

/// 16-bit alpha channel, 15-bit mantissas, 32-bit products.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Firmware16;

/// Base-2 logarithm of the table's intervals, and bits of the position within one.
const TABLE: (u8, u8) = if cfg!(feature = "plain") {
    (10, 0)
} else {
    (7, 17)
};

impl Firmware16 {
    /// Widths of the design.
    pub const WIDTHS: Widths = Widths {
        position: if cfg!(feature = "two-part") { 48 } else { 30 },
        view: 24,
        mantissa: 15,
        subpixel: 12,
        radial: 20,
        table: TABLE.0,
        interpolation: TABLE.1,
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
    const FIXED: Option<Widths> = Some(Firmware16::WIDTHS);
}
