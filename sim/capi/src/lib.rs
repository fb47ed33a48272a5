//! C ABI of the kernel: what firmware in C and Verilator benches link.
//!
//! The functions are thin: they check pointers, sizes and choices, convert plain structs to the kernel's types and call
//! the kernel. No arithmetic happens here. A design is a struct of widths and not a type, so one library serves every
//! design; the kernel's own tests prove that widths held in fields give the same bits as the named designs.
//!
//! | file | functions |
//! |---|---|
//! | `versions` | versions, texts of errors |
//! | `design` | named designs and rules, kernel tables |
//! | `setup` | splats to footprints |
//! | `packet` | footprints to packets and back, layout of the packet |
//! | `spans` | stepping: rows of a footprint, pixels of a row |
//! | `draw` | whole footprints into a window |
//! | `front` | camera, splats, scenes and strips in ordinary numbers |
#![cfg_attr(not(feature = "std"), no_std)]

mod design;
mod draw;
mod front;
mod memory;
mod packet;
mod spans;
mod setup;
mod status;
mod types;
mod versions;

pub use design::*;
pub use draw::*;
pub use front::*;
pub use packet::*;
pub use setup::*;
pub use spans::*;
pub use status::*;
pub use types::*;
pub use versions::*;

/// Never reached: the kernel has no panic path. Free-standing libraries must have a handler all the same.
#[cfg(all(not(feature = "std"), not(test)))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    #[cfg(feature = "prove-panic-free")]
    {
        unsafe extern "C" {
            fn splatline_panic_path_survived() -> !;
        }
        // SAFETY: declared here and defined nowhere; a library that still refers to it does not link.
        unsafe { splatline_panic_path_survived() }
    }
    #[cfg(not(feature = "prove-panic-free"))]
    loop {
        core::hint::spin_loop();
    }
}
