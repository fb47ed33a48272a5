//! Which comparison judges which mutations of `mutations.tsv`.

use crate::circuit::Effort;
use crate::harmonics::unit::HarmonicsUnit;
use crate::machine::loads::MachineOption;
use crate::machine::unit::MachineUnit;
use crate::mutation::{Mutation, mutations};
use crate::order::unit::OrderUnit;
use crate::primitive::unit::PrimitiveUnit;
use crate::setup::program::{ProgramKind, SetupProgram};
use crate::setup::tables::TableUnits;
use crate::setup::unit::{SetupLoad, SetupUnit};
use crate::unit::{Extent, Judge, Judgement, Unit};
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

/// What came of a mutation.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Its name.
    pub name: String,
    /// Where it is made.
    pub file: String,
    /// How it is noticed; nothing if it survives.
    pub noticed: Option<String>,
}

/// The names of a judge's mutations.
pub fn names(judge: &str) -> Result<Vec<String>> {
    let names = mutations(judge)?.into_iter().map(|mutation| mutation.name);
    Ok(names.collect())
}

/// Judges the mutations of these names; verdicts come one by one, since each takes a while.
pub fn judge(judge: &str, names: &[String], mut each: impl FnMut(Verdict)) -> Result<()> {
    if names.is_empty() {
        return Ok(());
    }
    let judges = judges(judge)?;
    for mutation in mutations(judge)? {
        if !names.contains(&mutation.name) {
            continue;
        }
        let mut noticed = None;
        for judge in &judges {
            if noticed.is_none() {
                noticed = judge.verdict(&mutation)?;
            }
        }
        if judge == WITHOUT_EFFECT {
            ensure!(noticed.is_none(), "{}: {noticed:?}", mutation.name);
            noticed = Some("changes nothing: every argument gives the kernel's".to_owned());
        }
        each(Verdict {
            name: mutation.name,
            file: mutation.file,
            noticed,
        });
    }
    Ok(())
}

/// One judge or more, of which any may notice a mutation.
fn judges(name: &str) -> Result<Vec<Box<dyn Judgement>>> {
    let quick = Extent::Quick;
    Ok(match name {
        "primitive" => vec![Box::new(Judge::new(
            PrimitiveUnit::new("lean18", 4)?,
            name,
            quick,
        )?)],
        // What no packet shows, the units of the tables do.
        "setup" => vec![
            Box::new(Judge::new(
                SetupUnit::new("lean18", 2, ProgramKind::Filter)?,
                name,
                quick,
            )?),
            Box::new(Judge::new(TableUnits::new("lean18")?, name, quick)?),
        ],
        WITHOUT_EFFECT => vec![Box::new(Judge::new(
            TableUnits::new("lean18")?,
            name,
            Extent::Full,
        )?)],
        PROGRAMS => vec![
            Box::new(ProgramJudge::new(SetupProgram::new(
                ProgramKind::DistanceScaling,
            ))?),
            Box::new(ProgramJudge::new(SetupProgram::new(
                ProgramKind::Compensation,
            ))?),
            Box::new(ProgramJudge::new(directed())?),
        ],
        "order" => vec![Box::new(Judge::new(OrderUnit::new(8)?, name, quick)?)],
        // What leads to the unit and away from it stands in setup and in the machine.
        "harmonics" => vec![
            Box::new(Judge::new(HarmonicsUnit::new(1)?, name, quick)?),
            Box::new(Judge::new(
                SetupUnit::with_program("lean18", 2, directed())?,
                name,
                quick,
            )?),
            Box::new(Judge::new(
                MachineUnit::new("lean18", 6, 4, MachineOption::Harmonics)?,
                name,
                quick,
            )?),
        ],
        "machine" => {
            let unit = MachineUnit::new("lean18", 2, 4, MachineOption::None)?;
            vec![Box::new(Judge::new(unit, name, quick)?)]
        }
        _ => bail!("no judge '{name}'; there are {}", JUDGES.join(", ")),
    })
}

/// The program with directions.
fn directed() -> SetupProgram {
    SetupProgram::new(ProgramKind::Filter).with_direction()
}

/// A setup unit of one core for each of a program's mistakes: a program is data of the circuit, in a package, and no choice can be made there.
struct ProgramJudge {
    right: SetupProgram,
    loads: Vec<SetupLoad>,
}

impl ProgramJudge {
    /// Without a mistake the circuit must agree.
    fn new(right: SetupProgram) -> Result<ProgramJudge> {
        let unit = SetupUnit::with_program("lean18", 1, right.clone())?;
        let loads = unit.loads(Extent::Quick, &mut Vec::new())?;
        let judge = ProgramJudge { right, loads };
        let difference = judge.difference(&unit)?;
        ensure!(difference.is_none(), "without a mutation: {difference:?}");
        Ok(judge)
    }

    fn difference(&self, unit: &SetupUnit) -> Result<Option<String>> {
        let library = unit.circuit().library(Effort::Little)?;
        Ok(unit.first_difference(&library, 0, &self.loads))
    }
}

impl Judgement for ProgramJudge {
    fn verdict(&self, mutation: &Mutation) -> Result<Option<String>> {
        let program = self.right.mutated(mutation)?;
        // A mistake in lines of the other program's is none here, and a circuit takes a while.
        let widths = &Lean18::WIDTHS;
        if program.assembled(widths)? == self.right.assembled(widths)? {
            return Ok(None);
        }
        self.difference(&SetupUnit::with_program("lean18", 1, program)?)
    }
}
