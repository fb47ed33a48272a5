//! The camera in ordinary numbers, and its way to the kernel's [`View`].
//!
//! A point `u` of the scene lies at `t = W u + d` in camera space (\[EWA\] eq. 22), x right, y down, z forward, and at
//! `fx t0 / t2 + cx` in the picture (orthographic: `fx t0 + cx`); pixel (i, j) is sampled at (i + 0.5, j + 0.5).

use super::{exp2, extended, eye, pixels, rotation, scaled};
use crate::math::Extended;
use crate::view::{Projection, RatioLimits, View};

/// Largest number of columns or rows.
const LARGEST: u16 = 32768;
/// Largest deviation of the rotation's products of rows from those of the identity.
const ORTHONORMAL: f64 = 1e-4;
/// Smallest sine of the angle between the direction of view and the up direction.
const SMALLEST_SINE: f64 = 1e-6;

/// A pinhole or orthographic camera. Fields may be set to anything; [`Camera::view`] checks them.
///
/// ```
/// use splatline::{Camera, CameraError};
///
/// let camera = Camera::look_at([3.0, -1.0, 0.0], [0.0; 3], [0.0, -1.0, 0.0], 45.0, [240, 240])?;
/// let view = camera.view()?; // What a renderer takes: integers only.
/// assert_eq!(view.window().pixels(), 240 * 240);
/// let wrong = Camera { near: -1.0, ..camera };
/// assert_eq!(wrong.view(), Err(CameraError::Near));
/// # Ok::<(), CameraError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Camera {
    /// Columns and rows of the picture, 1 to 32768 each.
    pub size: [u16; 2],
    /// Focal lengths in pixels (orthographic: pixels per scene unit), positive.
    pub focal: [f64; 2],
    /// Principal point in pixels from the picture's upper left corner.
    pub principal: [f64; 2],
    /// World-to-camera rotation W, row-major.
    pub rotation: [[f64; 3]; 3],
    /// World-to-camera translation d, scene units: t = W u + d.
    pub translation: [f64; 3],
    /// Splats with z <= near are culled; scene units, positive for perspective cameras.
    pub near: f64,
    /// Splats with z >= far are culled; scene units, infinite for no limit.
    pub far: f64,
    /// Perspective or orthographic.
    pub projection: Projection,
}

/// The first thing found wrong with a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CameraError {
    /// The size has an axis of 0 or of more than 32768 pixels.
    Size,
    /// The field of view is not between 0 and 180 degrees.
    FieldOfView,
    /// Eye and target coincide, or are no finite points.
    Direction,
    /// The up direction has no direction, or that of the view.
    Up,
    /// A focal length is not positive and finite.
    Focal,
    /// The principal point is not finite.
    Principal,
    /// The rotation's rows deviate by more than 1e-4 from a right-handed orthonormal frame.
    Rotation,
    /// The translation is not finite, or the matrix does not end in the row 0 0 0 1.
    Translation,
    /// `near` is not finite, or not positive though the camera is perspective.
    Near,
    /// `far` is not larger than `near`.
    Far,
}

impl Camera {
    /// A perspective camera at `eye` that looks at `target`, `up` pointing up in the picture. Pixels are square, the
    /// principal point is the picture's centre, near 0.01, far unlimited.
    ///
    /// The rotation's rows are right = forward x up, down = forward x right, and forward.
    pub fn look_at(
        eye: [f64; 3],
        target: [f64; 3],
        up: [f64; 3],
        vertical_fov_degrees: f64,
        size: [u16; 2],
    ) -> Result<Camera, CameraError> {
        if !(vertical_fov_degrees > 0.0 && vertical_fov_degrees < 180.0) {
            return Err(CameraError::FieldOfView);
        }
        let [columns, rows] = size.map(f64::from);
        let half_angle = 0.5 * vertical_fov_degrees.to_radians();
        let focal = 0.5 * rows * (libm::cos(half_angle) / libm::sin(half_angle));
        let rotation = frame(eye, target, up)?;
        Camera {
            size,
            focal: [focal; 2],
            principal: [0.5 * columns, 0.5 * rows],
            rotation,
            translation: rotation.map(|row| -dot(row, eye)),
            near: 0.01,
            far: f64::INFINITY,
            projection: Projection::Perspective,
        }
        .checked()
    }

    /// A perspective camera from its 4x4 world-to-camera matrix, row-major, and its intrinsics, as calibrations state
    /// them. Near 0.01, far unlimited.
    ///
    /// Files round matrices to a few digits: the camera gets the nearest rotation, seen from the same eye.
    pub fn from_matrix(
        world_to_camera: [[f64; 4]; 4],
        focal: [f64; 2],
        principal: [f64; 2],
        size: [u16; 2],
    ) -> Result<Camera, CameraError> {
        let [first, second, third, last] = world_to_camera;
        if last != [0.0, 0.0, 0.0, 1.0] {
            return Err(CameraError::Translation);
        }
        let rows = [first, second, third];
        let stated = Camera {
            size,
            focal,
            principal,
            rotation: rows.map(|[x, y, z, _]| [x, y, z]),
            translation: rows.map(|[_, _, _, offset]| offset),
            near: 0.01,
            far: f64::INFINITY,
            projection: Projection::Perspective,
        }
        .checked()?;
        let eye = stated.eye();
        let rotation = nearest_rotation(stated.rotation);
        Ok(Camera {
            rotation,
            translation: rotation.map(|row| -dot(row, eye)),
            ..stated
        })
    }

    /// The same camera with parallel rays: `u = pixels_per_unit t0 + cx`.
    pub const fn orthographic(mut self, pixels_per_unit: f64) -> Camera {
        self.focal = [pixels_per_unit; 2];
        self.projection = Projection::Orthographic;
        self
    }

    /// The same camera with other ends of the depths that it sees, scene units.
    pub const fn with_range(mut self, near: f64, far: f64) -> Camera {
        self.near = near;
        self.far = far;
        self
    }

    /// Where the camera stands: e = -W^-1 d, by the inverse and not the transpose, so that W (u - e) is W u + d for any
    /// W.
    pub fn eye(&self) -> [f64; 3] {
        let [a, b, c] = self.rotation;
        // Columns of the inverse are the rows' cross products over the determinant.
        let columns = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = dot(a, columns[0]);
        [0, 1, 2].map(|i: usize| {
            let along = columns.map(|column| column[i]);
            -dot(along, self.translation) / determinant
        })
    }

    /// The kernel's view.
    pub fn view(&self) -> Result<View, CameraError> {
        Ok(self.checked()?.quantised(0))
    }

    /// The kernel's view in units of `2^-scale_log2` scene units, without a check: numbers that are not finite count as
    /// 0, others saturate.
    ///
    /// Depths of surfaces, sheets and gathered points are kept in UQ9.23; a scene in the right unit fills that range.
    pub fn quantised(&self, scale_log2: i32) -> View {
        let focal_unit = match self.projection {
            Projection::Orthographic => scale_log2.saturating_neg(),
            Projection::Perspective => 0,
        };
        let ([low_x, high_x], [low_y, high_y]) = (self.limits(0), self.limits(1));
        let (rotation, rotation_rest) = rotation(self.rotation);
        let mut pose = eye(self.eye(), rotation_rest);
        if pose.position != [0; 3] {
            pose.exponent = pose.exponent.saturating_add(scale_log2);
        }
        let depth = |value: f64| {
            let number = extended(value);
            Extended {
                exponent: number.exponent.saturating_add(scale_log2),
                ..number
            }
        };
        View {
            rotation,
            pose,
            focal: self.focal.map(|f| scaled(f).scaled_by(focal_unit)),
            principal: self.principal.map(pixels),
            near: depth(self.near),
            far: if self.far.is_finite() {
                depth(self.far)
            } else {
                Extended::MAX
            },
            viewport: self.size,
            projection: self.projection,
            limits: RatioLimits {
                low: [low_x, low_y].map(pixels),
                high: [high_x, high_y].map(pixels),
            },
        }
    }

    /// Smallest and largest x/z of the frustum widened by 0.3 of its half width on each side (axis 0), or y/z (axis 1).
    fn limits(&self, axis: usize) -> [f64; 2] {
        let pick = |pair: [f64; 2]| if axis == 0 { pair[0] } else { pair[1] };
        let (size, focal, centre) = (
            pick(self.size.map(f64::from)),
            pick(self.focal),
            pick(self.principal),
        );
        let half = size / (2.0 * focal);
        [
            -(centre / focal + 0.3 * half),
            (size - centre) / focal + 0.3 * half,
        ]
    }

    fn checked(self) -> Result<Camera, CameraError> {
        let finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        let positive = |number: &f64| *number > 0.0 && number.is_finite();
        if self.size.iter().any(|size| *size == 0 || *size > LARGEST) {
            Err(CameraError::Size)
        } else if !self.focal.iter().all(positive) {
            Err(CameraError::Focal)
        } else if !finite(&self.principal) {
            Err(CameraError::Principal)
        } else if !is_rotation(&self.rotation) {
            Err(CameraError::Rotation)
        } else if !finite(&self.translation) {
            Err(CameraError::Translation)
        } else if !self.near.is_finite()
            || self.projection == Projection::Perspective && self.near <= 0.0
        {
            Err(CameraError::Near)
        } else if !matches!(
            self.far.partial_cmp(&self.near),
            Some(core::cmp::Ordering::Greater)
        ) {
            Err(CameraError::Far)
        } else {
            Ok(self)
        }
    }
}

/// Right, down and forward of a camera at `eye`.
fn frame(eye: [f64; 3], target: [f64; 3], up: [f64; 3]) -> Result<[[f64; 3]; 3], CameraError> {
    let [[x, y, z], [p, q, r]] = [eye, target];
    let forward = unit([p - x, q - y, r - z]).ok_or(CameraError::Direction)?;
    let up = unit(up).ok_or(CameraError::Up)?;
    let sideways = cross(forward, up);
    if dot(sideways, sideways) <= SMALLEST_SINE * SMALLEST_SINE {
        return Err(CameraError::Up);
    }
    let right = unit(sideways).ok_or(CameraError::Up)?;
    Ok([right, cross(forward, right), forward])
}

/// `a` at length 1, unless it is zero or not finite.
fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    // Scaled by a power of two near the largest coordinate first, so that squares neither overflow nor vanish.
    let largest = a.iter().fold(0.0f64, |m, value| m.max(value.abs()));
    if !a.iter().all(|value| value.is_finite()) || !largest.is_normal() {
        return None;
    }
    let by = exp2(-extended(largest).leading());
    let scaled = a.map(|value| value * by);
    let length = libm::sqrt(dot(scaled, scaled));
    Some(scaled.map(|value| value / length))
}

fn is_rotation(rows: &[[f64; 3]; 3]) -> bool {
    let [a, b, c] = *rows;
    let near = |value: f64, expected: f64| (value - expected).abs() <= ORTHONORMAL;
    near(dot(a, a), 1.0)
        && near(dot(b, b), 1.0)
        && near(dot(c, c), 1.0)
        && near(dot(a, b), 0.0)
        && near(dot(a, c), 0.0)
        && near(dot(b, c), 0.0)
        && dot(a, cross(b, c)) > 0.0
}

/// The rotation nearest to one that is nearly a rotation, in the sum of squares: the orthogonal factor of the polar
/// decomposition.
///
/// Newton's iteration `X' = (X + X^-T) / 2` squares the deviation, so that three steps reach the doubles' end from
/// 1e-4; X^-T has the cross products of the rows over the determinant as rows.
fn nearest_rotation(rows: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut rotation = rows;
    for _ in 0..4 {
        let [a, b, c] = rotation;
        let cofactors = [cross(b, c), cross(c, a), cross(a, b)];
        let inverse = 1.0 / dot(a, cofactors[0]);
        let mean = |[x, y, z]: [f64; 3], [p, q, r]: [f64; 3]| {
            [
                0.5 * (x + inverse * p),
                0.5 * (y + inverse * q),
                0.5 * (z + inverse * r),
            ]
        };
        rotation = [
            mean(a, cofactors[0]),
            mean(b, cofactors[1]),
            mean(c, cofactors[2]),
        ];
    }
    rotation
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

fn dot([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    a * x + b * y + c * z
}

impl core::fmt::Display for CameraError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            CameraError::Size => "camera: 'size' must be 1 to 32768 pixels on both axes",
            CameraError::FieldOfView => {
                "camera: the field of view must lie between 0 and 180 degrees, both excluded"
            }
            CameraError::Direction => {
                "camera: the target must lie away from the eye, both at a finite place"
            }
            CameraError::Up => "camera: 'up' must have a direction other than that of the view",
            CameraError::Focal => "camera: 'focal' must be positive and finite on both axes",
            CameraError::Principal => "camera: 'principal' must be finite",
            CameraError::Rotation => {
                "camera: the rows of 'rotation' must be a right-handed orthonormal frame to 1e-4 (world to camera, row-major)"
            }
            CameraError::Translation => {
                "camera: 'translation' must be finite, and a matrix end in the row 0 0 0 1 (row-major)"
            }
            CameraError::Near => {
                "camera: 'near' must be finite, and positive for a perspective camera"
            }
            CameraError::Far => "camera: 'far' must be larger than 'near'",
        })
    }
}

impl core::error::Error for CameraError {}
