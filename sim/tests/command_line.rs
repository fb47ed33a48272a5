//! The binary from outside: exit codes, and which stream says what.

use std::process::{Command, Output};

fn splatline(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_splatline"))
        .args(arguments)
        .output()
        .unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn help_and_version_succeed_on_stdout() {
    for arguments in [
        &["--help"][..],
        &["render", "--help"],
        &["compare", "--help"],
        &["footprints", "--help"],
        &["--version"],
    ] {
        let output = splatline(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert!(
            output.stderr.is_empty() && !output.stdout.is_empty(),
            "{arguments:?}"
        );
    }
}

#[test]
fn bad_usage_is_exit_code_2_on_stderr() {
    for arguments in [
        &["rendr"][..],
        &["render"],
        &["render", "a.ply"],
        &["render", "a.ply", "-o", "a.png", "--size", "0x10"],
        &["render", "a.ply", "-o", "a.png", "--size", "20000x10"],
        &[
            "render", "a.ply", "-o", "a.png", "--camera", "c.json", "--eye", "1,2,3", "--target",
            "0,0,0",
        ],
        &["render", "a.ply", "-o", "a.png", "--eye", "1,2"],
        &["footprints", "a.ply", "-o", "a.csv", "--engine", "exact"],
        &["compare", "a.ply", "-o", "a", "--design", "unheard-of"],
    ] {
        let output = splatline(arguments);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{arguments:?}: {}",
            stderr(&output)
        );
        assert!(
            output.stdout.is_empty() && stderr(&output).starts_with("error: "),
            "{arguments:?}"
        );
    }
}

#[test]
fn bad_input_is_exit_code_1_and_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("missing.ply");
    let picture = folder.path().join("a.png");
    let output = splatline(&[
        "render",
        scene.to_str().unwrap(),
        "-o",
        picture.to_str().unwrap(),
        "--eye",
        "-1,2,3",
        "--target",
        "0,0,0",
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("missing.ply"));
    assert!(output.stdout.is_empty() && !picture.exists());
}

/// Every command that prints, with little work: what cannot be printed must not look printed.
const PRINTING: [&[&str]; 13] = [
    &["--help"],
    &["--version"],
    &["model", "--help"],
    &["render", "random:9", "--size", "8x8", "-o", "OUT/a.png"],
    &[
        "compare",
        "random:9",
        "--size",
        "8x8",
        "--only",
        "-o",
        "OUT/compare",
    ],
    &["footprints", "random:9", "--size", "8x8", "-o", "OUT/f.csv"],
    &["model", "random:9", "--size", "8x8"],
    &["needs", "random:9", "--size", "8x8"],
    &["fit", "random:9", "--size", "8x8", "--max-error", "0.5"],
    &[
        "explore",
        "random:9",
        "--size",
        "8x8",
        "--no-error",
        "--space",
        "OUT/s.toml",
        "-o",
        "OUT/sweep",
    ],
    &["merge", "OUT/sweep", "-o", "OUT/merged"],
    &[
        "trace",
        "random:9",
        "--size",
        "8x8",
        "--format",
        "vcd",
        "-o",
        "OUT/t.vcd",
    ],
    &[
        "vectors",
        "export",
        "--splats",
        "1",
        "--size",
        "8x8",
        "OUT/vectors",
    ],
];

fn with_output(
    arguments: &[&str],
    folder: &std::path::Path,
    output: std::process::Stdio,
) -> Output {
    let arguments = arguments
        .iter()
        .map(|argument| argument.replace("OUT", folder.to_str().unwrap()));
    Command::new(env!("CARGO_BIN_EXE_splatline"))
        .args(arguments)
        .stdout(output)
        .output()
        .unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_fails_fails_and_a_reader_that_left_does_not() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), "[machine]\nlanes = [1, 2]\n").unwrap();
    for arguments in PRINTING {
        let full = std::fs::File::create("/dev/full").unwrap();
        let output = with_output(arguments, folder.path(), full.into());
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {told}");
        assert!(
            told.contains("cannot write to the standard output"),
            "{arguments:?}: {told}"
        );
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = with_output(arguments, folder.path(), writer.into());
        assert_eq!(
            output.status.code(),
            Some(0),
            "{arguments:?}: {}",
            stderr(&output)
        );
    }
}

/// The list above is complete: whatever command is added must be in it, or here with its reason.
#[test]
fn every_command_is_tried_with_a_full_disk() {
    // All minutes long, and all through the same function.
    let long = ["gallery", "results", "stability", "help"];
    let help = String::from_utf8(splatline(&["--help"]).stdout).unwrap();
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = commands
        .take_while(|line| !line.is_empty())
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next());
    let mut found = 0;
    for name in names {
        found += 1;
        let tried = PRINTING.iter().any(|arguments| arguments[0] == name);
        assert!(tried || long.contains(&name), "{name} is not tried");
    }
    assert!(found > 12, "{found} commands");
}
