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

#[test]
fn info_tells_what_is_in_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let cloud = folder.path().join("cloud.xyz");
    std::fs::write(
        &cloud,
        "0 0 0 0 0 1\n1 0 0 0 0 1\n0 2 0 0 0 1\n1 2 0 0 0 1\nnan 0 0 0 0 1\n",
    )
    .unwrap();
    let output = splatline(&["info", cloud.to_str().unwrap()]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for expected in [
        "points of a surface",
        "count      4",
        "unusable 1",
        "up         +z",
        "radius ",
    ] {
        assert!(told.contains(expected), "{expected}: {told}");
    }
    let output = splatline(&["info", "random:100", "--json", "-"]);
    let info: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (
            &info["kind"],
            &info["count"],
            &info["dropped"]["non_finite"]
        ),
        (&"3D Gaussians".into(), &100.into(), &0.into())
    );
    assert_eq!(splatline(&["info", "nothing.ply"]).status.code(), Some(1));
}

/// A picture on stdout is a picture and nothing else.
#[test]
fn a_stream_holds_the_result_alone() {
    let output = splatline(&["render", "random:50", "--size", "16x16", "-o", "-"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(output.stdout.starts_with(b"\x89PNG\r\n"));
    assert!(stderr(&output).contains("random:50"));
    let output = splatline(&["footprints", "random:5", "--size", "16x16", "-o", "-"]);
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(
        (table.lines().count(), table.starts_with("index,u,v")),
        (6, true)
    );
}

#[test]
fn shells_and_man_are_served() {
    let script = splatline(&["completions", "bash"]).stdout;
    assert!(
        String::from_utf8_lossy(&script).contains("splatline__subcmd__render")
            || String::from_utf8_lossy(&script).contains("splatline__render")
    );
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("man1");
    assert_eq!(
        splatline(&["man", "-o", out.to_str().unwrap()])
            .status
            .code(),
        Some(0)
    );
    let page = std::fs::read_to_string(out.join("splatline-render.1")).unwrap();
    assert!(
        page.contains("\\-\\-background") && page.contains(".TH"),
        "{page}"
    );
}
