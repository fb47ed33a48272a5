//! `splatline completions` and `splatline man`: made from the options themselves, so that they cannot fall behind.

use super::output::{self, create_folder};
use super::say::print_result;
use anyhow::Result;
use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct CompletionsOptions {
    /// Whose language: bash, zsh, fish, elvish or powershell
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: Shell,
}

#[derive(Debug, Args)]
pub struct ManOptions {
    /// Folder to write the pages into
    #[arg(short, long, value_name = "dir")]
    pub output: PathBuf,
}

/// Prints the script that a shell completes the command by.
pub fn completions(options: &CompletionsOptions, mut command: Command) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut command, "splatline", &mut script);
    print_result(&String::from_utf8_lossy(&script))
}

/// Writes a page for the program and one for each command.
pub fn man(options: &ManOptions, mut command: Command) -> Result<()> {
    create_folder(&options.output)?;
    command.build();
    let pages = std::iter::once(command.clone()).chain(command.get_subcommands().cloned());
    for page in pages.filter(|page| !page.is_hide_set()) {
        let name = match page.get_name() {
            "splatline" => "splatline".to_owned(),
            command => format!("splatline-{command}"),
        };
        let mut text = Vec::new();
        Man::new(page).title(name.clone()).render(&mut text)?;
        output::write(&options.output.join(format!("{name}.1")), text)?;
    }
    print_result(&format!(
        "{}\n",
        options.output.join("splatline.1").display()
    ))
}
