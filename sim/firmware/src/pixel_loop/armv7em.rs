//! The pixel loop of Armv7E-M (Cortex-M4, M7, M33): 26 instructions where the compiler has 40.
//!
//! | register | holds |
//! |---|---|
//! | r0 | the pixel |
//! | r1, r2 | radial index and first difference; the second lies on the stack |
//! | r3 | kernel, opacity, then share of the light, shifted up as a product's first factor |
//! | r4, r5, r6 | the three colour sums |
//! | r7 | transmittance |
//! | r8 | largest radial index inside the footprint |
//! | r9 | table |
//! | r10 | peak, scaled so that opacity and share are rounded at the same bit |
//! | r11 | red and green, doubled |
//! | r12 | blue, doubled, and above it the pixels to come less one |
//! | lr | rounding constant |
//!
//! A colour is half a word, and SMLAW adds the upper part of a product of a word and half a word:
//! `(g << 15) (2 c) >> 16` is `g c`.

use super::{BELOW, BLEND, INTERPOLATION, LANE, SCALE};
use crate::design::Firmware16;
use crate::table::{INTERVALS, WORDS};
use core::arch::naked_asm;
use core::mem::offset_of;
use splatline::blend::{FINISHED, Pixel};
use splatline::draw::{NarrowLanes, NarrowRun};
use splatline::footprint::Footprint;

// The share and the doubled colours are signed factors; the slope is half a word.
const _: () = {
    let widths = Firmware16::WIDTHS;
    assert!(widths.colour + 4 < 15 && BLEND.contribution_shift == 15 && widths.transmittance <= 16);
    assert!(BLEND.alpha_max < 1 << 15 && (INTERPOLATION == 0 || INTERPOLATION == 17));
};

/// Blends a run.
#[inline(always)]
pub fn paint(run: NarrowRun) {
    let NarrowRun {
        pixels,
        lanes,
        footprint,
        clamped,
    } = run;
    // The counter's bits.
    let count = pixels.len().min(1 << 16) as u32;
    let pixels = pixels.as_mut_ptr();
    // SAFETY: the pixels are a borrowed slice's.
    unsafe {
        if clamped {
            paint_clamped(pixels, &lanes, footprint, count)
        } else {
            paint_unclamped(pixels, &lanes, footprint, count)
        }
    }
}

/// The kernel at r1 into r3; r4 is free. The interval's number is cut to the table.
#[cfg(not(feature = "plain"))]
macro_rules! kernel {
    () => {
        "
        ubfx r3, r1, #{below}, #{index}
        ldr.w r3, [r9, r3, lsl #2]
        uxth r4, r3
        mls r3, r4, r1, r3
        lsrs r3, #{interpolation}
        "
    };
}
#[cfg(feature = "plain")]
macro_rules! kernel {
    () => {
        "
        ubfx r3, r1, #{below}, #{index}
        ldr.w r3, [r9, r3, lsl #2]      @ {interpolation} bits of position
        "
    };
}

/// Peak times kernel, rounded.
macro_rules! opacity_unclamped {
    () => {
        "
        mla r3, r3, r10, lr
        lsrs r3, #{share_shift}
        "
    };
}

/// The same with a peak up to 16, whose scaled product would not fit: the last bit shifted out is the rounding.
macro_rules! opacity_clamped {
    () => {
        "
        mul r3, r3, r10
        lsrs r3, #{opacity_shift}
        adc r3, r3, #0
        movw r4, #{alpha_max}
        cmp r3, r4
        it hi
        movhi r3, r4
        "
    };
}

/// A loop over `count` pixels for one way of opacity. It writes those pixels alone, and reads them, the two references
/// and [`WORDS`].
macro_rules! pixel_loop {
    ($name:ident, $opacity:expr, $scale:expr) => {
        /// # Safety
        /// `count` pixels from `pixels` on must be readable and writable.
        #[unsafe(naked)]
        unsafe extern "C" fn $name(
            pixels: *mut Pixel,
            lanes: &NarrowLanes,
            footprint: &Footprint,
            count: u32,
        ) {
            naked_asm!(
                "
                push {{r4, r5, r6, r7, r8, r9, r10, r11, lr}}
                ldr r10, [r2, #{peak}]
                ldr r4, [r2, #{colour}]
                ldr r5, [r2, #{colour} + 4]
                ldr r12, [r2, #{colour} + 8]
                ",
                $scale,
                "
                lsls r4, #1
                orr r11, r4, r5, lsl #17
                lsl r12, #1
                subs r3, #1
                orr r12, r12, r3, lsl #16
                ldmia r1, {{r1, r2, r3, r8}}
                push {{r3}}
                movw r9, #:lower16:{table}
                movt r9, #:upper16:{table}
                mov lr, #1 << ({share_shift} - 1)
                blo 6f
                2:
                ldr r7, [r0, #12]
                subs r3, r8, r1
                orrs r3, r7
                bmi 4f
                ",
                kernel!(),
                $opacity,
                "
                mla r3, r3, r7, lr
                bfc r3, #0, #{share_shift}
                sub r7, r7, r3, lsr #{share_shift}
                cmp r7, #{stop}
                bls 3f
                ldmia r0, {{r4, r5, r6}}
                smlawb r4, r3, r11, r4
                smlawt r5, r3, r11, r5
                smlawb r6, r3, r12, r6
                stmia r0!, {{r4, r5, r6, r7}}
                5:
                add r1, r2
                ldr r3, [sp]
                add r2, r3
                subs r12, #0x10000
                bhs 2b
                6:
                add sp, #4
                pop {{r4, r5, r6, r7, r8, r9, r10, r11, pc}}
                3:
                movs r3, #{finished} >> 24
                strb r3, [r0, #15]
                4:
                adds r0, #16
                b 5b
                ",
                below = const BELOW,
                index = const LANE - BELOW,
                interpolation = const INTERPOLATION,
                peak = const offset_of!(Footprint, opacity),
                colour = const offset_of!(Footprint, colour),
                scale = const SCALE,
                share_shift = const BLEND.contribution_shift,
                opacity_shift = const BLEND.opacity_shift,
                alpha_max = const BLEND.alpha_max,
                stop = const BLEND.minimum_transmittance,
                finished = const FINISHED,
                table = sym WORDS,
            )
        }
    };
}

pixel_loop!(
    paint_unclamped,
    concat!(
        opacity_unclamped!(),
        "@ by {opacity_shift} without the scale, at most {alpha_max}\n"
    ),
    "lsl r10, #{scale}"
);
pixel_loop!(paint_clamped, opacity_clamped!(), "@ not scaled by {scale}");

// The index cannot miss the table.
const _: () = assert!(INTERVALS == 1 << (LANE - BELOW));
