//! The units that a core's tables make, alone: rounding, reciprocal, root (with and without Heron's step) and logarithm, of every mantissa of a
//! design's width and of numbers that carry, against `SoftFloat::from_wide`, `reciprocal`, `square_root` and `cutoff`.
//!
//! The circuit is the setup unit; its program computes nothing else ([`units`]), and the results leave in fields that pass the packet's maker
//! as they are.

use super::bench::{SetupLoad, record, write_constants};
use super::circuit::{SetupSpec, library};
use super::model::{SetupInputs, SetupModel};
use super::program::units;
use crate::switch::MistakeNumber;
use crate::workload::split_mix;
use anyhow::{Result, ensure};
use splatline::footprint::packet::{Layout, Packet};
use splatline::format::Widths;
use splatline::math::{SoftFloat, reciprocal, square_root};
use splatline::rules::Rules;
use splatline::setup::cutoff;
use splatline::splat::{Axis, VolumeSplat};
use splatline_sim::vectors::hard_cases;
use std::path::Path;

/// Cycles for a result after which the unit counts as hanging.
const PATIENCE: u32 = 20_000;

/// The first number of which the circuit makes something else than the kernel, in words: every `step`-th mantissa, at odd and even exponents.
pub fn first_difference(design: &str, widths: &Widths, step: usize) -> Result<Option<String>> {
    let folder = tempfile::tempdir()?;
    let spec = SetupSpec {
        program: units,
        ..SetupSpec::new(design, widths, 3)
    };
    difference(&library(folder.path(), &spec)?, 0, widths, step)
}

/// The same of a circuit with one of the mistakes that it was built with.
pub fn difference(
    library: &Path,
    mistake: MistakeNumber,
    widths: &Widths,
    step: usize,
) -> Result<Option<String>> {
    let mut model = SetupModel::with_mistake(library, 1, mistake)?;
    let (view, _) = hard_cases(1, [640, 480], 1);
    let load = SetupLoad {
        name: "units".to_owned(),
        view,
        rules: Rules::GAUSSIAN_3D,
        splats: Vec::new(),
    };
    write_constants(&mut model, &units(widths)?.constants, widths, &load)?;
    let layout = Layout::new(widths);
    let numbers = numbers(widths, step);
    let (mut offered, mut answered, mut idle) = (0, 0, 0);
    while answered < numbers.len() {
        let next = numbers
            .get(offered)
            .and_then(|number| record(&bearing(*number)));
        let out = model.tick(&SetupInputs {
            record_valid: next.is_some().into(),
            record: next.unwrap_or_default(),
            packet_ready: 1,
            ..SetupInputs::default()
        });
        offered += usize::from(next.is_some() && out.record_ready == 1);
        idle += 1;
        ensure!(
            idle < PATIENCE,
            "the setup unit hangs after {answered} numbers"
        );
        if out.packet_valid == 1 {
            idle = 0;
            if let Some(difference) = compare(widths, &layout, numbers[answered], &out.packet) {
                return Ok(Some(difference));
            }
            answered += 1;
        }
    }
    Ok(None)
}

/// Mantissas of the design's width, and some of 31 bits, at an odd and an even exponent.
fn numbers(widths: &Widths, step: usize) -> Vec<SoftFloat> {
    let bits = u32::from(widths.mantissa);
    let usual = (1i32 << (bits - 1)..(1i64 << bits) as i32).step_by(step);
    let carrying = (0..31).flat_map(|shift| [i32::MAX >> shift, (1 << 30) >> shift]);
    let mut state = 1;
    let long = (0..2_000).map(|_| (split_mix(&mut state) >> 34) as i32 | 1 << 30);
    let carrying = carrying.filter(|mantissa| *mantissa > 0);
    let mantissas = usual.chain(carrying).chain(long);
    mantissas
        .flat_map(|mantissa| [-27, -20].map(|exponent| SoftFloat { mantissa, exponent }))
        .collect()
}

/// A splat with this weight, and in its first axis a 0 of a large power: a term that must not count.
fn bearing(weight: SoftFloat) -> VolumeSplat {
    let nothing = SoftFloat {
        mantissa: 0,
        exponent: 0,
    };
    let large = Axis {
        mantissa: [0, 1, 0],
        exponent: 100,
    };
    VolumeSplat {
        centre: [nothing; 3],
        axes: [large, Axis::default(), Axis::default()],
        weight,
        colour: [0.0; 3].map(splatline::float::colour),
    }
}

fn compare(widths: &Widths, layout: &Layout, number: SoftFloat, packet: &Packet) -> Option<String> {
    let bits = u32::from(widths.mantissa);
    let Ok(got) = layout.decode(packet) else {
        return Some("a packet of another version".to_owned());
    };
    let rounded = SoftFloat::from_wide(number.mantissa.into(), number.exponent, bits);
    // The circuit's root is twice the kernel's; its half stands in a constant of setup.
    let root = square_root(number, bits).scaled_by(1);
    let short = square_root(number, 16);
    let short = SoftFloat::from_wide(short.mantissa.into(), short.exponent, bits);
    let end = cutoff(&Rules::GAUSSIAN_3D, number).unwrap_or(0);
    let pairs = [
        ("rounded", got.ldl.shear, rounded),
        ("reciprocal", got.ldl.vertical, reciprocal(number, bits)?),
        ("root", got.ldl.horizontal, root),
        ("root of 16 bits", got.ldl.squared_width, short),
    ];
    for (name, got, expected) in pairs {
        if got != expected {
            return Some(format!(
                "{name} of {number:?}: the kernel has {expected:?}, the circuit {got:?}"
            ));
        }
    }
    // The cut-off is a number only where the opacity is above the least.
    (end > 0 && got.cutoff != end).then(|| {
        format!(
            "cut-off of {number:?}: the kernel has {end}, the circuit {}",
            got.cutoff
        )
    })
}
