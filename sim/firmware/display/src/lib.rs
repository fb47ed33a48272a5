//! Splats on a small display: ordinary numbers in, an `embedded-graphics` [`DrawTarget`] out, a strip of two rows at a
//! time.
//!
//! [`draw`] is all that an application needs; README.md shows the picture and what it costs.
#![cfg_attr(target_os = "none", no_std)]

pub mod panel;
pub mod scene;

use embedded_graphics::pixelcolor::{Rgb565, raw::RawU16};
use embedded_graphics::prelude::{DrawTarget, Point, Size};
use embedded_graphics::primitives::Rectangle;
use splatline::target::Target;
use splatline::{
    BoundedList, CameraError, Counts, DisplayList, ListFull, Micro16, Pixel, Renderer, View,
};
use splatline_firmware::phase::{phase_draw, phase_rest, phase_setup};

/// Rows of a strip.
pub const STRIP: u16 = 2;

/// The sky behind the scene, a dark blue.
pub const BACKGROUND: u16 = 0x0883;

/// All memory that drawing needs beside the stack: 12 KiB.
#[derive(Debug)]
pub struct DisplayMemory {
    list: BoundedList<56>,
    strip: [Pixel; scene::SIZE[0] as usize * STRIP as usize],
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DisplayError<E> {
    /// The camera is none.
    Camera(CameraError),
    /// More splats are visible than the list has room for.
    List(ListFull),
    /// The memory does not hold a strip.
    Strip,
    /// The display's own error.
    Display(E),
}

impl DisplayMemory {
    /// Empty memory.
    pub const EMPTY: DisplayMemory = DisplayMemory {
        list: BoundedList::new(),
        strip: [Pixel::EMPTY; scene::SIZE[0] as usize * STRIP as usize],
    };
}

/// Draws the scene on a display. The phases are for counting instructions and do nothing.
pub fn draw<T: DrawTarget<Color = Rgb565>>(
    memory: &mut DisplayMemory,
    display: &mut T,
) -> Result<Counts, DisplayError<T::Error>> {
    let renderer = Renderer::new(Micro16);
    phase_setup();
    let view = scene::camera().and_then(|camera| camera.view());
    let view = view.map_err(DisplayError::Camera)?;
    let splats = (0..scene::SPLATS).map(scene::splat);
    let counts = renderer.set_up(&view, splats, &mut memory.list);
    phase_rest();
    for window in view.window().strips(STRIP) {
        phase_draw();
        let strip = renderer.draw(&memory.list, window, &mut memory.strip);
        phase_rest();
        let strip = strip.map_err(|_| DisplayError::Strip)?;
        let area = Rectangle::new(
            Point::new(0, window.first[1].into()),
            Size::new(window.columns().into(), window.rows().into()),
        );
        let bits = strip.rgb565(BACKGROUND);
        let colours = bits.map(|bits| RawU16::new(bits).into());
        let sent = display.fill_contiguous(&area, colours);
        sent.map_err(DisplayError::Display)?;
    }
    counts.map_err(DisplayError::List)
}

/// Pixels of the picture that lie in a footprint, each as often as footprints cover it.
pub fn covered(memory: &mut DisplayMemory, view: &View) -> u64 {
    let renderer = Renderer::new(Micro16);
    let DisplayMemory { list, strip } = memory;
    let mut sum = 0;
    for window in view.window().strips(STRIP) {
        // By the painter that counts.
        if let Ok(mut target) = Target::new(strip, window, window.columns().into()) {
            target.clear(&Micro16::WIDTHS);
            sum += renderer.paint(list, &mut target).covered;
        }
    }
    sum
}

/// Splats that are on the list.
pub fn visible(memory: &DisplayMemory) -> usize {
    memory.list.footprints().len()
}
