//! A sweep's folder on the disk: its identity and its table. One process at a time writes there; two would leave points
//! that come twice, which reading refuses. Many machines share a study's file instead (`splatline.study`, in Python).

use super::cache::locked;
use super::identity::Identity;
use super::space::Space;
use super::table::{ResultTable, heading, row_digest, to_line, whole_lines};
use crate::input;
use anyhow::{Context, Result, anyhow, bail};
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Mutex;

/// The file of a folder's identity.
const IDENTITY: &str = "sweep.json";
/// Differences of two sweeps that a message lists at most.
const FEW: usize = 6;

/// Makes sure that the folder holds this sweep or none: results of different sweeps never share a table.
pub fn claim(folder: &Path, identity: &Identity) -> Result<()> {
    let path = folder.join(IDENTITY);
    let shown = path.display().to_string();
    let mut file = open(&path).with_context(|| format!("cannot write '{shown}'"))?;
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
    let mut differences = identity.differences(&known);
    if differences.is_empty() {
        return Ok(());
    }
    if let Some(more @ 1..) = differences.len().checked_sub(FEW) {
        differences.truncate(FEW);
        differences.push(format!("and {more} more"));
    }
    bail!(
        "'{}' holds another sweep ({shown}): choose another folder with -o. It differs in\n  {}",
        folder.display(),
        differences.join("\n  ")
    )
}

/// Reads a table and checks it against its space.
pub fn table(path: &Path, space: &Space) -> Result<ResultTable> {
    let shown = path.display();
    let text =
        input::own_text(path, input::TABLE).with_context(|| format!("cannot read '{shown}'"))?;
    checked(&text, space).map_err(|problem| anyhow!("{shown}: {problem}"))
}

fn checked(text: &str, space: &Space) -> Result<ResultTable, String> {
    let table = ResultTable::from_csv(text)?;
    table.check(space)?;
    Ok(table)
}

fn open(path: &Path) -> io::Result<File> {
    OpenOptions::new()
        .read(true)
        .append(true)
        .create(true)
        .open(path)
}

/// A table's file behind its last whole line, and the lines.
fn open_whole(path: &Path, heading: &[String]) -> io::Result<(File, String)> {
    let mut file = open(path)?;
    let mut text = String::new();
    file.read_to_string(&mut text)?;
    text.truncate(whole_lines(&text));
    file.set_len(text.len() as u64)?;
    if text.is_empty() {
        text = to_line(heading);
        file.write_all(text.as_bytes())?;
    }
    Ok((file, text))
}

/// Appends lines from any thread.
pub struct Appender(Mutex<File>);

impl Appender {
    /// Opens a sweep's table, which is made with its heading if need be, cuts off a broken last line, and reads what is
    /// done already.
    pub fn open(path: &Path, space: &Space) -> Result<(Appender, ResultTable)> {
        let shown = path.display();
        let opened = open_whole(path, &heading(space));
        let (file, text) = opened.with_context(|| format!("cannot write '{shown}'"))?;
        let table = checked(&text, space).map_err(|problem| anyhow!("{shown}: {problem}"))?;
        Ok((Appender(Mutex::new(file)), table))
    }

    /// Appends a row of these fields, and its digest.
    pub fn append(&self, mut fields: Vec<String>) -> io::Result<()> {
        fields.push(row_digest(&fields));
        let mut file = locked(&self.0);
        file.write_all(to_line(&fields).as_bytes())?;
        file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explore::table::RESULTS;

    /// Whatever byte an interruption cuts the table at, the sweep goes on with the whole lines, and ends with the same
    /// table; a new one has its heading.
    #[test]
    fn a_table_cut_anywhere_is_continued() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let space = Space::from_toml("s.toml", "[machine]\nlanes = [1, 2, 4]\n").unwrap();
        let written = || {
            let (out, done) = Appender::open(&path, &space).unwrap();
            for (point, lanes) in [1, 2, 4].iter().enumerate() {
                if !done.rows.contains_key(&point) {
                    let mut fields = vec![point.to_string(), lanes.to_string()];
                    fields.resize(2 + RESULTS.len(), "x".to_owned());
                    out.append(fields).unwrap();
                }
            }
            std::fs::read_to_string(&path).unwrap()
        };
        let whole = written();
        assert_eq!(whole.lines().next().unwrap(), heading(&space).join(","));
        for length in 0..=whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert_eq!(written(), whole, "cut at {length}");
        }
    }
}
