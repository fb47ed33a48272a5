//! Area: what Yosys makes of the primitive for three families of FPGAs, beside what the model estimates.

use crate::mutants::run;
use crate::package::{self, TILE_BITS};
use anyhow::{Context, Result};
use serde_json::Value;
use splatline::format::{Lean18, Standard24, Widths};
use splatline_sim::machine::synthesis::{Fabric, Family, estimate};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Yosys' command for a family.
fn synthesis(family: Family) -> &'static str {
    match family {
        Family::Ice40 => "synth_ice40 -dsp -noflatten",
        Family::Ecp5 => "synth_ecp5 -noflatten",
        Family::Xilinx7 => "synth_xilinx -family xc7 -noiopad -noclkbuf",
    }
}

/// Counts the cells of a netlist by kind.
fn count(cells: &serde_json::Map<String, Value>) -> Fabric {
    let mut area = Fabric::default();
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

/// A design that is synthesised: its name and widths.
struct Subject {
    name: &'static str,
    widths: Widths,
    /// Were the estimate's coefficients taken from it?
    fitted: bool,
}

/// The designs, and one between them that the estimate has not seen.
fn subjects() -> [Subject; 3] {
    let between = Widths {
        mantissa: 24,
        subpixel: 20,
        table: 10,
        interpolation: 14,
        weight: 24,
        alpha: 24,
        colour: 18,
        accumulator: 24,
        ..Standard24::WIDTHS
    };
    let subject = |name, widths, fitted| Subject {
        name,
        widths,
        fitted,
    };
    [
        subject("lean18", Lean18::WIDTHS, true),
        subject("standard24", Standard24::WIDTHS, true),
        subject("24-bit mantissa", between, false),
    ]
}

/// Synthesises `unit` and what it contains, but for `boxes`, and counts.
fn synthesise(
    subject: &Subject,
    family: Family,
    unit: &str,
    lanes: Option<u32>,
    boxes: &[&str],
) -> Result<Fabric> {
    let rtl = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let units = fs::read_to_string(rtl.join("files.txt"))?;
    let folder = tempfile::tempdir()?;
    let package = folder.path().join("splatline_pkg.sv");
    fs::write(&package, package::text(subject.name, &subject.widths))?;
    let counts = folder.path().join("stat.json");
    let lanes = lanes.map_or(String::new(), |lanes| {
        format!("chparam -set LANES {lanes} {unit}; ")
    });
    let boxes: String = boxes
        .iter()
        .map(|name| format!("blackbox {name}; "))
        .collect();
    let script = format!(
        "read_verilog -sv {} {}; {boxes}{lanes}{} -top {unit}; flatten; opt_clean; tee -q -o {} stat -json",
        package.display(),
        units.lines().collect::<Vec<_>>().join(" "),
        synthesis(family),
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

/// Pixels of the tile buffer.
pub const TILE_PIXELS: u64 = 1 << (TILE_BITS[0] + TILE_BITS[1]);

/// Where the table is kept.
pub const REPORT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/area.md");

const HEAD: &str = "# Area of the splat primitive

Printed by `cargo run --release -p splatline-rtl --example rtl -- area` (Yosys 0.23, hierarchy kept). LUT counts
contain those used as memory and shift registers; memory is in whole blocks. A tile of 32 x 32 pixels is held in the primitive.
Each cell: synthesis, the model's estimate (`sim/src/machine/synthesis.rs`), and its error. Lines with a point (.) were not fitted.

| design | family | part | LUT | FF | DSP | memory, kbit |
|---|---|---|---|---|---|---|
";

const FOOT: &str = include_str!("../area-notes.md");

/// Numbers of lanes that are synthesised, and whether the estimate was fitted on them.
const LANES: [(u32, bool); 3] = [(1, true), (2, false), (4, true)];

/// The whole table.
pub fn report() -> Result<String> {
    let tables: Vec<String> = subjects().iter().map(table).collect::<Result<_>>()?;
    Ok(HEAD.to_owned() + &tables.concat() + FOOT)
}

/// The lines of the design of that name.
pub fn design(name: &str) -> Result<String> {
    let subjects = subjects();
    let subject = subjects.iter().find(|subject| subject.name == name);
    table(subject.context("lean18, standard24 or '24-bit mantissa'")?)
}

/// One design's lines; shown on stderr as they come, since each takes a minute.
fn table(subject: &Subject) -> Result<String> {
    let mut text = String::new();
    for family in Family::ALL {
        let [setup, rows] = SHARED.map(|unit| synthesise(subject, family, unit, None, &[]));
        let (setup, rows) = (setup?, rows?);
        let mut lines = Vec::new();
        for (lanes, fitted) in LANES {
            let rest = synthesise(subject, family, "splat_primitive", Some(lanes), &SHARED)?;
            let all = plus(&plus(&rest, &setup), &rows);
            let estimate = estimate(&subject.widths, lanes, TILE_PIXELS, family);
            let point = if fitted && subject.fitted { "" } else { " ." };
            let part = format!("{lanes} lanes{point}");
            lines.push(line(subject.name, family, &part, &all, Some(&estimate)));
        }
        lines.push(line(subject.name, family, "of it setup", &setup, None));
        lines.push(line(subject.name, family, "of it rows", &rows, None));
        eprint!("{}", lines.concat());
        text += &lines.concat();
    }
    Ok(text)
}

fn line(
    design: &str,
    family: Family,
    part: &str,
    area: &Fabric,
    estimate: Option<&Fabric>,
) -> String {
    let cell = |of: fn(&Fabric) -> u64| match estimate.map(of) {
        Some(estimated) => {
            let error = 100.0 * (estimated as f64 / of(area) as f64 - 1.0);
            format!("{} / {estimated} / {error:+.1} %", of(area))
        }
        None => of(area).to_string(),
    };
    format!(
        "| {design} | {} | {part} | {} | {} | {} | {} |\n",
        family.name(),
        cell(|area| area.luts),
        cell(|area| area.flip_flops),
        cell(|area| area.dsps),
        cell(|area| area.memory_kbit),
    )
}

fn plus(a: &Fabric, b: &Fabric) -> Fabric {
    Fabric {
        luts: a.luts + b.luts,
        flip_flops: a.flip_flops + b.flip_flops,
        dsps: a.dsps + b.dsps,
        memory_kbit: a.memory_kbit + b.memory_kbit,
    }
}
