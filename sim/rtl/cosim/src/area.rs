//! Area: what Yosys makes of the primitive for three families of FPGAs, beside what the model estimates.
//!
//! The counts go into `sim/machine/src/area/synthesised.csv`, which calibrates the estimate, and with it onto the page. `page` writes the
//! page again without synthesis, for a changed estimate, and the model's clocks from what was placed.

use crate::mutants::run;
use crate::package;
use crate::placed::{self, CLOCKS, PLACED};
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use splatline::format::Widths;
use splatline_sim::atomic;
use splatline_sim::machine::area::synthesis::{
    Subject, Synthesised, SynthesisedPart, subjects, to_csv,
};
use splatline_sim::machine::area::{Calibration, Fabric, Family};
use splatline_sim::machine::primitive::SETUP_INTERVAL;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Yosys' command for a family.
pub fn synthesis(family: Family) -> &'static str {
    match family {
        Family::Ice40 => "synth_ice40 -dsp",
        Family::Ecp5 => "synth_ecp5",
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

/// Folder of the RTL.
pub fn rtl() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Writes a design's package into a folder; gives Yosys' words for reading it with all units.
pub fn sources(folder: &Path, name: &str, widths: &Widths) -> Result<String> {
    let package = folder.join("splatline_pkg.sv");
    fs::write(&package, package::text(name, widths)?)?;
    Ok(format!(
        "read_verilog -sv {} {}",
        package.display(),
        listed("files.txt")?
    ))
}

/// The units of a list in `sim/rtl` between spaces.
pub fn listed(list: &str) -> Result<String> {
    let units = fs::read_to_string(rtl().join(list))?;
    Ok(units.lines().collect::<Vec<_>>().join(" "))
}

/// Runs Yosys in the folder of the RTL.
pub fn yosys(script: &str) -> Result<()> {
    run(Command::new("yosys")
        .args(["-q", "-p", script])
        .current_dir(rtl()))
    .map(|_| ())
}

/// The same for a script that leaves one module of cells, which are counted.
pub fn synthesised_cells(script: &str, folder: &Path) -> Result<Fabric> {
    let counts = folder.join("stat.json");
    yosys(&format!(
        "{script}; tee -q -o {} stat -json",
        counts.display()
    ))?;
    let text = fs::read_to_string(&counts)?;
    let statistics: Value = serde_json::from_str(&text).context("yosys' statistics")?;
    let cells = statistics["design"]["num_cells_by_type"]
        .as_object()
        .context("yosys counts no cells")?;
    Ok(count(cells))
}

/// Prints what the units of a list take on the ECP5, a line for each value of a parameter of the unit at their top.
pub fn print_values(list: &str, top: &str, parameter: &str, values: &[u32]) -> Result<()> {
    println!("| family | {parameter} | LUT | FF | DSP | memory, kbit |");
    println!("|---|---:|---:|---:|---:|---:|");
    let folder = tempfile::tempdir()?;
    for value in values {
        let script = format!(
            "read_verilog -sv {}; chparam -set {parameter} {value} {top}; {} -top {top}",
            listed(list)?,
            synthesis(Family::Ecp5)
        );
        let fabric = synthesised_cells(&script, folder.path())?;
        let counts = fabric.resources().map(|(_, count)| count.to_string());
        let family = Family::Ecp5.name();
        println!("| {family} | {value} | {} |", counts.join(" | "));
    }
    Ok(())
}

/// Units that are the same whatever the number of lanes: synthesised once for each design and family.
const SHARED: [&str; 2] = ["splat_setup", "row_generator"];

/// Synthesises `unit` with these parameters and what it contains, but for `boxes`, and counts. Where a circuit is placed it is flattened first, as it would be
/// there; elsewhere hierarchy is kept, so that equal lanes are synthesised once.
fn synthesise(
    subject: &Subject,
    family: Family,
    unit: &str,
    parameters: &[(&str, u32)],
    boxes: &[&str],
) -> Result<Fabric> {
    let folder = tempfile::tempdir()?;
    let read = sources(folder.path(), subject.name, &subject.widths)?;
    let parameters: String = parameters
        .iter()
        .map(|(name, value)| format!("chparam -set {name} {value} {unit}; "))
        .collect();
    let boxes: String = boxes
        .iter()
        .map(|name| format!("blackbox {name}; "))
        .collect();
    let options = match family {
        Family::Xilinx7 => "",
        Family::Ecp5 => " -abc9",
        Family::Ice40 => " -noflatten",
    };
    let script = format!(
        "{read}; {boxes}{parameters}{}{options} -top {unit}; flatten; opt_clean",
        synthesis(family),
    );
    synthesised_cells(&script, folder.path())
}

/// Where the page is kept.
pub const REPORT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/area.md");

/// Where the counts are kept.
const COUNTS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../machine/src/area/synthesised.csv"
);

const HEAD: &str = "# Area of the splat primitive

Printed by `cargo run --release -p splatline-rtl --example rtl -- area` (Yosys 0.23), which writes the counts into `sim/machine/src/area/synthesised.csv` too: they calibrate the estimate. For the
ECP5 each unit is flattened and synthesised as it would be placed (`-abc9`); for iCE40 hierarchy is kept. The primitive is the sum of setup, rows and what is left without both. LUT counts contain those
used as memory and shift registers; memory is in whole blocks. The primitive holds two tiles of 32 x 32 pixels and sets a packet up in four cycles.
Each cell: synthesis, the model's estimate (`sim/machine/src/area`), and its error. Lines with a point (.) were not fitted.

| design | family | part | LUT | FF | DSP | memory, kbit |
|---|---|---|---|---|---|---|
";

const NOTES: &str = include_str!("../area-notes.md");

/// Numbers of lanes that are synthesised.
const LANES: [u32; 3] = [1, 2, 4];

/// Synthesises everything; writes counts and page.
pub fn report() -> Result<()> {
    let lines: Vec<Vec<Synthesised>> = subjects().iter().map(circuits).collect::<Result<_>>()?;
    let lines = lines.concat();
    atomic::write(COUNTS.as_ref(), to_csv(&lines).as_bytes())?;
    write_page(&lines)
}

/// The page again, from the counts of the last synthesis.
pub fn page() -> Result<()> {
    write_page(&counts()?)
}

/// The counts of the last synthesis.
pub fn counts() -> Result<Vec<Synthesised>> {
    let text = fs::read_to_string(COUNTS)?;
    splatline_sim::machine::area::synthesis::parse(&text).context("not a table of counts")
}

fn write_page(lines: &[Synthesised]) -> Result<()> {
    let table: String = lines
        .iter()
        .map(|found| line(found, &Calibration::fitted(found.family, lines)))
        .collect();
    let fmax = crate::fmax::table()?;
    let clocks = placed::clocks(&placed::read(PLACED.as_ref())?);
    atomic::write(CLOCKS.as_ref(), clocks.as_bytes())?;
    let text = [HEAD, &table, "\n", &fmax, NOTES].concat();
    Ok(atomic::write(REPORT.as_ref(), text.as_bytes())?)
}

/// Synthesises the design of that name alone; its counts take the place of those of before, and the page is written again.
pub fn design(name: &str) -> Result<()> {
    let subjects = subjects();
    let place = |design: &str| subjects.iter().position(|subject| subject.name == design);
    let known = subjects.each_ref().map(|subject| subject.name).join(", ");
    let asked = place(name).with_context(|| format!("no design {name}: one of {known}"))?;
    let mut lines = counts()?;
    lines.retain(|line| line.design != name);
    lines.extend(circuits(&subjects[asked])?);
    lines.sort_by_key(|line| place(&line.design));
    atomic::write(COUNTS.as_ref(), to_csv(&lines).as_bytes())?;
    write_page(&lines)
}

/// One design's circuits; shown on stderr as they come, against the calibration of the last synthesis, since they take minutes.
fn circuits(subject: &Subject) -> Result<Vec<Synthesised>> {
    let mut found = Vec::new();
    for family in Family::ALL {
        let mut keep = |part, fabric| {
            let circuit = Synthesised {
                design: subject.name.to_owned(),
                widths: subject.widths,
                family,
                part,
                fabric,
            };
            eprint!("{}", line(&circuit, &family.calibration()));
            found.push(circuit);
        };
        let [setup_unit, row_unit] = SHARED;
        let setup =
            |interval| synthesise(subject, family, setup_unit, &[("INTERVAL", interval)], &[]);
        keep(SynthesisedPart::Setup(1), setup(1)?);
        let setup = setup(SETUP_INTERVAL)?;
        keep(SynthesisedPart::Setup(SETUP_INTERVAL), setup);
        let rows = synthesise(subject, family, row_unit, &[], &[])?;
        keep(SynthesisedPart::Rows, rows);
        for lanes in LANES {
            let of_lanes = [("LANES", lanes)];
            let rest = synthesise(subject, family, "splat_primitive", &of_lanes, &SHARED)?;
            ensure!(rest.luts > 0, "yosys counts no look-up tables");
            keep(SynthesisedPart::Lanes(lanes), rest + setup + rows);
        }
    }
    Ok(found)
}

fn line(found: &Synthesised, calibration: &Calibration) -> String {
    let seen = if found.fitted() { "" } else { " ." };
    let part = match found.part {
        SynthesisedPart::Setup(SETUP_INTERVAL) => "of it setup".to_owned(),
        SynthesisedPart::Setup(_) => "setup of a packet in every cycle, alone".to_owned(),
        SynthesisedPart::Rows => "of it rows".to_owned(),
        SynthesisedPart::Lanes(1) => format!("1 lane{seen}"),
        SynthesisedPart::Lanes(lanes) => format!("{lanes} lanes{seen}"),
    };
    let estimate = found.estimate(calibration);
    let cells = (0..4).map(|i| {
        let count = found.fabric.resources()[i].1;
        match estimate.map(|estimate| estimate.resources()[i].1) {
            Some(estimated) => {
                let error = 100.0 * (estimated as f64 / count as f64 - 1.0);
                format!("{count} / {estimated} / {error:+.1} %")
            }
            None => count.to_string(),
        }
    });
    format!(
        "| {} | {} | {part} | {} |\n",
        found.design,
        found.family.name(),
        cells.collect::<Vec<_>>().join(" | ")
    )
}
