//! 3D Gaussians in the trainers' PLY layout.
//!
//! One `vertex` per Gaussian: `x y z`, `scale_0..2` (logarithms), `rot_0..3` (w, x, y, z), `opacity` (logit),
//! `f_dc_0..2` and optionally `f_rest_*` (9, 24, 45 or 72 numbers for degree 1 to 4: all of red, then green, then
//! blue). Properties may come in any order; others are ignored. Compressed files are the matter of [`compressed`].
//!
//! - Without `scale_2` they are 2D Gaussians (Huang et al., SIGGRAPH 2024): flat ones in the plane of the first two
//!   axes, whose variance on the screen is that of a surface splat's tangent frame.
//! - With `filter_3D` they come from Mip-Splatting's trainer (Yu et al., CVPR 2024) and are widened by that 3D filter
//!   on loading, opacities compensated (eq. 8); its 2D filter, of 0.1 square pixels and compensated as well, is the
//!   matter of the rules.

mod body;
mod compressed;
mod header;
pub(super) mod points;
#[cfg(test)]
mod tests;

use super::Scene;
use super::error::{Problem, shorten};
use super::gaussian::{
    Gaussian, GaussianScene, TRAINED_ANTIALIASED, base_from_coefficient, degree_of,
    opacity_from_logit, scale_from_log,
};
use crate::rules::Rules;
use anyhow::{Context, anyhow, bail, ensure};
use body::PlySource;
use header::Element;
use std::collections::HashSet;

/// Loads the Gaussians of a PLY file.
pub(super) fn load(bytes: &[u8], name: &str) -> Result<Scene, Problem> {
    let (header, body) = header::parse(bytes)?;
    let vertex = vertex_element(&header.elements)?;
    if vertex.column("packed_position").is_some() {
        return compressed::load(&header, body, name);
    }
    let columns = GaussianColumns::find(vertex)?;
    let degree = columns.degree();
    PlySource::new(&header, body).refuse_absurd_count(vertex)?;
    let mut scene = GaussianScene::new(degree, vertex.count)?;
    scene.rules = rules(&header, &columns);
    body::for_each_vertex(&header, body, &mut |record| {
        columns.read_harmonics(record, &mut scene.harmonics);
        scene.push(&columns.gaussian(record));
    })?;
    scene.finish(name)
}

/// What Mip-Splatting's trainer filters pictures with.
const MIP_SPLATTING: Rules = Rules {
    low_pass: 0.1,
    ..TRAINED_ANTIALIASED
};

/// The rules that the file's Gaussians were trained with.
fn rules(header: &header::PlyHeader, columns: &GaussianColumns) -> Rules {
    match (columns.filter, header.antialiased) {
        (Some(_), _) => MIP_SPLATTING,
        (None, true) => TRAINED_ANTIALIASED,
        (None, false) => Rules::GAUSSIAN_3D,
    }
}

fn vertex_element(elements: &[Element]) -> Result<&Element, Problem> {
    let mut vertices = elements.iter().filter(|element| element.name == "vertex");
    let vertex = vertices.next().context(
        "PLY header: there is no element 'vertex'; export the scene as a 3D Gaussian PLY",
    )?;
    ensure!(
        vertices.next().is_none(),
        "PLY header: element 'vertex' is declared twice; declare it once"
    );
    let mut seen = HashSet::new();
    if let Some(twice) = vertex.properties.iter().find(|p| !seen.insert(&p.name)) {
        bail!(
            "element vertex: property '{}' is declared twice; declare it once",
            shorten(&twice.name)
        );
    }
    ensure!(
        vertex.count != 0,
        "element vertex: its count is 0; export a scene with splats in it"
    );
    Ok(vertex)
}

/// Where a record holds each field.
#[derive(Debug)]
struct GaussianColumns {
    centre: [usize; 3],
    scales: [usize; 2],
    /// None of 2D Gaussians.
    third_scale: Option<usize>,
    /// Standard deviation of Mip-Splatting's 3D filter.
    filter: Option<usize>,
    rotation: [usize; 4],
    opacity: usize,
    constant: [usize; 3],
    rest: Vec<usize>,
}

impl GaussianColumns {
    fn find(vertex: &Element) -> Result<GaussianColumns, Problem> {
        refuse_other_kinds(vertex)?;
        let required = |name: &str| required(vertex, name);
        Ok(GaussianColumns {
            centre: all(["x", "y", "z"], required)?,
            scales: all(["scale_0", "scale_1"], required)?,
            third_scale: vertex.column("scale_2"),
            filter: vertex.column("filter_3D"),
            rotation: all(["rot_0", "rot_1", "rot_2", "rot_3"], required)?,
            opacity: required("opacity")?,
            constant: all(["f_dc_0", "f_dc_1", "f_dc_2"], required)?,
            rest: find_rest(vertex)?,
        })
    }

    fn degree(&self) -> u8 {
        degree_of(self.rest.len() / 3).unwrap_or(0)
    }

    fn read_harmonics(&self, record: &[f64], harmonics: &mut [[f32; 3]]) {
        let per_channel = harmonics.len();
        for (k, coefficient) in harmonics.iter_mut().enumerate() {
            *coefficient = [0, 1, 2]
                .map(|channel| number(record, self.rest[channel * per_channel + k]) as f32);
        }
    }

    fn gaussian(&self, record: &[f64]) -> Gaussian {
        let scale = |column: usize| scale_from_log(number(record, column));
        let [first, second] = self.scales.map(scale);
        let scales = [first, second, self.third_scale.map_or(0.0, scale)];
        let filter = self.filter.map_or(0.0, |column| number(record, column));
        let (scales, kept) = widened(scales, filter);
        Gaussian {
            centre: self.centre.map(|column| number(record, column)),
            scales,
            rotation: self.rotation.map(|column| number(record, column)),
            opacity: kept * opacity_from_logit(number(record, self.opacity)),
            base: self
                .constant
                .map(|column| base_from_coefficient(number(record, column))),
        }
    }
}

/// Scales after a filter of this standard deviation, and which part of the opacity is kept: sqrt(det / det of the
/// filtered variance).
fn widened(scales: [f64; 3], filter: f64) -> ([f64; 3], f64) {
    if filter == 0.0 {
        return (scales, 1.0);
    }
    let wide = scales.map(|scale| scale.hypot(filter));
    let kept = scales.iter().zip(wide).map(|(scale, wide)| scale / wide);
    (wide, kept.product())
}

/// A record has a value for each property, so the fallback is never used; NaN would be counted as a skip.
fn number(record: &[f64], column: usize) -> f64 {
    record.get(column).copied().unwrap_or(f64::NAN)
}

/// Files that are sound but hold something other than trained Gaussians.
fn refuse_other_kinds(vertex: &Element) -> Result<(), Problem> {
    let gaussian_fields = ["scale_0", "rot_0", "opacity", "f_dc_0"];
    ensure!(
        gaussian_fields
            .iter()
            .any(|name| vertex.column(name).is_some()),
        "element vertex: it has none of scale_0, rot_0, opacity and f_dc_0, so this is a point cloud; \
         give --as surface to draw its points, or a 3D Gaussian PLY"
    );
    Ok(())
}

/// The columns of several properties that must all be there.
fn all<const N: usize>(
    names: [&str; N],
    column: impl Fn(&str) -> Result<usize, Problem>,
) -> Result<[usize; N], Problem> {
    let mut columns = [0; N];
    for (found, name) in columns.iter_mut().zip(names) {
        *found = column(name)?;
    }
    Ok(columns)
}

fn required(vertex: &Element, name: &str) -> Result<usize, Problem> {
    vertex.column(name).with_context(|| {
        format!(
            "property {name}: the Gaussians' element vertex lacks it; export the scene with x y \
             z, scale_0..2 (2D Gaussians: scale_0..1), rot_0..3, opacity and f_dc_0..2"
        )
    })
}

fn find_rest(vertex: &Element) -> Result<Vec<usize>, Problem> {
    let count = vertex
        .properties
        .iter()
        .filter(|property| property.name.starts_with("f_rest_"))
        .count();
    if count % 3 != 0 || degree_of(count / 3).is_none() {
        return Err(bad_harmonics(count));
    }
    (0..count)
        .map(|k| required(vertex, &format!("f_rest_{k}")))
        .collect()
}

fn bad_harmonics(count: usize) -> Problem {
    anyhow!(
        "properties f_rest_*: there are {count}; degrees 0 to 4 have 0, 9, 24, 45 or 72; \
         export the scene with one of these"
    )
}
