//! Area of the harmonics unit by Yosys.

use super::circuit::MULTIPLIERS;
use crate::area::{rtl, synthesis, synthesised_cells};
use anyhow::Result;
use splatline_sim::machine::area::{Fabric, Family};
use std::fs;

/// Prints a line of counts for each number of multipliers, for the family for which the setup unit is synthesised too.
pub fn print() -> Result<()> {
    println!("| family | MULTIPLIERS | LUT4 | FF | DSP | memory, kbit |");
    println!("|---|---:|---:|---:|---:|---:|");
    for multipliers in MULTIPLIERS {
        let Fabric {
            luts,
            flip_flops,
            dsps,
            memory_kbit,
        } = unit(multipliers)?;
        let family = Family::Ecp5.name();
        println!("| {family} | {multipliers} | {luts} | {flip_flops} | {dsps} | {memory_kbit} |");
    }
    Ok(())
}

fn unit(multipliers: u32) -> Result<Fabric> {
    let folder = tempfile::tempdir()?;
    let units = fs::read_to_string(rtl().join("harmonics_files.txt"))?;
    let units: Vec<&str> = units.lines().collect();
    let script = format!(
        "read_verilog -sv {}; chparam -set MULTIPLIERS {multipliers} harmonics_unit; {} -top harmonics_unit",
        units.join(" "),
        synthesis(Family::Ecp5)
    );
    synthesised_cells(&script, folder.path())
}
