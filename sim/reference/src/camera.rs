//! The camera: x right, y down, z forward; pixel (i, j) is sampled at (i + 0.5, j + 0.5).
//!
//! A world point `u` lies at `t = W u + d` in camera space (EWA 6.2.1) and at `fx t0 / t2 + cx` in the picture
//! (orthographic: `fx t0 + cx`). A camera comes from a point of view ([`Camera::look_at`]) or from a JSON file
//! ([`Camera::corrected_from_json_file`]); both go through the same checks, so that the engines meet sound cameras
//! only.

use std::fmt;
use std::path::Path;

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::input;
use crate::vector::{self, Vector};

/// Largest number of columns or rows.
pub const MAX_SIZE: usize = 16384;
/// `near` of a camera that does not say.
pub const DEFAULT_NEAR: f64 = 0.01;
/// `far` of a camera that does not say.
pub const DEFAULT_FAR: f64 = 1e10;

/// Largest deviation of the rotation's products of rows from those of the identity.
const ORTHONORMAL_TOLERANCE: f64 = 1e-4;
/// Deviations up to this are those of double precision itself and stay as they are.
const ORTHONORMAL_IN_DOUBLES: f64 = 1e-13;
/// A rotation whose entries are corrected by more than this is worth a line.
pub const NOTABLE_CORRECTION: f64 = 1e-6;
/// Smallest sine of the angle between the direction of view and the up direction.
const MIN_SINE_TO_UP: f64 = 1e-6;

/// Pinhole or orthographic camera in double precision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "CameraFile", try_from = "CameraFile")]
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

/// Why a camera cannot be used; the message names the file, the field and what is expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CameraError {
    /// The camera file, if the camera came from one.
    pub file: Option<String>,
    /// The offending field or option, if the problem belongs to one.
    pub field: Option<&'static str>,
    /// What is wrong and what is expected.
    pub problem: String,
}

impl CameraError {
    fn new(field: &'static str, problem: String) -> Self {
        CameraError {
            file: None,
            field: Some(field),
            problem,
        }
    }

    /// Of the camera and not of a field.
    pub(crate) fn whole(problem: String) -> Self {
        CameraError {
            file: None,
            field: None,
            problem,
        }
    }

    /// The same problem of a camera from a file.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        CameraError {
            file: Some(path.display().to_string()),
            ..self
        }
    }
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.file {
            Some(file) => write!(f, "camera file '{file}': ")?,
            None => write!(f, "camera: ")?,
        }
        if let Some(field) = self.field {
            write!(f, "'{field}' ")?;
        }
        f.write_str(&self.problem)
    }
}

impl std::error::Error for CameraError {}

/// The camera file as it stands on disk and in reports.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFile {
    width: u64,
    height: u64,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    /// Four rows of four.
    world_to_camera: Vec<f64>,
    #[serde(default = "default_near")]
    near: f64,
    /// Null, as a report writes it, is no limit.
    #[serde(default = "default_far")]
    far: Option<f64>,
    #[serde(default)]
    orthographic: bool,
}

impl From<Camera> for CameraFile {
    fn from(camera: Camera) -> CameraFile {
        let row = |i: usize| {
            let [x, y, z] = camera.rotation[i];
            [x, y, z, camera.translation[i]]
        };
        let rows = [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]];
        CameraFile {
            width: camera.width as u64,
            height: camera.height as u64,
            fx: camera.fx,
            fy: camera.fy,
            cx: camera.cx,
            cy: camera.cy,
            world_to_camera: rows.concat(),
            near: camera.near,
            far: camera.far.is_finite().then_some(camera.far),
            orthographic: camera.orthographic,
        }
    }
}

impl CameraFile {
    /// The camera, checked and corrected.
    fn sound(self) -> Result<(Camera, f64), CameraError> {
        let field = "world_to_camera";
        let matrix = self.world_to_camera.try_into();
        let matrix: [f64; 16] = matrix.map_err(|numbers: Vec<f64>| {
            let count = numbers.len();
            let problem = format!("has {count} numbers, but must have 16, row by row");
            CameraError::new(field, problem)
        })?;
        let row = |i: usize| [matrix[4 * i], matrix[4 * i + 1], matrix[4 * i + 2]];
        let last = &matrix[12..];
        check(last == [0.0, 0.0, 0.0, 1.0], field, || {
            format!("ends in the row {last:?}, but must end in 0 0 0 1 (row-major)")
        })?;
        Camera {
            width: usize::try_from(self.width).unwrap_or(usize::MAX),
            height: usize::try_from(self.height).unwrap_or(usize::MAX),
            fx: self.fx,
            fy: self.fy,
            cx: self.cx,
            cy: self.cy,
            rotation: [row(0), row(1), row(2)],
            translation: [matrix[3], matrix[7], matrix[11]],
            near: self.near,
            far: self.far.unwrap_or(f64::INFINITY),
            orthographic: self.orthographic,
        }
        .sound()
    }
}

impl TryFrom<CameraFile> for Camera {
    type Error = CameraError;

    fn try_from(file: CameraFile) -> Result<Camera, CameraError> {
        Ok(file.sound()?.0)
    }
}

/// What a camera is taken from in a report.json, or what tells that from a camera file.
#[derive(Deserialize)]
struct ReportFile<T> {
    camera: T,
}

fn default_near() -> f64 {
    DEFAULT_NEAR
}

fn default_far() -> Option<f64> {
    Some(DEFAULT_FAR)
}

impl Camera {
    /// A pinhole at the origin that looks along z, with the principal point in the picture's middle; the focal length
    /// is in pixels.
    pub fn centred(width: usize, height: usize, focal_length: f64) -> Camera {
        Camera {
            width,
            height,
            fx: focal_length,
            fy: focal_length,
            cx: 0.5 * width as f64,
            cy: 0.5 * height as f64,
            rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            translation: [0.0; 3],
            near: DEFAULT_NEAR,
            far: DEFAULT_FAR,
            orthographic: false,
        }
    }

    /// A perspective camera at `eye` that looks at `target`, with `up` pointing up in the picture.
    ///
    /// The rotation's rows are right = forward x up, down = forward x right, and forward. Pixels are square and
    /// the principal point is the picture's centre.
    pub fn look_at(
        eye: [f64; 3],
        target: [f64; 3],
        up: [f64; 3],
        vertical_fov_degrees: f64,
        width: usize,
        height: usize,
    ) -> Result<Camera, CameraError> {
        check_finite("eye", &eye)?;
        check_finite("target", &target)?;
        check_finite("up", &up)?;
        check_size("width", width)?;
        check_size("height", height)?;
        let degrees = vertical_fov_degrees;
        check(degrees > 0.0 && degrees < 180.0, "fov", || {
            format!("is {degrees} degrees, but must lie between 0 and 180, both excluded")
        })?;
        let forward = unit(vector::subtract(target, eye)).ok_or_else(|| {
            let problem =
                format!("{target:?} must lie away from the eye {eye:?}, at a finite distance");
            CameraError::new("target", problem)
        })?;
        let no_direction = || CameraError::new("up", format!("is {up:?}, which has no direction"));
        let up = unit(up).ok_or_else(no_direction)?;
        let sideways = vector::cross(forward, up);
        let is_apart = |_: &Vector| vector::length(sideways) > MIN_SINE_TO_UP;
        let right = unit(sideways).filter(is_apart).ok_or_else(|| {
            let problem =
                format!("{up:?} is parallel to the direction of view {forward:?}: choose another");
            CameraError::new("up", problem)
        })?;
        let rotation = [right, vector::cross(forward, right), forward];
        let focal_length = 0.5 * height as f64 / (0.5 * vertical_fov_degrees.to_radians()).tan();
        Camera {
            rotation,
            translation: vector::scale(-1.0, vector::transform(&rotation, eye)),
            ..Camera::centred(width, height, focal_length)
        }
        .checked()
    }

    /// Reads a camera from the text of a camera file, or of a report, which holds one.
    pub fn from_json_str(text: &str) -> Result<Camera, CameraError> {
        Ok(Camera::corrected_from_json_str(text)?.0)
    }

    /// Reads a camera from such a text and tells by how much an entry of its rotation was corrected.
    ///
    /// Files round rotations to a few digits. The engines take W for a rotation, one by its rows and another by its
    /// inverse, so that one that is a rotation only nearly would make them draw different views. What they get is the
    /// nearest rotation, seen from the same eye.
    pub fn corrected_from_json_str(text: &str) -> Result<(Camera, f64), CameraError> {
        let wrong =
            |error: serde_json::Error| CameraError::whole(format!("not a camera in JSON: {error}"));
        let is_report = serde_json::from_str::<ReportFile<IgnoredAny>>(text).is_ok();
        let file = if is_report {
            serde_json::from_str(text).map(|report: ReportFile<_>| report.camera)
        } else {
            serde_json::from_str(text)
        };
        let file: CameraFile = file.map_err(wrong)?;
        file.sound()
    }

    /// The camera, checked, with the nearest rotation, and by how much an entry of it was corrected.
    pub(crate) fn sound(self) -> Result<(Camera, f64), CameraError> {
        Ok(self.checked()?.corrected())
    }

    /// Reads a camera file and tells by how much an entry of its rotation was corrected.
    pub fn corrected_from_json_file(path: &Path) -> Result<(Camera, f64), CameraError> {
        let text = input::text(path, input::SETTINGS).map_err(|error| {
            CameraError::whole(format!("cannot be opened or read: {error}")).in_file(path)
        })?;
        Camera::corrected_from_json_str(&text).map_err(|error| error.in_file(path))
    }

    /// The view with the nearest rotation and the same eye, and the largest change of an entry.
    fn corrected(self) -> (Camera, f64) {
        if orthonormal_deviation(&self.rotation) <= ORTHONORMAL_IN_DOUBLES {
            return (self, 0.0);
        }
        let eye = self.eye();
        let rotation = nearest_rotation(&self.rotation);
        let pairs = rotation
            .iter()
            .flatten()
            .zip(self.rotation.iter().flatten());
        let change = pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        let translation = vector::scale(-1.0, vector::transform(&rotation, eye));
        let camera = Camera {
            rotation,
            translation,
            ..self
        };
        (camera, change)
    }

    /// The camera as the text of a camera file; reading it back gives the same camera.
    pub fn to_json(&self) -> String {
        // Numbers, a list and a flag always have a JSON form, so the error case does not arise.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// The eye in world space, `-W^-1 d`: the place that the view maps to 0, also where W is a rotation only nearly.
    pub fn eye(&self) -> [f64; 3] {
        vector::scale(-1.0, vector::solve(&self.rotation, self.translation))
    }

    /// The direction of view in world space.
    pub fn forward(&self) -> [f64; 3] {
        self.rotation[2]
    }

    /// A world point in camera space: `t = W u + d`, taken as `W (u - eye)`.
    ///
    /// Far from the world's origin W u and d are large and nearly opposite: their sum rounds every splat's depth by
    /// itself, and neighbours change places (`splatline stability --only scenes` shows by how much). The difference to
    /// the eye loses nothing that matters, and what the eye itself loses moves all splats together.
    pub fn to_camera(&self, point: [f64; 3]) -> [f64; 3] {
        vector::transform(&self.rotation, vector::subtract(point, self.eye()))
    }

    /// x / z and y / z of what is seen at a place of the picture, in pixels; in parallel projection x and y themselves.
    pub fn slopes(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [(u - self.cx) / self.fx, (v - self.cy) / self.fy]
    }

    /// The direction, of any length, in which a place in camera space is seen.
    pub fn ray(&self, position: Vector) -> Vector {
        if self.orthographic {
            [0.0, 0.0, 1.0]
        } else {
            position
        }
    }

    /// The same view with another number of pixels: the intrinsics are scaled with the picture.
    pub fn resized(&self, width: usize, height: usize) -> Result<Camera, CameraError> {
        check_size("width", self.width)?;
        check_size("height", self.height)?;
        let across = width as f64 / self.width as f64;
        let down = height as f64 / self.height as f64;
        Camera {
            width,
            height,
            fx: self.fx * across,
            fy: self.fy * down,
            cx: self.cx * across,
            cy: self.cy * down,
            ..self.clone()
        }
        .checked()
    }

    /// Whether every number is finite (`far` may be infinite) and the rotation is one. A camera that was placed by
    /// coordinates whose squares or differences overflow is not.
    pub fn is_sound(&self) -> bool {
        let far = self.far.min(f64::MAX);
        let sound = Camera {
            far,
            ..self.clone()
        };
        sound.checked().is_ok()
    }

    /// The same view enlarged about the picture's principal point.
    pub fn zoomed(&self, factor: f64) -> Result<Camera, CameraError> {
        Camera {
            fx: self.fx * factor,
            fy: self.fy * factor,
            ..self.clone()
        }
        .checked()
    }

    /// The camera itself, or what is wrong with it.
    fn checked(self) -> Result<Camera, CameraError> {
        check_size("width", self.width)?;
        check_size("height", self.height)?;
        check_focal_length("fx", self.fx)?;
        check_focal_length("fy", self.fy)?;
        check_finite("cx", &[self.cx])?;
        check_finite("cy", &[self.cy])?;
        check_rotation(&self.rotation)?;
        check_finite("world_to_camera", &self.translation)?;
        check_finite("near", &[self.near])?;
        let Camera { near, far, .. } = self;
        check(!far.is_nan(), "far", || {
            "is no number, but must be one, or null for no limit".to_owned()
        })?;
        check(self.orthographic || near > 0.0, "near", || {
            format!("is {near}, but must be positive for a perspective camera")
        })?;
        check(far > near, "far", || {
            format!("is {far}, but must be larger than near = {near}")
        })?;
        Ok(self)
    }
}

/// Every two rows by number, their product, and that of a rotation's rows.
fn products(rows: &[Vector; 3]) -> impl Iterator<Item = (usize, usize, f64, f64)> {
    let pairs = (0..3).flat_map(|i| (i..3).map(move |j| (i, j)));
    pairs.map(|(i, j)| {
        (
            i,
            j,
            vector::dot(rows[i], rows[j]),
            f64::from(u8::from(i == j)),
        )
    })
}

/// Largest deviation of a product of rows from that of a rotation.
fn orthonormal_deviation(rows: &[Vector; 3]) -> f64 {
    let deviations = products(rows).map(|(_, _, product, expected)| (product - expected).abs());
    deviations.fold(0.0, f64::max)
}

/// The rotation nearest to one that is nearly a rotation, in the sum of squares: the orthogonal factor of the polar
/// decomposition.
///
/// Newton's iteration `X' = (X + X^-T) / 2` squares the deviation; X^-T has the cross products of the rows over the
/// determinant as rows.
fn nearest_rotation(rows: &[Vector; 3]) -> [Vector; 3] {
    let mut rotation = *rows;
    for _ in 0..4 {
        let cofactors = vector::cofactors(rotation);
        let determinant = vector::dot(rotation[0], cofactors[0]);
        rotation = [0, 1, 2].map(|i: usize| {
            let inverse = vector::scale(1.0 / determinant, cofactors[i]);
            vector::scale(0.5, vector::add(rotation[i], inverse))
        });
    }
    rotation
}

/// `a` at length 1, unless it is zero or too long for a double.
fn unit(a: Vector) -> Option<Vector> {
    // SoftFloat by the largest coordinate first, so that squares neither overflow nor vanish.
    let largest = a
        .iter()
        .fold(0.0_f64, |largest, coordinate| largest.max(coordinate.abs()));
    if !(largest.is_normal() && vector::is_finite(a)) {
        return None;
    }
    let scaled = a.map(|coordinate| coordinate / largest);
    let length = vector::length(scaled);
    Some(scaled.map(|coordinate| coordinate / length))
}

fn check(
    holds: bool,
    field: &'static str,
    problem: impl FnOnce() -> String,
) -> Result<(), CameraError> {
    if holds {
        Ok(())
    } else {
        Err(CameraError::new(field, problem()))
    }
}

fn check_size(field: &'static str, size: usize) -> Result<(), CameraError> {
    check((1..=MAX_SIZE).contains(&size), field, || {
        format!("is {size}, but must be 1 to {MAX_SIZE} pixels")
    })
}

fn check_finite(field: &'static str, numbers: &[f64]) -> Result<(), CameraError> {
    check(numbers.iter().all(|n| n.is_finite()), field, || {
        format!("holds {numbers:?}, but must be finite")
    })
}

fn check_focal_length(field: &'static str, length: f64) -> Result<(), CameraError> {
    check(length.is_finite() && length > 0.0, field, || {
        format!("is {length}, but must be positive and finite (in pixels)")
    })
}

fn check_rotation(rows: &[Vector; 3]) -> Result<(), CameraError> {
    let field = "world_to_camera";
    for (i, j, product, expected) in products(rows) {
        // Written so that NaN is refused.
        let orthonormal = (product - expected).abs() <= ORTHONORMAL_TOLERANCE;
        check(orthonormal, field, || {
            format!(
                "is not a rotation: the product of rows {i} and {j} is {product}, but must be {expected}; \
                 remove scale and shear, and check that the matrix is row-major"
            )
        })?;
    }
    let handed = vector::dot(vector::cross(rows[0], rows[1]), rows[2]) >= 0.0;
    check(handed, field, || {
        "is a mirror image, not a rotation: its rows must point right, down and forward".to_owned()
    })
}
