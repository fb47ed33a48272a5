//! The `splatline` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    splatline_sim::cli::run()
}
