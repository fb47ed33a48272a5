//! Mutants against the specification: its Python model equals every word of the exports of `sim/golden/designs.py` (a check of `.ci/run`), so
//! a mutant that changes a word of one of them is noticed by that check. The model runs once; for each mutant words are compared.

use crate::Failure;
use crate::trial::{Verdict, processor_time};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// One export: how it was written, what it held, and which mutants it reaches.
struct Export {
    arguments: Vec<String>,
    words: PathBuf,
    time: Duration,
    reached: BTreeSet<usize>,
}

pub struct Words {
    program: PathBuf,
    out: PathBuf,
    exports: Vec<Export>,
}

impl Words {
    /// Writes and checks all exports without a mutant.
    pub fn new(program: PathBuf, tree: &Path, work: &Path) -> Result<Words, Failure> {
        let kept = work.join("words");
        let _ = fs::remove_dir_all(&kept);
        let status = Command::new("python3")
            .arg(tree.join("sim/golden/designs.py"))
            .arg(&program)
            .arg("--keep")
            .arg(&kept)
            .status()?;
        if !status.success() {
            return Err("the model differs from the kernel without a mutant".into());
        }
        let (out, exports) = (work.join("exported"), Vec::new());
        let mut words = Words {
            program,
            out,
            exports,
        };
        for number in 0.. {
            let folder = kept.join(number.to_string());
            let Ok(text) = fs::read_to_string(folder.with_extension("options")) else {
                break;
            };
            let arguments: Vec<String> = text.lines().map(String::from).collect();
            let record = work.join("reached");
            let output = words
                .command(&arguments, &words.out, "60")
                .env("MUTANT_RECORD", &record)
                .stderr(Stdio::piped())
                .output()?;
            words.exports.push(Export {
                arguments,
                words: folder,
                time: processor_time(&String::from_utf8_lossy(&output.stderr)),
                reached: fs::read_to_string(&record)?
                    .split_whitespace()
                    .filter_map(|n| n.parse().ok())
                    .collect(),
            });
        }
        words.exports.sort_by_key(|export| export.time);
        Ok(words)
    }

    pub fn len(&self) -> usize {
        self.exports.len()
    }

    /// An export with limits of processor time in seconds and of memory.
    fn command(&self, arguments: &[String], out: &Path, seconds: &str) -> Command {
        let mut command = Command::new("sh");
        command
            .args([
                "-c",
                "ulimit -c 0; ulimit -t $0; ulimit -v 8000000; out=$1 program=$2; shift 2; rm -rf \"$out\"; \
                 \"$program\" vectors export \"$out\" \"$@\" 2>/dev/null; c=$?; times >&2; exit $c",
                seconds,
            ])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .stdin(Stdio::null());
        command.arg(out).arg(&self.program).args(arguments);
        command
    }

    pub fn try_mutant(&self, mutant: usize) -> Result<Verdict, Failure> {
        let mut verdict = Verdict::Unreached;
        let out = self.out.with_extension(mutant.to_string());
        for export in self.exports.iter().filter(|e| e.reached.contains(&mutant)) {
            let seconds = (1 + 4 * export.time.as_millis() / 1000).to_string();
            let status = self
                .command(&export.arguments, &out, &seconds)
                .env("MUTANT", mutant.to_string())
                .status()?;
            let alike = status.success() && equal(&export.words, &out)?;
            let _ = fs::remove_dir_all(&out);
            if !alike {
                return Ok(Verdict::Noticed(format!(
                    "words of {}",
                    export.arguments.join(" ")
                )));
            }
            verdict = Verdict::Survived;
        }
        Ok(verdict)
    }
}

/// Are all files of a folder those of another?
fn equal(folder: &Path, other: &Path) -> Result<bool, Failure> {
    for file in fs::read_dir(folder)? {
        let name = file?.file_name();
        let found = fs::read(other.join(&name));
        if !found.is_ok_and(|found| fs::read(folder.join(&name)).is_ok_and(|own| own == found)) {
            return Ok(false);
        }
    }
    Ok(true)
}
