//! The binary from outside: exit codes, and which stream says what.

use std::path::Path;
use std::process::{Command, Output};

pub fn splatline(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_splatline"))
        .args(arguments)
        .output()
        .unwrap()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What must be refused with a message, whatever it asks for.
pub fn refused(code: i32, arguments: &[&str], expected: &str) {
    let output = splatline(arguments);
    let printed = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {printed}");
    assert!(printed.contains(expected), "{arguments:?}: {printed}");
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
        &["page", "random:9", "-o", "a.png"],
        &["page", "random:9", "-o", "a.html", "--traversal", "stamp"],
        &["page", "random:9", "-o", "a.html", "--size", "4000x40"],
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

/// Every command that prints, with little work: what cannot be printed must not look printed.
const PRINTING: [&[&str]; 19] = [
    &["--help"],
    &["--version"],
    &["simulate", "--help"],
    &["render", "random:9", "--size", "8x8", "-o", "OUT/a.png"],
    &["render", "random:9", "--size", "8x8", "-o", "-"],
    &["bake", "random:9", "-o", "OUT/scene.rs"],
    &["info", "random:9"],
    &["completions", "bash"],
    &["man", "-o", "OUT/man"],
    &[
        "compare",
        "random:9",
        "--size",
        "8x8",
        "--only",
        "-o",
        "OUT/compare",
    ],
    &["footprints", "random:9", "--size", "8x8", "-o", "OUT/f.csv"],
    &["simulate", "random:9", "--size", "8x8"],
    &["profile", "random:9", "--size", "8x8"],
    &["fit", "random:9", "--size", "8x8", "--max-error", "0.5"],
    &["optimize", "random:9", "--size", "8x8", "--fps", "1"],
    &[
        "sweep",
        "random:9",
        "--size",
        "8x8",
        "--no-error",
        "--space",
        "OUT/s.toml",
        "-o",
        "OUT/sweep",
    ],
    &[
        "trace",
        "random:9",
        "--size",
        "8x8",
        "--format",
        "vcd",
        "-o",
        "OUT/t.vcd",
    ],
    &["page", "random:9", "--size", "8x8", "-o", "OUT/p.html"],
    &[
        "vectors",
        "export",
        "--splats",
        "1",
        "--size",
        "8x8",
        "OUT/vectors",
    ],
];

fn with_output(
    arguments: &[&str],
    folder: &std::path::Path,
    output: std::process::Stdio,
) -> Output {
    let arguments = arguments
        .iter()
        .map(|argument| argument.replace("OUT", folder.to_str().unwrap()));
    Command::new(env!("CARGO_BIN_EXE_splatline"))
        .args(arguments)
        .stdout(output)
        .output()
        .unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_fails_fails_and_a_reader_that_left_does_not() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), "[machine]\nlanes = [1, 2]\n").unwrap();
    for arguments in PRINTING {
        let full = std::fs::File::create("/dev/full").unwrap();
        let output = with_output(arguments, folder.path(), full.into());
        let printed = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {printed}");
        assert!(
            printed.contains("cannot write to the standard output"),
            "{arguments:?}: {printed}"
        );
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = with_output(arguments, folder.path(), writer.into());
        assert_eq!(
            output.status.code(),
            Some(0),
            "{arguments:?}: {}",
            stderr(&output)
        );
    }
}

/// The list above is complete: whatever command is added must be in it, or here with its reason.
#[test]
fn every_command_is_tried_with_a_full_disk() {
    // All minutes long, and all through the same function.
    let long = ["gallery", "results", "stability", "help"];
    let help = String::from_utf8(splatline(&["--help"]).stdout).unwrap();
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = commands
        .take_while(|line| !line.is_empty())
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next());
    let mut found = 0;
    for name in names {
        found += 1;
        let tried = PRINTING.iter().any(|arguments| arguments[0] == name);
        assert!(tried || long.contains(&name), "{name} is not tried");
    }
    assert!(found > 12, "{found} commands");
}

/// Exit code 0 and a black picture: the standard error says why.
#[test]
fn an_empty_picture_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("a.png").display().to_string();
    let cloud = folder.path().join("c.xyz").display().to_string();
    std::fs::write(&cloud, "0 0 0\n1 0 0\n0 1 0\n1 1 0\n").unwrap();
    let away = [
        "--eye", "0,0,900", "--target", "0,0,1000", "--up", "0,1,0", "--size", "16x16",
    ];
    for (scene, engine) in [
        ("random:9", "fixed"),
        ("random:9", "float"),
        (&*cloud, "fixed"),
    ] {
        let mut arguments = vec!["render", scene, "--engine", engine, "-o", &picture];
        arguments.extend(away);
        if scene == cloud {
            arguments.extend(["--as", "surface"]);
        }
        let output = splatline(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let printed = stderr(&output);
        assert!(
            printed.contains("the picture is empty: all ") && printed.contains("culled"),
            "{printed}"
        );
    }
    let seen = splatline(&["render", "random:9", "--size", "16x16", "-o", &picture]);
    assert_eq!(stderr(&seen), "");
}

/// What is found on an empty picture holds for no other one: every command that measures says that it is empty, and equal pictures have no decibels.
#[test]
fn measures_of_an_empty_picture_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").display().to_string();
    let away = "random:9 --eye 0,0,900 --target 0,0,1000 --up 0,1,0 --size 16x16";
    for (command, options) in [
        ("fit", "--max-error 0.1"),
        ("optimize", "--fps 1 --max-error 0.1"),
        ("simulate", ""),
        ("profile", ""),
        ("compare", "--only --formats -o OUT"),
    ] {
        let options = options.replace("OUT", &out);
        let line = format!("{command} {away} {options}");
        let output = splatline(&line.split_whitespace().collect::<Vec<_>>());
        let (said, printed) = (stderr(&output), String::from_utf8_lossy(&output.stdout));
        assert_eq!(output.status.code(), Some(0), "{line}: {said}");
        assert!(
            said.contains("the picture is empty: all 9 splats are culled"),
            "{line}: {said}"
        );
        assert!(
            !printed.contains("identical dB") && !printed.contains("inf dB"),
            "{printed}"
        );
    }
}

/// PSNR stands beside the largest error and the bias, also in what bake says.
#[test]
fn bake_tells_the_bias() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let json = path("b.json");
    let output = splatline(&[
        "bake",
        "random:50",
        "--size",
        "32x32",
        "--keep",
        "20",
        "--json",
        &json,
        "-o",
        &path("s.bin"),
    ]);
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        printed.contains("PSNR ") && printed.contains(", bias "),
        "{printed}"
    );
    let report: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    let bias = report["views"][0]["bias"].as_f64().unwrap();
    assert!(
        bias.abs() <= report["views"][0]["max_abs"].as_f64().unwrap(),
        "{report}"
    );
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
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for expected in [
        "points of a surface",
        "count      4",
        "unusable 1",
        "up         +z",
        "radius ",
    ] {
        assert!(printed.contains(expected), "{expected}: {printed}");
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

/// A scene without a name is recognised by its first bytes.
#[test]
fn a_stream_may_be_the_scene() {
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/tests/files");
    for name in ["compressed.ply", "second.sog", "tiny.glb"] {
        let file = files.join(name);
        let drawn = |scene: &str| {
            let output = Command::new(env!("CARGO_BIN_EXE_splatline"))
                .args(["render", scene, "--size", "16x16", "-o", "-"])
                .stdin(std::fs::File::open(&file).unwrap())
                .output()
                .unwrap();
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
            output.stdout
        };
        assert!(drawn("-") == drawn(file.to_str().unwrap()), "{name}");
    }
    let folder = tempfile::tempdir().unwrap();
    let cloud = folder.path().join("cloud.xyz");
    std::fs::write(&cloud, "0 0 0\n1 0 0\n0 2 0\n1 2 0.5\n").unwrap();
    let drawn = |scene: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_splatline"))
            .args([
                "render", scene, "--as", "surface", "--size", "16x16", "-o", "-",
            ])
            .stdin(std::fs::File::open(&cloud).unwrap())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        output.stdout
    };
    assert!(drawn("-") == drawn(cloud.to_str().unwrap()), "points");
}

/// The rules of 3D Gaussian splatting end opacities at 0.999, and only a splat beyond that needs the unit.
#[test]
fn profile_names_the_opacity_clamp_where_it_clamps() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("one.ply");
    let fields =
        "x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3";
    let properties = fields.replace(' ', "\nproperty float ");
    for (logit, expected) in [
        (8, "used: largest peak 0.9997"),
        (4, "not needed: largest peak 0.98"),
    ] {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float {properties}\nend_header\n0 0 0 1 1 1 {logit} -1 -1 -1 1 0 0 0\n"
        );
        std::fs::write(&scene, text).unwrap();
        let output = splatline(&["profile", scene.to_str().unwrap(), "--size", "16x16"]);
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        let line = printed.lines().find(|line| line.contains("opacity_clamp"));
        let line = line.unwrap_or_else(|| panic!("{printed}{}", stderr(&output)));
        assert!(
            line.contains(expected) && line.ends_with("end at 0.999"),
            "{line}"
        );
    }
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

/// A file from elsewhere with a pose from elsewhere, to a report in one command.
#[test]
fn first_contact_is_one_command() {
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/tests/files");
    let folder = tempfile::tempdir().unwrap();
    let poses = folder.path().join("sparse/0");
    std::fs::create_dir_all(&poses).unwrap();
    std::fs::write(poses.join("cameras.txt"), "3 PINHOLE 64 48 60 61 32 24\n").unwrap();
    let images = "7 1 0 0 0 0.5 0.25 9 3 a.png\n\n8 1 0 0 0 0 0 30 3 b.png\n\n";
    std::fs::write(poses.join("images.txt"), images).unwrap();
    for scene in ["second.sog", "first.sog", "compressed.ply"] {
        let out = folder.path().join(scene);
        let [scene, poses, out] = [&files.join(scene), &folder.path().to_owned(), &out]
            .map(|path| path.to_str().unwrap().to_owned());
        let output = splatline(&[
            "compare", &scene, "--camera", &poses, "--image", "b.png", "-o", &out,
        ]);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{scene}: {}",
            stderr(&output)
        );
        let page = std::fs::read_to_string(format!("{out}/report.html")).unwrap();
        assert!(page.contains("</html>"), "{scene}");
        let report = std::fs::read(format!("{out}/report.json")).unwrap();
        let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
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

/// A scene of glTF that is sorted by distance, the extension's own default, against the same one sorted by depth: what sorts it honours
/// that, and what cannot says so.
#[test]
fn a_files_order_is_honoured_or_refused() {
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/tests/files");
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let stated = std::fs::read(files.join("tiny.glb")).unwrap();
    // A key of the same length that means nothing, so that no other number of the file changes.
    let (key, other) = (&b"sortingMethod"[..], &b"sortingNothing"[..13]);
    let at = stated.windows(13).position(|bytes| bytes == key).unwrap();
    let mut silent = stated.clone();
    silent[at..at + 13].copy_from_slice(other);
    std::fs::write(path("depth.glb"), stated).unwrap();
    std::fs::write(path("distance.glb"), silent).unwrap();
    let view = [
        "--eye", "0,1,-6", "--target", "1,2,0", "--fov", "100", "--size", "32x24",
    ];
    let run = |arguments: &[&str]| {
        let output = splatline(&[arguments, &view[..]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let depths = |scene: &str, engine: &str| -> Vec<f64> {
        let table = run(&["footprints", scene, "--engine", engine, "-o", "-"]);
        let field = |line: &str| line.split(',').nth(3)?.parse().ok();
        table.lines().skip(1).filter_map(field).collect()
    };
    for order in ["depth", "distance"] {
        let scene = path(&format!("{order}.glb"));
        let info = splatline(&["info", &scene]).stdout;
        let printed = String::from_utf8_lossy(&info).into_owned();
        assert!(printed.contains(&format!("sorted by {order}")), "{printed}");
        run(&["render", &scene, "-o", &path("x.png")]);
        run(&["model", &scene]);
        let (fixed, float) = (depths(&scene, "fixed"), depths(&scene, "float"));
        assert!(fixed.len() == 2 && float.len() == 2, "{fixed:?} {float:?}");
        for (a, b) in fixed.iter().zip(&float) {
            assert!((a / b - 1.0).abs() < 1e-5, "{order}: {a} {b}");
        }
    }
    let [depth, distance] = ["depth.glb", "distance.glb"].map(|name| depths(&path(name), "float"));
    assert!(depth.iter().zip(&distance).all(|(near, far)| far > near));
    let scene = path("distance.glb");
    let swan = ["--rules", "ewa", "--antialias", "swan", "--points", "auto"];
    let picture = path("x.png");
    let points = [&["render", &scene, "-o", &picture], &swan[..]].concat();
    refused(1, &points, "spheres go by the depth");
    let vectors = ["vectors", "export", "--scene", &scene, &path("v")];
    refused(2, &vectors, "a setup unit whose key is the depth");
}
