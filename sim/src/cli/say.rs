//! How a command ends and what it says: results to stdout, all else to stderr, failures as exit codes.

use anyhow::{Context, Error, Result};
use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Stdout holds a file (`-o -`): what is said goes to stderr.
static DIVERTED: AtomicBool = AtomicBool::new(false);

/// Options that make no sense together; exit code 2. All other errors are those of a file or its contents: exit code 1.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct UsageError(pub String);

/// Says that options make no sense together.
pub fn usage(message: impl Into<String>) -> Error {
    UsageError(message.into()).into()
}

/// The exit code of a command that has ended, its failure told on stderr.
pub fn finish(outcome: Result<()>) -> u8 {
    let Err(error) = outcome else {
        return 0;
    };
    let message = shortened(&explain(&error));
    if error.is::<UsageError>() {
        print_error(&format!(
            "error: {message}\n\nFor more information, try '--help'.\n"
        ));
        return 2;
    }
    print_error(&format!("error: {message}\n"));
    1
}

/// The error and its causes, each said once: some errors already quote their cause.
pub fn explain(error: &Error) -> String {
    error
        .chain()
        .map(ToString::to_string)
        .fold(String::new(), |said, cause| {
            if said.is_empty() {
                cause
            } else if said.contains(&cause) {
                said
            } else {
                format!("{said}: {cause}")
            }
        })
}

/// Longest line of an error in characters, and most lines: some quote a line of the file, which may be all of it.
const LONGEST: usize = 2000;
const MOST_LINES: usize = 40;

fn shortened(text: &str) -> String {
    let lines = text.lines().take(MOST_LINES).map(|line| {
        let mut short: String = line.chars().take(LONGEST).collect();
        if short.len() < line.len() {
            short += " ...";
        }
        short
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Without the codes that move a terminal's cursor or colour its text: names come from files of strangers.
pub fn printable(text: &str) -> String {
    let shown = |c: char| {
        if c.is_control() && !matches!(c, '\n' | '\t') {
            '\u{fffd}'
        } else {
            c
        }
    };
    text.chars().map(shown).collect()
}

/// From now on stdout is for a file alone.
pub fn divert() {
    DIVERTED.store(true, Ordering::Relaxed);
}

/// Prints a result.
pub fn print_result(text: &str) -> Result<()> {
    if DIVERTED.load(Ordering::Relaxed) {
        print_error(text);
        return Ok(());
    }
    printed(std::io::stdout().write_all(printable(text).as_bytes()))
}

/// What became of a result: a reader that has gone away (`splatline ... | head`) is no error, a full disk is one.
pub fn printed(written: std::io::Result<()>) -> Result<()> {
    // Flushed here: what is still buffered when the process ends fails unseen.
    match written.and_then(|()| std::io::stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to the standard output")
        }
        _ => Ok(()),
    }
}

/// Warnings to stderr, one line each.
pub fn warn(lines: &[String]) {
    for line in lines {
        print_error(&format!("warning: {line}\n"));
    }
}

/// Prints to stderr; if even that fails, nobody is left to tell.
pub fn print_error(text: &str) {
    let _ = std::io::stderr().write_all(printable(text).as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_gets_text_and_no_codes() {
        assert_eq!(printable("a\tb\n"), "a\tb\n");
        let hostile = "\u{1b}[2J\u{1b}]0;owned\u{7}\r\u{9b}31m";
        assert!(!printable(hostile).contains(|c: char| c.is_control()));
    }

    #[test]
    fn an_error_is_no_copy_of_the_file() {
        let nested = format!("line 1\n{}\n{}", "[".repeat(100_000), " ^\n".repeat(1000));
        let short = shortened(&nested);
        assert!(
            short.len() < 3000 && short.starts_with("line 1\n[["),
            "{}",
            short.len()
        );
        assert!(short.lines().nth(1).unwrap().ends_with("[ ..."));
        assert_eq!(shortened("as it is"), "as it is");
    }
}
