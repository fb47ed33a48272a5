//! Splats on a microcontroller without an FPU: one scene, drawn in fixed point by the kernel and in soft float beside
//! it.
//!
//! | file | what |
//! |---|---|
//! | `design` | a design of one's own: widths for which the pixel path needs no 64-bit product |
//! | `scene` | the splats and the camera, constants in flash |
//! | `table` | the footprint table, made by the compiler |
//! | `order` | depth order of the splats |
//! | `fixed_picture` | the kernel: setup, depth order, strips |
//! | `float_picture` | the same drawing in `f32`, twice: as it is usually written, and by the kernel's own algorithm |
//! | `general` | the same strips by the kernel's general painter, on the host: they must be equal |
//! | `pixel_loop` | the pixel loops of Cortex-M0+, M4 and RV32 in assembly |
//! | `board` | reset, semihosting output, stack gauge |
//!
//! `unsafe` code is in `board`, `pixel_loop`, the size markers below and the images' static memory.
//!
//! The picture is drawn in strips, as one would for a display on a serial bus: setup once, then rows of
//! eight lines each in a buffer that is sent off and used again. Here "sent off" is a checksum.
#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
pub mod board;
pub mod checksum;
pub mod design;
pub mod fixed_picture;
pub mod float_picture;
#[cfg(not(target_os = "none"))]
pub mod general;
pub mod order;
#[cfg(any(armv6m, armv7em, target_arch = "riscv32"))]
pub mod pixel_loop;
pub mod scene;
pub mod table;

/// What the instructions are counted for: functions that the counter in `counter/` knows by name.
///
/// Each must stay a function of its own with a body of its own, hence the different volatile writes.
#[macro_export]
macro_rules! phases {
    ($($name:ident = $number:literal, $what:literal;)*) => {$(
        #[doc = $what]
        #[unsafe(no_mangle)]
        #[inline(never)]
        pub extern "C" fn $name() {
            let (mut number, new) = (0u8, $number);
            // SAFETY: a local variable.
            unsafe { core::ptr::write_volatile(&mut number, new) };
        }
    )*};
}

/// The phases of all images.
pub mod phase {
    phases! {
        phase_rest = 1, "Start, checksum, output: not counted for the drawing.";
        phase_setup = 2, "Splats to footprints.";
        phase_draw = 3, "Footprints to pixels.";
        phase_draw_again = 4, "The second way of drawing.";
    }
}
