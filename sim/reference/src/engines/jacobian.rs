//! The affine map from camera space to pixels at one ray, and the variance it gives a splat on the screen.
//!
//! EWA eq. 29 replaces the perspective map by its Jacobian. Without the third row, which only matters for the
//! integral along the ray, and in pixels instead of unit focal length it reads
//!
//! ```text
//!     J = | kx  0  -kx sx |      kx = fx / z,  ky = fy / z        (orthographic: k = f,
//!         |  0 ky  -ky sy |      sx = x / z,   sy = y / z          s = 0)
//! ```
//!
//! The slopes (sx, sy, 1) are the direction of the ray at which the map is taken. With the splat's axes a1 a2 a3
//! (one standard deviation each) as columns of A, the variance on the screen is V' + V^h with V' = M M^T, M = J A,
//! and V^h = h I for the low-pass filter.
//!
//! Its determinant is a sum of squares (Cauchy-Binet), never the difference a c - b^2:
//!
//! ```text
//!     det(M M^T + h I) = |m0 x m1|^2 + h (|m0|^2 + |m1|^2) + h^2
//! ```
//!
//! and m0 x m1 itself is not taken from the nearly parallel rows of a needle, but from the cofactors of A, which
//! are exact for orthogonal axes of any ratio:
//!
//! ```text
//!     m0 x m1 = ( (a2 x a3) . n, (a3 x a1) . n, (a1 x a2) . n ),   n = j0 x j1 = kx ky (sx, sy, 1)
//! ```

use crate::camera::Camera;
use crate::vector::{self, Vector};

/// The affine map from camera space to pixels at one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jacobian {
    /// Pixels per scene unit across the ray, horizontally and vertically: (kx, ky).
    pub scale: [f64; 2],
    /// Direction of the ray (sx, sy, 1), without the 1.
    pub slope: [f64; 2],
}

impl Jacobian {
    /// The map at depth `z` along the ray of slopes `slope`; in parallel projection neither matters.
    pub fn at(camera: &Camera, slope: [f64; 2], z: f64) -> Jacobian {
        if camera.orthographic {
            return Jacobian {
                scale: [camera.fx, camera.fy],
                slope: [0.0, 0.0],
            };
        }
        Jacobian {
            scale: [camera.fx / z, camera.fy / z],
            slope,
        }
    }

    /// The two rows of the map.
    pub fn rows(&self) -> [Vector; 2] {
        let [kx, ky] = self.scale;
        let [sx, sy] = self.slope;
        [[kx, 0.0, -kx * sx], [0.0, ky, -ky * sy]]
    }

    /// The determinant of the full 3x3 Jacobian, whose third row is the direction of the ray (EWA eq. 29):
    /// square pixels per square scene unit across the ray.
    pub fn determinant(&self) -> f64 {
        let [kx, ky] = self.scale;
        let [sx, sy] = self.slope;
        kx * ky * vector::length([sx, sy, 1.0])
    }
}

/// A splat's axes in camera space, with the cofactors that every determinant needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraAxes {
    /// The axes a1 a2 a3, scene units.
    pub axes: [Vector; 3],
    /// a2 x a3, a3 x a1, a1 x a2.
    pub cofactors: [Vector; 3],
}

impl CameraAxes {
    /// Rotates the axes of a splat into camera space.
    pub fn new(world_axes: &[Vector; 3], camera: &Camera) -> CameraAxes {
        // The cofactors turn with the axes; taken in world space they keep the exactness of axes that lie there
        // along the coordinates.
        let cofactors = vector::cofactors(*world_axes);
        let rotate = |a: Vector| vector::transform(&camera.rotation, a);
        CameraAxes {
            axes: world_axes.map(rotate),
            cofactors: cofactors.map(rotate),
        }
    }

    /// The coordinate `i` of all three axes: row `i` of A.
    pub fn row(&self, i: usize) -> Vector {
        self.axes.map(|axis| axis[i])
    }
}

/// Variance matrix (a b; b c) of a footprint on the screen, square pixels, with its determinant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenVariance {
    /// Variance along x.
    pub a: f64,
    /// Covariance.
    pub b: f64,
    /// Variance along y.
    pub c: f64,
    /// a c - b^2, computed as a sum of squares.
    pub determinant: f64,
    /// The determinant without the low-pass filter.
    pub sharp_determinant: f64,
}

impl ScreenVariance {
    /// V' + V^h of a splat under the affine map `jacobian` and a low-pass filter of variance `low_pass`.
    pub fn new(splat: &CameraAxes, jacobian: &Jacobian, low_pass: f64) -> ScreenVariance {
        let [j0, j1] = jacobian.rows();
        let m0 = splat.axes.map(|axis| vector::dot(j0, axis));
        let m1 = splat.axes.map(|axis| vector::dot(j1, axis));
        let normal = [jacobian.slope[0], jacobian.slope[1], 1.0];
        let area = jacobian.scale[0] * jacobian.scale[1];
        let cross = splat
            .cofactors
            .map(|cofactor| area * vector::dot(cofactor, normal));
        let (squared0, squared1) = (vector::dot(m0, m0), vector::dot(m1, m1));
        let sharp_determinant = vector::dot(cross, cross);
        ScreenVariance {
            a: squared0 + low_pass,
            b: vector::dot(m0, m1),
            c: squared1 + low_pass,
            sharp_determinant,
            determinant: sharp_determinant + low_pass * (squared0 + squared1) + low_pass * low_pass,
        }
    }

    /// The conic Q = (V' + V^h)^-1 as (A, B, C) of A x^2 + 2 B x y + C y^2.
    pub fn conic(&self) -> [f64; 3] {
        [
            self.c / self.determinant,
            -self.b / self.determinant,
            self.a / self.determinant,
        ]
    }

    /// The radial index r = x^T Q x at an offset from the centre.
    ///
    /// Written with the square completed, as a sum of two positive terms, so that a needle's small r is not the
    /// difference of large numbers.
    pub fn radial_index(&self, offset: [f64; 2]) -> f64 {
        let [x, y] = offset;
        let along_row = x - self.b / self.c * y;
        along_row * along_row * (self.c / self.determinant) + y * y / self.c
    }

    /// Whether an inverse exists and everything is finite.
    pub fn is_regular(&self) -> bool {
        let numbers = [self.a, self.b, self.c, self.determinant];
        let [a, b, c] = self.conic();
        self.determinant > 0.0
            && numbers
                .iter()
                .chain(&[a, b, c])
                .all(|number| number.is_finite())
            && a > 0.0
            && c > 0.0
    }

    /// By which factor the low-pass filter would lift the volume of a Gaussian of constant peak, inverted: sqrt(det V'
    /// / det(V' + V^h)).
    pub fn compensation(&self) -> f64 {
        (self.sharp_determinant / self.determinant).sqrt()
    }

    /// The peak of a Gaussian of unit volume on the screen: 1 / (2 pi sqrt(det)), per square pixel.
    pub fn normalised_peak(&self) -> f64 {
        1.0 / (std::f64::consts::TAU * self.determinant.sqrt())
    }
}
