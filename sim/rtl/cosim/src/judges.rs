//! Which comparison judges which mutations of `mutations.tsv`, and the programs with mistakes.

use crate::harmonics::unit::HarmonicsUnit;
use crate::machine::unit::MachineUnit;
use crate::mutation::mutations;
use crate::order::unit::OrderUnit;
use crate::primitive::unit::PrimitiveUnit;
use crate::setup::program::Protection;
use crate::setup::program_mutations::{program_mutations, verdict};
use crate::setup::tables::TableUnits;
use crate::setup::unit::SetupUnit;
use crate::unit::{Extent, Judge, Judgement};
use anyhow::{Result, bail, ensure};

/// Setup's programs with a mistake in distance scaling or compensation.
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
    if judge == PROGRAMS {
        let names = program_mutations().map(|(name, ..)| name.to_owned());
        return Ok(names.collect());
    }
    let names = mutations(judge)?.into_iter().map(|mutation| mutation.name);
    Ok(names.collect())
}

/// Judges the mutations of these names; verdicts come one by one, since each takes a while.
pub fn judge(judge: &str, names: &[String], mut each: impl FnMut(Verdict)) -> Result<()> {
    if names.is_empty() {
        return Ok(());
    }
    if judge == PROGRAMS {
        return judge_programs(names, &mut each);
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
                SetupUnit::new("lean18", 2, Protection::Filter)?,
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
        "order" => vec![Box::new(Judge::new(OrderUnit::new(8)?, name, quick)?)],
        "harmonics" => vec![Box::new(Judge::new(HarmonicsUnit::new(1)?, name, quick)?)],
        "machine" => {
            let unit = MachineUnit::new("lean18", 2, 4, false)?;
            vec![Box::new(Judge::new(unit, name, quick)?)]
        }
        _ => bail!("no judge '{name}'; there are {}", JUDGES.join(", ")),
    })
}

fn judge_programs(names: &[String], each: &mut impl FnMut(Verdict)) -> Result<()> {
    for protection in [Protection::DistanceScaling, Protection::Compensation] {
        let right = verdict(protection, None)?;
        ensure!(right.is_none(), "without a mutation: {right:?}");
    }
    for (name, protection, program) in program_mutations() {
        if names.iter().any(|known| known == name) {
            each(Verdict {
                name: name.to_owned(),
                file: "splatline_setup_pkg.sv".to_owned(),
                noticed: verdict(protection, Some(program))?,
            });
        }
    }
    Ok(())
}
