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

/// The energies of a report add up to the last digit, the export holds the same counts, and a wrong table is refused by name and line.
#[test]
fn model_says_what_a_picture_takes_and_for_what() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let printed = succeed(&with("model", &["-o", text(&out)]));
    let timing: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("timing.json")).unwrap()).unwrap();
    let energy = &timing["energy"];
    let whole = |value: &serde_json::Value| value.as_u64().unwrap();
    let mut sum = 0;
    for unit in energy["units"].as_array().unwrap() {
        let actions = unit["actions"].as_array().unwrap().iter();
        let of_unit: u64 = actions
            .map(|action| whole(&action["count"]) * whole(&action["attojoules_each"]))
            .sum();
        assert_eq!(whole(&unit["attojoules"]), of_unit, "{}", unit["unit"]);
        sum += of_unit;
    }
    assert_eq!(whole(&energy["attojoules"]), sum);
    let said = format!("energy: {:.4} mJ a frame", sum as f64 / 1e15);
    assert!(printed.contains(&said) && printed.contains("estimate"));
    let counts = std::fs::read_to_string(out.join("action_counts.yaml")).unwrap();
    assert!(counts.contains("- name: splatline.lanes.table_"));

    let table = folder.path().join("mine.toml");
    let shipped = splatline_sim::machine::energy::SHIPPED;
    std::fs::write(&table, shipped.replace("pj = 3.1", "pj = -3.1")).unwrap();
    let refused = fail(1, &with("model", &["--energy", text(&table)]));
    assert!(
        refused.contains("mine.toml:29: multiplier.pj = -3.1: allowed are numbers above 0"),
        "{refused}"
    );
}

/// A part needs a clock; with one the report says what it did, and its requests come out for the simulators of DRAM.
#[test]
fn a_memory_part_is_a_setting_and_its_requests_are_a_trace() {
    let folder = tempfile::tempdir().unwrap();
    let part = ["--set", "part=ddr3-1600-x16", "--set", "clock_mhz=100"];
    let no_clock = fail(2, &with("model", &part[..2]));
    assert!(
        no_clock.contains("part = \"ddr3-1600-x16\": allowed with a clock_mhz of 1 to 10000"),
        "{no_clock}"
    );
    let printed = succeed(&with("model", &part));
    assert!(printed.contains("memory ddr3-1600-x16: ") && printed.contains("row"));
    let file = folder.path().join("requests.txt");
    for (format, first) in [("ramulator2", "LD 0x0\n"), ("dramsim3", "0x0 READ 0\n")] {
        let trace = ["--format", format, "-o", text(&file)];
        let said = succeed(&with("trace", &[&part[..], &trace].concat()));
        let lines = std::fs::read_to_string(&file).unwrap();
        assert!(lines.starts_with(first), "{}", &lines[..80]);
        assert!(said.contains(&format!(
            "{} requests to ddr3-1600-x16",
            lines.lines().count()
        )));
    }
    let channels = fail(
        2,
        &with("trace", &["--format", "dramsim3", "-o", text(&file)]),
    );
    assert!(channels.contains("--set part=ddr3-1600-x16"), "{channels}");
}

/// Machines of others stand beside ours on the same splats; options that none of them would hear are refused.
#[test]
fn machines_of_others_stand_beside_ours() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let printed = succeed(&with("model", &["--machines", "-o", text(&out)]));
    for name in [
        "box-tiles",
        "sub-tiles",
        "row-sequential",
        "axis-shared",
        "primitive-1997",
        "splatline lean18",
    ] {
        assert!(printed.contains(&format!("| {name} |")), "{printed}");
    }
    assert!(printed.contains("reimplemented from the paper"));
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("machines.json")).unwrap()).unwrap();
    let machines = json["machines"].as_array().unwrap();
    let live = |machine: &serde_json::Value| machine["cycles"]["pixels"]["live"].as_u64().unwrap();
    assert_eq!(live(&machines[0]), live(&machines[1]));
    fail(2, &with("model", &["--machines", "--set", "lanes=4"]));
}

/// Floating-point datapaths draw by `render` and stand in the report of `compare`, worse with fewer bits; what they cannot draw is refused.
#[test]
fn floating_point_datapaths_are_engines() {
    let folder = tempfile::tempdir().unwrap();
    let (picture, out) = (folder.path().join("x.png"), folder.path().join("out"));
    for engine in ["fp32", "fp16", "bfloat16"] {
        succeed(&with("render", &["--engine", engine, "-o", text(&picture)]));
    }
    let printed = succeed(&with("compare", &["--only", "--formats", "-o", text(&out)]));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
    let formats = report["formats"].as_array().unwrap();
    let psnr = formats
        .iter()
        .map(|row| row["error"]["rgb"]["psnr_db"].as_f64().unwrap());
    let psnr: Vec<f64> = psnr.collect();
    assert!(psnr.is_sorted_by(|wide, narrow| wide > narrow), "{psnr:?}");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(printed.contains("bfloat16") && page.contains("Floating-point datapaths"));
    let refused = |command: &str, more: &[&str]| fail(1, &with(command, more));
    let x_ray = [
        "--engine",
        "fp16",
        "--compositing",
        "x-ray",
        "-o",
        text(&picture),
    ];
    assert!(refused("render", &x_ray).contains("front to back"));
    let wrong = ["--engine", "fp16", "-o", text(&out)];
    assert!(fail(2, &with("compare", &wrong)).contains("--formats"));
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
    let empty = folder.path().join("empty.csv");
    std::fs::write(&empty, "").unwrap();
    assert!(fail(1, &["model", "--footprints", text(&empty)]).contains("no column 'u'"));
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
    assert!(
        refused.contains("space, line 1: '[design]' there, '[machine]' here"),
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

/// Edited files of one name, other options, another program's identity: neither resumed nor merged, and the message says why.
#[test]
fn a_sweep_of_anything_else_is_neither_resumed_nor_merged() {
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
    let arguments = |shard: &str, out: &str, more: &[&str]| -> Vec<String> {
        let out = format!("FOLDER/{out}");
        let usual = [
            "explore",
            "FOLDER/a.splat",
            "--size",
            "16x16",
            "--space",
            "FOLDER/s.toml",
            "--no-error",
        ];
        let files = [
            "--design",
            "FOLDER/d.toml",
            "--machine",
            "FOLDER/m.toml",
            "--calibration",
            "FOLDER/p.toml",
        ];
        let all = [&usual, &files[..], more, &["--shard", shard, "-o", &out]].concat();
        all.iter()
            .map(|argument| argument.replace("FOLDER", text(folder.path())))
            .collect()
    };
    let run = |shard: &str, out: &str, more: &[&str]| {
        let arguments = arguments(shard, out, more);
        splatline(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    };
    assert!(run("1/2", "known", &[]).status.success());
    let refused = |expected: &str, out: &str, more: &[&str]| {
        let resumed = run("2/2", "known", more);
        let told = String::from_utf8_lossy(&resumed.stderr).into_owned();
        assert!(
            told.contains("holds another sweep") && told.contains(expected),
            "{expected}: {told}"
        );
        assert!(run("2/2", out, more).status.success(), "{expected}");
        let told = fail(
            1,
            &[
                "merge",
                text(&path("known")),
                text(&path(out)),
                "-o",
                text(&path("merged")),
            ],
        );
        assert!(
            told.contains("another sweep") && told.contains(expected),
            "{expected}: {told}"
        );
        assert!(!path("merged").join("points.csv").exists());
    };
    std::fs::write(path("a.splat"), scene(0.6)).unwrap();
    refused("scene.sha256", "edited", &[]);
    std::fs::write(path("a.splat"), scene(0.5)).unwrap();
    for (name, role, section) in [
        ("d.toml", "design", ""),
        ("m.toml", "machine", ""),
        ("p.toml", "calibration", ""),
    ] {
        let before = std::fs::read_to_string(path(name)).unwrap();
        std::fs::write(path(name), format!("{before}# a comment {section}\n")).unwrap();
        refused(&format!("files_sha256.{role}"), role, &[]);
        std::fs::write(path(name), before).unwrap();
    }
    refused("camera.", "size", &["--eye", "0,0,-3", "--target", "0,0,0"]);
    refused("rules", "rules", &["--kernel", "disc"]);
    refused("compositing", "order", &["--compositing", "x-ray"]);
    refused("machine, line", "set", &["--set", "row_fifo=3"]);
    // Tables of another version of the program.
    let sweep = path("known").join("sweep.json");
    let text = std::fs::read_to_string(&sweep).unwrap();
    let start = text.find("sources_sha256").unwrap() + 18;
    let other = format!("{}0000{}", &text[..start], &text[start + 4..]);
    std::fs::write(&sweep, other).unwrap();
    refused("program.sources_sha256", "program", &[]);
}

#[test]
fn an_incomplete_or_altered_sweep_is_not_merged() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(
        path("s.toml"),
        "[machine]\nrow_fifo = [1, 2, 3, 4, 5, 6, 7, 8]\n",
    )
    .unwrap();
    let (out, merged) = (path("out"), path("merged"));
    let sweep = |shard: &str| {
        let more = [
            "--space",
            text(&path("s.toml")),
            "--shard",
            shard,
            "-o",
            text(&out),
        ]
        .map(str::to_owned);
        let more: Vec<&str> = more.iter().map(String::as_str).collect();
        succeed(&with("explore", &more))
    };
    sweep("1/8");
    let told = fail(1, &["merge", text(&out), "-o", text(&merged)]);
    assert!(
        told.contains("7 of the sweep's 8 points are missing") && told.contains("--partial"),
        "{told}"
    );
    assert!(!merged.join("points.csv").exists());
    let told = succeed(&["merge", "--partial", text(&out), "-o", text(&merged)]);
    assert!(told.contains("1 points; 7 of 8 are missing"), "{told}");
    for shard in 2..=8 {
        sweep(&format!("{shard}/8"));
    }
    // A row that was merged before is not lost, though its folder is not named again.
    std::fs::rename(out.join("points-1-of-8.csv"), path("kept.csv")).unwrap();
    assert!(succeed(&["merge", text(&out), "-o", text(&merged)]).starts_with("8 points"));
    std::fs::rename(path("kept.csv"), out.join("points-1-of-8.csv")).unwrap();

    let table = out.join("points-3-of-8.csv");
    let sound = std::fs::read_to_string(&table).unwrap();
    let altered = |from: &str, to: &str, expected: &str| {
        std::fs::write(&table, sound.replacen(from, to, 1)).unwrap();
        let told = fail(1, &["merge", text(&out), "-o", text(&path("other"))]);
        assert!(
            told.contains("points-3-of-8.csv") && told.contains(expected),
            "{told}"
        );
        let resume = [
            "--space",
            text(&path("s.toml")),
            "--shard",
            "3/8",
            "-o",
            text(&out),
        ]
        .map(str::to_owned);
        let resume: Vec<&str> = resume.iter().map(String::as_str).collect();
        assert!(fail(1, &with("explore", &resume)).contains(expected));
    };
    altered(
        "\n2,3,",
        "\n2,4,",
        "row_fifo is '4', in the space it is '3'",
    );
    altered("\n2,3,", "\n2,3,NaN", "psnr_db is 'NaN");
    let row = sound.lines().nth(1).unwrap();
    altered(row, &format!("{row}\n{row}"), "point 2 a second time");
    std::fs::write(&table, &sound).unwrap();
    std::fs::write(out.join("points-old.csv"), &sound).unwrap();
    let told = fail(1, &["merge", text(&out), "-o", text(&path("other"))]);
    assert!(
        told.contains("points-old.csv: looks like a sweep's table"),
        "{told}"
    );
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
        let kill = format!("kill -INT {}", child.id());
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

/// A second process on the same table is refused while the first one runs.
#[test]
fn two_processes_do_not_share_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let space = folder.path().join("s.toml");
    std::fs::write(&space, "[machine]\nlanes = [1, 2]\n").unwrap();
    let arguments = with(
        "explore",
        &["--space", text(&space), "-o", text(folder.path())],
    );
    succeed(&arguments);
    let table = std::fs::File::open(folder.path().join("points.csv")).unwrap();
    table.lock().unwrap();
    assert!(fail(1, &arguments).contains("another process is writing this table"));
    let merge = ["merge", text(folder.path()), "-o", text(folder.path())];
    assert!(fail(1, &merge).contains("another process is writing this table"));
    drop(table);
    succeed(&arguments);
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

#[test]
fn a_pace_says_whose_clock_it_goes_by() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let assumed = succeed(&with("model", &[]));
    assert!(
        assumed.contains("assumed: no clock_mhz was given"),
        "{assumed}"
    );
    let machine = ["--set", "clock_mhz=200", "--set", "overlap_frames=2"];
    let more = ["--part", "XC7A100T", "-o", text(&out)];
    let given = succeed(&with("model", &[&machine[..], &more].concat()));
    assert!(
        given.contains("clock: 200 MHz (clock_mhz of the machine)"),
        "{given}"
    );
    assert!(given.contains("part XC7A100T (DS180"), "{given}");
    let timing: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("timing.json")).unwrap()).unwrap();
    let pace = &timing["pace"];
    let cycles = pace["cycles_per_frame"].as_f64().unwrap();
    let fps = pace["frames_per_s"].as_f64().unwrap();
    assert!((fps * cycles / 200e6 - 1.0).abs() < 1e-9);
    assert!(cycles < timing["cycles"]["total"].as_f64().unwrap());
    assert_eq!(timing["area"]["part"]["dsps"], 240);
    assert!(
        std::fs::read_to_string(out.join("timing.html"))
            .unwrap()
            .contains("<svg")
    );
    let refused = fail(2, &with("model", &["--set", "clock_mhz=10001"]));
    assert!(
        refused.contains("--set: clock_mhz = 10001: allowed are 0 to 10000"),
        "{refused}"
    );
    let refused = fail(2, &with("model", &["--set", "packet_cache=100"]));
    assert!(
        refused.contains("packet_cache = 100: allowed are 0, 16, 32"),
        "{refused}"
    );
    let refused = fail(2, &with("model", &["--part", "xc2000"]));
    assert!(
        refused.contains("unknown part 'xc2000': there are ice40up5k"),
        "{refused}"
    );
}

const PATH: &str = "frames = 12\n[[key]]\neye = [0.0, 0.0, -9.0]\ntarget = [0.0, 0.0, 5.0]\nup = [0.0, -1.0, 0.0]\n\
                    [[key]]\neye = [3.0, 1.0, -3.0]\ntarget = [0.0, 0.0, 5.0]\nup = [0.0, -1.0, 0.0]\n";

#[test]
fn many_frames_are_one_report() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("keys.toml"), PATH).unwrap();
    let keys = path("keys.toml");
    let by_path = [
        "random:200:1",
        "--size",
        "32x24",
        "--camera-path",
        text(&keys),
    ];
    let json = |file: &Path| -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap()
    };

    let out = path("model");
    let told = succeed(&[&["model"], &by_path[..], &["-o", text(&out)]].concat());
    assert!(
        told.contains("12 frames, the worst is random:200:1, frame "),
        "{told}"
    );
    let timing = json(&out.join("timing.json"));
    let ms: Vec<f64> = timing["frames"]
        .as_array()
        .unwrap()
        .iter()
        .map(|frame| frame["pace"]["ms_per_frame"].as_f64().unwrap())
        .collect();
    let over = &timing["over_frames"]["ms_per_frame"];
    assert_eq!(ms.len(), 12);
    assert_eq!(
        over["worst"].as_f64().unwrap(),
        ms.iter().copied().fold(0.0, f64::max)
    );
    assert!((over["mean"].as_f64().unwrap() - ms.iter().sum::<f64>() / 12.0).abs() < 1e-12);

    let (picture, report) = (path("x.png"), path("r.json"));
    succeed(
        &[
            &["render"],
            &by_path[..],
            &["--json", text(&report), "-o", text(&picture)],
        ]
        .concat(),
    );
    assert!(path("x-0001.png").is_file() && path("x-0012.png").is_file() && !picture.exists());
    assert_eq!(json(&report)["frames"].as_array().unwrap().len(), 12);

    let out = path("compare");
    let told = succeed(&[&["compare"], &by_path[..], &["-o", text(&out)]].concat());
    assert!(
        told.contains("12 frames, the one with the lowest PSNR"),
        "{told}"
    );
    let all = json(&out.join("frames.json"));
    assert_eq!(all["frames"].as_array().unwrap().len(), 12);
    let first = json(&out.join("frame-0001/report.json"));
    assert_eq!(
        first["error"]["rgb"]["max_abs"],
        all["frames"][0]["max_abs"]
    );
    assert!(
        std::fs::read_to_string(out.join("frames.html"))
            .unwrap()
            .contains("frame-0012/report.html")
    );

    let scenes = ["needs", "random:100:1", "random:100:2", "--size", "24x24"];
    let needed = succeed(&scenes);
    assert!(
        needed.contains("random:100:1: ") && needed.contains("random:100:2: "),
        "{needed}"
    );
    let told = fail(
        2,
        &[
            "model",
            "random:9",
            "--camera-path",
            "k.toml",
            "--fov",
            "40",
        ],
    );
    assert!(told.contains("--camera-path"), "{told}");
    std::fs::write(path("keys.toml"), PATH.replace("12", "0")).unwrap();
    let told = fail(1, &[&["model"], &by_path[..]].concat());
    assert!(
        told.contains("keys.toml:1: frames = 0: allowed are 1 to 100000"),
        "{told}"
    );
}

/// From the question to an answer whose design and machine hold what it says when they are used, also as the base of a space.
#[test]
fn a_question_has_one_answer() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let space = path("s.toml");
    let fields = "[design]\nmantissa = { from = 12, to = 24 }\nalpha = { from = 8, to = 24 }\n[machine]\nlanes = [1, 2, 4]\n\
                  rows_at_once = [1, 2]\nread_bandwidth = [4, 8]\nwrite_bandwidth = [4]\n";
    std::fs::write(&space, fields).unwrap();
    let out = path("out");
    let asked = [
        "--space",
        text(&space),
        "--fps",
        "500",
        "--max-error",
        "0.01",
        "--part",
        "xc7a200t",
        "--set",
        "clock_mhz=50",
        "-o",
        text(&out),
    ];
    let told = succeed(&with("explore", &asked));
    assert!(
        told.contains("cheapest point that holds all limits") && told.contains("next 3"),
        "{told}"
    );
    let answer: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("answer.json")).unwrap()).unwrap();
    let reached = &answer["answer"]["found"][0]["reached"];
    let (design, machine) = (out.join("design.toml"), out.join("machine.toml"));
    let modelled = path("modelled");
    let again = [
        "--design",
        text(&design),
        "--machine",
        text(&machine),
        "-o",
        text(&modelled),
    ];
    succeed(&with("model", &again));
    let timing: serde_json::Value =
        serde_json::from_slice(&std::fs::read(modelled.join("timing.json")).unwrap()).unwrap();
    assert_eq!(timing["pace"], reached["pace"]);
    assert_eq!(timing["area"]["luts_in_all"], reached["area"]["weight"]);
    let base = format!("[design]\nbase = [\"lean18\", \"{}\"]\n", text(&design));
    std::fs::write(&space, base).unwrap();
    let swept = path("swept");
    let told = succeed(&with(
        "explore",
        &["--space", text(&space), "-o", text(&swept)],
    ));
    assert!(
        told.contains("2 points, 2 of them new") && told.contains("assumed clock"),
        "{told}"
    );
    let points = std::fs::read_to_string(swept.join("points.csv")).unwrap();
    assert!(
        points
            .lines()
            .next()
            .unwrap()
            .contains("frames_per_s,ms_per_frame")
    );

    let none = succeed(&with(
        "explore",
        &["--space", text(&space), "--fps", "1000000", "--lut", "10"],
    ));
    assert!(
        none.contains("no point was found that holds all limits"),
        "{none}"
    );
    let told = fail(2, &with("explore", &["-o", text(&out)]));
    assert!(told.contains("--space"), "{told}");
    let told = fail(
        2,
        &with(
            "explore",
            &["playbot.ply", "--space", text(&space), "-o", text(&out)],
        ),
    );
    assert!(told.contains("need a limit"), "{told}");
}
