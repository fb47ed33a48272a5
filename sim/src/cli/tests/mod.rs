//! The command line from outside: options, then commands.

mod commands;
mod options;
mod messages;

use super::args::*;
use super::say::explain;
use super::values::*;
use super::*;
use crate::picture::{Depth, Picture};
use crate::plan::{Engine, VOLUMES_ALONE};
use crate::report::Report;
use crate::rules::Compositing;
use clap::error::ErrorKind;
use std::path::Path;

fn parse(line: &str) -> Result<Cli, clap::Error> {
    super::parsed(std::iter::once("splatline").chain(line.split_whitespace()))
}

fn run_line(line: &str) -> Result<(), Failure> {
    dispatch(parse(line).unwrap().command)
}

fn read_json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn read_report(path: &Path) -> Report {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn a_negative_number_is_a_value_of_every_option() {
    let mut whole = Cli::command();
    whole.build();
    for command in whole.get_subcommands() {
        // A value behind `=` alone belongs to its option whatever it is.
        let options = command
            .get_opts()
            .filter(|option| !option.is_require_equals_set());
        for long in options.filter_map(|option| option.get_long()) {
            let line = format!("{} --{long} -7", command.get_name());
            if let Err(error) = parse(&line) {
                assert_ne!(error.kind(), ErrorKind::UnknownArgument, "{line}: {error}");
            }
        }
    }
}
