//! One record's way through all formulas, told by the Python model of `sim/golden`, which is part of this program.
//!
//! The model and not the kernel: it has a function for every formula of docs/specification.md and can name each of
//! them.

use super::files::refused;
use crate::input::Refused;
use std::io::{self, Write};
use std::path::Path;
use std::process::{Command, Stdio};

/// The model's files, each after those that it uses.
const MODULES: [(&str, &str); 13] = [
    ("arithmetic", include_str!("../../golden/arithmetic.py")),
    ("setup", include_str!("../../golden/setup.py")),
    ("tables", include_str!("../../golden/tables.py")),
    ("rows", include_str!("../../golden/rows.py")),
    ("pixels", include_str!("../../golden/pixels.py")),
    ("surface", include_str!("../../golden/surface.py")),
    ("harmonics", include_str!("../../golden/harmonics.py")),
    ("deep", include_str!("../../golden/deep.py")),
    ("points", include_str!("../../golden/points.py")),
    ("spheres", include_str!("../../golden/spheres.py")),
    ("systems", include_str!("../../golden/systems.py")),
    ("vectors", include_str!("../../golden/vectors.py")),
    ("explain", include_str!("../../golden/explain.py")),
];

/// Prints the way of `record`, which is `STAGE:NUMBER`, to the standard output.
pub fn explain(folder: &Path, record: &str) -> Result<(), Refused> {
    let python = |error: io::Error| {
        Refused(format!(
            "python3: {error}; install Python 3, which explains"
        ))
    };
    let mut child = Command::new("python3")
        .arg("-")
        .arg(folder)
        .arg(record)
        .stdin(Stdio::piped())
        .spawn()
        .map_err(python)?;
    if let Some(mut input) = child.stdin.take() {
        input.write_all(program().as_bytes()).map_err(python)?;
    }
    let status = child.wait().map_err(python)?;
    if status.success() {
        return Ok(());
    }
    Err(refused(folder, format!("'{record}' is not explained")))
}

/// The model as one text that needs no files.
fn program() -> String {
    let mut text = String::from("import sys, types\n");
    for (name, source) in MODULES {
        // A string of JSON is one of Python.
        let source = serde_json::Value::from(source);
        text += &format!(
            "module = sys.modules['{name}'] = types.ModuleType('{name}')\n\
             module.__file__ = '{name}.py'\n\
             exec(compile({source}, '{name}.py', 'exec'), vars(module))\n"
        );
    }
    text + "module.main(sys.argv[1:])\n"
}
