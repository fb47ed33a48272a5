//! What is set up: captured scenes, hard cases, and bits of which nobody made a splat.

use super::bench::SetupLoad;
use crate::workload::{GuitarView, guitar_scene, shared, split_mix};
use anyhow::{Context, Result};
use splatline::float;
use splatline::math::SoftFloat;
use splatline::rules::Rules as KernelRules;
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Projection, View};
use splatline_sim::camera::Camera;
use splatline_sim::fixed::QuantisedScene;
use splatline_sim::rules::Rules;
use splatline_sim::scene::points::{self, spheres};
use splatline_sim::scene::{self, Scene};
use splatline_sim::vectors::hard_cases;

/// Both kinds of rules by the simulator's names and the kernel's.
pub fn rules() -> [(Rules, KernelRules); 2] {
    [
        (Rules::EWA, KernelRules::EWA),
        (Rules::GAUSSIAN_3D, KernelRules::GAUSSIAN_3D),
    ]
}

/// Hard cases, arbitrary splats before a sane camera, and the same from an orthographic one.
pub fn synthetic(count: usize, seed: u64) -> Vec<SetupLoad> {
    let (view, splats) = hard_cases(count, [640, 480], 5);
    let flat = View {
        projection: Projection::Orthographic,
        ..view
    };
    let mut state = seed;
    let near: Vec<VolumeSplat> = (0..count).map(|_| arbitrary(&mut state, 24)).collect();
    let wild: Vec<VolumeSplat> = (0..count).map(|_| arbitrary(&mut state, 1024)).collect();
    let mut loads = Vec::new();
    for (_, rules) in rules() {
        for (name, view, splats) in [
            ("hard cases", view, &splats),
            ("hard cases, orthographic", flat, &splats),
            ("arbitrary splats", view, &near),
            ("arbitrary splats, orthographic", flat, &near),
            ("arbitrary bits", view, &wild),
        ] {
            loads.push(SetupLoad {
                name: format!("{name}, {}", name_of(&rules)),
                view,
                rules,
                splats: splats.clone(),
            });
        }
    }
    loads
}

pub(super) fn name_of(rules: &KernelRules) -> &'static str {
    if rules.normalised { "ewa" } else { "3dgs" }
}

/// The scenes at hand, every `step`-th splat of them, and the names of those that are not.
pub fn captured(step: usize) -> Result<(Vec<SetupLoad>, Vec<&'static str>)> {
    let mut loads = Vec::new();
    let mut missing = Vec::new();
    for (name, seen) in [
        ("guitar", guitar_scene(GuitarView::Close, 512)?),
        ("playbot", playbot()?),
        ("lion", lion()?),
    ] {
        let Some((mut scene, camera)) = seen else {
            missing.push(name);
            continue;
        };
        let mut index = 0;
        scene.splats.retain(|_| {
            index += 1;
            (index - 1) % step == 0
        });
        scene.harmonics = None;
        for (rules, _) in rules() {
            let quantised = QuantisedScene::new(&scene, &camera, &rules);
            let stated = quantised.rules(&rules);
            loads.push(SetupLoad {
                name: format!("{name}, {}", name_of(&stated)),
                view: quantised.view,
                rules: stated,
                splats: quantised.splats,
            });
        }
    }
    Ok((loads, missing))
}

pub(crate) fn playbot() -> Result<Option<(Scene, Camera)>> {
    let Some(file) = shared("gaussians/playbot_lod4.ply") else {
        return Ok(None);
    };
    let scene = scene::load(&file, &Default::default())?;
    let camera = scene.default_camera(640, 480);
    Ok(Some((scene, camera)))
}

pub(crate) fn lion() -> Result<Option<(Scene, Camera)>> {
    let Some(file) = shared("points/lion_takanawa.ply") else {
        return Ok(None);
    };
    let scene = spheres::as_spheres(&points::load(&file)?, spheres::LION_DEVIATION);
    let (eye, target) = ([4.11, 3.88, -0.16], [-2.89, 3.88, -1.16]);
    let camera =
        Camera::look_at(eye, target, scene.up, 45.0, 512, 512).context("the lion's camera")?;
    Ok(Some((scene, camera)))
}

/// A splat of random bits: mantissas from 0 to the ends of the format, exponents over `range` powers around those of a usual scene.
fn arbitrary(state: &mut u64, range: u64) -> VolumeSplat {
    let mut exponent = |usual: i64| {
        let moved = (split_mix(state) % range) as i64 - range as i64 / 2;
        (usual + moved).clamp(-512, 511) as i32
    };
    let exponents = [-28, -28, -28, -33, -33, -33, -30].map(&mut exponent);
    let mut mantissa = || {
        let bits = split_mix(state);
        match bits % 16 {
            0 => 0,
            1 => i32::MIN,
            2 => 1 << ((bits >> 32) % 31),
            3 => i32::MAX,
            _ => (bits >> 32) as i32 >> ((bits >> 8) % 8),
        }
    };
    let mut number = |i: usize| SoftFloat {
        mantissa: mantissa(),
        exponent: exponents[i],
    };
    let centre = [number(0), number(1), number(2)];
    let weight = number(6);
    let axes = [3, 4, 5].map(|i| Axis {
        mantissa: [number(i).mantissa, number(i).mantissa, number(i).mantissa],
        exponent: exponents[i],
    });
    let colour = [0; 3]
        .map(|_: u32| float::colour(f64::from(number(0).mantissa as u32) / f64::from(1 << 28)));
    VolumeSplat {
        centre,
        axes,
        weight,
        colour,
    }
}
