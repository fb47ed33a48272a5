//! The units that a core's tables make, alone: rounding, reciprocal, root (with and without Heron's step) and logarithm, of mantissas of a design's width
//! and of numbers that carry, against `SoftFloat::from_wide`, `reciprocal`, `square_root` and `cutoff`.
//!
//! The circuit is the setup unit; its program computes nothing else ([`ProgramKind::Units`]), and the results leave in fields that pass the packet's maker as they are.

use super::program::{ProgramKind, SetupProgram};
use super::record::record;
use super::unit::{channels, constant_words, one_record, packet, write_constants};
use crate::bench::{Bench, Checker, Item, Pressure};
use crate::circuit::SETUP;
use crate::random::split_mix;
use crate::unit::{Circuit, Extent, Findings, Missing, Simulation, Unit};
use anyhow::{Context, Result};
use splatline::footprint::packet::Layout;
use splatline::format::{Traversal, Widths};
use splatline::math::{SoftFloat, reciprocal, square_root};
use splatline::rules::Rules;
use splatline::setup::cutoff;
use splatline::splat::{Axis, VolumeSplat};
use splatline_sim::vectors::hard_cases;

/// The setup unit with that program.
pub struct TableUnits(Circuit);

impl TableUnits {
    /// Of a design.
    pub fn new(design: &str) -> Result<TableUnits> {
        let program = SetupProgram::new(ProgramKind::Units);
        let circuit = Circuit::new(&SETUP, design, 2)?;
        Ok(TableUnits(circuit.with_program(program)))
    }
}

impl Unit for TableUnits {
    type Load = Vec<SoftFloat>;
    const PRESSURES: usize = 1;

    fn circuit(&self) -> &Circuit {
        &self.0
    }

    /// For the full extent all mantissas of 18 bits, and as many of wider ones.
    fn loads(&self, extent: Extent, _: &mut Missing) -> Result<Vec<Vec<SoftFloat>>> {
        let mantissa = self.0.widths.mantissa;
        Ok(vec![match extent {
            Extent::Quick => numbers(mantissa, 37 << (mantissa - 18)),
            Extent::Full => numbers(mantissa, 1 << (mantissa - 18)),
        }])
    }

    fn name(&self, _: &Vec<SoftFloat>) -> String {
        "units of the tables".to_owned()
    }

    fn compare(&self, circuit: Simulation, load: &Vec<SoftFloat>, _: usize) -> Result<Findings> {
        let widths = self.0.widths;
        let (view, _) = hard_cases(1, [640, 480], 1);
        let mut bench = Bench::new(circuit, 1)?;
        let words = constant_words(&self.0, &view, &Rules::GAUSSIAN_3D)?;
        write_constants(&mut bench, &words)?;
        let item = |number: &SoftFloat| Some(one_record(record(&bearing(*number))?.to_vec()));
        let items: Option<Vec<Item>> = load.iter().map(item).collect();
        let mut checker = TableChecker {
            layout: Layout::new(&widths, Traversal::Spans),
            widths,
            numbers: load,
        };
        let channels = channels(&bench.circuit)?;
        let items = items.context("a number without a place in a record")?;
        bench.run(&channels, &items, &Pressure::at_ends([0; 3]), &mut checker)
    }
}

/// Every `step`-th mantissa of the design's width, and some of 31 bits, at an odd and an even exponent.
fn numbers(bits: u8, step: usize) -> Vec<SoftFloat> {
    let usual = (1i32 << (bits - 1)..(1i64 << bits) as i32).step_by(step);
    let carrying = (0..31).flat_map(|shift| [i32::MAX >> shift, (1 << 30) >> shift]);
    let mut state = 1;
    let long = (0..2_000).map(|_| (split_mix(&mut state) >> 34) as i32 | 1 << 30);
    let carrying = carrying.filter(|mantissa| *mantissa > 0);
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

struct TableChecker<'a> {
    layout: Layout,
    widths: Widths,
    numbers: &'a [SoftFloat],
}

impl Checker for TableChecker<'_> {
    fn check(&mut self, place: usize, answer: &[Vec<u32>]) -> Option<String> {
        let number = self.numbers[place];
        let bits = u32::from(self.widths.mantissa);
        let Ok(got) = self.layout.decode(&packet(&answer[2])) else {
            return Some("a packet of another version".to_owned());
        };
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
}
