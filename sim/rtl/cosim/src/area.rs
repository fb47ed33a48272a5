//! Area: what Yosys makes of the primitive for three families of FPGAs, and the clock that nextpnr reaches where the device holds it.

use crate::mutants::run;
use crate::suite::DESIGNS;
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
    pub const ALL: [Family; 3] = [Family::Xilinx7, Family::Ecp5, Family::Ice40];

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
            Family::Ice40 => "synth_ice40 -dsp -noflatten",
            Family::Ecp5 => "synth_ecp5 -noflatten",
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

/// Units that are the same whatever the number of lanes: synthesised once for each design and family.
const SHARED: [&str; 2] = ["splat_setup", "row_generator"];

/// Synthesises `unit` and what it contains, but for `boxes`, and counts.
fn synthesise(
    design: &str,
    family: Family,
    unit: &str,
    lanes: Option<usize>,
    boxes: &[&str],
) -> Result<Area> {
    let rtl = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let units = fs::read_to_string(rtl.join("files.txt"))?;
    let package = format!("{design}/splatline_pkg.sv");
    let files: Vec<&str> = iter::once(package.as_str()).chain(units.lines()).collect();
    let folder = tempfile::tempdir()?;
    let counts = folder.path().join("stat.json");
    let lanes = lanes.map_or(String::new(), |lanes| {
        format!("chparam -set LANES {lanes} {unit}; ")
    });
    let boxes: String = boxes
        .iter()
        .map(|name| format!("blackbox {name}; "))
        .collect();
    let script = format!(
        "read_verilog -sv {}; {boxes}{lanes}{} -top {unit}; flatten; opt_clean; tee -q -o {} stat -json",
        files.join(" "),
        family.synthesis(),
        counts.display()
    );
    run(Command::new("yosys")
        .args(["-q", "-p", &script])
        .current_dir(&rtl))?;
    let text = fs::read_to_string(&counts)?;
    let statistics: Value = serde_json::from_str(&text).context("yosys' statistics")?;
    let cells = statistics["design"]["num_cells_by_type"]
        .as_object()
        .context("yosys counts no cells")?;
    Ok(count(cells))
}

/// Where the table is kept.
pub const REPORT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/area.md");

const HEAD: &str = "# Area of the splat primitive

Printed by `cargo run --release -p splatline-rtl --example rtl -- area` (Yosys 0.23, hierarchy kept). LUT counts
contain those used as memory and shift registers; memory is in whole blocks. A tile of 32 x 32 pixels is held in the primitive.
\"One lane\" is a third of the difference between four lanes and one, and \"shared\" what is left of one lane's circuit without it:
the model of area is `shared + lanes * one lane`.

| design | family | part | LUT | FF | DSP | memory, kbit |
|---|---|---|---|---|---|---|
";

const FOOT: &str = "
Notes by hand:

- Fmax is not measured yet: no iCE40 holds the primitive, and placing it for an ECP5 (`timing_wrapper.sv`, nextpnr-ecp5) was not finished. The
  longest paths are likely those of setup (normalisation in one stage) and of the transmittance (read, product, comparison, write).
- The largest iCE40 has 7,680 LUT4 and 128 kbit (UltraPlus: 5,280 and 8 DSPs): the primitive does not fit any of them.
- Setup is two thirds of the shared part: it is built for one splat and one row a cycle, with eight shifters of 64 bits. One shifter
  and one multiplier used over ten cycles would be smaller, but slower than the seven rows that a splat of guitar has in a tile.
- Losing way: rounding shifts as `(value + half) >> shift` with a saturation check that shifts back. Four 64-bit shifters for one: the
  setup unit took 8,900 LUT6 in place of 5,100, the row unit 5,000 in place of 3,200 (lean18).
- Losing way: unsigned products. An 18-bit fraction whose 1.0 must be a value has 19 bits, 20 with a sign; with `offset_multiply` it
  has 18, and a lane's blend unit takes 10 DSP48E1 in place of 20.
";

/// The whole table.
pub fn report() -> Result<String> {
    let tables: Vec<String> = DESIGNS
        .iter()
        .map(|design| table(design))
        .collect::<Result<_>>()?;
    Ok(HEAD.to_owned() + &tables.concat() + FOOT)
}

/// One design's lines; shown on stderr as they come, since each takes a minute.
pub fn table(design: &str) -> Result<String> {
    let mut text = String::new();
    for family in Family::ALL {
        for (part, area) in parts(design, family)? {
            let line = line(design, family, part, &area);
            eprint!("{line}");
            text += &line;
        }
    }
    Ok(text)
}

/// The primitive with one and four lanes, a lane's own part and the shared rest, and of that the two largest units.
fn parts(design: &str, family: Family) -> Result<[(&'static str, Area); 6]> {
    let [setup, rows] = SHARED.map(|unit| synthesise(design, family, unit, None, &[]));
    let (setup, rows) = (setup?, rows?);
    let whole = |lanes| -> Result<Area> {
        let rest = synthesise(design, family, "splat_primitive", Some(lanes), &SHARED)?;
        Ok(rest.plus(&setup).plus(&rows))
    };
    let (one, four) = (whole(1)?, whole(4)?);
    let lane = four.minus(&one).third();
    Ok([
        ("1 lane in all", one),
        ("4 lanes in all", four),
        ("one lane", lane),
        ("shared", one.minus(&lane)),
        ("of it setup", setup),
        ("of it rows", rows),
    ])
}

fn line(design: &str, family: Family, part: &str, area: &Area) -> String {
    let Area {
        luts,
        flip_flops,
        dsps,
        memory_kbit,
    } = area;
    format!(
        "| {design} | {} | {part} | {luts} | {flip_flops} | {dsps} | {memory_kbit} |\n",
        family.name()
    )
}

impl Area {
    fn each(&self, other: &Area, by: impl Fn(u64, u64) -> u64) -> Area {
        Area {
            luts: by(self.luts, other.luts),
            flip_flops: by(self.flip_flops, other.flip_flops),
            dsps: by(self.dsps, other.dsps),
            memory_kbit: by(self.memory_kbit, other.memory_kbit),
        }
    }

    fn plus(&self, other: &Area) -> Area {
        self.each(other, u64::saturating_add)
    }

    fn minus(&self, other: &Area) -> Area {
        self.each(other, u64::saturating_sub)
    }

    fn third(&self) -> Area {
        self.each(self, |value, _| (value + 1) / 3)
    }
}
