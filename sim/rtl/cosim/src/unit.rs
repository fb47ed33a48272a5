//! What the units of `sim/rtl` have in common: loads, back-pressure, and a comparison with what defines the unit. From
//! it follow the report of a full comparison and the judgement of mutations.

use crate::mutation::{Mutation, MutationNumber, mutations};
use anyhow::{Result, bail, ensure};
use rayon::prelude::*;
use std::ops::AddAssign;
use std::path::Path;

pub use crate::bench::Bench;
pub use crate::circuit::Circuit;

/// How much is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// What tests draw and mutations are judged by: seconds.
    Quick,
    /// Every splat of captured scenes and thousands of others.
    Full,
}

impl Extent {
    /// The C++ compiler's option: a quick comparison takes less time than building its circuit.
    pub(crate) fn compiled(self) -> &'static str {
        self.of("-O1", "-O2")
    }

    /// One of two.
    pub(crate) fn of<T>(self, quick: T, full: T) -> T {
        match self {
            Extent::Quick => quick,
            Extent::Full => full,
        }
    }
}

/// Names of scenes whose data is not at hand.
pub type Missing = Vec<&'static str>;

/// Loads with their names. Those of one name in a row are parts of one.
pub type Loads<L> = Vec<(String, L)>;

/// What a comparison found.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// Answers compared: packets, colours, pixels, places of an order.
    pub compared: u64,
    /// The first difference, in words.
    pub first_difference: Option<String>,
    /// Cycles.
    pub cycles: u64,
    /// What else there was, by its name, in the order of the report's columns.
    pub counts: Vec<(&'static str, u64)>,
}

impl Findings {
    /// So many more of this name.
    pub fn count(&mut self, name: &'static str, more: u64) {
        match self.counts.iter_mut().find(|known| known.0 == name) {
            Some((_, count)) => *count += more,
            None => self.counts.push((name, more)),
        }
    }
}

impl AddAssign for Findings {
    fn add_assign(&mut self, other: Findings) {
        self.compared += other.compared;
        self.cycles += other.cycles;
        for (name, more) in other.counts {
            self.count(name, more);
        }
        if self.first_difference.is_none() {
            self.first_difference = other.first_difference;
        }
    }
}

/// What one comparison of a unit with what defines it is made of.
pub trait Load: Sized + Sync {
    /// How many ways there are of feeding and emptying the circuit; the first is that at full speed.
    const WAYS: usize;

    /// All that the circuit is given. The names of scenes whose data is not at hand go to `missing`.
    fn all(circuit: &Circuit, extent: Extent, missing: &mut Missing) -> Result<Loads<Self>>;

    /// Gives the load to the circuit under one of the pressures. An error is a circuit that hangs.
    fn compare(&self, circuit: &Circuit, bench: Bench, pressure: usize) -> Result<Findings>;
}

/// What a circuit's comparison says first, or nothing if it agrees everywhere.
fn first_difference<L: Load>(
    circuit: &Circuit,
    library: &Path,
    mutation: MutationNumber,
    loads: &Loads<L>,
) -> Option<String> {
    let jobs = 0..loads.len() * L::WAYS;
    let difference = |job: usize| {
        let ((name, load), pressure) = (&loads[job / L::WAYS], job % L::WAYS);
        let bench = Bench::new(library, pressure as u32 + 1, mutation);
        let found = bench.and_then(|bench| load.compare(circuit, bench, pressure));
        let found = found.map(|findings| findings.first_difference);
        let difference = found.unwrap_or_else(|error| Some(format!("{error:#}")))?;
        Some(format!("{name}: {difference}"))
    };
    jobs.into_par_iter().find_map_first(difference)
}

/// Compares everything and prints a line for each load.
pub fn report<L: Load>(circuit: &Circuit) -> Result<()> {
    let library = circuit.library(Extent::Full)?;
    let mut missing = Vec::new();
    let loads = L::all(circuit, Extent::Full, &mut missing)?;
    println!("{circuit}; not at hand: {missing:?}\n");
    let mut total = Findings::default();
    for parts in loads.chunk_by(|one, next| one.0 == next.0) {
        // Under all pressures, or under one for each part of a divided load.
        let jobs = match parts.len() {
            1 => L::WAYS,
            count => count,
        };
        let compared = |job: usize| {
            let (_, part) = &parts[job % parts.len()];
            let bench = Bench::new(&library, job as u32 + 1, 0)?;
            part.compare(circuit, bench, job % L::WAYS)
        };
        let found: Result<Vec<Findings>> = (0..jobs).into_par_iter().map(compared).collect();
        let found = found?;
        let unhindered = found.first().map_or(0, |first| first.cycles);
        let mut sum = Findings::default();
        found.into_iter().for_each(|part| sum += part);
        let counts = sum.counts.iter();
        if total.cycles == 0 {
            let names = counts.clone().map(|(name, _)| format!(" {name} |"));
            let names: String = names.collect();
            println!("| load | compared | cycles at full speed |{names}");
            println!("|---|{}", "---:|".repeat(2 + sum.counts.len()));
        }
        let counts: String = counts.map(|(_, count)| format!(" {count} |")).collect();
        let (name, compared) = (&parts[0].0, sum.compared);
        println!("| {name} | {compared} | {unhindered} |{counts}");
        total += sum;
    }
    println!("\n{} compared\n", total.compared);
    match total.first_difference {
        Some(difference) => bail!("{difference}"),
        None => Ok(()),
    }
}

/// What notices mutations: it says how one is noticed, or nothing if it survives.
pub type Judge = Box<dyn Fn(&Mutation) -> Result<Option<String>>>;

/// A circuit's comparison as a judge. One circuit has all of its mutations that have a choice, and without one of them
/// it must agree; circuits with the others are built when they are asked for.
pub fn judge_of<L: Load + 'static>(
    circuit: Result<Circuit>,
    judge: &str,
    extent: Extent,
) -> Result<Judge> {
    let circuit = circuit?;
    let (library, chosen) = circuit.with_choices(&mutations(judge)?)?;
    let loads: Loads<L> = L::all(&circuit, extent, &mut Vec::new())?;
    let difference = first_difference(&circuit, &library, 0, &loads);
    ensure!(difference.is_none(), "without a mutation: {difference:?}");
    Ok(Box::new(move |mutation| {
        if chosen.contains(&mutation.number) {
            return Ok(first_difference(
                &circuit,
                &library,
                mutation.number,
                &loads,
            ));
        }
        let mutated = circuit.clone().with_mutation(mutation)?;
        // A mistake in a file or in lines of a program that the circuit does not have.
        if mutated.is_same(&circuit)? {
            return Ok(None);
        }
        let library = mutated.library(Extent::Quick)?;
        Ok(first_difference(&mutated, &library, 0, &loads))
    }))
}
