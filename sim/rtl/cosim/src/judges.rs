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
use crate::setup::unit as setup;
use crate::unit::{Circuit, Extent, Judge, judge_of};
use anyhow::{Result, bail, ensure};
use splatline_sim::machine::primitive::Intervals;

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
    let extent = match name {
        WITHOUT_EFFECT => Extent::Full,
        _ => Extent::Quick,
    };
    let program = SetupProgram::new;
    let directed = || program(ProgramKind::Filter).with_direction();
    let setup = |cores, program| {
        let circuit = setup::circuit("lean18", cores, program);
        judge_of::<SetupLoad>(circuit, name, extent)
    };
    let machine = |circuit| judge_of::<MachineLoad>(circuit, name, extent);
    let machine_of = |cores| machine::circuit("lean18", cores, 4);
    let judges = match name {
        "primitive" => {
            let circuits = [
                primitive::circuit("lean18", 4, Intervals::USUAL),
                primitive::small("lean18"),
                primitive::few_multipliers("standard24"),
            ];
            circuits
                .map(|circuit| judge_of::<PrimitiveLoad>(circuit, name, extent))
                .into()
        }
        // What no packet shows, the units of the tables do.
        "setup" => vec![
            setup(2, program(ProgramKind::Filter)),
            setup(2, program(ProgramKind::Units)),
        ],
        WITHOUT_EFFECT => vec![setup(2, program(ProgramKind::Units))],
        PROGRAMS => vec![
            setup(1, program(ProgramKind::DistanceScaling)),
            setup(1, program(ProgramKind::Compensation)),
            setup(1, directed()),
        ],
        "order" => {
            let circuit = Circuit::new(&ORDER, "lean18", 8);
            vec![judge_of::<OrderLoad>(circuit, name, extent)]
        }
        // What leads to the unit and away from it stands in setup and in the machine.
        "harmonics" => vec![
            judge_of::<HarmonicsLoad>(Circuit::new(&HARMONICS, "lean18", 1), name, extent),
            setup(2, directed()),
            machine(machine_of(6).map(|circuit| with_harmonics(circuit, 1))),
        ],
        "machine" => vec![machine(machine_of(2))],
        _ => bail!("no judge '{name}'; there are {}", JUDGES.join(", ")),
    };
    judges.into_iter().collect()
}
