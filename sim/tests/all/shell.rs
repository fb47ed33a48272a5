//! The program from outside: a folder of its own, in which it is called by lines as a shell has them.

use serde_json::Value;
use splatline_sim::report::Report;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What `SCENE` stands for in a line.
const SCENE: &str = "random:300:1 --size 48x32";

/// A folder that goes with the test.
pub struct Shell(tempfile::TempDir);

/// What a call came to.
pub struct Said {
    pub code: Option<i32>,
    pub stdout: Vec<u8>,
    pub stderr: String,
}

impl Shell {
    pub fn new() -> Shell {
        Shell(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file and the folders that it lies in.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub fn read(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&self.bytes(name)).unwrap()
    }

    pub fn report(&self, name: &str) -> Report {
        serde_json::from_slice(&self.bytes(name)).unwrap()
    }

    pub fn has(&self, name: &str) -> bool {
        self.path(name).is_file()
    }

    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_splatline"));
        command.args(line.replace("SCENE", SCENE).split_whitespace());
        command.current_dir(self.0.path());
        command
    }

    pub fn run(&self, line: &str) -> Said {
        said(self.command(line))
    }

    /// Runs what must succeed; its standard output.
    pub fn succeed(&self, line: &str) -> String {
        let said = self.run(line);
        assert_eq!(said.code, Some(0), "{line}: {}", said.stderr);
        String::from_utf8(said.stdout).unwrap()
    }

    /// The same of what says nothing but its results in a pipe.
    pub fn results(&self, line: &str) -> String {
        let said = self.run(line);
        assert_eq!((said.code, &*said.stderr), (Some(0), ""), "{line}");
        String::from_utf8(said.stdout).unwrap()
    }

    /// Runs what must be refused with a message; all of it.
    pub fn refused(&self, code: i32, line: &str, expected: &str) -> String {
        let Said {
            code: own, stderr, ..
        } = self.run(line);
        assert_eq!(own, Some(code), "{line}: {stderr}");
        assert!(stderr.contains(expected), "{line}: {stderr}");
        stderr
    }

    /// The same of every line of a table, `CODE LINE => WORDS`.
    pub fn refuses(&self, table: &str) {
        let cases = table.lines().filter(|case| !case.trim().is_empty());
        for case in cases {
            let (call, expected) = case.split_once("=>").expect(case);
            let (code, line) = call.trim().split_once(' ').expect(case);
            self.refused(code.parse().expect(case), line, expected.trim());
        }
    }
}

/// Runs a command.
pub fn said(mut command: Command) -> Said {
    let output = command.output().unwrap();
    Said {
        code: output.status.code(),
        stdout: output.stdout,
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// All files of a folder and of those in it.
pub fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .flat_map(|path| {
            if path.is_dir() {
                files_below(&path)
            } else {
                vec![path]
            }
        })
        .collect()
}

/// Does a text hold all of this?
pub fn holds(text: &str, expected: &[&str]) {
    for words in expected {
        assert!(text.contains(words), "{words}: {text}");
    }
}
