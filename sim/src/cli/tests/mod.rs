//! The command line from outside: options, then commands.

mod commands;
mod options;
mod messages;

use super::args::*;
use super::say::UsageError;
use super::say::explain;
use super::*;
use crate::picture::{Depth, Picture};
use crate::plan::{Engine, VOLUMES_ALONE};
use crate::report::Report;
use crate::rules::Compositing;
use clap::error::ErrorKind;
use std::path::{Path, PathBuf};

fn parse(line: &str) -> Result<Cli, clap::Error> {
    super::parsed(std::iter::once("splatline").chain(line.split_whitespace()))
}

fn run_line(line: &str) -> anyhow::Result<()> {
    dispatch(parse(line).unwrap().command)
}

/// Heights of a surface.
const HEIGHTS: &str = "0,0.1,0.3\n0,0.2,0.2\n0.1,0.1,0\n";

/// A folder that goes with the test: `./` in a line is it.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Folder {
        Folder(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    fn read(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.bytes(name)).unwrap()
    }

    fn report(&self, name: &str) -> Report {
        serde_json::from_slice(&self.bytes(name)).unwrap()
    }

    fn attempt(&self, line: &str) -> anyhow::Result<()> {
        run_line(&line.replace("./", &format!("{}/", self.0.path().display())))
    }

    fn run(&self, line: &str) {
        self.attempt(line).unwrap();
    }

    /// The message about what is refused for its options.
    fn usage(&self, line: &str) -> String {
        match self.attempt(line) {
            Err(error) if error.is::<UsageError>() => error.to_string(),
            other => panic!("{line}: {other:?}"),
        }
    }
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
