//! Area: what Yosys makes of the primitive for three families of FPGAs, and the clock that nextpnr reaches where the device holds it.

use crate::mutants::run;
use anyhow::{Context, Result};
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use std::{fs, iter};

/// A family of devices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Lattice iCE40: LUT4, 16-bit DSP (UltraPlus), 4 kbit memories.
    Ice40,
    /// Lattice ECP5: LUT4, 18-bit DSP, 18 kbit memories.
    Ecp5,
    /// Xilinx 7 series: LUT6, 25x18 DSP, 36 kbit memories.
    Xilinx7,
}

impl Family {
    /// All of them.
    pub const ALL: [Family; 3] = [Family::Ice40, Family::Ecp5, Family::Xilinx7];

    /// Name in the tables.
    pub fn name(self) -> &'static str {
        match self {
            Family::Ice40 => "iCE40",
            Family::Ecp5 => "ECP5",
            Family::Xilinx7 => "Xilinx 7",
        }
    }

    fn synthesis(self) -> &'static str {
        match self {
            Family::Ice40 => "synth_ice40 -dsp",
            Family::Ecp5 => "synth_ecp5",
            Family::Xilinx7 => "synth_xilinx -family xc7 -noiopad -noclkbuf",
        }
    }
}

/// What a circuit takes, in the family's own units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Area {
    /// Look-up tables, those used as memory and shift registers included.
    pub luts: u64,
    /// Flip-flops.
    pub flip_flops: u64,
    /// Multiplier blocks.
    pub dsps: u64,
    /// Kilobits of block memory, in whole blocks.
    pub memory_kbit: u64,
}

/// Counts the cells of a netlist by kind.
fn count(cells: &serde_json::Map<String, Value>) -> Area {
    let mut area = Area::default();
    for (kind, number) in cells {
        let number = number.as_u64().unwrap_or(0);
        match kind.as_str() {
            "SB_LUT4" | "LUT4" | "TRELLIS_SLICE" => area.luts += number,
            // A CCU2C is a slice's two LUTs with their carry.
            "CCU2C" => area.luts += 2 * number,
            "TRELLIS_DPR16X4" => area.luts += 4 * number,
            "RAM32M" => area.luts += 4 * number,
            "SB_DFF" | "TRELLIS_FF" => area.flip_flops += number,
            "SB_MAC16" | "MULT18X18D" | "DSP48E1" => area.dsps += number,
            "SB_RAM40_4K" => area.memory_kbit += 4 * number,
            "DP16KD" | "RAMB18E1" => area.memory_kbit += 18 * number,
            "RAMB36E1" => area.memory_kbit += 36 * number,
            _ if kind.starts_with("LUT") || kind.starts_with("SRL") => area.luts += number,
            _ if kind.starts_with("SB_DFF") || kind.starts_with("FD") => area.flip_flops += number,
            _ => {}
        }
    }
    area
}

/// Synthesises one circuit (`unit` on its own, or the whole primitive) and counts.
pub fn synthesise(design: &str, lanes: usize, family: Family, unit: &str) -> Result<Area> {
    let rtl = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let units = fs::read_to_string(rtl.join("files.txt"))?;
    let package = format!("{design}/splatline_pkg.sv");
    let files: Vec<&str> = iter::once(package.as_str()).chain(units.lines()).collect();
    let folder = tempfile::tempdir()?;
    let counts = folder.path().join("stat.json");
    let lanes = if unit == "splat_primitive" { format!("chparam -set LANES {lanes} splat_primitive; ") } else { String::new() };
    let script = format!(
        "read_verilog -sv {}; {lanes}{} -top {unit}; flatten; opt_clean; tee -q -o {} stat -json",
        files.join(" "),
        family.synthesis(),
        counts.display()
    );
    run(Command::new("yosys").args(["-q", "-p", &script]).current_dir(&rtl))?;
    let text = fs::read_to_string(&counts)?;
    let statistics: Value = serde_json::from_str(&text).context("yosys' statistics")?;
    let cells = statistics["design"]["num_cells_by_type"].as_object().context("yosys counts no cells")?;
    Ok(count(cells))
}
