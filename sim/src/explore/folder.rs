//! A sweep's folder on the disk: its identity and its table. One process at a time writes there; two would leave points
//! that come twice, which reading refuses. Many machines share a study's file instead (`splatline.study`, in Python).

use super::cache::locked;
use super::identity::Identity;
use super::table::{ResultTable, row_digest, to_line, whole_lines};
use crate::input;
use anyhow::{Context, Result, anyhow, bail};
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Mutex;

/// The file of a folder's identity.
const IDENTITY: &str = "sweep.json";

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

fn open(path: &Path) -> io::Result<File> {
    OpenOptions::new()
        .read(true)
        .append(true)
        .create(true)
        .open(path)
}

/// Appends lines from any thread.
pub struct Appender(Mutex<File>);

impl Appender {
    /// Opens the file, which is made with its heading if need be, and cuts off a broken last line. Also the text that
    /// it holds.
    pub fn open(path: &Path, heading: &[String]) -> io::Result<(Appender, String)> {
        let mut file = open(path)?;
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
        let mut file = locked(&self.0);
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

    /// Whatever byte an interruption cuts the table at, the sweep goes on with the whole lines, and ends with the same
    /// table.
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
}
