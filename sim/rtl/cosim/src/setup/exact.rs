//! Splats of few bits before cameras that turn nothing: what random numbers hardly ever make, and where mistakes hide that they do not show.
//!
//! Sums that are exactly 0 or a power of two; positions at every power around the end of a word; depths on the planes themselves; an eye whose coordinates
//! fill 60 bits; the least components of axes. Each stands for a mistake of `mutations.tsv` that captured scenes and random bits let pass.

use super::loads::{name_of, rules, soft_float};
use super::unit::SetupLoad;
use crate::random::split_mix;
use fixed::types::I32F32;
use splatline::float;
use splatline::math::{Extended, SoftFloat};
use splatline::rules::Rules as KernelRules;
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Eye, Projection, View};
use splatline_sim::vectors::hard_cases;
use std::ops::Range;

/// All of them, about `count` splats of each kind.
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
    for (word, projection, planes) in [
        ("", Projection::Perspective, [-4, 2]),
        (", orthographic", Projection::Orthographic, [-4, -1]),
    ] {
        let mut load = on_the_planes(count / 10, seed, projection, planes);
        load.name = format!("on the planes{word}, ewa");
        loads.push(load);
    }
    loads.extend([0, 1, 1 << 18].map(|above| on_the_range(above, seed)));
    loads.push(least_components(count / 10));
    loads.push(on_the_edge(count / 10));
    loads.push(flat_and_slanted(count / 3));
    loads
}

/// Depths of both planes and beside them, the near one behind the eye: equal negative numbers, and what an eye with perspective cannot see.
fn on_the_planes(
    count: usize,
    seed: u64,
    projection: Projection,
    [near, far]: [i64; 2],
) -> SetupLoad {
    let depth = |value| Extended { value, exponent: 0 };
    let mut state = seed;
    SetupLoad {
        name: String::new(),
        view: View {
            near: depth(near),
            far: depth(far),
            ..straight(projection, FOCAL)
        },
        rules: KernelRules::EWA,
        splats: (0..count)
            .map(|index| {
                let mut splat = few_bits(&mut state);
                splat.centre[2] = soft_float((index % 8) as i32 - 6, 0);
                splat
            })
            .collect(),
    }
}

/// Footprints four pixels wide to either side, and a thousandth: centres a part of a pixel apart, so that one ends exactly in the middle of a pixel.
fn on_the_edge(count: usize) -> SetupLoad {
    let plain = |mantissa: [i32; 3]| Axis {
        mantissa: mantissa.map(|component| component << 24),
        exponent: -24 - FOCAL,
    };
    let splat = |index: usize| VolumeSplat {
        centre: [
            soft_float(120 + index as i32, -8 - FOCAL),
            SoftFloat::ZERO,
            soft_float(1, 0),
        ],
        axes: [plain([1, 1, 0]), plain([1, -1, 0]), plain([1, 0, 0])],
        weight: soft_float(1, -12),
        colour: [0.0, 0.5, 1.0].map(float::colour),
    };
    SetupLoad {
        name: "on the edge, ewa".to_owned(),
        view: straight(Projection::Orthographic, FOCAL),
        rules: KernelRules::EWA,
        splats: (0..count).map(splat).collect(),
    }
}

/// Without a low-pass filter, four million times as wide as high and slanted: of all that has an exponent the conic's last coefficient is the largest,
/// and alone beyond the packet's exponents where `1 / Vyy` still has a place.
fn flat_and_slanted(count: usize) -> SetupLoad {
    let axis = |mantissa, exponent| Axis { mantissa, exponent };
    let size = |index: usize| -286 + (index / 7 % 10) as i32;
    let splat = |index: usize| VolumeSplat {
        centre: [0, 0, 1].map(|mantissa| soft_float(mantissa, 0)),
        axes: [
            axis([1 << 30, 1 << 8, 0], size(index)),
            axis([0, 1 << 30, 0], size(index) - 22 - (index % 7) as i32),
            axis([0; 3], 0),
        ],
        weight: soft_float(1, -1),
        colour: [0.0, 0.5, 1.0].map(float::colour),
    };
    SetupLoad {
        name: "flat and slanted, 3dgs".to_owned(),
        view: straight(Projection::Orthographic, FOCAL),
        rules: KernelRules {
            low_pass: SoftFloat::ZERO,
            ..KernelRules::GAUSSIAN_3D
        },
        splats: (0..count).map(splat).collect(),
    }
}

/// Axes with a component of -2^31, which counts as -(2^31 - 1), where this is the difference between two mantissas: the camera adds the next component,
/// and the sum lies in the middle.
fn least_components(count: usize) -> SetupLoad {
    let view = straight(Projection::Orthographic, FOCAL);
    let [across, along, ahead] = view.rotation;
    let one = across[0];
    let splat = |index: usize| {
        let half_up = (((1 << 17) + index as i32) << 13) + (1 << 12);
        let mut axes = [Axis {
            mantissa: [0, 0, 1 << 27],
            exponent: -27 - FOCAL,
        }; 3];
        axes[0] = Axis {
            mantissa: [i32::MIN, i32::MAX - half_up, 0],
            exponent: -27 - FOCAL,
        };
        VolumeSplat {
            centre: [0, 0, 1].map(|mantissa| soft_float(mantissa, 0)),
            axes,
            weight: soft_float(1, -1),
            colour: [0.0, 0.5, 1.0].map(float::colour),
        }
    };
    SetupLoad {
        name: "least components, ewa".to_owned(),
        view: View {
            rotation: [[one, one, across[2]], along, ahead],
            ..view
        },
        rules: KernelRules::EWA,
        splats: (0..count).map(splat).collect(),
    }
}

/// An eye whose coordinates fill 60 bits, before splats at the next number of 31: differences of some hundred in the last bit.
fn far_from_the_origin(count: usize, seed: u64) -> SetupLoad {
    let view = straight(Projection::Perspective, FOCAL);
    let mut state = seed;
    let place = 1 << 59;
    let at_place = soft_float(1 << 30, 29 - FOCAL);
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

/// Positions of -2^26 pixels, which are out of range, or by so many of the last bits nearer, which are not.
fn on_the_range(above: i64, seed: u64) -> SetupLoad {
    let view = straight(Projection::Orthographic, FOCAL);
    let edge = I32F32::from_bits(above - (1 << 58));
    let mut state = seed;
    SetupLoad {
        name: format!("{above} above the range's end, 3dgs"),
        view: View {
            principal: [edge, view.principal[1]],
            ..view
        },
        rules: KernelRules::GAUSSIAN_3D,
        splats: (0..8)
            .map(|_| VolumeSplat {
                centre: [SoftFloat::ZERO, SoftFloat::ZERO, soft_float(1, 0)],
                ..few_bits(&mut state)
            })
            .collect(),
    }
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
pub(super) fn few_bits(state: &mut u64) -> VolumeSplat {
    let mut number = |exponent: i32| {
        soft_float(
            [0, 0, 0, 1, 1, -1, -1, 2, 3, -3][(split_mix(state) % 10) as usize] << 24,
            exponent - 24,
        )
    };
    let axes = [(); 3].map(|()| Axis {
        mantissa: [(); 3].map(|()| number(0).mantissa),
        exponent: -24 - FOCAL,
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
fn aside(powers: Range<i32>, axes: i32) -> Vec<VolumeSplat> {
    let mut splats = Vec::new();
    for exponent in powers {
        for mantissa in [1 << 30, 3 << 29, 0x7f00_0000, i32::MAX] {
            for (axis, mantissa) in [(0, mantissa), (0, -mantissa), (1, mantissa), (1, -mantissa)] {
                let mut centre = [SoftFloat::ZERO; 3];
                centre[axis] = soft_float(mantissa, exponent);
                centre[2] = soft_float(1, 0);
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
                    weight: soft_float(1, -1),
                    colour: [0.0, 0.5, 1.0].map(float::colour),
                });
            }
        }
    }
    splats
}
