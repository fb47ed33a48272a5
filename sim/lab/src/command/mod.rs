//! The lab's commands: `gallery`, `results` and `lines`.

mod gallery;
pub mod options;
mod results;

use clap::Parser;
use options::{Lab, LabCommand};
use splatline_lab::results::lines::compared;
use splatline_sim::cli::{Failure, finish, print_result};
use std::process::ExitCode;

/// Parses the command line, runs the command and turns failures into messages and exit codes.
pub fn run() -> ExitCode {
    finish(match Lab::parse().command {
        LabCommand::Gallery(options) => gallery::run(&options),
        LabCommand::Results(options) => results::run(&options),
        LabCommand::Lines(options) => compared(&options.before)
            .map_err(Failure::from)
            .and_then(|table| print_result(&table)),
    })
}
