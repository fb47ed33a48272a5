//! What the images of all boards have in common: strips to a display, and what remains where none can be shown.
#![no_std]

use embedded_graphics_core::pixelcolor::Rgb565;
use embedded_graphics_core::pixelcolor::raw::RawU16;
use embedded_hal::digital::OutputPin;
use mipidsi::Display;
use mipidsi::interface::{Interface, InterfacePixelFormat};
use mipidsi::models::Model;
use splatline_frame::scene::SIDE;
use splatline_frame::{FrameMemory, STRIP};

/// Sends a strip: a window command, then its pixels.
pub fn send<I, M, R>(display: &mut Display<I, M, R>, first: u16, sent: &[u16])
where
    I: Interface,
    M: Model<ColorFormat = Rgb565>,
    R: OutputPin,
    Rgb565: InterfacePixelFormat<I::Word>,
{
    let pixels = sent.iter().map(|bits| Rgb565::from(RawU16::new(*bits)));
    let _ = display.set_pixels(0, first, SIDE - 1, first + STRIP - 1, pixels);
}

/// Draws the scenes for ever, by one core.
pub fn show<I, M, R>(display: &mut Display<I, M, R>, memory: &mut FrameMemory) -> !
where
    I: Interface,
    M: Model<ColorFormat = Rgb565>,
    R: OutputPin,
    Rgb565: InterfacePixelFormat<I::Word>,
{
    splatline_frame::show(memory, |first, sent| send(display, first, sent))
}

/// Nothing can be shown.
pub fn halt() -> ! {
    loop {
        core::hint::spin_loop();
    }
}
