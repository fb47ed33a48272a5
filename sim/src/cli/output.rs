//! Where results go: checked before the work, so that no run of an hour ends in a refused name, and no file that was
//! read is overwritten. `atomic::write`, through which every file goes, refuses the latter once more.
//!
//! `-` is stdout. What would have been said there goes to stderr then, so that a pipe holds the result alone.

use super::say::{divert, print_error, printed, usage};
use crate::{atomic, input};
use anyhow::{Context, Result, anyhow, ensure};
use serde::Serialize;
use std::fmt::Display;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The name of stdout, and of stdin where a file is read.
pub const STREAM: &str = "-";

/// The file that says that a folder holds results, and the command that wrote them.
const RECORDS: [(&str, &str); 6] = [
    ("report.json", "compare"),
    ("frames.json", "compare --camera-path"),
    ("photos.json", "compare --photos"),
    ("timing.json", MACHINES[0]),
    ("answer.json", MACHINES[1]),
    ("sweep.json", "sweep"),
];

/// A result of two commands, and these.
const MACHINE: &str = "machine.toml";
const MACHINES: [&str; 2] = ["simulate", "optimize"];

/// Is this stdout (or stdin)?
pub fn is_stream(path: &Path) -> bool {
    path == Path::new(STREAM)
}

/// The files that a command is going to write, and a folder that is for its results alone.
#[derive(Default)]
pub struct Outputs {
    files: Vec<PathBuf>,
    folder: Option<PathBuf>,
}

impl Outputs {
    /// With a file of one of these formats, or stdout, if one is asked for.
    pub fn file(mut self, path: Option<&Path>, extensions: &[&str]) -> Result<Outputs> {
        let Some(path) = path else {
            return Ok(self);
        };
        if self.files.iter().any(|other| other == path) {
            let shown = path.display();
            let message = format!("two results cannot both be written to '{shown}'");
            return Err(usage(message));
        }
        if is_stream(path) {
            self.files.push(path.to_owned());
            divert();
            return Ok(self);
        }
        self.files([path.to_owned()].into_iter(), extensions)
    }

    /// With numbered files of one of these formats, which differ from each other and from JSON.
    pub fn files(
        mut self,
        paths: impl Iterator<Item = PathBuf>,
        extensions: &[&str],
    ) -> Result<Outputs> {
        for path in paths {
            check_folder_of(&path)?;
            check_extension(&path, extensions)?;
            self.files.push(path);
        }
        Ok(self)
    }

    /// With a JSON file, if one is asked for.
    pub fn json(self, path: Option<&PathBuf>) -> Result<Outputs> {
        self.file(path.map(PathBuf::as_path), &["json"])
    }

    /// With these files of a folder, which is made if need be, if one is asked for.
    pub fn folder(mut self, folder: Option<&Path>, files: &[&str]) -> Result<Outputs> {
        let Some(folder) = folder else {
            return Ok(self);
        };
        create_folder(folder)?;
        self.folder = Some(folder.to_owned());
        self.files
            .extend(files.iter().map(|file| folder.join(file)));
        Ok(self)
    }

    /// Fails if a file that the command has read, or a result of another command, would be replaced; tells of results
    /// beside which its own will lie. Asked when everything is read, before the work.
    pub fn spare_inputs(&self) -> Result<()> {
        let outputs = self.files.iter().filter(|path| !is_stream(path));
        for output in outputs {
            atomic::refuse_input(output).map_err(|refused| {
                usage(format!("cannot write '{}': {refused}", output.display()))
            })?;
        }
        match &self.folder {
            Some(folder) => self.spare_results(folder),
            None => Ok(()),
        }
    }

    /// Fails if another command's result in the folder would be replaced; tells of those that stay.
    fn spare_results(&self, folder: &Path) -> Result<()> {
        let writes = |file: &str| self.files.contains(&folder.join(file));
        let there = |file: &str| folder.join(file).is_file();
        let others = RECORDS
            .iter()
            .filter(|(record, _)| there(record) && !writes(record));
        let commands: Vec<&str> = others.map(|(_, command)| *command).collect();
        let shown = folder.display();
        let replaced = commands.iter().find(|command| MACHINES.contains(command));
        if let Some(command) = replaced.filter(|_| writes(MACHINE) && there(MACHINE)) {
            return Err(usage(format!(
                "cannot write to '{shown}': '{MACHINE}' there is a result of `{command}` and would be replaced; name another folder"
            )));
        }
        for command in commands {
            print_error(&format!(
                "note: '{shown}' also holds results of `{command}`, which stay as they are\n"
            ));
        }
        Ok(())
    }
}

fn check_extension(output: &Path, extensions: &[&str]) -> Result<()> {
    // A device (/dev/null, /dev/stdout) has no extension to go by.
    let is_device = std::fs::metadata(output).is_ok_and(|found| !found.is_file());
    let extension = output.extension().unwrap_or_default().to_string_lossy();
    let known = |known: &&str| known.eq_ignore_ascii_case(&extension);
    if is_device || extensions.iter().any(known) {
        return Ok(());
    }
    let found = if extension.is_empty() {
        "it has no extension".to_owned()
    } else {
        format!("'.{extension}' is not written")
    };
    let named = extensions.iter().filter(|name| !name.is_empty());
    let expected = named.map(|name| format!(".{name}"));
    Err(usage(format!(
        "cannot write '{}': {found}; end the name in {}, or write to - (stdout)",
        output.display(),
        expected.collect::<Vec<_>>().join(" or ")
    )))
}

/// Fails before the work and not after it if the output's folder does not exist.
fn check_folder_of(file: &Path) -> Result<()> {
    ensure!(
        !file.is_dir(),
        "cannot write '{}': it is a folder; name a file in it",
        file.display()
    );
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            let (file, folder) = (file.display(), folder.display());
            Err(anyhow!(
                "cannot write '{file}': the folder '{folder}' does not exist"
            ))
        }
        _ => Ok(()),
    }
}

/// Writes bytes whole, or to stdout; the error names the file.
pub fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<()> {
    if is_stream(path) {
        return printed(std::io::stdout().write_all(bytes.as_ref()));
    }
    atomic::write(path, bytes.as_ref())
        .with_context(|| format!("cannot write '{}'", path.display()))
}

/// Writes a record as JSON.
pub fn write_json(path: &Path, record: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(record)
        .with_context(|| format!("cannot write '{}'", path.display()))?;
    write(path, text + "\n")
}

/// The same if a file is asked for.
pub fn write_json_if(path: Option<&PathBuf>, record: &impl Serialize) -> Result<()> {
    path.map_or(Ok(()), |path| write_json(path, record))
}

/// A text file, or stdin.
pub fn read_text(path: &Path) -> Result<String> {
    let text = if is_stream(path) {
        input::text_of(std::io::stdin(), input::TABLE)
    } else {
        input::text(path, input::TABLE)
    };
    text.with_context(|| format!("cannot read '{}'", path.display()))
}

/// A file of settings.
pub fn read_settings(path: &Path) -> Result<String> {
    input::text(path, input::SETTINGS).with_context(|| format!("cannot read '{}'", path.display()))
}

/// What a file of settings says, by a reader that is given its name and its text.
pub fn settings<T, E: Display>(
    path: &Path,
    read: impl Fn(&str, &str) -> Result<T, E>,
) -> Result<T> {
    let found = read(&path.display().to_string(), &read_settings(path)?);
    found.map_err(|problem| anyhow!("{problem}"))
}

/// The folder for results, made if need be.
pub fn create_folder(folder: &Path) -> Result<()> {
    let shown = folder.display();
    ensure!(
        !folder.exists() || folder.is_dir(),
        "cannot write to '{shown}': it is a file; name a folder"
    );
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot create the folder '{}'", folder.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::say::UsageError;

    /// The message about a file that may not be written.
    fn refused(outputs: Result<Outputs>) -> String {
        match outputs.unwrap().spare_inputs() {
            Err(error) if error.is::<UsageError>() => error.to_string(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn an_input_is_never_an_output_by_whatever_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("x.ply"), "scene").unwrap();
        std::fs::create_dir(path("sub")).unwrap();
        input::text(&path("x.ply"), input::TABLE).unwrap();
        let mut names = vec![path("x.ply"), path("sub/../x.ply")];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(path("x.ply"), path("soft.png")).unwrap();
            std::fs::hard_link(path("x.ply"), path("hard.png")).unwrap();
            names.extend([path("soft.png"), path("hard.png")]);
        }
        let file = |name: &Path| Outputs::default().file(Some(name), &["png", "ply"]);
        for name in names {
            let message = refused(file(&name));
            assert!(message.contains("would be destroyed"), "{message}");
        }
        assert!(file(&path("y.png")).unwrap().spare_inputs().is_ok());
        let member = Outputs::default().folder(Some(folder.path()), &["x.ply"]);
        assert!(refused(member).contains("x.ply"));
    }
}
