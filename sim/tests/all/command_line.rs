//! The binary from outside: exit codes, and which stream says what.

use super::photos::gaussians;
use super::shell::{Shell, holds, said};
use std::path::{Path, PathBuf};

/// Files of scenes that others wrote.
fn scene_file(name: &str) -> PathBuf {
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/tests/files");
    files.join(name)
}

#[test]
fn bad_usage_is_exit_code_2_on_stderr() {
    let shell = Shell::new();
    let mut lines: Vec<String> = [
        "rendr",
        "render",
        "render a.ply",
        "render a.ply -o a.png --edges",
        "render a.ply -o a.png --alpha --background white",
        "compare a.ply -o a --design unheard-of",
        "page random:9 -o a.png",
        "page random:9 -o a.html --traversal stamp",
        "page random:9 -o a.html --size 4000x40",
    ]
    .map(str::to_owned)
    .to_vec();
    // Options, of which the last one does not take these values.
    let values = "
        --size: 0x5 5x0 16385x1 5 5x-1 x 1e3x2
        --target 0,0,0 --eye: 1,2 1,2,3,4 1,nan,3 inf,0,0 a,b,c
        --eye: 1,2,3
        --target: 1,2,3
        --orbit: 30 30,90
        --zoom: 0
        --eye 1,2,3 --target 0,0,0 --fov: 0 180
        --camera c.json --target 0,0,0 --eye: 1,2,3
        --camera c.json --fov: 40
        --camera c.json --orbit: 30,0
        --background: grey 1,1,2
        --rules: gl
        --engine: gpu
        --design: fancy
        --depth: 12
        --threads: 0 -1 99999
        --repeat: 0
        --traversal: zigzag
        --compositing: sideways
        --layers: 2
        --as surface --layers: 5
        --as surface --z-threshold: 0";
    for row in values.trim().lines() {
        let (options, values) = row.trim().split_once(": ").unwrap();
        let line = |value| format!("render a.ply -o a.png {options} {value}");
        lines.extend(values.split(' ').map(line));
    }
    for line in &lines {
        let said = shell.run(line);
        assert_eq!(said.code, Some(2), "{line}: {}", said.stderr);
        assert!(
            said.stdout.is_empty() && said.stderr.starts_with("error: "),
            "{line}"
        );
    }
}

/// Every command that prints, with little work: what cannot be printed must not look printed.
const PRINTING: [&str; 19] = [
    "--help",
    "--version",
    "simulate --help",
    "render random:9 --size 8x8 -o a.png",
    "render random:9 --size 8x8 -o -",
    "bake random:9 -o scene.rs",
    "info random:9",
    "completions bash",
    "man -o man",
    "compare random:9 --size 8x8 --only -o compare",
    "footprints random:9 --size 8x8 -o f.csv",
    "simulate random:9 --size 8x8",
    "profile random:9 --size 8x8",
    "fit random:9 --size 8x8 --max-error 0.5",
    "optimize random:9 --size 8x8 --fps 1",
    "sweep random:9 --size 8x8 --no-error --space s.toml -o sweep",
    "trace random:9 --size 8x8 --format vcd -o t.vcd",
    "page random:9 --size 8x8 -o p.html",
    "vectors export --splats 1 --size 8x8 vectors",
];

#[cfg(target_os = "linux")]
#[test]
fn output_that_fails_fails_and_a_reader_that_left_does_not() {
    let shell = Shell::new();
    shell.write("s.toml", "[machine]\nlanes = [1, 2]\n");
    let run = |line: &str, output: std::process::Stdio| {
        let mut command = shell.command(line);
        command.stdout(output);
        let said = said(command);
        (said.code, said.stderr)
    };
    for line in PRINTING {
        let full = std::fs::File::create("/dev/full").unwrap();
        let (code, printed) = run(line, full.into());
        assert_eq!(code, Some(1), "{line}: {printed}");
        holds(&printed, &["cannot write to the standard output"]);
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let (code, printed) = run(line, writer.into());
        assert_eq!(code, Some(0), "{line}: {printed}");
    }
}

/// The list above is complete: whatever command is added must be in it, or here with its reason.
#[test]
fn every_command_is_tried_with_a_full_disk() {
    // All minutes long, and all through the same function.
    let long = ["gallery", "results", "stability", "help"];
    let help = Shell::new().results("--help");
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = commands
        .take_while(|line| !line.is_empty())
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next());
    let mut found = 0;
    for name in names {
        found += 1;
        let tried = PRINTING
            .iter()
            .any(|line| line.split(' ').next() == Some(name));
        assert!(tried || long.contains(&name), "{name} is not tried");
    }
    assert!(found > 12, "{found} commands");
}

/// Exit code 0 and a black picture: the standard error says why.
#[test]
fn an_empty_picture_says_why() {
    let shell = Shell::new();
    shell.write("c.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
    let away = "--eye 0,0,900 --target 0,0,1000 --up 0,1,0 --size 16x16 -o a.png";
    for scene in ["random:9", "random:9 --engine float", "c.xyz --as surface"] {
        let said = shell.run(&format!("render {scene} {away}"));
        assert_eq!(said.code, Some(0), "{}", said.stderr);
        holds(&said.stderr, &["the picture is empty: all ", "culled"]);
    }
    shell.results("render random:9 --size 16x16 -o a.png");
}

/// What is found on an empty picture holds for no other one: every command that measures says that it is empty, and
/// equal pictures have no decibels.
#[test]
fn measures_of_an_empty_picture_say_so() {
    let shell = Shell::new();
    let away = "random:9 --eye 0,0,900 --target 0,0,1000 --up 0,1,0 --size 16x16";
    for (command, options) in [
        ("fit", "--max-error 0.1"),
        ("optimize", "--fps 1 --max-error 0.1"),
        ("simulate", ""),
        ("profile", ""),
        ("compare", "--only --formats -o out"),
    ] {
        let line = format!("{command} {away} {options}");
        let said = shell.run(&line);
        assert_eq!(said.code, Some(0), "{line}: {}", said.stderr);
        let empty = "the picture is empty: all 9 splats are culled";
        assert!(said.stderr.contains(empty), "{line}: {}", said.stderr);
        let printed = String::from_utf8(said.stdout).unwrap();
        assert!(
            !printed.contains("identical dB") && !printed.contains("inf dB"),
            "{printed}"
        );
    }
}

/// PSNR stands beside the largest error and the bias, also in what bake says.
#[test]
fn bake_tells_the_bias() {
    let shell = Shell::new();
    let printed = shell.succeed("bake random:50 --size 32x32 --keep 20 --json b.json -o s.bin");
    holds(&printed, &["PSNR ", ", bias "]);
    let report = shell.json("b.json");
    assert_eq!(report["format"], "splatline-bake/1");
    let bias = report["views"][0]["bias"].as_f64().unwrap();
    assert!(
        bias.abs() <= report["views"][0]["max_abs"].as_f64().unwrap(),
        "{report}"
    );
}

#[test]
fn info_tells_what_is_in_a_scene() {
    let shell = Shell::new();
    let cloud = "0 0 0 0 0 1\n1 0 0 0 0 1\n0 2 0 0 0 1\n1 2 0 0 0 1\nnan 0 0 0 0 1\n";
    shell.write("cloud.xyz", cloud);
    let printed = shell.succeed("info cloud.xyz");
    let expected = [
        "points of a surface",
        "count      4",
        "unusable 1",
        "up         +z",
        "radius ",
    ];
    holds(&printed, &expected);
    let info = shell.succeed("info random:100 --json -");
    let info: serde_json::Value = serde_json::from_str(&info).unwrap();
    assert_eq!(
        (
            &info["kind"],
            &info["count"],
            &info["dropped"]["non_finite"]
        ),
        (&"3D Gaussians".into(), &100.into(), &0.into())
    );
    assert_eq!(shell.run("info nothing.ply").code, Some(1));
}

/// A picture on stdout is a picture and nothing else.
#[test]
fn a_stream_holds_the_result_alone() {
    let shell = Shell::new();
    let said = shell.run("render random:50 --size 16x16 -o -");
    assert_eq!(said.code, Some(0), "{}", said.stderr);
    assert!(said.stdout.starts_with(b"\x89PNG\r\n"));
    assert!(said.stderr.contains("random:50"));
    let table = shell.succeed("footprints random:5 --size 16x16 -o -");
    assert_eq!(
        (table.lines().count(), table.starts_with("index,u,v")),
        (6, true)
    );
}

/// A scene without a name is recognised by its first bytes.
#[test]
fn a_stream_may_be_the_scene() {
    let shell = Shell::new();
    shell.write("cloud.xyz", "0 0 0\n1 0 0\n0 2 0\n1 2 0.5\n");
    for (file, options) in [
        (scene_file("compressed.ply"), ""),
        (scene_file("second.sog"), ""),
        (scene_file("tiny.glb"), ""),
        (shell.path("cloud.xyz"), "--as surface"),
    ] {
        let drawn = |scene: &str| {
            let mut command = shell.command(&format!("render {scene} {options} --size 16x16 -o -"));
            command.stdin(std::fs::File::open(&file).unwrap());
            let said = said(command);
            assert_eq!(said.code, Some(0), "{}", said.stderr);
            said.stdout
        };
        assert!(drawn("-") == drawn(file.to_str().unwrap()), "{file:?}");
    }
}

/// The rules of 3D Gaussian splatting end opacities at 0.999, and only a splat beyond that needs the unit.
#[test]
fn profile_names_the_opacity_clamp_where_it_clamps() {
    let shell = Shell::new();
    for (logit, expected) in [
        (8, "used: largest peak 0.9997"),
        (4, "not needed: largest peak 0.98"),
    ] {
        let record = format!("0 0 0 1 1 1 {logit} -1 -1 -1 1 0 0 0");
        let text = gaussians(3, &[record]);
        shell.write("one.ply", text);
        let printed = shell.succeed("profile one.ply --size 16x16");
        let line = printed.lines().find(|line| line.contains("opacity_clamp"));
        let line = line.unwrap_or_else(|| panic!("{printed}"));
        assert!(
            line.contains(expected) && line.ends_with("end at 0.999"),
            "{line}"
        );
    }
}

#[test]
fn shells_and_man_are_served() {
    let shell = Shell::new();
    let script = shell.succeed("completions bash");
    assert!(script.contains("splatline__subcmd__render") || script.contains("splatline__render"));
    shell.succeed("man -o man1");
    let page = shell.read("man1/splatline-render.1");
    holds(&page, &["\\-\\-background", ".TH"]);
}

/// A file from elsewhere with a pose from elsewhere, to a report in one command.
#[test]
fn first_contact_is_one_command() {
    let shell = Shell::new();
    let cameras = "3 PINHOLE 64 48 60 61 32 24\n";
    shell.write("sparse/0/cameras.txt", cameras);
    let images = "7 1 0 0 0 0.5 0.25 9 3 a.png\n\n8 1 0 0 0 0 0 30 3 b.png\n\n";
    shell.write("sparse/0/images.txt", images);
    for scene in ["second.sog", "first.sog", "compressed.ply"] {
        let file = scene_file(scene);
        let pose = "--camera . --image b.png";
        shell.succeed(&format!("compare {} {pose} -o {scene}", file.display()));
        let page = shell.read(&format!("{scene}/report.html"));
        assert!(page.contains("</html>"), "{scene}");
        let report = shell.json(&format!("{scene}/report.json"));
        let camera = &report["plan"]["camera"];
        let numbers = ["width", "height", "fx", "fy"].map(|key| camera[key].as_f64());
        assert_eq!(
            numbers,
            [64.0, 48.0, 60.0, 61.0].map(Some),
            "{scene}: {camera}"
        );
        assert_eq!(
            camera["world_to_camera"][11].as_f64(),
            Some(30.0),
            "{camera}"
        );
    }
}

/// A scene of glTF that is sorted by distance, the extension's own default, against the same one sorted by depth: what
/// sorts it honours that, and what cannot says so.
#[test]
fn a_files_order_is_honoured_or_refused() {
    let shell = Shell::new();
    let stated = std::fs::read(scene_file("tiny.glb")).unwrap();
    // A key of the same length that means nothing, so that no other number of the file changes.
    let (key, other) = (&b"sortingMethod"[..], &b"sortingNothing"[..13]);
    let at = stated.windows(13).position(|bytes| bytes == key).unwrap();
    let mut silent = stated.clone();
    silent[at..at + 13].copy_from_slice(other);
    shell.write("depth.glb", stated);
    shell.write("distance.glb", silent);
    let view = "--eye 0,1,-6 --target 1,2,0 --fov 100 --size 32x24";
    let depths = |order: &str, engine: &str| -> Vec<f64> {
        let scene = format!("{order}.glb {view}");
        let table = shell.succeed(&format!("footprints {scene} --engine {engine} -o -"));
        let field = |line: &str| line.split(',').nth(3)?.parse().ok();
        table.lines().skip(1).filter_map(field).collect()
    };
    for order in ["depth", "distance"] {
        let printed = shell.succeed(&format!("info {order}.glb"));
        assert!(printed.contains(&format!("sorted by {order}")), "{printed}");
        shell.succeed(&format!("render {order}.glb {view} -o x.png"));
        shell.succeed(&format!("model {order}.glb {view}"));
        let (fixed, float) = (depths(order, "fixed"), depths(order, "float"));
        assert!(fixed.len() == 2 && float.len() == 2, "{fixed:?} {float:?}");
        for (a, b) in fixed.iter().zip(&float) {
            assert!((a / b - 1.0).abs() < 1e-5, "{order}: {a} {b}");
        }
    }
    let [depth, distance] = ["depth", "distance"].map(|order| depths(order, "float"));
    assert!(depth.iter().zip(&distance).all(|(near, far)| far > near));
    shell.refuses(
        "1 render distance.glb --rules ewa --antialias swan --points auto -o x.png => spheres go by the depth
         2 vectors export --scene distance.glb v => a setup unit whose key is the depth",
    );
}
