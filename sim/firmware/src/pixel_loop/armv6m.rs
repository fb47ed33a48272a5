//! The pixel loop of Armv6-M (Cortex-M0, M0+).
//!
//! A compiler for this processor works in seven of eight low registers and spills the rest. Here the upper registers
//! hold what is only added, moved or compared, which are the three things that an instruction can do with them, and the
//! stack holds what a pixel reads once:
//!
//! | register | holds |
//! |---|---|
//! | r0 | the pixel |
//! | r1 | radial index |
//! | r2 | opacity, then share of the light |
//! | r3 | scratch |
//! | r4, r5, r6 | value and slope of the interval; then the three colour sums |
//! | r7 | transmittance |
//! | r8, r9 | first and second difference |
//! | r10 | largest radial index inside the footprint |
//! | r11 | table |
//! | r12 | rounding constant, the same for opacity and share: the peak is scaled for that |
//! | lr | end of the run |
//! | stack | peak, red, green, blue |
//!
//! Transmittance and sums lie side by side, so one instruction reads the sums, one writes all four and goes on to the
//! next pixel. The loop draws two pixels in turn; a run of an odd length begins with the second.

use super::intervals::{TABLE, within_table};
use super::{BELOW, BLEND, INTERPOLATION, SCALE};
use core::arch::naked_asm;
use core::mem::offset_of;
use splatline::blend::{FINISHED, Pixel};
use splatline::draw::{NarrowLanes, NarrowRun};
use splatline::footprint::Footprint;

/// Blends a run.
#[inline(always)]
pub fn paint(run: NarrowRun) {
    let pixels = run.pixels.as_mut_ptr_range();
    let lanes = within_table(run.lanes);
    let scale = if run.clamped { 0 } else { SCALE as u32 };
    // SAFETY: the range is a borrowed slice's, and `last` lies within the table.
    unsafe { paint_range(pixels.start, run.footprint, &lanes, pixels.end, scale) }
}

/// The kernel at r1 into r2; r3 to r6 are free.
#[cfg(not(feature = "plain"))]
macro_rules! kernel {
    () => {
        "
        lsrs r3, r1, #{below}
        lsls r3, #3
        add r3, r11
        ldmia r3!, {{r4, r5}}
        muls r5, r1
        subs r4, r5
        lsrs r2, r4, #{interpolation}
        "
    };
}
#[cfg(feature = "plain")]
macro_rules! kernel {
    () => {
        "
        lsrs r2, r1, #{below}
        lsls r2, #1
        add r2, r11
        ldrh r2, [r2]           @ {interpolation} bits of position
        "
    };
}

/// Peak times kernel, rounded.
macro_rules! opacity_unclamped {
    () => {
        "
        ldr r3, [sp]
        muls r2, r3
        add r2, r12
        lsrs r2, #{share_shift}     @ by {opacity_shift} without the peak's scale
        "
    };
}

/// The same with a peak up to 16, whose scaled product would not fit: the last bit shifted out is the rounding.
macro_rules! opacity_clamped {
    () => {
        "
        ldr r3, [sp]
        muls r2, r3
        movs r3, #0
        lsrs r2, #{opacity_shift}
        adcs r2, r3
        ldr r3, 8f
        cmp r2, r3
        bls 7f
        mov r2, r3
        7:
        "
    };
}

/// One pixel: to `$skip` if it lies outside or takes nothing, to `$finish` if the layer would finish it. Ends with the
/// next pixel in r0.
macro_rules! pixel {
    ($opacity:expr, $skip:literal, $finish:literal) => {
        concat!(
            "cmp r1, r10
            bhi ",
            $skip,
            "
            ldr r7, [r0, #12]
            cmp r7, #0
            bmi ",
            $skip,
            kernel!(),
            $opacity,
            "muls r2, r7
            add r2, r12
            lsrs r2, #{share_shift}
            subs r7, r2
            cmp r7, #{stop}
            bls ",
            $finish,
            "
            ldmia r0!, {{r4, r5, r6}}
            ldr r3, [sp, #4]
            muls r3, r2
            adds r4, r3
            ldr r3, [sp, #8]
            muls r3, r2
            adds r5, r3
            ldr r3, [sp, #12]
            muls r3, r2
            adds r6, r3
            subs r0, #12
            stmia r0!, {{r4, r5, r6, r7}}
            "
        )
    };
}

/// What the pixel's skips come to: at `$finish` only the flag is set, which has a byte of its own in memory, at `$skip`
/// nothing.
macro_rules! left_out {
    ($finish:literal, $skip:literal, $next:literal) => {
        concat!(
            $finish,
            ":
            movs r3, #{finished} >> 24
            strb r3, [r0, #15]
            ",
            $skip,
            ":
            adds r0, #16
            b ",
            $next,
            "
            "
        )
    };
}

/// Blends the pixels from `pixels` to `end`: two in turn where the peak is scaled, one by one with the clamp where it
/// is not (`scale` 0).
///
/// It writes those pixels alone, and reads them, the two references and [`TABLE`]. It calls nothing and uses 52 bytes
/// of stack.
///
/// # Safety
/// The pixels from `pixels` to `end` must be readable and writable, and `lanes.last` below `2^LANE`.
#[unsafe(naked)]
unsafe extern "C" fn paint_range(
    pixels: *mut Pixel,
    footprint: &Footprint,
    lanes: &NarrowLanes,
    end: *mut Pixel,
    scale: u32,
) {
    naked_asm!(
        "
        push {{r4, r5, r6, r7, lr}}
        mov r4, r8
        mov r5, r9
        mov r6, r10
        mov r7, r11
        push {{r4, r5, r6, r7}}
        mov lr, r3
        ldr r4, [r1, #{peak}]
        ldr r5, [sp, #36]
        lsls r4, r5
        ldr r5, [r1, #{colour}]
        ldr r6, [r1, #{colour} + 4]
        ldr r7, [r1, #{colour} + 8]
        push {{r4, r5, r6, r7}}
        ldmia r2!, {{r1, r4, r5, r6}}
        mov r8, r4
        mov r9, r5
        mov r10, r6
        ldr r4, 9f
        mov r11, r4
        movs r4, #1
        lsls r4, #{share_shift} - 1
        mov r12, r4
        subs r3, r0
        beq 6f
        ldr r4, [sp, #52]
        cmp r4, #0
        beq 40f
        lsrs r3, #5
        bcs 30f
        ",
        "20:",
        pixel!(opacity_unclamped!(), "22f", "21f"),
        "23:
        add r1, r8
        add r8, r9
        ",
        "30:",
        pixel!(opacity_unclamped!(), "32f", "31f"),
        "33:
        add r1, r8
        add r8, r9
        cmp r0, lr
        bne 20b
        ",
        "6:
        add sp, #16
        pop {{r4, r5, r6, r7}}
        mov r8, r4
        mov r9, r5
        mov r10, r6
        mov r11, r7
        pop {{r4, r5, r6, r7, pc}}
        ",
        left_out!("21", "22", "23b"),
        left_out!("31", "32", "33b"),
        "40:",
        pixel!(opacity_clamped!(), "42f", "41f"),
        "43:
        add r1, r8
        add r8, r9
        cmp r0, lr
        bne 40b
        b 6b
        ",
        left_out!("41", "42", "43b"),
        "
        .balign 4
        8: .word {alpha_max}
        9: .word {table}
        ",
        below = const BELOW,
        interpolation = const INTERPOLATION,
        peak = const offset_of!(Footprint, opacity),
        colour = const offset_of!(Footprint, colour),
        share_shift = const BLEND.contribution_shift,
        opacity_shift = const BLEND.opacity_shift,
        alpha_max = const BLEND.alpha_max,
        stop = const BLEND.minimum_transmittance,
        finished = const FINISHED,
        table = sym TABLE,
    )
}
