//! Area of the whole machine and of each unit in it: `rtl -- area machine`.

use super::unit::with_harmonics;
use crate::area::fabric;
use crate::circuit::Circuit;
use crate::placement::{self, machine};
use anyhow::{Context, Result};
use splatline_sim::machine::area::Fabric;
use std::collections::BTreeMap;

/// Cores of setup: a splat in 8 and in 16 cycles.
pub const CORES: [u32; 2] = [17, 9];

/// Instances in `splat_machine.sv`, and what they are called in the table; the last is an option. Without an instance
/// what stands in the machine itself: its states, its port, the words of records and packets.
const UNITS: [(&str, &str); 12] = [
    ("setup", "setup"),
    ("order", "order"),
    ("raster", "primitive"),
    ("fetch", "fetch"),
    ("stream", "stream"),
    ("reads", "arbiter"),
    ("drawn_pixels", "pixels"),
    ("writing", "port"),
    ("drawn", "finder"),
    ("background", "background"),
    ("", CONTROL),
    ("harmonics", "harmonics"),
];

const CONTROL: &str = "control";

/// The table, in lines of `sim/machine/src/area/machine.csv`, or that of a machine for harmonics: a splat in 16 cycles,
/// and a multiplier for them. Each machine is shown on stderr as it comes.
pub fn report(evaluates: bool) -> Result<String> {
    let mut text = "cores,unit,luts,flip_flops,dsps,memory_kbit\n".to_owned();
    let cores: &[u32] = if evaluates { &[10] } else { &CORES };
    for cores in cores {
        let mut circuit = machine(*cores)?;
        if evaluates {
            circuit = with_harmonics(circuit, 1);
        }
        for (unit, fabric) in by_unit(&circuit)? {
            text += &format!("{cores},{unit},{}\n", fabric.cells());
        }
    }
    Ok(text)
}

/// Units of the machine by name, and the whole of it: of the netlist that is placed.
fn by_unit(circuit: &Circuit) -> Result<Vec<(&'static str, Fabric)>> {
    let folder = tempfile::tempdir()?;
    let (netlist, _) = placement::netlist(circuit, folder.path())?;
    let wrapper = netlist.modules.get(placement::WRAPPER);
    let wrapper = wrapper.context("a netlist without its wrapper")?;
    let mut areas: BTreeMap<&str, Fabric> = BTreeMap::new();
    // The wrapper's own cells stand in no unit.
    for (name, cell) in &wrapper.cells {
        if let Some(unit) = unit_of(name) {
            let area = areas.entry(unit).or_default();
            *area = *area + fabric([cell.kind.as_str()]);
        }
    }
    let whole = areas
        .values()
        .fold(Fabric::default(), |sum, area| sum + *area);
    eprintln!("{circuit}: {whole}");
    let area = |(_, name)| Some((name, areas.remove(name)?));
    let units = UNITS.into_iter().filter_map(area);
    Ok(units.chain([("whole", whole)]).collect())
}

/// The unit in which a cell of the machine stands. Its name begins with the unit's, behind `$flatten` if Yosys named
/// it.
fn unit_of(cell: &str) -> Option<&'static str> {
    let name = cell.trim_start_matches("$flatten").trim_start_matches('\\');
    let name = name.strip_prefix("placed.")?.trim_start_matches('\\');
    let name = name.strip_prefix("gen_harmonics.").unwrap_or(name);
    let instance = name.split_once('.').map(|(instance, _)| instance);
    let unit = UNITS.iter().find(|(unit, _)| Some(*unit) == instance);
    Some(unit.map_or(CONTROL, |(_, name)| name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::rtl;
    use std::fs;

    #[test]
    fn cells_are_counted_for_the_unit_in_which_they_stand() {
        for (cell, unit) in [
            ("placed.raster.rows.root_TRELLIS_FF_Q", Some("primitive")),
            ("$flatten\\placed.\\setup.\\pack.$abc$1$lut", Some("setup")),
            (
                "$flatten\\placed.\\gen_harmonics.harmonics.$abc$1$lut",
                Some("harmonics"),
            ),
            ("placed.drawn.tile_TRELLIS_FF_Q_1", Some("finder")),
            ("placed.number_TRELLIS_FF_Q", Some(CONTROL)),
            ("$flatten\\placed.$abc$1$lut", Some(CONTROL)),
            ("inputs_TRELLIS_FF_Q", None),
        ] {
            assert_eq!(unit_of(cell), unit, "{cell}");
        }
    }

    #[test]
    fn every_unit_of_the_machine_has_a_line() {
        let text = fs::read_to_string(rtl().join("splat_machine.sv")).unwrap();
        // `memory_stream stream (`, and `) setup (` behind parameters.
        let words = text.lines().map(|line| line.split_whitespace().collect());
        let mut instances: Vec<&str> = words
            .filter_map(|words: Vec<&str>| match words[..] {
                ["module", ..] => None,
                [_, instance, "("] if instance != "#" => Some(instance),
                _ => None,
            })
            .filter(|instance| text.contains(&format!(" {instance} (\n      .clk,")))
            .collect();
        instances.sort_unstable();
        let mut units: Vec<&str> = UNITS[..10].iter().map(|(instance, _)| *instance).collect();
        units.sort_unstable();
        assert_eq!(instances, units);
    }
    #[test]
    fn the_committed_table_is_of_all_units() {
        let table = include_str!("../../../../machine/src/area/machine.csv");
        let names = UNITS[..11].iter().map(|(_, name)| *name);
        let names: Vec<&str> = names.chain(["whole"]).collect();
        let lines: Vec<&str> = table.lines().skip(1).collect();
        assert_eq!(lines.len(), CORES.len() * names.len());
        for machine in lines.chunks(names.len()) {
            let units: Vec<&str> = machine
                .iter()
                .filter_map(|line| line.split(',').nth(1))
                .collect();
            assert_eq!(units, names);
            for column in 2..6 {
                let count = |line: &&str| line.split(',').nth(column).unwrap().parse().unwrap();
                let counts: Vec<u64> = machine.iter().map(count).collect();
                let (whole, units) = counts.split_last().unwrap();
                assert_eq!(units.iter().sum::<u64>(), *whole);
            }
        }
    }
}
