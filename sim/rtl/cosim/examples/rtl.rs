//! Commands around the RTL: `cargo run --release -p splatline-rtl --example rtl -- COMMAND`.

use anyhow::{Context, Result, bail, ensure};
use splatline::format::Traversal;
use splatline_rtl::circuit::{Circuit, DESIGNS, HARMONICS, ORDER, PRIMITIVE, RtlUnit, packages};
use splatline_rtl::harmonics::unit::{HarmonicsLoad, MULTIPLIERS, print_cycles};
use splatline_rtl::machine::MachineLoad;
use splatline_rtl::machine::unit::with_harmonics;
use splatline_rtl::mutation::{Mutation, mutations};
use splatline_rtl::order::OrderLoad;
use splatline_rtl::primitive::unit::{LANES, PrimitiveLoad};
use splatline_rtl::setup::SetupLoad;
use splatline_rtl::setup::program::{ProgramKind, SetupProgram};
use splatline_rtl::tools::rtl;
use splatline_rtl::unit::report;
use splatline_rtl::{area, asic, formal, harmonics, judges, machine, placement, primitive, rules};
use splatline_rtl::{setup, tables};
use splatline_sim::atomic;
use splatline_sim::design::DesignChoice;
use splatline_sim::machine::Config;
use splatline_sim::machine::area::{CountedMachine, Family, synthesis};
use splatline_sim::machine::primitive::Intervals;
use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = include_str!("usage.txt");

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match run(&words) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => {
            eprint!("{USAGE}");
            ExitCode::from(2)
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(1)
        }
    }
}

/// Runs a command; false if there is no such command.
fn run(words: &[&str]) -> Result<bool> {
    match words {
        ["package"] => write_packages()?,
        ["package", design, folder, options @ ..] => {
            write_package(design, Path::new(folder), &program(options)?)?;
        }
        ["compare", unit] => compare(unit)?,
        ["mutations"] => judge(None, "")?,
        ["mutations", unit] => judge(Some(unit), "")?,
        ["mutations", unit, part] => judge(Some(unit), part)?,
        ["formal"] => formal::report()?,
        ["area", "primitive", rest @ ..] => print!("{}", area::of_primitives(first(rest))?),
        ["area", "setup", rest @ ..] => print!("{}", area::of_setup_units(first(rest))?),
        ["area", "order"] => print_area(&ORDER, DIGITS)?,
        ["area", "harmonics"] => print_area(&HARMONICS, MULTIPLIERS)?,
        ["area", "machine"] => print!("{}", machine::area::report(false)?),
        ["area", "frames-harmonics"] => print!("{}", machine::area::report(true)?),
        ["area", "asic", liberty, rest @ ..] => {
            let circuits = placement::circuits(first(rest).unwrap_or_default())?;
            asic::report(Path::new(liberty), &circuits)?;
        }
        ["fmax", words] => placement::report(words, None)?,
        ["fmax", words, seed] => placement::report(words, Some(number(seed)?))?,
        ["bitstream", design, count, file] => {
            let circuit = match (*design, number(count)?) {
                ("machine", cores) => placement::machine(cores)?,
                (design, lanes) => Circuit::new(&PRIMITIVE, design, lanes)?,
            };
            println!("{}", placement::bitstream(&circuit, Path::new(file))?);
        }
        ["registers", design, name] => {
            let widths = DesignChoice::load(design)?.widths;
            print!("{}", rules::register_writes(&widths, name)?);
        }
        ["frame", design, file] => machine::shell::write_frame(design, Path::new(file))?,
        ["estimate", design, lanes] => estimate(design, lanes)?,
        _ => return Ok(false),
    }
    Ok(true)
}

/// The first of the words at a command's end, if there are any.
fn first<'a>(words: &[&'a str]) -> Option<&'a str> {
    words.first().copied()
}

fn number(text: &str) -> Result<u32> {
    text.parse()
        .with_context(|| format!("'{text}' is no number"))
}

fn write_packages() -> Result<()> {
    for design in DESIGNS {
        write_package(design, &rtl().join(design), &program(&[])?)?;
    }
    atomic::write(&rtl().join(tables::FILE), tables::text().as_bytes())?;
    let (file, program) = (harmonics::program::FILE, harmonics::program::text()?);
    Ok(atomic::write(&rtl().join(file), program.as_bytes())?)
}

/// Setup's program with these options.
fn program(options: &[&str]) -> Result<SetupProgram> {
    let (kind, rest) = match options {
        ["distance", rest @ ..] => (ProgramKind::DistanceScaling, rest),
        ["compensation", rest @ ..] => (ProgramKind::Compensation, rest),
        rest => (ProgramKind::Filter, rest),
    };
    match rest {
        [] => Ok(SetupProgram::new(kind)),
        ["direction"] => Ok(SetupProgram::new(kind).with_direction()),
        _ => bail!("no option of setup's program: {rest:?}"),
    }
}

fn write_package(design: &str, folder: &Path, program: &SetupProgram) -> Result<()> {
    let choice = DesignChoice::load(design)?;
    std::fs::create_dir_all(folder)?;
    for (file, text) in packages(&choice, program, 2)? {
        atomic::write(&folder.join(file), text.as_bytes())?;
    }
    Ok(())
}

/// Bits of a digit for which there are tables of the sorter.
const DIGITS: [u32; 2] = [8, 12];

/// Shapes of the primitive that no test draws with: design, lanes, cycles between two packets and between two rows.
const SHAPES: [(&str, &[u32], Intervals); 7] = [
    ("lean18", &[2, 8, 16], Intervals::USUAL),
    ("lean18", &[4], Intervals { setup: 1, rows: 1 }),
    ("lean18", &[2], Intervals { setup: 8, rows: 1 }),
    ("standard24", &[2, 8, 16], Intervals::USUAL),
    ("standard24", &[1], Intervals { setup: 1, rows: 1 }),
    ("standard24", &[4], Intervals { setup: 4, rows: 2 }),
    ("24-bit mantissa", &[1, 4, 16], Intervals::USUAL),
];

fn compare(unit: &str) -> Result<()> {
    match unit {
        "shapes" => SHAPES
            .into_iter()
            .try_for_each(|(design, lanes, intervals)| {
                compare_primitives(design, lanes, intervals)
            }),
        "order" => DIGITS
            .into_iter()
            .try_for_each(|digit| report::<OrderLoad>(&Circuit::new(&ORDER, "lean18", digit)?)),
        "harmonics" => MULTIPLIERS.into_iter().try_for_each(|multipliers| {
            let circuit = Circuit::new(&HARMONICS, "lean18", multipliers)?;
            report::<HarmonicsLoad>(&circuit)?;
            print_cycles(&circuit)
        }),
        _ => DESIGNS
            .into_iter()
            .try_for_each(|design| compare_design(unit, design)),
    }
}

fn compare_primitives(design: &str, lanes: &[u32], intervals: Intervals) -> Result<()> {
    for lanes in lanes {
        report::<PrimitiveLoad>(&primitive::unit::circuit(design, *lanes, intervals)?)?;
    }
    Ok(())
}

fn compare_design(unit: &str, design: &str) -> Result<()> {
    let setup =
        |cores, program| report::<SetupLoad>(&setup::unit::circuit(design, cores, program)?);
    let machine = || machine::unit::circuit(design, 8, 4);
    match unit {
        "primitive" => {
            compare_primitives(design, &LANES, Intervals::USUAL)?;
            report::<PrimitiveLoad>(&primitive::unit::few_multipliers(design)?)?;
            report::<PrimitiveLoad>(&primitive::unit::small(design)?)
        }
        // Of several cores a number that divides no round.
        "setup" => setup(7, program(&[])?),
        "compensation" | "distance" | "direction" => setup(7, program(&[unit])?),
        "tables" => setup(2, SetupProgram::new(ProgramKind::Units)),
        "machine" => report::<MachineLoad>(&machine()?),
        "frames-distance" => {
            report::<MachineLoad>(&machine()?.with_program(program(&["distance"])?))
        }
        "frames-harmonics" => MULTIPLIERS.into_iter().try_for_each(|multipliers| {
            report::<MachineLoad>(&with_harmonics(machine()?, multipliers))
        }),
        _ => bail!("no unit '{unit}'\n{USAGE}"),
    }
}

/// Prints how each mutation is noticed whose name contains `part`.
fn judge(unit: Option<&str>, part: &str) -> Result<()> {
    println!("| judged by | mutation | file | noticed as |\n|---|---|---|---|");
    let mut survivors = 0;
    for judge in judges::JUDGES {
        if unit.is_some_and(|unit| unit != judge) {
            continue;
        }
        let mut mutations = mutations(judge)?;
        mutations.retain(|mutation| mutation.name.contains(part));
        judges::judge(judge, &mutations, |Mutation { name, file, .. }, noticed| {
            survivors += usize::from(noticed.is_none());
            let noticed = noticed.unwrap_or("**not noticed**");
            println!("| {judge} | {name} | {file} | {noticed} |");
        })?;
    }
    ensure!(survivors == 0, "{survivors} mutations survive");
    Ok(())
}

fn print_area(unit: &'static RtlUnit, values: [u32; 2]) -> Result<()> {
    println!("circuit,luts,flip_flops,dsps,memory_kbit");
    for value in values {
        let circuit = Circuit::new(unit, "lean18", value)?;
        println!("{circuit},{}", area::of_circuit(&circuit)?.cells());
    }
    Ok(())
}

fn estimate(design: &str, lanes: &str) -> Result<()> {
    let design = DesignChoice::load(design)?;
    let machine = Config::primitive(number(lanes)?);
    for family in Family::ALL {
        let prices = family.calibration();
        let area =
            CountedMachine::new(&design.widths, Traversal::Spans, &machine, &prices).raster_unit();
        let statement = synthesis::statement(&prices);
        println!("{}: {area}\n  ({statement})", family.name());
    }
    Ok(())
}
