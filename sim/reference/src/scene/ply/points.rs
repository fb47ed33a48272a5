//! The vertices of a PLY file as points of a surface: place, normal, colour, opacity and radius, in any order.
//!
//! Colours of integer type are divided by the largest value of their type; floating-point colours are taken as they
//! are.

use super::super::bytes::Scalar;
use super::super::error::Problem;
use super::super::points::Record;
use super::body::{self, PlySource};
use super::header::{self, Element, PropertyKind};
use super::{number, vertex_element};
use crate::memory;
use anyhow::{Context, bail, ensure};

/// Where a record holds each field.
struct PointColumns {
    centre: [usize; 3],
    normal: Option<[usize; 3]>,
    colour: Option<[usize; 3]>,
    opacity: Option<usize>,
    radius: Option<usize>,
    full_colour: f64,
}

/// Every vertex as a record.
pub(in super::super) fn records(bytes: &[u8]) -> Result<Vec<Record>, Problem> {
    let (header, body) = header::parse(bytes)?;
    let vertex = vertex_element(&header.elements)?;
    let columns = PointColumns::find(vertex)?;
    PlySource::new(&header, body).refuse_absurd_count(vertex)?;
    let mut records = memory::list(vertex.count, "the points")?;
    body::for_each_vertex(&header, body, &mut |values| {
        records.push(columns.record(values));
    })?;
    Ok(records)
}

impl PointColumns {
    fn find(vertex: &Element) -> Result<PointColumns, Problem> {
        ensure!(
            vertex.column("scale_0").is_none(),
            "property scale_0: these are Gaussians with a volume, not points of a surface; \
             leave out --as surface"
        );
        let centre = all(vertex, ["x", "y", "z"])?
            .context("element vertex: it has no x, y and z; export the points with their places")?;
        let colour = match all(vertex, ["red", "green", "blue"])? {
            Some(columns) => Some(columns),
            None => all(vertex, ["diffuse_red", "diffuse_green", "diffuse_blue"])?,
        };
        Ok(PointColumns {
            centre,
            normal: all(vertex, ["nx", "ny", "nz"])?,
            colour,
            opacity: vertex.column("alpha").or(vertex.column("opacity")),
            radius: vertex.column("radius"),
            full_colour: colour.map_or(1.0, |columns| full_scale(vertex, columns[0])),
        })
    }

    fn record(&self, values: &[f64]) -> Record {
        let three = |columns: [usize; 3]| columns.map(|column| number(values, column));
        let channel = |value: f64| value / self.full_colour;
        Record {
            centre: three(self.centre),
            normal: self.normal.map(three),
            colour: self.colour.map(|columns| three(columns).map(channel)),
            opacity: self.opacity.map(|column| channel(number(values, column))),
            radius: self.radius.map(|column| number(values, column)),
        }
    }
}

/// Three properties that make sense together only: nothing if none is there, an error if some are.
fn all(vertex: &Element, names: [&str; 3]) -> Result<Option<[usize; 3]>, Problem> {
    let columns = names.map(|name| vertex.column(name));
    match columns {
        [Some(a), Some(b), Some(c)] => Ok(Some([a, b, c])),
        [None, None, None] => Ok(None),
        _ => bail!(
            "properties {}: only some of them are there; export all three or none",
            names.join(", ")
        ),
    }
}

/// The value of full intensity for the type of a property.
fn full_scale(vertex: &Element, column: usize) -> f64 {
    match vertex.properties.get(column).map(|property| property.kind) {
        Some(PropertyKind::Number(Scalar::U8 | Scalar::I8)) => 255.0,
        Some(PropertyKind::Number(Scalar::U16 | Scalar::I16)) => 65_535.0,
        Some(PropertyKind::Number(Scalar::U32 | Scalar::I32)) => f64::from(u32::MAX),
        _ => 1.0,
    }
}
