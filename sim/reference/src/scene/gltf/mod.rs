//! glTF 2.0 (`.gltf`, `.glb`) with Gaussians by the extension KHR_gaussian_splatting.
//!
//! Attributes of a primitive of points: `POSITION`, and behind `KHR_gaussian_splatting:` `ROTATION` (x, y, z, w),
//! `SCALE` (linear), `OPACITY` (0 to 1), `SH_DEGREE_l_COEF_n` (RGB, l = 0 to 4). Floats, or integers with `normalized`.
//! All primitives of the scene are gathered, each through its nodes' transforms; harmonics turn with them. y is up in
//! glTF.
//!
//! The structures are read with serde: the crate `gltf` knows no extension of this kind and would not save much. What
//! the extension states beyond that (kernel, projection, colour space) is checked; its order of drawing becomes the
//! scene's.

mod buffers;
mod transform;

use self::buffers::{Buffers, Numbers};
use self::transform::Transform;
use super::error::{Problem, shorten};
use super::gaussian::{Gaussian, GaussianScene, MAX_DEGREE, base_from_coefficient};
use super::{Scene, SortOrder};
use crate::memory;
use anyhow::{Context, anyhow, bail, ensure};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

const EXTENSION: &str = "KHR_gaussian_splatting";
/// y is up in glTF.
const UP: [f64; 3] = [0.0, 1.0, 0.0];
/// Deepest nesting of nodes; also ends circles.
const MAX_DEPTH: usize = 64;
/// Most nodes visited: a node may be the child of several, so that a short file could ask for billions.
const MAX_VISITS: usize = 1 << 16;

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Document {
    scene: Option<usize>,
    scenes: Vec<Root>,
    nodes: Vec<Node>,
    meshes: Vec<Mesh>,
    accessors: Vec<buffers::Accessor>,
    buffer_views: Vec<buffers::GltfView>,
    buffers: Vec<buffers::GltfBuffer>,
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
struct Root {
    #[serde(default)]
    nodes: Vec<usize>,
}

#[derive(Deserialize)]
struct Node {
    mesh: Option<usize>,
    #[serde(default)]
    children: Vec<usize>,
    #[serde(flatten)]
    transform: transform::Stated,
}

#[derive(Deserialize)]
struct Mesh {
    primitives: Vec<GltfPrimitive>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct GltfPrimitive {
    attributes: BTreeMap<String, usize>,
    extensions: BTreeMap<String, serde_json::Value>,
}

/// What the extension says of a primitive.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Splatting {
    kernel: Option<String>,
    color_space: Option<String>,
    sorting_method: Option<String>,
    projection: Option<String>,
    #[serde(default)]
    extensions: BTreeMap<String, serde_json::Value>,
}

/// Loads a `.gltf` or `.glb` file; other buffers are looked for in `folder`.
pub(super) fn load(bytes: &[u8], folder: Option<&Path>, name: &str) -> Result<Scene, Problem> {
    let (json, binary) = buffers::split(bytes)?;
    memory::room_for_json(json)?;
    let document: Document = serde_json::from_slice(json).map_err(|error| {
        anyhow!("glTF JSON: it is not understood: {error}; export the scene again")
    })?;
    let unknown = |name: &&String| *name != EXTENSION;
    if let Some(required) = document.extensions_required.iter().find(unknown) {
        bail!(
            "extensionsRequired: '{}' is not read; \
             export the scene with {EXTENSION} alone, without compression",
            shorten(required)
        );
    }
    let placed = placed_meshes(&document)?;
    let buffers = Buffers::load(&document, binary, folder)?;
    gather(&document, &buffers, &placed, name)
}

/// The meshes of the scene, each with its transform.
fn placed_meshes(document: &Document) -> Result<Vec<(usize, Transform)>, Problem> {
    let root = document.scene.unwrap_or(0);
    let roots = at(&document.scenes, "scene", root)?.nodes.iter();
    let mut waiting: Vec<(usize, Transform, usize)> =
        roots.map(|node| (*node, Transform::IDENTITY, 0)).collect();
    let mut placed = Vec::new();
    let mut visits = 0;
    while let Some((index, above, depth)) = waiting.pop() {
        let node = at(&document.nodes, "node", index)?;
        visits += 1;
        ensure!(
            depth <= MAX_DEPTH && visits <= MAX_VISITS,
            "node {index}: nodes are nested too deeply or in a circle; \
             export the scene again with a tree of nodes"
        );
        let transform = above.then(&node.transform.matrix());
        placed.extend(node.mesh.map(|mesh| (mesh, transform)));
        waiting.extend(
            node.children
                .iter()
                .map(|child| (*child, transform, depth + 1)),
        );
    }
    placed.reverse();
    Ok(placed)
}

/// What another part of the document names by its number.
fn at<'a, T>(list: &'a [T], kind: &str, index: usize) -> Result<&'a T, Problem> {
    list.get(index).with_context(|| {
        format!("{kind} {index}: it is used but not there; export the scene again")
    })
}

/// A primitive's numbers.
struct GltfAttributes<'a> {
    /// Centres, rotations, scales, opacities and constant colours.
    always: [Numbers<'a>; 5],
    /// Harmonics of further degrees.
    rest: Vec<Numbers<'a>>,
    transform: Transform,
}

fn gather(
    document: &Document,
    buffers: &Buffers,
    placed: &[(usize, Transform)],
    name: &str,
) -> Result<Scene, Problem> {
    let mut parts = Vec::new();
    let mut orders = Vec::new();
    let mut left_out = false;
    for (index, transform) in placed {
        for primitive in &at(&document.meshes, "mesh", *index)?.primitives {
            match primitive.extensions.get(EXTENSION) {
                Some(stated) => {
                    orders.push(check(stated)?);
                    parts.push(attributes(primitive, document, buffers, *transform)?);
                }
                None => left_out = true,
            }
        }
    }
    ensure!(
        !parts.is_empty(),
        "meshes: no primitive of the scene has the extension {EXTENSION}; \
         export Gaussians with it, or give another scene"
    );
    // Parts may differ in degree; coefficients that one lacks are 0.
    let degree_of =
        |part: &GltfAttributes| super::gaussian::degree_of(part.rest.len()).unwrap_or(0);
    let degree = parts.iter().map(degree_of).max().unwrap_or(0);
    let count = parts.iter().map(|part| part.count() as u64).sum();
    let mut scene = GaussianScene::new(degree, count)?;
    for part in &parts {
        part.push_all(&mut scene)?;
    }
    let mut scene = scene.finish(name)?;
    if left_out {
        let note = "primitives without Gaussians are left out";
        scene.notes.push(note.to_owned());
    }
    let order = orders.first().copied().unwrap_or_default();
    if orders.iter().any(|other| *other != order) {
        let name = order.name();
        scene.notes.push(format!(
            "its primitives are sorted in two ways: all are drawn in order of {name}"
        ));
    }
    (scene.up, scene.order) = (UP, order);
    Ok(scene)
}

/// Refuses what would be drawn otherwise than stated, and gives the order of drawing.
fn check(stated: &serde_json::Value) -> Result<SortOrder, Problem> {
    let stated: Splatting = Deserialize::deserialize(stated).map_err(|error| {
        anyhow!("{EXTENSION}: it is not understood: {error}; export the scene again")
    })?;
    let refused = |field: &str, found: &str, fix: &str| {
        anyhow!(
            "{EXTENSION}.{field}: '{}' is not read; {fix}",
            shorten(found)
        )
    };
    if let Some(compression) = stated.extensions.keys().next() {
        let fix = "export the scene without compression";
        return Err(refused("extensions", compression, fix));
    }
    let fields = [
        ("kernel", &stated.kernel, "ellipse"),
        ("projection", &stated.projection, "perspective"),
        // Pictures hold the stored numbers: linear ones would have to be encoded for a display, which no engine here
        // does.
        ("colorSpace", &stated.color_space, "srgb_rec709_display"),
    ];
    for (field, found, read) in fields {
        if let Some(other) = found.as_deref().filter(|found| *found != read) {
            let fix = format!("export the scene with '{read}'");
            return Err(refused(field, other, &fix));
        }
    }
    match stated.sorting_method.as_deref() {
        Some("zDepth") => Ok(SortOrder::Depth),
        None | Some("cameraDistance") => Ok(SortOrder::Distance),
        Some(other) => {
            let fix = "export the scene with 'cameraDistance' or 'zDepth'";
            Err(refused("sortingMethod", other, fix))
        }
    }
}

fn attributes<'a>(
    primitive: &GltfPrimitive,
    document: &Document,
    buffers: &'a Buffers,
    transform: Transform,
) -> Result<GltfAttributes<'a>, Problem> {
    let find = |name: &str, width: usize| match primitive.attributes.get(name) {
        Some(accessor) => buffers.numbers(document, *accessor, width, name).map(Some),
        None => Ok(None),
    };
    let required = |name: &str, width: usize| {
        find(name, width)?.with_context(|| {
            format!(
                "attribute {name}: the primitive lacks it; \
                 export the scene with all attributes of {EXTENSION}"
            )
        })
    };
    let own = |name: &str| format!("{EXTENSION}:{name}");
    let part = GltfAttributes {
        always: [
            required("POSITION", 3)?,
            required(&own("ROTATION"), 4)?,
            required(&own("SCALE"), 3)?,
            required(&own("OPACITY"), 1)?,
            required(&own("SH_DEGREE_0_COEF_0"), 3)?,
        ],
        rest: harmonics(&find)?,
        transform,
    };
    let count = part.count();
    for numbers in part.always.iter().chain(&part.rest) {
        let other = numbers.count;
        ensure!(
            other == count,
            "accessor count: {other} beside {count} positions; \
             export the scene again: every attribute needs as many"
        );
    }
    Ok(part)
}

/// The coefficients of the degrees that are whole; one that is not is an error.
fn harmonics<'a>(
    find: &impl Fn(&str, usize) -> Result<Option<Numbers<'a>>, Problem>,
) -> Result<Vec<Numbers<'a>>, Problem> {
    let mut rest = Vec::new();
    for degree in 1..=MAX_DEGREE {
        for order in 0..2 * degree + 1 {
            let name = format!("{EXTENSION}:SH_DEGREE_{degree}_COEF_{order}");
            match find(&name, 3)? {
                Some(numbers) => rest.push(numbers),
                None if order == 0 => return Ok(rest),
                None => bail!(
                    "attribute {name}: the primitive lacks it; \
                     a degree must have all of its coefficients; export the scene again"
                ),
            }
        }
    }
    Ok(rest)
}

impl GltfAttributes<'_> {
    /// Gaussians of the primitive.
    fn count(&self) -> usize {
        self.always[0].count
    }

    fn push_all(&self, scene: &mut GaussianScene) -> Result<(), Problem> {
        let [centres, rotations, scales, opacities, constant] = &self.always;
        let turn = self.transform.harmonics(self.rest.len())?;
        scene.harmonics.fill([0.0; 3]);
        for index in 0..self.count() {
            for (coefficient, numbers) in scene.harmonics.iter_mut().zip(&self.rest) {
                *coefficient = numbers.three(index).map(|value| value as f32);
            }
            if let Some(turn) = &turn {
                turn.apply(&mut scene.harmonics[..self.rest.len()]);
            }
            let [x, y, z, w] = [0, 1, 2, 3].map(|k| rotations.at(index, k));
            let gaussian = Gaussian {
                centre: centres.three(index),
                scales: scales.three(index),
                rotation: [w, x, y, z],
                opacity: opacities.at(index, 0),
                base: constant.three(index).map(base_from_coefficient),
            };
            scene.push_transformed(&gaussian, &self.transform.linear, self.transform.offset);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
