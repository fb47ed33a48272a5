//! Independence: the kernel's rounding and overflow against a second, slow implementation in big integers.
//!
//! Nothing here shares a line with the kernel. A number `m 2^e` is a big integer over a power of two; rounding is
//! floor((2 n + d) / 2 d), which is "to nearest, halves up" by definition. Operands come from
//! boundary patterns and at random; domains that are small enough are walked through whole.

use crate::arbitrary::Source;
use fixed::types::I2F30;
use num_bigint::{BigInt, BigUint, Sign};
use proptest::prelude::*;
use splatline::blend::{Blend, Pixel};
use splatline::format::{Classic8, Design, Rounding, RuntimeWidths, Widths};
use splatline::kernel::{FootprintTable, entries, fill_gaussian};
use splatline::math::{self, Product, SoftFloat};
use splatline::rules::Rules;
use splatline::view::Pose;

fn big(value: i64) -> BigInt {
    BigInt::from(value)
}

/// floor(a / b) for b > 0.
fn floor(a: &BigInt, b: &BigInt) -> BigInt {
    let quotient = a / b;
    if a.sign() == Sign::Minus && &quotient * b != *a {
        quotient - 1
    } else {
        quotient
    }
}

/// a / 2^shift to nearest, halves up.
fn halved(a: &BigInt, shift: u32) -> BigInt {
    let divisor: BigInt = BigInt::from(1) << shift;
    floor(&(a * 2 + &divisor), &(&divisor * 2))
}

fn saturated(a: &BigInt) -> i64 {
    i64::try_from(a).unwrap_or(if a.sign() == Sign::Minus {
        i64::MIN
    } else {
        i64::MAX
    })
}

/// `a * 2^-shift` as the kernel promises it: rounded to the right, saturated to the left.
fn shifted(a: i64, shift: i32) -> i64 {
    match shift {
        0.. => saturated(&halved(&big(a), shift as u32)),
        _ => saturated(&(big(a) << shift.unsigned_abs())),
    }
}

/// The mantissa of exactly `bits` bits and the exponent, rounded to nearest, of `a * 2^exponent`.
fn normalised(a: &BigInt, exponent: i64, bits: u32) -> (BigInt, i64) {
    if a.sign() == Sign::NoSign {
        return (BigInt::from(0), 0);
    }
    let shift = a.bits() as i64 - i64::from(bits);
    if shift <= 0 {
        return (a << shift.unsigned_abs(), exponent + shift);
    }
    let mantissa = halved(a, shift as u32);
    if mantissa.bits() > u64::from(bits) {
        (mantissa / 2, exponent + shift + 1)
    } else {
        (mantissa, exponent + shift)
    }
}

fn assert_is(got: SoftFloat, expected: (BigInt, i64)) {
    assert_eq!(BigInt::from(got.mantissa), expected.0, "{got:?}");
    assert!(
        got.mantissa == 0 || i64::from(got.exponent) == expected.1,
        "{got:?} against {expected:?}"
    );
}

/// |got / 2^power - 1| as a double, of a ratio of big integers.
fn relative(got: &BigInt, wanted: &BigInt) -> f64 {
    let scaled: BigInt = ((got - wanted) << 80u32) / wanted;
    scaled.to_string().parse::<f64>().unwrap_or(f64::NAN).abs() / 2f64.powi(80)
}

const SEAMS: [i64; 15] = [
    i64::MIN,
    i64::MIN + 1,
    -(1 << 62),
    -(1 << 31) - 1,
    -(1 << 31),
    -3,
    -2,
    -1,
    0,
    1,
    2,
    3,
    1 << 31,
    (1 << 62) - 1,
    i64::MAX,
];

/// Values whose rounding constant does not leave the word, as the shift's header demands.
fn has_room(value: i64, shift: u32) -> bool {
    shift == 0 || shift >= 64 || value.checked_add(1 << (shift - 1)).is_some()
}

#[test]
fn shifts_at_every_seam_by_every_amount() {
    for value in SEAMS {
        for shift in 0..70 {
            assert_eq!(
                math::shift_left(value, shift),
                shifted(value, -(shift as i32)),
                "{value} << {shift}"
            );
            if shift < 64 && has_room(value, shift) {
                assert_eq!(
                    math::shift_round(value, shift),
                    shifted(value, shift as i32),
                    "{value} >> {shift}"
                );
            }
        }
    }
}

#[test]
fn reciprocals_of_all_16_bit_mantissas() {
    for mantissa in 1..=0xffff {
        for bits in [12, 16, 18, 24, 31] {
            let got = math::reciprocal(
                SoftFloat {
                    mantissa,
                    exponent: 0,
                },
                bits,
            )
            .expect("it is not 0");
            let product = BigInt::from(got.mantissa) * mantissa;
            let one = BigInt::from(1) << got.exponent.unsigned_abs();
            let table = if bits > 16 {
                2f64.powi(-29)
            } else {
                2f64.powf(-17.9)
            };
            assert!(
                relative(&product, &one) <= 2f64.powi(-(bits as i32)) + table,
                "1/{mantissa} at {bits} bits"
            );
        }
    }
}

#[test]
fn roots_of_all_16_bit_mantissas() {
    for mantissa in 1..=0xffff {
        for bits in [16, 24, 31] {
            let got = math::square_root(
                SoftFloat {
                    mantissa,
                    exponent: 0,
                },
                bits,
            );
            // got^2 against the argument: twice the relative error, and a little.
            let square = BigInt::from(got.mantissa) * got.mantissa;
            let wanted = BigInt::from(mantissa) << (2 * got.exponent.unsigned_abs());
            let table = if bits > 16 {
                2f64.powi(-29)
            } else {
                2f64.powf(-16.9)
            };
            let bound = 2.0 * (2f64.powi(-(bits as i32)) + table) * 1.001;
            assert!(
                relative(&square, &wanted) <= bound,
                "sqrt {mantissa} at {bits} bits"
            );
        }
    }
}

/// One opacity of a pixel's share, rounded as the design says, by division of integers.
fn share(product: u64, bits: u32, rounding: Rounding) -> u64 {
    let divisor = 1u64 << bits;
    match rounding {
        Rounding::Truncate => product / divisor,
        Rounding::Nearest => (2 * product + divisor) / (2 * divisor),
        Rounding::NearestEven => {
            let up = (2 * product + divisor) / (2 * divisor);
            let is_tie = 2 * (product % divisor) == divisor;
            up - u64::from(is_tie && up % 2 == 1)
        }
    }
}

#[test]
fn alpha_operations_at_8_bits_for_all_pairs() {
    for rounding in [Rounding::Nearest, Rounding::NearestEven, Rounding::Truncate] {
        let widths = Widths {
            rounding,
            ..Classic8::WIDTHS
        };
        let blend = Blend::new(
            &widths,
            &Rules {
                alpha_min: 0,
                alpha_max: 1 << 31,
                minimum_transmittance: 0,
                ..Rules::EWA
            },
        );
        for first in 0..=256u32 {
            for alpha in 0..=256u32 {
                let opacity =
                    share(u64::from(first) * u64::from(alpha), 8, rounding).min(256) as u32;
                assert_eq!(blend.opacity(first, alpha), opacity);
                let colour = [256, 128, 1];
                let start = Pixel {
                    colour: [7; 3],
                    transmittance: first,
                };
                let hidden =
                    |value: u32| share(u64::from(value) * u64::from(alpha), 8, rounding) as u32;

                let mut front = start;
                blend.front_to_back(&mut front, alpha, &colour);
                assert_eq!(
                    front.transmittance(),
                    first - hidden(first),
                    "{first} under {alpha}"
                );
                // The sum is what is rounded.
                let gained = |c: u32| u64::from(hidden(first)) * u64::from(c) + (7 << 8);
                let sums = colour.map(|c| share(gained(c), 8, rounding) as u32);
                assert_eq!(front.colour, sums);

                let mut back = start;
                blend.back_to_front(&mut back, alpha, &colour);
                let layer = |c: u32| share(u64::from(alpha) * u64::from(c), 8, rounding) as u32;
                assert_eq!(back.transmittance(), first - hidden(first));
                assert_eq!(back.colour, colour.map(|c| 7 - hidden(7) + layer(c)));

                let mut sum = start;
                blend.x_ray(&mut sum, alpha, &colour);
                assert_eq!(sum.transmittance(), first.saturating_sub(alpha));
                assert_eq!(sum.colour, colour.map(|c| 7 + layer(c)));
            }
        }
    }
}

#[test]
fn table_lookup_at_every_index() {
    for interpolation in [0, 4, 12] {
        let widths = Widths {
            radial: 12,
            table: 6,
            interpolation,
            weight: 20,
            ..Classic8::WIDTHS
        };
        let mut memory = vec![0; entries(&widths)];
        fill_gaussian(&mut memory, &widths, 4);
        let table = FootprintTable::new(&memory, &widths, 4).expect("the size is right");
        let rest_bits = 12 + 4 - 6;
        let kept = u32::from(interpolation).min(rest_bits);
        for radial in 0..1u64 << 16 {
            let index = (radial >> rest_bits) as usize;
            let (low, high) = (i64::from(memory[index]), i64::from(memory[index + 1]));
            let rest = (radial % (1 << rest_bits)) >> (rest_bits - kept);
            let step = halved(&(big(high - low) * rest), kept);
            assert_eq!(
                i64::from(table.weight(radial)),
                low + saturated(&step),
                "{radial}"
            );
        }
    }
}

/// `value 2^(exponent + 400)`, for exponents above -400.
fn at_400(value: &BigInt, exponent: i32) -> BigInt {
    value << (exponent + 400) as u32
}

/// The camera space of the kernel against exact numbers: the error is relative to the distance from the eye, wherever
/// both are.
fn camera_space_is_relative_to_the_eye(source: &mut Source, design: RuntimeWidths) {
    let widths = design.widths();
    let mut view = source.sound_view();
    // Entries as they are, not a rotation: the formula does not care.
    view.rotation = [(); 3].map(|()| [(); 3].map(|()| I2F30::from_bits(source.i32() >> 2)));
    let rest = || 1i32 << 29;
    view.pose.rotation_rest =
        [(); 3].map(|()| [(); 3].map(|()| source.i32().rem_euclid(2 * rest()) - rest()));
    view.pose.exponent = i32::from(source.byte() % 64) - 60;
    view.pose.position = [(); 3].map(|()| source.i64() >> 4);
    // Near the eye by cancellation, or anywhere.
    let centre = [0, 1, 2].map(|axis| {
        let near = SoftFloat::from_wide(view.pose.position[axis], view.pose.exponent, 31);
        match source.byte() % 3 {
            _ if near.mantissa == 0 => SoftFloat {
                mantissa: source.i32() >> 3,
                exponent: -30,
            },
            0 => SoftFloat {
                mantissa: source.i32().max(-i32::MAX),
                exponent: i32::from(source.byte() % 64) - 60,
            },
            1 => SoftFloat {
                mantissa: near.mantissa ^ i32::from(source.byte()),
                ..near
            },
            _ => near,
        }
    });
    let point = view.pose.to_camera(&view.rotation, &centre, &widths);
    let difference = [0, 1, 2].map(|axis| {
        at_400(
            &big(centre[axis].mantissa.into()),
            centre[axis].exponent.max(-399),
        ) - at_400(&big(view.pose.position[axis]), view.pose.exponent)
    });
    let magnitude = |n: &BigInt| {
        if n.sign() == Sign::Minus {
            -n.clone()
        } else {
            n.clone()
        }
    };
    let distance: BigInt = difference.iter().map(magnitude).max().unwrap();
    // What is rounded before the difference: 2^-60 of the largest coordinate of either.
    let operands = (0..3).flat_map(|axis| {
        [
            at_400(
                &big(centre[axis].mantissa.into()),
                centre[axis].exponent.max(-399),
            ),
            at_400(&big(view.pose.position[axis]), view.pose.exponent),
        ]
    });
    let largest: BigInt = operands.map(|n| magnitude(&n)).max().unwrap();
    for row in 0..3 {
        let mut exact = big(0);
        let entries = view.rotation[row].iter().zip(view.pose.rotation_rest[row]);
        for ((entry, rest), part) in entries.zip(&difference) {
            let entry = (i64::from(entry.to_bits()) << 30) + i64::from(rest);
            exact += big(entry) * part;
        }
        let got: BigInt = at_400(&big(point.value[row]), point.exponent.max(-399)) << 60u32;
        let allowed: BigInt = (&distance << (62 - u32::from(widths.position)))
            + (&largest << 2u32)
            + (big(1) << 61u32);
        assert!(
            magnitude(&(got - exact)) <= allowed,
            "{view:?} {centre:?} {point:?}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(20_000) })]

    #[test]
    fn camera_space(bytes in proptest::collection::vec(any::<u8>(), 400)) {
        let mut source = Source::new(&bytes);
        let design = source.design();
        camera_space_is_relative_to_the_eye(&mut source, design);
    }

    #[test]
    fn shifts(bytes in proptest::collection::vec(any::<u8>(), 32)) {
        let mut source = Source::new(&bytes);
        let (value, shift) = (source.i64(), source.i32() % 70);
        if shift < 64 && has_room(value, shift.max(0) as u32) {
            prop_assert_eq!(math::shift_signed(value, shift), shifted(value, shift));
        }
    }

    #[test]
    fn normalisation_and_products(bytes in proptest::collection::vec(any::<u8>(), 64), bits in 8u32..=31) {
        let mut source = Source::new(&bytes);
        let (wide, exponent) = (source.i64(), source.i32() >> 8);
        // The last bit of i64::MIN's neighbours is dropped before rounding: a half of 2^-32, below every result.
        if wide.unsigned_abs() < 1 << 62 {
            assert_is(SoftFloat::from_wide(wide, exponent, bits), normalised(&big(wide), exponent.into(), bits));
        }
        let (a, b) = (source.i32().max(-i32::MAX), source.i32().max(-i32::MAX));
        let product = SoftFloat { mantissa: a, exponent }.multiply(SoftFloat { mantissa: b, exponent: 5 }, bits);
        assert_is(product, normalised(&(big(a.into()) * b), i64::from(exponent) + 5, bits));
    }

    #[test]
    fn sums_of_products(bytes in proptest::collection::vec(any::<u8>(), 120), bits in 8u32..=31) {
        let mut source = Source::new(&bytes);
        let terms = [(); 4].map(|()| Product::new(source.i64() >> 2, i32::from(source.byte() as i8)));
        let exact: BigInt = terms.iter().map(|t| big(t.value) << (t.exponent + 200) as u32).sum();
        let largest = terms.iter().map(|t| (big(t.value) << (t.exponent + 200) as u32).magnitude().clone()).max();
        let got = math::sum_of_products(terms, bits);
        let got = if got.mantissa == 0 { BigInt::from(0) } else { BigInt::from(got.mantissa) << (got.exponent + 300) as u32 };
        let error: BigInt = got - (&exact << 100u32);
        // Half a unit of the result, and for each of four terms a unit of the window, which begins at the largest
        // term's leading bit.
        let cuts: BigUint = (largest.unwrap_or_default() << 100u32) >> (bits + math::GUARD - 3);
        let bound = (((exact.magnitude() << 100u32) + &cuts) >> bits) + cuts;
        prop_assert!(*error.magnitude() <= bound);
    }
}
