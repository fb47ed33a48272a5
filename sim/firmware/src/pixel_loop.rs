//! Pixel loops in assembly: the same bits as [`Painter32::paint`](splatline::draw::Painter32::paint), which stays their
//! definition (`bin/loops.rs` compares the two run by run, `run.sh` the checksum of the picture with the host's).
//!
//! None looks whether an opacity is 0: such a layer takes nothing, and a pixel that has not finished has more than the
//! least transmittance.

#[cfg(armv6m)]
mod armv6m;
#[cfg(armv7em)]
mod armv7em;
#[cfg(not(armv7em))]
mod intervals;
#[cfg(target_arch = "riscv32")]
mod rv32;
#[cfg(armv6m)]
pub use armv6m::paint;
#[cfg(armv7em)]
pub use armv7em::paint;
#[cfg(target_arch = "riscv32")]
pub use rv32::paint;

use crate::design::Firmware16;
use crate::scene::RULES;
use crate::table::INTERVALS;
use core::mem::{offset_of, size_of};
use splatline::blend::{Blend, BlendConstants, FINISHED, Pixel};
use splatline::draw::NarrowLanes;
use splatline::format::Rounding;

const INTERPOLATION: u8 = Firmware16::WIDTHS.interpolation;
const BLEND: BlendConstants = Blend::new(&Firmware16::WIDTHS, &RULES).constants();

/// Bits of a radial index, and those of them below the interval's number.
const LANE: u32 = Firmware16::WIDTHS.radial as u32 + RULES.table_range as u32;
const BELOW: u32 = LANE - INTERVALS.ilog2();

/// From the peak's scale to the one at which opacity and share are rounded at the same bit.
const SCALE: i32 = BLEND.contribution_shift - BLEND.opacity_shift;

// What the assembly takes for granted.
const _: () = {
    assert!(matches!(BLEND.rounding, Rounding::Nearest) && BLEND.omit_finishing);
    // What rounds to 0 is all that is skipped.
    assert!(BLEND.opacity_min == 1 << (BLEND.opacity_shift - 1));
    assert!(BLEND.minimum_transmittance < 256);
    assert!(BLEND.contribution_shift > 0 && BLEND.opacity_shift > 0 && BLEND.colour_shift == 0);
    // The peak of a splat that is not clamped, scaled so that opacity and share are rounded at the same bit, fits a
    // word with the kernel.
    let widths = Firmware16::WIDTHS;
    assert!(SCALE >= 0 && widths.peak as i32 + SCALE + (widths.weight as i32) < 32);
    // The position ends where the lane ends.
    assert!(INTERPOLATION == 0 || INTERPOLATION as u32 == BELOW);
    assert!(size_of::<Pixel>() == 16 && offset_of!(Pixel, colour) == 0);
    assert!(offset_of!(NarrowLanes, last) == 12);
    assert!(FINISHED == 1 << 31 && widths.transmittance < 24 && cfg!(target_endian = "little"));
};
