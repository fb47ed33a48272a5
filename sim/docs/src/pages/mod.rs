//! The pages of `docs/results`: each is computed afresh from the scenes by the functions that the commands run, and
//! laid out.
//!
//! A page shows the rows that matter and has all of them as CSV beside it. No figure is copied by hand, except on the
//! page of times, which need a quiet machine.

pub mod accuracy;
pub mod check;
pub mod colour;
pub mod formats;
pub mod golden;
pub mod machines;
pub mod packet;
pub mod picture;
pub mod speed;
pub mod systems;
pub mod widths;

use anyhow::Result;
use splatline_sim::cli::write;
use std::path::Path;

/// The command that prints every page.
pub const COMMAND: &str = "cargo run --release -p splatline-docs -- results";

/// A page in Markdown, and the files that it shows or refers to.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Name and text of each, the page itself first.
    pub files: Vec<(String, String)>,
}

impl Page {
    /// A page with its heading, and nothing below it yet.
    pub fn new(name: &str, title: &str) -> Page {
        let text = format!("# {title}\n\nPrinted by `{COMMAND} --only {name}`; do not edit.\n");
        Page {
            files: vec![(format!("{name}.md"), text)],
        }
    }

    /// A paragraph, a table or a heading.
    pub fn add(&mut self, text: impl AsRef<str>) {
        let page = &mut self.files[0].1;
        page.push('\n');
        page.push_str(text.as_ref().trim_end());
        page.push('\n');
    }

    pub fn beside(&mut self, name: &str, text: String) {
        self.files.push((name.to_owned(), text));
    }

    pub fn write(&self, folder: &Path) -> Result<()> {
        for (name, text) in &self.files {
            write(&folder.join(name), text)?;
        }
        Ok(())
    }
}
