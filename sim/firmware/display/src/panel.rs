//! A display on a serial bus, as far as an emulator has one: what it is sent ends in a checksum.

use core::convert::Infallible;
use embedded_graphics::pixelcolor::Rgb565;
use embedded_graphics::prelude::{DrawTarget, OriginDimensions, Pixel, RawData, Size};
use embedded_graphics::primitives::Rectangle;
use splatline_firmware::checksum::Checksum;

/// The display.
#[derive(Clone, Copy, Debug, Default)]
pub struct Panel {
    /// Areas and colours in the order in which they came.
    pub checksum: Checksum,
    /// Pixels that were sent.
    pub pixels: u32,
}

impl Panel {
    fn send(&mut self, colour: Rgb565) {
        let raw: embedded_graphics::pixelcolor::raw::RawU16 = colour.into();
        self.checksum.add(raw.into_inner().into());
        self.pixels = self.pixels.wrapping_add(1);
    }
}

impl OriginDimensions for Panel {
    fn size(&self) -> Size {
        let [columns, rows] = crate::scene::SIZE;
        Size::new(columns.into(), rows.into())
    }
}

impl DrawTarget for Panel {
    type Color = Rgb565;
    type Error = Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> Result<(), Infallible>
    where
        I: IntoIterator<Item = Pixel<Rgb565>>,
    {
        for Pixel(place, colour) in pixels {
            self.checksum.add(place.x as u32);
            self.checksum.add(place.y as u32);
            self.send(colour);
        }
        Ok(())
    }

    /// One window command, then its pixels without an address each: what such displays are fastest at.
    fn fill_contiguous<I>(&mut self, area: &Rectangle, colours: I) -> Result<(), Infallible>
    where
        I: IntoIterator<Item = Rgb565>,
    {
        self.checksum.add(area.top_left.x as u32);
        self.checksum.add(area.top_left.y as u32);
        let count = area.size.width.saturating_mul(area.size.height);
        for colour in colours.into_iter().take(count as usize) {
            self.send(colour);
        }
        Ok(())
    }
}
