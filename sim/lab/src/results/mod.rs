//! The measurements that the project stands by, as pages of `docs/results`.
//!
//! Each page is computed afresh from the scenes and carries the command that printed it; no figure is copied by hand.
//!
//! | page | question |
//! |---|---|
//! | [`accuracy`] | How far is each design from the float reference on real scenes and on the deep stack? |
//! | [`colour`] | How far are view-dependent colours in fixed point from double precision? |
//! | [`formats`] | How far is a scene from itself in another format? |
//! | [`golden`] | How far are both engines from data of independent origin? |
//! | [`packet`] | Where does every field of the footprint packet lie? |
//! | [`widths`] | What does a width cost, stage by stage, and what do floating-point formats? |
//! | [`systems`] | Where is each system of the papers, and how far is it from its float counterpart? |

pub mod accuracy;
pub mod check;
pub mod colour;
pub mod formats;
pub mod golden;
pub mod lines;
pub mod packet;
pub mod picture;
pub mod systems;
pub mod views;
pub mod widths;

use std::fmt::Write;

/// The command that regenerates every page.
pub const COMMAND: &str = "cargo run --release -p splatline-lab -- results";

/// A page of results in Markdown.
#[derive(Clone, Debug, PartialEq)]
pub struct ResultPage {
    /// File name.
    pub file: &'static str,
    /// Its text.
    pub text: String,
}

/// A Markdown table: the first column is text, all others are aligned as numbers.
pub fn table(headings: &[&str], rows: &[Vec<String>]) -> String {
    let mut text = format!(
        "| {} |\n|---|{}\n",
        headings.join(" | "),
        "---:|".repeat(headings.len() - 1)
    );
    for row in rows {
        let _ = writeln!(text, "| {} |", row.join(" | "));
    }
    text
}

/// A page's first lines.
fn opening(title: &str) -> String {
    format!("# {title}\n\nPrinted by `{COMMAND}`; do not edit.\n\n")
}

/// `met` or `MISSED`.
fn verdict(met: bool) -> String {
    if met { "met" } else { "MISSED" }.to_owned()
}
