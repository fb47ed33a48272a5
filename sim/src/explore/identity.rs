//! What a sweep is of: everything that decides its results, kept in `sweep.json` beside its tables.
//!
//! A name and a count do not tell two scenes apart: the file may have been edited since, or another node may have
//! another one of that name. So the scene is known by a digest of what was loaded from it (which takes in transfer
//! function and light), the program by a digest of its sources, every settings file by a digest of its text, and
//! camera, rules, design, machine and prices by all their values. Results may share a table only if all of it is equal,
//! and where it is not, the message says what differs.

use super::subject::Subject;
use crate::design::traversal_name;
use crate::difference::{Difference, differences};
use crate::digest::Digest;
use crate::machine::area::synthesis;
use crate::machine::config;
use crate::plan::{Prepared, Subject as Drawn};
use crate::scene::points::SurfaceScene;
use crate::scene::{Harmonics, Scene, Weight};
use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use std::collections::HashMap;

/// Version of `sweep.json`; tables of another version are never taken for ours.
const FORMAT: &str = "splatline-sweep/7";

/// The facts of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Identity(Value);

/// A settings file that took part: what it was for (`transfer`, `design`, `machine`, `calibration`, `camera`), and its
/// text.
pub type SettingsText = (&'static str, String);

impl Identity {
    /// Of a sweep over the space of this text.
    pub fn new(subject: &Subject, space: &str, settings: &[SettingsText]) -> Result<Identity> {
        let files: serde_json::Map<String, Value> = settings
            .iter()
            .map(|(role, text)| ((*role).to_owned(), of_bytes(text.as_bytes()).into()))
            .collect();
        let (first, more) = subject.frames.split_first().context("there is no frame")?;
        let known = &mut SceneDigests::new();
        let look = technique(first)?;
        Ok(Identity(json!({
            "format": FORMAT,
            "program": { "version": env!("CARGO_PKG_VERSION"), "sources_sha256": env!("SPLATLINE_SOURCES") },
            "scene": {
                "name": first.scene.name(),
                "splats": first.scene.len(),
                "sha256": scene_digest(first, known)?,
            },
            "camera": first.plan.camera,
            "more_frames": more.iter().map(|frame| further(frame, known)).collect::<Result<Vec<_>>>()?,
            "rules": look["rules"],
            "compositing": look["compositing"],
            "design": subject.design.resolved(),
            "traversal": subject.traversal.map(traversal_name),
            "machine": config::to_toml(&subject.machine),
            "calibration": subject.calibration,
            "energy": subject.energy,
            "area": synthesis::statement(&subject.calibration),
            "errors": !subject.references.is_empty(),
            "files_sha256": files,
            "space": space,
        })))
    }

    /// Reads the text of a `sweep.json`.
    pub fn parse(text: &str) -> Result<Identity> {
        let facts: Value = serde_json::from_str(text).context("not the JSON of a sweep")?;
        let format = facts["format"].as_str();
        let format = format.context("no \"format\": not the identity of a sweep")?;
        ensure!(
            format == FORMAT,
            "format is '{format}', this program's is '{FORMAT}': run the sweep again in a new folder"
        );
        Ok(Identity(facts))
    }

    /// The text of a `sweep.json`.
    pub fn to_text(&self) -> String {
        format!("{:#}\n", self.0)
    }

    /// Where `known` and this one differ, one line each; empty if they are the same sweep.
    pub fn differences(&self, known: &Identity) -> Vec<String> {
        let line = |d: Difference| format!("{}: {} there, {} here", d.place, d.first, d.second);
        let found = differences(&known.0, &self.0).into_iter();
        found.map(line).collect()
    }
}

/// Rules, order and method of blending as a plan records them, or the style of surfaces as its rules.
fn technique(frame: &Prepared) -> Result<Value> {
    let mut recorded = serde_json::to_value(frame.plan.technique)?;
    Ok(match frame.subject()? {
        Drawn::Splats(_) => recorded["splats"].take(),
        Drawn::Surface(..) => json!({ "rules": recorded["surface"] }),
    })
}

/// Digests of scenes by where they lie, since many frames may share one.
type SceneDigests = HashMap<*const (), String>;

fn scene_digest(frame: &Prepared, known: &mut SceneDigests) -> Result<String> {
    let known = match frame.subject()? {
        Drawn::Splats(splats) => known
            .entry(std::ptr::from_ref(splats.scene).cast())
            .or_insert_with(|| of_scene(splats.scene)),
        Drawn::Surface(scene, _) => known
            .entry(std::ptr::from_ref(scene).cast())
            .or_insert_with(|| of_surface(scene)),
    };
    Ok(known.clone())
}

/// Scene, camera and rules of a further frame.
fn further(frame: &Prepared, known: &mut SceneDigests) -> Result<Value> {
    Ok(json!({
        "scene": frame.scene.name(),
        "sha256": scene_digest(frame, known)?,
        "camera": frame.plan.camera,
        "rules": technique(frame)?["rules"],
    }))
}

fn of_bytes(bytes: &[u8]) -> String {
    let mut digest = Digest::default();
    digest.add(bytes);
    digest.finish()
}

/// Every bit of a scene that a picture or a count can depend on.
fn of_scene(scene: &Scene) -> String {
    let Scene {
        name: _,
        natural_rules: _,
        weight,
        splats,
        harmonics,
        skipped,
        up,
        order,
        notes: _,
    } = scene;
    let mut digest = Digest::default();
    digest.add(match weight {
        Weight::Opacity => b"o",
        Weight::Mass => b"m",
    });
    digest.add(order.name().as_bytes());
    for number in [splats.len(), skipped.non_finite, skipped.zero_rotation] {
        digest.add(&(number as u64).to_le_bytes());
    }
    doubles(&mut digest, up);
    for splat in splats {
        doubles(&mut digest, &splat.centre);
        doubles(&mut digest, splat.axes.as_flattened());
        doubles(&mut digest, &[splat.weight]);
        doubles(&mut digest, &splat.colour);
    }
    if let Some(Harmonics {
        degree,
        coefficients,
        base,
    }) = harmonics
    {
        digest.add(&[*degree]);
        for list in [coefficients, base] {
            digest.add(&(list.len() as u64).to_le_bytes());
            for value in list.as_flattened() {
                digest.add(&value.to_bits().to_le_bytes());
            }
        }
    }
    digest.finish()
}

/// The same of points of a surface.
fn of_surface(scene: &SurfaceScene) -> String {
    let SurfaceScene {
        name: _,
        points,
        materials,
        radius,
        skipped,
        coloured,
        notes: _,
        up,
    } = scene;
    let mut digest = Digest::default();
    digest.add(&[b's', (*coloured).into()]);
    for number in [points.len(), materials.len(), *skipped] {
        digest.add(&(number as u64).to_le_bytes());
    }
    doubles(&mut digest, &[*radius]);
    doubles(&mut digest, up);
    for point in points {
        doubles(&mut digest, &point.centre);
        doubles(&mut digest, point.frame.as_flattened());
        doubles(&mut digest, &point.normal);
        doubles(&mut digest, &point.colour);
        doubles(&mut digest, &[point.weight, point.opacity]);
        digest.add(&[point.material]);
    }
    for material in materials {
        doubles(
            &mut digest,
            &[material.ambient, material.diffuse, material.specular],
        );
        digest.add(&[material.exponent]);
    }
    digest.finish()
}

fn doubles(digest: &mut Digest, values: &[f64]) {
    for value in values {
        digest.add(&value.to_bits().to_le_bytes());
    }
}

#[cfg(test)]
#[path = "identity_tests.rs"]
mod tests;
