//! The command line from outside: options, then commands.

mod commands;
mod options;
mod messages;

use super::args::*;
use super::say::explain;
use super::values::*;
use super::*;
use crate::picture::{Depth, Picture};
use crate::plan::{Engine, NO_SURFACE_UNIT};
use crate::report::Report;
use crate::rules::Compositing;
use clap::error::ErrorKind;
use std::path::Path;

fn parse(line: &str) -> Result<Cli, clap::Error> {
    Cli::try_parse_from(std::iter::once("splatline").chain(line.split_whitespace()))
}

fn run_line(line: &str) -> Result<(), Failure> {
    dispatch(parse(line).unwrap().command)
}

fn read_report(path: &Path) -> Report {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}
