//! Mutants of the kernel: every comparison, operator, limit, constant, result and statement of `src` is changed in
//! turn, and a test must fail. The kernel is compiled once with all changes in it, of which a number chooses one when
//! the tests run; what the compiler evaluates (tables, constants) is compiled once for each. `../mutants.sh` says how
//! to call it.

mod copy;
mod sites;
mod trial;

use copy::Copy;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use trial::{Suite, Verdict};

type Failure = Box<dyn std::error::Error>;

const HELP: &str = "\
sim/fuzz/mutants.sh                      all that are chosen at run time: five minutes
sim/fuzz/mutants.sh --sample SEED 8      others each time, for as many minutes; the seed repeats a sample
sim/fuzz/mutants.sh --in src/math,Blend  those whose name contains one of these
sim/fuzz/mutants.sh --again              those that survived the last run
sim/fuzz/mutants.sh --own                against the unit tests alone: a minute, and more survive
sim/fuzz/mutants.sh --compiled           those in constants, each compiled singly: a night; with --again the survivors
sim/fuzz/mutants.sh --list               names only
Survivors that change nothing stand in sim/fuzz/mutants/equivalent.txt: a name, and indented below it the proof.";

#[derive(Default)]
struct Options {
    sample: Option<(u64, u64)>,
    part: Option<String>,
    again: bool,
    own: bool,
    compiled: bool,
    list: bool,
}

fn options() -> Result<Options, Failure> {
    let mut options = Options::default();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let missing = format!("{argument} needs a value\n{HELP}");
        let mut value = || arguments.next().ok_or_else(|| missing.clone());
        match argument.as_str() {
            "--sample" => options.sample = Some((value()?.parse()?, value()?.parse()?)),
            "--in" => options.part = Some(value()?),
            "--again" => options.again = true,
            "--own" => options.own = true,
            "--compiled" => options.compiled = true,
            "--list" => options.list = true,
            _ => return Err(HELP.into()),
        }
    }
    Ok(options)
}

/// Names of mutants that change nothing, with the reason. A name that ends with ` | *` stands for all that begin like
/// it.
fn equivalent(text: &str) -> Result<BTreeMap<String, String>, Failure> {
    let mut names = BTreeMap::new();
    let mut open = Vec::new();
    let lines = text
        .lines()
        .filter(|l| !l.is_empty() && !l.starts_with('#'));
    for line in lines {
        match line.strip_prefix("    ") {
            Some(reason) => names.extend(open.drain(..).map(|name| (name, reason.to_string()))),
            None => open.push(line.to_string()),
        }
    }
    match open.first() {
        Some(name) => Err(format!("equivalent.txt: no reason for {name}").into()),
        None => Ok(names),
    }
}

fn reason<'a>(names: &'a BTreeMap<String, String>, key: &str) -> Option<&'a String> {
    let covers = |name: &str| {
        let start = name.strip_suffix('*');
        start.is_some_and(|start| key.starts_with(start))
    };
    let covering = || names.iter().find(|(name, _)| covers(name));
    names.get(key).or_else(|| Some(covering()?.1))
}

fn main() {
    if let Err(error) = run() {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

fn run() -> Result<(), Failure> {
    let options = options()?;
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = here.join("../../..").canonicalize()?;
    let work = here.join("../target/mutants");
    let names = equivalent(&fs::read_to_string(here.join("equivalent.txt"))?)?;
    let last = work.join("survivors.txt");
    let mut copy = Copy::new(&root, &work)?;
    let mut chosen = choose(&copy, &options, &last)?;
    if options.list {
        for mutant in chosen.iter().map(|&m| &copy.mutants[m]) {
            println!("{}:{}", mutant.key, mutant.line);
        }
        return Ok(());
    }
    copy.settle()?;
    chosen.retain(|&m| !copy.mutants[m].dropped);
    let dropped = copy.mutants.iter().filter(|m| m.dropped).count() - 1;
    println!(
        "{} mutants, {dropped} do not compile, {} chosen",
        copy.mutants.len() - 1,
        chosen.len()
    );
    let time = options
        .sample
        .map(|(_, minutes)| Duration::from_secs(60 * minutes));
    let end = time.map(|time| Instant::now() + time);
    let explained = |m: &usize| reason(&names, &copy.mutants[*m].key).is_some();
    let (tried, survivors) = trials(&copy, chosen, &options, end, &work, explained)?;
    let (explained, unexplained): (Vec<usize>, Vec<usize>) =
        survivors.into_iter().partition(explained);
    let mut text = String::new();
    for &m in &unexplained {
        println!("SURVIVED {}:{}", copy.mutants[m].key, copy.mutants[m].line);
        text += &format!("{}\n", copy.mutants[m].key);
    }
    fs::write(&last, text)?;
    println!(
        "{tried} tried, {} survived and are explained, {} unexplained",
        explained.len(),
        unexplained.len()
    );
    if unexplained.is_empty() {
        Ok(())
    } else {
        Err("mutants survived".into())
    }
}

/// What mutants are held against, the quick ones first: the kernel's own tests, and no others, so that nobody who has
/// the kernel alone is left without what notices a mistake.
const SUITES: [&[&str]; 2] = [
    &["-p", "splatline", "--lib"],
    &["-p", "splatline", "--test", "all"],
];

/// Tries mutants against one suite after the other, as long as some survive and nothing explains why. Returns how many
/// were tried, and the survivors.
fn trials(
    copy: &Copy,
    mut open: Vec<usize>,
    options: &Options,
    end: Option<Instant>,
    work: &Path,
    explained: impl Fn(&usize) -> bool,
) -> Result<(usize, Vec<usize>), Failure> {
    let mut tried = open.len();
    let mut survivors = Vec::new();
    let suites = if options.own { &SUITES[..1] } else { &SUITES };
    for (number, arguments) in suites.iter().enumerate() {
        if open.is_empty() {
            break;
        }
        println!("{} mutants", open.len());
        let suite = Suite::new(copy.programs(0, arguments)?, work)?;
        println!(
            "against {} tests of {}",
            suite.tests.len(),
            arguments.join(" ")
        );
        // What was begun goes through both.
        let end = end.filter(|_| number == 0);
        let judged = in_parallel(&open, options.compiled, end, |mutant| {
            let verdict = judge(&suite, mutant, options.compiled, copy, arguments)
                .map_err(|error| error.to_string())?;
            let mutation = &copy.mutants[mutant];
            match &verdict {
                Verdict::Noticed(by) => println!("noticed   {} by {by}", mutation.key),
                Verdict::Endless(by) => println!("endless   {} in {by}", mutation.key),
                Verdict::Unreached => println!("unreached {}:{}", mutation.key, mutation.line),
                Verdict::Survived => println!("open      {}:{}", mutation.key, mutation.line),
            }
            Ok(matches!(verdict, Verdict::Unreached | Verdict::Survived))
        })?;
        if number == 0 {
            tried = judged.len();
        }
        let alive = judged.into_iter().filter(|(_, survived)| *survived);
        let (known, unknown) = alive
            .map(|(mutant, _)| mutant)
            .partition::<Vec<_>, _>(&explained);
        survivors.extend(known);
        open = unknown;
    }
    survivors.extend(open);
    Ok((tried, survivors))
}

/// Tries one mutant, which is chosen when the tests run or has to be compiled.
fn judge(
    suite: &Suite,
    mutant: usize,
    compiled: bool,
    copy: &Copy,
    arguments: &[&str],
) -> Result<Verdict, Failure> {
    if !compiled {
        return suite.try_mutant(mutant);
    }
    match copy.programs(mutant, arguments) {
        Ok(programs) => suite.try_built(&programs, mutant),
        Err(_) => Ok(Verdict::Noticed("the compiler".into())),
    }
}

/// Which mutants survive, by all processors, in their order; those that are compiled in by one, since each is a build.
fn in_parallel(
    mutants: &[usize],
    compiled: bool,
    end: Option<Instant>,
    judge: impl Fn(usize) -> Result<bool, String> + Sync,
) -> Result<Vec<(usize, bool)>, Failure> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let workers = if compiled { 1 } else { workers };
    let next = AtomicUsize::new(0);
    let work = || {
        let mut judged = Vec::new();
        while end.is_none_or(|end| Instant::now() < end) {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(&mutant) = mutants.get(place) else {
                break;
            };
            judged.push((place, mutant, judge(mutant)?));
        }
        Ok::<_, String>(judged)
    };
    let mut judged = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        let mut all = Vec::new();
        for worker in workers {
            all.extend(worker.join().map_err(|_| "a worker panicked")??);
        }
        Ok::<_, Failure>(all)
    })?;
    judged.sort_by_key(|(place, ..)| *place);
    let judged = judged.into_iter();
    Ok(judged
        .map(|(_, mutant, survived)| (mutant, survived))
        .collect())
}

/// Numbers of the mutants to try, in their order.
fn choose(copy: &Copy, options: &Options, last: &Path) -> Result<Vec<usize>, Failure> {
    let last: BTreeSet<String> = if options.again {
        fs::read_to_string(last)?
            .lines()
            .map(String::from)
            .collect()
    } else {
        BTreeSet::new()
    };
    let parts = options.part.as_deref().unwrap_or("");
    let mut chosen: Vec<usize> = (1..copy.mutants.len())
        .filter(|&m| options.again || copy.mutants[m].constant == options.compiled)
        .filter(|&m| {
            parts
                .split(',')
                .any(|part| copy.mutants[m].key.contains(part))
        })
        .filter(|&m| !options.again || last.contains(&copy.mutants[m].key))
        .collect();
    if let Some((seed, _)) = options.sample {
        println!("seed {seed}");
        // An order by a mixed number of each mutant.
        let mix = |m: usize| {
            let x = (m as u64 ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15))
                .wrapping_mul(0xbf58_476d_1ce4_e5b9);
            (x ^ x >> 29).wrapping_mul(0x94d0_49bb_1331_11eb)
        };
        chosen.sort_by_key(|&m| mix(m));
    }
    Ok(chosen)
}
