//! The commands about the machine from outside: what they print, write and refuse.

use std::path::Path;
use std::process::{Command, Output};

fn splatline(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_splatline"))
        .args(arguments)
        .output()
        .unwrap()
}

fn succeed(arguments: &[&str]) -> String {
    let output = splatline(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {error}");
    assert!(error.is_empty(), "nothing but results in a pipe: {error}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn fail(code: i32, arguments: &[&str]) -> String {
    let output = splatline(arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

const SCENE: [&str; 3] = ["random:300:1", "--size", "48x32"];

fn with<'a>(command: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&[command], &SCENE[..], more].concat()
}

#[test]
fn model_writes_accounts_and_the_resolved_machine() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let printed = succeed(&with("model", &["--set", "lanes=4", "-o", text(&out)]));
    assert!(printed.contains("simulated cycles per second"));
    let timing: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("timing.json")).unwrap()).unwrap();
    let luts = timing["area"]["raster"]["luts"].as_u64().unwrap();
    assert!(
        printed.contains(&format!("area: raster units {luts} LUT")) && printed.contains("Xilinx 7")
    );
    let total = timing["cycles"]["total"].as_u64().unwrap();
    for (name, unit) in timing["cycles"]["units"].as_object().unwrap() {
        let stalled: u64 = unit["stalled"]
            .as_object()
            .unwrap()
            .values()
            .filter_map(serde_json::Value::as_u64)
            .sum();
        let sum = unit["busy"].as_u64().unwrap() + stalled + unit["idle"].as_u64().unwrap();
        assert_eq!(sum, unit["instances"].as_u64().unwrap() * total, "{name}");
    }
    let machine = out.join("machine.toml");
    assert!(
        std::fs::read_to_string(&machine)
            .unwrap()
            .contains("lanes = 4")
    );
    let again = succeed(&with("model", &["--machine", text(&machine)]));
    assert_eq!(again.lines().next(), printed.lines().next());
}

#[test]
fn area_is_counted_for_a_family_or_by_prices_of_ones_own() {
    let folder = tempfile::tempdir().unwrap();
    let prices = folder.path().join("prices.toml");
    std::fs::write(&prices, "family = \"ice40\"\nluts_per_dsp = 1.0\n").unwrap();
    let ecp5 = succeed(&with("model", &["--family", "ecp5"]));
    assert!(ecp5.contains("area for ECP5") && ecp5.contains("of its synthesis"));
    let own = succeed(&with("model", &["--calibration", text(&prices)]));
    assert!(own.contains("not held against any synthesis"));
    std::fs::write(&prices, "luts_per_dps = 1.0\n").unwrap();
    let refused = fail(1, &with("model", &["--calibration", text(&prices)]));
    assert!(refused.contains("luts_per_dps"), "{refused}");
}

#[test]
fn a_table_of_footprints_is_timed_like_the_scene_it_came_from() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("f.csv");
    succeed(&with("footprints", &["-o", text(&table)]));
    let from_table = ["model", "--footprints", text(&table), "--screen", "48x32"];
    let printed = succeed(&from_table);
    assert!(
        printed.contains("cycles = geometry") && printed.contains("0 left out"),
        "{printed}"
    );
    // A table has no opacities, so nothing finishes in it; nor does anything in an X-ray.
    let cycles = |printed: &str| {
        let line = printed
            .lines()
            .find(|line| line.contains(" cycles = "))
            .unwrap();
        let words: Vec<&str> = line.split_whitespace().collect();
        words[1].parse::<f64>().unwrap()
    };
    let scene = cycles(&succeed(&with("model", &["--compositing", "x-ray"])));
    assert!(
        (cycles(&printed) / scene - 1.0).abs() < 0.002,
        "{printed} {scene}"
    );
    let whole = std::fs::read_to_string(&table).unwrap();
    let without: String = whole
        .lines()
        .map(|line| line.rsplit_once(',').unwrap().0.to_owned() + "\n")
        .collect();
    std::fs::write(&table, without).unwrap();
    let refused = fail(1, &from_table);
    assert!(
        refused.contains("no cut-off") && refused.contains("--cutoff"),
        "{refused}"
    );
    assert!(fail(1, &["model", "--footprints", "/dev/null"]).contains("no column 'u'"));
}

#[test]
fn a_sweep_in_shards_is_the_whole_sweep() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(
        path("s.toml"),
        "[design]\nmantissa = [14, 18]\n[machine]\nlanes = [1, 4]\nrow_fifo = [2, 8]\n",
    )
    .unwrap();
    let sweep = |out: &Path, shard: &str| {
        succeed(&with(
            "explore",
            &[
                "--space",
                text(&path("s.toml")),
                "--shard",
                shard,
                "-o",
                text(out),
            ],
        ))
    };
    let (whole, parts, merged) = (path("whole"), path("parts"), path("merged"));
    assert!(sweep(&whole, "1/1").contains("8 points, 8 of them new"));
    assert!(sweep(&whole, "1/1").contains("8 points, 0 of them new"));
    sweep(&parts, "1/2");
    sweep(&parts, "2/2");
    succeed(&["merge", text(&parts), "-o", text(&merged)]);
    let read = |folder: &Path, file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    assert_eq!(read(&whole, "front.csv"), read(&merged, "front.csv"));
    assert!(read(&whole, "front.html").contains("<title>point"));
    for sweep in [&whole, &merged] {
        assert!(read(sweep, "front.html").contains("Estimate of area for Xilinx 7"));
    }
    std::fs::write(path("s.toml"), "[machine]\nlanes = [2]\n").unwrap();
    let refused = fail(
        1,
        &with(
            "explore",
            &["--space", text(&path("s.toml")), "-o", text(&whole)],
        ),
    );
    assert!(refused.contains("holds another sweep"), "{refused}");
}

#[test]
fn needs_fit_and_trace_answer() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let needs = succeed(&with("needs", &["--json", text(&path("n.json"))]));
    assert!(needs.contains("row_fifo") && needs.contains("layers: at most"));
    let fit = succeed(&with(
        "fit",
        &["--max-error", "0.02", "-o", text(&path("d.toml"))],
    ));
    assert!(fit.contains("binding width"));
    succeed(&with(
        "render",
        &[
            "--design",
            text(&path("d.toml")),
            "-o",
            text(&path("x.png")),
        ],
    ));
    assert!(fail(1, &with("fit", &["--max-error", "1e-12"])).contains("above the budget"));
    for format in ["kanata", "vcd", "perfetto"] {
        let printed = succeed(&with(
            "trace",
            &[
                "--format",
                format,
                "--last",
                "20",
                "-o",
                text(&path(format)),
            ],
        ));
        assert!(printed.contains("splats 0 to 20"), "{printed}");
        assert!(path(format).metadata().unwrap().len() > 200);
    }
}

#[test]
fn bad_machines_name_key_line_and_range() {
    let folder = tempfile::tempdir().unwrap();
    let machine = folder.path().join("m.toml");
    std::fs::write(&machine, "[lanes]\nlanes = 5\n").unwrap();
    let message = fail(1, &with("model", &["--machine", text(&machine)]));
    assert!(
        message.contains("m.toml:2: lanes.lanes = 5: allowed are 1, 2, 4"),
        "{message}"
    );
    assert!(fail(2, &with("model", &["--set", "lanes=5"])).contains("lanes = 5: allowed are"));
    assert!(fail(2, &with("model", &["--set", "lane=4"])).contains("did you mean lanes"));
    assert!(
        fail(
            2,
            &with(
                "trace",
                &["--format", "vcd", "--first", "9", "--last", "3", "-o", "x"]
            )
        )
        .contains("smaller")
    );
}
