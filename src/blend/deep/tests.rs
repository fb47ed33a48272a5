//! The channel against double precision, its invariants for any bits, and the noise.

use super::*;
use proptest::prelude::*;
extern crate std;
use std::vec::Vec;

const REPRESENTATIONS: [Representation; 3] = [
    Representation::Opacity,
    Representation::Transmittance,
    Representation::OpticalDepth,
];
const ROUNDINGS: [ChannelRounding; 3] = [
    ChannelRounding::Nearest,
    ChannelRounding::Truncate,
    ChannelRounding::Dither,
];

fn channels() -> impl Strategy<Value = Channel> {
    (0usize..3, 0usize..3, 8u8..=32)
        .prop_map(|(r, o, width)| Channel::new(REPRESENTATIONS[r], ROUNDINGS[o], width).unwrap())
}

fn unit(value: u32) -> f64 {
    f64::from(value) / 2f64.powi(31)
}

proptest! {
    #[test]
    fn any_bits_stay_within_the_word(channel in channels(), word: u32, alpha: u32, noise: u32, colour: [u32; 3], layer: u32) {
        let next = channel.over(word, alpha, noise);
        prop_assert!(u64::from(next) < 1 << channel.width());
        prop_assert!(channel.transmittance(next) <= ONE && channel.transmittance(word) <= ONE);
        let mut pixel = DeepPixel { colour, alpha: word };
        pixel.front_to_back(&channel, alpha, &colour, [3, 4], layer);
        pixel.back_to_front(&channel, alpha, &colour, [3, 4], layer);
        prop_assert!(pixel.colour.iter().all(|c| u64::from(*c) < 1 << channel.width()));
    }

    #[test]
    fn one_layer_is_right_to_one_step(channel in channels(), before in 0u32..=ONE, alpha in 0u32..=ONE, noise: u32) {
        let word = match channel.representation() {
            Representation::Opacity => (ONE - before) >> (31 - channel.fraction()),
            Representation::Transmittance => before >> (31 - channel.fraction()),
            Representation::OpticalDepth => {
                let depth = -unit(before.max(1)).log2() * f64::from(channel.fraction()).exp2();
                depth.min(f64::from(channel.width()).exp2() - 2.0) as u32
            }
        };
        let exact = unit(channel.transmittance(word)) * (1.0 - unit(alpha));
        let got = unit(channel.transmittance(channel.over(word, alpha, noise)));
        let step = (-f64::from(channel.fraction())).exp2();
        // Within a step of the word; what lies beyond 16 octaves of optical depth is opaque.
        let tolerance = match channel.representation() {
            Representation::OpticalDepth => exact * step * 1.01 + 2f64.powi(-16),
            _ => step,
        } + 2f64.powi(-29);
        prop_assert!((got - exact).abs() <= tolerance, "{got} {exact} {channel:?}");
    }
}

/// Rounding as the table at the module's head has it, in numbers that are wide enough.
fn rounded(channel: &Channel, value: u64, shift: u32, noise: u32) -> u64 {
    let addend = match channel.rounding() {
        ChannelRounding::Nearest => 1 << (shift - 1),
        ChannelRounding::Truncate => 0,
        ChannelRounding::Dither => (u128::from(noise) << shift) >> 32,
    };
    ((u128::from(value) + addend) >> shift) as u64
}

/// A word with many at the ends of what it may hold.
fn words(one: u32) -> impl Strategy<Value = u32> {
    prop_oneof![Just(0), Just(1), Just(one - 1), Just(one), any::<u32>()]
}

proptest! {
    /// Words are rounded once, and colours get what the channel lost, or their share of it.
    #[test]
    fn every_bit_is_as_stated(
        channel in channels(), word in words(ONE), alpha in words(ONE), colour: [u32; 3], before: [u32; 3], place: [u16; 2], layer: u32,
    ) {
        let deepest = (1u64 << channel.width()) - 1;
        let one = 1u32 << channel.fraction();
        let word = if layer % 2 == 0 { word.min(deepest as u32) } else { word >> (32 - channel.width()) };
        let random = noise(place[0], place[1], layer);
        let opaque = alpha.min(ONE);
        let round = |value, shift, noise| rounded(&channel, value, shift, noise);
        let part = |value: u32, share: u32| u64::from(value) * u64::from(share);
        let next = match channel.representation() {
            Representation::Opacity => u64::from(word.min(one)) + round(part(one - word.min(one), opaque), 31, random),
            Representation::Transmittance => round(part(word.min(one), ONE - opaque), 31, random),
            Representation::OpticalDepth => {
                let step = round(octaves::of_opacity(opaque), 44 - channel.fraction(), random);
                deepest.min(u64::from(word) + step)
            }
        };
        let before = before.map(|c| c >> (32 - channel.width()));
        let (mut front, mut back) = (DeepPixel { colour: before, alpha: word }, DeepPixel { colour: before, alpha: word });
        front.front_to_back(&channel, alpha, &colour, place, layer);
        back.back_to_front(&channel, alpha, &colour, place, layer);
        prop_assert_eq!([front.alpha, back.alpha].map(u64::from), [next; 2]);
        let lost = channel.transmittance(word).saturating_sub(channel.transmittance(front.alpha));
        for c in 0..3 {
            let random = random.rotate_left(8 * (c as u32 + 1));
            let light = |share, noise| round(part(share, colour[c].min((1 << 29) - 1)), 60 - u32::from(channel.width()), noise);
            let sum = u64::from(before[c]) + light(lost, random);
            prop_assert_eq!(u64::from(front.colour[c]), sum.min(deepest));
            let kept = round(part(before[c], ONE - opaque), 31, random);
            prop_assert_eq!(u64::from(back.colour[c]), (kept + light(opaque, random.rotate_left(4))).min(deepest));
        }
    }
}

#[test]
fn a_clear_pixel_lets_all_through_and_the_deepest_nothing() {
    for representation in REPRESENTATIONS {
        for width in [8, 16, 32] {
            let channel = Channel::new(representation, ChannelRounding::Dither, width).unwrap();
            let clear = DeepPixel::clear(&channel);
            assert_eq!(
                (clear.colour, channel.transmittance(clear.alpha)),
                ([0; 3], ONE)
            );
            let deepest = (1u64 << width) - 1;
            let expected = if representation == Representation::Transmittance {
                ONE
            } else {
                0
            };
            assert_eq!(channel.transmittance(deepest as u32), expected);
        }
    }
}

#[test]
fn the_logarithm_is_accurate() {
    let mut worst = (0.0f64, 0.0f64);
    let small = (0..2_000_000u32).map(|i| i * 4);
    let all = (0..2_000_000u32).map(|i| i.wrapping_mul(0x9e37_79b1) >> 1);
    for alpha in small.chain(all).chain([1, ONE - 1, ONE - 2, ONE / 2]) {
        let exact = -(-unit(alpha)).ln_1p() / std::f64::consts::LN_2;
        let error = (octaves::of_opacity(alpha) as f64 / 2f64.powi(44) - exact).abs();
        worst.0 = worst.0.max(error);
        if alpha < 1 << 23 && alpha > 0 {
            worst.1 = worst.1.max((error - 2f64.powi(-42)) / exact);
        }
    }
    assert!(worst.0 < 2f64.powi(-35), "absolute 2^{:.1}", worst.0.log2());
    assert!(worst.1 < 2f64.powi(-28), "relative 2^{:.1}", worst.1.log2());
    assert_eq!(octaves::of_opacity(0), 0);
    assert_eq!(octaves::of_opacity(ONE / 2), 1 << 44);
}

#[test]
fn the_exponential_is_accurate() {
    let (mut worst, mut bias) = (0.0f64, 0.0);
    for depth in (0..4_000_000u32).map(|i| i.wrapping_mul(1073)) {
        let exact = (-f64::from(depth) / 2f64.powi(28)).exp2();
        let error = unit(octaves::transmittance(depth, 28)) - exact;
        worst = worst.max(error.abs());
        bias += error * 2f64.powi(31) / 4e6;
    }
    assert!(worst < 2f64.powi(-30), "2^{:.1}", worst.log2());
    assert!(bias.abs() < 5e-3, "{bias}");
    assert_eq!(octaves::transmittance(0, 28), ONE);
    assert_eq!(octaves::transmittance(3 << 4, 4), ONE / 8);
    assert_eq!(
        [31, 32].map(|octaves| octaves::transmittance(octaves << 4, 4)),
        [1, 0]
    );
    for fraction in [0, 1, 4, 26] {
        assert_eq!(octaves::transmittance(u32::MAX, fraction), 0, "{fraction}");
    }
    // More fraction bits than the format has count as what it has.
    assert_eq!(octaves::transmittance(1 << 28, 40), ONE / 2);
}

/// What each rounding does to 40,000 layers of 2^-14 in a word of 16 bits: only dithering comes down to 1 - e^-2.44.
#[test]
fn roundings_of_a_deep_stack() {
    let opacity = |representation, rounding| {
        let channel = Channel::new(representation, rounding, 16).unwrap();
        let places = 0..32;
        let total: f64 = places
            .clone()
            .map(|x| {
                let mut word = channel.clear();
                for layer in 0..40_000 {
                    word = channel.over(word, ONE >> 14, noise(x, 7, layer));
                }
                1.0 - unit(channel.transmittance(word))
            })
            .sum();
        total / places.len() as f64
    };
    use ChannelRounding::*;
    use Representation::*;
    let exact = 1.0 - (1.0 - 2f64.powi(-14)).powi(40_000);
    assert!((exact - 0.9130).abs() < 1e-4);
    // Half a unit of 2^-15 is 2^-14 of a quarter: the last three quarters never go.
    let table = [
        (Opacity, Nearest, 0.75),
        (Opacity, Truncate, 0.5),
        (Opacity, Dither, exact),
        (Transmittance, Nearest, 0.75),
        (Transmittance, Truncate, 1.0),
        (Transmittance, Dither, exact),
        (OpticalDepth, Nearest, 0.0),
        (OpticalDepth, Truncate, 0.0),
        (OpticalDepth, Dither, exact),
    ];
    for (representation, rounding, expected) in table {
        let got = opacity(representation, rounding);
        assert!(
            (got - expected).abs() < 2e-3,
            "{representation:?} {rounding:?}: {got}, expected {expected}"
        );
    }
}

#[test]
fn optical_depth_does_not_care_for_the_order() {
    let channel = Channel::new(Representation::OpticalDepth, ChannelRounding::Nearest, 24).unwrap();
    let layers: Vec<u32> = (0..500u32).map(|i| noise(1, 2, i) >> 9).collect();
    let forth = layers
        .iter()
        .fold(channel.clear(), |word, a| channel.over(word, *a, 0));
    let back = layers
        .iter()
        .rev()
        .fold(channel.clear(), |word, a| channel.over(word, *a, 0));
    assert_eq!(forth, back);
}

#[test]
fn shares_and_the_last_transmittance_sum_to_one() {
    for representation in REPRESENTATIONS {
        let channel = Channel::new(representation, ChannelRounding::Truncate, 32).unwrap();
        let mut pixel = DeepPixel::clear(&channel);
        for layer in 0..1000 {
            pixel.front_to_back(&channel, ONE / 300, &[1 << 28; 3], [0, 0], layer);
        }
        let rest = channel.transmittance(pixel.alpha);
        let light = unit(pixel.colour[0]) + unit(rest);
        assert!((light - 1.0).abs() < 1e-6, "{representation:?}: {light}");
    }
}

/// Pictures repeat on every machine and after every change: numbers of a program in another language.
#[test]
fn noise_is_the_hash_that_is_documented() {
    let table = [
        ((0, 0, 0), 0xea2d_3c4a),
        ((1, 0, 0), 0x583e_6b2e),
        ((0, 1, 0), 0x77e8_dd99),
        ((0, 0, 1), 0x4846_6855),
        ((639, 479, 12_345), 0xe1e2_83de),
        ((u16::MAX, u16::MAX, u32::MAX), 0x5ace_28d6),
    ];
    for ((x, y, layer), expected) in table {
        assert_eq!(noise(x, y, layer), expected, "{x} {y} {layer}");
    }
}

#[test]
fn noise_is_uniform_in_every_direction() {
    let mean = |words: &mut dyn Iterator<Item = u32>| {
        let words: Vec<f64> = words.map(|w| f64::from(w) / 2f64.powi(32)).collect();
        words.iter().sum::<f64>() / words.len() as f64
    };
    // 65,536 uniform numbers have a mean within 0.0056 of 1/2 at five standard deviations.
    for other in [0, 1, 77] {
        let runs = [
            mean(&mut (0..=u16::MAX).map(|x| noise(x, other, 3))),
            mean(&mut (0..=u16::MAX).map(|y| noise(other, y, 3))),
            mean(&mut (0..1 << 16).map(|layer| noise(other, 9, layer))),
        ];
        for mean in runs {
            assert!((mean - 0.5).abs() < 0.0056, "{mean}");
        }
    }
}

#[test]
fn widths_out_of_range_are_refused() {
    for width in [0, 7, 33, 255] {
        assert!(Channel::new(Representation::Opacity, ChannelRounding::Nearest, width).is_err());
    }
}
