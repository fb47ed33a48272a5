//! Point clouds as surfaces: points with normals and colours become surface splats (SURF 3).
//!
//! | file | read |
//! |---|---|
//! | `.ply` | `x y z`, `nx ny nz`, `red green blue` (also with `alpha`), `radius` |
//! | `.xyz`, `.pts`, `.txt`, `.asc` | lines of 3, 6 or 9 numbers: place, normal, colour |
//! | `.obj` | vertices, with colours and normals if they have any |
//! | `.las`, `.laz` | places and colours; the latter with the feature `laz` |
//!
//! A point without a radius gets the distance to the farthest of its six nearest neighbours; a cloud without normals
//! gets those of the planes through each point's neighbours. What was made up that way is told in
//! [`SurfaceScene::notes`].

pub mod flatten;
pub mod height_field;
mod las;
mod neighbours;
mod obj;
pub mod orientation;
pub mod spheres;
pub mod synthetic;
#[cfg(test)]
mod tests;
mod xyz;

use super::error::{LoadError, Problem};
use super::file::read_file;
use super::{Bounds, ply};
use crate::memory;
use crate::metrics::median;
use crate::vector::{self, Vector};
use anyhow::{bail, ensure};
use std::path::Path;

/// Share of a hexagonal grid's cell in the square of its spacing: sqrt(3) / 2.
const HEXAGONAL_CELL: f64 = 0.866_025_403_784_438_6;
/// Part of a Gaussian's integral inside the cut-off r < 2: 1 - exp(-1).
const INSIDE_CUTOFF: f64 = 0.632_120_558_828_557_7;
/// Radius of a stray point at most, in medians of all radii.
const LARGEST_RADIUS: f64 = 4.0;
/// Colour of points that have none.
const WITHOUT_COLOUR: [f64; 3] = [0.75, 0.75, 0.75];

/// A point of a surface as the reference sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Place, scene units.
    pub centre: Vector,
    /// The tangent frame: two axes, each one standard deviation of the basis function long.
    pub frame: [Vector; 2],
    /// Unit normal.
    pub normal: Vector,
    /// Height of the basis function at its centre; neighbours' functions sum to about 1.
    pub weight: f64,
    /// Linear RGB, 0 to 1.
    pub colour: [f64; 3],
    /// Opacity, 0 to 1.
    pub opacity: f64,
    /// Row of the material table.
    pub material: u8,
}

/// How a surface answers to light (SURF 4: a table row).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Share of the colour that is there without light.
    pub ambient: f64,
    /// Diffuse coefficient.
    pub diffuse: f64,
    /// Specular coefficient.
    pub specular: f64,
    /// Phong exponent.
    pub exponent: u8,
}

impl Material {
    /// Mostly diffuse, with a faint highlight.
    pub const MATT: Material = Material {
        ambient: 0.25,
        diffuse: 0.75,
        specular: 0.1,
        exponent: 8,
    };
    /// A narrow, strong highlight.
    pub const GLOSSY: Material = Material {
        ambient: 0.15,
        diffuse: 0.6,
        specular: 0.6,
        exponent: 40,
    };
}

/// A set of surface points with what is needed to draw them.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceScene {
    /// File name without folders.
    pub name: String,
    /// The points.
    pub points: Vec<SurfacePoint>,
    /// The material table.
    pub materials: Vec<Material>,
    /// Median standard deviation of the basis functions, scene units.
    pub radius: f64,
    /// Points left out because a number was NaN or infinite, or the normal had no direction.
    pub skipped: usize,
    /// Have the points colours of their own?
    pub coloured: bool,
    /// What the loader had to make up.
    pub notes: Vec<String>,
    /// Default camera's up direction.
    pub up: Vector,
}

/// A record of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Record {
    pub(super) centre: Vector,
    pub(super) normal: Option<Vector>,
    pub(super) colour: Option<[f64; 3]>,
    pub(super) opacity: Option<f64>,
    pub(super) radius: Option<f64>,
}

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Cloud {
    pub(super) records: Vec<Record>,
    /// What of the file is left out.
    pub(super) notes: Vec<String>,
}

/// Extensions of files that hold nothing but points.
const EXTENSIONS: [&str; 6] = ["xyz", "pts", "asc", "obj", "las", "laz"];

/// Is this, by its name, a file of points and nothing else?
pub fn is_cloud(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    EXTENSIONS.contains(&extension.to_ascii_lowercase().as_str())
}

/// Loads a point cloud.
pub fn load(path: &Path) -> Result<SurfaceScene, LoadError> {
    if let Some(scene) = synthetic::named(&path.to_string_lossy()) {
        return Ok(scene);
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    read_file(path)
        .and_then(|bytes| parse(&bytes, path))
        .and_then(|cloud| surface(&name, cloud))
        .map_err(LoadError::about(path.display()))
}

fn parse(bytes: &[u8], path: &Path) -> Result<Cloud, Problem> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let plain = |records| Cloud {
        records,
        notes: Vec::new(),
    };
    match extension.to_ascii_lowercase().as_str() {
        "xyz" | "pts" | "txt" | "asc" => xyz::records(bytes).map(plain),
        _ if bytes.starts_with(b"ply") => ply::points::records(bytes).map(plain),
        "obj" => obj::cloud(bytes),
        "las" | "laz" => las::cloud(bytes),
        _ if bytes.starts_with(b"LASF") => las::cloud(bytes),
        // Of stdin the first bytes alone say what it is.
        "" if xyz::begins(bytes) => xyz::records(bytes).map(plain),
        other => bail!(
            "point cloud: '.{other}' is no format of points; \
             give a .ply, .xyz, .obj, .las or .laz file, or leave out --as surface"
        ),
    }
}

/// Colours to 0 to 1: the first of these full scales that none exceeds, or the last.
fn full_scale(records: &mut [Record], scales: &[f64]) {
    let channels = records.iter().filter_map(|record| record.colour).flatten();
    let greatest = channels.fold(0.0, f64::max);
    let enough = |scale: &&f64| greatest <= **scale;
    let Some(full) = scales.iter().find(enough).or(scales.last()) else {
        return;
    };
    for colour in records
        .iter_mut()
        .filter_map(|record| record.colour.as_mut())
    {
        *colour = colour.map(|channel| channel / full);
    }
}

/// Is there room for a record and so many further bytes for each line of a text?
fn room_for_lines(text: &[u8], more: usize) -> Result<(), Problem> {
    let lines = 1 + text.iter().filter(|byte| **byte == b'\n').count();
    Ok(memory::room_for_records(
        lines as u64,
        size_of::<Record>() + more,
        "the points",
    )?)
}

/// Completes the records: radii and normals from the neighbours where the file has none.
fn surface(name: &str, cloud: Cloud) -> Result<SurfaceScene, Problem> {
    let Cloud { records, mut notes } = cloud;
    // The sound records, their places, tree, radii and normals, and the points.
    let each = size_of::<Record>() + 3 * size_of::<Vector>() + size_of::<SurfacePoint>();
    memory::room_for_records(records.len() as u64, each, "the surface's points")?;
    let sound: Vec<Record> = records.iter().copied().filter(is_sound).collect();
    ensure!(
        sound.len() >= 3,
        "points: only {} of {} are usable; \
         give a cloud of at least 3 points with finite coordinates",
        sound.len(),
        records.len()
    );
    let any = |field: fn(&Record) -> bool| sound.iter().any(field);
    let (no_radius, no_normal) = (any(|r| r.radius.is_none()), any(|r| r.normal.is_none()));
    let places: Vec<Vector> = sound.iter().map(|record| record.centre).collect();
    let neighbours = (no_radius || no_normal).then(|| neighbours::Neighbours::new(&places));
    let found = neighbours.as_ref();
    if no_radius {
        notes.push("radii: distance to the sixth nearest neighbour".to_owned());
    }
    if no_normal {
        notes.push("normals: planes through the neighbours, not oriented".to_owned());
    }
    let coloured = any(|r| r.colour.is_some());
    if any(|r| r.colour.is_none()) {
        notes.push("colours: grey where the file has none".to_owned());
    }
    let radii = found
        .filter(|_| no_radius)
        .map(|n| limited(n.radii(), &mut notes));
    let normals = found.filter(|_| no_normal).map(|n| n.normals());
    let complete = |(index, record): (usize, &Record)| {
        let radius = record.radius.or(radii.as_ref().map(|r| r[index]))?;
        let normal = record.normal.or(normals.as_ref().map(|n| n[index]))?;
        point(record, radius, normal)
    };
    let points: Vec<SurfacePoint> = sound.iter().enumerate().filter_map(complete).collect();
    let skipped = records.len() - points.len();
    let mut sizes: Vec<f64> = points.iter().map(|p| vector::length(p.frame[0])).collect();
    let Some(radius) = median(&mut sizes) else {
        bail!(
            "points: none has a radius and a normal; \
             give normals of non-zero length, and no radii of 0"
        );
    };
    let up = orientation::up(&points);
    Ok(SurfaceScene {
        name: name.to_owned(),
        points,
        materials: vec![Material::MATT],
        radius,
        skipped,
        coloured,
        notes,
        up,
    })
}

/// Radii cut to [`LARGEST_RADIUS`] medians: a stray point far from all others would become a disc as large as its
/// distance.
fn limited(radii: Vec<f64>, notes: &mut Vec<String>) -> Vec<f64> {
    let largest = LARGEST_RADIUS * median(&mut radii.clone()).unwrap_or(0.0);
    let stray = radii.iter().filter(|radius| **radius > largest).count();
    if stray > 0 && largest > 0.0 {
        notes.push(format!(
            "radii: {stray} of stray points cut to {LARGEST_RADIUS} times the median"
        ));
        return radii.iter().map(|radius| radius.min(largest)).collect();
    }
    radii
}

fn is_sound(record: &Record) -> bool {
    let numbers = record.normal.into_iter().chain(record.colour);
    let scalars = record.opacity.into_iter().chain(record.radius);
    vector::is_finite(record.centre)
        && numbers.into_iter().all(vector::is_finite)
        && scalars.into_iter().all(f64::is_finite)
}

/// One surface point; nothing if its normal has no direction or its radius is not positive.
fn point(record: &Record, radius: f64, normal: Vector) -> Option<SurfacePoint> {
    let length = vector::length(normal);
    if !(length > 1e-12 && length.is_finite() && radius > 0.0 && radius.is_finite()) {
        return None;
    }
    let normal = vector::scale(1.0 / length, normal);
    Some(SurfacePoint {
        centre: record.centre,
        frame: tangents(normal).map(|t| vector::scale(radius, t)),
        normal,
        weight: share_of_area(),
        colour: record
            .colour
            .unwrap_or(WITHOUT_COLOUR)
            .map(|c| c.clamp(0.0, 1.0)),
        opacity: record.opacity.unwrap_or(1.0).clamp(0.0, 1.0),
        material: 0,
    })
}

/// The weight by which basis functions of standard deviation s on a hexagonal grid of spacing s sum to 1 within the
/// cut-off: the area of a cell over the integral of the function.
pub fn share_of_area() -> f64 {
    HEXAGONAL_CELL / (std::f64::consts::TAU * INSIDE_CUTOFF)
}

/// Two unit vectors that are orthogonal to the unit vector `normal` and to each other.
pub fn tangents(normal: Vector) -> [Vector; 2] {
    let smallest = (0..3)
        .min_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()))
        .unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[smallest] = 1.0;
    let first = vector::cross(normal, axis);
    let first = vector::scale(1.0 / vector::length(first), first);
    [first, vector::cross(normal, first)]
}

impl SurfaceScene {
    /// The box of all places; none for a scene without points.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::around(self.points.iter().map(|point| point.centre), 0.0)
    }

    /// Depth differences up to this belong to one surface unless the command line says otherwise: three radii.
    pub fn usual_threshold(&self) -> f64 {
        3.0 * self.radius
    }
}
