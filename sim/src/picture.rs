//! A picture in double precision: RGBA, premultiplied on black, linear as stored.

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

impl Picture {
    /// A transparent black picture.
    pub fn new(width: usize, height: usize) -> Self {
        Picture {
            width,
            height,
            pixels: vec![[0.0; 4]; width * height],
        }
    }
}
