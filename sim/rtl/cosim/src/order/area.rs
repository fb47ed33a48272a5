//! Area of sorter and binning by Yosys.

use crate::area::{synthesis, synthesised_cells};
use anyhow::Result;
use splatline_sim::machine::area::{Fabric, Family};
use std::fs;

/// Prints a line of counts for each family and digit.
pub fn print() -> Result<()> {
    println!("| family | digit | LUT | FF | DSP | memory, kbit |");
    println!("|---|---:|---:|---:|---:|---:|");
    for family in [Family::Ecp5, Family::Xilinx7] {
        for digit in [8, 12] {
            let Fabric {
                luts,
                flip_flops,
                dsps,
                memory_kbit,
            } = unit(family, digit)?;
            println!(
                "| {} | {digit} | {luts} | {flip_flops} | {dsps} | {memory_kbit} |",
                family.name()
            );
        }
    }
    Ok(())
}

fn unit(family: Family, digit: u32) -> Result<Fabric> {
    let folder = tempfile::tempdir()?;
    let units = fs::read_to_string(crate::area::rtl().join("order_files.txt"))?;
    let units: Vec<&str> = units.lines().collect();
    let script = format!(
        "read_verilog -sv {}; chparam -set DIGIT {digit} splat_order; {} -top splat_order",
        units.join(" "),
        synthesis(family)
    );
    synthesised_cells(&script, folder.path())
}
