//! The command line from inside: its options, and what commands tell while they work. `sim/tests` calls it from
//! outside.

mod options;
mod messages;

use super::args::*;
use super::say::explain;
use super::*;
use crate::picture::Depth;
use crate::plan::Engine;
use crate::rules::Compositing;
use clap::error::ErrorKind;

fn parse(line: &str) -> Result<Cli, clap::Error> {
    super::parsed(std::iter::once("splatline").chain(line.split_whitespace()))
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
