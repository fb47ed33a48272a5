//! 8-bit RGB pictures for the report. (A picture that is a result has its own format: see [`crate::picture`].)

use crate::metrics::stored;
use crate::picture::Picture;
use image::{ExtendedColorType, ImageEncoder, ImageError, codecs::png::PngEncoder};

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
        let bytes = picture
            .pixels
            .iter()
            .flat_map(|p| [byte(p[0]), byte(p[1]), byte(p[2])])
            .collect();
        Rgb {
            width: picture.width,
            height: picture.height,
            bytes,
        }
    }

    /// The bytes of a PNG file.
    pub fn to_png(&self) -> Result<Vec<u8>, ImageError> {
        let mut file = Vec::new();
        // Sizes beyond 32 bits cannot be allocated; saturation makes the encoder refuse them.
        let width = u32::try_from(self.width).unwrap_or(u32::MAX);
        let height = u32::try_from(self.height).unwrap_or(u32::MAX);
        if self.bytes.len() as u64 != u64::from(width) * u64::from(height) * 3 {
            let reason = format!(
                "{} bytes do not make a {width}x{height} RGB picture",
                self.bytes.len()
            );
            return Err(ImageError::IoError(std::io::Error::other(reason)));
        }
        PngEncoder::new(&mut file).write_image(
            &self.bytes,
            width,
            height,
            ExtendedColorType::Rgb8,
        )?;
        Ok(file)
    }
}
