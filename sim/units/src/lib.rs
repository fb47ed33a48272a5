//! One entry point per set of systems, linked alone by `sizes.sh`: what a scene does not need costs no code, no table
//! and no state.
//!
//! Each entry sets up one splat, draws it and resolves what it drew, in `standard24` under the rules its systems are
//! meant for. Tables that are needed are constants of the image; the state of a pixel is a static of its type, so that
//! both appear in the image's size.
#![no_std]

use core::panic::PanicInfo;

#[cfg(feature = "volume")]
mod volume;
#[cfg(any(feature = "surface", feature = "layers"))]
mod surface;
#[cfg(any(feature = "hybrid", feature = "stamp"))]
mod points;
#[cfg(feature = "sphere")]
mod sphere;
#[cfg(any(feature = "sheets", feature = "deep"))]
mod depth;

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    loop {}
}

/// What all entries that draw volume splats share.
#[allow(dead_code)]
mod common {
    use splatline::draw::Painter;
    use splatline::format::{Standard24, Traversal, Widths};
    use splatline::kernel::{self, FootprintTable};
    use splatline::rules::{Compositing, Rules};

    pub const WIDTHS: Widths = Standard24::WIDTHS;
    pub static TABLE: [u32; kernel::entries(&WIDTHS)] = kernel::gaussian(&WIDTHS, 4);

    /// The painter that a front-to-back drawing by spans uses; none if the table did not fit, which it does.
    pub fn painter(
        rules: &Rules,
        compositing: Compositing,
    ) -> Option<Painter<'static, Standard24>> {
        let table = FootprintTable::new(&TABLE, &WIDTHS, rules.table_range).ok()?;
        Some(Painter::new(
            Standard24,
            rules,
            table,
            compositing,
            Traversal::Spans,
        ))
    }
}
