//! The eighteen systems of the four papers: what they are and where they live.

use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// A system of the papers.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct System {
    /// 1 to 18.
    pub number: u8,
    /// What it is.
    pub name: String,
    /// Paper and section or equation.
    pub source: String,
    /// Files that hold it: of the kernel, or of the host where they begin with `sim`.
    pub modules: String,
    /// Its counterpart in double precision, in `sim/reference/src/engines`.
    pub reference: String,
}

/// All of them, by number.
pub static SYSTEMS: LazyLock<Vec<System>> = LazyLock::new(|| {
    let table = csv::Reader::from_reader(include_bytes!("systems.csv").as_slice());
    let systems: csv::Result<_> = table.into_deserialize().collect();
    systems.expect("systems.csv is a table of systems; a test reads it")
});

/// Whether a system is exercised, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SystemVerdict {
    /// 1 to 18.
    pub number: u8,
    /// What it is.
    pub name: String,
    /// Is it exercised?
    pub used: bool,
    /// Why, or what it lacks.
    pub reason: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A name without a folder lies in the folder of the name before: `setup/project, jacobian` are two of `setup`.
    #[test]
    fn files_of_systems_exist() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let exists = |path: &std::path::Path| path.is_dir() || path.with_extension("rs").exists();
        for system in SYSTEMS.iter() {
            for group in system.modules.split("; ") {
                let mut folder = root.join("src");
                for name in group.split(", ") {
                    let file = if name.starts_with("sim/") {
                        root.join(name)
                    } else if name.contains('/') {
                        root.join("src").join(name)
                    } else {
                        folder.join(name)
                    };
                    assert!(exists(&file), "{}: {name}", system.number);
                    folder = file.parent().map_or(folder, |parent| parent.to_owned());
                }
            }
            for name in system.reference.split(", ") {
                let file = root.join("sim/reference/src/engines").join(name);
                assert!(exists(&file), "{}: {name}", system.number);
            }
        }
    }

    #[test]
    fn systems_are_numbered_in_order() {
        assert!(
            SYSTEMS
                .iter()
                .zip(1..)
                .all(|(system, number)| system.number == number)
        );
    }
}
