//! Clocks, parts, frames along a path, and the one question with its answer.

use super::*;

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
    let printed = succeed(&[&["model"], &by_path[..], &["-o", text(&out)]].concat());
    assert!(
        printed.contains("12 frames, the worst is random:200:1, frame "),
        "{printed}"
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
    let printed = succeed(&[&["compare"], &by_path[..], &["-o", text(&out)]].concat());
    assert!(
        printed.contains("12 frames, the one with the lowest PSNR"),
        "{printed}"
    );
    let all = json(&out.join("frames.json"));
    assert_eq!(all["frames"].as_array().unwrap().len(), 12);
    let first = json(&out.join("frame-0001/report.json"));
    assert_eq!(
        first["error"]["rgb"]["max_abs"],
        all["frames"][0]["max_abs"]
    );
    let of_first = &first["pace"]["ms_per_frame"];
    assert!(of_first.as_f64().unwrap() > 0.0);
    assert_eq!(*of_first, all["frames"][0]["ms_per_frame"]);
    assert!(
        printed.contains("frames a second if every frame"),
        "{printed}"
    );
    let page = std::fs::read_to_string(out.join("frame-0001/report.html")).unwrap();
    assert!(
        page.contains(" ms a frame, "),
        "the page of a comparison has a pace"
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
    let printed = fail(
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
    assert!(printed.contains("--camera-path"), "{printed}");
    std::fs::write(path("keys.toml"), PATH.replace("12", "0")).unwrap();
    let printed = fail(1, &[&["model"], &by_path[..]].concat());
    assert!(
        printed.contains("keys.toml:1: frames = 0: allowed are 1 to 100000"),
        "{printed}"
    );
}

/// Lists that keep their order along a path: what that saves and what it does to the picture is told, and it is refused where nothing comes before.
#[test]
fn a_kept_order_has_a_gain_and_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let (keys, out) = (folder.path().join("keys.toml"), folder.path().join("out"));
    std::fs::write(&keys, PATH.replace("12", "8")).unwrap();
    let scene = ["model", "random:2000:1", "--size", "64x48"];
    let path = ["--camera-path", text(&keys)];
    let every = ["--set", "sort_passes=8", "--set", "sort_every=4"];
    let printed = succeed(&[&scene[..], &path, &every, &["-o", text(&out)]].concat());
    assert!(printed.contains("order kept in 6 of 8 frames"), "{printed}");
    assert!(
        printed.contains("against exact order    PSNR worst "),
        "{printed}"
    );
    let timing: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("timing.json")).unwrap()).unwrap();
    for (number, frame) in timing["frames"].as_array().unwrap().iter().enumerate() {
        let kept = &frame["kept"];
        assert_eq!(kept.is_null(), number % 4 == 0, "{number}");
        if kept.is_null() {
            continue;
        }
        let two = |key: &str| [0, 1].map(|which| kept[key][which].as_u64().unwrap());
        let count = |key: &str| kept["lists"][key].as_u64().unwrap();
        let entries = kept["entries"].as_u64().unwrap();
        let moves = 8 * count("came") + entries + count("left");
        // Four bytes an entry, read and written.
        assert_eq!(two("sort_bytes"), [8 * moves, 8 * 8 * entries]);
        let [old, anew] = two("sort_cycles");
        assert!(old < anew && frame["cycles"]["sort"] == old);
        assert!(count("inversions") > 0 && count("inversions") < count("pairs") / 2);
        assert!(kept["error"]["max_abs"].as_f64().unwrap() > 0.0);
    }
    let refused = fail(2, &[&scene[..], &every].concat());
    assert!(
        refused.contains("sort_every = 4: allowed is 1 here"),
        "{refused}"
    );
    let refused = fail(2, &[&["needs"], &scene[1..], &every].concat());
    assert!(
        refused.contains("sort_every = 4: allowed is 1 here"),
        "{refused}"
    );
    let refused = fail(2, &[&scene[..], &path, &["--set", "sort_every=4"]].concat());
    assert!(
        refused.contains("allowed is 1 with a sort_passes below 2"),
        "{refused}"
    );
    let refused = fail(
        2,
        &[&scene[..], &path, &["--set", "sort_every=1025"]].concat(),
    );
    assert!(
        refused.contains("sort_every = 1025: allowed are 1 to 1024"),
        "{refused}"
    );
}

/// The first limit of the answer that a question leaves in its folder.
fn first_standing(arguments: &[&str], out: &Path) -> serde_json::Value {
    succeed(arguments);
    let text = std::fs::read(out.join("answer.json")).unwrap();
    let answer: serde_json::Value = serde_json::from_slice(&text).unwrap();
    answer["answer"]["standings"][0].clone()
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
    let printed = succeed(&with("explore", &asked));
    assert!(
        printed.contains("cheapest point that holds all limits")
            && printed.contains("  next      +"),
        "{printed}"
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
    let printed = succeed(&with(
        "explore",
        &["--space", text(&space), "-o", text(&swept)],
    ));
    assert!(
        printed.contains("2 points, 2 of them new") && printed.contains("assumed clock"),
        "{printed}"
    );
    let points = std::fs::read_to_string(swept.join("points.csv")).unwrap();
    assert!(
        points
            .lines()
            .next()
            .unwrap()
            .contains("frames_per_s,ms_per_frame")
    );

    let energy = first_standing(
        &with(
            "explore",
            &[
                "--space",
                text(&space),
                "--max-energy",
                "0.5",
                "-o",
                text(&path("energy")),
            ],
        ),
        &path("energy"),
    );
    assert_eq!(energy["limit"]["of"], "--max-energy");
    let reached = energy["value"].as_f64().unwrap();
    let design = path("energy").join("design.toml");
    let machine = path("energy").join("machine.toml");
    let again = ["--design", text(&design), "--machine", text(&machine)];
    let printed = succeed(&with("model", &again));
    assert!(
        reached > 0.0 && printed.contains(&format!("energy: {reached:.4} mJ a frame")),
        "{reached} {printed}"
    );
    let none = succeed(&with(
        "explore",
        &["--space", text(&space), "--max-energy", "1e-9"],
    ));
    assert!(
        none.contains("refused before any simulation")
            && none.contains("mJ a frame (--max-energy): asked for at most"),
        "{none}"
    );
    let printed = fail(2, &with("explore", &["--max-energy=-1"]));
    assert!(
        printed.contains("--max-energy") && printed.contains("larger than 0"),
        "{printed}"
    );
    let none = succeed(&with(
        "explore",
        &["--space", text(&space), "--fps", "1000000", "--lut", "10"],
    ));
    assert!(
        none.contains("frames a second (--fps): asked for at least 1000000.00, at most ")
            && none.contains("LUT (--lut): asked for at most 10, at least "),
        "{none}"
    );
    let printed = fail(2, &with("explore", &["-o", text(&out)]));
    assert!(printed.contains("--space"), "{printed}");
}
