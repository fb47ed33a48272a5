//! What random numbers hardly ever make, and where mistakes hide that they do not show: the cases of the test vectors,
//! at the ends of formats and ranges, and splats of few bits before cameras that turn nothing.
//!
//! Sums that are exactly 0 or a power of two; depths on the planes themselves; an eye whose coordinates fill 60 bits.
//! Each stands for a mistake of `mutations.tsv` that captured scenes, random bits and test vectors let pass.

use super::loads::{KINDS, SetupLoad, soft_float};
use crate::unit::Loads;
use fixed::types::I32F32;
use splatline::float;
use splatline::format::Widths;
use splatline::math::{Extended, SoftFloat};
use splatline::rules::Rules;
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Eye, Projection, View};
use splatline_sim::scene::synthetic::Random;
use splatline_sim::vectors::{hard_cases, stress_cases, stress_orthographic, stress_view};

/// All of them, about `count` splats of each kind of few bits, for these widths.
pub fn exact(widths: &Widths, count: usize) -> Loads<SetupLoad> {
    let flat = straight(Projection::Orthographic, FOCAL);
    let near = straight(Projection::Perspective, FOCAL);
    let [ends, flat_ends] = ends(widths);
    let mut loads = Vec::new();
    for rules in KINDS {
        let unfiltered = Rules {
            low_pass: SoftFloat::ZERO,
            ..rules
        };
        let few_bits = few(count, |_, _| ());
        let slanted = (0..count as i32 / 3).map(flat_and_slanted).collect();
        for (name, rules, (view, splats)) in [
            ("few bits", rules, (near, few_bits.clone())),
            ("few bits, orthographic", rules, (flat, few_bits)),
            ("ends of formats", rules, ends.clone()),
            ("ends of formats, unfiltered", unfiltered, ends.clone()),
            ("ends of formats, orthographic", rules, flat_ends.clone()),
            ("flat and slanted", unfiltered, (flat, slanted)),
        ] {
            loads.push(SetupLoad::named(name, view, rules, splats));
        }
    }
    loads.extend([0, 1, 1 << 18].map(|above| on_the_range(flat, above)));
    loads.push(far_from_the_origin(near, count / 10));
    loads.push(on_the_planes(near, count / 10));
    loads
}

/// The cases that test vectors are made of, by their cameras with perspective and without.
fn ends(widths: &Widths) -> [(View, Vec<VolumeSplat>); 2] {
    let ((mut view, _), splats) = (hard_cases(1, [640, 480], 1), stress_cases());
    let (mut flat, mut flat_splats) = (view, splats.clone());
    stress_view(&mut view, widths);
    stress_orthographic(&mut flat, &mut flat_splats, widths);
    [(view, splats), (flat, flat_splats)]
}

/// A depth of 1 on the axis.
const AHEAD: [SoftFloat; 3] = [SoftFloat::ZERO, SoftFloat::ZERO, soft_float(1, 0)];

const fn axis(mantissa: [i32; 3], exponent: i32) -> Axis {
    Axis { mantissa, exponent }
}

/// Depths of both planes and beside them, the near one behind the eye: equal negative numbers, and what an eye with
/// perspective cannot see.
fn on_the_planes(mut view: View, count: usize) -> (String, SetupLoad) {
    let plane = |value| Extended { value, exponent: 0 };
    (view.near, view.far) = (plane(-4), plane(2));
    let splats = few(count, |index, splat| {
        splat.centre[2] = soft_float((index % 8) as i32 - 6, 0)
    });
    SetupLoad::named("on the planes", view, Rules::EWA, splats)
}

/// Without a low-pass filter, four million times as wide as high and slanted: of all that has an exponent the conic's
/// last coefficient is the largest, and alone beyond the packet's exponents where `1 / Vyy` still has a place.
fn flat_and_slanted(index: i32) -> VolumeSplat {
    let size = -286 + index / 7 % 10;
    let axes = [
        axis([1 << 30, 1 << 8, 0], size),
        axis([0, 1 << 30, 0], size - 22 - index % 7),
        axis([0; 3], 0),
    ];
    VolumeSplat {
        centre: AHEAD,
        axes,
        weight: soft_float(1, -1),
        colour: [0.0, 0.5, 1.0].map(float::colour),
    }
}

/// An eye whose coordinates fill 60 bits, before splats at the next number of 31: differences of some hundred in the
/// last bit.
fn far_from_the_origin(mut view: View, count: usize) -> (String, SetupLoad) {
    let place = 1 << 59;
    view.pose.position = [place + 3, place - 5, place - 1001];
    view.pose.exponent = -FOCAL;
    let centre = [soft_float(1 << 30, 29 - FOCAL); 3];
    let splats = few(count, |_, splat| splat.centre = centre);
    SetupLoad::named("far from the origin", view, Rules::GAUSSIAN_3D, splats)
}

/// Positions of -2^26 pixels, which are out of range, or by so many of the last bits nearer, which are not.
fn on_the_range(mut view: View, above: i64) -> (String, SetupLoad) {
    view.principal[0] = I32F32::from_bits(above - (1 << 58));
    let splats = few(8, |_, splat| splat.centre = AHEAD);
    let name = format!("{above} above the range's end");
    SetupLoad::named(&name, view, Rules::GAUSSIAN_3D, splats)
}

/// Pixels a unit, as a power of two.
pub(super) const FOCAL: i32 = 9;

/// From the origin along z; orthographic: whatever the depth.
pub(super) fn straight(projection: Projection, focal: i32) -> View {
    let (view, _) = hard_cases(1, [640, 480], 1);
    let [zero, one, _] = view.rotation[1];
    let end = |value| Extended {
        value,
        exponent: 1000,
    };
    let near = match projection {
        Projection::Perspective => view.near,
        Projection::Orthographic => end(-1),
    };
    View {
        rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        pose: Eye {
            position: [0; 3],
            ..view.pose
        },
        focal: [SoftFloat::from_wide(1, focal, 31); 2],
        near,
        far: end(1),
        projection,
        ..view
    }
}

/// Splats of few bits, each of them changed.
fn few(count: usize, change: impl Fn(usize, &mut VolumeSplat)) -> Vec<VolumeSplat> {
    let mut random = Random(1);
    let splat = |index| {
        let mut splat = few_bits(&mut random);
        change(index, &mut splat);
        splat
    };
    (0..count).map(splat).collect()
}

/// A splat whose numbers have two bits and a sign, some tens of pixels around the middle, of some pixels' size.
pub(super) fn few_bits(random: &mut Random) -> VolumeSplat {
    let mut number = |exponent: i32| {
        let values = [0, 0, 0, 1, 1, -1, -1, 2, 3, -3];
        let value: i32 = values[(random.next() % 10) as usize];
        soft_float(value << 24, exponent - 24)
    };
    let axes = [(); 3].map(|()| {
        let mantissa = [(); 3].map(|()| number(0).mantissa);
        axis(mantissa, -24 - FOCAL)
    });
    let aside = [number(-4), number(-3)];
    let powers = random.next() >> 32;
    VolumeSplat {
        centre: [aside[0], aside[1], soft_float(1, (powers % 2) as i32)],
        axes,
        weight: soft_float(1 << (powers >> 8 & 3), -2),
        // The middle between an even and an odd number, whatever bits a colour has.
        colour: [0.0, 0.5 + 0.5f64.powi((powers >> 16) as i32 % 24 + 5), 1.0].map(float::colour),
    }
}
