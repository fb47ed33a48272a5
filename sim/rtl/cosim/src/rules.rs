//! What primitive and machine are told of the rules of blending, by the kernel's own constants.

use crate::bench::Bench;
use crate::package::table;
use anyhow::{Result, bail};
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

/// The writes that tell the AXI shell the rules of a name at the design's widths, as a C array of {address, value} pairs for `shell/splat_axi.h`.
pub fn register_writes(widths: &Widths, name: &str) -> Result<String> {
    let rules = match name {
        "ewa" => Rules::EWA,
        "3dgs" => Rules::GAUSSIAN_3D,
        _ => bail!("no rules '{name}': ewa or 3dgs"),
    };
    let constants = Blend::new(widths, &rules).constants();
    let flags = u32::from(constants.omit_finishing) | u32::from(rules.table_range == 4) << 1;
    let [least, least_high] = [0, 32].map(|shift| (constants.opacity_min >> shift) as u32);
    let mut writes = vec![
        ("ALPHA_MAX", constants.alpha_max),
        ("MINIMUM_TRANSMITTANCE", constants.minimum_transmittance),
        ("LEAST", least),
        ("LEAST_HIGH", least_high),
        ("FLAGS", flags),
        ("TABLE_INDEX", 0),
    ];
    for entry in table(widths, &rules) {
        writes.push(("TABLE_LOW", entry.low));
        writes.push(("TABLE_STEP", entry.step));
    }
    let lines = writes.iter();
    let lines =
        lines.map(|(register, value)| format!("  {{SPLAT_AXI_{register}, 0x{value:x}u}},\n"));
    Ok(format!(
        "static const uint32_t splat_axi_rules[{}][2] = {{\n{}}};\n",
        writes.len(),
        lines.collect::<String>()
    ))
}
