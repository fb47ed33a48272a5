//! Compositing against its formulas, and the limits of its shortcuts.

use super::*;
extern crate std;
use crate::format::{Classic8, Deep32, Lean18, Standard24};
use proptest::prelude::*;
use std::vec;
use std::vec::Vec;

/// Widths for which all three products fit words of 32 bits or two of them, up to the limits.
const NARROW: [Widths; 5] = [
    Classic8::WIDTHS,
    Lean18::WIDTHS,
    Widths {
        colour: 14,
        rounding: Rounding::Nearest,
        ..Lean18::WIDTHS
    },
    Widths {
        peak: 15,
        weight: 13,
        alpha: 15,
        transmittance: 16,
        colour: 10,
        accumulator: 16,
        ..Standard24::WIDTHS
    },
    Widths {
        peak: 12,
        weight: 16,
        alpha: 11,
        transmittance: 20,
        colour: 8,
        accumulator: 20,
        rounding: Rounding::Truncate,
        ..Standard24::WIDTHS
    },
];

/// A product of exactly the least opacity is drawn, one less is not.
/// No design asks for more than 28 bits, but the function is public.
#[test]
fn any_bits_of_a_weight_are_defined() {
    let blend = Blend::new(&Standard24::WIDTHS, &Rules::GAUSSIAN_3D);
    for bits in 0..=u8::MAX {
        let clamped = blend.is_clamped(u32::MAX, bits);
        assert_eq!(clamped, blend.is_clamped(u32::MAX, bits % 32), "{bits}");
    }
}

#[test]
fn the_least_opacity_is_drawn() {
    for widths in [Classic8::WIDTHS, Lean18::WIDTHS, Standard24::WIDTHS] {
        for rules in [Rules::EWA, Rules::GAUSSIAN_3D] {
            let blend = Blend::new(&widths, &rules);
            let least = blend.opacity_min as u32;
            assert!(blend.opacity_unclamped(least, 1) > 0);
            assert_eq!(blend.opacity_unclamped(least - 1, 1), 0);
            assert_eq!(blend.opacity(least - 1, 1), 0);
        }
    }
}

/// `value / 2^by`, rounded, in numbers that are wide enough.
fn rounded(value: u128, by: i32, rounding: Rounding) -> u128 {
    if by <= 0 {
        return value << -by;
    }
    let (half, odd) = (1u128 << (by - 1), value >> by & 1);
    match rounding {
        Rounding::Nearest => (value + half) >> by,
        Rounding::NearestEven => (value + half - 1 + odd) >> by,
        Rounding::Truncate => value >> by,
    }
}

fn any_widths() -> impl Strategy<Value = Widths> {
    (
        (4u8..=28, 4u8..=28, 4u8..=28),
        (4u8..=30, 4u8..=28, 4u8..=27),
        prop::sample::select(vec![
            Rounding::Nearest,
            Rounding::NearestEven,
            Rounding::Truncate,
        ]),
    )
        .prop_map(
            |((weight, peak, alpha), (transmittance, colour, accumulator), rounding)| Widths {
                weight,
                peak,
                alpha,
                transmittance,
                colour,
                accumulator: accumulator.min(if rounding == Rounding::NearestEven {
                    23
                } else {
                    27
                }),
                rounding,
                ..Standard24::WIDTHS
            },
        )
}

/// A word of so many bits, often at the format's end.
fn word(bits: u32, random: u32) -> u32 {
    let end = ((1u64 << bits) - 1) as u32;
    if random & 3 == 0 {
        end
    } else {
        random.rotate_right(2) & end
    }
}

proptest! {
    /// The formulas at the module's head, word for word, for all widths and any thresholds.
    #[test]
    fn every_word_is_as_stated(
        widths in any_widths(), alpha_max: u32, omit_finishing: bool, radial: bool,
        alpha_min in prop_oneof![Just(0), 0u64..1 << THRESHOLD, Just(Rules::GAUSSIAN_3D.alpha_min)],
        minimum_transmittance in prop_oneof![Just(0), Just(1 << 57), 0u64..1 << THRESHOLD, 0u64..1 << 40],
        layers in prop::collection::vec(any::<[u32; 5]>(), 1..12),
    ) {
        let cutoff = if radial { Cutoff::Radial(4 << 28) } else { Cutoff::Opacity };
        let rules = Rules { alpha_max, omit_finishing, alpha_min, minimum_transmittance, cutoff, ..Rules::GAUSSIAN_3D };
        let blend = Blend::new(&widths, &rules);
        let Widths { weight, peak, alpha, transmittance, colour, accumulator, rounding, .. } = widths;
        let [weight, peak, alpha, t, c, s] = [weight, peak, alpha, transmittance, colour, accumulator].map(i32::from);
        let least = if radial { u128::from(alpha_min) } else { 0 };
        let blind = (peak + weight - alpha - GUARD).max(0);
        let least = rounded(least, THRESHOLD as i32 - (peak + weight - blind), Rounding::Nearest) << blind;
        let most = rounded(alpha_max.into(), 31 - alpha, Rounding::Nearest).min(1 << alpha);
        let constants = blend.constants();
        let stop = u128::from(minimum_transmittance).saturating_sub(1) >> (THRESHOLD as i32 - t);
        prop_assert_eq!(u128::from(constants.minimum_transmittance), stop);
        // The least product that is drawn, and the one below it.
        let smallest = u128::from(constants.opacity_min);
        let is_drawn = |product| rounded(product, peak + weight - alpha, rounding) > 0 && product >= least;
        prop_assert!(is_drawn(smallest) && !is_drawn(smallest - 1));
        if smallest < 1 << (4 + peak) {
            let opacities = [0, 1].map(|below| blend.opacity(smallest as u32 - below, 1));
            prop_assert!(opacities[0] > 0 || most == 0);
            prop_assert_eq!(opacities[1], 0);
        }
        prop_assert_eq!(blend.is_clamped(1 << peak, widths.weight), most < 1 << alpha);
        let [mut front, mut back, mut sum] = [Pixel::clear(&widths); 3];
        for [p, w, colours @ ..] in layers {
            let (p, w) = (word(4 + peak as u32, p), word(weight as u32, w) + (w >> 31));
            let w = w.min(1 << weight);
            let product = u128::from(p) * u128::from(w);
            let free = rounded(product, peak + weight - alpha, rounding);
            let drawn = free > 0 && product >= least;
            let a = if drawn { free.min(most) } else { 0 };
            prop_assert_eq!(u128::from(blend.opacity(p, w)), a);
            prop_assert_eq!(blend.is_clamped(p, widths.weight), rounded(u128::from(p) << weight, peak + weight - alpha, rounding) > most);
            if free <= most {
                prop_assert_eq!(u128::from(blend.opacity_unclamped(p, w)), a);
            }
            let k = colours.map(|k| word(u32::from(widths.colour_range()) + c as u32, k));
            if a == 0 || front.is_finished() {
                continue;
            }
            let before = front;
            let mut unsaturated = front;
            blend.front_to_back(&mut front, a as u32, &k);
            blend.front_to_back_of_opacity(&mut unsaturated, a as u32, &k);
            prop_assert_eq!(unsaturated, front);
            let taken = rounded(u128::from(before.transmittance) * a, alpha, rounding);
            let rest = u128::from(before.transmittance) - taken;
            let stops = rest == 0 || rest << (THRESHOLD as i32 - t) < u128::from(minimum_transmittance);
            prop_assert_eq!(front.is_finished(), stops);
            let left_out = stops && omit_finishing;
            prop_assert_eq!(u128::from(front.transmittance()), if left_out { before.transmittance.into() } else { rest });
            let layer = |i: usize, old: u32| {
                let (product, by) = (taken * u128::from(k[i]), t + c - s);
                let odd = rounding == Rounding::NearestEven && by > 0;
                let fused = rounded((u128::from(old) << by.max(0)) + product, by, rounding);
                if odd { fused } else { u128::from(old) + rounded(product, by, rounding) }
            };
            let over: Vec<u32> = (0..3).map(|i| if left_out {
                before.colour[i]
            } else {
                layer(i, before.colour[i]).min(u32::MAX.into()) as u32
            }).collect();
            prop_assert_eq!(&front.colour[..], &over[..]);
            let (old_back, old_sum) = (back, sum);
            blend.back_to_front(&mut back, a as u32, &k);
            blend.x_ray(&mut sum, a as u32, &k);
            let hidden = |value: u32| value.saturating_sub(rounded(u128::from(value) * a, alpha, rounding) as u32);
            for (i, k) in k.into_iter().enumerate() {
                let light = rounded(a * u128::from(k), alpha + c - s, rounding) as u32;
                prop_assert_eq!(back.colour[i], hidden(old_back.colour[i]).saturating_add(light));
                prop_assert_eq!(sum.colour[i], old_sum.colour[i].saturating_add(light));
            }
            prop_assert_eq!(back.transmittance, hidden(old_back.transmittance));
            let whole = rounded(a, alpha - t, rounding) as u32;
            prop_assert_eq!(sum.transmittance, old_sum.transmittance.saturating_sub(whole));
        }
    }
}

/// Each limit of single precision by itself, at it and beyond.
#[test]
fn single_precision_ends_where_it_is_stated() {
    let single = |widths: Widths| Blend::new(&widths, &Rules::EWA).is_single();
    let most = Widths {
        peak: 20,
        weight: 24,
        alpha: 19,
        transmittance: 23,
        colour: 19,
        accumulator: 19,
        rounding: Rounding::NearestEven,
        ..Standard24::WIDTHS
    };
    assert!(single(most));
    for beyond in [
        Widths { peak: 21, ..most },
        Widths { weight: 25, ..most },
        Widths { alpha: 20, ..most },
        Widths {
            transmittance: 24,
            ..most
        },
        Widths { colour: 20, ..most },
        Widths {
            accumulator: 24,
            ..most
        },
        Widths {
            accumulator: 18,
            ..most
        },
        Widths {
            peak: 9,
            weight: 10,
            ..most
        },
        Widths {
            transmittance: 10,
            colour: 9,
            ..most
        },
        Widths {
            rounding: Rounding::Nearest,
            ..most
        },
    ] {
        assert!(!single(beyond), "{beyond:?}");
    }
    assert!(single(Widths {
        peak: 10,
        weight: 10,
        ..most
    }));
    assert!(single(Widths {
        transmittance: 11,
        colour: 9,
        ..most
    }));
    // Sums that just fit their format.
    let fitting = Widths {
        peak: 12,
        weight: 12,
        alpha: 12,
        transmittance: 16,
        colour: 10,
        accumulator: 12,
        ..Standard24::WIDTHS
    };
    for (accumulator, narrow) in [(12, true), (11, false)] {
        assert_eq!(
            Blend::new(
                &Widths {
                    accumulator,
                    ..fitting
                },
                &Rules::EWA
            )
            .is_narrow(),
            narrow
        );
    }
    // Others end where the word ends.
    let others = Blend::new(
        &Widths {
            accumulator: 11,
            ..fitting
        },
        &Rules::EWA,
    );
    let mut bright = Pixel {
        colour: [u32::MAX; 3],
        ..Pixel::clear(&fitting)
    };
    others.front_to_back(&mut bright, 1 << 11, &[1 << 10; 3]);
    assert_eq!(bright.colour, [u32::MAX; 3]);
    // Nothing is dropped.
    let whole = Widths {
        peak: 8,
        weight: 8,
        alpha: 16,
        transmittance: 12,
        ..fitting
    };
    assert!(Blend::new(&whole, &Rules::EWA).is_narrow());
    // As many bits dropped as the first factor has zeros.
    for (peak, weight) in (4u8..=28).flat_map(|peak| (4..=28).map(move |weight| (peak, weight))) {
        let alpha = (2 * peak + weight).saturating_sub(28u8);
        if (4..=28).contains(&alpha) {
            let widths = Widths {
                peak,
                weight,
                alpha,
                ..Standard24::WIDTHS
            };
            let (p, w) = ((1u32 << peak) - 1, (1u32 << weight) - 1);
            let by = i32::from(peak + weight) - i32::from(alpha);
            let expected = rounded(u128::from(p) * u128::from(w), by, widths.rounding);
            assert_eq!(
                u128::from(Blend::new(&widths, &Rules::EWA).opacity(p, w)),
                expected,
                "{peak} {weight}"
            );
        }
    }
    // The largest factors of products that fit 32 bits, or just do not.
    for (peak, alpha) in (4..=24).flat_map(|peak| (4..=28).map(move |alpha| (peak, alpha))) {
        let widths = Widths {
            peak,
            alpha,
            weight: 28 - peak,
            ..Standard24::WIDTHS
        };
        let full =
            Blend::new(&widths, &Rules::EWA).opacity(u32::MAX >> (28 - peak), 1 << widths.weight);
        assert_eq!(full, 1 << alpha, "{peak} {alpha}");
    }
    let narrow = Blend::new(&Lean18::WIDTHS, &Rules::EWA);
    assert!(narrow.is_narrow());
    let [opacity, contribution, colour] =
        [narrow.opacity, narrow.contribution, narrow.colour].map(Product::wide);
    for wide in [
        Blend { opacity, ..narrow },
        Blend {
            contribution,
            ..narrow
        },
        Blend { colour, ..narrow },
        Blend {
            sums_fit: false,
            ..narrow
        },
    ] {
        assert!(!wide.is_narrow());
    }
    let radial = Rules {
        cutoff: Cutoff::Radial(4 << 28),
        ..Rules::GAUSSIAN_3D
    };
    for (rules, all) in [
        (Rules::EWA, true),
        (Rules::GAUSSIAN_3D, true),
        (radial, false),
    ] {
        assert_eq!(Blend::new(&Lean18::WIDTHS, &rules).draws_all_visible(), all);
    }
}

proptest! {
    /// The oracle is the same blend with every shortcut switched off.
    #[test]
    fn shortcuts_change_no_bit(
        choice in 0..NARROW.len(), rules in prop_oneof![Just(Rules::EWA), Just(Rules::GAUSSIAN_3D)],
        layers in prop::collection::vec((any::<u32>(), any::<u32>(), any::<[u32; 3]>()), 1..50),
    ) {
        let widths = NARROW[choice];
        let fast = Blend::new(&widths, &rules);
        let words = [fast.opacity.words, fast.contribution.words, fast.colour.words];
        prop_assert!(fast.sums_fit && !words.contains(&Words::Wide));
        let [opacity, contribution, colour] = [fast.opacity, fast.contribution, fast.colour].map(Product::wide);
        let wide = Blend { opacity, contribution, colour, sums_fit: false, ..fast };
        let (mut a, mut b) = (Pixel::clear(&widths), Pixel::clear(&widths));
        for (peak, weight, colour) in layers {
            // Half of all values lie at the end of their format.
            let value = |bits: u32, integer: u8, fraction: u8| {
                let end = (1u64 << (integer + fraction)) - u64::from(integer > 0);
                if bits & 1 == 0 { end as u32 } else { (u64::from(bits >> 1) % (end + 1)) as u32 }
            };
            let (peak, weight) = (value(peak, 4, widths.peak), value(weight, 0, widths.weight));
            let colour = colour.map(|c| value(c, widths.colour_range(), widths.colour));
            let alpha = fast.opacity(peak, weight);
            prop_assert_eq!(alpha, wide.opacity(peak, weight));
            if alpha > 0 && !a.is_finished() {
                fast.front_to_back(&mut a, alpha, &colour);
                wide.front_to_back(&mut b, alpha, &colour);
            }
            prop_assert_eq!(a, b);
        }
    }
}

#[test]
fn sums_are_divided_to_these() {
    use crate::blend::surface::{Fragment, WeightedSum};
    let mut next = crate::random();
    let widths = Widths {
        mantissa: 31,
        ..Deep32::WIDTHS
    };
    let words = (0..1000).flat_map(|_| {
        let filtered = WeightedSum::new(&widths, 0).normalise(&Fragment {
            weight: next() as u32 >> (next() % 8),
            colour: [0; 3].map(|_| next() as u32),
            opacity: next() as u32,
            normal: [0; 3].map(|_| next() as i32),
            ..Fragment::EMPTY
        });
        let [red, green, blue] = filtered.colour.map(u64::from);
        let [x, y, z] = filtered.normal.map(|part| part as u64);
        [red, green, blue, filtered.opacity.into(), x, y, z]
    });
    assert_eq!(crate::digest(words), 1_186_260_060_372_628_850);
}
