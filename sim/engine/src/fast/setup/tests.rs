//! Setup on vectors against the kernel's, whole footprints and reasons, on ordinary splats and on arbitrary bits.

use super::real::Real;
use super::*;
use crate::fast::lanes::Portable;
use crate::fast::tests::{normalised, number};
use crate::fixed::{QuantisedScene, kernel_rules};
use crate::rules;
use crate::scene::synthetic;
use fixed::types::U4F28;
use proptest::prelude::*;
use splatline::format::{Classic8, Deep32, Lean18, Standard24};
use splatline::math::sum_of_products;
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
    // Trained scenes have axes of almost no length.
    let exponent =
        prop_oneof![4 => -60i32..-20, 2 => -120i32..-40, 1 => any::<i32>(), 1 => -600i32..600];
    let axis = (prop::array::uniform3(bits()), exponent.clone())
        .prop_map(|(mantissa, exponent)| Axis { mantissa, exponent });
    let any_number = || number(bits(), exponent.clone());
    let coordinate =
        prop_oneof![20 => normalised(-40i32..-24), 1 => any_number(), 1 => Just(SoftFloat::ZERO)];
    let places = (
        prop::array::uniform3(coordinate),
        prop::array::uniform3(axis),
    );
    (places, any_number(), any::<[u32; 3]>()).prop_map(|((centre, axes), weight, colour)| {
        VolumeSplat {
            centre,
            axes,
            weight,
            colour: colour.map(U4F28::from_bits),
        }
    })
}

/// Sets splats up by vectors; `alone` is the kernel's outcome of one.
fn check_all<S, T>(
    widths: Widths,
    (view, rules): (&View, &Rules),
    splats: &[S],
    alone: impl Fn(&S) -> Result<T, Cull>,
) where
    S: Batched<Outcome = Result<T, Cull>> + std::fmt::Debug,
    T: Clone + PartialEq + std::fmt::Debug,
{
    let fields = RuntimeWidths::new(widths).unwrap();
    for choice in [VectorLevel::Best, VectorLevel::Avx2] {
        let mut outcomes = vec![Err(Cull::Near); splats.len()];
        set_up(fields, view, rules, splats, &mut outcomes, Some(choice));
        for (splat, outcome) in splats.iter().zip(outcomes) {
            assert_eq!(outcome, alone(splat), "{choice:?} {splat:?}");
        }
    }
}

fn quantised(count: usize, rules: &rules::Rules) -> QuantisedScene {
    let scene = synthetic::random_gaussians(count, 5, 3.0);
    QuantisedScene::new(&scene, &synthetic::camera(320, 200), rules)
}

fn check<D: Design>(design: D, splats: &[VolumeSplat], rules: &Rules) {
    let view = quantised(10, &rules::Rules::GAUSSIAN_3D).view;
    let alone = |splat: &VolumeSplat| setup(design, &view, rules, splat);
    check_all(design.widths(), (&view, rules), splats, alone);
}

/// Arrays are what processors without vectors of their own would use; here the kernel is faster.
#[test]
fn arrays_set_up_as_well() {
    for stated in [rules::Rules::EWA, rules::Rules::GAUSSIAN_3D] {
        let QuantisedScene { view, splats, .. } = quantised(2_000, &stated);
        let rules = kernel_rules(&stated);
        let mut outcomes = vec![Err(Cull::Near); splats.len()];
        let batch = SetupBatch {
            design: RuntimeWidths::new(Deep32.widths()).unwrap(),
            view: &view,
            rules: &rules,
            splats: &splats,
            outcomes: &mut outcomes,
        };
        batch.run(Portable);
        for (splat, outcome) in splats.iter().zip(outcomes) {
            assert_eq!(outcome, setup(Deep32, &view, &rules, splat), "{splat:?}");
        }
    }
}

proptest! {
    /// The oracle is the kernel's arithmetic.
    #[test]
    fn reals_are_soft_floats(numbers in prop::collection::vec((normal(), normal(), normal(), normal()), 32..=32), bits in 16u32..=31) {
        let lanes = Portable;
        for (a, b, c, d) in numbers {
            let doubt = Cell::new(lanes.splat(0));
            let reals = Reals { lanes, doubt: &doubt };
            let [x, y, z, w] = [a, b, c, d].map(|number| reals.number(number));
            let same = |got: Real<Portable>, expected: SoftFloat| {
                let expected = reals.number(expected);
                prop_assert_eq!(got.0[0] << 1, expected.0[0] << 1);
                prop_assert!(got.0[0] == expected.0[0] || got.0[0] << 1 == 0);
                Ok(())
            };
            same(reals.multiply(x, y, bits), a.multiply(b, bits))?;
            let positive = |number: SoftFloat| SoftFloat { mantissa: number.mantissa.abs(), ..number };
            let [p, q] = [positive(a), positive(b)];
            let [px, py] = [reals.magnitude(x), reals.magnitude(y)];
            same(reals.reciprocal(px, bits), splatline::math::reciprocal(p, bits).unwrap())?;
            let sum = reals.sum([reals.term(px), reals.term(py)], bits);
            same(sum, sum_of_products([p.term_within(31), q.term_within(31)], bits))?;
            let sum = reals.sum([reals.product(x, y, 62), reals.product(z, w, 62)], bits);
            same(sum, sum_of_products([a.times(b), c.times(d)], bits))?;
            let sum = reals.sum([reals.product(x, y, 62), reals.product(z, w, 62), reals.product(x, z, 62), reals.term(y)], bits);
            same(sum, sum_of_products([a.times(b), c.times(d), a.times(c), b.term_within(31)], bits))?;
            // A root's argument has no more bits than its root.
            let short = SoftFloat::from_wide(p.mantissa.into(), p.exponent, bits);
            same(reals.square_root(reals.number(short), bits), splatline::math::square_root(short, bits))?;
            prop_assert!(doubt.get() == [0; 8]);
        }
    }
}

/// Normalised numbers, many of few bits, of similar size.
fn normal() -> impl Strategy<Value = SoftFloat> {
    (normalised(-34i32..-26), 0u32..31).prop_map(|(SoftFloat { mantissa, exponent }, zeros)| {
        let short = (mantissa.abs() >> zeros << zeros).max(1 << 30);
        SoftFloat {
            mantissa: short * mantissa.signum(),
            exponent,
        }
    })
}

proptest! {
    #[test]
    fn arbitrary_bits(splats in prop::collection::vec(splat(), 8..40), normalised: bool, spacing in spacing()) {
        let rules = kernel_rules(if normalised { &rules::Rules::EWA } else { &rules::Rules::GAUSSIAN_3D });
        check(Classic8, &splats, &rules);
        check(Lean18, &splats, &rules);
        check(Standard24, &splats, &rules);
        check(Deep32, &splats, &rules);
        // Enlarged by their distance: all, some, none of the splats of usual depths.
        let spaced = Rules { spacing, ..rules };
        check(Classic8, &splats, &spaced);
        check(Standard24, &splats, &spaced);
        check(Deep32, &splats, &spaced);
        // Peaks compensated for the filter: of large splats, of slender ones, and of those without area.
        let compensated = Rules { compensated: true, ..rules };
        check(Classic8, &splats, &compensated);
        check(Lean18, &splats, &compensated);
        check(Standard24, &splats, &compensated);
        check(Deep32, &splats, &compensated);
        // Nothing hides how small a variance is.
        let low_pass = SoftFloat::ZERO;
        check(Lean18, &splats, &Rules { low_pass, ..rules });
        check(Deep32, &splats, &Rules { low_pass, ..compensated });
    }
}

/// Distances between samples, some beyond what vectors take.
fn spacing() -> impl Strategy<Value = SoftFloat> {
    let exponent = prop_oneof![8 => -50i32..-26, 1 => -80i32..20];
    number(1i32 << 30..=i32::MAX, exponent)
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
    let alone = |splat: &SurfaceSplat| setup_surface(design, view, &rules, splat);
    check_all(design.widths(), (view, &rules), splats, alone);
}

proptest! {
    #[test]
    fn surfaces_of_arbitrary_bits(splats in prop::collection::vec(splat(), 8..40)) {
        let view = quantised(10, &rules::Rules::GAUSSIAN_3D).view;
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
    let ways = [rules::Rules::EWA, rules::Rules::GAUSSIAN_3D];
    // Of about a pixel's distance, so that some splats are enlarged and some are not.
    let spaced = ways.map(|rules| rules.with_antialias(rules::Antialias::Swan(0.012)));
    for rules in ways.into_iter().chain(spaced) {
        let splats = quantised(4_000, &rules).splats;
        check(Standard24, &splats, &kernel_rules(&rules));
    }
}
