//! The commands about the machine from outside: what they print, write and refuse.

mod questions;
mod sweeps;

use super::command_line::splatline;
use std::path::Path;

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
    let part = [
        "--set",
        "memory_part=ddr3-1600-x16",
        "--set",
        "clock_mhz=100",
    ];
    let no_clock = fail(2, &with("model", &part[..2]));
    assert!(
        no_clock
            .contains("memory_part = \"ddr3-1600-x16\": allowed with a clock_mhz of 1 to 10000"),
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
    assert!(
        channels.contains("--set memory_part=ddr3-1600-x16"),
        "{channels}"
    );
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
    for engine in ["fp32", "fp16", "bfloat16", "e5m2-fp16", "fp8"] {
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

/// Beside what is fitted and beside the cheapest machine; a format whose error is too large holds nothing.
#[test]
fn formats_stand_beside_fixed_designs() {
    let folder = tempfile::tempdir().unwrap();
    let asked = ["--psnr", "40", "--formats", "fp16,bfloat16,fp8"];
    let printed = succeed(&with("fit", &asked));
    let line = |name: &str| {
        let mut lines = printed
            .lines()
            .filter(|line| line.trim_start().starts_with(name));
        lines.next().unwrap_or_else(|| panic!("{name}: {printed}"))
    };
    assert!(
        line("fp16").ends_with("yes") && line("fp8").ends_with("no"),
        "{printed}"
    );
    let cells: Vec<&str> = line("fixed").split_whitespace().collect();
    let psnr: f64 = cells[1].parse().unwrap();
    assert!((40.0..60.0).contains(&psnr), "{printed}");
    assert!(
        printed.contains("Cheapest: fixed; bfloat16 takes"),
        "{printed}"
    );
    let out = folder.path().join("out");
    let machine = ["--fps", "60", "-o", text(&out)];
    succeed(&with("optimize", &[&asked[..], &machine].concat()));
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("answer.json")).unwrap()).unwrap();
    let rows = json["answer"]["formats"].as_array().unwrap();
    let names: Vec<&str> = rows
        .iter()
        .map(|row| row["format"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["fixed", "fp16", "bfloat16", "fp8"]);
    let of = |row: usize, field: &str| rows[row]["machine"][field].as_f64().unwrap();
    // The fixed row is the answer itself.
    let reached = &json["answer"]["found"][0]["reached"];
    assert_eq!(Some(of(0, "mj_per_frame")), reached["millijoules"].as_f64());
    assert_eq!(
        Some(of(0, "luts_in_all")),
        reached["area"]["weight"].as_f64()
    );
    assert!(of(1, "luts_in_all") > of(2, "luts_in_all"));
    assert!(of(2, "luts_in_all") > of(0, "luts_in_all"));
    assert!(of(1, "mj_per_frame") > of(2, "mj_per_frame"));
    let page = std::fs::read_to_string(out.join("answer.html")).unwrap();
    assert!(
        page.contains("In floating-point formats")
            && page.contains("error and transistors of a lane")
    );
    assert!(fail(2, &with("fit", &["--psnr", "40", "--formats", "fp12"])).contains("fp12"));
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
    let cycles = |printed: &str| {
        let line = printed
            .lines()
            .find(|line| line.contains(" cycles = "))
            .unwrap();
        let words: Vec<&str> = line.split_whitespace().collect();
        words[1].parse::<f64>().unwrap()
    };
    let scene = cycles(&succeed(&with("model", &[])));
    assert!(
        (cycles(&printed) / scene - 1.0).abs() < 0.002,
        "{printed} {scene}"
    );
    // Without opacities nothing finishes; nor does anything in an X-ray.
    let whole = std::fs::read_to_string(&table).unwrap();
    std::fs::write(&table, whole.replace("opacity", "unknown")).unwrap();
    let printed = succeed(&from_table);
    let scene = cycles(&succeed(&with("model", &["--compositing", "x-ray"])));
    assert!(
        (cycles(&printed) / scene - 1.0).abs() < 0.002,
        "{printed} {scene}"
    );
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
    assert!(fail(1, &with("fit", &["--max-error", "1e-12"])).contains("above --max-error"));
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
