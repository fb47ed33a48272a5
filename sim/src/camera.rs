//! The camera: x right, y down, z forward; pixel (i, j) is sampled at (i + 0.5, j + 0.5).

/// Pinhole or orthographic camera in double precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Columns of the picture.
    pub width: usize,
    /// Rows of the picture.
    pub height: usize,
    /// Horizontal focal length in pixels (orthographic: pixels per scene unit).
    pub fx: f64,
    /// Vertical focal length in pixels (orthographic: pixels per scene unit).
    pub fy: f64,
    /// Principal point, pixels.
    pub cx: f64,
    /// Principal point, pixels.
    pub cy: f64,
    /// World-to-camera rotation, row-major.
    pub rotation: [[f64; 3]; 3],
    /// World-to-camera translation: t = W u + d.
    pub translation: [f64; 3],
    /// Splats with z <= near are culled.
    pub near: f64,
    /// Splats with z >= far are culled.
    pub far: f64,
    /// Parallel projection: u = fx x + cx.
    pub orthographic: bool,
}
