//! What can be wrong with a scene: every message names the file, the field and the fix.

use std::fmt::Display;

/// A scene that could not be loaded.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct LoadError {
    /// The file as the caller named it.
    pub file: String,
    /// What is wrong with it.
    #[source]
    pub problem: Problem,
}

impl LoadError {
    /// What turns a problem into an error about `file`.
    pub(crate) fn about(file: impl Display) -> impl FnOnce(Problem) -> LoadError {
        let file = file.to_string();
        |problem| LoadError { file, problem }
    }
}

/// Why a file is refused: the field, what was found there, and what to do, in a sentence.
pub type Problem = anyhow::Error;

/// What the system says of a file.
pub(crate) fn unreadable(error: std::io::Error) -> Problem {
    anyhow::anyhow!("cannot be read: {error}")
}

/// The problem of a format whose feature was not built.
#[allow(dead_code)] // With all features there is none.
pub(crate) fn without(feature: &str) -> Problem {
    anyhow::anyhow!(
        ".{feature}: this program was built without its reader; \
         build it with `cargo build --features {feature}` or convert the file"
    )
}

/// What a message may show of a file: no control characters, and not much.
pub(crate) fn shorten(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(60).collect()
}
