//! Texts from strangers: TOML, JSON and CSV files, read whole if they are files and not absurdly long.
//!
//! A pipe may never end and `/dev/zero` never does; a file of gigabytes under a name that promises a page of settings
//! is a mistake of the caller's. Both are refused with the number and the limit, before anything is read.
//!
//! What a command has read is remembered, so that none of its outputs replaces it: a scene may consist of many files,
//! which only its reader knows. Every reader reads on its command's thread, so each thread has a list of its own.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

thread_local! {
    static READ: RefCell<BTreeSet<PathBuf>> = const { RefCell::new(BTreeSet::new()) };
}

/// Remembers that this file was read.
pub fn note(path: &Path) {
    READ.with_borrow_mut(|read| read.insert(path.to_owned()));
}

/// The name by which this file was read on this thread: its own, another spelling of it, or that of a link to it.
pub fn read_as(path: &Path) -> Option<PathBuf> {
    if !path.is_file() {
        return None;
    }
    let same = |read: &&PathBuf| same_file::is_same_file(read, path).unwrap_or(false);
    READ.with_borrow(|all| all.iter().find(same).cloned())
}

/// Forgets what was read on this thread: another command begins.
pub fn forget() {
    READ.with_borrow_mut(BTreeSet::clear);
}

/// Most bytes of a file that people write: a camera, a machine, a space, a design, prices, a transfer function.
pub const SETTINGS: u64 = 1 << 20;
/// Most bytes of a file that programs write: tables of footprints and of sweeps, test vectors.
pub const TABLE: u64 = 1 << 30;

/// What is wrong with a file of settings, a table or one value of either: a sentence that names file, place, value and
/// what is allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Refused(pub String);

/// Line, counted from 1, in which a byte of a text lies.
pub fn line_at(text: &str, byte: usize) -> usize {
    let before = text.bytes().take(byte);
    1 + before.filter(|byte| *byte == b'\n').count()
}

/// Line, counted from 1, on which a text of TOML sets a key, which is named by its tables, its place in lists, and
/// itself; 1 if none does.
pub fn line_of(text: &str, keys: &[&str]) -> usize {
    let document = DeTable::parse(text).map(Spanned::into_inner);
    document.map_or(1, |table| line_in(&DeValue::Table(table), keys, text, 1))
}

fn line_in(value: &DeValue, keys: &[&str], text: &str, line: usize) -> usize {
    let [name, keys @ ..] = keys else {
        return line;
    };
    let found = match value {
        DeValue::Table(table) => table
            .get_key_value(*name)
            .map(|(key, value)| (line_at(text, key.span().start), value)),
        DeValue::Array(list) => {
            let place = name.parse().ok();
            place.and_then(|place: usize| Some((line, list.get(place)?)))
        }
        _ => None,
    };
    found.map_or(1, |(line, value)| {
        line_in(value.get_ref(), keys, text, line)
    })
}

/// The text of a regular file of at most `most` bytes.
pub fn text(path: &Path, most: u64) -> io::Result<String> {
    in_utf8(bytes(path, most)?)
}

/// The same of a file that the program wrote and goes on with, which it may replace.
pub fn own_text(path: &Path, most: u64) -> io::Result<String> {
    in_utf8(unnoted(path, most)?)
}

/// The text of a stream that its caller promises will end, of at most `most` bytes.
pub fn text_of(stream: impl Read, most: u64) -> io::Result<String> {
    let mut bytes = Vec::new();
    // One more tells a stream of just so many bytes from a longer one.
    stream
        .take(most.saturating_add(1))
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        Err(io::Error::new(
            io::ErrorKind::FileTooLarge,
            format!("longer than {most} bytes: is it the right one?"),
        ))
    } else {
        in_utf8(bytes)
    }
}

/// The bytes of a regular file of at most `most` bytes.
pub fn bytes(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let bytes = unnoted(path, most)?;
    note(path);
    Ok(bytes)
}

fn unnoted(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let refuse = |kind, message: String| Err(io::Error::new(kind, message));
    // Before it is opened: opening a pipe waits for its writer.
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() {
        let message = "not a regular file: name a file on disk (pipes and devices may never end)";
        return refuse(io::ErrorKind::InvalidInput, message.to_owned());
    }
    if metadata.len() > most {
        let bytes = metadata.len();
        return refuse(
            io::ErrorKind::FileTooLarge,
            format!("{bytes} bytes long, at most {most} are read: is it the right file?"),
        );
    }
    let mut bytes = Vec::new();
    // It may have grown since.
    File::open(path)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn in_utf8(bytes: Vec<u8>) -> io::Result<String> {
    String::from_utf8(bytes).map_err(|error| {
        let place = error.utf8_error().valid_up_to();
        let message = format!("not a text in UTF-8: byte {place} begins no character");
        io::Error::new(io::ErrorKind::InvalidData, message)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_within_the_limit_are_read_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        fs::write(&path, "ten bytes\n").unwrap();
        assert_eq!(text(&path, 10).unwrap(), "ten bytes\n");
        let message = |path: &Path, most| text(path, most).unwrap_err().to_string();
        assert!(message(&path, 9).contains("10 bytes long, at most 9"));
        assert!(message(folder.path(), 9).contains("not a regular file"));
        assert_eq!(text_of(&b"ten bytes\n"[..], 10).unwrap(), "ten bytes\n");
        let endless = text_of(io::repeat(b'a'), 9).unwrap_err().to_string();
        assert!(endless.contains("longer than 9 bytes"));
        fs::write(&path, b"ab\xff").unwrap();
        assert!(message(&path, 10).contains("byte 2"));
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused_without_waiting() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        for path in [&pipe, Path::new("/dev/zero"), Path::new("/dev/null")] {
            let message = text(path, SETTINGS).unwrap_err().to_string();
            assert!(message.contains("not a regular file"), "{message}");
        }
    }
}
