//! The constants of a subject's datapath as integers, for readers that know the formulas of docs/specification.md and
//! nothing else.

use super::VectorSubject;
use crate::fixed::kernel_rules;
use serde::{Deserialize, Serialize};
use splatline::blend::Blend;
use splatline::footprint::depth::{KEY_BITS, MANTISSA};
use splatline::format::Traversal;
use splatline::math::{self, LN_2};
use splatline::rules::{Cutoff, THRESHOLD};
use splatline::setup::axis_bits;
use splatline::{blend, raster};

/// One constant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConstantRecord {
    /// Name.
    pub name: String,
    /// Value; of a choice 1 if it is made.
    pub value: i64,
    /// Format: `UQ1.31`, `integer`, `mantissa`, `exponent`, `choice`.
    pub format: String,
    /// The formula of docs/specification.md that uses or gives it.
    pub formula: String,
}

/// All constants, first those of the rules, then those that follow from rules and widths, then the datapath's own.
pub fn of(subject: &VectorSubject) -> Vec<ConstantRecord> {
    let rules = kernel_rules(&subject.rules);
    let widths = subject.design.widths;
    let peak = rules.kernel.inverse_integral();
    let blend = Blend::new(&widths, &rules).constants();
    let uq = |integer: u8, fraction: u8| format!("UQ{integer}.{fraction}");
    let threshold = format!("UQ1.{THRESHOLD}");
    let (radial, by_opacity) = match rules.cutoff {
        Cutoff::Radial(cutoff) => (cutoff, false),
        Cutoff::Opacity => (0, true),
    };
    let mut list = List::default();
    list.choice("normalised", rules.normalised, "2.17");
    list.choice("compensated", rules.compensated, "2.17");
    list.number("low_pass", rules.low_pass, "2.13");
    list.number("spacing", rules.spacing, "2.12");
    list.choice("cutoff_by_opacity", by_opacity, "2.18");
    list.add("cutoff", radial, "UQ4.28", "2.18");
    list.add("kernel_end", rules.kernel.end(), "UQ4.28", "2.18");
    list.number("inverse_integral", peak, "2.17");
    list.add("alpha_max", rules.alpha_max, "UQ1.31", "8.2");
    list.add("alpha_min", rules.alpha_min as i64, &threshold, "8.3");
    let stop = rules.minimum_transmittance as i64;
    list.add("minimum_transmittance", stop, &threshold, "8.4");
    list.choice("omit_finishing", rules.omit_finishing, "8.7");
    list.choice("clamp_jacobian", rules.clamp_jacobian, "2.9");
    list.integer("table_range", rules.table_range, "4.2");

    let lane = |bits: u8| uq(1, bits);
    let (alpha, stop) = (lane(widths.alpha), lane(widths.transmittance));
    let opacity = uq(4, widths.peak + widths.weight);
    list.add("lane_alpha_max", blend.alpha_max, &alpha, "8.2");
    let least = blend.opacity_min as i64;
    list.add("lane_opacity_min", least, &opacity, "8.3");
    let least = blend.minimum_transmittance;
    list.add("lane_minimum_transmittance", least, &stop, "8.4");
    list.integer("lane_bits", lane_bits(subject), "7.1");
    list.integer("axis_bits", axis_bits(&widths), "2.10");

    list.integer("sum_guard", math::GUARD, "1.8");
    list.add("ln_2", LN_2, "UQ1.40", "1.17");
    list.integer("key_bits", KEY_BITS, "2.4");
    list.integer("key_mantissa", MANTISSA, "2.4");
    list.integer("block", raster::BLOCK, "5.12");
    list.integer("balance_guard", raster::GUARD, "5.2");
    list.integer("opacity_guard", blend::GUARD, "8.3");
    list.0
}

/// Bits of a lane's word under the subject's traversal.
pub fn lane_bits(subject: &VectorSubject) -> i64 {
    match subject.design.traversal {
        Traversal::Spans => subject.design.lane_bits().into(),
        Traversal::Box => 64,
    }
}

#[derive(Default)]
struct List(Vec<ConstantRecord>);

impl List {
    fn add(&mut self, name: &str, value: impl Into<i64>, format: &str, formula: &str) {
        self.0.push(ConstantRecord {
            name: name.to_owned(),
            value: value.into(),
            format: format.to_owned(),
            formula: formula.to_owned(),
        });
    }

    fn integer(&mut self, name: &str, value: impl Into<i64>, formula: &str) {
        self.add(name, value, "integer", formula);
    }

    fn choice(&mut self, name: &str, made: bool, formula: &str) {
        self.add(name, made, "choice", formula);
    }

    fn number(&mut self, name: &str, number: math::SoftFloat, formula: &str) {
        let mut part = |part: &str, value: i32| {
            self.add(&format!("{name}_{part}"), value, part, formula);
        };
        part("mantissa", number.mantissa);
        part("exponent", number.exponent);
    }
}
