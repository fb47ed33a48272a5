//! Area of sorter and binning by Yosys.

use crate::area::{synthesis, synthesised_cells};
use anyhow::Result;
use splatline_sim::machine::area::{Fabric, Family};
use std::fs;

/// Prints a line of counts for each width of a digit, for the family for which the setup unit is synthesised too.
pub fn print() -> Result<()> {
    println!("| family | digit | LUT | FF | DSP | memory, kbit |");
    println!("|---|---:|---:|---:|---:|---:|");
    for digit in [8, 12] {
        let Fabric {
            luts,
            flip_flops,
            dsps,
            memory_kbit,
        } = unit(digit)?;
        let family = Family::Ecp5.name();
        println!("| {family} | {digit} | {luts} | {flip_flops} | {dsps} | {memory_kbit} |");
    }
    Ok(())
}

fn unit(digit: u32) -> Result<Fabric> {
    let folder = tempfile::tempdir()?;
    let units = fs::read_to_string(crate::area::rtl().join("order_files.txt"))?;
    let units: Vec<&str> = units.lines().collect();
    let script = format!(
        "read_verilog -sv {}; chparam -set DIGIT {digit} splat_order; {} -top splat_order",
        units.join(" "),
        synthesis(Family::Ecp5)
    );
    synthesised_cells(&script, folder.path())
}
