//! Setup on vectors against the kernel's, whole footprints and reasons, on ordinary splats and on arbitrary bits.

use super::*;
use crate::fixed::{QuantisedScene, kernel_rules};
use crate::rules;
use crate::scene::synthetic;
use fixed::types::U4F28;
use proptest::prelude::*;
use splatline::format::{Classic8, Deep32, Lean18, Standard24};
use splatline::setup::setup_surface;
use splatline::splat::surface::SurfaceSplat;

fn bits() -> impl Strategy<Value = i32> {
    prop_oneof![
        any::<i32>(),
        -3i32..4,
        (0u32..31, any::<bool>()).prop_map(|(e, s)| if s { -(1 << e) } else { (1 << e) - 1 })
    ]
}

/// Any bits; exponents mostly near those of scenes.
fn splat() -> impl Strategy<Value = VolumeSplat> {
    let exponent = prop_oneof![4 => -60i32..-20, 1 => any::<i32>(), 1 => -600i32..600];
    let axis = (prop::array::uniform3(bits()), exponent.clone())
        .prop_map(|(mantissa, exponent)| Axis { mantissa, exponent });
    // Normalised, as the host has them, or any.
    let normalised =
        (1i32 << 30..=i32::MAX, any::<bool>(), -40i32..-24).prop_map(|(m, s, exponent)| {
            SoftFloat {
                mantissa: if s { -m } else { m },
                exponent,
            }
        });
    let any_number = (bits(), exponent.clone())
        .prop_map(|(mantissa, exponent)| SoftFloat { mantissa, exponent });
    let centre = prop::array::uniform3(
        prop_oneof![20 => normalised, 1 => any_number, 1 => Just(SoftFloat::ZERO)],
    );
    (
        centre,
        prop::array::uniform3(axis),
        bits(),
        exponent,
        any::<[u32; 3]>(),
    )
        .prop_map(|(centre, axes, mantissa, exponent, colour)| VolumeSplat {
            centre,
            axes,
            weight: SoftFloat { mantissa, exponent },
            colour: colour.map(U4F28::from_bits),
        })
}

fn check<D: Design>(design: D, splats: &[VolumeSplat], rules: &Rules) {
    let scene = synthetic::random_gaussians(10, 1, 1.0);
    let camera = synthetic::camera(320, 200);
    let view = QuantisedScene::new(&scene, &camera, &rules::Rules::GAUSSIAN_3D).view;
    for choice in [VectorLevel::Best, VectorLevel::Avx2] {
        let mut outcomes = vec![Err(Cull::Near); splats.len()];
        set_up(design, &view, rules, splats, &mut outcomes, choice);
        for (splat, outcome) in splats.iter().zip(outcomes) {
            let expected = setup(design, &view, rules, splat);
            assert_eq!(outcome, expected, "{choice:?} {splat:?}");
        }
    }
}

proptest! {
    #[test]
    fn arbitrary_bits(splats in prop::collection::vec(splat(), 8..40), normalised: bool) {
        let rules = kernel_rules(if normalised { &rules::Rules::EWA } else { &rules::Rules::GAUSSIAN_3D });
        check(Classic8, &splats, &rules);
        check(Lean18, &splats, &rules);
        check(Standard24, &splats, &rules);
        check(Deep32, &splats, &rules);
    }
}

/// A surface splat of a volume splat's bits: two of its axes, and the third as the normal.
fn surface_splat(splat: &VolumeSplat) -> SurfaceSplat {
    let [first, second, normal] = splat.axes;
    SurfaceSplat {
        centre: splat.centre,
        frame: [first, second],
        normal,
        weight: splat.weight,
        colour: splat.colour,
        opacity: splat.colour[0],
        material: 3,
    }
}

fn check_surface<D: Design>(design: D, splats: &[SurfaceSplat], view: &View) {
    let rules = Rules::SURFACE;
    for choice in [VectorLevel::Best, VectorLevel::Avx2] {
        let mut outcomes = vec![Err(Cull::Near); splats.len()];
        set_up(design, view, &rules, splats, &mut outcomes, choice);
        for (splat, outcome) in splats.iter().zip(outcomes) {
            let expected = setup_surface(design, view, &rules, splat);
            assert_eq!(outcome, expected, "{choice:?} {splat:?}");
        }
    }
}

proptest! {
    #[test]
    fn surfaces_of_arbitrary_bits(splats in prop::collection::vec(splat(), 8..40)) {
        let scene = synthetic::random_gaussians(10, 1, 1.0);
        let camera = synthetic::camera(320, 200);
        let view = QuantisedScene::new(&scene, &camera, &rules::Rules::GAUSSIAN_3D).view;
        let splats: Vec<SurfaceSplat> = splats.iter().map(surface_splat).collect();
        check_surface(Classic8, &splats, &view);
        check_surface(Lean18, &splats, &view);
        check_surface(Standard24, &splats, &view);
        check_surface(Deep32, &splats, &view);
    }
}

#[test]
fn ordinary_surfaces() {
    let scene = synthetic::random_gaussians(4_000, 5, 3.0);
    let camera = synthetic::camera(320, 200);
    let quantised = QuantisedScene::with_depths(&scene, &camera, &rules::Rules::GAUSSIAN_3D);
    let splats: Vec<SurfaceSplat> = quantised.splats.iter().map(surface_splat).collect();
    check_surface(Standard24, &splats, &quantised.view);
    check_surface(Deep32, &splats, &quantised.view);
}

#[test]
fn ordinary_splats() {
    let scene = synthetic::random_gaussians(4_000, 5, 3.0);
    let camera = synthetic::camera(320, 200);
    for rules in [rules::Rules::EWA, rules::Rules::GAUSSIAN_3D] {
        let quantised = QuantisedScene::new(&scene, &camera, &rules);
        check(Standard24, &quantised.splats, &kernel_rules(&rules));
    }
}
