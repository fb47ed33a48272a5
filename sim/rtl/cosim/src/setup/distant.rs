//! Splats under rules with a spacing, on both sides of the distance k and exactly there, for the program with distance scaling.

use super::exact::{FOCAL, few_bits, straight};
use super::loads::{KINDS, SetupLoad, soft_float, synthetic};
use crate::random::Random;
use crate::unit::Loads;
use splatline::format::Widths;
use splatline::math::SoftFloat;
use splatline::rules::Rules;
use splatline::setup::distance::enlargement;
use splatline::setup::project;
use splatline::splat::VolumeSplat;
use splatline::view::{Projection, View};

/// About `count` splats of each kind.
pub fn distant(count: usize, seed: u64) -> Loads<SetupLoad> {
    let mut loads = Vec::new();
    for (index, (name, mut load)) in synthetic(count, seed).into_iter().enumerate() {
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
    for (_, rules) in KINDS {
        for (name, projection) in [
            ("at k and at 2 k", Projection::Perspective),
            ("at k, orthographic", Projection::Orthographic),
        ] {
            let rules = Rules {
                spacing: soft_float(1, -FOCAL),
                ..rules
            };
            let view = straight(projection, FOCAL);
            loads.push(SetupLoad::named(name, view, rules, at_k(count, seed)));
        }
    }
    // The rules of the loads above, which have no spacing, by the same circuit.
    loads.extend(synthetic(count, seed + 1).into_iter().take(2));
    loads
}

/// How many of the splats lie beyond k.
pub fn enlarged(widths: &Widths, view: &View, rules: &Rules, splats: &[VolumeSplat]) -> usize {
    let beyond = |splat: &&VolumeSplat| {
        let projected = project(widths, view, rules, &splat.centre);
        projected.is_ok_and(|projected| enlargement(widths, rules, &projected).is_some())
    };
    splats.iter().filter(beyond).count()
}

/// Splats at the distance k itself, which keep all bits of their weights, and (with perspective) at twice that distance.
fn at_k(count: usize, seed: u64) -> Vec<VolumeSplat> {
    let mut random = Random(seed);
    let splat = |_| VolumeSplat {
        weight: soft_float((random.next() >> 34) as i32 | 1, -30),
        ..few_bits(&mut random)
    };
    (0..count).map(splat).collect()
}
