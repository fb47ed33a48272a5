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
