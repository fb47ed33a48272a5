//! Exhibits of systems 5 and 8: sheet buffers and the deep alpha channel.

mod alpha;
mod plot;
mod sheets;

use super::Exhibit;
use splatline_sim::design::DesignChoice;
use std::path::Path;

/// Names of the groups of exhibits, in the order in which they are shown.
pub const NAMES: [&str; 2] = ["alpha", "sheets"];

/// What a group shows, and the files that its captions point to: name and text.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// For the page.
    pub exhibits: Vec<Exhibit>,
    /// Beside the page.
    pub files: Vec<(&'static str, String)>,
}

/// One group by its name of [`NAMES`]; nothing for another name. Takes about half a minute.
///
/// `data` is the folder that holds `volumes/aneurism.nhdr`; a missing volume is named in the exhibit's caption.
pub fn some(data: &Path, name: &str) -> Group {
    match name {
        "alpha" => alpha::group(data),
        "sheets" => Group {
            exhibits: vec![sheets::exhibit(data)],
            files: Vec::new(),
        },
        _ => Group::default(),
    }
}

fn exhibit(name: &str, equation: &'static str, caption: String) -> Exhibit {
    Exhibit {
        name: name.to_owned(),
        equation,
        caption,
        pictures: Vec::new(),
        numbers: Vec::new(),
    }
}

fn standard24() -> DesignChoice {
    DesignChoice::named("standard24").unwrap_or_else(|| unreachable!("a named design"))
}
