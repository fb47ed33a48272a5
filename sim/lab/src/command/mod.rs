//! The lab's commands: `gallery` and `results`.

mod gallery;
mod options;
mod results;

use clap::Parser;
use options::{Command, Lab};
use std::process::ExitCode;

/// Parses the command line, runs the command and turns failures into messages and exit codes.
pub fn run() -> ExitCode {
    splatline_sim::cli::finish(match Lab::parse().command {
        Command::Gallery(options) => gallery::run(&options),
        Command::Results(options) => results::run(&options),
    })
}
