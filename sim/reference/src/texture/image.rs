//! A texture: a photograph or a pattern, as linear RGB on a grid of texels.
//!
//! Texture coordinates are in texels from the upper left corner: texel (i, j) is the sample at (i + 0.5, j + 0.5). As
//! everywhere, values are linear as stored (no gamma applied).

use crate::camera::Camera;
use crate::cameras::lens::{Distortion, Lens};
use crate::memory;
use crate::picture::{Picture, png};
use crate::scene::{LoadError, Problem};
use anyhow::{Context, anyhow, ensure};
use std::path::Path;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Columns and rows of a texture at most: a 16384^2 photograph is already 6 GB of doubles.
const LARGEST_SIDE: usize = 8192;

/// A texture without a file: 96 x 96 texels of a checkerboard whose fields are 12 wide.
const CHECKERBOARD: &str = "checkerboard";

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

    /// Loads a PNG or JPEG file, whose alpha channel is ignored, or makes the texture named `checkerboard`.
    pub fn load(path: &Path) -> Result<Texture, LoadError> {
        if path == Path::new(CHECKERBOARD) {
            return Ok(Texture::from_pattern(96, 96, |u, v| {
                let field = (u / 12.0) as usize + (v / 12.0) as usize;
                let [light, dark] = [[0.65, 0.62, 0.55], [0.35, 0.36, 0.42]];
                if field.is_multiple_of(2) { light } else { dark }
            }));
        }
        decode(path).map_err(LoadError::about(path.display()))
    }

    /// Bilinear interpolation at texture coordinates; beyond the border the border's colour.
    pub fn sample(&self, place: [f64; 2]) -> [f64; 3] {
        bilinear(&self.texels, [self.width, self.height], place)
    }
}

/// A photograph as a picture: its alpha channel is kept, and colours are multiplied by it.
pub fn load_photograph(path: &Path) -> Result<Picture, LoadError> {
    let load = || {
        let bytes = crate::scene::read_file(path)?;
        if bytes.starts_with(JPEG) {
            let read = from_jpeg(&bytes).map_err(damaged)?;
            let opaque = |[r, g, b]: &[f64; 3]| [*r, *g, *b, 1.0];
            return Ok(Picture {
                width: read.width,
                height: read.height,
                pixels: read.texels.iter().map(opaque).collect(),
            });
        }
        Picture::from_png(&bytes).map_err(damaged)
    };
    load().map_err(LoadError::about(path.display()))
}

fn damaged(reason: Problem) -> Problem {
    anyhow!("picture: {reason}; give a sound .png or .jpg file")
}

/// The photograph as a pinhole of the lens' focal lengths and principal point would have taken it; transparent where it
/// has nothing to show. A photograph of another size than the lens' is a scaled one.
pub fn undistorted(photograph: &Picture, lens: &Lens) -> Picture {
    if lens.distortion == Distortion::default() {
        return photograph.clone();
    }
    let size = [photograph.width, photograph.height];
    let scale = [0, 1].map(|axis: usize| size[axis] as f64 / lens.size[axis] as f64);
    resampled(photograph, size, |centre| {
        let direction = lens.pinhole_direction([centre[0] / scale[0], centre[1] / scale[1]]);
        let seen = lens.pixel(direction);
        let place = [seen[0] * scale[0], seen[1] * scale[1]];
        let inside = (0..2).all(|axis| (0.0..size[axis] as f64).contains(&place[axis]));
        inside.then_some(place)
    })
}

/// What a lens shows of a picture that its wider pinhole ([`Lens::pinhole`]) has drawn; transparent where it shows
/// nothing.
pub fn distorted(drawn: &Picture, pinhole: &Camera, lens: &Lens) -> Picture {
    resampled(drawn, lens.size.map(|side| side as usize), |centre| {
        let [x, y] = lens.direction(centre)?;
        Some([pinhole.fx * x + pinhole.cx, pinhole.fy * y + pinhole.cy])
    })
}

/// A picture of what another one shows at the place that belongs to each pixel's centre; transparent without a place.
fn resampled(
    shown: &Picture,
    [width, height]: [usize; 2],
    place: impl Fn([f64; 2]) -> Option<[f64; 2]>,
) -> Picture {
    let mut picture = Picture::new(width, height);
    for (at, pixel) in picture.pixels.iter_mut().enumerate() {
        let centre = [at % width, at / width].map(|place| place as f64 + 0.5);
        if let Some(place) = place(centre) {
            *pixel = bilinear(&shown.pixels, [shown.width, shown.height], place);
        }
    }
    picture
}

/// Bilinear interpolation between pixels; beyond the border the border's.
fn bilinear<const N: usize>(
    pixels: &[[f64; N]],
    [width, height]: [usize; 2],
    [u, v]: [f64; 2],
) -> [f64; N] {
    let (columns, across) = between(u, width);
    let (rows, down) = between(v, height);
    let pixel = |x: usize, y: usize| pixels[rows[y] * width + columns[x]];
    std::array::from_fn(|c| {
        let row = |y: usize| pixel(0, y)[c] + across * (pixel(1, y)[c] - pixel(0, y)[c]);
        row(0) + down * (row(1) - row(0))
    })
}

/// The two texels on either side of a coordinate, and how far it lies towards the second.
fn between(coordinate: f64, size: usize) -> ([usize; 2], f64) {
    let place = (coordinate - 0.5).clamp(0.0, (size - 1) as f64);
    let first = place as usize;
    ([first, (first + 1).min(size - 1)], place - first as f64)
}

fn decode(path: &Path) -> Result<Texture, Problem> {
    let bytes = crate::scene::read_file(path)?;
    let texture = if bytes.starts_with(JPEG) {
        from_jpeg(&bytes)
    } else {
        from_png(&bytes)
    };
    let some = texture.and_then(|texture| {
        ensure!(!texture.texels.is_empty(), "it has no texels");
        Ok(texture)
    });
    some.map_err(damaged)
}

/// What a JPEG file begins with.
const JPEG: &[u8] = &[0xff, 0xd8, 0xff];

fn from_png(bytes: &[u8]) -> Result<Texture, Problem> {
    let ([width, height], pixels) = png::decode(bytes)?;
    ensure!(
        width.max(height) <= LARGEST_SIDE,
        "a side has more than {LARGEST_SIDE} texels"
    );
    let texel = |[r, g, b, _]: &[u16; 4]| [r, g, b].map(|value| f64::from(*value) / 65535.0);
    Ok(Texture {
        width,
        height,
        texels: pixels.iter().map(texel).collect(),
    })
}

/// As other readers do, small faults of a photograph are overlooked.
fn from_jpeg(bytes: &[u8]) -> Result<Texture, Problem> {
    let options = DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(LARGEST_SIDE)
        .set_max_height(LARGEST_SIDE)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers()?;
    let (width, height) = decoder.dimensions().context("it has no size")?;
    let what = format!("{width} x {height} texels");
    let each = 6 + size_of::<[f64; 3]>();
    memory::room_for_records((width * height) as u64, each, &what)?;
    let samples = decoder.decode()?;
    let texel = |texel: &[u8]| [0, 1, 2].map(|c: usize| f64::from(texel[c]) / 255.0);
    Ok(Texture {
        width,
        height,
        texels: samples.chunks_exact(3).map(texel).collect(),
    })
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

    /// A photograph whose values depend on the ray alone, taken by a lens: its pinhole shows the same function.
    #[test]
    fn an_undistorted_photograph_is_a_pinholes() {
        let lens = Lens {
            size: [120, 90],
            focal: [100.0, 100.0],
            principal: [60.0, 45.0],
            distortion: Distortion {
                radial: [0.15, 0.02, 0.0, 0.0],
                tangential: [0.002, -0.001],
                ..Distortion::default()
            },
        };
        let colour = |ray: [f64; 2]| 0.5 + 0.4 * ray[0] - 0.3 * ray[1] + 0.2 * ray[0] * ray[1];
        // The ray that the lens sees at a pixel of a photograph of half the size, by iteration.
        let ray = |at: usize| {
            let pixel = [at % 60, at / 60].map(|place| 2.0 * (place as f64 + 0.5));
            let bent = lens.pinhole_direction(pixel);
            (0..50).fold(bent, |ray, _| {
                let seen = lens.distortion.apply(ray);
                [0, 1].map(|axis: usize| ray[axis] + bent[axis] - seen[axis])
            })
        };
        let photograph = Picture {
            width: 60,
            height: 45,
            pixels: (0..60 * 45)
                .map(|at| [colour(ray(at)), 0.0, 0.0, 1.0])
                .collect(),
        };
        let straight = undistorted(&photograph, &lens);
        let mut shown = 0;
        for (at, [red, .., alpha]) in straight.pixels.iter().enumerate() {
            let (x, y) = (at % 60, at / 60);
            if *alpha == 0.0 || x < 2 || y < 2 || x > 57 || y > 42 {
                continue;
            }
            let pixel = [x, y].map(|place| 2.0 * (place as f64 + 0.5));
            let expected = colour(lens.pinhole_direction(pixel));
            assert!((red - expected).abs() < 2e-3, "{x} {y}: {red} {expected}");
            shown += 1;
        }
        assert!(shown > 1500, "{shown}");
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
        // A photograph by another writer, of which rounding leaves a step or two.
        let photograph = folder.path().join("photograph.jpg");
        image::RgbImage::from_pixel(16, 8, image::Rgb([200, 51, 30]))
            .save(&photograph)
            .unwrap();
        let texture = Texture::load(&photograph).unwrap();
        assert_eq!((texture.width, texture.height), (16, 8));
        for texel in texture.texels {
            let off = [200.0, 51.0, 30.0].iter().zip(texel);
            assert!(off.map(|(a, b)| (a - 255.0 * b).abs()).all(|off| off < 2.5));
        }
        let missing = Texture::load(&folder.path().join("none.jpg")).unwrap_err();
        assert!(missing.to_string().contains("none.jpg"));
    }
}
