//! The command line: one file per command. Options are parsed in `args` and resolved to a [`crate::plan::Plan`] once,
//! in `resolve`; from there on no command sees them.
//!
//! Exit codes: 0, 1 for bad input (a file that cannot be read, drawn or written), 2 for bad usage (an option that is
//! missing, malformed or contradictory). Errors go to stderr, results to stdout or to the named files.

mod args;
mod bake;
mod compare;
mod demo;
mod drawing_args;
mod fit;
mod footprints;
mod frames;
mod info;
mod order_reuse;
mod machine_args;
mod maps;
mod model;
mod optimize;
mod photos;
mod output;
mod page;
mod profile;
mod render;
mod resolve;
mod say;
mod search_args;
mod shell;
mod stability;
mod verification_args;
mod summary;
mod sweep;
#[cfg(test)]
mod tests;
mod trace;
mod values;
mod vectors;
mod view_args;

pub use maps::{Map, in_colours};
pub use output::{create_folder, write};
pub use say::{explain, finish, print_result, printable};

use crate::plan::Prepared;
use anyhow::{Result, bail};
use args::{Cli, Command};
use clap::{CommandFactory, FromArgMatches};
use resolve::PlanRequest;
use say::printed;
use search_args::LIMITS;
use std::ffi::OsString;
use std::process::ExitCode;

/// Parses the command line, runs the command and turns failures into messages and exit codes.
pub fn run() -> ExitCode {
    crate::threads::deepen_global_stacks();
    run_from(std::env::args_os()).into()
}

/// The same for words that a program hands over, the first of them its name; the exit code.
pub fn run_from<T: Into<OsString> + Clone>(words: impl IntoIterator<Item = T>) -> u8 {
    finish(match parsed(words) {
        Ok(cli) => {
            if let Some(megabytes) = cli.memory {
                crate::memory::limit_to(megabytes.saturating_mul(1_000_000));
            }
            dispatch(cli.command)
        }
        // Help and version, which are results and must arrive.
        Err(shown) if !shown.use_stderr() => printed(shown.print()),
        Err(error) => {
            // The message is clap's, with its colours; that it cannot be printed changes nothing.
            let _ = error.print();
            return 2;
        }
    })
}

fn parsed<T: Into<OsString> + Clone>(
    words: impl IntoIterator<Item = T>,
) -> Result<Cli, clap::Error> {
    let mut words: Vec<OsString> = words.into_iter().map(Into::into).collect();
    let mut command = with_negative_numbers(Cli::command());
    command.build();
    take_earlier_name(&mut words, &command);
    Cli::from_arg_matches(&command.try_get_matches_from(words)?)
}

/// `explore` is the earlier name of two commands: a limit asks for the cheapest point, and without one the whole space
/// is swept.
fn take_earlier_name(words: &mut [OsString], command: &clap::Command) {
    // Behind the one option of all commands.
    let place = match words.get(1).map(|word| word.to_string_lossy()) {
        Some(word) if word == "--memory" => 3,
        Some(word) if word.starts_with("--memory=") => 2,
        _ => 1,
    };
    if words.get(place).is_none_or(|word| word != "explore") {
        return;
    }
    let optimize = command.find_subcommand("optimize");
    let groups = optimize
        .into_iter()
        .flat_map(|command| command.get_groups());
    let limits = groups.filter(|group| group.get_id() == LIMITS);
    let names: Vec<String> = limits
        .flat_map(|group| group.get_args())
        .map(|id| format!("--{}", id.as_str().replace('_', "-")))
        .collect();
    let is_limit = |word: &OsString| {
        let word = word.to_string_lossy();
        let name = word.split('=').next().unwrap_or_default();
        names.iter().any(|limit| limit == name)
    };
    let asks = words.iter().any(is_limit);
    words[place] = if asks { "optimize" } else { "sweep" }.into();
}

/// A negative number after an option is its value, of which the range can be said, and not an option of that name; so
/// are several.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let command = command.mut_args(|arg| {
        let is_option = !arg.is_positional() && arg.get_action().takes_values();
        let names = arg.get_value_names().unwrap_or_default();
        let are_several = names
            .iter()
            .any(|name| ["x,y,z", "az,el"].contains(&name.as_str()));
        arg.allow_negative_numbers(is_option && !are_several)
            .allow_hyphen_values(are_several)
    });
    command.mut_subcommands(with_negative_numbers)
}

/// The plan of the words that `compare` takes, with its scene loaded; what would be said on the way goes to stderr.
pub fn prepared(words: Vec<String>) -> Result<Prepared> {
    say::divert();
    let command = ["splatline", "compare", "--output", "."].map(str::to_owned);
    let Cli { command, .. } = parsed(command.into_iter().chain(words))?;
    let Some(Command::Compare(options)) = command else {
        bail!("name a scene");
    };
    let request = PlanRequest::drawing(&options.view, &options.drawing).on(&options.machine);
    request.prepare()
}

fn dispatch(command: Option<Command>) -> Result<()> {
    crate::input::forget();
    match command {
        None => demo::run(),
        Some(Command::Render(options)) => render::run(&options),
        Some(Command::Compare(options)) => compare::run(&options),
        Some(Command::Footprints(options)) => footprints::run(&options),
        Some(Command::Bake(options)) => bake::run(&options),
        Some(Command::Page(options)) => page::run(&options),
        Some(Command::Info(options)) => info::run(&options),
        Some(Command::Completions(options)) => shell::completions(&options, Cli::command()),
        Some(Command::Man(options)) => shell::man(&options, Cli::command()),
        Some(Command::Vectors { action }) => vectors::run(&action),
        Some(Command::Stability(options)) => stability::run(&options),
        Some(Command::Simulate(options)) => model::run(&options),
        Some(Command::Sweep(options)) => sweep::run(&options),
        Some(Command::Optimize(options)) => optimize::run(&options),
        Some(Command::Fit(options)) => fit::run(&options),
        Some(Command::Profile(options)) => profile::run(&options),
        Some(Command::Trace(options)) => trace::run(&options),
    }
}
