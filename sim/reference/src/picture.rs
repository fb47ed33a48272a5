//! A picture in double precision: RGBA, premultiplied on black, linear as stored.
//!
//! Files: PNG with values clamped to 0..1 and rounded to the nearest of 255 or 65535 steps, without gamma, either
//! opaque on a [`Backdrop`] or with straight (not premultiplied) alpha, as PNG demands; `.npy` and `.exr` for
//! measuring, see `floats`.

mod floats;
pub mod png;

use crate::atomic;
use crate::input::Refused;
use ::png::{BitDepth, ColorType};
use std::path::Path;

/// What a PNG file shows behind the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Backdrop {
    /// This colour; the file has no alpha.
    Colour([f64; 3]),
    /// Nothing: the file has straight alpha. Colours brighter than their alpha are cut to it.
    Transparent,
}

impl Default for Backdrop {
    /// Black, on which the picture is what was composited.
    fn default() -> Self {
        Backdrop::Colour([0.0; 3])
    }
}

/// Formats of picture files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// 8 or 16 bits per channel.
    Png,
    /// NumPy: height x width x 4 doubles, premultiplied.
    Npy,
    /// OpenEXR: single precision, premultiplied.
    Exr,
}

/// Extensions of the formats.
pub const EXTENSIONS: [&str; 3] = ["png", "npy", "exr"];

impl PictureFormat {
    /// The format that a file's extension names.
    pub fn of(path: &Path) -> Option<PictureFormat> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "png" => Some(PictureFormat::Png),
            "npy" => Some(PictureFormat::Npy),
            "exr" => Some(PictureFormat::Exr),
            _ => None,
        }
    }
}

/// Row-major RGBA picture, premultiplied on black; A = 1 - transmittance.
#[derive(Clone, Debug, Default, PartialEq)]
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

impl Depth {
    /// Steps of a channel from 0 to 1.
    pub fn steps(self) -> f64 {
        match self {
            Depth::Eight => 255.0,
            Depth::Sixteen => 65535.0,
        }
    }
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

    /// The picture as the bytes of a file; `depth` and `backdrop` are PNG's.
    pub fn encode(
        &self,
        format: PictureFormat,
        depth: Depth,
        backdrop: Backdrop,
    ) -> Result<Vec<u8>, Refused> {
        if self.width.checked_mul(self.height) != Some(self.pixels.len()) {
            return Err(Refused(format!(
                "a picture of {} x {} with {} pixels cannot be written",
                self.width,
                self.height,
                self.pixels.len()
            )));
        }
        match format {
            PictureFormat::Png => self.encode_png(depth, backdrop),
            PictureFormat::Npy => Ok(floats::npy(self)),
            PictureFormat::Exr => Ok(floats::exr(self)),
        }
    }

    fn encode_png(&self, depth: Depth, backdrop: Backdrop) -> Result<Vec<u8>, Refused> {
        let step = |value: f64| quantise(value, depth.steps());
        let pixels = self.pixels.iter();
        let (colour, values): (_, Vec<u16>) = match backdrop {
            Backdrop::Colour(behind) => {
                let opaque = pixels.flat_map(|pixel| over(pixel, behind).map(step));
                (ColorType::Rgb, opaque.collect())
            }
            Backdrop::Transparent => {
                let straight = pixels.flat_map(|pixel| straight(pixel).map(step));
                (ColorType::Rgba, straight.collect())
            }
        };
        let values = values.into_iter();
        let (depth, bytes): (_, Vec<u8>) = match depth {
            Depth::Eight => (BitDepth::Eight, values.map(|value| value as u8).collect()),
            Depth::Sixteen => (
                BitDepth::Sixteen,
                values.flat_map(u16::to_be_bytes).collect(),
            ),
        };
        png::encode([self.width, self.height], colour, depth, &bytes)
            .map_err(|error| Refused(format!("a picture that makes no PNG: {error}")))
    }

    /// The picture on an opaque colour.
    pub fn on(&self, colour: [f64; 3]) -> Picture {
        let pixels = self.pixels.iter().map(|pixel| {
            let [r, g, b] = over(pixel, colour);
            [r, g, b, 1.0]
        });
        Picture {
            pixels: pixels.collect(),
            ..*self
        }
    }

    /// Writes a PNG file; a failure or an interruption leaves the old file or none, never a part.
    pub fn write_png(&self, path: &Path, depth: Depth, backdrop: Backdrop) -> Result<(), Refused> {
        let bytes = self.encode(PictureFormat::Png, depth, backdrop)?;
        atomic::write(path, &bytes)
            .map_err(|error| Refused(format!("picture '{}': {error}", path.display())))
    }

    /// Reads a PNG file of 8 or 16 bits; colours are premultiplied, and without an alpha channel every pixel is opaque.
    pub fn read_png(path: &Path) -> Result<Picture, Refused> {
        let file = path.display();
        let bytes =
            std::fs::read(path).map_err(|error| Refused(format!("picture '{file}': {error}")))?;
        Picture::from_png(&bytes)
            .map_err(|error| Refused(format!("picture '{file}' is not a sound PNG: {error}")))
    }

    /// The same from the file's bytes.
    pub fn from_png(bytes: &[u8]) -> anyhow::Result<Picture> {
        let ([width, height], pixels) = png::decode(bytes)?;
        let share = |pixel: &[u16; 4]| pixel.map(|value| f64::from(value) / 65535.0);
        let pixels = pixels.iter().map(|pixel| premultiplied(share(pixel)));
        Ok(Picture {
            width,
            height,
            pixels: pixels.collect(),
        })
    }
}

/// A premultiplied pixel on an opaque colour.
fn over([r, g, b, a]: &[f64; 4], behind: [f64; 3]) -> [f64; 3] {
    let free = 1.0 - a.clamp(0.0, 1.0);
    [
        r + free * behind[0],
        g + free * behind[1],
        b + free * behind[2],
    ]
}

/// Colours divided by alpha.
fn straight(&[r, g, b, a]: &[f64; 4]) -> [f64; 4] {
    if a > 0.0 {
        [r / a, g / a, b / a, a]
    } else {
        [0.0; 4]
    }
}

fn premultiplied([r, g, b, a]: [f64; 4]) -> [f64; 4] {
    [r * a, g * a, b * a, a]
}

/// The nearest step of `0..=steps`; NaN becomes 0.
fn quantise(value: f64, steps: f64) -> u16 {
    (value.clamp(0.0, 1.0) * steps).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Picture {
        // No colour is brighter than its alpha, as a composited picture's are.
        let pixels = (0..35)
            .map(|i| f64::from(i) / 34.0)
            .map(|x| [0.5 * x, 0.5 * x * (1.0 - x), 0.5 * x * x, 0.5 * x])
            .collect();
        Picture {
            width: 7,
            height: 5,
            pixels,
        }
    }

    /// What a viewer shows on a background is what was composited, not darkened a second time.
    #[test]
    fn straight_alpha_over_a_background_is_the_picture_over_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ramp.png");
        for (depth, steps) in [(Depth::Eight, 255.0), (Depth::Sixteen, 65535.0)] {
            ramp()
                .write_png(&path, depth, Backdrop::Transparent)
                .unwrap();
            let read = Picture::read_png(&path).unwrap();
            assert_eq!((read.width, read.height), (7, 5));
            for (stored, original) in read.pixels.iter().zip(&ramp().pixels) {
                for channel in 0..4 {
                    // Colour and alpha are each half a step off.
                    let error = (stored[channel] - original[channel]).abs();
                    assert!(
                        error <= 1.01 / steps,
                        "{depth:?}: {stored:?} for {original:?}"
                    );
                }
            }
            let raw = image::open(&path).unwrap().into_rgba16();
            let [r, .., a] = raw.get_pixel(3, 2).0.map(f64::from);
            let [colour, .., alpha] = ramp().pixels[2 * 7 + 3];
            assert!(
                (r / 65535.0 - colour / alpha).abs() < 3.0 / steps,
                "{r} {a}"
            );
        }
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
    fn opaque_pictures_stand_on_their_background() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ramp.png");
        for (depth, steps) in [(Depth::Eight, 255.0), (Depth::Sixteen, 65535.0)] {
            for colour in [[0.0; 3], [1.0, 0.5, 0.0]] {
                ramp()
                    .write_png(&path, depth, Backdrop::Colour(colour))
                    .unwrap();
                assert!(!image::open(&path).unwrap().color().has_alpha());
                let read = Picture::read_png(&path).unwrap();
                for (stored, original) in read.pixels.iter().zip(&ramp().pixels) {
                    for channel in 0..3 {
                        let expected = original[channel] + (1.0 - original[3]) * colour[channel];
                        let error = (stored[channel] - expected.min(1.0)).abs();
                        assert!(error <= 0.500001 / steps, "{stored:?} for {original:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_extension_names_the_format() {
        let of = |name: &str| PictureFormat::of(Path::new(name));
        assert_eq!(of("a.PNG"), Some(PictureFormat::Png));
        assert_eq!(of("b/a.npy"), Some(PictureFormat::Npy));
        assert_eq!(of("a.exr"), Some(PictureFormat::Exr));
        for other in ["a.jpg", "a", "png", "a.ply"] {
            assert_eq!(of(other), None, "{other}");
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
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("broken.png");
        let names_it = || {
            let Refused(message) = Picture::read_png(&path).unwrap_err();
            message.contains("broken.png")
        };
        assert!(names_it());
        std::fs::write(&path, b"\x89PNG\r\n\x1a\nrubbish").unwrap();
        assert!(names_it());
        let mut torn = ramp();
        torn.pixels.pop();
        let torn = torn.encode(PictureFormat::Png, Depth::Eight, Backdrop::default());
        assert!(torn.unwrap_err().0.contains("34 pixels"));
    }
}
