//! What is set up: captured scenes, hard cases, bits of which nobody made a splat, and splats under rules with a
//! spacing.

use super::exact::{FOCAL, few_bits, straight};
use crate::scenes::scenes;
use crate::unit::{Loads, Missing};
use anyhow::Result;
use splatline::float;
use splatline::format::Widths;
use splatline::math::SoftFloat;
use splatline::rules::Rules as KernelRules;
use splatline::setup::distance::enlargement;
use splatline::setup::project;
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Projection, View};
use splatline_sim::fixed::QuantisedScene;
use splatline_sim::rules::Rules;
use splatline_sim::scene::synthetic::Random;
use splatline_sim::vectors::hard_cases;

/// What is set up: splats seen by a camera under rules.
#[derive(Clone, Debug)]
pub struct SetupLoad {
    /// The camera.
    pub view: View,
    /// What its program is told.
    pub rules: KernelRules,
    /// In the order in which they are given.
    pub splats: Vec<VolumeSplat>,
}

impl SetupLoad {
    /// With its name, followed by that of the rules.
    pub fn named(
        name: &str,
        view: View,
        rules: KernelRules,
        splats: Vec<VolumeSplat>,
    ) -> (String, SetupLoad) {
        let of_rules = if rules.normalised { "ewa" } else { "3dgs" };
        let load = SetupLoad {
            view,
            rules,
            splats,
        };
        (format!("{name}, {of_rules}"), load)
    }
}

/// Both kinds of rules.
pub const KINDS: [KernelRules; 2] = [KernelRules::EWA, KernelRules::GAUSSIAN_3D];

/// Hard cases, arbitrary splats before a sane camera, and the same from an orthographic one.
pub fn synthetic(count: usize, seed: u64) -> Loads<SetupLoad> {
    let (view, splats) = hard_cases(count, [640, 480], 5);
    let flat = View {
        projection: Projection::Orthographic,
        ..view
    };
    let mut random = Random(seed);
    let near: Vec<VolumeSplat> = (0..count).map(|_| arbitrary(&mut random, 24)).collect();
    let wild: Vec<VolumeSplat> = (0..count).map(|_| arbitrary(&mut random, 1024)).collect();
    let mut loads = Vec::new();
    for rules in KINDS {
        for (name, view, splats) in [
            ("hard cases", view, &splats),
            ("hard cases, orthographic", flat, &splats),
            ("arbitrary splats", view, &near),
            ("arbitrary splats, orthographic", flat, &near),
            ("arbitrary bits", view, &wild),
        ] {
            loads.push(SetupLoad::named(name, view, rules, splats.clone()));
        }
    }
    loads
}

/// A number by its mantissa and exponent.
pub(super) const fn soft_float(mantissa: i32, exponent: i32) -> SoftFloat {
    SoftFloat { mantissa, exponent }
}

/// Every `step`-th splat of the scenes at hand under both kinds of rules.
pub fn captured(step: usize, missing: &mut Missing) -> Result<Loads<SetupLoad>> {
    let mut loads = Vec::new();
    for mut seen in scenes(&["guitar", "playbot", "lion"], 512, missing)? {
        let splats = std::mem::take(&mut seen.scene.splats);
        seen.scene.splats = splats.into_iter().step_by(step).collect();
        seen.scene.harmonics = None;
        for rules in [Rules::EWA, Rules::GAUSSIAN_3D] {
            let scene = QuantisedScene::new(&seen.scene, &seen.camera, &rules);
            let (view, rules, splats) = (scene.view, scene.rules, scene.splats);
            loads.push(SetupLoad::named(seen.name, view, rules, splats));
        }
    }
    Ok(loads)
}

/// A splat of random bits: mantissas from 0 to the ends of the format, exponents over `range` powers around those of a
/// usual scene.
fn arbitrary(random: &mut Random, range: u64) -> VolumeSplat {
    let mut exponent = |usual: i64| {
        let moved = (random.next() % range) as i64 - range as i64 / 2;
        (usual + moved).clamp(-512, 511) as i32
    };
    let exponents = [-28, -28, -28, -33, -33, -33, -30].map(&mut exponent);
    let mut mantissa = || {
        let bits = random.next();
        match bits % 16 {
            0 => 0,
            1 => i32::MIN,
            2 => 1 << ((bits >> 32) % 31),
            3 => i32::MAX,
            _ => (bits >> 32) as i32 >> ((bits >> 8) % 8),
        }
    };
    let mut number = |i: usize| soft_float(mantissa(), exponents[i]);
    let centre = [number(0), number(1), number(2)];
    let weight = number(6);
    let axes = [3, 4, 5].map(|i| Axis {
        mantissa: [(); 3].map(|()| number(i).mantissa),
        exponent: exponents[i],
    });
    let mut channel = || f64::from(number(0).mantissa as u32) / f64::from(1 << 28);
    let colour = [(); 3].map(|()| float::colour(channel()));
    VolumeSplat {
        centre,
        axes,
        weight,
        colour,
    }
}

/// Splats on both sides of the distance k and exactly there, for the program with distance scaling: about `count` of
/// each kind.
pub fn distant(count: usize) -> Loads<SetupLoad> {
    let mut loads = Vec::new();
    for (index, (name, mut load)) in synthetic(count, 1).into_iter().enumerate() {
        load.rules.spacing = match load.view.projection {
            // k lies where the camera of the hard cases looks at, 4 units away.
            Projection::Perspective => soft_float(13, -11),
            // All splats beyond k, or none.
            Projection::Orthographic => soft_float([11, 13][index % 2], -13),
        };
        // Pixels that are not square: higher than wide, or wider than high.
        let longer = &mut load.view.focal[index / 2 % 2];
        *longer = longer.multiply(SoftFloat::from_wide(5, -2, 31), 31);
        loads.push((name + ", with a spacing", load));
    }
    for rules in KINDS {
        for (name, projection) in [
            ("at k and at 2 k", Projection::Perspective),
            ("at k, orthographic", Projection::Orthographic),
        ] {
            let rules = KernelRules {
                spacing: soft_float(1, -FOCAL),
                ..rules
            };
            let view = straight(projection, FOCAL);
            loads.push(SetupLoad::named(name, view, rules, at_k(count)));
        }
    }
    // The rules of the loads above, which have no spacing, by the same circuit.
    loads.extend(synthetic(count, 2).into_iter().take(2));
    loads
}

/// How many of the splats lie beyond k.
pub fn enlarged(
    widths: &Widths,
    view: &View,
    rules: &KernelRules,
    splats: &[VolumeSplat],
) -> usize {
    let beyond = |splat: &&VolumeSplat| {
        let projected = project(widths, view, rules, &splat.centre);
        projected.is_ok_and(|projected| enlargement(widths, rules, &projected).is_some())
    };
    splats.iter().filter(beyond).count()
}

/// Splats at the distance k itself, which keep all bits of their weights, and (with perspective) at twice that
/// distance.
fn at_k(count: usize) -> Vec<VolumeSplat> {
    let mut random = Random(1);
    let splat = |_| VolumeSplat {
        weight: soft_float((random.next() >> 34) as i32 | 1, -30),
        ..few_bits(&mut random)
    };
    (0..count).map(splat).collect()
}

/// Words of a record.
pub const RECORD: usize = 19;

/// A splat as the unit takes it, and a word of nothing; nothing if an exponent has no place.
pub fn record(splat: &VolumeSplat) -> Option<[u32; RECORD + 1]> {
    let (centre, axes, weight) = (splat.centre, splat.axes, splat.weight);
    // Values with their bits, the lowest ones first.
    let mut fields: Vec<(u32, usize)> = Vec::new();
    fields.extend(centre.map(|place| (place.mantissa as u32, 32)));
    for place in centre {
        fields.push((exponent(place.exponent, place.mantissa == 0)?, 10));
    }
    let components = axes.iter().flat_map(|axis| axis.mantissa);
    fields.extend(components.map(|component| (component as u32, 32)));
    for axis in axes {
        fields.push((exponent(axis.exponent, axis.mantissa == [0; 3])?, 10));
    }
    fields.push((weight.mantissa as u32, 32));
    fields.push((exponent(weight.exponent, weight.mantissa == 0)?, 10));
    fields.extend(splat.colour.map(|channel| (channel.to_bits(), 32)));
    let bits = |(value, bits)| (0..bits).map(move |bit| value >> bit & 1);
    let mut words = [0; RECORD + 1];
    for (place, bit) in fields.into_iter().flat_map(bits).enumerate() {
        words[place / 32] |= bit << (place % 32);
    }
    Some(words)
}

/// Ten bits; 0 has any exponent.
fn exponent(value: i32, zero: bool) -> Option<u32> {
    match value {
        _ if zero => Some(0),
        -512..=511 => Some(value as u32 & 0x3ff),
        _ => None,
    }
}
