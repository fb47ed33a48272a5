//! The constants of a subject's datapath as integers, for readers that know the formulas of docs/specification.md and nothing else.

use super::VectorSubject;
use crate::fixed::kernel_rules;
use serde::{Deserialize, Serialize};
use splatline::blend::Blend;
use splatline::footprint::depth::{KEY_BITS, MANTISSA};
use splatline::format::{Traversal, Widths};
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
    let (radial, choice) = match rules.cutoff {
        Cutoff::Radial(cutoff) => (cutoff, 0),
        Cutoff::Opacity => (0, 1),
    };
    let choice_of = |made: bool| i64::from(made);
    let mut list = List::default();
    list.add("normalised", choice_of(rules.normalised), "choice", "2.17");
    list.add(
        "compensated",
        choice_of(rules.compensated),
        "choice",
        "2.17",
    );
    list.number("low_pass", rules.low_pass, "2.13");
    list.number("spacing", rules.spacing, "2.12");
    list.add("cutoff_by_opacity", choice, "choice", "2.18");
    list.add("cutoff", radial.into(), "UQ4.28", "2.18");
    list.add("kernel_end", rules.kernel.end().into(), "UQ4.28", "2.18");
    list.number("inverse_integral", peak, "2.17");
    list.add("alpha_max", rules.alpha_max.into(), "UQ1.31", "8.2");
    list.add("alpha_min", rules.alpha_min as i64, &threshold, "8.3");
    list.add(
        "minimum_transmittance",
        rules.minimum_transmittance as i64,
        &threshold,
        "8.4",
    );
    list.add(
        "omit_finishing",
        choice_of(rules.omit_finishing),
        "choice",
        "8.7",
    );
    list.add(
        "clamp_jacobian",
        choice_of(rules.clamp_jacobian),
        "choice",
        "2.9",
    );
    list.add("table_range", rules.table_range.into(), "integer", "4.2");

    let Widths {
        peak,
        weight,
        alpha,
        transmittance,
        ..
    } = widths;
    list.add(
        "lane_alpha_max",
        blend.alpha_max.into(),
        &uq(1, alpha),
        "8.2",
    );
    list.add(
        "lane_opacity_min",
        blend.opacity_min as i64,
        &uq(4, peak + weight),
        "8.3",
    );
    list.add(
        "lane_minimum_transmittance",
        blend.minimum_transmittance.into(),
        &uq(1, transmittance),
        "8.4",
    );
    list.add("lane_bits", lane_bits(subject), "integer", "7.1");
    list.add("axis_bits", axis_bits(&widths).into(), "integer", "2.10");

    list.add("sum_guard", math::GUARD.into(), "integer", "1.8");
    list.add("ln_2", LN_2, "UQ1.40", "1.17");
    list.add("key_bits", KEY_BITS.into(), "integer", "2.4");
    list.add("key_mantissa", MANTISSA.into(), "integer", "2.4");
    list.add("block", raster::BLOCK.into(), "integer", "5.12");
    list.add("balance_guard", raster::GUARD.into(), "integer", "5.2");
    list.add("opacity_guard", blend::GUARD.into(), "integer", "8.3");
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
    fn add(&mut self, name: &str, value: i64, format: &str, formula: &str) {
        self.0.push(ConstantRecord {
            name: name.to_owned(),
            value,
            format: format.to_owned(),
            formula: formula.to_owned(),
        });
    }

    fn number(&mut self, name: &str, number: math::SoftFloat, formula: &str) {
        let mut part = |part: &str, value: i32| {
            self.add(&format!("{name}_{part}"), value.into(), part, formula);
        };
        part("mantissa", number.mantissa);
        part("exponent", number.exponent);
    }
}
