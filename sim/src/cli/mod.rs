//! The command line: one file per command, the options in `args`, the engines behind `engines`.
//!
//! Exit codes: 0, 1 for bad input (a file that cannot be read, drawn or written), 2 for bad usage (an option that is
//! missing, malformed or contradictory). Errors go to stderr, results to stdout or to the named files.

mod args;
mod compare;
mod demo;
mod drawing;
mod engines;
mod explore;
mod fit;
mod footprints;
mod info;
mod machine_args;
mod model;
mod needs;
mod output;
mod page;
mod progress;
mod render;
mod setup;
mod shell;
mod stability;
mod study_args;
mod surface;
mod sweep;
#[cfg(test)]
mod tests;
mod trace;
mod vectors;
mod view_args;

pub use args::Engine;
pub use compare::{all_entries, create_folder};
pub use engines::on_threads;
pub use output::write;
pub use progress::Progress;
pub use setup::{View, threads};
pub use sweep::{Entry, Manner, run as draw_all};

use args::{Cli, Command};
use clap::Parser;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// Stdout holds a file (`-o -`): what is said goes to stderr.
static DIVERTED: AtomicBool = AtomicBool::new(false);

/// Why a command failed, which decides the exit code.
#[derive(Debug)]
pub enum Failure {
    /// The options make no sense together; exit code 2.
    Usage(String),
    /// A file or its contents; exit code 1.
    Input(anyhow::Error),
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Failure::Input(error.into())
    }
}

/// Parses the command line, runs the command and turns failures into messages and exit codes.
pub fn run() -> ExitCode {
    finish(match Cli::try_parse() {
        Ok(cli) => dispatch(cli.command),
        // Help and version, which are results and must arrive.
        Err(shown) if !shown.use_stderr() => printed(shown.print()),
        Err(error) => error.exit(),
    })
}

/// The exit code of a command that has ended, its failure told on stderr.
pub fn finish(outcome: Result<(), Failure>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Input(error)) => {
            complain(&format!("error: {}\n", explain(&error)));
            ExitCode::from(1)
        }
        Err(Failure::Usage(message)) => {
            complain(&format!(
                "error: {message}\n\nFor more information, try '--help'.\n"
            ));
            ExitCode::from(2)
        }
    }
}

fn dispatch(command: Option<Command>) -> Result<(), Failure> {
    match command {
        None => demo::run(),
        Some(Command::Render(options)) => render::run(&options),
        Some(Command::Compare(options)) => compare::run(&options),
        Some(Command::Footprints(options)) => footprints::run(&options),
        Some(Command::Page(options)) => page::run(&options),
        Some(Command::Info(options)) => info::run(&options),
        Some(Command::Completions(options)) => shell::completions(&options),
        Some(Command::Man(options)) => shell::man(&options),
        Some(Command::Vectors { action }) => vectors::run(&action),
        Some(Command::Stability(options)) => stability::run(&options),
        Some(Command::Model(options)) => model::run(&options),
        Some(Command::Explore(options)) => explore::run(&options),
        Some(Command::Merge(options)) => explore::merge(&options),
        Some(Command::Fit(options)) => fit::run(&options),
        Some(Command::Needs(options)) => needs::run(&options),
        Some(Command::Trace(options)) => trace::run(&options),
    }
}

/// The error and its causes, each said once: some errors already quote their cause.
fn explain(error: &anyhow::Error) -> String {
    error
        .chain()
        .map(ToString::to_string)
        .fold(String::new(), |said, cause| {
            if said.is_empty() {
                cause
            } else if said.contains(&cause) {
                said
            } else {
                format!("{said}: {cause}")
            }
        })
}

/// From now on stdout is for a file alone.
fn divert() {
    DIVERTED.store(true, Ordering::Relaxed);
}

/// Prints a result.
pub fn say(text: &str) -> Result<(), Failure> {
    if DIVERTED.load(Ordering::Relaxed) {
        complain(text);
        return Ok(());
    }
    printed(std::io::stdout().write_all(text.as_bytes()))
}

/// What became of a result: a reader that has gone away (`splatline ... | head`) is no error, a full disk is one.
fn printed(written: std::io::Result<()>) -> Result<(), Failure> {
    // Flushed here: what is still buffered when the process ends fails unseen.
    match written.and_then(|()| std::io::stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(anyhow::Error::new(error)
            .context("cannot write to the standard output")
            .into()),
        _ => Ok(()),
    }
}

/// Warnings to stderr, one line each.
fn warn(lines: &[String]) {
    for line in lines {
        complain(&format!("warning: {line}\n"));
    }
}

/// Prints to stderr; if even that fails, nobody is left to tell.
pub fn complain(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}
