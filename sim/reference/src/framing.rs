//! The camera where nobody names one: far enough away that a ball around the scene fits the picture.
//!
//! The rule, for every kind of scene: the ball holds every centre but strays (farther from the middle than
//! `STRAY_DISTANCE` times the distance that holds 95 % of the centres; captures have a few such splats kilometres away,
//! and framing them would show nothing else). The eye lies on the scene's front, at the distance where the ball touches
//! the narrower side of the picture. Up and front are conventions of the kind of scene ([`FramingInput`]); neither can
//! be read off a file, so both are printed.

mod fill;

use crate::camera::{Camera, CameraError};
use crate::scene::points::SurfaceScene;
use crate::scene::{Bounds, Scene, Weight, across};
use crate::vector::{self, Vector};

/// Share of the centres that may lie outside the box whose middle is the ball's first guess, per side and axis.
const OUTERMOST: f64 = 0.02;
/// Share of the centres whose distance is what strays are measured by.
const MOST: f64 = 0.95;
/// Distance of a stray, in distances that hold [`MOST`] of the centres.
const STRAY_DISTANCE: f64 = 4.0;
/// Room around the ball.
const MARGIN: f64 = 1.05;
/// Vertical field of view unless something else is asked for, degrees.
pub const USUAL_FOV: f64 = 45.0;
/// How far above the ground a height field is seen from, degrees.
const OBLIQUE: f64 = 31.0;

/// A ball around a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Ball {
    /// Middle.
    pub centre: Vector,
    /// Distance of the farthest centre, above 0.
    pub radius: f64,
    /// Centres that were left out.
    pub strays: usize,
}

/// What framing goes by.
#[derive(Clone, Debug, PartialEq)]
pub struct FramingInput {
    /// What is to be seen.
    pub ball: Ball,
    /// Up in the picture.
    pub up: Vector,
    /// From the ball to the eye.
    pub front: Vector,
    /// Elevation of the eye over `front` unless an orbit says otherwise, degrees.
    pub elevation: f64,
    /// Why up and front are these.
    pub reason: &'static str,
}

/// A change of the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Turn around up, counter-clockwise seen from above, degrees.
    pub azimuth: f64,
    /// Above the horizon, degrees, less than 90 either way.
    pub elevation: f64,
}

impl Ball {
    /// The ball around some places; `size` is the extent of a scene of one place.
    pub fn around(places: impl Iterator<Item = Vector> + Clone, size: f64) -> Ball {
        let Some(guess) = Bounds::around(places.clone(), OUTERMOST) else {
            return Ball {
                centre: [0.0; 3],
                radius: 1.0,
                strays: 0,
            };
        };
        let guess = guess.centre();
        let distance = |from: Vector, place: Vector| vector::length(vector::subtract(place, from));
        let distances = places.clone().map(|place| distance(guess, place));
        let mut distances: Vec<f64> = distances.collect();
        let last = distances.len() - 1;
        let most = (last as f64 * MOST).ceil() as usize;
        let usual = *distances.select_nth_unstable_by(most, f64::total_cmp).1;
        let limit = STRAY_DISTANCE * usual;
        let strays = distances.len() - distances.iter().filter(|d| **d <= limit).count();
        drop(distances);
        let near = places.filter(|place| distance(guess, *place) <= limit);
        // Half of the places lie within the box's middle, so that some are near.
        let centre = Bounds::around(near.clone(), 0.0).map_or(guess, |near| near.centre());
        let radius = near.map(|place| distance(centre, place));
        let radius = radius.fold(0.0, f64::max);
        let least = if size > 0.0 && size.is_finite() {
            size
        } else {
            1.0
        };
        Ball {
            centre,
            radius: if radius > 0.0 { radius } else { least },
            strays,
        }
    }
}

impl FramingInput {
    /// How a scene of splats is framed: volumes along +z, captures across their thinner horizontal side.
    pub fn of_scene(scene: &Scene, up: Option<Vector>) -> FramingInput {
        // Not as a list: of four million splats it would be 100 MB beside them.
        let places = scene.splats.iter().map(|splat| splat.centre);
        let longest = scene.splats.first().map_or(1.0, |splat| {
            3.0 * splat
                .axes
                .iter()
                .map(|axis| vector::length(*axis))
                .fold(0.0, f64::max)
        });
        let ball = Ball::around(places.clone(), longest);
        let chosen = up.unwrap_or(scene.up);
        let (front, reason) = match scene.weight {
            Weight::Mass => ([0.0, 0.0, -1.0], "a volume is seen along +z with -y up"),
            Weight::Opacity => (
                thinner_side(places, &ball, chosen),
                "a capture is seen across its thinner horizontal side; -y is up in trainers' files, +y in glTF",
            ),
        };
        FramingInput {
            ball,
            up: chosen,
            front: level(front, chosen),
            elevation: 0.0,
            reason,
        }
    }

    /// How points of a surface are framed: clouds across their thinner horizontal side, height fields from the south
    /// and above.
    pub fn of_surface(
        scene: &SurfaceScene,
        is_height_field: bool,
        up: Option<Vector>,
    ) -> FramingInput {
        let places = scene.points.iter().map(|point| point.centre);
        let ball = Ball::around(places.clone(), 3.0 * scene.radius);
        let chosen = up.unwrap_or(scene.up);
        let (front, elevation, reason) = if is_height_field {
            (
                [0.0, -1.0, 0.0],
                OBLIQUE,
                "a height field is seen from the south and above",
            )
        } else {
            let front = thinner_side(places, &ball, chosen);
            (front, 0.0, cloud_reason(scene.up))
        };
        FramingInput {
            ball,
            up: chosen,
            front: level(front, chosen),
            elevation,
            reason,
        }
    }

    /// A camera that shows the whole ball.
    pub fn camera(
        &self,
        orbit: Option<Orbit>,
        fov: f64,
        width: usize,
        height: usize,
    ) -> Result<Camera, CameraError> {
        let half = 0.5 * fov.to_radians();
        let narrower = (half.tan() * (width as f64 / height as f64).min(1.0)).atan();
        let distance = MARGIN * self.ball.radius / narrower.sin();
        let orbit = orbit.unwrap_or(Orbit {
            azimuth: 0.0,
            elevation: self.elevation,
        });
        let towards = turned(self.front, self.up, orbit);
        let eye = vector::add(self.ball.centre, vector::scale(distance, towards));
        let squares = [
            distance * distance,
            vector::dot(eye, eye),
            vector::dot(self.ball.centre, self.ball.centre),
        ];
        if !squares.iter().all(|square| square.is_finite()) {
            let problem = "the scene's coordinates overflow when they are squared";
            return Err(CameraError::whole(problem.to_owned()));
        }
        let camera = Camera::look_at(eye, self.ball.centre, self.up, fov, width, height)?;
        // The usual near plane would swallow a tiny scene.
        let free = distance - self.ball.radius;
        Ok(Camera {
            near: camera.near.min(0.1 * free),
            ..camera
        })
    }

    /// Such a camera moved so that a capture fills the picture, and how many outlying splats it leaves outside; other
    /// scenes keep theirs.
    pub fn filled(&self, camera: Camera, scene: &Scene) -> (Camera, usize) {
        if scene.is_capture() {
            fill::filled(camera, scene, self.ball.centre)
        } else {
            (camera, 0)
        }
    }

    /// The rule and what it chose.
    pub fn describe(&self, fov: f64) -> String {
        let strays = match self.ball.strays {
            0 => String::new(),
            count => format!(
                ", {count} strays beyond {STRAY_DISTANCE} times the distance of 95 % not framed"
            ),
        };
        format!(
            "camera: whole scene (ball of radius {:.4} around {}{strays}), up {}, seen from {}, {fov} degrees; {} \
             (--up, --orbit, --zoom, --fov or --camera change it)",
            self.ball.radius,
            place(self.ball.centre),
            direction(self.up),
            direction(self.front),
            self.reason
        )
    }
}

/// A camera turned around an axis through `centre`, counter-clockwise seen from above, degrees.
pub fn turned_camera(camera: &Camera, centre: Vector, up: Vector, azimuth: f64) -> Camera {
    let up = unit(up).unwrap_or([0.0, 0.0, 1.0]);
    let (sine, cosine) = azimuth.to_radians().sin_cos();
    let turn = |v: Vector| {
        let along = vector::scale(vector::dot(v, up), up);
        let level = vector::scale(cosine, vector::subtract(v, along));
        let sideways = vector::scale(sine, vector::cross(up, v));
        vector::add(along, vector::add(level, sideways))
    };
    let eye = vector::add(centre, turn(vector::subtract(camera.eye(), centre)));
    let rotation = camera.rotation.map(turn);
    Camera {
        rotation,
        translation: vector::scale(-1.0, vector::transform(&rotation, eye)),
        ..camera.clone()
    }
}

/// Turned around `up` and then raised towards it; lengths 1, `front` level.
fn turned(front: Vector, up: Vector, orbit: Orbit) -> Vector {
    let up = unit(up).unwrap_or([0.0, 0.0, 1.0]);
    let sideways = vector::cross(up, front);
    let (azimuth, elevation) = (orbit.azimuth.to_radians(), orbit.elevation.to_radians());
    let level = vector::add(
        vector::scale(azimuth.cos(), front),
        vector::scale(azimuth.sin(), sideways),
    );
    vector::add(
        vector::scale(elevation.cos(), level),
        vector::scale(elevation.sin(), up),
    )
}

/// An eye moved on its sphere around the target.
pub fn orbited(eye: Vector, target: Vector, up: Vector, orbit: Orbit) -> Vector {
    let offset = vector::subtract(eye, target);
    let distance = vector::length(offset);
    let Some(up) = unit(up) else { return eye };
    let height = vector::dot(offset, up);
    let flat = vector::subtract(offset, vector::scale(height, up));
    let Some(front) = unit(flat) else { return eye };
    let before = height.atan2(vector::length(flat)).to_degrees();
    // Never over the pole, where no picture has an up.
    let elevation = (before + orbit.elevation).clamp(-89.0, 89.0);
    let towards = turned(front, up, Orbit { elevation, ..orbit });
    vector::add(target, vector::scale(distance, towards))
}

/// Why a cloud is seen so.
fn cloud_reason(up: Vector) -> &'static str {
    if up == [0.0, 0.0, 1.0] {
        "a cloud is seen across its thinner horizontal side; z is up in scanners' files"
    } else {
        "a cloud is seen across its thinner horizontal side, and stands on its flat base"
    }
}

/// The horizontal axis along which the framed places extend least, towards its positive end.
fn thinner_side(places: impl Iterator<Item = Vector> + Clone, ball: &Ball, up: Vector) -> Vector {
    let extent = |axis: usize| {
        let is_framed =
            |place: &Vector| vector::length(vector::subtract(*place, ball.centre)) <= ball.radius;
        let framed = places.clone().filter(is_framed);
        let offsets = framed.map(|place| (place[axis] - ball.centre[axis]).abs());
        offsets.fold(0.0, f64::max)
    };
    let mut front = [0.0; 3];
    front[across(up, extent)] = 1.0;
    front
}

/// The level part of `front` at length 1; another axis if it is up itself.
fn level(front: Vector, up: Vector) -> Vector {
    let up = unit(up).unwrap_or([0.0, 0.0, 1.0]);
    let flat = |v: Vector| vector::subtract(v, vector::scale(vector::dot(v, up), up));
    let axes = [front, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let level = axes
        .map(flat)
        .into_iter()
        .find(|v| vector::length(*v) > 0.1);
    level.and_then(unit).unwrap_or(front)
}

fn unit(v: Vector) -> Option<Vector> {
    let length = vector::length(v);
    (length.is_finite() && length > 0.0).then(|| vector::scale(1.0 / length, v))
}

fn place(v: Vector) -> String {
    let [x, y, z] = v.map(|coordinate| format!("{coordinate:.4}"));
    format!("{x},{y},{z}")
}

/// `-y` for an axis, numbers for what is none.
pub fn direction(v: Vector) -> String {
    let Some(v) = unit(v) else { return place(v) };
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        if v[axis].abs() > 0.9999 {
            return format!("{}{name}", if v[axis] < 0.0 { '-' } else { '+' });
        }
    }
    place(v)
}

#[cfg(test)]
#[path = "framing_tests.rs"]
mod tests;
