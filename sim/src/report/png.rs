//! 8-bit RGB pictures for the report. (A picture that is a result has its own format: see [`crate::picture`].)

use crate::metrics::stored;
use crate::picture::Picture;
use crate::picture::png::encode_rgb8;

/// Opaque 8-bit RGB, row-major.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rgb {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Three bytes per pixel.
    pub bytes: Vec<u8>,
}

impl Rgb {
    /// A picture as it looks on black. Colours are premultiplied on black already; were alpha kept, a browser would
    /// multiply by it once more.
    pub fn on_black(picture: &Picture) -> Rgb {
        let byte = |value: f64| (stored(value) * 255.0).round() as u8;
        let colours = picture.pixels.iter().map(|[r, g, b, _]| [r, g, b]);
        let colours = colours.map(|colour| colour.map(|value| byte(*value)));
        Rgb::of_pixels([picture.width, picture.height], colours)
    }

    /// From the colours of its pixels.
    pub fn of_pixels([width, height]: [usize; 2], colours: impl Iterator<Item = [u8; 3]>) -> Rgb {
        let bytes = colours.flatten().collect();
        Rgb {
            width,
            height,
            bytes,
        }
    }

    /// The bytes of a PNG file.
    pub fn to_png(&self) -> anyhow::Result<Vec<u8>> {
        encode_rgb8([self.width, self.height], &self.bytes)
    }
}
