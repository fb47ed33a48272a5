//! Independence of the pixel path: opacity, transmittance and colour at any widths and in both roundings, against
//! integers of 128 bits and the definition of rounding. And the walks through whole 24-bit domains, which take minutes
//! without the optimiser.
//!
//! `cargo test --release -p splatline --test all independence_pixels -- --ignored` walks them.

use crate::arbitrary::Source;
use proptest::prelude::*;
use splatline::blend::{Blend, FINISHED, Pixel};
use splatline::format::{Rounding, Standard24, WIDTH_RANGES, Widths};
use splatline::math::{self, SoftFloat};
use splatline::rules::{Cutoff, Rules};

/// `value 2^-shift` by the definition of the rounding; a negative shift multiplies.
fn shifted(value: u128, shift: i32, rounding: Rounding) -> u128 {
    let Ok(right) = u32::try_from(shift) else {
        return value << shift.unsigned_abs();
    };
    let divisor = 1u128 << right;
    match rounding {
        Rounding::Truncate => value / divisor,
        Rounding::Nearest => (2 * value + divisor) / (2 * divisor),
        Rounding::NearestEven => {
            let up = (2 * value + divisor) / (2 * divisor);
            let is_tie = 2 * (value % divisor) == divisor;
            up - u128::from(is_tie && up % 2 == 1)
        }
    }
}

#[test]
fn shifts_of_the_pixel_path_at_every_seam() {
    let seams = (0..63).flat_map(|bit| {
        let power = 1u64 << bit;
        [power - 1, power, power + 1]
    });
    for value in seams {
        for rounding in [Rounding::Nearest, Rounding::NearestEven, Rounding::Truncate] {
            for shift in -80..80 {
                let expected = match shift {
                    64.. | ..=-64 => 0,
                    _ => shifted(value.into(), shift, rounding) as u64,
                };
                assert_eq!(
                    math::shift_unsigned(value, shift, rounding),
                    expected,
                    "{value} by {shift}, {rounding:?}"
                );
            }
        }
    }
}

/// The same pixel in wide integers.
struct WideWord {
    widths: Widths,
    /// UQ1.60.
    alpha_min: u128,
    alpha_max: u128,
    stop: u128,
    omit_finishing: bool,
}

impl WideWord {
    fn new(widths: Widths, rules: &Rules) -> WideWord {
        let unit =
            |value: u32, bits: u8| shifted(value.into(), 31 - i32::from(bits), Rounding::Nearest);
        WideWord {
            widths,
            // Under rules whose cut-off decides by opacity nothing is left to skip but 0.
            alpha_min: match rules.cutoff {
                Cutoff::Opacity => 0,
                Cutoff::Radial(_) => rules.alpha_min.into(),
            },
            alpha_max: unit(rules.alpha_max, widths.alpha).min(1 << widths.alpha),
            // The largest integer below the threshold.
            stop: ((u128::from(rules.minimum_transmittance) << widths.transmittance).max(1) - 1)
                >> 60,
            omit_finishing: rules.omit_finishing,
        }
    }

    /// a b with `from` fraction bits together, brought to `to`.
    fn product(&self, a: u32, b: u32, from: u8, to: u8) -> u128 {
        let shift = i32::from(from) - i32::from(to);
        shifted(u128::from(a) * u128::from(b), shift, self.widths.rounding)
    }

    fn opacity(&self, peak: u32, weight: u32) -> u32 {
        let w = &self.widths;
        // Compared before it is rounded, with a threshold of at most seven bits more than alpha has.
        let fraction = (w.peak + w.weight).min(w.alpha + 7);
        let least = ((self.alpha_min >> (59 - fraction)) + 1) >> 1;
        let exact = u128::from(peak) * u128::from(weight);
        if exact < least << (w.peak + w.weight - fraction) {
            return 0;
        }
        let alpha = self.product(peak, weight, w.peak + w.weight, w.alpha);
        alpha.min(self.alpha_max) as u32
    }

    fn front_to_back(&self, pixel: &mut Pixel, alpha: u32, colour: &[u32; 3]) {
        let w = &self.widths;
        let share = self.product(
            pixel.transmittance,
            alpha,
            w.transmittance + w.alpha,
            w.transmittance,
        ) as u32;
        let rest = pixel.transmittance - share;
        let stop = u128::from(rest) <= self.stop;
        if stop && self.omit_finishing {
            pixel.transmittance |= FINISHED;
            return;
        }
        for (sum, c) in pixel.colour.iter_mut().zip(colour) {
            // The sum is rounded as a whole, which only ties to even can tell from rounding what is added.
            let drop = i32::from(w.transmittance + w.colour) - i32::from(w.accumulator);
            let exact = u128::from(share) * u128::from(*c);
            let sum_of = |sum: u128| match drop {
                1.. => shifted(exact + (sum << drop), drop, w.rounding),
                _ => sum + shifted(exact, drop, w.rounding),
            };
            *sum = sum_of((*sum).into()).min(u32::MAX.into()) as u32;
        }
        pixel.transmittance = if stop { rest | FINISHED } else { rest };
    }

    fn back_to_front(&self, pixel: &mut Pixel, alpha: u32, colour: &[u32; 3]) {
        let w = &self.widths;
        let hidden = |value: u32| self.product(value, alpha, w.alpha, 0) as u32;
        for (sum, c) in pixel.colour.iter_mut().zip(colour) {
            let layer = self.product(alpha, *c, w.alpha + w.colour, w.accumulator);
            *sum = (u128::from(*sum - hidden(*sum)) + layer).min(u32::MAX.into()) as u32;
        }
        pixel.transmittance -= hidden(pixel.transmittance);
    }

    fn x_ray(&self, pixel: &mut Pixel, alpha: u32, colour: &[u32; 3]) {
        let w = &self.widths;
        for (sum, c) in pixel.colour.iter_mut().zip(colour) {
            let layer = self.product(alpha, *c, w.alpha + w.colour, w.accumulator);
            *sum = (u128::from(*sum) + layer).min(u32::MAX.into()) as u32;
        }
        let taken = self.product(alpha, 1, w.alpha, w.transmittance);
        let left = u128::from(pixel.transmittance).saturating_sub(taken);
        pixel.transmittance = left as u32;
    }
}

/// Widths of the pixel path within their ranges, ends included.
fn pixel_widths(source: &mut Source) -> Widths {
    let mut widths = Standard24::WIDTHS;
    let fields: [(&str, &mut u8); 6] = [
        ("weight", &mut widths.weight),
        ("peak", &mut widths.peak),
        ("alpha", &mut widths.alpha),
        ("transmittance", &mut widths.transmittance),
        ("colour", &mut widths.colour),
        ("accumulator", &mut widths.accumulator),
    ];
    for (name, field) in fields {
        let (_, low, high) = WIDTH_RANGES[WIDTH_RANGES.iter().position(|r| r.0 == name).unwrap()];
        *field = match source.byte() {
            0..64 => low,
            64..128 => high,
            other => low + other % (high - low + 1),
        };
    }
    widths.rounding = match source.byte() % 3 {
        0 => Rounding::Nearest,
        1 => Rounding::NearestEven,
        _ => Rounding::Truncate,
    };
    widths
}

/// A value of `integer` and `fraction` bits; formats that only reach 1 include it.
fn value(source: &mut Source, integer: u8, fraction: u8) -> u32 {
    let one = 1u64 << fraction;
    match integer {
        0 => source.bits(u32::from(fraction) + 1).min(one) as u32,
        _ => (source.bits(u32::from(integer + fraction)) & (one << integer).wrapping_sub(1)) as u32,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(4_000) })]

    #[test]
    fn blending_at_any_widths(bytes in proptest::collection::vec(any::<u8>(), 400)) {
        let mut source = Source::new(&bytes);
        let widths = pixel_widths(&mut source);
        let rules = Rules {
            alpha_min: source.bits(60) & 0x1fff_ffff_ffff,
            alpha_max: 1 << 31,
            minimum_transmittance: source.bits(60) & 0x1f_ffff_ffff_ffff,
            omit_finishing: source.byte() < 128,
            ..Rules::EWA
        };
        let (blend, wide) = (Blend::new(&widths, &rules), WideWord::new(widths, &rules));
        let mut pixels = [Pixel::clear(&widths); 6];
        for _ in 0..8 {
            let peak = value(&mut source, 4, widths.peak);
            let weight = value(&mut source, 0, widths.weight);
            let last = (1u64 << (widths.colour_range() + widths.colour)) - 1;
            let colour = [(); 3].map(|()| value(&mut source, 4, widths.colour).min(last as u32));
            let alpha = blend.opacity(peak, weight);
            prop_assert_eq!(alpha, wide.opacity(peak, weight), "{:?}", widths);
            let [front, front_wide, back, back_wide, sum, sum_wide] = &mut pixels;
            if !front.is_finished() {
                blend.front_to_back(front, alpha, &colour);
                wide.front_to_back(front_wide, alpha, &colour);
            }
            blend.back_to_front(back, alpha, &colour);
            wide.back_to_front(back_wide, alpha, &colour);
            blend.x_ray(sum, alpha, &colour);
            wide.x_ray(sum_wide, alpha, &colour);
            prop_assert_eq!(&pixels[0], &pixels[1], "front to back, {:?}", widths);
            prop_assert_eq!(&pixels[2], &pixels[3], "back to front, {:?}", widths);
            prop_assert_eq!(&pixels[4], &pixels[5], "summed, {:?}", widths);
        }
    }
}

/// Is |got / truth - 1| at most 2^-bits + 2^-29, times `factor`, in integers?
fn is_close(got: u128, truth: u128, bits: u32, factor: u128) -> bool {
    got.abs_diff(truth) << 31 <= truth * factor * ((1 << (31 - bits)) + 4)
}

#[test]
#[ignore = "walks through eight million numbers"]
fn reciprocals_of_all_24_bit_mantissas() {
    for mantissa in 1i32 << 23..1 << 24 {
        for bits in [24, 28] {
            let number = SoftFloat {
                mantissa,
                exponent: 0,
            };
            let got = math::reciprocal(number, bits).unwrap();
            let product = got.mantissa as u128 * mantissa as u128;
            let one = 1u128 << got.exponent.unsigned_abs();
            assert!(is_close(product, one, bits, 1), "1/{mantissa}, {bits} bits");
        }
    }
}

#[test]
#[ignore = "walks through sixteen million numbers"]
fn roots_of_all_24_bit_mantissas() {
    for mantissa in 1i32 << 23..1 << 24 {
        for (bits, exponent) in [(24, 0), (28, 0), (24, 1), (28, 1)] {
            let got = math::square_root(SoftFloat { mantissa, exponent }, bits);
            let square = (got.mantissa as u128).pow(2);
            let wanted = (mantissa as u128) << (exponent + 2 * -got.exponent);
            // (1 + e)^2 = 1 + 2 e, but for e^2 < 2^-46.
            assert!(
                is_close(square, wanted + (wanted >> 46), bits, 2)
                    || is_close(square, wanted, bits, 2),
                "sqrt {mantissa} 2^{exponent}, {bits} bits"
            );
        }
    }
}
