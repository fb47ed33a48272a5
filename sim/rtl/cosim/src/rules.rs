//! What primitive and machine are told of the rules of blending, by the kernel's own constants.

use crate::bench::Bench;
use crate::package::table;
use anyhow::{Result, bail};
use splatline::blend::Blend;
use splatline::format::Widths;
use splatline::rules::Rules;

/// Drives the rules at the design's widths and writes the footprint table.
pub fn write_rules(bench: &mut Bench, widths: &Widths, rules: &Rules) {
    let constants = Blend::new(widths, rules).constants();
    let transmittance = constants.minimum_transmittance;
    bench.set(&[
        ("alpha_max", constants.alpha_max.into()),
        ("least", constants.opacity_min),
        ("minimum_transmittance", transmittance.into()),
        ("omit_finishing", constants.omit_finishing.into()),
        ("wide_table", (rules.table_range == 4).into()),
        ("table_valid", 1),
    ]);
    for (index, [low, step]) in (0..).zip(table(widths, rules)) {
        bench.set(&[
            ("table_index", index),
            ("table_low", low.into()),
            ("table_step", step.into()),
        ]);
        bench.cycle();
    }
    bench.set(&[("table_valid", 0)]);
}

/// The registers of an AXI shell and the words that tell it the rules at the design's widths, in the order of writing.
pub fn rule_writes(widths: &Widths, rules: &Rules) -> Vec<(&'static str, u32)> {
    let constants = Blend::new(widths, rules).constants();
    let flags = u32::from(constants.omit_finishing) | u32::from(rules.table_range == 4) << 1;
    let [least, least_high] = [0, 32].map(|shift| (constants.opacity_min >> shift) as u32);
    let mut writes = vec![
        ("alpha_max", constants.alpha_max),
        ("minimum_transmittance", constants.minimum_transmittance),
        ("least", least),
        ("least_high", least_high),
        ("flags", flags),
        ("table_index", 0),
    ];
    for [low, step] in table(widths, rules) {
        writes.extend([("table_low", low), ("table_step", step)]);
    }
    writes
}

/// The writes for rules of a name, as a C array of {address, value} pairs for `shell/splat_axi.h`.
pub fn register_writes(widths: &Widths, name: &str) -> Result<String> {
    let rules = match name {
        "ewa" => Rules::EWA,
        "3dgs" => Rules::GAUSSIAN_3D,
        _ => bail!("no rules '{name}': ewa or 3dgs"),
    };
    let writes = rule_writes(widths, &rules);
    let line = |(register, value): &(&str, u32)| {
        let register = register.to_uppercase();
        format!("  {{SPLAT_AXI_{register}, 0x{value:x}u}},\n")
    };
    let (count, lines) = (writes.len(), writes.iter().map(line).collect::<String>());
    Ok(format!(
        "static const uint32_t splat_axi_rules[{count}][2] = {{\n{lines}}};\n"
    ))
}
