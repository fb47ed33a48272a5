//! Sheets against their formulas in double precision, and slabs that partition space.

use super::*;
use crate::format::Standard24;
use crate::math::SoftFloat;
use crate::rules::Rules;
use crate::splat::Axis;
use crate::view::View;
use fixed::types::{I2F30, I8F24, I32F32};
use proptest::prelude::*;
extern crate std;
use std::vec::Vec;

const WIDTHS: Widths = Standard24::WIDTHS;

fn value(pixel: &Pixel) -> [f64; 4] {
    let [r, g, b] = pixel
        .colour
        .map(|c| f64::from(c) / 2f64.powi(WIDTHS.accumulator.into()));
    [r, g, b, f64::from(pixel.transmittance()) / 2f64.powi(30)]
}

fn pixel() -> impl Strategy<Value = Pixel> {
    (proptest::array::uniform3(0u32..1 << 24), 0u32..=1 << 30).prop_map(
        |(colour, transmittance)| Pixel {
            colour,
            transmittance,
        },
    )
}

proptest! {
    #[test]
    fn sheets_follow_the_formula(back in pixel(), sheet in pixel()) {
        let mut rules = Rules::EWA;
        rules.minimum_transmittance = 0;
        let blend = Blend::new(&WIDTHS, &rules);
        let (b, s) = (value(&back), value(&sheet));
        let (mut behind, mut over) = (back, back);
        blend.sheet_behind(&mut behind, &sheet);
        blend.sheet_over(&mut over, &sheet);
        for channel in 0..3 {
            let expected = b[channel] + b[3] * s[channel];
            prop_assert!((value(&behind)[channel] - expected).abs() < 2f64.powi(-24));
            let expected = b[channel] * s[3] + s[channel];
            prop_assert!((value(&over)[channel] - expected).abs() < 2f64.powi(-24));
        }
        prop_assert!((value(&behind)[3] - b[3] * s[3]).abs() < 2f64.powi(-30));
        prop_assert!((value(&over)[3] - b[3] * s[3]).abs() < 2f64.powi(-30));
    }

    #[test]
    fn no_bits_panic(
        colour: [u32; 3], transmittance: u32, sheet: [u32; 3], opacity: u32,
        depth: u32, nearest: u32, per_unit: u32, slab: u32, mantissa: i32, exponent: i32, centre: [(i32, i32); 3], axis: usize,
    ) {
        let blend = Blend::new(&WIDTHS, &Rules::EWA);
        let mut pixel = Pixel { colour, transmittance };
        let sheet = Pixel { colour: sheet, transmittance: opacity };
        blend.sheet_behind(&mut pixel, &sheet);
        blend.sheet_over(&mut pixel, &sheet);
        let spread = SoftFloat { mantissa, exponent };
        let slabs = DepthSlabs { nearest, per_unit };
        prop_assert!(slabs.fraction_in(slab, depth, spread) <= 1 << 16);
        let facing = Facing { axis, ascending: depth % 2 == 0 };
        AxisSlabs { facing, first: I8F24::from_bits(mantissa), per_unit }.slab(centre.map(|(mantissa, exponent)| SoftFloat { mantissa, exponent }));
    }

    #[test]
    fn shares_of_a_kernel_sum_to_one(depth in 0u32..1 << 30, spread in 0.0f64..4.0, per_unit in 1u32..1 << 18) {
        let slabs = DepthSlabs { nearest: 1 << 23, per_unit };
        let spread = SoftFloat::from_wide((spread * 2f64.powi(30)) as i64, -30, 31);
        let (first, last) = slabs.reach(depth, spread);
        let sum: u32 = (first..=last).map(|slab| slabs.fraction_in(slab, depth, spread)).sum();
        prop_assert_eq!(sum, 1 << 16);
        prop_assert_eq!(slabs.fraction_in(last + 1, depth, spread), 0);
    }
}

#[test]
fn shares_are_the_normal_distribution() {
    // A kernel of spread 1 slab in the middle of slab 5.
    let slabs = DepthSlabs {
        nearest: 0,
        per_unit: 1 << 16,
    };
    let one = SoftFloat::from_wide(1, 0, 31);
    let share = |slab| f64::from(slabs.fraction_in(slab, 11 << 22, one)) / 65536.0;
    let expected = [0.0062, 0.0606, 0.2417, 0.3829, 0.2417, 0.0606, 0.0062];
    for (slab, expected) in (2..9).zip(expected) {
        assert!(
            (share(slab) - expected).abs() < 2e-4,
            "{slab}: {}",
            share(slab)
        );
    }
}

#[test]
fn the_facing_axis_is_the_largest_component() {
    let table = [
        ([0.0, 0.0, 1.0], (2, true)),
        ([0.6, 0.0, -0.8], (2, false)),
        ([0.8, 0.0, -0.6], (0, true)),
        ([0.0, -0.9, 0.1], (1, false)),
        ([0.5, 0.5, 0.5], (0, true)),
    ];
    for (direction, (axis, ascending)) in table {
        let facing = Facing::new(direction.map(I2F30::from_num));
        assert_eq!(facing, Facing { axis, ascending }, "{direction:?}");
    }
}

#[test]
fn slabs_count_away_from_the_eye() {
    let slabs = |ascending| AxisSlabs {
        facing: Facing { axis: 2, ascending },
        first: I8F24::from_num(-4),
        per_unit: 2 << 16,
    };
    let number = |value: f64| SoftFloat {
        mantissa: (value * 2f64.powi(24)) as i32,
        exponent: -24,
    };
    let centre = |z: f64| [0.0, 0.0, z].map(number);
    assert_eq!(slabs(true).slab(centre(-4.0)), 0);
    assert_eq!(slabs(true).slab(centre(-3.26)), 1);
    assert_eq!(slabs(false).slab(centre(-3.26)), -1);
    assert_eq!(slabs(true).slab(centre(2.0)), 12);
}

#[test]
fn a_composited_sheet_is_empty_again() {
    let window = Window {
        first: [5, 2],
        end: [8, 10],
    };
    // One that lacks the sheet's first column and its last row.
    let part = Window {
        first: [6, 1],
        end: [9, 9],
    };
    let blend = Blend::new(&WIDTHS, &Rules::EWA);
    for over in [false, true] {
        let (mut memory, mut frame) = ([Pixel::default(); 24], [Pixel::clear(&WIDTHS); 24]);
        let mut sheet = SheetBuffer::new(&mut memory, window, 3, &WIDTHS).unwrap();
        let mut target = Target::new(&mut frame, part, 3).unwrap();
        for y in [2, 8, 9] {
            for pixel in sheet.target().row(y, 5, 3) {
                blend.x_ray(pixel, 1 << (WIDTHS.alpha - 1), &[1 << WIDTHS.colour; 3]);
            }
        }
        let mut composite = || {
            if over {
                sheet.composite_over(&blend, &mut target)
            } else {
                sheet.composite_behind(&blend, &mut target)
            }
        };
        assert_eq!([composite(), composite()], [4, 0]);
        assert_eq!(
            target.row(2, 6, 3).iter().map(value).collect::<Vec<_>>(),
            [[0.5; 4], [0.5; 4], [0.0, 0.0, 0.0, 1.0]]
        );
        assert_eq!(value(&target.row(1, 6, 1)[0]), [0.0, 0.0, 0.0, 1.0]);
    }
}

/// As between splats: what is left of the light at the threshold stops a pixel, and may itself be left out.
#[test]
fn a_sheet_finishes_a_pixel_at_the_threshold() {
    for omit_finishing in [false, true] {
        let blend = Blend::new(
            &WIDTHS,
            &Rules {
                omit_finishing,
                ..Rules::EWA
            },
        );
        let least = blend.constants().minimum_transmittance;
        for (transmittance, stops) in [(least, true), (least + 1, false), (1 << 20, false)] {
            let sheet = Pixel {
                colour: [1 << 20; 3],
                transmittance,
            };
            let mut pixel = Pixel::clear(&WIDTHS);
            blend.sheet_behind(&mut pixel, &sheet);
            let left_out = stops && omit_finishing;
            assert_eq!(pixel.is_finished(), stops);
            assert_eq!(
                pixel.transmittance(),
                if left_out {
                    1 << WIDTHS.transmittance
                } else {
                    transmittance
                }
            );
            assert_eq!(pixel.colour, [if left_out { 0 } else { 1 << 20 }; 3]);
        }
    }
}

#[test]
fn slabs_begin_at_the_nearest_depth() {
    let slabs = DepthSlabs {
        nearest: 2 << 23,
        per_unit: 3 << 16,
    };
    let numbers = [0, 1 << 23, 2 << 23, 9 << 22, u32::MAX].map(|depth| slabs.slab(depth));
    assert_eq!(numbers, [0, 0, 0, 7, 1529]);
    let one = SoftFloat::from_wide(1, 0, 31);
    // Three standard deviations of three slabs each.
    assert_eq!(slabs.reach(3 << 23, one), (0, 12));
    // A sheet itself lies in one slab, also where that begins.
    assert_eq!(slabs.reach(3 << 23, SoftFloat::ZERO), (3, 3));
    let share = |slab| slabs.fraction_in(slab, 3 << 23, SoftFloat::ZERO);
    assert_eq!([2, 3, 4].map(share), [0, 1 << 16, 0]);
    assert!(Facing::new([I2F30::ZERO; 3]).ascending);
    let last = |per_unit, spread| {
        DepthSlabs {
            nearest: 0,
            per_unit,
        }
        .reach(0, spread)
        .1
    };
    assert_eq!(last((1 << 31) - 1, one), 98_303);
    assert_eq!(last(1 << 16, one.scaled_by(60)), 3 << 24);
}

/// The root of the squared depths of the axes, in double precision; exponents end where the format's do, and the least
/// mantissa is the greatest's negative.
#[test]
fn spreads_are_lengths_along_the_view() {
    let end = |value| crate::math::Extended { value, exponent: 0 };
    let row = [0.48, -0.6, 0.64].map(I2F30::from_num);
    let view = View {
        rotation: [[I2F30::ONE; 3], [I2F30::ZERO; 3], row],
        pose: crate::view::Eye::ORIGIN,
        focal: [SoftFloat::from_wide(1, 0, 31); 2],
        principal: [I32F32::ZERO; 2],
        near: end(0),
        far: end(1),
        viewport: [1; 2],
        projection: crate::view::Projection::Orthographic,
        limits: crate::view::RatioLimits {
            low: [I32F32::MIN; 2],
            high: [I32F32::MAX; 2],
        },
    };
    assert_eq!(
        Facing::of_view(&view),
        Facing {
            axis: 2,
            ascending: true
        }
    );
    let mantissas = [
        [1 << 30, 5 << 27, -3 << 26],
        [i32::MIN, 7, 1 << 29],
        [-9 << 24, i32::MAX, 1 << 30],
    ];
    let spread = |mantissas: [[i32; 3]; 3], exponent| {
        depth_spread(
            &view,
            &mantissas.map(|mantissa| Axis { mantissa, exponent }),
        )
    };
    let depths = mantissas.map(|axis| {
        (0..3)
            .map(|i| row[i].to_num::<f64>() * f64::from(axis[i]))
            .sum::<f64>()
    });
    let exact = depths.iter().map(|depth| depth * depth).sum::<f64>().sqrt();
    let found = spread(mantissas, 0);
    let length = f64::from(found.mantissa) * f64::from(found.exponent).exp2();
    assert!(
        (length / exact - 1.0).abs() < 2f64.powi(-23),
        "{length} {exact}"
    );
    assert_eq!(found.mantissa.ilog2(), 23);
    for exponent in [-600, -512, -100, 511, 600] {
        assert_eq!(
            spread(mantissas, exponent),
            found.scaled_by(exponent.clamp(-512, 511))
        );
    }
    let [least, negative] = [i32::MIN, -i32::MAX].map(|mantissa| spread([[0, 0, mantissa]; 3], 0));
    assert_eq!(least, negative);
    // A digest of what is rounded: 31 bits of each part and of their sum.
    let mixed = |index: i32| index.wrapping_mul(0x9e37_79b9u32 as i32) >> (index & 3);
    let spreads = (1..2000).map(|index| {
        let mantissas = [0, 3, 6].map(|part| [0, 1, 2].map(|i| mixed(9 * index + part + i)));
        spread(mantissas, 0).mantissa as u64
    });
    assert_eq!(crate::digest(spreads), 7_101_847_323_222_192_272);
}
