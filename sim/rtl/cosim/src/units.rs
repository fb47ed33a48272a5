//! The two units behind every alignment of the circuit, fed with words that no scene has: shifts of 64 and more, saturation, roundings that carry.
//!
//! What they do there reaches no pixel of a legal packet, so that drawing alone would not notice a mistake.

use crate::bench::Bench;
use crate::model::{Inputs, Outputs};
use crate::workload::split_mix;
use splatline::math::{SoftFloat, shift_signed};
use std::collections::VecDeque;

/// Words that each comparison feeds.
const WORDS: usize = 3_000;

/// Magnitude bits of the units in flat_primitive.sv.
const BITS: u32 = 40;

/// Cycles of align.sv and of normalise.sv.
const ALIGN: usize = 4;
const NORMALISE: usize = 3;

/// A value and the shift that it is aligned by.
#[derive(Clone, Copy)]
struct UnitWord {
    value: i64,
    shift: i16,
}

impl UnitWord {
    fn random(state: &mut u64) -> UnitWord {
        let [bits, kind, far] = [0; 3].map(|_: u32| split_mix(state));
        let magnitude = match kind % 4 {
            // Ones that a rounding carries through, powers of two, and anything.
            0 => (1 << ((kind >> 8) % u64::from(BITS))) - 1,
            1 => 1 << ((kind >> 8) % u64::from(BITS)),
            _ => bits >> (64 - BITS) >> ((kind >> 8) % u64::from(BITS)),
        };
        let reach = if kind & 64 == 0 { 90 } else { 1_000 };
        UnitWord {
            value: if kind & 128 == 0 { 1 } else { -1 } * magnitude as i64,
            shift: (far % (2 * reach + 1)) as i16 - reach as i16,
        }
    }
}

/// The first word of which either unit makes something else than the kernel, in words.
pub fn first_difference(bench: &mut Bench, mantissa: u8) -> Option<String> {
    let mut state = 5;
    let mut fed = VecDeque::new();
    for _ in 0..WORDS {
        let word = UnitWord::random(&mut state);
        let out = bench.step(&Inputs {
            unit_negative: (word.value < 0).into(),
            unit_magnitude: word.value.unsigned_abs(),
            unit_shift: word.shift as u16,
            ..bench.pixel_offer(false)
        });
        if let (Some(aligned), Some(normalised)) = (fed.get(ALIGN - 1), fed.get(NORMALISE - 1)) {
            let difference = of_alignment(aligned, &out);
            let difference = difference.or_else(|| of_normalisation(normalised, mantissa, &out));
            if difference.is_some() {
                return difference;
            }
        }
        fed.push_front(word);
        fed.truncate(ALIGN);
    }
    None
}

fn of_alignment(UnitWord { value, shift }: &UnitWord, out: &Outputs) -> Option<String> {
    let expected = shift_signed(*value, (*shift).into());
    let got = out.aligned as i64;
    (got != expected)
        .then(|| format!("{value} aligned by {shift}: the kernel has {expected}, align.sv {got}"))
}

fn of_normalisation(
    UnitWord { value, .. }: &UnitWord,
    mantissa: u8,
    out: &Outputs,
) -> Option<String> {
    let expected = SoftFloat::from_wide(*value, 0, mantissa.into());
    let magnitude = out.normal as i32;
    let signed = if out.normal_negative == 1 {
        -magnitude
    } else {
        magnitude
    };
    let got = (signed, i32::from(out.normal_exponent as i16));
    // The exponent of 0 says nothing.
    let same = got.0 == expected.mantissa && (got.0 == 0 || got.1 == expected.exponent);
    (!same).then(|| {
        format!("{value} as a mantissa: the kernel has {expected:?}, normalise.sv {got:?}")
    })
}
