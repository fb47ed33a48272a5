//! A texture: a photograph or a pattern, as linear RGB on a grid of texels.
//!
//! Texture coordinates are in texels from the upper left corner: texel (i, j) is the sample at (i + 0.5, j + 0.5). As everywhere,
//! values are linear as stored (no gamma applied).

use crate::scene::{LoadError, Problem};
use image::{DynamicImage, ImageReader, Limits};
use std::path::Path;

/// Columns and rows of a texture at most: a 16384^2 photograph is already 6 GB of doubles.
const LARGEST_SIDE: u32 = 8192;

/// Colours on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear RGB, row-major.
    pub texels: Vec<[f64; 3]>,
}

impl Texture {
    /// The pattern that has colour `colour(u, v)` at the texel whose centre is (u, v).
    pub fn from_pattern(
        width: usize,
        height: usize,
        colour: impl Fn(f64, f64) -> [f64; 3],
    ) -> Texture {
        let texels = (0..width * height).map(|index| {
            let (column, row) = (index % width, index / width);
            colour(column as f64 + 0.5, row as f64 + 0.5)
        });
        Texture {
            width,
            height,
            texels: texels.collect(),
        }
    }

    /// Loads a PNG or JPEG file; an alpha channel is ignored.
    pub fn load(path: &Path) -> Result<Texture, LoadError> {
        decode(path).map_err(|problem| problem.of(path.display().to_string()))
    }

    /// Bilinear interpolation at texture coordinates; beyond the border the border's colour.
    pub fn sample(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let (columns, across) = between(u, self.width);
        let (rows, down) = between(v, self.height);
        let blend = |a: [f64; 3], b: [f64; 3], part: f64| {
            [0, 1, 2].map(|c: usize| a[c] + part * (b[c] - a[c]))
        };
        let row = |y: usize| {
            let at = |x: usize| self.texels[y * self.width + x];
            blend(at(columns[0]), at(columns[1]), across)
        };
        blend(row(rows[0]), row(rows[1]), down)
    }
}

/// The two texels on either side of a coordinate, and how far it lies towards the second.
fn between(coordinate: f64, size: usize) -> ([usize; 2], f64) {
    let place = (coordinate - 0.5).clamp(0.0, (size - 1) as f64);
    let first = place as usize;
    ([first, (first + 1).min(size - 1)], place - first as f64)
}

fn decode(path: &Path) -> Result<Texture, Problem> {
    let bytes = crate::scene::read_file(path)?;
    let damaged = |reason: String| {
        Problem::malformed(
            "picture",
            reason,
            "give a sound .png or .jpg file as texture",
        )
    };
    let mut reader = ImageReader::new(std::io::Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| damaged(error.to_string()))?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(LARGEST_SIDE);
    limits.max_image_height = Some(LARGEST_SIDE);
    reader.limits(limits);
    let picture = reader
        .decode()
        .map_err(|error| damaged(error.to_string()))?;
    if picture.width() == 0 || picture.height() == 0 {
        return Err(damaged("it has no texels".to_owned()));
    }
    Ok(from_picture(picture))
}

fn from_picture(picture: DynamicImage) -> Texture {
    let picture = picture.into_rgb16();
    let texels = picture.pixels();
    Texture {
        width: picture.width() as usize,
        height: picture.height() as usize,
        texels: texels
            .map(|texel| texel.0.map(|value| f64::from(value) / 65535.0))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bilinear_samples_meet_texels_at_their_centres_and_stay_at_the_border() {
        let texture = Texture::from_pattern(4, 3, |u, v| [u / 4.0, v / 3.0, 0.25]);
        for index in 0..12 {
            let place = [(index % 4) as f64 + 0.5, (index / 4) as f64 + 0.5];
            assert_eq!(texture.sample(place), texture.texels[index]);
        }
        let middle = texture.sample([2.0, 1.75]);
        assert!((middle[0] - 0.5).abs() < 1e-15 && (middle[1] - 1.75 / 3.0).abs() < 1e-15);
        assert_eq!(texture.sample([-9.0, -9.0]), texture.texels[0]);
        assert_eq!(texture.sample([9.0, 9.0]), texture.texels[11]);
    }

    #[test]
    fn a_file_is_read_as_stored_and_a_damaged_one_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("photograph.png");
        image::RgbImage::from_pixel(2, 1, image::Rgb([255, 51, 0]))
            .save(&path)
            .unwrap();
        let texture = Texture::load(&path).unwrap();
        assert_eq!((texture.width, texture.height), (2, 1));
        assert_eq!(texture.texels, [[1.0, 0.2, 0.0]; 2]);
        std::fs::write(&path, b"\x89PNG\r\n\x1a\nrubbish").unwrap();
        let message = Texture::load(&path).unwrap_err().to_string();
        assert!(
            message.contains("photograph.png") && message.contains(".jpg"),
            "{message}"
        );
        let missing = Texture::load(&folder.path().join("none.jpg")).unwrap_err();
        assert!(missing.to_string().contains("none.jpg"));
    }
}
