//! The pixel loop of RV32IM: 35 instructions where the compiler has 40. It draws two pixels in turn; a run of an odd
//! length begins with the second.
//!
//! | register | holds |
//! |---|---|
//! | a0 | the pixels |
//! | a1, a2, a3 | radial index, first and second difference |
//! | a4 | largest radial index inside the footprint |
//! | a5 | table |
//! | a6 | peak, scaled so that opacity and share are rounded at the same bit |
//! | a7 | rounding constant |
//! | t0, t1, t2 | red, green, blue |
//! | t3 | transmittance |
//! | t4, t5, t6 | scratch |
//! | s0, s1 | end of the run, transmittance that finishes a pixel |

use super::intervals::{TABLE, within_table};
use super::{BELOW, BLEND, INTERPOLATION, SCALE};
use core::arch::naked_asm;
use core::mem::{offset_of, size_of_val};
use splatline::blend::{FINISHED, Pixel};
use splatline::draw::{NarrowLanes, NarrowRun};
use splatline::footprint::Footprint;

/// Base-2 logarithm of an interval's bytes.
const INTERVAL: u32 = size_of_val(&TABLE[0]).ilog2();

/// Blends a run.
#[inline(always)]
pub fn paint(run: NarrowRun) {
    let pixels = run.pixels.as_mut_ptr_range();
    let lanes = within_table(run.lanes);
    // SAFETY: the range is a borrowed slice's, and `last` lies within the table.
    unsafe {
        if run.clamped {
            paint_clamped(pixels.start, &lanes, run.footprint, pixels.end)
        } else {
            paint_unclamped(pixels.start, &lanes, run.footprint, pixels.end)
        }
    }
}

/// The kernel at a1 into t4.
#[cfg(not(feature = "plain"))]
macro_rules! kernel {
    () => {
        "
        srli t5, a1, {below}
        slli t5, t5, {interval}
        add t5, t5, a5
        lw t4, 0(t5)
        lw t5, 4(t5)
        mul t5, t5, a1
        sub t4, t4, t5
        srli t4, t4, {interpolation}
        "
    };
}
#[cfg(feature = "plain")]
macro_rules! kernel {
    () => {
        "
        srli t5, a1, {below}
        slli t5, t5, {interval}         # {interpolation} bits of position
        add t5, t5, a5
        lhu t4, 0(t5)
        "
    };
}

/// Peak times kernel, rounded.
macro_rules! opacity_unclamped {
    () => {
        "
        mul t4, t4, a6
        add t4, t4, a7
        srli t4, t4, {share_shift}      # by {opacity_shift} without the scale, at most {alpha_max}
        "
    };
}

/// The same with a peak up to 16, whose scaled product would not fit.
macro_rules! opacity_clamped {
    () => {
        "
        mul t4, t4, a6
        srli t4, t4, {opacity_shift} - 1
        addi t4, t4, 1
        srli t4, t4, 1
        li t5, {alpha_max}
        bltu t4, t5, 7f
        mv t4, t5
        7:
        "
    };
}

/// A colour sum of that pixel.
macro_rules! colour {
    ($colour:literal, $channel:literal, $at:literal) => {
        concat!(
            "lw t5, ",
            $channel,
            " + ",
            $at,
            "(a0)
            mul t6, t4, ",
            $colour,
            "
            add t5, t5, t6
            sw t5, ",
            $channel,
            " + ",
            $at,
            "(a0)
            "
        )
    };
}

/// The pixel `$at` bytes beyond a0: to `$skip` if it lies outside, to `$finish` if the layer would finish it.
macro_rules! pixel {
    ($opacity:expr, $at:literal, $skip:literal, $finish:literal) => {
        concat!(
            "lw t3, 12 + ",
            $at,
            "(a0)
            bltu a4, a1, ",
            $skip,
            "
            bltz t3, ",
            $skip,
            "
            ",
            kernel!(),
            $opacity,
            "mul t4, t4, t3
            add t4, t4, a7
            srli t4, t4, {share_shift}
            sub t3, t3, t4
            bgeu s1, t3, ",
            $finish,
            "
            ",
            colour!("t0", "0", $at),
            colour!("t1", "4", $at),
            colour!("t2", "8", $at),
            "sw t3, 12 + ",
            $at,
            "(a0)
            ",
        )
    };
}

/// The loop for one way of opacity. It writes the pixels from `pixels` to `end` alone, and reads them, the two
/// references and [`TABLE`].
macro_rules! pixel_loop {
    ($name:ident, $opacity:expr, $scale:literal) => {
        /// # Safety
        /// The pixels from `pixels` to `end` must be readable and writable, and `lanes.last` below `2^LANE`.
        #[unsafe(naked)]
        unsafe extern "C" fn $name(
            pixels: *mut Pixel,
            lanes: &NarrowLanes,
            footprint: &Footprint,
            end: *mut Pixel,
        ) {
            naked_asm!(
                "
                .option push
                .option arch, +m
                addi sp, sp, -16
                sw s0, 0(sp)
                sw s1, 4(sp)
                mv s0, a3
                li s1, {stop}
                lw a6, {peak}(a2)
                lw t0, {colour}(a2)
                lw t1, {colour} + 4(a2)
                lw t2, {colour} + 8(a2)
                la a5, {table}
                li a7, 1 << ({share_shift} - 1)
                lw a4, 12(a1)
                lw a3, 8(a1)
                lw a2, 4(a1)
                lw a1, 0(a1)
                ",
                $scale,
                "
                beq a0, s0, 6f
                sub t3, s0, a0
                andi t3, t3, 16
                beqz t3, 20f
                addi a0, a0, -16
                j 30f
                20:
                ",
                pixel!($opacity, "0", "22f", "21f"),
                "
                23:
                add a1, a1, a2
                add a2, a2, a3
                30:
                ",
                pixel!($opacity, "16", "32f", "31f"),
                "
                33:
                add a1, a1, a2
                add a2, a2, a3
                addi a0, a0, 32
                bne a0, s0, 20b
                6:
                lw s0, 0(sp)
                lw s1, 4(sp)
                addi sp, sp, 16
                ret
                21:
                lui t4, {finished} >> 12
                lw t3, 12(a0)
                or t3, t3, t4
                sw t3, 12(a0)
                22:
                j 23b
                31:
                lui t4, {finished} >> 12
                lw t3, 28(a0)
                or t3, t3, t4
                sw t3, 28(a0)
                32:
                j 33b
                .option pop
                ",
                below = const BELOW,
                interval = const INTERVAL,
                interpolation = const INTERPOLATION,
                peak = const offset_of!(Footprint, opacity),
                colour = const offset_of!(Footprint, colour),
                scale = const SCALE,
                share_shift = const BLEND.contribution_shift,
                opacity_shift = const BLEND.opacity_shift,
                alpha_max = const BLEND.alpha_max,
                stop = const BLEND.minimum_transmittance,
                finished = const FINISHED,
                table = sym TABLE,
            )
        }
    };
}

pixel_loop!(
    paint_unclamped,
    opacity_unclamped!(),
    "slli a6, a6, {scale}"
);
pixel_loop!(paint_clamped, opacity_clamped!(), "# not scaled by {scale}");
