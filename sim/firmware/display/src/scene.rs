//! The scene in ordinary numbers: a flower over a disc of water, with sparks above it. Made one splat at a time, so
//! that it takes no memory.

use splatline::{Camera, CameraError, Gaussian};

const PETALS: u16 = 14;
const SPARKS: u16 = 24;
/// Splats of the scene: water, petals in two rings, the middle, sparks.
pub const SPLATS: u16 = 2 + 2 * PETALS + SPARKS;
/// Columns and rows of the display: the size of many with an ST7735.
pub const SIZE: [u16; 2] = [160, 128];

/// A little above the flower, looking down at it.
pub fn camera() -> Result<Camera, CameraError> {
    let (eye, target, up) = ([0.0, -2.0, -4.2], [0.0, -0.05, 0.0], [0.0, -1.0, 0.0]);
    Camera::look_at(eye, target, up, 40.0, SIZE)
}

/// One splat of the scene; numbers beyond [`SPLATS`] are sparks, too.
pub fn splat(number: u16) -> Gaussian {
    match number {
        0 => Gaussian {
            mean: [0.0, 0.75, 0.0],
            scales: [1.1, 0.03, 1.1],
            opacity: 0.9,
            colour: [0.04, 0.16, 0.3],
            ..Gaussian::UNIT
        },
        1 => Gaussian {
            mean: [0.0, 0.05, 0.0],
            scales: [0.2, 0.14, 0.2],
            opacity: 0.95,
            colour: [1.0, 0.78, 0.2],
            ..Gaussian::UNIT
        },
        _ if number < 2 + 2 * PETALS => petal(number - 2),
        _ => spark(number.saturating_sub(2 + 2 * PETALS)),
    }
}

/// A leaf that points outwards and up, in the lower or the upper ring.
fn petal(number: u16) -> Gaussian {
    let upper = number >= PETALS;
    let step = core::f32::consts::TAU / f32::from(PETALS);
    let angle = step * (f32::from(number) + if upper { 0.5 } else { 0.0 });
    let (radius, height, lift, shade) = if upper {
        (0.52, 0.0, 0.75, 0.85)
    } else {
        (0.85, 0.25, 0.3, 0.45)
    };
    let (sine, cosine) = libm::sincosf(angle);
    Gaussian {
        mean: [radius * cosine, height, radius * sine],
        rotation: product(about_y(-angle), about_z(-lift)),
        scales: [0.3, 0.012, 0.11],
        opacity: 0.9,
        colour: [0.95, 0.2 + 0.3 * shade, shade],
    }
}

/// A small ball on a spiral that rises from the middle.
fn spark(number: u16) -> Gaussian {
    let along = f32::from(number) / f32::from(SPARKS);
    let (sine, cosine) = libm::sincosf(9.0 * along);
    let radius = 0.25 + 0.9 * along;
    Gaussian {
        mean: [radius * cosine, -0.35 - 0.75 * along, radius * sine],
        scales: [0.035; 3],
        opacity: 0.9 - 0.5 * along,
        colour: [1.0, 0.9 - 0.5 * along, 0.5],
        ..Gaussian::UNIT
    }
}

fn about_y(angle: f32) -> [f32; 4] {
    let (sine, cosine) = libm::sincosf(0.5 * angle);
    [cosine, 0.0, sine, 0.0]
}

fn about_z(angle: f32) -> [f32; 4] {
    let (sine, cosine) = libm::sincosf(0.5 * angle);
    [cosine, 0.0, 0.0, sine]
}

/// The turn `b`, then the turn `a`.
fn product([aw, ax, ay, az]: [f32; 4], [bw, bx, by, bz]: [f32; 4]) -> [f32; 4] {
    [
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]
}
