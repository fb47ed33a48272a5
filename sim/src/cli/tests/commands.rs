//! The commands from their options to their files, on small scenes.

use super::*;

#[test]
fn compare_writes_all_files_and_all_designs() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/out");
    run_line(&format!(
        "compare random:300 --size 60x40 --repeat 3 -o {}",
        out.display()
    ))
    .unwrap();
    for name in [
        "fixed.png",
        "float.png",
        "error.png",
        "report.json",
        "report.html",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let report = read_report(&out.join("report.json"));
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
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display();
    run_line(&format!(
        "compare random:300 --size 30x30 --only --design lean18 --traversal box -o {out}"
    ))
    .unwrap();
    let report = read_report(&folder.path().join("report.json"));
    assert_eq!(report.table.len(), 1);
    assert_eq!(
        (report.design_name(), report.traversal.as_deref()),
        ("lean18", Some("box"))
    );

    let file = folder.path().join("mine12.toml");
    std::fs::write(&file, "base = \"lean18\"\nmantissa = 17\n").unwrap();
    let file = file.display();
    run_line(&format!(
        "compare random:300 --size 30x30 --design {file} --engine exact -o {out}"
    ))
    .unwrap();
    let report = read_report(&folder.path().join("report.json"));
    assert_eq!(report.table.len(), 12);
    assert_eq!(
        (report.design_name(), report.reference.as_deref()),
        ("mine12", Some("exact"))
    );
}

#[test]
fn render_writes_the_picture_and_a_report_without_errors() {
    let folder = tempfile::tempdir().unwrap();
    let (png, json) = (folder.path().join("a.png"), folder.path().join("a.json"));
    let camera = folder.path().join("c.json");
    for (engine, design, view, depth) in [
        (
            "fixed",
            true,
            "--eye -1,-2,-6 --target 0,0,0 --size 40x30".to_owned(),
            8,
        ),
        // The camera of the first report, as a camera file.
        ("float", false, format!("--camera {}", camera.display()), 16),
        (
            "exact",
            false,
            format!("--camera {} --size 80x60", camera.display()),
            8,
        ),
    ] {
        let (png, json) = (png.display(), json.display());
        run_line(&format!(
            "render random:300 --engine {engine} {view} --depth {depth} -o {png} --json {json}"
        ))
        .unwrap();
        let report = read_report(Path::new(&json.to_string()));
        let picture = Picture::read_png(Path::new(&png.to_string())).unwrap();
        assert_eq!(
            (report.camera.width, report.camera.height),
            (picture.width as u64, picture.height as u64)
        );
        assert_eq!(picture.width, if engine == "exact" { 80 } else { 40 });
        std::fs::write(&camera, serde_json::to_string(&report.camera).unwrap()).unwrap();
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
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let render = |options: &str, name: &str| {
        let line = format!("random:50 --size 24x16 --zoom 0.2 {options}");
        run_line(&format!("render {line} -o {}", path(name).display())).unwrap();
    };
    for (options, corner) in [
        ("", [0.0, 0.0, 0.0, 1.0]),
        ("--background #ff3300", [1.0, 0.2, 0.0, 1.0]),
        ("--alpha", [0.0; 4]),
    ] {
        render(options, "x.png");
        let pixels = Picture::read_png(&path("x.png")).unwrap().pixels;
        assert_eq!(pixels[0], corner, "{options}");
        assert!(pixels.iter().any(|pixel| *pixel != corner), "{options}");
    }
    render("", "x.npy");
    render("", "x.exr");
    let size = |name: &str| path(name).metadata().unwrap().len();
    assert_eq!(size("x.npy"), 128 + 24 * 16 * 4 * 8);
    assert!(size("x.exr") > 24 * 16 * 4 * 4);
}

/// What was read is still there afterwards, and a name never lies about its format.
#[test]
fn inputs_are_never_overwritten_and_names_do_not_lie() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("cloud.xyz");
    write_cloud(&scene);
    let before = std::fs::read(&scene).unwrap();
    let (scene, out) = (scene.display(), folder.path().display());
    for line in [
        format!("render {scene} -o {scene}"),
        format!("footprints {scene} -o {scene}"),
        format!("render {scene} -o {out}/x.png --json {scene}"),
        format!("render {scene} -o {out}/x.jpg"),
        format!("render {scene} -o {out}/x"),
        format!("footprints random:9 -o {out}/x.png"),
        format!("fit random:9 --max-error 1 -o {out}/x.json"),
        format!("trace random:9 --format vcd -o {out}/x.json"),
        format!("render random:9 -o {out}/x.png --json {out}/x.png"),
    ] {
        assert!(matches!(run_line(&line), Err(Failure::Usage(_))), "{line}");
    }
    assert_eq!(
        std::fs::read(folder.path().join("cloud.xyz")).unwrap(),
        before
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// A report records the whole plan: `--from` draws the same bits, though the design's file is gone.
#[test]
fn a_report_draws_the_same_bits_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (cloud, heights, design) = (path("c.xyz"), path("h.csv"), path("mine.toml"));
    write_cloud(Path::new(&cloud));
    std::fs::write(&heights, "0,0.1,0.3\n0,0.2,0.2\n0.1,0.1,0\n").unwrap();
    let (json, first, again) = (path("r.json"), path("a.npy"), path("b.npy"));
    for scene in [
        "random:200 --orbit 40,20 --traversal box --compositing back-to-front --rules ewa",
        "random:200 --engine float --kernel cubic",
        "random:200 --engine exact --zoom 1.5",
        "demo --light 1,0,0.3 --rules ewa --antialias swan --points auto",
        "random:60 --rules ewa --antialias swan --traversal stamp --phase-bits 2",
        &format!("{cloud} --as surface --layers 3 --edges --light 1,0,1"),
        &format!("{cloud} --as surface --engine float --cull-backfaces"),
        &format!("{heights} --as surface --spacing 0.3"),
    ] {
        std::fs::write(
            &design,
            "base = \"lean18\"\nmantissa = 17\nrounding = \"truncate\"\n",
        )
        .unwrap();
        let line = format!("{scene} --design {design} --size 40x30");
        run_line(&format!("render {line} -o {first} --json {json}")).unwrap();
        std::fs::remove_file(&design).unwrap();
        let report = read_report(Path::new(&json));
        let second = path("again.json");
        run_line(&format!("render --from {json} -o {again} --json {second}")).unwrap();
        let same = std::fs::read(&first).unwrap() == std::fs::read(&again).unwrap();
        assert!(same, "{scene}");
        let repeated = read_report(Path::new(&second));
        assert_eq!(
            Report {
                host: report.host,
                ..repeated
            },
            report,
            "{scene}"
        );
    }
    let refused = parse(&format!("render --from {json} --zoom 2 -o {again}"));
    assert_eq!(refused.unwrap_err().kind(), ErrorKind::ArgumentConflict);
}

/// The machine is part of the plan as well, and a comparison's report makes a comparison again.
#[test]
fn a_report_counts_the_same_cycles_again() {
    let folder = tempfile::tempdir().unwrap();
    let out = |name: &str| folder.path().join(name).join("report.json");
    let shown = |name: &str| folder.path().join(name).display().to_string();
    let machine = "--machine primitive-2 --set read_bandwidth=16";
    let line = format!("random:200 --size 40x30 --only --engine exact {machine}");
    run_line(&format!("compare {line} -o {}", shown("a"))).unwrap();
    let from = |name: &str| format!("--from {}", out(name).display());
    run_line(&format!("compare {} --only -o {}", from("a"), shown("b"))).unwrap();
    let (first, second) = (read_report(&out("a")), read_report(&out("b")));
    assert_eq!(first.plan, second.plan);
    let counted = |name: &str| read_json(&out(name))["cycles"].clone();
    assert!(counted("a").is_object());
    assert_eq!(counted("a"), counted("b"));
    assert_eq!(first.error, second.error);
    run_line(&format!("model {} -o {}", from("a"), shown("m"))).unwrap();
    let timing = read_json(&folder.path().join("m/timing.json"));
    assert_eq!(timing["cycles"]["total"], counted("a")["total"]);
}

/// Surfaces come through the same entrance; what counts cycles has a unit for them.
#[test]
fn surfaces_are_taken_by_every_command_that_they_mean_something_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let cloud = path("c.xyz");
    write_cloud(Path::new(&cloud));
    let scene =
        format!("{cloud} --as surface --size 40x30 --eye 2.5,2.5,16 --target 2.5,2.5,0 --up 0,1,0");
    let lines = |engine: &str| -> Vec<Vec<f64>> {
        let csv = path("f.csv");
        run_line(&format!("footprints {scene} --engine {engine} -o {csv}")).unwrap();
        let text = std::fs::read_to_string(csv).unwrap();
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
    let toml = path("fit.toml");
    run_line(&format!("fit {scene} --max-error 0.02 -o {toml}")).unwrap();
    run_line(&format!(
        "compare {scene} --design {toml} --only -o {}",
        path("out")
    ))
    .unwrap();
    let report = read_report(&folder.path().join("out/report.json"));
    assert!(report.error.unwrap().rgb.max_abs <= 0.02);
    std::fs::write(path("s.toml"), "[machine]\nlanes = [1, 2]\n").unwrap();
    run_line(&format!(
        "sweep {scene} --space {} -o {}",
        path("s.toml"),
        path("e")
    ))
    .unwrap();
    run_line(&format!("trace {scene} --format vcd -o {}", path("t.vcd"))).unwrap();
}

/// Its machine has a unit that is an estimate, and says so; what else is of volume splats alone refuses it.
#[test]
fn a_surface_is_simulated_and_its_question_answered() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let cloud = path("c.xyz");
    write_cloud(Path::new(&cloud));
    let scene = format!("{cloud} --as surface --size 40x30");
    run_line(&format!("simulate {scene} -o {}", path("m"))).unwrap();
    let timing = read_json(&folder.path().join("m/timing.json"));
    let work = &timing["cycles"]["surface"];
    assert!(
        work["samples"].as_u64() > work["fragments"].as_u64()
            && work["fragments"].as_u64() > Some(0)
    );
    let limits = "--fps 100 --max-error 0.05 --lut 100000";
    std::fs::write(
        path("s.toml"),
        "[machine]\nlanes = [1, 2]\nresolve_interval = [1, 8]\nsetup_interval = [8, 16]\n",
    )
    .unwrap();
    let space = path("s.toml");
    run_line(&format!(
        "optimize {scene} {limits} --space {space} -o {}",
        path("a")
    ))
    .unwrap();
    let answer = read_json(&folder.path().join("a/answer.json"));
    assert_eq!(answer["answer"]["holds"], true);
    for said in [&timing["area"]["of"], &answer["area_of"]] {
        let said = said.as_str().unwrap();
        assert!(said.contains("the surface unit is an estimate"), "{said}");
    }
    let page = std::fs::read_to_string(folder.path().join("a/answer.html")).unwrap();
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
        let Err(failure) = run_line(&format!("simulate {scene} {options}")) else {
            panic!("{options} was accepted");
        };
        let message = format!("{failure:?}");
        assert!(message.contains(expected), "{options}: {message}");
    }
    let volume = run_line("simulate random:20:1 --size 40x30 --set surface_layers=1");
    assert!(format!("{:?}", volume.unwrap_err()).contains("surface_layers = 0"));
}

/// Up, angle and orbit without an eye turn the automatic view, which still shows the whole scene.
#[test]
fn view_options_alone_keep_the_whole_scene_in_view() {
    let folder = tempfile::tempdir().unwrap();
    let [json, png] = ["r.json", "x.png"].map(|name| folder.path().join(name));
    let scene = crate::scene::load(Path::new("random:200"), &Default::default()).unwrap();
    let mut cameras = Vec::new();
    for options in [
        "",
        "--up 0,0,1",
        "--fov 30",
        "--orbit 40,20",
        "--up 1,0,0 --fov 70",
    ] {
        let (out, report) = (png.display(), json.display());
        let line = format!("render random:200 --size 64x48 {options} -o {out} --json {report}");
        run_line(&line).unwrap();
        let camera = crate::camera::Camera::from_json_file(&json).unwrap();
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
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (json, first, again) = (path("r.json"), path("a.npy"), path("b.npy"));
    run_line(&format!(
        "render random:200 --orbit 40,20 --size 40x30 -o {first} --json {json}"
    ))
    .unwrap();
    run_line(&format!("render random:200 --camera {json} -o {again}")).unwrap();
    assert!(std::fs::read(&first).unwrap() == std::fs::read(&again).unwrap());
    run_line(&format!(
        "render random:200 --camera {json} --zoom 2 -o {again}"
    ))
    .unwrap();
    assert!(std::fs::read(&first).unwrap() != std::fs::read(&again).unwrap());
}

#[test]
fn footprints_are_csv_with_empty_fields_for_culled_splats() {
    let folder = tempfile::tempdir().unwrap();
    let read =
        |engine: &str| -> Vec<Vec<String>> {
            let path = folder.path().join("f.csv");
            let view = "--eye 0,0,-2 --target 0,0,0 --size 40x30";
            run_line(&format!(
                "footprints random:300 --engine {engine} {view} -o {}",
                path.display()
            ))
            .unwrap();
            let text = std::fs::read_to_string(path).unwrap();
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
    let folder = tempfile::tempdir().unwrap();
    demo::run_into(
        folder.path(),
        PictureSize {
            width: 32,
            height: 32,
        },
        1,
    )
    .unwrap();
    assert_eq!(
        read_report(&folder.path().join("report.json")).table.len(),
        10
    );
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(page.contains("brainsmall") && page.contains("id=\"scene\""));
}

/// A square of 6 x 6 points in the plane z = 0, seen from +z by default up.
fn write_cloud(path: &Path) {
    let mut text = String::from("# x y z nx ny nz r g b\n");
    for index in 0..36 {
        let (x, y) = (index % 6, index / 6);
        text += &format!("{x} {y} {} 0.1 0 1 {} 80 200\n", 0.1 * f64::from(x), 40 * x);
    }
    std::fs::write(path, text).unwrap();
}

#[test]
fn a_cloud_is_drawn_as_a_surface() {
    let folder = tempfile::tempdir().unwrap();
    let (cloud, picture) = (
        folder.path().join("cloud.xyz"),
        folder.path().join("cloud.png"),
    );
    write_cloud(&cloud);
    let scene = format!(
        "{} --as surface --size 40x30 --eye 2.5,2.5,16 --target 2.5,2.5,0 --up 0,1,0",
        cloud.display()
    );
    for options in [
        "",
        "--layers 4 --edges",
        "--light 0,0,1",
        "--engine float",
        "--z-threshold 0.5",
    ] {
        run_line(&format!(
            "render {scene} {options} --alpha -o {}",
            picture.display()
        ))
        .unwrap();
        let drawn = Picture::read_png(&picture).unwrap();
        let middle = drawn.pixels[15 * 40 + 20];
        assert!(middle[3] > 0.99 && middle[2] > 0.1, "{options}: {middle:?}");
        assert_eq!(drawn.pixels[0], [0.0; 4], "{options}");
    }
    run_line(&format!(
        "compare {scene} --layers 2 --only -o {}",
        folder.path().display()
    ))
    .unwrap();
    let report = read_report(&folder.path().join("report.json"));
    assert_eq!(
        (report.rules.name, report.compositing.as_str()),
        ("surf", "2 layers")
    );
    assert!(report.error.unwrap().rgb.psnr_db > 60.0);
}

#[test]
fn points_and_stamps_ask_for_distance_scaling() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("x.png");
    let line = |options: &str| {
        let output = output.display();
        run_line(&format!(
            "render random:50 {options} -o {output} --size 32x32"
        ))
    };
    for options in [
        "--points all",
        "--traversal stamp",
        "--antialias swan --points auto",
    ] {
        let Err(Failure::Usage(message)) = line(options) else {
            panic!("{options} was accepted");
        };
        assert!(message.contains("--rules ewa and --antialias swan"));
    }
    let sound = "--rules ewa --antialias swan";
    let backwards = format!("{sound} --points auto --compositing back-to-front");
    assert!(matches!(line(&backwards), Err(Failure::Usage(_))));
    for options in ["--points auto", "--traversal stamp --phase-bits 2"] {
        line(&format!("{sound} {options}")).unwrap();
    }
    for kernel in ["cubic", "quadratic", "disc"] {
        line(&format!("--kernel {kernel} --antialias none")).unwrap();
    }
}
