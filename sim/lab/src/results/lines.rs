//! How long the host crates are, by folder, today and at an earlier commit: lines of Rust without tests.
//!
//! Tests are files called so (`tests.rs`, `*_tests.rs`, folders `tests`, `sample.rs` of the report's tests) and whatever stands under
//! `#[cfg(test)]`. Blank lines and comments count: what is read is what is measured.

use super::table;
use anyhow::{Context, Result, bail};
use std::collections::BTreeMap;
use std::process::Command;

/// The crates' sources, as columns.
const ROOTS: [&str; 5] = [
    "sim/src",
    "sim/machine/src",
    "sim/engine/src",
    "sim/reference/src",
    "sim/lab/src",
];

/// Lines by folder; files that stand in no folder are counted under `.`.
type Folders = BTreeMap<String, usize>;

/// The table: a folder a row, `before` beside today's crates.
pub fn compared(before: &str) -> Result<String> {
    let mut columns = vec![count(Some(before), ROOTS[0])?];
    for root in ROOTS {
        columns.push(count(None, root)?);
    }
    let mut names: Vec<&String> = columns.iter().flat_map(BTreeMap::keys).collect();
    names.sort();
    names.dedup();
    let row = |name: &str, cell: &dyn Fn(&Folders) -> String| -> Vec<String> {
        let cells = columns.iter().map(cell);
        std::iter::once(name.to_owned()).chain(cells).collect()
    };
    let lines = |name: &str, folders: &Folders| match folders.get(name) {
        Some(lines) => lines.to_string(),
        None => String::new(),
    };
    let mut rows: Vec<Vec<String>> = names
        .iter()
        .map(|name| row(name, &|folders| lines(name, folders)))
        .collect();
    rows.push(row("**all**", &|folders| {
        folders.values().sum::<usize>().to_string()
    }));
    let earlier = format!("{} at {before}", ROOTS[0]);
    let mut headings = vec!["folder", &earlier];
    headings.extend(ROOTS);
    Ok(table(&headings, &rows))
}

/// The lines below `root`, in the work tree or at a commit.
fn count(commit: Option<&str>, root: &str) -> Result<Folders> {
    let listed = match commit {
        Some(commit) => git(&["ls-tree", "-r", "--name-only", commit, root])?,
        None => git(&[
            "ls-files",
            "--cached",
            "--others",
            "--exclude-standard",
            root,
        ])?,
    };
    let mut folders = Folders::new();
    for path in listed.lines().filter(|path| is_counted(path)) {
        let text = match commit {
            Some(commit) => git(&["show", &format!("{commit}:{path}")])?,
            None => match std::fs::read_to_string(path) {
                Ok(text) => text,
                // Deleted, and not yet committed.
                Err(_) => continue,
            },
        };
        let below = path
            .strip_prefix(root)
            .unwrap_or(path)
            .trim_start_matches('/');
        let folder = below.split_once('/').map_or(".", |(folder, _)| folder);
        *folders.entry(folder.to_owned()).or_default() += without_tests(&text);
    }
    Ok(folders)
}

fn git(words: &[&str]) -> Result<String> {
    let output = Command::new("git")
        .args(words)
        .output()
        .context("cannot run git, which knows the files")?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        bail!("git {}: {}", words.join(" "), said.trim());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn is_counted(path: &str) -> bool {
    let file = path.rsplit('/').next().unwrap_or(path);
    let is_test = matches!(file, "tests.rs" | "sample.rs")
        || file.ends_with("_tests.rs")
        || path.contains("/tests/");
    path.ends_with(".rs") && !is_test
}

/// Lines of a source, what stands under `#[cfg(test)]` left out: up to the closing brace in the same column.
fn without_tests(text: &str) -> usize {
    let mut lines = text.lines();
    let mut counted = 0;
    while let Some(line) = lines.next() {
        if line.trim() != "#[cfg(test)]" {
            counted += 1;
            continue;
        }
        let column = line.len() - line.trim_start().len();
        let end = format!("{}}}", " ".repeat(column));
        let item = lines.by_ref().find(|line| !line.trim().starts_with("#["));
        if item.is_some_and(|item| item.trim_end().ends_with('{')) {
            lines.by_ref().find(|line| *line == end);
        }
    }
    counted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_are_left_out() {
        let text = "//! Unit.\n\nfn a() {\n}\n#[cfg(test)]\nmod tests;\n\n#[cfg(test)]\n#[path = \"x.rs\"]\nmod more {\n    fn b() {\n    }\n}\nfn c() {}\n";
        assert_eq!(without_tests(text), 6);
        let counted = ["sim/src/a.rs", "sim/src/tests.rs", "sim/src/a_tests.rs"].map(is_counted);
        assert_eq!(counted, [true, false, false]);
        assert!(!is_counted("sim/machine/src/tests/oracle.rs") && !is_counted("sim/src/page.css"));
    }
}
