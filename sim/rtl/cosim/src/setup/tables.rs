//! The units that a core's tables make, alone: rounding, reciprocal, root (with and without Heron's step) and
//! logarithm, of mantissas of a design's width and of numbers that carry, against `SoftFloat::from_wide`, `reciprocal`,
//! `square_root` and `cutoff`.
//!
//! The program computes nothing else ([`ProgramKind::Units`](super::program::ProgramKind::Units)), and the results
//! leave in fields that pass the packet's maker as they are.

use super::loads::SetupLoad;
use crate::unit::{Extent, Loads};
use splatline::footprint::packet::{Layout, Packet};
use splatline::format::Widths;
use splatline::math::{SoftFloat, reciprocal, square_root};
use splatline::rules::Rules;
use splatline::setup::cutoff;
use splatline::splat::{Axis, VolumeSplat};
use splatline_sim::scene::synthetic::Random;
use splatline_sim::vectors::hard_cases;

/// Splats with these numbers as their weights: for the full extent all mantissas of 18 bits, and as many of wider ones.
pub fn arguments(mantissa: u8, extent: Extent) -> Loads<SetupLoad> {
    let step = extent.of(37, 1) << (mantissa - 18);
    let load = SetupLoad {
        view: hard_cases(1, [640, 480], 1).0,
        rules: Rules::GAUSSIAN_3D,
        splats: numbers(mantissa, step).into_iter().map(bearing).collect(),
    };
    vec![("units of the tables".to_owned(), load)]
}

/// Every `step`-th mantissa of the design's width, and some of 31 bits, at an odd and an even exponent.
fn numbers(bits: u8, step: usize) -> Vec<SoftFloat> {
    let usual = (1i32 << (bits - 1)..(1i64 << bits) as i32).step_by(step);
    let carrying = (0..31).flat_map(|shift| [i32::MAX >> shift, (1 << 30) >> shift]);
    let mut random = Random(1);
    let long = (0..2_000).map(|_| (random.next() >> 34) as i32 | 1 << 30);
    let mantissas = usual.chain(carrying).chain(long);
    let both = |mantissa| [-27, -20].map(|exponent| SoftFloat { mantissa, exponent });
    mantissas.flat_map(both).collect()
}

/// A splat with this weight, and in its first axis a 0 of a large power: a term that must not count.
fn bearing(weight: SoftFloat) -> VolumeSplat {
    let large = Axis {
        mantissa: [0, 1, 0],
        exponent: 100,
    };
    VolumeSplat {
        centre: [SoftFloat::ZERO; 3],
        axes: [large, Axis::default(), Axis::default()],
        weight,
        colour: [0.0; 3].map(splatline::float::colour),
    }
}

/// What a packet has of a splat's weight that the kernel has not, in words.
pub fn difference(
    widths: &Widths,
    number: SoftFloat,
    layout: &Layout,
    packet: &Packet,
) -> Option<String> {
    let Ok(got) = layout.decode(packet) else {
        return Some("a packet of another version".to_owned());
    };
    let bits = u32::from(widths.mantissa);
    let rounded = SoftFloat::from_wide(number.mantissa.into(), number.exponent, bits);
    // The circuit's root is twice the kernel's; its half stands in a constant of setup.
    let root = square_root(number, bits).scaled_by(1);
    let short = square_root(number, 16);
    let short = SoftFloat::from_wide(short.mantissa.into(), short.exponent, bits);
    let pairs = [
        ("rounded", got.ldl.shear, rounded),
        ("reciprocal", got.ldl.vertical, reciprocal(number, bits)?),
        ("root", got.ldl.horizontal, root),
        ("root of 16 bits", got.ldl.squared_width, short),
    ];
    if let Some((name, got, expected)) = pairs.into_iter().find(|pair| pair.1 != pair.2) {
        let words = format!("the kernel has {expected:?}, the circuit {got:?}");
        return Some(format!("{name} of {number:?}: {words}"));
    }
    // The cut-off is a number only where the opacity is above the least.
    let end = cutoff(&Rules::GAUSSIAN_3D, number).unwrap_or(0);
    let differs = end > 0 && got.cutoff != end;
    differs.then(|| format!("cut-off of {number:?}: {end}, the circuit {}", got.cutoff))
}
