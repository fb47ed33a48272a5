//! A folder of sweeps on the disk: its identity, its tables, and who may write to them.
//!
//! Nodes share a folder, each with a shard's table of its own; each table has one writer at a time, who holds a lock on it for as long as
//! the sweep runs. The system gives the lock back however the process ends, so no lock file is ever left behind. Whoever comes second is
//! told so: waiting would mean to compute the same points again.

use super::identity::Identity;
use super::table::{ResultTable, row_digest, to_line, whole_lines};
use crate::{atomic, input};
use anyhow::{Context, Result, anyhow, bail};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The file of a folder's identity.
const IDENTITY: &str = "sweep.json";

/// Makes sure that the folder holds this sweep or none: results of different sweeps never share a table.
pub fn claim(folder: &Path, identity: &Identity) -> Result<()> {
    let path = folder.join(IDENTITY);
    let shown = path.display().to_string();
    let mut file = open(&path).with_context(|| format!("cannot write '{shown}'"))?;
    // Another process may be writing it in this moment.
    file.lock()
        .with_context(|| format!("cannot lock '{shown}'"))?;
    let mut text = String::new();
    file.read_to_string(&mut text)
        .with_context(|| format!("cannot read '{shown}'"))?;
    if !text.ends_with('\n') {
        // New, or its writer died while writing: nothing was computed under it.
        file.set_len(0)?;
        file.write_all(identity.to_text().as_bytes())
            .and_then(|()| file.sync_all())
            .with_context(|| format!("cannot write '{shown}'"))?;
        return Ok(());
    }
    let known = Identity::parse(&text).with_context(|| shown.clone())?;
    if identity.differences(&known).is_empty() {
        Ok(())
    } else {
        bail!(
            "'{}' holds another sweep ({shown}): choose another folder with -o. It differs in{}",
            folder.display(),
            identity.difference_text(&known)
        )
    }
}

/// The identity of a folder.
pub fn identity(folder: &Path) -> Result<Identity> {
    let path = folder.join(IDENTITY);
    let shown = path.display();
    let text = input::own_text(&path, input::SETTINGS)
        .with_context(|| format!("cannot read '{shown}'"))?;
    Identity::parse(&text).with_context(|| shown.to_string())
}

/// Whether a file is called like a table: `points.csv`, `points-3-of-8.csv`. Copies under other names are nobody's.
fn is_table(name: &str) -> bool {
    let middle = name
        .strip_prefix("points")
        .and_then(|name| name.strip_suffix(".csv"));
    let shard = |middle: &str| {
        let (index, count) = middle.strip_prefix('-')?.split_once("-of-")?;
        Some((index.parse::<usize>().ok()?, count.parse::<usize>().ok()?))
    };
    middle.is_some_and(|middle| middle.is_empty() || shard(middle).is_some())
}

/// The tables of a folder.
pub fn tables(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries =
        std::fs::read_dir(folder).with_context(|| format!("cannot read '{}'", folder.display()))?;
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry
            .with_context(|| format!("cannot read '{}'", folder.display()))?
            .path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if is_table(&name) {
            paths.push(path);
        } else if name.starts_with("points") && name.ends_with(".csv") {
            bail!(
                "{}: looks like a sweep's table, but these are called points.csv or points-i-of-n.csv: move it away or rename it",
                path.display()
            );
        }
    }
    paths.sort();
    Ok(paths)
}

/// Reads a table and checks it against its sweep.
pub fn table(path: &Path, identity: &Identity) -> Result<ResultTable> {
    let shown = path.display();
    let text =
        input::own_text(path, input::TABLE).with_context(|| format!("cannot read '{shown}'"))?;
    checked(&text, identity).map_err(|problem| anyhow!("{shown}: {problem}"))
}

fn checked(text: &str, identity: &Identity) -> Result<ResultTable> {
    let space = identity.space()?;
    let table = ResultTable::from_csv(text).map_err(anyhow::Error::msg)?;
    table
        .check(&space, identity.has_errors())
        .map_err(anyhow::Error::msg)?;
    Ok(table)
}

/// All tables of some folders of one sweep as one; folders of different sweeps are refused.
pub fn merge(folders: &[PathBuf]) -> Result<(ResultTable, Identity)> {
    let mut merged: Option<(ResultTable, Identity)> = None;
    for folder in folders {
        let identity = identity(folder)?;
        if let Some((_, known)) = &merged
            && !identity.differences(known).is_empty()
        {
            let (folder, text) = (folder.display(), identity.difference_text(known));
            bail!("'{folder}' holds another sweep than the folders before it: it differs in{text}");
        }
        let (all, identity) = merged.get_or_insert((ResultTable::default(), identity));
        for path in tables(folder)? {
            all.merge(table(&path, identity)?)
                .map_err(|problem| anyhow!("{}: {problem}", path.display()))?;
        }
    }
    match merged {
        Some((table, identity)) if !table.heading.is_empty() => Ok((table, identity)),
        _ => bail!("no points.csv or points-i-of-n.csv with a heading in these folders"),
    }
}

/// Writes a merged table; refused while a sweep is writing to the file of that name.
pub fn replace(path: &Path, table: &ResultTable) -> Result<()> {
    let shown = path.display();
    let _lock = if path.exists() {
        Some(locked(path).with_context(|| format!("cannot write '{shown}'"))?)
    } else {
        None
    };
    atomic::write(path, table.to_csv().as_bytes())
        .with_context(|| format!("cannot write '{shown}'"))
}

fn open(path: &Path) -> io::Result<File> {
    OpenOptions::new()
        .read(true)
        .append(true)
        .create(true)
        .open(path)
}

/// The file, with the lock that says that it is being written.
fn locked(path: &Path) -> io::Result<File> {
    let file = open(path)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(io::Error::new(
            io::ErrorKind::ResourceBusy,
            "another process is writing this table: wait for it, or choose another shard or folder",
        )),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// Appends lines from any thread, alone among all processes.
pub struct Appender(Mutex<File>);

impl Appender {
    /// Opens the file, which is made with its heading if need be, and cuts off a broken last line. Also the text that it holds.
    pub fn open(path: &Path, heading: &[String]) -> io::Result<(Appender, String)> {
        let mut file = locked(path)?;
        let mut text = String::new();
        file.read_to_string(&mut text)?;
        text.truncate(whole_lines(&text));
        file.set_len(text.len() as u64)?;
        if text.is_empty() {
            text = to_line(heading);
            file.write_all(text.as_bytes())?;
        }
        Ok((Appender(Mutex::new(file)), text))
    }

    /// Opens a sweep's table, and reads what is done already.
    pub fn resume(
        path: &Path,
        heading: &[String],
        identity: &Identity,
    ) -> Result<(Appender, ResultTable)> {
        let shown = path.display();
        let (appender, text) =
            Appender::open(path, heading).with_context(|| format!("cannot write '{shown}'"))?;
        let table = checked(&text, identity).map_err(|problem| anyhow!("{shown}: {problem}"))?;
        Ok((appender, table))
    }

    /// Appends a row of these fields, and its digest.
    pub fn append(&self, fields: &[String]) -> io::Result<()> {
        let mut row = fields.to_vec();
        row.push(row_digest(fields));
        self.append_line(&to_line(&row))
    }

    fn append_line(&self, line: &str) -> io::Result<()> {
        let mut file = self
            .0
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(line.as_bytes())?;
        file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heading() -> Vec<String> {
        ["point", "a"].map(str::to_owned).to_vec()
    }

    #[test]
    fn a_broken_last_line_is_dropped_and_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        std::fs::write(&path, "point,a\n0,5\n1,").unwrap();
        let table = ResultTable::from_csv(&std::fs::read_to_string(&path).unwrap()).unwrap();
        assert_eq!(table.rows.keys().collect::<Vec<_>>(), [&0]);
        Appender::open(&path, &heading())
            .unwrap()
            .0
            .append_line("1,6\n")
            .unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "point,a\n0,5\n1,6\n"
        );
    }

    /// Whatever byte an interruption cuts the table at, the sweep goes on with the whole lines, and ends with the same table.
    #[test]
    fn a_table_cut_anywhere_is_continued() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let lines = ["0,5\n", "1,16\n", "2,270\n"];
        let whole = format!("point,a\n{}", lines.concat());
        for length in 0..=whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let done = ResultTable::from_csv(&std::fs::read_to_string(&path).unwrap()).unwrap();
            let (out, _) = Appender::open(&path, &heading()).unwrap();
            for (point, line) in lines.iter().enumerate() {
                match done.rows.get(&point) {
                    Some(kept) => assert_eq!(to_line(kept), *line, "cut at {length}"),
                    None => out.append_line(line).unwrap(),
                }
            }
            assert_eq!(std::fs::read_to_string(&path).unwrap(), whole, "{length}");
        }
    }

    #[test]
    fn a_new_table_has_its_heading() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        Appender::open(&path, &heading()).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "point,a\n");
    }

    #[test]
    fn a_table_has_one_writer() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let first = Appender::open(&path, &heading()).unwrap();
        let refused = Appender::open(&path, &heading()).err().unwrap().to_string();
        assert!(refused.contains("another process"), "{refused}");
        let replaced = replace(&path, &ResultTable::default()).unwrap_err();
        assert!(format!("{replaced:#}").contains("another process"));
        drop(first);
        Appender::open(&path, &heading()).unwrap();
    }

    #[test]
    fn only_tables_are_taken_for_tables() {
        for name in ["points.csv", "points-1-of-8.csv", "points-12-of-100.csv"] {
            assert!(is_table(name), "{name}");
        }
        for name in [
            "points-1.csv",
            "points-a-of-b.csv",
            "points2.csv",
            "front.csv",
            "points-1-of-8.csv.bak",
        ] {
            assert!(!is_table(name), "{name}");
        }
    }
}
