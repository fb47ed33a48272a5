//! What is set up: captured scenes, hard cases, and bits of which nobody made a splat.

use super::bench::SetupLoad;
use crate::workload::{GuitarView, guitar_scene, shared, split_mix};
use anyhow::{Context, Result};
use splatline::float;
use splatline::math::{Extended, SoftFloat};
use splatline::rules::Rules as KernelRules;
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Eye, Projection, View};
use splatline_sim::camera::Camera;
use splatline_sim::fixed::QuantisedScene;
use splatline_sim::rules::Rules;
use splatline_sim::scene::points::{self, spheres};
use splatline_sim::scene::{self, Scene};
use splatline_sim::vectors::hard_cases;
use std::ops::Range;

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

/// What random bits hardly ever make: sums that are 0 or a power of two, and numbers around every power where fixed point ends. The cameras turn nothing.
pub fn exact(count: usize, seed: u64) -> Vec<SetupLoad> {
    let mut loads = Vec::new();
    for (_, rules) in rules() {
        for (word, projection) in [
            ("", Projection::Perspective),
            (", orthographic", Projection::Orthographic),
        ] {
            let mut state = seed;
            loads.push(SetupLoad {
                name: format!("few bits{word}, {}", name_of(&rules)),
                view: straight(projection, FOCAL),
                rules,
                splats: (0..count).map(|_| few_bits(&mut state)).collect(),
            });
        }
    }
    // From so near that most positions are inside to far beyond 64 bits, where the unit below the largest ends.
    let flat = straight(Projection::Orthographic, FOCAL);
    let long = straight(Projection::Perspective, TELEPHOTO);
    for (name, view, powers, rules) in [
        ("far aside, orthographic", flat, -31..20, KernelRules::EWA),
        (
            "far aside, telephoto",
            long,
            -48..-28,
            KernelRules::GAUSSIAN_3D,
        ),
    ] {
        loads.push(SetupLoad {
            name: format!("{name}, {}", name_of(&rules)),
            view,
            rules,
            splats: aside(powers, -36 - (view.focal[0].exponent + 21)),
        });
    }
    loads.push(far_from_the_origin(count / 10, seed));
    loads
}

/// An eye whose coordinates fill 60 bits, before splats at the next number of 31: differences of some hundred in the last bit.
fn far_from_the_origin(count: usize, seed: u64) -> SetupLoad {
    let view = straight(Projection::Perspective, FOCAL);
    let mut state = seed;
    let place = 1 << 59;
    let at_place = SoftFloat {
        mantissa: 1 << 30,
        exponent: 29 - FOCAL,
    };
    SetupLoad {
        name: "far from the origin, 3dgs".to_owned(),
        view: View {
            pose: Eye {
                position: [place + 3, place - 5, place - 1001],
                exponent: -FOCAL,
                ..view.pose
            },
            ..view
        },
        rules: KernelRules::GAUSSIAN_3D,
        splats: (0..count)
            .map(|_| VolumeSplat {
                centre: [at_place; 3],
                ..few_bits(&mut state)
            })
            .collect(),
    }
}

/// Pixels a unit, as a power of two.
const FOCAL: i32 = 9;
const TELEPHOTO: i32 = 40;

/// From the origin along z; orthographic: whatever the depth.
fn straight(projection: Projection, focal: i32) -> View {
    let (view, _) = hard_cases(1, [640, 480], 1);
    let [zero, one, _] = view.rotation[1];
    let end = |value| Extended {
        value,
        exponent: 1000,
    };
    let (near, far) = match projection {
        Projection::Perspective => (view.near, end(1)),
        Projection::Orthographic => (end(-1), end(1)),
    };
    View {
        rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        pose: Eye {
            position: [0; 3],
            ..view.pose
        },
        focal: [SoftFloat::from_wide(1, focal, 31); 2],
        near,
        far,
        projection,
        ..view
    }
}

/// A splat whose numbers have two bits and a sign, some tens of pixels around the middle, of some pixels' size.
fn few_bits(state: &mut u64) -> VolumeSplat {
    let mut number = |exponent: i32| SoftFloat {
        mantissa: [0, 0, 0, 1, 1, -1, -1, 2, 3, -3][(split_mix(state) % 10) as usize] << 24,
        exponent: exponent - 24,
    };
    let axes = [(); 3].map(|()| Axis {
        mantissa: [(); 3].map(|()| number(0).mantissa),
        exponent: -24 - FOCAL,
    });
    let aside = [number(-4), number(-3)];
    let powers = split_mix(state);
    VolumeSplat {
        centre: [
            aside[0],
            aside[1],
            SoftFloat {
                mantissa: 1,
                exponent: (powers % 2) as i32,
            },
        ],
        axes,
        weight: SoftFloat {
            mantissa: 1 << (powers >> 8 & 3),
            exponent: -2,
        },
        colour: [0.0, 0.5, 1.0].map(float::colour),
    }
}

/// Splats to all four sides of the middle at every power of two, with mantissas up to where a word ends.
fn aside(powers: Range<i32>, axes: i32) -> Vec<VolumeSplat> {
    let nothing = SoftFloat {
        mantissa: 0,
        exponent: 0,
    };
    let mut splats = Vec::new();
    for exponent in powers {
        for mantissa in [1 << 30, 3 << 29, 0x7f00_0000, i32::MAX] {
            for (axis, mantissa) in [(0, mantissa), (0, -mantissa), (1, mantissa), (1, -mantissa)] {
                let mut centre = [nothing; 3];
                centre[axis] = SoftFloat { mantissa, exponent };
                centre[2] = SoftFloat {
                    mantissa: 1,
                    exponent: 0,
                };
                splats.push(VolumeSplat {
                    centre,
                    axes: [0, 1, 2].map(|i| {
                        let mut mantissa = [0; 3];
                        mantissa[i] = 1 << 27;
                        Axis {
                            mantissa,
                            exponent: axes,
                        }
                    }),
                    weight: SoftFloat {
                        mantissa: 1,
                        exponent: -1,
                    },
                    colour: [0.0, 0.5, 1.0].map(float::colour),
                });
            }
        }
    }
    splats
}

fn name_of(rules: &KernelRules) -> &'static str {
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
