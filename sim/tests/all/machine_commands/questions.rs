//! Clocks, parts, frames along a path, and the one question with its answer.

use super::*;

#[test]
fn a_pace_says_whose_clock_it_goes_by() {
    let shell = Shell::new();
    let assumed = shell.results("model SCENE");
    holds(&assumed, &["assumed: no clock_mhz was given"]);
    let machine = "--set clock_mhz=200 --set overlap_frames=2 --part XC7A100T";
    let given = shell.results(&format!("model SCENE {machine} -o out"));
    let clock = "clock: 200 MHz (clock_mhz of the machine)";
    holds(&given, &[clock, "part XC7A100T (DS180"]);
    let timing = shell.json("out/timing.json");
    let pace = &timing["pace"];
    let cycles = pace["cycles_per_frame"].as_f64().unwrap();
    let fps = pace["frames_per_s"].as_f64().unwrap();
    assert!((fps * cycles / 200e6 - 1.0).abs() < 1e-9);
    assert!(cycles < timing["cycles"]["total"].as_f64().unwrap());
    assert_eq!(timing["area"]["part"]["dsps"], 240);
    assert!(shell.read("out/timing.html").contains("<svg"));
    shell.refuses(
        "2 model SCENE --set clock_mhz=10001 => --set: clock_mhz = 10001: allowed are 0 to 10000
         2 model SCENE --set packet_cache=100 => packet_cache = 100: allowed are 0, 16, 32
         2 model SCENE --part xc2000 => unknown part 'xc2000': there are ice40up5k",
    );
}

const PATH: &str = "frames = 12\n[[key]]\neye = [0.0, 0.0, -9.0]\ntarget = [0.0, 0.0, 5.0]\nup = [0.0, -1.0, 0.0]\n\
                    [[key]]\neye = [3.0, 1.0, -3.0]\ntarget = [0.0, 0.0, 5.0]\nup = [0.0, -1.0, 0.0]\n";

#[test]
fn many_frames_are_one_report() {
    let shell = Shell::new();
    shell.write("keys.toml", PATH);
    let by_path = "random:200:1 --size 32x24 --camera-path keys.toml";

    let printed = shell.results(&format!("model {by_path} -o model"));
    holds(&printed, &["12 frames, the worst is random:200:1, frame "]);
    let timing = shell.json("model/timing.json");
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

    shell.results(&format!("render {by_path} --json r.json -o x.png"));
    assert!(shell.has("x-0001.png") && shell.has("x-0012.png") && !shell.has("x.png"));
    assert_eq!(shell.json("r.json")["frames"].as_array().unwrap().len(), 12);

    let printed = shell.results(&format!("compare {by_path} -o compare"));
    holds(&printed, &["12 frames, the one with the lowest PSNR"]);
    let all = shell.json("compare/frames.json");
    assert_eq!(all["frames"].as_array().unwrap().len(), 12);
    let first = shell.json("compare/frame-0001/report.json");
    assert_eq!(
        first["error"]["rgb"]["max_abs"],
        all["frames"][0]["max_abs"]
    );
    let of_first = &first["pace"]["ms_per_frame"];
    assert!(of_first.as_f64().unwrap() > 0.0);
    assert_eq!(*of_first, all["frames"][0]["ms_per_frame"]);
    holds(&printed, &["frames a second if every frame"]);
    let page = shell.read("compare/frame-0001/report.html");
    holds(&page, &[" ms a frame, "]);
    let page = shell.read("compare/frames.html");
    assert!(page.contains("frame-0012/report.html"));

    let needed = shell.results("needs random:100:1 random:100:2 --size 24x24");
    holds(&needed, &["random:100:1: ", "random:100:2: "]);
    shell.write("keys.toml", PATH.replace("12", "0"));
    shell.refuses(
        "2 model random:9 --camera-path k.toml --fov 40 => --camera-path
         1 model random:9 --camera-path keys.toml => keys.toml:1: frames = 0: allowed are 1 to 100000",
    );
}

/// Lists that keep their order along a path: what that saves and what it does to the picture is told, and it is refused
/// where nothing comes before.
#[test]
fn a_kept_order_has_a_gain_and_an_error() {
    let shell = Shell::new();
    shell.write("keys.toml", PATH.replace("12", "8"));
    let scene = "random:2000:1 --size 64x48";
    let path = "--camera-path keys.toml";
    let every = "--set sort_passes=8 --set sort_every=4";
    let printed = shell.results(&format!("model {scene} {path} {every} -o out"));
    let against = "against exact order    PSNR worst ";
    holds(&printed, &["order kept in 6 of 8 frames", against]);
    let timing = shell.json("out/timing.json");
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
    shell.refuses(&format!(
        "2 model {scene} {every} => sort_every = 4: allowed is 1 here
         2 needs {scene} {every} => sort_every = 4: allowed is 1 here
         2 model {scene} {path} --set sort_every=4 => allowed is 1 with a sort_passes below 2
         2 model {scene} {path} --set sort_every=1025 => sort_every = 1025: allowed are 1 to 1024"
    ));
}

/// From the question to an answer whose design and machine hold what it says when they are used, also as the base of a
/// space.
#[test]
fn a_question_has_one_answer() {
    let shell = Shell::new();
    let fields = "[design]\nmantissa = { from = 12, to = 24 }\nalpha = { from = 8, to = 24 }\n[machine]\nlanes = [1, 2, 4]\n\
                  rows_at_once = [1, 2]\nread_bandwidth = [4, 8]\nwrite_bandwidth = [4]\n";
    shell.write("s.toml", fields);
    let explore = "explore SCENE --space s.toml";
    let limits = "--fps 500 --max-error 0.01 --part xc7a200t --set clock_mhz=50";
    let printed = shell.results(&format!("{explore} {limits} -o out"));
    let cheapest = "cheapest point that holds all limits";
    holds(&printed, &[cheapest, "  next      +"]);
    let answer = shell.json("out/answer.json");
    let reached = &answer["answer"]["found"][0]["reached"];
    let model = "model SCENE --design out/design.toml --machine out/machine.toml -o model";
    shell.results(model);
    let timing = shell.json("model/timing.json");
    assert_eq!(timing["pace"], reached["pace"]);
    assert_eq!(timing["area"]["luts_in_all"], reached["area"]["weight"]);
    let base = "[design]\nbase = [\"lean18\", \"out/design.toml\"]\n";
    shell.write("s.toml", base);
    let printed = shell.results(&format!("{explore} -o swept"));
    holds(&printed, &["2 points, 2 of them new", "assumed clock"]);
    let points = shell.read("swept/points.csv");
    let heading = points.lines().next().unwrap();
    holds(heading, &["frames_per_s,ms_per_frame"]);

    shell.results(&format!("{explore} --max-energy 0.5 -o energy"));
    let energy = &shell.json("energy/answer.json")["answer"]["standings"][0];
    assert_eq!(energy["limit"]["of"], "--max-energy");
    let reached = energy["value"].as_f64().unwrap();
    let model = "model SCENE --design energy/design.toml --machine energy/machine.toml";
    let printed = shell.results(model);
    assert!(reached > 0.0, "{reached}");
    holds(&printed, &[&format!("energy: {reached:.4} mJ a frame")]);
    // The answer is printed, and scripts need not read it.
    let without = |limits: &str| {
        let said = shell.run(&format!("{explore} {limits}"));
        assert_eq!(said.code, Some(1), "{limits}: {}", said.stderr);
        holds(&said.stderr, &["no point holds all limits"]);
        String::from_utf8(said.stdout).unwrap()
    };
    let none = without("--max-energy 1e-9");
    let energy = "mJ a frame (--max-energy): asked for at most";
    holds(&none, &["refused before any simulation", energy]);
    let printed = shell.refused(2, "explore SCENE --max-energy=-1", "--max-energy");
    holds(&printed, &["larger than 0"]);
    let none = without("--fps 1000000 --lut 10");
    let fps = "frames a second (--fps): asked for at least 1000000.00, at most ";
    let luts = "LUT (--lut): asked for at most 10, at least ";
    holds(&none, &[fps, luts]);
    shell.refused(2, "explore SCENE -o out", "--space");
}
