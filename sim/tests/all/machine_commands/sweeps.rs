//! Sweeps: resuming, and what is refused because it belongs to another sweep.

use super::*;
use std::process::Command;

#[test]
fn a_sweep_is_resumed_and_has_a_front() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(
        path("s.toml"),
        "[design]\nmantissa = [14, 18]\n[machine]\nlanes = [1, 4]\nrow_fifo = [2, 8]\n",
    )
    .unwrap();
    let (space, whole) = (path("s.toml"), path("whole"));
    let sweep = ["--space", text(&space), "-o", text(&whole)];
    assert!(succeed(&with("explore", &sweep)).contains("8 points, 8 of them new"));
    assert!(succeed(&with("explore", &sweep)).contains("8 points, 0 of them new"));
    let page = std::fs::read_to_string(whole.join("front.html")).unwrap();
    assert!(page.contains("<title>point") && page.contains("Estimate of area for Xilinx 7"));
    std::fs::write(&space, "[machine]\nlanes = [2]\n").unwrap();
    let refused = fail(1, &with("explore", &sweep));
    assert!(refused.contains("holds another sweep"), "{refused}");
    assert!(
        refused.contains("space, line 1: '[design]' there, '[machine]' here"),
        "{refused}"
    );
}

/// Several scenes by several cameras: each point says its slowest frame, the 95th percentile and the mean, as `model` says them of that machine.
#[test]
fn a_sweep_over_frames_has_worst_percentile_and_mean() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let keys = "frames = 3\n[[key]]\neye = [0.0, 0.0, -9.0]\ntarget = [0.0, 0.0, 0.0]\nup = [0.0, -1.0, 0.0]\n\
                [[key]]\neye = [2.0, 0.0, -4.0]\ntarget = [0.0, 0.0, 0.0]\nup = [0.0, -1.0, 0.0]\n";
    std::fs::write(path("keys.toml"), keys).unwrap();
    std::fs::write(
        path("s.toml"),
        "[machine]\nlanes = [1, 4]\nlayout = [\"rows\", \"quad\"]\n",
    )
    .unwrap();
    let (keys, space, out) = (path("keys.toml"), path("s.toml"), path("out"));
    let frames = [
        "random:200:1",
        "random:100:2",
        "--size",
        "32x24",
        "--camera-path",
        text(&keys),
    ];
    let sweep = ["--space", text(&space), "-o", text(&out)];
    let printed = succeed(&[&["explore"], &frames[..], &sweep].concat());
    assert!(printed.contains("4 points, 4 of them new"), "{printed}");
    let table = std::fs::read_to_string(out.join("points.csv")).unwrap();
    let heading: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let column = |line: &str, name: &str| {
        let place = heading.iter().position(|column| *column == name).unwrap();
        line.split(',').nth(place).unwrap().to_owned()
    };
    let line = table
        .lines()
        .find(|line| line.contains(",4,rows,"))
        .unwrap();
    assert_eq!(column(line, "frames"), "6");
    let modelled = path("model");
    let machine = [
        "--set",
        "lanes=4",
        "--set",
        "layout=rows",
        "-o",
        text(&modelled),
    ];
    let printed = succeed(&[&["model"], &frames[..], &machine].concat());
    assert!(printed.contains("6 frames, the worst is"), "{printed}");
    let timing: serde_json::Value =
        serde_json::from_slice(&std::fs::read(modelled.join("timing.json")).unwrap()).unwrap();
    let spread = &timing["over_frames"]["ms_per_frame"];
    for (name, key) in [
        ("ms_per_frame", "worst"),
        ("ms_per_frame_95", "percentile_95"),
        ("ms_per_frame_mean", "mean"),
    ] {
        assert_eq!(
            column(line, name),
            format!("{:.4}", spread[key].as_f64().unwrap()),
            "{name}"
        );
    }
    let errors: f64 = column(line, "max_abs").parse().unwrap();
    assert!(errors > 0.0);
    let none = table
        .lines()
        .find(|line| line.contains(",1,quad,"))
        .unwrap();
    assert!(none.contains("allowed with 2 or more lanes"), "{none}");
    // Another path is another sweep.
    std::fs::write(
        &keys,
        std::fs::read_to_string(&keys)
            .unwrap()
            .replace("2.0", "2.5"),
    )
    .unwrap();
    let refused = fail(1, &[&["explore"], &frames[..], &sweep].concat());
    assert!(
        refused.contains("holds another sweep") && refused.contains("more_frames"),
        "{refused}"
    );
}

/// A scene of three splats in a file, so that it can be edited under its name.
fn scene(weight: f32) -> Vec<u8> {
    let record = |x: f32| {
        let mut bytes = [x, 0.0, 0.0, 0.1, 0.1, 0.1].map(f32::to_le_bytes).concat();
        bytes.extend([200, 100, 50, (weight * 255.0) as u8, 255, 128, 128, 128]);
        bytes
    };
    [-0.3, 0.0, 0.4].map(record).concat()
}

/// Edited files of one name, other options, another program's identity: not resumed, and the message says why.
#[test]
fn a_sweep_of_anything_else_is_not_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let files = [
        ("s.toml", "[machine]\nlanes = [1, 2]\n"),
        ("d.toml", "base = \"lean18\"\n"),
        ("m.toml", "[lanes]\nlanes = 1\n"),
        ("p.toml", "family = \"ecp5\"\n"),
    ];
    for (name, text) in files {
        std::fs::write(path(name), text).unwrap();
    }
    std::fs::write(path("a.splat"), scene(0.5)).unwrap();
    let run = |more: &[&str]| {
        let usual = [
            "explore",
            "FOLDER/a.splat",
            "--size",
            "16x16",
            "--space",
            "FOLDER/s.toml",
            "--no-error",
            "-o",
            "FOLDER/known",
        ];
        let files = [
            "--design",
            "FOLDER/d.toml",
            "--machine",
            "FOLDER/m.toml",
            "--calibration",
            "FOLDER/p.toml",
        ];
        let all = [&usual, &files[..], more].concat();
        let all = all
            .iter()
            .map(|argument| argument.replace("FOLDER", text(folder.path())));
        let all: Vec<String> = all.collect();
        splatline(&all.iter().map(String::as_str).collect::<Vec<_>>())
    };
    assert!(run(&[]).status.success());
    let refused = |expected: &str, more: &[&str]| {
        let printed = String::from_utf8_lossy(&run(more).stderr).into_owned();
        assert!(
            printed.contains("holds another sweep") && printed.contains(expected),
            "{expected}: {printed}"
        );
    };
    std::fs::write(path("a.splat"), scene(0.6)).unwrap();
    refused("scene.sha256", &[]);
    std::fs::write(path("a.splat"), scene(0.5)).unwrap();
    for (name, role, section) in [
        ("d.toml", "design", ""),
        ("m.toml", "machine", ""),
        ("p.toml", "calibration", ""),
    ] {
        let before = std::fs::read_to_string(path(name)).unwrap();
        std::fs::write(path(name), format!("{before}# a comment {section}\n")).unwrap();
        refused(&format!("files_sha256.{role}"), &[]);
        std::fs::write(path(name), before).unwrap();
    }
    refused("camera.", &["--eye", "0,0,-3", "--target", "0,0,0"]);
    refused("rules", &["--kernel", "disc"]);
    refused("compositing", &["--compositing", "x-ray"]);
    refused("machine, line", &["--set", "row_fifo=3"]);
    // Tables of another version of the program.
    let sweep = path("known").join("sweep.json");
    let text = std::fs::read_to_string(&sweep).unwrap();
    let start = text.find("sources_sha256").unwrap() + 18;
    let other = format!("{}0000{}", &text[..start], &text[start + 4..]);
    std::fs::write(&sweep, other).unwrap();
    refused("program.sources_sha256", &[]);
}

#[test]
fn an_altered_sweep_is_not_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("s.toml"), "[machine]\nrow_fifo = [1, 2, 3, 4]\n").unwrap();
    let (space, out) = (path("s.toml"), path("out"));
    let sweep = ["--space", text(&space), "-o", text(&out)];
    succeed(&with("explore", &sweep));
    let table = out.join("points.csv");
    let sound = std::fs::read_to_string(&table).unwrap();
    let altered = |from: &str, to: &str, expected: &str| {
        std::fs::write(&table, sound.replacen(from, to, 1)).unwrap();
        let printed = fail(1, &with("explore", &sweep));
        assert!(
            printed.contains("points.csv") && printed.contains(expected),
            "{printed}"
        );
    };
    altered(
        "\n2,3,",
        "\n2,4,",
        "row_fifo is '4', in the space it is '3'",
    );
    altered("\n2,3,", "\n2,3,NaN", "psnr_db is 'NaN");
    let row = sound.lines().nth(1).unwrap();
    altered(row, &format!("{row}\n{row}"), "a second time");
}

/// A scene that nobody sees is swept, and its rows are read again.
#[test]
fn a_sweep_of_nothing_can_be_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let space = folder.path().join("s.toml");
    std::fs::write(&space, "[machine]\nlanes = [1, 2]\n").unwrap();
    let away = [
        "--eye",
        "0,0,900",
        "--target",
        "0,0,1000",
        "--space",
        text(&space),
        "-o",
        text(folder.path()),
    ];
    assert!(succeed(&with("explore", &away)).contains("2 points, 2 of them new"));
    assert!(succeed(&with("explore", &away)).contains("2 points, 0 of them new"));
}

/// Stopped by Ctrl-C again and again, a sweep still ends with the rows of one that was left alone.
#[cfg(unix)]
#[test]
fn an_interrupted_sweep_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(
        path("s.toml"),
        "[design]\nmantissa = { from = 12, to = 27 }\n[machine]\nlanes = [1, 4]\nrow_fifo = [2, 8]\n",
    )
    .unwrap();
    // Large enough that it takes a while after its first rows.
    let large = ["explore", "random:3000:1", "--size", "160x120"];
    let arguments = |out: &Path| -> Vec<String> {
        let space = path("s.toml");
        let more = ["--space", text(&space), "-o", text(out)];
        let all = large.iter().chain(&more);
        all.map(|argument| argument.to_string()).collect()
    };
    let (whole, stopped) = (path("whole"), path("stopped"));
    let run = |out: &Path| {
        let arguments = arguments(out);
        succeed(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    };
    run(&whole);
    let table = stopped.join("points.csv");
    let rows = || {
        std::fs::read_to_string(&table)
            .unwrap_or_default()
            .lines()
            .count()
    };
    let mut interrupted = 0;
    for _ in 0..3 {
        let before = rows();
        let mut child = Command::new(env!("CARGO_BIN_EXE_splatline"))
            .args(arguments(&stopped))
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        // Until it has written something new.
        while child.try_wait().unwrap().is_none() && rows() < before + 2 {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        // Not an interrupt: a shell starts its background jobs deaf to it, and whoever tests from one would find nothing interrupted.
        let kill = format!("kill -TERM {}", child.id());
        let signal = Command::new("sh").args(["-c", &kill]).status();
        if signal.is_ok_and(|status| status.success()) && !child.wait().unwrap().success() {
            interrupted += 1;
        }
    }
    assert!(interrupted > 0, "the sweep was too fast to be interrupted");
    run(&stopped);
    let sorted = |folder: &Path| {
        let text = std::fs::read_to_string(folder.join("points.csv")).unwrap();
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines.sort();
        lines
    };
    assert_eq!(sorted(&stopped), sorted(&whole));
    assert_eq!(sorted(&whole).len(), 65);
}
