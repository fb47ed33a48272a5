//! A picture in double precision: RGBA, premultiplied on black, linear as stored.
//!
//! PNG files hold the same numbers, clamped to 0..1 and rounded to the nearest of 255 or 65535 steps. No gamma is
//! applied and the colour stays premultiplied, so that a stored picture can be compared with a computed one.

use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageBuffer, ImageFormat, ImageReader};

use crate::atomic;

/// Row-major RGBA picture, premultiplied on black; A = 1 - transmittance.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` pixels.
    pub pixels: Vec<[f64; 4]>,
}

/// Bits per channel of a PNG file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Depth {
    /// 8 bits: steps of 1/255.
    #[default]
    Eight,
    /// 16 bits: steps of 1/65535.
    Sixteen,
}

/// Why a picture could not be read or written; the message names the file.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file could not be opened, read or written.
    #[error("picture '{file}': {source}")]
    Io {
        /// The file.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not a PNG picture that can be decoded, or the picture cannot be encoded.
    #[error("picture '{file}' is not a sound PNG: {source}")]
    Png {
        /// The file, or a description where there is none.
        file: String,
        /// What the PNG library said.
        source: image::ImageError,
    },
    /// The picture's size and its number of pixels contradict each other, or do not fit a PNG.
    #[error("a picture of {width} x {height} with {pixels} pixels cannot be written")]
    Size {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Pixels held.
        pixels: usize,
    },
}

impl Picture {
    /// A transparent black picture.
    pub fn new(width: usize, height: usize) -> Self {
        Picture {
            width,
            height,
            pixels: vec![[0.0; 4]; width * height],
        }
    }

    /// The picture as the bytes of a PNG file.
    pub fn to_png(&self, depth: Depth) -> Result<Vec<u8>, PictureError> {
        let size_error = || PictureError::Size {
            width: self.width,
            height: self.height,
            pixels: self.pixels.len(),
        };
        let width = u32::try_from(self.width).map_err(|_| size_error())?;
        let height = u32::try_from(self.height).map_err(|_| size_error())?;
        if self.width.checked_mul(self.height) != Some(self.pixels.len()) {
            return Err(size_error());
        }
        let channels = self.pixels.iter().flatten();
        let image = match depth {
            Depth::Eight => {
                let data = channels
                    .map(|&value| quantise(value, 255.0) as u8)
                    .collect();
                ImageBuffer::from_raw(width, height, data).map(DynamicImage::ImageRgba8)
            }
            Depth::Sixteen => {
                let data = channels.map(|&value| quantise(value, 65535.0)).collect();
                ImageBuffer::from_raw(width, height, data).map(DynamicImage::ImageRgba16)
            }
        }
        .ok_or_else(size_error)?;
        let mut bytes = Cursor::new(Vec::new());
        image
            .write_to(&mut bytes, ImageFormat::Png)
            .map_err(|source| PictureError::Png {
                file: "(in memory)".to_string(),
                source,
            })?;
        Ok(bytes.into_inner())
    }

    /// Writes a PNG file; a failure or an interruption leaves the old file or none, never a part.
    pub fn write_png(&self, path: &Path, depth: Depth) -> Result<(), PictureError> {
        let bytes = self.to_png(depth)?;
        atomic::write(path, &bytes).map_err(|source| PictureError::Io {
            file: path.display().to_string(),
            source,
        })
    }

    /// Reads a PNG file of 8 or 16 bits; without an alpha channel every pixel is opaque.
    pub fn read_png(path: &Path) -> Result<Picture, PictureError> {
        let file = || path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| PictureError::Io {
            file: file(),
            source,
        })?;
        let image = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png)
            .decode()
            .map_err(|source| PictureError::Png {
                file: file(),
                source,
            })?;
        // 16 bits hold an 8-bit value without loss: v / 255 = 257 v / 65535.
        let image = image.into_rgba16();
        Ok(Picture {
            width: image.width() as usize,
            height: image.height() as usize,
            pixels: image
                .pixels()
                .map(|pixel| pixel.0.map(|value| f64::from(value) / 65535.0))
                .collect(),
        })
    }
}

/// The nearest step of `0..=steps`; NaN becomes 0.
fn quantise(value: f64, steps: f64) -> u16 {
    (value.clamp(0.0, 1.0) * steps).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Picture {
        let pixels = (0..35)
            .map(|i| f64::from(i) / 34.0)
            .map(|x| [x, 1.0 - x, x * x, 0.5 * x])
            .collect();
        Picture {
            width: 7,
            height: 5,
            pixels,
        }
    }

    #[test]
    fn png_keeps_every_channel_to_half_a_step() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ramp.png");
        for (depth, steps) in [(Depth::Eight, 255.0), (Depth::Sixteen, 65535.0)] {
            ramp().write_png(&path, depth).unwrap();
            let read = Picture::read_png(&path).unwrap();
            assert_eq!((read.width, read.height), (7, 5));
            for (stored, original) in read
                .pixels
                .iter()
                .flatten()
                .zip(ramp().pixels.iter().flatten())
            {
                assert!(
                    (stored - original).abs() <= 0.500001 / steps,
                    "{depth:?}: {stored} for {original}"
                );
            }
        }
    }

    #[test]
    fn values_outside_the_range_are_clamped_and_rounding_is_to_nearest() {
        let values = [
            -1.0,
            2.0,
            f64::NAN,
            f64::INFINITY,
            0.49 / 255.0,
            0.51 / 255.0,
        ];
        assert_eq!(
            values.map(|value| quantise(value, 255.0)),
            [0, 255, 0, 255, 0, 1]
        );
    }

    #[test]
    fn rgb_without_alpha_is_opaque() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rgb.png");
        image::RgbImage::from_pixel(2, 1, image::Rgb([255, 51, 0]))
            .save(&path)
            .unwrap();
        assert_eq!(
            Picture::read_png(&path).unwrap().pixels,
            [[1.0, 0.2, 0.0, 1.0]; 2]
        );
    }

    #[test]
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("broken.png");
        assert!(
            Picture::read_png(&path)
                .unwrap_err()
                .to_string()
                .contains("broken.png")
        );
        std::fs::write(&path, b"\x89PNG\r\n\x1a\nrubbish").unwrap();
        assert!(
            Picture::read_png(&path)
                .unwrap_err()
                .to_string()
                .contains("broken.png")
        );
        let mut torn = ramp();
        torn.pixels.pop();
        assert!(
            torn.to_png(Depth::Eight)
                .unwrap_err()
                .to_string()
                .contains("34 pixels")
        );
    }
}
