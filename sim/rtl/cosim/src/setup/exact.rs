//! Splats of few bits before cameras that turn nothing: what random numbers hardly ever make, and where mistakes hide that they do not show.
//!
//! Sums that are exactly 0 or a power of two; positions at every power around the end of a word; depths on the planes themselves; an eye whose coordinates
//! fill 60 bits; the least components of axes. Each stands for a mistake of `mutations.tsv` that captured scenes and random bits let pass.

use super::loads::{KINDS, SetupLoad, soft_float};
use crate::random::split_mix;
use fixed::types::I32F32;
use splatline::float;
use splatline::math::{Extended, SoftFloat};
use splatline::rules::Rules;
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Eye, Projection, View};
use splatline_sim::vectors::hard_cases;
use std::ops::Range;

/// All of them, about `count` splats of each kind.
pub fn exact(count: usize, seed: u64) -> Vec<SetupLoad> {
    let flat = straight(Projection::Orthographic, FOCAL);
    let near = straight(Projection::Perspective, FOCAL);
    let long = straight(Projection::Perspective, TELEPHOTO);
    let (ewa, trained) = (Rules::EWA, Rules::GAUSSIAN_3D);
    let mut loads = Vec::new();
    for (_, rules) in KINDS {
        for (name, view) in [("few bits", near), ("few bits, orthographic", flat)] {
            let splats = few(count, seed, |_, _| ());
            loads.push(SetupLoad::new(name, view, rules, splats));
        }
    }
    // From so near that most positions are inside to far beyond 64 bits, where the unit below the largest ends.
    for (name, view, powers, rules) in [
        ("far aside, orthographic", flat, -31..20, ewa),
        ("far aside, telephoto", long, -48..-28, trained),
    ] {
        let splats = aside(powers, -36 - (view.focal[0].exponent + 21));
        loads.push(SetupLoad::new(name, view, rules, splats));
    }
    loads.push(far_from_the_origin(near, count / 10, seed));
    for (name, view, planes) in [
        ("on the planes", near, [-4, 2]),
        ("on the planes, orthographic", flat, [-4, -1]),
    ] {
        let [near, far] = planes.map(|value| Extended { value, exponent: 0 });
        let splats = on_the_planes(count / 10, seed);
        loads.push(SetupLoad::new(
            name,
            View { near, far, ..view },
            ewa,
            splats,
        ));
    }
    loads.extend([0, 1, 1 << 18].map(|above| on_the_range(flat, above, seed)));
    loads.push(least_components(flat, count / 10));
    let on_the_edge = (0..count as i32 / 10).map(on_the_edge).collect();
    loads.push(SetupLoad::new("on the edge", flat, ewa, on_the_edge));
    let rules = Rules {
        low_pass: SoftFloat::ZERO,
        ..trained
    };
    let slanted = (0..count as i32 / 3).map(flat_and_slanted).collect();
    loads.push(SetupLoad::new("flat and slanted", flat, rules, slanted));
    loads
}

/// A depth of 1 on the axis.
const AHEAD: [SoftFloat; 3] = [SoftFloat::ZERO, SoftFloat::ZERO, soft_float(1, 0)];

const fn axis(mantissa: [i32; 3], exponent: i32) -> Axis {
    Axis { mantissa, exponent }
}

/// A splat with a power of two as its weight.
fn weighing(power: i32, centre: [SoftFloat; 3], axes: [Axis; 3]) -> VolumeSplat {
    VolumeSplat {
        centre,
        axes,
        weight: soft_float(1, power),
        colour: [0.0, 0.5, 1.0].map(float::colour),
    }
}

/// Depths of both planes and beside them, the near one behind the eye: equal negative numbers, and what an eye with perspective cannot see.
fn on_the_planes(count: usize, seed: u64) -> Vec<VolumeSplat> {
    few(count, seed, |index, splat| {
        splat.centre[2] = soft_float((index % 8) as i32 - 6, 0)
    })
}

/// Footprints four pixels wide to either side, and a thousandth: centres a part of a pixel apart, so that one ends exactly in the middle of a pixel.
fn on_the_edge(index: i32) -> VolumeSplat {
    let plain = |mantissa: [i32; 3]| axis(mantissa.map(|part| part << 24), -24 - FOCAL);
    let across = soft_float(120 + index, -8 - FOCAL);
    let axes = [[1, 1, 0], [1, -1, 0], [1, 0, 0]].map(plain);
    weighing(-12, [across, AHEAD[1], AHEAD[2]], axes)
}

/// Without a low-pass filter, four million times as wide as high and slanted: of all that has an exponent the conic's last coefficient is the largest,
/// and alone beyond the packet's exponents where `1 / Vyy` still has a place.
fn flat_and_slanted(index: i32) -> VolumeSplat {
    let size = -286 + index / 7 % 10;
    let axes = [
        axis([1 << 30, 1 << 8, 0], size),
        axis([0, 1 << 30, 0], size - 22 - index % 7),
        axis([0; 3], 0),
    ];
    weighing(-1, AHEAD, axes)
}

/// Axes with a component of -2^31, which counts as -(2^31 - 1), where this is the difference between two mantissas: the camera adds the next component,
/// and the sum lies in the middle.
fn least_components(view: View, count: usize) -> SetupLoad {
    let [across, along, ahead] = view.rotation;
    let one = across[0];
    let splat = |index: i32| {
        let half_up = (((1 << 17) + index) << 13) + (1 << 12);
        let mut axes = [axis([0, 0, 1 << 27], -27 - FOCAL); 3];
        axes[0].mantissa = [i32::MIN, i32::MAX - half_up, 0];
        weighing(-1, AHEAD, axes)
    };
    let view = View {
        rotation: [[one, one, across[2]], along, ahead],
        ..view
    };
    let splats = (0..count as i32).map(splat).collect();
    SetupLoad::new("least components", view, Rules::EWA, splats)
}

/// An eye whose coordinates fill 60 bits, before splats at the next number of 31: differences of some hundred in the last bit.
fn far_from_the_origin(mut view: View, count: usize, seed: u64) -> SetupLoad {
    let place = 1 << 59;
    view.pose.position = [place + 3, place - 5, place - 1001];
    view.pose.exponent = -FOCAL;
    let centre = [soft_float(1 << 30, 29 - FOCAL); 3];
    let splats = few(count, seed, |_, splat| splat.centre = centre);
    SetupLoad::new("far from the origin", view, Rules::GAUSSIAN_3D, splats)
}

/// Positions of -2^26 pixels, which are out of range, or by so many of the last bits nearer, which are not.
fn on_the_range(mut view: View, above: i64, seed: u64) -> SetupLoad {
    view.principal[0] = I32F32::from_bits(above - (1 << 58));
    let splats = few(8, seed, |_, splat| splat.centre = AHEAD);
    let name = format!("{above} above the range's end");
    SetupLoad::new(&name, view, Rules::GAUSSIAN_3D, splats)
}

/// Pixels a unit, as a power of two.
pub(super) const FOCAL: i32 = 9;
const TELEPHOTO: i32 = 40;

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
fn few(count: usize, seed: u64, change: impl Fn(usize, &mut VolumeSplat)) -> Vec<VolumeSplat> {
    let mut state = seed;
    let splat = |index| {
        let mut splat = few_bits(&mut state);
        change(index, &mut splat);
        splat
    };
    (0..count).map(splat).collect()
}

/// A splat whose numbers have two bits and a sign, some tens of pixels around the middle, of some pixels' size.
pub(super) fn few_bits(state: &mut u64) -> VolumeSplat {
    let mut number = |exponent: i32| {
        let values = [0, 0, 0, 1, 1, -1, -1, 2, 3, -3];
        let value: i32 = values[(split_mix(state) % 10) as usize];
        soft_float(value << 24, exponent - 24)
    };
    let axes = [(); 3].map(|()| {
        let mantissa = [(); 3].map(|()| number(0).mantissa);
        axis(mantissa, -24 - FOCAL)
    });
    let aside = [number(-4), number(-3)];
    let powers = split_mix(state) >> 32;
    VolumeSplat {
        centre: [aside[0], aside[1], soft_float(1, (powers % 2) as i32)],
        axes,
        weight: soft_float(1 << (powers >> 8 & 3), -2),
        // The middle between an even and an odd number, whatever bits a colour has.
        colour: [0.0, 0.5 + 0.5f64.powi((powers >> 16) as i32 % 24 + 5), 1.0].map(float::colour),
    }
}

/// Splats to all four sides of the middle at every power of two, with mantissas up to where a word ends.
fn aside(powers: Range<i32>, size: i32) -> Vec<VolumeSplat> {
    let axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let axes = axes.map(|mantissa| axis(mantissa.map(|part| part << 27), size));
    let mut splats = Vec::new();
    for exponent in powers {
        for mantissa in [1 << 30, 3 << 29, 0x7f00_0000, i32::MAX] {
            for (side, mantissa) in [(0, mantissa), (0, -mantissa), (1, mantissa), (1, -mantissa)] {
                let mut centre = AHEAD;
                centre[side] = soft_float(mantissa, exponent);
                splats.push(weighing(-1, centre, axes));
            }
        }
    }
    splats
}
