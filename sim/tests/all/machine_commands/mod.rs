//! The commands about the machine from outside: what they print, write and refuse.

mod questions;
mod sweeps;

use super::shell::{Shell, holds};

#[test]
fn model_writes_accounts_and_the_resolved_machine() {
    let shell = Shell::new();
    let printed = shell.results("model SCENE --set lanes=4 -o out");
    assert!(printed.contains("simulated cycles per second"));
    let timing = shell.json("out/timing.json");
    let luts = timing["area"]["raster"]["luts"].as_u64().unwrap();
    let area = format!("area: raster units {luts} LUT");
    holds(&printed, &[&area, "Xilinx 7"]);
    assert!(shell.read("out/machine.toml").contains("lanes = 4"));
    let again = shell.results("model SCENE --machine out/machine.toml");
    assert_eq!(again.lines().next(), printed.lines().next());
}

/// The report has the energy that is printed, the export its counts, and a wrong table is refused by name and line.
#[test]
fn model_says_what_a_picture_takes_and_for_what() {
    let shell = Shell::new();
    let printed = shell.results("model SCENE -o out");
    let energy = &shell.json("out/timing.json")["energy"];
    let attojoules = energy["attojoules"].as_u64().unwrap();
    let energy = format!("energy: {:.4} mJ a frame", attojoules as f64 / 1e15);
    holds(&printed, &[&energy, "estimate"]);
    let counts = shell.read("out/action_counts.yaml");
    assert!(counts.contains("- name: splatline.lanes.table_"));

    let shipped = splatline_sim::machine::energy::SHIPPED;
    shell.write("mine.toml", shipped.replace("pj = 3.1", "pj = -3.1"));
    let expected = "mine.toml:31: multiplier.pj = -3.1: allowed are numbers above 0";
    shell.refused(1, "model SCENE --energy mine.toml", expected);
}

/// A part needs a clock; with one the report says what it did, and its requests come out for the simulators of DRAM.
#[test]
fn a_memory_part_is_a_setting_and_its_requests_are_a_trace() {
    let shell = Shell::new();
    let part = "--set memory_part=ddr3-1600-x16";
    let expected = "memory_part = \"ddr3-1600-x16\": allowed with a clock_mhz of 1 to 10000";
    shell.refused(2, &format!("model SCENE {part}"), expected);
    let part = format!("{part} --set clock_mhz=100");
    let printed = shell.results(&format!("model SCENE {part}"));
    holds(&printed, &["memory ddr3-1600-x16: ", "row"]);
    for (format, first) in [("ramulator2", "LD 0x0\n"), ("dramsim3", "0x0 READ 0\n")] {
        let printed = shell.results(&format!("trace SCENE {part} --format {format} -o r.txt"));
        let lines = shell.read("r.txt");
        assert!(lines.starts_with(first), "{}", &lines[..80]);
        let count = lines.lines().count();
        holds(&printed, &[&format!("{count} requests to ddr3-1600-x16")]);
    }
    let channels = "trace SCENE --format dramsim3 -o r.txt";
    shell.refused(2, channels, "--set memory_part=ddr3-1600-x16");
}

/// Machines of others stand beside ours on the same splats; options that none of them would hear are refused.
#[test]
fn machines_of_others_stand_beside_ours() {
    let shell = Shell::new();
    let printed = shell.results("model SCENE --machines -o out");
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
    let json = shell.json("out/machines.json");
    let machines = json["machines"].as_array().unwrap();
    let live = |machine: &serde_json::Value| machine["cycles"]["pixels"]["live"].as_u64().unwrap();
    assert_eq!(live(&machines[0]), live(&machines[1]));
    assert_eq!(
        shell.run("model SCENE --machines --set lanes=4").code,
        Some(2)
    );
}

/// Floating-point datapaths draw by `render` and stand in the report of `compare`, worse with fewer bits; what they
/// cannot draw is refused.
#[test]
fn floating_point_datapaths_are_engines() {
    let shell = Shell::new();
    for engine in ["fp32", "fp16", "bfloat16", "e5m2-fp16", "fp8"] {
        shell.results(&format!("render SCENE --engine {engine} -o x.png"));
    }
    let printed = shell.results("compare SCENE --only --formats -o out");
    let report = shell.json("out/report.json");
    let formats = report["formats"].as_array().unwrap();
    let psnr = formats
        .iter()
        .map(|row| row["error"]["rgb"]["psnr_db"].as_f64().unwrap());
    let psnr: Vec<f64> = psnr.collect();
    assert!(psnr.is_sorted_by(|wide, narrow| wide > narrow), "{psnr:?}");
    let page = shell.read("out/report.html");
    assert!(printed.contains("bfloat16") && page.contains("Floating-point datapaths"));
    shell.refuses(
        "1 render SCENE --engine fp16 --compositing x-ray -o x.png => front to back
         2 compare SCENE --engine fp16 -o out => --formats",
    );
}

/// Beside what is fitted and beside the cheapest machine; a format whose error is too large holds nothing.
#[test]
fn formats_stand_beside_fixed_designs() {
    let shell = Shell::new();
    let asked = "SCENE --psnr 40 --formats fp16,bfloat16,fp8";
    let printed = shell.results(&format!("fit {asked}"));
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
    holds(&printed, &["Cheapest: fixed; bfloat16 takes"]);
    shell.results(&format!("optimize {asked} --fps 60 -o out"));
    let json = shell.json("out/answer.json");
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
    let page = shell.read("out/answer.html");
    let told = [
        "In floating-point formats",
        "error and transistors of a lane",
    ];
    holds(&page, &told);
    shell.refused(2, "fit SCENE --psnr 40 --formats fp12", "fp12");
}

#[test]
fn area_is_counted_for_a_family_or_by_prices_of_ones_own() {
    let shell = Shell::new();
    shell.write("p.toml", "family = \"ice40\"\nluts_per_dsp = 1.0\n");
    let ecp5 = shell.results("model SCENE --family ecp5");
    holds(&ecp5, &["area for ECP5", "of its synthesis"]);
    let own = shell.results("model SCENE --calibration p.toml");
    holds(&own, &["not held against any synthesis"]);
    shell.write("p.toml", "luts_per_dps = 1.0\n");
    shell.refused(1, "model SCENE --calibration p.toml", "luts_per_dps");
}

#[test]
fn a_table_of_footprints_is_timed_like_the_scene_it_came_from() {
    let shell = Shell::new();
    shell.results("footprints SCENE -o f.csv");
    let from_table = "model --footprints f.csv --screen 48x32";
    let printed = shell.results(from_table);
    holds(&printed, &["cycles = geometry", "0 left out"]);
    let cycles = |printed: &str| {
        let line = printed
            .lines()
            .find(|line| line.contains(" cycles = "))
            .unwrap();
        let words: Vec<&str> = line.split_whitespace().collect();
        words[1].parse::<f64>().unwrap()
    };
    let near = |printed: &str, scene: &str| {
        let ratio = cycles(printed) / cycles(scene);
        assert!((ratio - 1.0).abs() < 0.002, "{printed} {scene}");
    };
    near(&printed, &shell.results("model SCENE"));
    // Without opacities nothing finishes; nor does anything in an X-ray.
    let whole = shell.read("f.csv");
    shell.write("f.csv", whole.replace("opacity", "unknown"));
    let x_ray = shell.results("model SCENE --compositing x-ray");
    near(&shell.results(from_table), &x_ray);
    let without: String = whole
        .lines()
        .map(|line| line.rsplit_once(',').unwrap().0.to_owned() + "\n")
        .collect();
    shell.write("f.csv", without);
    let refused = shell.refused(1, from_table, "no cut-off");
    holds(&refused, &["--cutoff"]);
    shell.write("empty.csv", "");
    shell.refused(1, "model --footprints empty.csv", "no column 'u'");
}

#[test]
fn needs_fit_and_trace_answer() {
    let shell = Shell::new();
    let needs = shell.results("needs SCENE --json n.json");
    holds(&needs, &["row_fifo", "layers: at most"]);
    let fit = shell.results("fit SCENE --max-error 0.02 -o d.toml");
    assert!(fit.contains("binding width"));
    shell.results("render SCENE --design d.toml -o x.png");
    shell.refuses(
        "1 fit SCENE --max-error 1e-12 => above --max-error 1.000e-12
         1 fit SCENE --psnr 500 => below --psnr 500.00",
    );
    for format in ["kanata", "vcd", "perfetto"] {
        let printed = shell.results(&format!(
            "trace SCENE --format {format} --last 20 -o {format}"
        ));
        assert!(printed.contains("splats 0 to 20"), "{printed}");
        assert!(shell.bytes(format).len() > 200);
    }
}

#[test]
fn bad_machines_name_key_line_and_range() {
    let shell = Shell::new();
    shell.write("m.toml", "[lanes]\nlanes = 5\n");
    shell.refuses(
        "1 model SCENE --machine m.toml => m.toml:2: lanes.lanes = 5: allowed are 1, 2, 4
         2 model SCENE --set lanes=5 => lanes = 5: allowed are
         2 model SCENE --set lane=4 => did you mean lanes
         2 trace SCENE --format vcd --first 9 --last 3 -o x => smaller",
    );
}
