//! Area of the setup unit: Yosys' counts, the lines through them, and which device holds it beside four lanes.

use super::counts::{FITTED_CORES, LEAST_INTERVAL, SetupUnit, cores, estimate, parse, to_csv};
use super::program::program;
use super::text::text;
use crate::area::{listed, synthesis, synthesised_cells};
use crate::package;
use anyhow::{Context, Result};
use splatline::format::Widths;
use splatline_sim::atomic;
use splatline_sim::machine::area::synthesis::{Subject, SynthesisedPart, subjects, synthesised};
use splatline_sim::machine::area::{Fabric, Family};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Where the page is kept.
pub const REPORT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/setup-unit.md");

/// What `rtl -- setup` printed last, which it writes and the page repeats.
pub const COMPARED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/setup-cosim.md");
/// The same of `rtl -- setup exact`.
pub const COMPARED_FEW: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/setup-exact.md");
/// The same of `rtl -- setup distance`.
pub const COMPARED_DISTANT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/setup-distance.md");
/// The same of `rtl -- setup distance mutants`.
pub const JUDGED_PROGRAMS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/setup-distance-mutants.md");
/// The same of `rtl -- setup mutants`.
pub const JUDGED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/setup-mutants.md");

/// Where the counts are kept.
const COUNTS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../machine/src/area/setup.csv"
);

const HEAD: &str = include_str!("../../setup-head.md");
const NOTES: &str = include_str!("../../setup-notes.md");

const COMPARED_HEAD: &str = "
What `rtl -- setup` prints; loads in parts of 10,000 splats, of which the first is drawn without pauses and those behind it with pauses at both ends (every tenth without):

";
const FEW_HEAD: &str = "
What `rtl -- setup exact` prints, splats of few bits that show what those above do not:

";
const DISTANT_HEAD: &str = "
What `rtl -- setup distance` prints, the unit with distance scaling under rules with a spacing; loads on both sides of the distance k and exactly there:

";
const JUDGED_PROGRAMS_HEAD: &str = "
What `rtl -- setup distance mutants` prints: programs with one mistake in distance scaling, lean18 with one core:

";
const JUDGED_HEAD: &str = include_str!("../../setup-mutants-head.md");

/// Devices by name: family, look-up tables, multipliers, kilobits of block memory, from their data sheets (FPGA-DS-02012, DS180).
const DEVICES: [(&str, Family, [u64; 3]); 2] = [
    ("LFE5U-85F", Family::Ecp5, [83_640, 156, 3_744]),
    ("XC7A100T", Family::Xilinx7, [63_400, 240, 4_860]),
];

/// The families that are synthesised.
const FAMILIES: [Family; 2] = [Family::Ecp5, Family::Xilinx7];

/// Intervals on the page.
const INTERVALS: [u32; 6] = [8, 10, 16, 20, 32, 64];

/// Units that no line goes through: place of the design, and cores.
const UNSEEN: [(usize, u32); 3] = [(0, 2), (2, 1), (3, 1)];

/// Synthesises all of them, and writes counts and page.
pub fn report() -> Result<()> {
    let fitted = (0..2).flat_map(|place| FITTED_CORES.map(|cores| (place, cores)));
    let circuits: Vec<_> = fitted.chain(UNSEEN).collect();
    let mut units = Vec::new();
    for family in FAMILIES {
        for (place, cores) in &circuits {
            units.push(synthesised_unit(&subjects()[*place], *cores, family)?);
        }
    }
    write_counts(units)
}

/// Synthesises one unit alone; its counts take the place of those of before, and the page is written again.
pub fn one(design: &str, cores: u32, family: &str) -> Result<()> {
    let subjects = subjects();
    let subject = subjects.iter().find(|subject| subject.name == design);
    let family = FAMILIES.into_iter().find(|each| each.name() == family);
    let family = family.context("the family is ECP5 or 'Xilinx 7'")?;
    let unit = synthesised_unit(subject.context("no such design")?, cores, family)?;
    let mut units = counts()?;
    units.retain(|kept| (kept.design.as_str(), kept.cores, kept.family) != (design, cores, family));
    units.push(unit);
    write_counts(units)
}

/// Counts in the order of families, designs and cores, and the page of them.
fn write_counts(mut units: Vec<SetupUnit>) -> Result<()> {
    let subjects = subjects();
    let place = |unit: &SetupUnit| {
        let design = subjects
            .iter()
            .position(|subject| subject.name == unit.design);
        let family = FAMILIES.iter().position(|family| *family == unit.family);
        (family, design, unit.cores)
    };
    units.sort_by_key(place);
    atomic::write(COUNTS.as_ref(), to_csv(&units).as_bytes())?;
    write_page(&units)
}

/// The page again, from the counts of the last synthesis.
pub fn page() -> Result<()> {
    Ok(atomic::write(REPORT.as_ref(), page_text()?.as_bytes())?)
}

/// Writes a design's packages into a folder; gives Yosys' words for reading them with all units.
pub fn sources(folder: &Path, name: &str, widths: &Widths) -> Result<String> {
    let packages = [
        ("splatline_pkg.sv", package::text(name, widths)?),
        ("splatline_setup_pkg.sv", text(name, widths)?),
    ];
    let mut read = "read_verilog -sv".to_owned();
    for (file, text) in packages {
        let path = folder.join(file);
        fs::write(&path, text)?;
        // Writing to a String cannot fail.
        let _ = write!(read, " {}", path.display());
    }
    Ok(format!("{read} {}", listed("setup_files.txt")?))
}

/// Hierarchy is kept, so that equal cores are synthesised once.
fn synthesised_unit(subject: &Subject, cores: u32, family: Family) -> Result<SetupUnit> {
    let folder = tempfile::tempdir()?;
    let Subject { name, widths } = subject;
    let read = sources(folder.path(), name, widths)?;
    // Yosys flattens for Lattice's devices unless it is told not to, and for Xilinx' only if it is told to.
    let hierarchy = match family {
        Family::Xilinx7 => "",
        _ => "-noflatten ",
    };
    let script = format!(
        "{read}; chparam -set CORES {cores} setup_unit; {} {hierarchy}-top setup_unit; flatten; opt_clean",
        synthesis(family)
    );
    let unit = SetupUnit {
        design: (*name).to_owned(),
        position: widths.position,
        mantissa: widths.mantissa,
        round: program(widths)?.round as u32,
        family,
        cores,
        fabric: synthesised_cells(&script, folder.path())?,
    };
    eprintln!("{name} {} {cores}: {}", family.name(), unit.fabric);
    Ok(unit)
}

fn write_page(units: &[SetupUnit]) -> Result<()> {
    Ok(atomic::write(REPORT.as_ref(), text_of(units)?.as_bytes())?)
}

/// The page as it would be written without synthesis.
pub fn page_text() -> Result<String> {
    text_of(&counts()?)
}

/// The counts of the last synthesis.
fn counts() -> Result<Vec<SetupUnit>> {
    let text = fs::read_to_string(COUNTS)?;
    parse(&text).context("not a table of counts")
}

fn text_of(units: &[SetupUnit]) -> Result<String> {
    let mut text = HEAD.to_owned();
    for unit in units {
        let seen = if unit.fitted() { "" } else { " ." };
        // There are no lines before the circuits that they go through have been synthesised.
        let estimate = estimate(units, unit.family, unit.mantissa, unit.cores);
        let cells = (0..4).map(|i| {
            let count = unit.fabric.resources()[i].1;
            let Some(estimate) = &estimate else {
                return count.to_string();
            };
            let estimated = estimate.resources()[i].1;
            let error = 100.0 * (estimated as f64 / count.max(1) as f64 - 1.0);
            format!("{count} / {estimated} / {error:+.1} %")
        });
        let _ = writeln!(
            text,
            "| {} | {} | {}{seen} | {} |",
            unit.design,
            unit.family.name(),
            unit.cores,
            cells.collect::<Vec<_>>().join(" | ")
        );
    }
    text.push_str("\n## Which device holds it beside four lanes\n\n| design | device | cycles a splat | cores | setup unit: LUT, DSP, kbit | with the primitive of four lanes | fits |\n|---|---|---|---|---|---|---|\n");
    for subject in subjects().iter().take(2) {
        for device in DEVICES {
            for interval in INTERVALS {
                text += &held(units, subject.name, &subject.widths, device, interval)?;
            }
        }
    }
    let read = |path: &str| fs::read_to_string(path).context("what a command printed last");
    for (head, kept) in [
        (NOTES, None),
        (COMPARED_HEAD, Some(COMPARED)),
        (FEW_HEAD, Some(COMPARED_FEW)),
        (DISTANT_HEAD, Some(COMPARED_DISTANT)),
        (JUDGED_HEAD, Some(JUDGED)),
        (JUDGED_PROGRAMS_HEAD, Some(JUDGED_PROGRAMS)),
    ] {
        text.push_str(head);
        text.push_str(&kept.map_or(Ok(String::new()), read)?);
    }
    Ok(text)
}

/// One line of the second table.
fn held(
    units: &[SetupUnit],
    name: &str,
    widths: &Widths,
    (device, family, has): (&str, Family, [u64; 3]),
    interval: u32,
) -> Result<String> {
    let round = program(widths)?.round as u32;
    let cores = cores(round, interval.max(LEAST_INTERVAL));
    let Some(setup) = estimate(units, family, widths.mantissa, cores) else {
        return Ok(String::new());
    };
    let lanes = synthesised()
        .into_iter()
        .find(|line| {
            line.design == name && line.family == family && line.part == SynthesisedPart::Lanes(4)
        })
        .context("the primitive's counts")?;
    let together = setup + lanes.fabric;
    let numbers = |fabric: &Fabric| [fabric.luts, fabric.dsps, fabric.memory_kbit];
    let short: Vec<String> = ["LUT", "DSP", "kbit"]
        .iter()
        .zip(numbers(&together).iter().zip(has))
        .filter(|(_, (needs, has))| *needs > has)
        .map(|(what, (needs, has))| format!("no: {needs} of {has} {what}"))
        .collect();
    let fits = if short.is_empty() {
        "yes".to_owned()
    } else {
        short.join(", ")
    };
    let words = |fabric: &Fabric| numbers(fabric).map(|n| n.to_string()).join(", ");
    Ok(format!(
        "| {name} | {device} | {interval} | {cores} | {} | {} | {fits} |\n",
        words(&setup),
        words(&together)
    ))
}
