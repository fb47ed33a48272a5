//! Programs around the circuits: Yosys, Verilator, the placer, and the folder of the RTL in which they run.

use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder of the RTL.
pub fn rtl() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Standard output of a command that succeeded.
pub fn run(command: &mut Command) -> Result<String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command
        .output()
        .with_context(|| format!("cannot run {name}: is it installed?"))?;
    ensure!(
        output.status.success(),
        "{name} failed:\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// All that a program prints, whatever its exit code.
pub fn printed(command: &mut Command) -> Result<String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command
        .output()
        .with_context(|| format!("cannot run {name}: is it installed?"))?;
    let printed = [output.stdout, output.stderr].concat();
    Ok(String::from_utf8_lossy(&printed).into_owned())
}

/// Runs a script of Yosys in the folder of the RTL.
pub fn yosys(script: &str) -> Result<()> {
    run(Command::new("yosys")
        .args(["-q", "-p", script])
        .current_dir(rtl()))
    .map(|_| ())
}

/// The first of some programs of the same use that runs.
pub fn first_that_runs(tools: &'static [&'static str]) -> Result<&'static str> {
    let runs = |tool: &&str| Command::new(tool).arg("--version").output().is_ok();
    let found = tools.iter().copied().find(runs);
    found.with_context(|| format!("{} not found", tools.join(" or ")))
}
