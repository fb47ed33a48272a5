//! The mutated copy of the tree, and its test programs.

use crate::Failure;
use crate::sites::{Edit, Kind, Mutant, find};
use serde_json::Value;
use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A choice that the compiler can make too, so that `const fn` keeps its word.
const FEATURES: &str =
    "#![feature(core_intrinsics, const_eval_select)]\n#![allow(internal_features)]\n";

/// One file of the kernel.
struct Source {
    path: String,
    text: String,
    edits: Vec<Edit>,
}

/// The copy, with all mutants of the kernel.
pub struct Copy {
    tree: PathBuf,
    build: PathBuf,
    sources: Vec<Source>,
    pub mutants: Vec<Mutant>,
}

/// One compiled test program.
#[derive(Clone)]
pub struct Program {
    pub path: PathBuf,
    /// Where it expects to run.
    pub folder: PathBuf,
}

/// A mutant's number and its code.
type Choice = (usize, String);

/// Which part of a rewritten file belongs to which mutant.
struct Part {
    range: Range<usize>,
    mutant: usize,
}

impl Copy {
    /// Copies the repository `root` below `work` and finds every mutant of its `src`.
    pub fn new(root: &Path, work: &Path) -> Result<Copy, Failure> {
        let (tree, build) = (work.join("tree"), work.join("build"));
        let mut list = Command::new("git");
        list.args(["ls-files", "-co", "--exclude-standard"]);
        let files = String::from_utf8(list.current_dir(root).output()?.stdout)?;
        let kept = |f: &&str| !f.starts_with("sim/fuzz/") && root.join(f).is_file();
        let mut texts = Vec::new();
        for file in files.lines().filter(kept) {
            let bytes = fs::read(root.join(file))?;
            if file.starts_with("src/") && file.ends_with(".rs") {
                texts.push((file.to_owned(), String::from_utf8(bytes)?))
            } else {
                write(&tree.join(file), &bytes)?
            }
        }
        // Mutants count from 1: 0 is none.
        let none = Mutant {
            key: "none".into(),
            dropped: true,
            ..Mutant::default()
        };
        let (mut sources, mut mutants) = (Vec::new(), vec![none]);
        for (path, text) in texts {
            let found = if path.ends_with("/tests.rs") {
                find(&path, "", mutants.len())?
            } else {
                find(&path, &text, mutants.len()).map_err(|e| format!("{path}: {e}"))?
            };
            mutants.extend(found.mutants);
            sources.push(Source {
                path,
                text,
                edits: found.edits,
            });
        }
        Ok(Copy {
            tree,
            build,
            sources,
            mutants,
        })
    }

    /// Writes the rewritten kernel. Returns which bytes of which file belong to which mutant.
    fn write(&self) -> Result<Vec<(String, Vec<Part>)>, Failure> {
        let mut parts = Vec::new();
        for source in &self.sources {
            let (mut text, mut at) = rewritten(source, &self.mutants);
            if source.path == "src/lib.rs" {
                text = format!("{FEATURES}{text}\n#[doc(hidden)]\npub mod mutation;\n");
                for part in &mut at {
                    part.range = part.range.start + FEATURES.len()..part.range.end + FEATURES.len();
                }
            }
            write(&self.tree.join(&source.path), text.as_bytes())?;
            parts.push((source.path.clone(), at));
        }
        let cell = self.tree.join("src/mutation.rs");
        write(&cell, include_bytes!("cell.rs"))?;
        Ok(parts)
    }

    /// Rewrites the kernel, leaving out mutants until it compiles: not every type has every operator.
    pub fn settle(&mut self) -> Result<(), Failure> {
        // What did not compile the last time is left out at once, so that unchanged files stay as they are.
        let before = fs::read_to_string(self.tree.with_extension("dropped")).unwrap_or_default();
        let before: BTreeSet<&str> = before.lines().collect();
        for mutant in &mut self.mutants {
            mutant.dropped |= before.contains(mutant.key.as_str());
        }
        for _ in 0..40 {
            let parts = self.write()?;
            let output = self.cargo(&["check", "-p", "splatline", "--lib", "--tests"], 0)?;
            let before = self.dropped();
            let mut message = String::new();
            for error in messages(&output).filter(|m| m["message"]["level"] == "error") {
                message += error["message"]["rendered"].as_str().unwrap_or("");
                for span in error["message"]["spans"].as_array().into_iter().flatten() {
                    self.drop_at(span, &parts);
                }
            }
            if message.is_empty() {
                let dropped = self.mutants.iter().filter(|m| m.dropped);
                let names: String = dropped.map(|m| format!("{}\n", m.key)).collect();
                return Ok(fs::write(self.tree.with_extension("dropped"), names)?);
            }
            if self.dropped() == before {
                return Err(message.into());
            }
        }
        Err("the rewritten kernel does not compile".into())
    }

    /// Leaves out the innermost mutant that an error points at.
    fn drop_at(&mut self, span: &Value, parts: &[(String, Vec<Part>)]) {
        let number = |name: &str| span[name].as_u64().unwrap_or(0) as usize;
        let (start, end) = (number("byte_start"), number("byte_end"));
        let is_file = |part: &&(String, Vec<Part>)| span["file_name"] == part.0.as_str();
        let Some((_, parts)) = parts.iter().find(is_file) else {
            return;
        };
        let around = |p: &&Part| p.range.start <= start && end <= p.range.end;
        let around = parts.iter().filter(around);
        if let Some(part) = around.min_by_key(|p| p.range.len()) {
            self.mutants[part.mutant].dropped = true;
        }
    }

    fn dropped(&self) -> usize {
        self.mutants.iter().filter(|m| m.dropped).count()
    }

    /// Compiles test programs of the copy, with mutant `compiled` in what the compiler evaluates.
    pub fn programs(&self, compiled: usize, arguments: &[&str]) -> Result<Vec<Program>, Failure> {
        let arguments = [&["test", "--no-run"], arguments].concat();
        let output = self.cargo(&arguments, compiled)?;
        let program = |m: Value| {
            Some(Program {
                path: m["executable"].as_str()?.into(),
                folder: Path::new(m["manifest_path"].as_str()?).parent()?.into(),
            })
        };
        let tests = messages(&output).filter(|m| m["profile"]["test"] == true);
        let programs: Vec<Program> = tests.filter_map(program).collect();
        if programs.is_empty() {
            let error = |m: Value| m["message"]["rendered"].as_str().map(String::from);
            let errors: String = messages(&output).filter_map(error).collect();
            return Err(errors.into());
        }
        Ok(programs)
    }

    fn cargo(&self, arguments: &[&str], compiled: usize) -> Result<Vec<u8>, Failure> {
        // A table whose loop does not end keeps the compiler busy until it has no memory.
        let limits = match compiled {
            0 => "exec cargo \"$@\"",
            _ => "ulimit -v 8000000; ulimit -t 300; exec cargo \"$@\"",
        };
        let output = Command::new("sh")
            .args(["-c", limits, "cargo"])
            .args(arguments)
            .args(["--profile", "mutants", "--offline"])
            .args(["--message-format", "json"])
            .env("RUSTC_BOOTSTRAP", "1")
            .env("RUSTFLAGS", "--cap-lints=allow")
            .env("MUTANT_COMPILED", compiled.to_string())
            .env("CARGO_TARGET_DIR", &self.build)
            .current_dir(&self.tree)
            .stderr(Stdio::inherit())
            .output()?;
        Ok(output.stdout)
    }
}

fn messages(output: &[u8]) -> impl Iterator<Item = Value> {
    output
        .split(|&b| b == b'\n')
        .filter_map(|line| serde_json::from_slice(line).ok())
}

/// Writes a file if it differs, so that nothing is compiled again for its date.
fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    if fs::read(path).is_ok_and(|old| old == bytes) {
        return Ok(());
    }
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    Ok(fs::write(path, bytes)?)
}

/// The text with every choice in it, and which part of it belongs to which mutant.
fn rewritten(source: &Source, mutants: &[Mutant]) -> (String, Vec<Part>) {
    let compiles = |choice: &&Choice| !mutants[choice.0].dropped;
    let edits = source.edits.iter();
    let chosen = edits
        .clone()
        .map(|edit| edit.choices.iter().filter(compiles).collect());
    let mut edits: Vec<(&Edit, Vec<&Choice>)> = edits.zip(chosen).collect();
    edits.retain(|(_, choices)| !choices.is_empty());
    // Outer ones before those inside.
    edits.sort_by_key(|(edit, _)| (edit.range.start, Reverse(edit.range.end)));
    let mut writer = Writer {
        text: &source.text,
        position: 0,
        out: String::new(),
        parts: Vec::new(),
        open: Vec::new(),
    };
    for (edit, choices) in edits {
        writer.close(edit.range.start);
        writer.open(edit, choices);
    }
    writer.close(source.text.len());
    writer.copy(source.text.len());
    (writer.out, writer.parts)
}

/// Goes through a text, opening and closing edits.
struct Writer<'a> {
    text: &'a str,
    /// Up to where the text is copied.
    position: usize,
    out: String,
    parts: Vec<Part>,
    /// Edits whose end is to come, where they begin in the output, and their choices.
    open: Vec<(&'a Edit, usize, Vec<&'a Choice>)>,
}

impl<'a> Writer<'a> {
    fn copy(&mut self, end: usize) {
        self.out.push_str(&self.text[self.position..end]);
        self.position = end;
    }

    /// Closes what ends until `limit`.
    fn close(&mut self, limit: usize) {
        while let Some((edit, begin, choices)) =
            self.open.pop_if(|(edit, ..)| edit.range.end <= limit)
        {
            self.copy(edit.range.end);
            let instead = edit.kind == Kind::Instead;
            self.out.push_str(if instead { " })" } else { " }" });
            let range = begin..self.out.len();
            self.parts.extend(choices.iter().map(|choice| Part {
                range: range.clone(),
                mutant: choice.0,
            }));
        }
    }

    fn open(&mut self, edit: &'a Edit, choices: Vec<&'a Choice>) {
        self.copy(edit.range.start);
        let begin = self.out.len();
        if edit.kind == Kind::Instead {
            self.out.push('(');
        }
        for (mutant, code) in &choices {
            let start = self.out.len();
            self.out += &match edit.kind {
                Kind::Instead => format!("if crate::mutation::at({mutant}) {{ {code} }} else "),
                Kind::Entry => format!("if crate::mutation::at({mutant}) {{ {code} }} "),
                Kind::LeftOut => format!("if !crate::mutation::at({mutant}) {{ "),
            };
            let range = start..self.out.len();
            self.parts.push(Part {
                range,
                mutant: *mutant,
            });
        }
        match edit.kind {
            Kind::Instead => self.out.push_str("{ "),
            Kind::LeftOut => {}
            Kind::Entry => return,
        }
        self.open.push((edit, begin, choices));
    }
}
