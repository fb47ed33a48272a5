//! `splatline-lab`: prints the documentation's galleries and tables.

mod command;

use std::process::ExitCode;

fn main() -> ExitCode {
    command::run()
}
