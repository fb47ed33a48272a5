//! The blend of `lean18` as single precision has it, one fused multiply-add a product, as the head of
//! `src/blend/mod.rs` states it: every pixel word equal to the kernel's. Numbers are in the ordinary `f32` of this
//! machine and share nothing with the kernel's integers.

use proptest::prelude::*;
use splatline::blend::{Blend, FINISHED, Pixel};
use splatline::format::{Lean18, Widths};
use splatline::rules::Rules;

const WIDTHS: Widths = Lean18::WIDTHS;
const WHOLE: f32 = 8_388_608.0;

fn unit(bits: u8) -> f32 {
    (-f32::from(bits)).exp2()
}

/// T and the sums, each as a number that is an integer.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SinglePixel {
    light: f32,
    sums: [f32; 3],
    finished: bool,
}

impl SinglePixel {
    fn over(&mut self, [peak, weight]: [u32; 2], colour: [u32; 3], rules: &Rules) {
        let limit = Blend::new(&WIDTHS, rules).constants();
        let scale = unit(WIDTHS.peak + WIDTHS.weight - WIDTHS.alpha);
        let alpha = (peak as f32 * scale).mul_add(weight as f32, WHOLE) - WHOLE;
        let alpha = alpha.min(limit.alpha_max as f32);
        let share = (self.light * unit(WIDTHS.alpha)).mul_add(alpha, WHOLE) - WHOLE;
        let rest = self.light - share;
        let stop = alpha > 0.0 && rest <= limit.minimum_transmittance as f32;
        self.finished = stop;
        if stop && rules.omit_finishing {
            return;
        }
        let scale = unit(WIDTHS.transmittance + WIDTHS.colour - WIDTHS.accumulator);
        for (sum, c) in self.sums.iter_mut().zip(colour) {
            *sum = share.mul_add(c as f32 * scale, WHOLE + *sum) - WHOLE;
        }
        self.light = rest;
    }

    fn words(&self) -> Pixel {
        let mark = if self.finished { FINISHED } else { 0 };
        Pixel {
            colour: self.sums.map(|sum| sum as u32),
            transmittance: self.light as u32 | mark,
        }
    }
}

/// A value up to `end`, itself included, of any magnitude.
fn up_to(end: u32) -> impl Strategy<Value = u32> {
    prop_oneof![
        Just(end),
        Just(end - 1),
        0..=end,
        (0u32..22).prop_map(move |by| end >> by)
    ]
}

type Layer = ([u32; 2], [u32; 3]);

fn layer() -> impl Strategy<Value = Layer> {
    let colour = 1 << (WIDTHS.colour + WIDTHS.colour_range());
    let peak = up_to((1 << (4 + WIDTHS.peak)) - 1);
    let weight = up_to(1 << WIDTHS.weight);
    (
        (peak, weight),
        [up_to(colour), up_to(colour), up_to(colour)],
    )
        .prop_map(|((p, w), c)| ([p, w], c))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4_000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn single_precision_is_the_kernel(layers in prop::collection::vec(layer(), 1..60), ewa: bool) {
        let rules = if ewa { Rules::EWA } else { Rules::GAUSSIAN_3D };
        let blend = Blend::new(&WIDTHS, &rules);
        prop_assert!(blend.is_single() && blend.draws_all_visible());
        let mut pixel = Pixel::clear(&WIDTHS);
        let mut single = SinglePixel { light: pixel.transmittance as f32, sums: [0.0; 3], finished: false };
        for (factors, colour) in layers {
            let alpha = blend.opacity(factors[0], factors[1]);
            if alpha > 0 {
                blend.front_to_back(&mut pixel, alpha, &colour);
            }
            single.over(factors, colour, &rules);
            prop_assert_eq!(single.words(), pixel, "{:?} {:?}", factors, colour);
            // The bound on sums: 2^(n+s) (1 - T).
            let taken = (1 << WIDTHS.transmittance) - pixel.transmittance();
            let bound = taken << (WIDTHS.accumulator + WIDTHS.colour_range() - WIDTHS.transmittance);
            prop_assert!(pixel.colour.iter().all(|sum| *sum <= bound));
            if pixel.is_finished() {
                break;
            }
        }
    }
}

/// Every transmittance and every opacity of a share: all whose product is a tie, and their neighbours.
#[test]
fn ties_of_all_transmittances() {
    let blend = Blend::new(&WIDTHS, &Rules::EWA);
    let one = 1u32 << WIDTHS.transmittance;
    for transmittance in (1000..=one).step_by(7) {
        // T A = 2^17 modulo 2^18 needs as many factors of two in A as T lacks of 17.
        let twos = transmittance.trailing_zeros().min(17);
        let alpha = 1u32 << (17 - twos);
        for alpha in [alpha, 3 * alpha, alpha + 1, (1 << 18) - alpha] {
            let alpha = alpha.min(1 << 18);
            let mut pixel = Pixel {
                colour: [0; 3],
                transmittance,
            };
            blend.front_to_back(&mut pixel, alpha, &[0; 3]);
            let single = (transmittance as f32 * unit(18)).mul_add(alpha as f32, WHOLE) - WHOLE;
            assert_eq!(
                transmittance - pixel.transmittance(),
                single as u32,
                "{transmittance} {alpha}"
            );
        }
    }
}
