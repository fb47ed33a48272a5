//! Runs tests against one mutant: the quickest first, only those that reach it, until one fails.

use crate::Failure;
use crate::copy::Program;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Processor time that a test may take, in times of what it takes without a mutant.
const LIMIT: u128 = 4;

/// One test, run once without a mutant.
pub struct Test {
    program: usize,
    name: String,
    time: Duration,
    reached: BTreeSet<usize>,
}

/// All tests, quickest first.
pub struct Suite {
    programs: Vec<Program>,
    pub tests: Vec<Test>,
}

/// What became of a mutant.
pub enum Verdict {
    /// By one of these tests.
    Noticed(String),
    /// Ran longer than four times what the tests take without it, or took too much memory.
    Endless(String),
    Survived,
    /// No test runs this code.
    Unreached,
}

impl Suite {
    /// Runs every test alone, and notes how long it takes and which mutants it reaches.
    pub fn new(programs: Vec<Program>, work: &Path) -> Result<Suite, Failure> {
        let mut suite = Suite {
            programs,
            tests: Vec::new(),
        };
        for program in 0..suite.programs.len() {
            let arguments = ["--list", "--format", "terse"];
            let list = command(&suite.programs[program], &arguments, "20").output()?;
            for line in String::from_utf8(list.stdout)?.lines() {
                let Some(name) = line.strip_suffix(": test") else {
                    continue;
                };
                suite.try_once(program, name, work)?;
            }
        }
        suite.tests.sort_by_key(|t| t.time);
        Ok(suite)
    }

    fn try_once(&mut self, program: usize, name: &str, work: &Path) -> Result<(), Failure> {
        let record = work.join("reached");
        let output = command(&self.programs[program], &["--exact", name], "600")
            .env("MUTANT_RECORD", &record)
            .stderr(Stdio::piped())
            .output()?;
        let time = processor_time(&String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8_lossy(&output.stdout);
        if !output.status.success() {
            return Err(format!("{name} fails without a mutant:\n{text}").into());
        }
        if text.contains("1 passed") {
            let numbers = std::fs::read_to_string(&record)?;
            let numbers = numbers.split_whitespace();
            self.tests.push(Test {
                program,
                name: name.into(),
                time,
                reached: numbers.filter_map(|n| n.parse().ok()).collect(),
            });
        }
        Ok(())
    }

    /// Tries one mutant by the tests that reach it.
    pub fn try_mutant(&self, mutant: usize) -> Result<Verdict, Failure> {
        let reaching = self.tests.iter().filter(|t| t.reached.contains(&mutant));
        self.attempt(&self.programs, reaching.collect(), mutant)
    }

    /// The same in builds that hold the mutant: which tests reach it is not known.
    pub fn try_built(&self, programs: &[Program], mutant: usize) -> Result<Verdict, Failure> {
        self.attempt(programs, self.tests.iter().collect(), mutant)
    }

    fn attempt(
        &self,
        programs: &[Program],
        all: Vec<&Test>,
        mutant: usize,
    ) -> Result<Verdict, Failure> {
        if all.is_empty() {
            return Ok(Verdict::Unreached);
        }
        let mut rest = all.as_slice();
        while !rest.is_empty() {
            let (now, later) = rest.split_at(group(rest));
            rest = later;
            for (program, built) in programs.iter().enumerate() {
                let tests = now.iter().copied().filter(|t| t.program == program);
                let tests: Vec<&Test> = tests.collect();
                if tests.is_empty() {
                    continue;
                }
                let time: Duration = tests.iter().map(|t| t.time).sum();
                let seconds = (1 + LIMIT * time.as_millis() / 1000).to_string();
                let mut arguments = vec!["--exact"];
                arguments.extend(tests.iter().map(|t| t.name.as_str()));
                let output = command(built, &arguments, &seconds)
                    .env("MUTANT", mutant.to_string())
                    .output()?;
                if !output.status.success() {
                    return Ok(verdict(&output));
                }
            }
        }
        Ok(Verdict::Survived)
    }
}

/// A test program with limits of processor time in seconds and of memory. Random cases are the same ones each time.
fn command(program: &Program, arguments: &[&str], seconds: &str) -> Command {
    let mut command = Command::new("sh");
    command
        .args([
            "-c",
            "ulimit -c 0; ulimit -t $0; ulimit -v 8000000; \"$@\" 2>/dev/null; c=$?; times >&2; exit $c",
            seconds,
        ])
        .arg(&program.path)
        .args(arguments)
        .args(["--test-threads=1", "-Zunstable-options", "--fail-fast"])
        .env("RUSTC_BOOTSTRAP", "1")
        .env("PROPTEST_RNG_SEED", "1")
        .env("PROPTEST_MAX_SHRINK_ITERS", "0")
        .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1")
        .env("RUST_BACKTRACE", "0")
        .current_dir(&program.folder)
        .stdin(Stdio::null())
        .stderr(Stdio::null());
    command
}

/// Of a shell's children, from the last line of what `times` prints: `0m1.25s 0m0.01s`.
fn processor_time(text: &str) -> Duration {
    let part = |word: &str| {
        let (minutes, seconds) = word.trim_end_matches('s').split_once('m')?;
        Some(60.0 * minutes.parse::<f64>().ok()? + seconds.parse::<f64>().ok()?)
    };
    let last = text.lines().last().unwrap_or("");
    Duration::from_secs_f64(last.split_whitespace().filter_map(part).sum())
}

/// How many tests are run together: more than one only if they are quick.
fn group(tests: &[&Test]) -> usize {
    let mut time = Duration::ZERO;
    let quick = tests.iter().take_while(|t| {
        time += t.time;
        time < Duration::from_millis(400)
    });
    quick.count().max(1)
}

fn verdict(output: &std::process::Output) -> Verdict {
    let text = String::from_utf8_lossy(&output.stdout);
    let mut tests = text.lines().filter(|l| l.starts_with("test "));
    match tests.clone().find(|l| l.ends_with("FAILED")) {
        Some(line) => Verdict::Noticed(line.split_whitespace().nth(1).unwrap_or("").into()),
        None => Verdict::Endless(tests.next_back().unwrap_or("").to_string()),
    }
}
