//! Area: what Yosys makes of the units for three families of FPGAs.
//!
//! `rtl -- area primitive` and `rtl -- area setup` print the tables that the model's estimate is calibrated on and held
//! against (`sim/machine/src/area/synthesised.csv` and `setup.csv`); `rtl -- area UNIT` counts the cells of another
//! unit.

use crate::adders;
use crate::circuit::{Circuit, PRIMITIVE, Parameter, RtlUnit, SETUP, set};
use crate::netlist::Netlist;
use crate::tools::{json, yosys};
use anyhow::{Context, Result, ensure};
use splatline_sim::machine::area::setup::{self, FITTED_CORES, SetupUnit};
use splatline_sim::machine::area::synthesis::{self, Subject, Synthesised, SynthesisedPart};
use splatline_sim::machine::area::{Fabric, Family};
use splatline_sim::machine::primitive::Intervals;
use std::path::Path;

/// Runs a script that leaves one module of cells, and counts them after look-up tables have moved into adders.
pub fn cells(script: &str, top: &str, folder: &Path) -> Result<(Netlist, Fabric)> {
    let file = folder.join("cells.json");
    let write = format!("rename -top {top}; write_json {}", file.display());
    yosys(&format!("{script}; {write}"))?;
    let mut netlist: Netlist = json(&file)?;
    let module = netlist.modules.get_mut(top);
    let module = module.with_context(|| format!("a netlist without {top}"))?;
    adders::move_in(module);
    let fabric = fabric(module.cells.values().map(|cell| cell.kind.as_str()));
    ensure!(fabric.luts > 0, "yosys leaves no look-up tables");
    Ok((netlist, fabric))
}

/// What cells of these kinds take.
pub fn fabric<'a>(kinds: impl IntoIterator<Item = &'a str>) -> Fabric {
    let mut area = Fabric::default();
    for kind in kinds {
        match kind {
            "SB_LUT4" | "LUT4" | "TRELLIS_SLICE" => area.luts += 1,
            // A CCU2C is a slice's two LUTs with their carry.
            "CCU2C" => area.luts += 2,
            "TRELLIS_DPR16X4" | "RAM32M" => area.luts += 4,
            "SB_DFF" | "TRELLIS_FF" => area.flip_flops += 1,
            "SB_MAC16" | "MULT18X18D" | "DSP48E1" => area.dsps += 1,
            "SB_RAM40_4K" => area.memory_kbit += 4,
            "DP16KD" | "RAMB18E1" => area.memory_kbit += 18,
            "RAMB36E1" => area.memory_kbit += 36,
            _ if kind.starts_with("LUT") || kind.starts_with("SRL") => area.luts += 1,
            _ if kind.starts_with("SB_DFF") || kind.starts_with("FD") => area.flip_flops += 1,
            _ => {}
        }
    }
    area
}

/// Yosys' command for a family. Units that are placed are flattened first, as they would be there; elsewhere hierarchy
/// is kept, so that equal lanes and cores are synthesised once. Yosys flattens for Lattice's devices unless it is told
/// not to, and for Xilinx' only if it is told to.
fn synthesis(family: Family, unit: &RtlUnit) -> &'static str {
    match family {
        Family::Ice40 => "synth_ice40 -dsp -noflatten",
        Family::Ecp5 if *unit == SETUP => "synth_ecp5 -abc9 -noflatten",
        Family::Ecp5 => "synth_ecp5 -abc9",
        Family::Xilinx7 => "synth_xilinx -family xc7 -noiopad -noclkbuf",
    }
}

/// Synthesises a module of a circuit with these parameters and what it contains, but for `boxes`, and counts.
fn synthesised(
    circuit: &Circuit,
    family: Family,
    module: &str,
    parameters: &[Parameter],
    boxes: &[&str],
) -> Result<Fabric> {
    let folder = tempfile::tempdir()?;
    let mut script = circuit.read_command(folder.path())?;
    for name in boxes {
        script += &format!("; blackbox {name}");
    }
    let (set, command) = (set(module, parameters), synthesis(family, circuit.unit));
    script += &format!("; {set}{command} -top {module}; flatten; opt_clean");
    let (_, found) = cells(&script, module, folder.path())?;
    eprintln!("{circuit}, {module} for {}: {found}", family.name());
    Ok(found)
}

/// A circuit as a whole on the ECP5.
pub fn of_circuit(circuit: &Circuit) -> Result<Fabric> {
    let unit = circuit.unit;
    synthesised(circuit, Family::Ecp5, unit.top, &circuit.parameters, &[])
}

/// Numbers of lanes that are synthesised.
const LANES: [u32; 3] = [1, 2, 4];

/// Units of the primitive that are the same whatever the number of lanes: synthesised once for each design and family.
const SHARED: [&str; 2] = ["splat_setup", "row_generator"];

/// The table of the primitives of all designs, or of one; shown on stderr as it comes, since it takes minutes.
pub fn of_primitives(design: Option<&str>) -> Result<String> {
    let subjects = synthesis::subjects();
    let chosen = |subject: &&Subject| design.is_none_or(|design| design == subject.name);
    let mut lines = Vec::new();
    for subject in subjects.iter().filter(chosen) {
        for family in Family::ALL {
            lines.extend(primitive(subject, family)?);
        }
    }
    ensure!(!lines.is_empty(), "no such design");
    Ok(synthesis::to_csv(&lines))
}

/// One design's circuits for a family. The primitive is the sum of setup, rows and what is left without both.
fn primitive(subject: &Subject, family: Family) -> Result<Vec<Synthesised>> {
    let circuit = Circuit::new(&PRIMITIVE, subject.name, 1)?;
    let [setup_unit, row_unit] = SHARED;
    let shared = |unit, interval| {
        let interval = [("INTERVAL", interval)];
        synthesised(&circuit, family, unit, &interval, &[])
    };
    let (usual, small) = (Intervals::USUAL, Intervals::SMALL);
    let mut found = Vec::new();
    for cycles in [1, usual.setup, small.setup] {
        found.push((SynthesisedPart::Setup(cycles), shared(setup_unit, cycles)?));
    }
    for cycles in [usual.rows, small.rows] {
        found.push((SynthesisedPart::Rows(cycles), shared(row_unit, cycles)?));
    }
    let (usual, small) = (found[1].1 + found[3].1, found[2].1 + found[4].1);
    // Words of the family's block RAM at its full width.
    let block_words = if family == Family::Ice40 { 256 } else { 512 };
    let rest = |lanes, added| {
        let parameters = [
            ("LANES", lanes),
            ("BLOCK_WORDS", block_words),
            ("ADDED_BITS", added),
        ];
        synthesised(&circuit, family, PRIMITIVE.top, &parameters, &SHARED)
    };
    for lanes in LANES {
        found.push((SynthesisedPart::Lanes(lanes), rest(lanes, 4)? + usual));
    }
    found.push((SynthesisedPart::Small, rest(1, 0)? + small));
    let line = |(part, fabric)| Synthesised {
        design: subject.name.to_owned(),
        widths: subject.widths,
        family,
        part,
        fabric,
    };
    Ok(found.into_iter().map(line).collect())
}

/// Designs and cores of further setup units: a shorter mantissa, by which the estimate knows what a bit takes, and what
/// it is held against.
const FURTHER: [(usize, u32); 4] = [(0, 2), (2, 1), (2, 4), (3, 1)];

/// The table of the setup units of all designs, or of one: half an hour.
pub fn of_setup_units(design: Option<&str>) -> Result<String> {
    let subjects = synthesis::subjects();
    let fitted = (0..2).flat_map(|place| FITTED_CORES.map(|cores| (place, cores)));
    let mut units: Vec<(usize, u32)> = fitted.chain(FURTHER).collect();
    units.retain(|(place, _)| design.is_none_or(|design| design == subjects[*place].name));
    units.sort();
    let mut lines = Vec::new();
    for family in [Family::Ecp5, Family::Xilinx7] {
        for (place, cores) in &units {
            let Subject { name, widths } = &subjects[*place];
            let circuit = Circuit::new(&SETUP, name, *cores)?;
            lines.push(SetupUnit {
                design: (*name).to_owned(),
                position: widths.position,
                mantissa: widths.mantissa,
                round: circuit.program.assembled(widths)?.round as u32,
                family,
                cores: *cores,
                fabric: synthesised(&circuit, family, SETUP.top, &circuit.parameters, &[])?,
            });
        }
    }
    Ok(setup::to_csv(&lines))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_counted_by_kind() {
        let cells = [
            ("LUT4", 3),
            ("CCU2C", 2),
            ("TRELLIS_FF", 5),
            ("DP16KD", 2),
            ("GSR", 1),
        ];
        let found = fabric(
            cells
                .into_iter()
                .flat_map(|(kind, count)| vec![kind; count]),
        );
        let expected = Fabric {
            luts: 7,
            flip_flops: 5,
            dsps: 0,
            memory_kbit: 36,
        };
        assert_eq!(found, expected);
    }
}
