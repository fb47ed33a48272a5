//! Where results go: checked before the work, so that no run of an hour ends in a refused name, and no file that was read is
//! overwritten.
//!
//! `-` is stdout. What would have been said there goes to stderr then, so that a pipe holds the result alone.

use super::say::{Failure, divert, printed};
use super::values::DesignName;
use crate::input;
use anyhow::{Context, anyhow};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The name of stdout, and of stdin where a file is read.
pub const STREAM: &str = "-";

/// Is this stdout (or stdin)?
pub fn is_stream(path: &Path) -> bool {
    path == Path::new(STREAM)
}

/// Fails unless `output` can be written as a file of one of these formats without destroying one of the `inputs`.
pub fn check(output: &Path, extensions: &[&str], inputs: &[PathBuf]) -> Result<(), Failure> {
    if is_stream(output) {
        divert();
        return Ok(());
    }
    check_input(output, inputs)?;
    check_folder_of(output)?;
    check_extension(output, extensions)
}

/// Fails if one of these files in `folder` is one of the `inputs`.
pub fn check_folder(folder: &Path, files: &[&str], inputs: &[PathBuf]) -> Result<(), Failure> {
    files
        .iter()
        .try_for_each(|file| check_input(&folder.join(file), inputs))
}

fn check_input(output: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
    match inputs.iter().find(|input| is_same(input, output)) {
        Some(input) => Err(Failure::Usage(format!(
            "cannot write '{}': it is read as '{}' and would be destroyed; name another output",
            output.display(),
            input.display()
        ))),
        None => Ok(()),
    }
}

/// The same regular file, also by another name.
fn is_same(a: &Path, b: &Path) -> bool {
    let regular = |path: &Path| std::fs::metadata(path).is_ok_and(|found| found.is_file());
    regular(a) && regular(b) && (same_place(a, b) || same_inode(a, b))
}

fn same_place(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

#[cfg(unix)]
fn same_inode(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |path: &Path| std::fs::metadata(path).map(|found| (found.dev(), found.ino()));
    matches!((id(a), id(b)), (Ok(a), Ok(b)) if a == b)
}

#[cfg(not(unix))]
fn same_inode(_: &Path, _: &Path) -> bool {
    false
}

fn check_extension(output: &Path, extensions: &[&str]) -> Result<(), Failure> {
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
    Err(Failure::Usage(format!(
        "cannot write '{}': {found}; end the name in {}, or write to - (stdout)",
        output.display(),
        expected.collect::<Vec<_>>().join(" or ")
    )))
}

/// Fails before the work and not after it if the output's folder does not exist.
pub fn check_folder_of(file: &Path) -> Result<(), Failure> {
    if file.is_dir() {
        return Err(anyhow!(
            "cannot write '{}': it is a folder; name a file in it",
            file.display()
        )
        .into());
    }
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            let (file, folder) = (file.display(), folder.display());
            Err(anyhow!("cannot write '{file}': the folder '{folder}' does not exist").into())
        }
        _ => Ok(()),
    }
}

/// Writes bytes whole, or to stdout; the error names the file.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    if is_stream(path) {
        return printed(std::io::stdout().write_all(bytes));
    }
    crate::atomic::write(path, bytes)
        .with_context(|| format!("cannot write '{}'", path.display()))?;
    Ok(())
}

/// A text file, or stdin.
pub fn read_text(path: &Path) -> Result<String, Failure> {
    let text = if is_stream(path) {
        input::text_of(std::io::stdin(), input::TABLE)
    } else {
        input::text(path, input::TABLE)
    };
    Ok(text.with_context(|| format!("cannot read '{}'", path.display()))?)
}

/// A file of settings.
pub fn read_settings(path: &Path) -> Result<String, Failure> {
    Ok(input::text(path, input::SETTINGS)
        .with_context(|| format!("cannot read '{}'", path.display()))?)
}

/// The folder for results, made if need be.
pub fn create_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot create the folder '{}'", folder.display()))?;
    Ok(())
}

/// The files among these that are given.
pub fn files<'a>(given: impl IntoIterator<Item = Option<&'a PathBuf>>) -> Vec<PathBuf> {
    given.into_iter().flatten().cloned().collect()
}

/// A design's file, if it is one and no name.
pub fn design_file(design: &DesignName) -> Option<PathBuf> {
    design
        .0
        .ends_with(".toml")
        .then(|| PathBuf::from(&design.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(result: Result<(), Failure>) -> String {
        match result {
            Err(Failure::Usage(message)) => message,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn an_input_is_never_an_output_by_whatever_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("x.ply"), "scene").unwrap();
        std::fs::create_dir(path("sub")).unwrap();
        let inputs = [path("x.ply")];
        let mut names = vec![path("x.ply"), path("sub/../x.ply")];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(path("x.ply"), path("soft.png")).unwrap();
            std::fs::hard_link(path("x.ply"), path("hard.png")).unwrap();
            names.extend([path("soft.png"), path("hard.png")]);
        }
        for name in names {
            let message = refused(check(&name, &["png", "ply"], &inputs));
            assert!(message.contains("would be destroyed"), "{message}");
        }
        assert!(check(&path("y.png"), &["png"], &inputs).is_ok());
        assert!(refused(check_folder(folder.path(), &["x.ply"], &inputs)).contains("x.ply"));
    }

    #[test]
    fn only_what_is_written_may_be_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["a.jpg", "a.ppm", "a", "a.png.txt"] {
            let message = refused(check(&path(name), &["png", "npy"], &[]));
            assert!(
                message.contains("end the name in .png or .npy"),
                "{message}"
            );
        }
        assert!(check(&path("a.PNG"), &["png"], &[]).is_ok());
        #[cfg(unix)]
        assert!(check(Path::new("/dev/null"), &["png"], &[]).is_ok());
    }
}
