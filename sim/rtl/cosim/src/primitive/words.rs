//! Words that reach no pixel, so that drawing alone would not notice a mistake in them: those of the two units behind
//! every alignment of the circuit, fed with shifts of 64 and more, saturation and roundings that carry; and the row
//! unit's roots, whose last bits the spans' slack hides.

use crate::bench::Bench;
use crate::simulation::Simulation;
use splatline::math::{SoftFloat, root_seed, shift_signed};
use splatline_sim::scene::synthetic::Random;
use std::collections::VecDeque;

/// Words that a comparison feeds.
const WORDS: usize = 3_000;

/// Magnitude bits of the units in flat_primitive.sv.
const BITS: u32 = 40;

/// Cycles of align.sv and of normalise.sv.
const ALIGN: usize = 4;
const NORMALISE: usize = 3;

/// A value and the shift that it is aligned by.
fn word(random: &mut Random) -> (i64, i16) {
    let [bits, kind, far] = [0; 3].map(|_: u32| random.next());
    let magnitude = match kind % 4 {
        // Ones that a rounding carries through, powers of two, and anything.
        0 => (1 << ((kind >> 8) % u64::from(BITS))) - 1,
        1 => 1 << ((kind >> 8) % u64::from(BITS)),
        _ => bits >> (64 - BITS) >> ((kind >> 8) % u64::from(BITS)),
    };
    let reach = if kind & 64 == 0 { 90 } else { 1_000 };
    let sign = if kind & 128 == 0 { 1 } else { -1 };
    let shift = (far % (2 * reach + 1)) as i16 - reach as i16;
    (sign * magnitude as i64, shift)
}

/// The first word of which either unit makes something else than the kernel, in words.
pub fn first_difference(bench: &mut Bench, mantissa: u8) -> Option<String> {
    let mut random = Random(5);
    let mut fed = VecDeque::new();
    for _ in 0..WORDS {
        let (value, shift) = word(&mut random);
        bench.set(&[
            ("unit_negative", (value < 0).into()),
            ("unit_magnitude", value.unsigned_abs()),
            ("unit_shift", u64::from(shift as u16)),
        ]);
        bench.circuit.settle();
        if let (Some((then, by)), Some((later, _))) = (fed.get(ALIGN - 1), fed.get(NORMALISE - 1)) {
            let got = bench.circuit.read("aligned") as i64;
            let expected = shift_signed(*then, i32::from(*by));
            let differs = (got != expected).then(|| {
                format!("{then} aligned by {by}: the kernel has {expected}, align.sv {got}")
            });
            let normal = ["normal", "normal_negative", "normal_exponent"];
            let got = normal.map(|port| bench.circuit.read(port));
            let difference = differs.or_else(|| of_normalisation(*later, mantissa, got));
            if difference.is_some() {
                return difference;
            }
        }
        bench.circuit.edge();
        bench.cycles += 1;
        fed.push_front((value, shift));
        fed.truncate(ALIGN);
    }
    None
}

fn of_normalisation(value: i64, mantissa: u8, normal: [u64; 3]) -> Option<String> {
    let [magnitude, negative, exponent] = normal;
    let expected = SoftFloat::from_wide(value, 0, mantissa.into());
    let sign = if negative == 1 { -1 } else { 1 };
    let got = (sign * magnitude as i32, i32::from(exponent as i16));
    // The exponent of 0 says nothing.
    let same = got.0 == expected.mantissa && (got.0 == 0 || got.1 == expected.exponent);
    (!same).then(|| {
        format!("{value} as a mantissa: the kernel has {expected:?}, normalise.sv {got:?}")
    })
}

/// The row unit's arguments on their way, and the roots that were compared with the kernel's.
#[derive(Default)]
pub struct Roots {
    under_way: VecDeque<u64>,
    /// Roots compared.
    pub compared: u64,
}

impl Roots {
    /// The difference of the root that leaves the unit in this cycle.
    pub fn note(&mut self, circuit: &Simulation) -> Option<String> {
        let mut difference = None;
        if circuit.read("root_valid") == 1
            && let Some(squared) = self.under_way.pop_front()
        {
            self.compared += 1;
            let (expected, got) = (u64::from(root_seed(squared).0), circuit.read("root"));
            difference = (expected != got).then(|| {
                format!("root of {squared:#x}: the kernel has {expected:#x}, the row unit {got:#x}")
            });
        }
        if circuit.read("squared_valid") == 1 {
            self.under_way.push_back(circuit.read("squared"));
        }
        difference
    }
}
