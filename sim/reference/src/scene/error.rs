//! What can be wrong with a scene: every message names the file, the field and the fix.

use crate::memory::TooLarge;
use std::fmt::Display;
use std::io;

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

/// Why a file is refused: the field, what was found there, and what to do, in a sentence.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Problem(pub(crate) String);

impl From<TooLarge> for Problem {
    fn from(error: TooLarge) -> Problem {
        Problem(error.to_string())
    }
}

impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Problem {
        Problem(format!("cannot be read: {error}"))
    }
}

impl Problem {
    /// A malformed field, what was found there and what to do about it.
    pub(crate) fn malformed(field: impl Display, found: impl Display, fix: impl Display) -> Self {
        Problem(format!("{field}: {found}; {fix}"))
    }

    /// A format whose feature was not built.
    #[allow(dead_code)] // With all features there is none.
    pub(crate) fn without(feature: &'static str) -> Self {
        Problem(format!(
            ".{feature}: this program was built without its reader; build it with `cargo build --features {feature}` or convert the file"
        ))
    }

    /// The same problem as an error about `file`.
    pub(crate) fn of(self, file: impl Into<String>) -> LoadError {
        LoadError {
            file: file.into(),
            problem: self,
        }
    }
}

/// What a message may show of a file: no control characters, and not much.
pub(crate) fn shorten(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(60).collect()
}
