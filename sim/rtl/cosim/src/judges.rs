//! Which comparison judges which mutations of `mutations.tsv`.

use crate::harmonics::unit::HarmonicsUnit;
use crate::machine::MachineOption;
use crate::machine::unit::MachineUnit;
use crate::mutation::Mutation;
use crate::order::OrderUnit;
use crate::primitive::unit::PrimitiveUnit;
use crate::setup::program::{ProgramKind, SetupProgram};
use crate::setup::unit::SetupUnit;
use crate::unit::{Extent, Judge, Unit, judge_of};
use anyhow::{Result, bail, ensure};
use splatline::format::Lean18;

/// Setup's programs with a mistake in distance scaling, compensation or directions.
const PROGRAMS: &str = "programs";

/// Mutations that the design has no number to show: all arguments are drawn, and none may differ.
const WITHOUT_EFFECT: &str = "setup without effect";

/// All that judges.
pub const JUDGES: [&str; 7] = [
    "primitive",
    "setup",
    WITHOUT_EFFECT,
    PROGRAMS,
    "order",
    "harmonics",
    "machine",
];

/// Judges some of a judge's mutations. How each is noticed, or nothing if it survives, comes one by one, since each takes a while.
pub fn judge(
    judge: &str,
    mutations: &[Mutation],
    mut each: impl FnMut(&Mutation, Option<&str>),
) -> Result<()> {
    if mutations.is_empty() {
        return Ok(());
    }
    let judges = judges(judge)?;
    for mutation in mutations {
        let mut noticed = None;
        for judge in &judges {
            if noticed.is_none() {
                noticed = judge(mutation)?;
            }
        }
        if judge == WITHOUT_EFFECT {
            ensure!(noticed.is_none(), "{}: {noticed:?}", mutation.name);
            noticed = Some("changes nothing: every argument gives the kernel's".to_owned());
        }
        each(mutation, noticed.as_deref());
    }
    Ok(())
}

/// One judge or more, of which any may notice a mutation.
fn judges(name: &str) -> Result<Vec<Judge>> {
    let quick = Extent::Quick;
    let machine = |cores, option| MachineUnit::new("lean18", cores, 4, option);
    let program = SetupProgram::new;
    let tables = setup(2, program(ProgramKind::Units));
    // A program with directions.
    let directed = || program(ProgramKind::Filter).with_direction();
    Ok(match name {
        "primitive" => vec![judge_of(PrimitiveUnit::new("lean18", 4), name, quick)?],
        // What no packet shows, the units of the tables do.
        "setup" => vec![
            judge_of(setup(2, program(ProgramKind::Filter)), name, quick)?,
            judge_of(tables, name, quick)?,
        ],
        WITHOUT_EFFECT => vec![judge_of(tables, name, Extent::Full)?],
        PROGRAMS => vec![
            program_judge(program(ProgramKind::DistanceScaling))?,
            program_judge(program(ProgramKind::Compensation))?,
            program_judge(directed())?,
        ],
        "order" => vec![judge_of(OrderUnit::new(8), name, quick)?],
        // What leads to the unit and away from it stands in setup and in the machine.
        "harmonics" => vec![
            judge_of(HarmonicsUnit::new(1), name, quick)?,
            judge_of(setup(2, directed()), name, quick)?,
            judge_of(machine(6, MachineOption::Harmonics(1)), name, quick)?,
        ],
        "machine" => vec![judge_of(machine(2, MachineOption::None), name, quick)?],
        _ => bail!("no judge '{name}'; there are {}", JUDGES.join(", ")),
    })
}

fn setup(cores: u32, program: SetupProgram) -> Result<SetupUnit> {
    SetupUnit::new("lean18", cores, program)
}

/// A setup unit of one core for each of a program's mistakes: a program is data of the circuit, in a package, and no choice can be made there. Without a
/// mistake the circuit must agree.
fn program_judge(right: SetupProgram) -> Result<Judge> {
    let unit = setup(1, right.clone())?;
    let loads = unit.loads(Extent::Quick, &mut Vec::new())?;
    let first_difference = move |unit: &SetupUnit| -> Result<Option<String>> {
        let library = unit.circuit().library(Extent::Quick)?;
        Ok(unit.first_difference(&library, 0, &loads))
    };
    let difference = first_difference(&unit)?;
    ensure!(difference.is_none(), "without a mutation: {difference:?}");
    Ok(Box::new(move |mutation| {
        let program = right.mutated(mutation)?;
        // A mistake in lines of the other program's is none here, and a circuit takes a while.
        let widths = &Lean18::WIDTHS;
        if program.assembled(widths)? == right.assembled(widths)? {
            return Ok(None);
        }
        first_difference(&setup(1, program)?)
    }))
}
