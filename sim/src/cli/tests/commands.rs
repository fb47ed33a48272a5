//! The commands from their options to their files, on small scenes.

use super::*;

#[test]
fn compare_writes_all_files_and_all_designs() {
    let folder = Folder::new();
    folder.run("compare random:300 --size 60x40 --repeat 3 -o ./new/out");
    for name in [
        "fixed.png",
        "float.png",
        "error.png",
        "report.json",
        "report.html",
    ] {
        let name = format!("new/out/{name}");
        assert!(folder.path(&name).is_file(), "{name}");
    }
    let report = folder.report("new/out/report.json");
    assert_eq!(report.table.len(), 10);
    assert_eq!(
        (report.engine.as_str(), report.reference.as_deref()),
        ("fixed", Some("float"))
    );
    assert_eq!(
        (report.design_name(), report.traversal.as_deref()),
        ("standard24", Some("spans"))
    );
    assert_eq!((report.host.repeat, report.scene.splats), (3, 300));
    assert!(report.host.setup_s > 0.0 && report.host.total_s >= report.host.raster_s);
    assert!(report.pixels.unwrap().covered > 0);
    let error = report.error.unwrap();
    assert!(error.rgb.psnr_db > 60.0, "{error:?}");
    let row = report
        .table
        .iter()
        .find(|row| row.design == "standard24" && row.traversal == "spans")
        .unwrap();
    assert_eq!(row.error, error.rgb);
}

#[test]
fn only_restricts_the_table_and_a_file_joins_it() {
    let folder = Folder::new();
    let small = "compare random:300 --size 30x30 -o ./";
    folder.run(&format!("{small} --only --design lean18 --traversal box"));
    let report = folder.report("report.json");
    assert_eq!(report.table.len(), 1);
    assert_eq!(
        (report.design_name(), report.traversal.as_deref()),
        ("lean18", Some("box"))
    );

    folder.write("mine12.toml", "base = \"lean18\"\nmantissa = 17\n");
    folder.run(&format!("{small} --design ./mine12.toml --engine exact"));
    let report = folder.report("report.json");
    assert_eq!(report.table.len(), 12);
    assert_eq!(
        (report.design_name(), report.reference.as_deref()),
        ("mine12", Some("exact"))
    );
}

#[test]
fn render_writes_the_picture_and_a_report_without_errors() {
    let folder = Folder::new();
    for (engine, design, view, depth) in [
        (
            "fixed",
            true,
            "--eye -1,-2,-6 --target 0,0,0 --size 40x30",
            8,
        ),
        // The camera of the first report, as a camera file.
        ("float", false, "--camera ./c.json", 16),
        ("exact", false, "--camera ./c.json --size 80x60", 8),
    ] {
        folder.run(&format!(
            "render random:300 --engine {engine} {view} --depth {depth} -o ./a.png --json ./a.json"
        ));
        let report = folder.report("a.json");
        let picture = Picture::read_png(&folder.path("a.png")).unwrap();
        assert_eq!(
            (report.camera.width, report.camera.height),
            (picture.width as u64, picture.height as u64)
        );
        assert_eq!(picture.width, if engine == "exact" { 80 } else { 40 });
        let camera = serde_json::to_string(&report.camera).unwrap();
        folder.write("c.json", &camera);
        assert_eq!((report.error, report.table.len()), (None, 0));
        assert_eq!(
            (report.pixels.is_some(), report.design.is_none()),
            (design, !design)
        );
        assert_eq!(report.engine, engine);
    }
}

/// Without alpha a viewer shows black where nothing was drawn, or the colour asked for.
#[test]
fn pictures_have_a_background_and_floats_have_none() {
    let folder = Folder::new();
    let render = |options: &str, name: &str| {
        let scene = "render random:50 --size 24x16 --zoom 0.2";
        folder.run(&format!("{scene} {options} -o ./{name}"));
    };
    for (options, corner) in [
        ("", [0.0, 0.0, 0.0, 1.0]),
        ("--background #ff3300", [1.0, 0.2, 0.0, 1.0]),
        ("--alpha", [0.0; 4]),
    ] {
        render(options, "x.png");
        let pixels = Picture::read_png(&folder.path("x.png")).unwrap().pixels;
        assert_eq!(pixels[0], corner, "{options}");
        assert!(pixels.iter().any(|pixel| *pixel != corner), "{options}");
    }
    render("", "x.npy");
    render("", "x.exr");
    let size = |name: &str| folder.path(name).metadata().unwrap().len();
    assert_eq!(size("x.npy"), 128 + 24 * 16 * 4 * 8);
    assert!(size("x.exr") > 24 * 16 * 4 * 4);
}

/// What was read is still there afterwards, and a name never lies about its format.
#[test]
fn inputs_are_never_overwritten_and_names_do_not_lie() {
    let folder = Folder::new();
    folder.write("cloud.xyz", &cloud());
    for line in [
        "render ./cloud.xyz -o ./cloud.xyz",
        "footprints ./cloud.xyz -o ./cloud.xyz",
        "render ./cloud.xyz -o ./x.png --json ./cloud.xyz",
        "render ./cloud.xyz -o ./x.jpg",
        "render ./cloud.xyz -o ./x",
        "footprints random:9 -o ./x.png",
        "fit random:9 --max-error 1 -o ./x.json",
        "trace random:9 --format vcd -o ./x.json",
        "render random:9 -o ./x.png --json ./x.png",
    ] {
        folder.usage(line);
    }
    assert_eq!(folder.read("cloud.xyz"), cloud());
    assert_eq!(std::fs::read_dir(folder.path("")).unwrap().count(), 1);
}

/// A report records the whole plan: `--from` draws the same bits, though the design's file is gone.
#[test]
fn a_report_draws_the_same_bits_again() {
    let folder = Folder::new();
    folder.write("c.xyz", &cloud());
    folder.write("h.csv", HEIGHTS);
    for scene in [
        "random:200 --orbit 40,20 --traversal box --compositing back-to-front --rules ewa",
        "random:200 --engine float --kernel cubic",
        "random:200 --engine exact --zoom 1.5",
        "demo --light 1,0,0.3 --rules ewa --antialias swan --points auto",
        "random:60 --rules ewa --antialias swan --traversal stamp --phase-bits 2",
        "./c.xyz --as surface --layers 3 --edges --light 1,0,1",
        "./c.xyz --as surface --engine float --cull-backfaces",
        "./h.csv --as surface --spacing 0.3",
    ] {
        let design = "base = \"lean18\"\nmantissa = 17\nrounding = \"truncate\"\n";
        folder.write("mine.toml", design);
        let line = format!("{scene} --design ./mine.toml --size 40x30");
        folder.run(&format!("render {line} -o ./a.npy --json ./r.json"));
        std::fs::remove_file(folder.path("mine.toml")).unwrap();
        let report = folder.report("r.json");
        folder.run("render --from ./r.json -o ./b.npy --json ./again.json");
        assert!(folder.bytes("a.npy") == folder.bytes("b.npy"), "{scene}");
        let repeated = folder.report("again.json");
        assert_eq!(
            Report {
                host: report.host,
                ..repeated
            },
            report,
            "{scene}"
        );
    }
    let refused = parse("render --from r.json --zoom 2 -o b.npy");
    assert_eq!(refused.unwrap_err().kind(), ErrorKind::ArgumentConflict);
}

/// The machine is part of the plan as well, and a comparison's report makes a comparison again.
#[test]
fn a_report_counts_the_same_cycles_again() {
    let folder = Folder::new();
    let machine = "--machine primitive-2 --set read_bandwidth=16";
    let line = format!("random:200 --size 40x30 --only --engine exact {machine}");
    folder.run(&format!("compare {line} -o ./a"));
    folder.run("compare --from ./a/report.json --only -o ./b");
    let [first, second] = ["a", "b"].map(|name| folder.report(&format!("{name}/report.json")));
    assert_eq!(first.plan, second.plan);
    let counted = |name: &str| folder.json(&format!("{name}/report.json"))["cycles"].clone();
    assert!(counted("a").is_object());
    assert_eq!(counted("a"), counted("b"));
    assert_eq!(first.error, second.error);
    folder.run("model --from ./a/report.json -o ./m");
    let timing = folder.json("m/timing.json");
    assert_eq!(timing["cycles"]["total"], counted("a")["total"]);
}

/// Surfaces come through the same entrance; what counts cycles has a unit for them.
#[test]
fn surfaces_are_taken_by_every_command_that_they_mean_something_for() {
    let folder = Folder::new();
    folder.write("c.xyz", &cloud());
    let scene = "./c.xyz --as surface --size 40x30 --eye 2.5,2.5,16 --target 2.5,2.5,0 --up 0,1,0";
    let lines = |engine: &str| -> Vec<Vec<f64>> {
        folder.run(&format!("footprints {scene} --engine {engine} -o ./f.csv"));
        let text = folder.read("f.csv");
        // Points of a surface have no opacity of their own: that field alone is empty.
        let number = |(column, field): (usize, &str)| match column {
            11 if field.is_empty() => 0.0,
            _ => field.parse::<f64>().unwrap(),
        };
        let lines = text.lines().skip(1);
        lines
            .map(|line| line.split(',').enumerate().map(number).collect())
            .collect()
    };
    let (fixed, float) = (lines("fixed"), lines("float"));
    assert_eq!((fixed.len(), float.len()), (36, 36));
    for (a, b) in fixed.iter().zip(&float) {
        let near = |column: usize, bound: f64| (a[column] - b[column]).abs() <= bound;
        assert!((1..=3).all(|column| near(column, 1e-3)), "{a:?} {b:?}");
        let largest = b[4].abs().max(b[6].abs());
        assert!(
            (4..=6).all(|column| near(column, 1e-4 * largest)),
            "{a:?} {b:?}"
        );
        assert!(
            (7..=10).all(|column| near(column, 1.0)) && near(12, 1e-6),
            "{a:?} {b:?}"
        );
    }
    folder.run(&format!("fit {scene} --max-error 0.02 -o ./fit.toml"));
    folder.run(&format!(
        "compare {scene} --design ./fit.toml --only -o ./out"
    ));
    let report = folder.report("out/report.json");
    assert!(report.error.unwrap().rgb.max_abs <= 0.02);
    folder.write("s.toml", "[machine]\nlanes = [1, 2]\n");
    folder.run(&format!("sweep {scene} --space ./s.toml -o ./e"));
    folder.run(&format!("trace {scene} --format vcd -o ./t.vcd"));
}

/// Its machine has a unit that is an estimate, and says so; what else is of volume splats alone refuses it.
#[test]
fn a_surface_is_simulated_and_its_question_answered() {
    let folder = Folder::new();
    folder.write("c.xyz", &cloud());
    let scene = "./c.xyz --as surface --size 40x30";
    folder.run(&format!("simulate {scene} -o ./m"));
    let timing = folder.json("m/timing.json");
    let work = &timing["cycles"]["surface"];
    assert!(
        work["samples"].as_u64() > work["fragments"].as_u64()
            && work["fragments"].as_u64() > Some(0)
    );
    let limits = "--fps 100 --max-error 0.05 --lut 100000";
    let space = "[machine]\nlanes = [1, 2]\nresolve_interval = [1, 8]\nsetup_interval = [8, 16]\n";
    folder.write("s.toml", space);
    let question = format!("optimize {scene} {limits} --space ./s.toml -o ./a");
    folder.run(&question);
    let answer = folder.json("a/answer.json");
    assert_eq!(answer["answer"]["holds"], true);
    for said in [&timing["area"]["of"], &answer["area_of"]] {
        let said = said.as_str().unwrap();
        assert!(said.contains("the surface unit is an estimate"), "{said}");
    }
    let page = folder.read("a/answer.html");
    assert!(page.contains("the surface unit is an estimate") && page.contains("gather"));
    for (options, expected) in [
        ("--machines", VOLUMES_ALONE),
        (
            "--turntable 2 --set sort_passes=2 --set sort_every=2",
            VOLUMES_ALONE,
        ),
        (
            "--machine primitive-4",
            "the circuit of sim/rtl has no surface unit",
        ),
        (
            "--machine machine-4 --set overlap=pipelined",
            "nothing is sorted",
        ),
        ("--layers 2 --set surface_layers=4", "surface_layers = 2"),
    ] {
        let failure = folder.attempt(&format!("simulate {scene} {options}"));
        let message = format!("{:?}", failure.expect_err(options));
        assert!(message.contains(expected), "{options}: {message}");
    }
    let volume = run_line("simulate random:20:1 --size 40x30 --set surface_layers=1");
    assert!(format!("{:?}", volume.unwrap_err()).contains("surface_layers = 0"));
}

/// Up, angle and orbit without an eye turn the automatic view, which still shows the whole scene.
#[test]
fn view_options_alone_keep_the_whole_scene_in_view() {
    let folder = Folder::new();
    let scene = crate::scene::load(Path::new("random:200"), &Default::default()).unwrap();
    let mut cameras = Vec::new();
    for options in [
        "",
        "--up 0,0,1",
        "--fov 30",
        "--orbit 40,20",
        "--up 1,0,0 --fov 70",
    ] {
        let line = format!("render random:200 --size 64x48 {options}");
        folder.run(&format!("{line} -o ./x.png --json ./r.json"));
        let (camera, _) =
            crate::camera::Camera::corrected_from_json_file(&folder.path("r.json")).unwrap();
        for splat in &scene.splats {
            let [x, y, z] = camera.to_camera(splat.centre);
            let [u, v] = [camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy];
            let inside = (0.0..64.0).contains(&u) && (0.0..48.0).contains(&v);
            assert!(z > camera.near && inside, "{options}: {u}, {v} at {z}");
        }
        assert!(!cameras.contains(&camera), "{options} changes nothing");
        cameras.push(camera);
    }
}

/// The camera of a report draws the same picture again, from the report itself as well.
#[test]
fn a_reports_camera_can_be_used_again() {
    let folder = Folder::new();
    folder.run("render random:200 --orbit 40,20 --size 40x30 -o ./a.npy --json ./r.json");
    folder.run("render random:200 --camera ./r.json -o ./b.npy");
    assert!(folder.bytes("a.npy") == folder.bytes("b.npy"));
    folder.run("render random:200 --camera ./r.json --zoom 2 -o ./b.npy");
    assert!(folder.bytes("a.npy") != folder.bytes("b.npy"));
}

#[test]
fn footprints_are_csv_with_empty_fields_for_culled_splats() {
    let folder = Folder::new();
    let read =
        |engine: &str| -> Vec<Vec<String>> {
            let view = "--eye 0,0,-2 --target 0,0,0 --size 40x30";
            folder.run(&format!(
                "footprints random:300 --engine {engine} {view} -o ./f.csv"
            ));
            let text = folder.read("f.csv");
            assert!(text.starts_with(
                "index,u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1,opacity,cutoff\n"
            ));
            text.lines()
                .skip(1)
                .map(|line| line.split(',').map(str::to_owned).collect())
                .collect()
        };
    let (fixed, float) = (read("fixed"), read("float"));
    assert_eq!((fixed.len(), float.len()), (300, 300));
    let mut drawn = 0;
    for (index, (a, b)) in fixed.iter().zip(&float).enumerate() {
        assert_eq!(
            (a.len(), b.len(), a[0].parse(), b[0].parse()),
            (13, 13, Ok(index), Ok(index))
        );
        let culled = |fields: &[String]| fields[1..].iter().all(String::is_empty);
        if culled(a) || culled(b) {
            continue;
        }
        drawn += 1;
        let value = |fields: &[String], column: usize| fields[column].parse::<f64>().unwrap();
        for column in 1..=3 {
            assert!(
                (value(a, column) - value(b, column)).abs() < 1e-3,
                "{a:?} {b:?}"
            );
        }
        let largest = (4..=6)
            .map(|column| value(b, column).abs())
            .fold(0.0, f64::max);
        for column in 4..=6 {
            assert!(
                (value(a, column) - value(b, column)).abs() < 1e-4 * largest,
                "{a:?} {b:?}"
            );
        }
        assert!(value(a, 7) < value(a, 9) && value(a, 8) < value(a, 10));
    }
    assert!(
        (20..300).contains(&drawn),
        "{drawn} drawn: the test needs both kinds"
    );
}

#[test]
fn the_demo_writes_its_report() {
    let folder = Folder::new();
    demo::run_into(&folder.path(""), [32, 32], 1).unwrap();
    assert_eq!(folder.report("report.json").table.len(), 10);
    let page = folder.read("page.html");
    assert!(page.contains("brainsmall") && page.contains("id=\"scene\""));
}

/// A square of 6 x 6 points in the plane z = 0, seen from +z by default up.
fn cloud() -> String {
    let mut text = String::from("# x y z nx ny nz r g b\n");
    for index in 0..36 {
        let (x, y) = (index % 6, index / 6);
        text += &format!("{x} {y} {} 0.1 0 1 {} 80 200\n", 0.1 * f64::from(x), 40 * x);
    }
    text
}

#[test]
fn a_cloud_is_drawn_as_a_surface() {
    let folder = Folder::new();
    folder.write("cloud.xyz", &cloud());
    let scene =
        "./cloud.xyz --as surface --size 40x30 --eye 2.5,2.5,16 --target 2.5,2.5,0 --up 0,1,0";
    for options in [
        "",
        "--layers 4 --edges",
        "--light 0,0,1",
        "--engine float",
        "--z-threshold 0.5",
    ] {
        folder.run(&format!("render {scene} {options} --alpha -o ./cloud.png"));
        let drawn = Picture::read_png(&folder.path("cloud.png")).unwrap();
        let middle = drawn.pixels[15 * 40 + 20];
        assert!(middle[3] > 0.99 && middle[2] > 0.1, "{options}: {middle:?}");
        assert_eq!(drawn.pixels[0], [0.0; 4], "{options}");
    }
    folder.run(&format!("compare {scene} --layers 2 --only -o ./"));
    let report = folder.report("report.json");
    assert_eq!(
        (report.rules.name, report.compositing.as_str()),
        ("surf", "2 layers")
    );
    assert!(report.error.unwrap().rgb.psnr_db > 60.0);
}

#[test]
fn points_and_stamps_ask_for_distance_scaling() {
    let folder = Folder::new();
    let line = |options: &str| format!("render random:50 {options} -o ./x.png --size 32x32");
    for options in [
        "--points all",
        "--traversal stamp",
        "--antialias swan --points auto",
    ] {
        let message = folder.usage(&line(options));
        assert!(message.contains("--rules ewa and --antialias swan"));
    }
    let sound = "--rules ewa --antialias swan";
    let backwards = format!("{sound} --points auto --compositing back-to-front");
    folder.usage(&line(&backwards));
    for options in ["--points auto", "--traversal stamp --phase-bits 2"] {
        folder.run(&line(&format!("{sound} {options}")));
    }
    for kernel in ["cubic", "quadratic", "disc"] {
        folder.run(&line(&format!("--kernel {kernel} --antialias none")));
    }
}
