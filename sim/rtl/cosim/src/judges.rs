//! Which comparison judges which mutations of `mutations.tsv`.

use crate::circuit::{HARMONICS, ORDER};
use crate::harmonics::unit::HarmonicsLoad;
use crate::machine::MachineLoad;
use crate::machine::unit::{self as machine, with_harmonics};
use crate::mutation::Mutation;
use crate::order::OrderLoad;
use crate::primitive::unit::{self as primitive, PrimitiveLoad};
use crate::setup::SetupLoad;
use crate::setup::program::{ProgramKind, SetupProgram};
use crate::setup::unit::circuit;
use crate::unit::{Circuit, Extent, Judge, Load, first_difference, judge_of};
use anyhow::{Result, bail, ensure};
use splatline::format::Lean18;
use splatline_sim::machine::primitive::SETUP_INTERVAL;

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

/// Judges some of a judge's mutations. How each is noticed, or nothing if it survives, comes one by one, since each
/// takes a while.
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
    let machine = |cores| machine::circuit("lean18", cores, 4);
    let program = SetupProgram::new;
    let tables = setup(2, program(ProgramKind::Units));
    // A program with directions.
    let directed = || program(ProgramKind::Filter).with_direction();
    Ok(match name {
        "primitive" => {
            let circuit = primitive::circuit("lean18", 4, SETUP_INTERVAL);
            vec![judge_of::<PrimitiveLoad>(circuit, name, quick)?]
        }
        // What no packet shows, the units of the tables do.
        "setup" => vec![
            judge_of::<SetupLoad>(setup(2, program(ProgramKind::Filter)), name, quick)?,
            judge_of::<SetupLoad>(tables, name, quick)?,
        ],
        WITHOUT_EFFECT => vec![judge_of::<SetupLoad>(tables, name, Extent::Full)?],
        PROGRAMS => vec![
            program_judge(program(ProgramKind::DistanceScaling))?,
            program_judge(program(ProgramKind::Compensation))?,
            program_judge(directed())?,
        ],
        "order" => {
            let circuit = Circuit::new(&ORDER, "lean18", 8);
            vec![judge_of::<OrderLoad>(circuit, name, quick)?]
        }
        // What leads to the unit and away from it stands in setup and in the machine.
        "harmonics" => vec![
            judge_of::<HarmonicsLoad>(Circuit::new(&HARMONICS, "lean18", 1), name, quick)?,
            judge_of::<SetupLoad>(setup(2, directed()), name, quick)?,
            judge_of::<MachineLoad>(Ok(with_harmonics(machine(6)?, 1)), name, quick)?,
        ],
        "machine" => vec![judge_of::<MachineLoad>(machine(2), name, quick)?],
        _ => bail!("no judge '{name}'; there are {}", JUDGES.join(", ")),
    })
}

fn setup(cores: u32, program: SetupProgram) -> Result<Circuit> {
    circuit("lean18", cores, program)
}

/// A setup unit of one core for each of a program's mistakes: a program is data of the circuit, in a package, and no
/// choice can be made there. Without a mistake the circuit must agree.
fn program_judge(right: SetupProgram) -> Result<Judge> {
    let circuit = setup(1, right.clone())?;
    let loads = SetupLoad::all(&circuit, Extent::Quick, &mut Vec::new())?;
    let first_difference = move |circuit: &Circuit| -> Result<Option<String>> {
        let library = circuit.library(Extent::Quick)?;
        Ok(first_difference(circuit, &library, 0, &loads))
    };
    let difference = first_difference(&circuit)?;
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
