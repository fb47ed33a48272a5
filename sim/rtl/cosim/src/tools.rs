//! Programs around the circuits: Yosys, Verilator, the placer, and the folder of the RTL in which they run.

use anyhow::{Context, Result, ensure};
use serde::de::DeserializeOwned;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Folder of the RTL.
pub fn rtl() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A program that a variable of the environment names, or the usual one.
pub fn tool(variable: &str, usual: &str) -> Command {
    Command::new(std::env::var(variable).unwrap_or_else(|_| usual.to_owned()))
}

fn output(command: &mut Command) -> Result<Output> {
    let output = command.output();
    let name = command.get_program().display();
    output.with_context(|| format!("cannot run {name}: is it installed?"))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Standard output of a command that succeeded.
pub fn run(command: &mut Command) -> Result<String> {
    let output = output(command)?;
    let (name, error) = (command.get_program().display(), text(&output.stderr));
    ensure!(output.status.success(), "{name} failed:\n{error}");
    Ok(text(&output.stdout))
}

/// All that a program prints, whatever its exit code.
pub fn printed(command: &mut Command) -> Result<String> {
    let output = output(command)?;
    Ok(text(&[output.stdout, output.stderr].concat()))
}

/// Runs a script of Yosys in the folder of the RTL.
pub fn yosys(script: &str) -> Result<()> {
    let mut command = Command::new("yosys");
    run(command.args(["-q", "-p", script]).current_dir(rtl()))?;
    Ok(())
}

/// A JSON file.
pub fn json<T: DeserializeOwned>(path: &Path) -> Result<T> {
    serde_json::from_slice(&fs::read(path)?).with_context(|| path.display().to_string())
}

/// The first of some programs of the same use that runs.
pub fn first_that_runs(tools: &'static [&'static str]) -> Result<&'static str> {
    let runs = |tool: &&str| Command::new(tool).arg("--version").output().is_ok();
    let found = tools.iter().copied().find(runs);
    found.with_context(|| format!("{} not found", tools.join(" or ")))
}
