//! Surfaces without a file: spheres and sheets of evenly spread points, some of which have names on the command line.

use super::{HEXAGONAL_CELL, Material, SurfacePoint, SurfaceScene, share_of_area, tangents};
use crate::vector::{self, Vector};

/// What all points of a synthetic surface share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// Linear RGB.
    pub colour: [f64; 3],
    /// Opacity.
    pub opacity: f64,
    /// Row of the material table.
    pub material: u8,
}

impl Paint {
    /// An opaque colour.
    pub fn opaque(colour: [f64; 3]) -> Paint {
        Paint {
            colour,
            opacity: 1.0,
            material: 0,
        }
    }
}

/// The surface of that name: `sphere`, opaque and half of it glossy, or `glass`, three sheets that cross each other in
/// a translucent sphere.
pub fn named(name: &str) -> Option<SurfaceScene> {
    match name {
        "sphere" => Some(scene(name, glossy_sphere())),
        "glass" => Some(scene(name, crossing_sheets())),
        _ => None,
    }
}

fn glossy_sphere() -> Vec<SurfacePoint> {
    let mut points = sphere([0.0; 3], 1.0, 6_000, Paint::opaque([0.9, 0.75, 0.5]));
    for point in &mut points {
        let [x, y, z] = point.normal;
        point.material = u8::from(x > 0.0);
        point.colour = [0.5 + 0.4 * x, 0.5 + 0.4 * y, 0.5 + 0.4 * z];
    }
    points
}

fn crossing_sheets() -> Vec<SurfacePoint> {
    let spacing = 0.05;
    let glass = |colour: [f64; 3], opacity: f64| Paint {
        colour,
        opacity,
        material: 0,
    };
    let sheets = [
        (
            [0.0; 3],
            [[0.9, 0.0, 0.0], [0.0, 0.5, 0.7]],
            [0.9, 0.2, 0.15],
        ),
        (
            [0.0; 3],
            [[0.6, 0.6, 0.0], [0.2, -0.3, 0.8]],
            [0.15, 0.8, 0.25],
        ),
        (
            [0.0, 0.1, 0.1],
            [[0.7, -0.5, 0.1], [0.1, 0.4, 0.8]],
            [0.2, 0.35, 0.95],
        ),
    ];
    let sheets = sheets.into_iter();
    let mut points: Vec<SurfacePoint> = sheets
        .flat_map(|(centre, axes, colour)| sheet(centre, axes, spacing, |_, _| glass(colour, 0.5)))
        .collect();
    points.extend(sphere([0.0; 3], 1.25, 9_000, glass([1.0, 0.95, 0.8], 0.25)));
    points
}

/// A sphere of `count` points on a Fibonacci spiral.
pub fn sphere(centre: Vector, radius: f64, count: usize, paint: Paint) -> Vec<SurfacePoint> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let spacing = radius * (4.0 * std::f64::consts::PI / (count as f64 * HEXAGONAL_CELL)).sqrt();
    let point = |index: usize| {
        let z = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
        let (sine, cosine) = (golden * index as f64).sin_cos();
        let across = (1.0 - z * z).sqrt();
        let normal = [across * cosine, across * sine, z];
        let place = vector::add(centre, vector::scale(radius, normal));
        surface_point(place, normal, spacing, paint)
    };
    (0..count).map(point).collect()
}

/// A parallelogram `centre + a u + b v`, -1 <= a, b <= 1, as a hexagonal grid of the given spacing.
pub fn sheet(
    centre: Vector,
    [u, v]: [Vector; 2],
    spacing: f64,
    paint: impl Fn(f64, f64) -> Paint,
) -> Vec<SurfacePoint> {
    let normal = vector::cross(u, v);
    let normal = vector::scale(1.0 / vector::length(normal), normal);
    let (step_u, step_v) = (
        spacing / vector::length(u),
        HEXAGONAL_CELL * spacing / vector::length(v),
    );
    let (columns, rows) = ((1.0 / step_u) as i64, (1.0 / step_v) as i64);
    let mut points = Vec::new();
    for row in -rows..=rows {
        for column in -columns..=columns {
            let shift = 0.5 * (row.rem_euclid(2)) as f64;
            let (a, b) = ((column as f64 + shift) * step_u, row as f64 * step_v);
            let offset = vector::add(vector::scale(a, u), vector::scale(b, v));
            points.push(surface_point(
                vector::add(centre, offset),
                normal,
                spacing,
                paint(a, b),
            ));
        }
    }
    points
}

/// Points as a scene.
pub fn scene(name: &str, points: Vec<SurfacePoint>) -> SurfaceScene {
    let radius = points
        .first()
        .map_or(1.0, |point| vector::length(point.frame[0]));
    SurfaceScene {
        name: name.to_owned(),
        points,
        materials: vec![Material::MATT, Material::GLOSSY],
        radius,
        skipped: 0,
        coloured: true,
        notes: Vec::new(),
        up: [0.0, 0.0, 1.0],
    }
}

fn surface_point(centre: Vector, normal: Vector, spacing: f64, paint: Paint) -> SurfacePoint {
    SurfacePoint {
        centre,
        frame: tangents(normal).map(|tangent| vector::scale(spacing, tangent)),
        normal,
        weight: share_of_area(),
        colour: paint.colour,
        opacity: paint.opacity,
        material: paint.material,
    }
}
