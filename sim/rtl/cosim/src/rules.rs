//! What primitive and machine are told of the rules of blending, by the kernel's own constants.

use crate::bench::Bench;
use crate::package::table;
use anyhow::Result;
use splatline::blend::Blend;
use splatline::format::Widths;
use splatline::rules::Rules;

/// Drives the rules at the design's widths and writes the footprint table.
pub fn write_rules(bench: &mut Bench, widths: &Widths, rules: &Rules) -> Result<()> {
    let constants = Blend::new(widths, rules).constants();
    bench.set(&[
        ("alpha_max", constants.alpha_max.into()),
        ("least", constants.opacity_min),
        (
            "minimum_transmittance",
            constants.minimum_transmittance.into(),
        ),
        ("omit_finishing", constants.omit_finishing.into()),
        ("wide_table", (rules.table_range == 4).into()),
        ("table_valid", 1),
    ])?;
    for (index, entry) in table(widths, rules).iter().enumerate() {
        bench.set(&[
            ("table_index", index as u64),
            ("table_low", entry.low.into()),
            ("table_step", entry.step.into()),
        ])?;
        bench.cycle();
    }
    bench.set(&[("table_valid", 0)])
}
