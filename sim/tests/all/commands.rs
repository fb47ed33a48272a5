//! The commands from their options to their files, on small scenes.

use super::shell::{Shell, holds};
use splatline_sim::camera::Camera;
use splatline_sim::picture::Picture;
use splatline_sim::plan::VOLUMES_ALONE;
use splatline_sim::report::Report;
use std::path::Path;

/// Heights of a surface.
const HEIGHTS: &str = "0,0.1,0.3\n0,0.2,0.2\n0.1,0.1,0\n";

/// A square of 6 x 6 points in the plane z = 0, seen from +z by default up.
fn cloud() -> String {
    let mut text = String::from("# x y z nx ny nz r g b\n");
    for index in 0..36 {
        let (x, y) = (index % 6, index / 6);
        text += &format!("{x} {y} {} 0.1 0 1 {} 80 200\n", 0.1 * f64::from(x), 40 * x);
    }
    text
}

/// Of a report: the design, the traversal and the reference.
fn drawn_by(report: &Report) -> [Option<&str>; 3] {
    let design = Some(report.design_name());
    [
        design,
        report.traversal.as_deref(),
        report.reference.as_deref(),
    ]
}

#[test]
fn compare_writes_all_files_and_all_designs() {
    let shell = Shell::new();
    shell.succeed("compare random:300 --size 60x40 --repeat 3 -o new/out");
    for name in ["fixed.png", "float.png", "error.png", "report.html"] {
        assert!(shell.has(&format!("new/out/{name}")), "{name}");
    }
    let report = shell.report("new/out/report.json");
    assert_eq!(report.table.len(), 10);
    assert_eq!(report.engine, "fixed");
    assert_eq!(
        drawn_by(&report),
        ["standard24", "spans", "float"].map(Some)
    );
    assert_eq!((report.host.repeat, report.scene.splats), (3, 300));
    assert!(report.host.setup_s > 0.0 && report.host.total_s >= report.host.raster_s);
    assert!(report.pixels.unwrap().covered > 0);
    let error = report.error.unwrap();
    assert!(error.rgb.psnr_db > 60.0, "{error:?}");
    let mut rows = report.table.iter();
    let row = rows.find(|row| row.design == "standard24" && row.traversal == "spans");
    assert_eq!(row.unwrap().error, error.rgb);
}

#[test]
fn only_restricts_the_table_and_a_file_joins_it() {
    let shell = Shell::new();
    let small = "compare random:300 --size 30x30 -o .";
    shell.succeed(&format!("{small} --only --design lean18 --traversal box"));
    let report = shell.report("report.json");
    assert_eq!(report.table.len(), 1);
    assert_eq!(drawn_by(&report), ["lean18", "box", "float"].map(Some));

    shell.write("mine12.toml", "base = \"lean18\"\nmantissa = 17\n");
    shell.succeed(&format!("{small} --design mine12.toml --engine exact"));
    let report = shell.report("report.json");
    assert_eq!(report.table.len(), 12);
    assert_eq!(drawn_by(&report), ["mine12", "spans", "exact"].map(Some));
}

#[test]
fn render_writes_the_picture_and_a_report_without_errors() {
    let shell = Shell::new();
    let eye = "--eye -1,-2,-6 --target 0,0,0 --size 40x30 --depth 8";
    for (engine, view, width) in [
        ("fixed", eye, 40),
        // The camera of the first report, as a camera file.
        ("float", "--camera c.json --depth 16", 40),
        ("exact", "--camera c.json --size 80x60", 80),
    ] {
        shell.succeed(&format!(
            "render random:300 --engine {engine} {view} -o a.png --json a.json"
        ));
        let report = shell.report("a.json");
        let picture = Picture::read_png(&shell.path("a.png")).unwrap();
        let size = [picture.width, picture.height];
        assert_eq!([report.camera.width, report.camera.height], size);
        assert_eq!(picture.width, width);
        shell.write("c.json", serde_json::to_string(&report.camera).unwrap());
        assert_eq!((report.error, report.table.len()), (None, 0));
        let has_design = engine == "fixed";
        assert_eq!(
            (report.pixels.is_some(), report.design.is_some()),
            (has_design, has_design)
        );
        assert_eq!(report.engine, engine);
    }
}

/// Without alpha a viewer shows black where nothing was drawn, or the colour asked for.
#[test]
fn pictures_have_a_background_and_floats_have_none() {
    let shell = Shell::new();
    let render = "render random:50 --size 24x16 --zoom 0.2 -o";
    for (options, corner) in [
        ("", [0.0, 0.0, 0.0, 1.0]),
        ("--background #ff3300", [1.0, 0.2, 0.0, 1.0]),
        ("--alpha", [0.0; 4]),
    ] {
        shell.succeed(&format!("{render} x.png {options}"));
        let pixels = Picture::read_png(&shell.path("x.png")).unwrap().pixels;
        assert_eq!(pixels[0], corner, "{options}");
        assert!(pixels.iter().any(|pixel| *pixel != corner), "{options}");
    }
    let [npy, exr] = ["x.npy", "x.exr"].map(|name| {
        shell.succeed(&format!("{render} {name}"));
        shell.bytes(name).len()
    });
    assert_eq!(npy, 128 + 24 * 16 * 4 * 8);
    assert!(exr > 24 * 16 * 4 * 4);
}

/// What was read is still there afterwards, and a name never lies about its format.
#[test]
fn inputs_are_never_overwritten_and_names_do_not_lie() {
    let shell = Shell::new();
    shell.write("cloud.xyz", cloud());
    shell.refuses(
        "2 render cloud.xyz -o cloud.xyz => end the name in .png or .npy
         2 footprints cloud.xyz -o cloud.xyz => end the name in .csv
         2 render cloud.xyz -o x.png --json cloud.xyz => end the name in .json
         2 render cloud.xyz -o x.jpg => '.jpg' is not written
         2 render cloud.xyz -o x.ppm => end the name in .png or .npy
         2 render cloud.xyz -o x.png.txt => end the name in .png or .npy
         2 render cloud.xyz -o x => it has no extension
         2 footprints random:9 -o x.png => end the name in .csv
         2 fit random:9 --max-error 1 -o x.json => end the name in .toml
         2 trace random:9 --format vcd -o x.json => end the name in .vcd
         2 render random:9 -o x.png --json x.png => two results cannot both be written
         1 render missing.ply -o a.png => missing.ply
         1 render a.ply -o no/such/a.png => does not exist
         1 render a.ply -o ./ => is a folder
         1 compare a.ply -o cloud.xyz => it is a file; name a folder
         1 simulate random:9 -o cloud.xyz => it is a file; name a folder
         1 man -o cloud.xyz => it is a file; name a folder
         1 vectors export cloud.xyz => it is a file; name a folder",
    );
    assert_eq!(shell.read("cloud.xyz"), cloud());
    assert_eq!(std::fs::read_dir(shell.path("")).unwrap().count(), 1);
    shell.succeed("render random:9 --size 8x8 -o x.PNG");
    #[cfg(unix)]
    shell.succeed("render random:9 --size 8x8 -o /dev/null");
}

/// Options that are sound by themselves and make no sense together, or with the kind of scene.
#[test]
fn options_that_contradict_each_other_are_named() {
    let shell = Shell::new();
    shell.refuses(
        "2 render random:9 -o a.png --eye 0,0,0 --target 0,0,0 => --eye
         2 footprints a.ply -o a.csv --engine exact => no footprints
         2 render a.ply -o a.png --engine float --traversal box => no meaning
         2 render a.ply --as surface --rules ewa -o a.png => --rules has no meaning
         2 render a.ply --as surface --engine exact -o a.png => use fixed or float
         2 render --from r.json --zoom 2 -o b.npy => cannot be used with
         2 render random:50 --points all -o x.png => --rules ewa and --antialias swan
         2 render random:50 --traversal stamp -o x.png => --rules ewa and --antialias swan
         2 render random:50 --antialias swan --points auto -o x.png => --rules ewa and --antialias swan",
    );
    let sound = "random:50 --rules ewa --antialias swan -o x.png --size 32x32";
    let backwards = format!("render {sound} --points auto --compositing back-to-front");
    shell.refused(2, &backwards, "front to back only");
    for options in ["--points auto", "--traversal stamp --phase-bits 2"] {
        shell.succeed(&format!("render {sound} {options}"));
    }
    for kernel in ["cubic", "quadratic", "disc"] {
        let line = format!("render random:50 --kernel {kernel} --antialias none");
        shell.succeed(&format!("{line} -o x.png --size 32x32"));
    }
}

/// A report records the whole plan: `--from` draws the same bits, though the design's file is gone.
#[test]
fn a_report_draws_the_same_bits_again() {
    let shell = Shell::new();
    shell.write("c.xyz", cloud());
    shell.write("h.csv", HEIGHTS);
    for scene in [
        "random:200 --orbit 40,20 --traversal box --compositing back-to-front --rules ewa",
        "random:200 --engine float --kernel cubic",
        "random:200 --engine exact --zoom 1.5",
        "demo --light 1,0,0.3 --rules ewa --antialias swan --points auto",
        "random:60 --rules ewa --antialias swan --traversal stamp --phase-bits 2",
        "c.xyz --as surface --layers 3 --edges --light 1,0,1",
        "c.xyz --as surface --engine float --cull-backfaces",
        "h.csv --as surface --spacing 0.3",
    ] {
        let design = "base = \"lean18\"\nmantissa = 17\nrounding = \"truncate\"\n";
        shell.write("mine.toml", design);
        let line = format!("{scene} --design mine.toml --size 40x30");
        shell.succeed(&format!("render {line} -o a.npy --json r.json"));
        std::fs::remove_file(shell.path("mine.toml")).unwrap();
        let report = shell.report("r.json");
        shell.succeed("render --from r.json -o b.npy --json again.json");
        assert!(shell.bytes("a.npy") == shell.bytes("b.npy"), "{scene}");
        let repeated = Report {
            host: report.host,
            ..shell.report("again.json")
        };
        assert_eq!(repeated, report, "{scene}");
    }
}

/// The machine is part of the plan as well, and a comparison's report makes a comparison again.
#[test]
fn a_report_counts_the_same_cycles_again() {
    let shell = Shell::new();
    let machine = "--machine primitive-2 --set read_bandwidth=16";
    let line = format!("random:200 --size 40x30 --only --engine exact {machine}");
    shell.succeed(&format!("compare {line} -o a"));
    shell.succeed("compare --from a/report.json --only -o b");
    let [first, second] = ["a", "b"].map(|name| shell.json(&format!("{name}/report.json")));
    for key in ["plan", "cycles", "error"] {
        assert!(first[key].is_object(), "{key}");
        assert_eq!(first[key], second[key]);
    }
    shell.succeed("model --from a/report.json -o m");
    let timing = shell.json("m/timing.json");
    assert_eq!(timing["cycles"]["total"], first["cycles"]["total"]);
}

/// A line of a table of footprints by its columns; nothing where a field is empty.
type Fields = Vec<Option<f64>>;

/// Where splats or points land by the kernel and in double precision: centre, depth and conic agree, and what is culled
/// has its number alone.
fn footprints(shell: &Shell, scene: &str) -> [Vec<Fields>; 2] {
    let tables = ["fixed", "float"].map(|engine| {
        shell.succeed(&format!("footprints {scene} --engine {engine} -o f.csv"));
        let text = shell.read("f.csv");
        let (heading, lines) = text.split_once('\n').unwrap();
        let columns = "index,u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1,opacity,cutoff";
        assert_eq!(heading, columns);
        let fields = |line: &str| line.split(',').map(|field| field.parse().ok()).collect();
        lines.lines().map(fields).collect::<Vec<Fields>>()
    });
    assert_eq!(tables[0].len(), tables[1].len());
    for (index, (a, b)) in tables[0].iter().zip(&tables[1]).enumerate() {
        for line in [a, b] {
            assert_eq!((line.len(), line[0]), (13, Some(index as f64)));
            // Points of a surface have no opacity of their own: that field alone is empty.
            let present = line[1..].iter().flatten().count();
            assert!(present == 0 || present >= 11, "{line:?}");
        }
        let conic = b[4..=6].iter().flatten();
        let largest = conic.fold(0.0, |most: f64, entry| most.max(entry.abs()));
        for column in 1..=6 {
            let bound = if column <= 3 { 1e-3 } else { 1e-4 * largest };
            if let (Some(fixed), Some(float)) = (a[column], b[column]) {
                assert!((fixed - float).abs() < bound, "{a:?} {b:?}");
            }
        }
    }
    tables
}

#[test]
fn footprints_are_csv_with_empty_fields_for_culled_splats() {
    let shell = Shell::new();
    let view = "--eye 0,0,-2 --target 0,0,0 --size 40x30";
    let [fixed, float] = footprints(&shell, &format!("random:300 {view}"));
    assert_eq!(fixed.len(), 300);
    let pairs = fixed.iter().zip(&float);
    let drawn = pairs.filter(|(a, b)| a[1].is_some() && b[1].is_some());
    let drawn: Vec<_> = drawn.map(|(a, _)| a).collect();
    assert!(drawn.iter().all(|a| a[7] < a[9] && a[8] < a[10]));
    assert!((20..300).contains(&drawn.len()), "{} drawn", drawn.len());
}

const SURFACE: &str =
    "c.xyz --as surface --size 40x30 --eye 2.5,2.5,16 --target 2.5,2.5,0 --up 0,1,0";

/// Surfaces come through the same entrance; what counts cycles has a unit for them.
#[test]
fn surfaces_are_taken_by_every_command_that_they_mean_something_for() {
    let shell = Shell::new();
    shell.write("c.xyz", cloud());
    let [fixed, float] = footprints(&shell, SURFACE);
    assert_eq!(fixed.len(), 36);
    for (a, b) in fixed.iter().zip(&float) {
        let near =
            |column: usize, bound: f64| (a[column].unwrap() - b[column].unwrap()).abs() <= bound;
        assert!(
            (7..=10).all(|column| near(column, 1.0)) && near(12, 1e-6),
            "{a:?} {b:?}"
        );
    }
    shell.succeed(&format!("fit {SURFACE} --max-error 0.02 -o fit.toml"));
    shell.succeed(&format!(
        "compare {SURFACE} --design fit.toml --only -o out"
    ));
    let report = shell.report("out/report.json");
    assert!(report.error.unwrap().rgb.max_abs <= 0.02);
    shell.write("s.toml", "[machine]\nlanes = [1, 2]\n");
    shell.succeed(&format!("sweep {SURFACE} --space s.toml -o e"));
    shell.succeed(&format!("trace {SURFACE} --format vcd -o t.vcd"));
}

/// Its machine has a unit that is an estimate, and says so; what else is of volume splats alone refuses it.
#[test]
fn a_surface_is_simulated_and_its_question_answered() {
    let shell = Shell::new();
    shell.write("c.xyz", cloud());
    let scene = "c.xyz --as surface --size 40x30";
    shell.succeed(&format!("simulate {scene} -o m"));
    let timing = shell.json("m/timing.json");
    let work = &timing["cycles"]["surface"];
    let [samples, fragments] = ["samples", "fragments"].map(|key| work[key].as_u64());
    assert!(samples > fragments && fragments > Some(0));
    let limits = "--fps 100 --max-error 0.05 --lut 100000";
    let space = "[machine]\nlanes = [1, 2]\nresolve_interval = [1, 8]\nsetup_interval = [8, 16]\n";
    shell.write("s.toml", space);
    shell.succeed(&format!("optimize {scene} {limits} --space s.toml -o a"));
    let answer = shell.json("a/answer.json");
    assert_eq!(answer["answer"]["holds"], true);
    let estimate = "the surface unit is an estimate";
    for said in [&timing["area"]["of"], &answer["area_of"]] {
        holds(said.as_str().unwrap(), &[estimate]);
    }
    holds(&shell.read("a/answer.html"), &[estimate, "gather"]);
    shell.refuses(&format!(
        "1 simulate {scene} --machines => {VOLUMES_ALONE}
         1 simulate {scene} --turntable 2 --set sort_passes=2 --set sort_every=2 => {VOLUMES_ALONE}
         1 simulate {scene} --machine primitive-4 => the circuit of sim/rtl has no surface unit
         1 simulate {scene} --machine machine-4 --set overlap=pipelined => nothing is sorted
         1 simulate {scene} --layers 2 --set surface_layers=4 => surface_layers = 2
         1 simulate random:20:1 --size 40x30 --set surface_layers=1 => surface_layers = 0"
    ));
}

#[test]
fn a_cloud_is_drawn_as_a_surface() {
    let shell = Shell::new();
    shell.write("c.xyz", cloud());
    for options in [
        "",
        "--layers 4 --edges",
        "--light 0,0,1",
        "--engine float",
        "--z-threshold 0.5",
    ] {
        shell.succeed(&format!("render {SURFACE} {options} --alpha -o c.png"));
        let drawn = Picture::read_png(&shell.path("c.png")).unwrap();
        let middle = drawn.pixels[15 * 40 + 20];
        assert!(middle[3] > 0.99 && middle[2] > 0.1, "{options}: {middle:?}");
        assert_eq!(drawn.pixels[0], [0.0; 4], "{options}");
    }
    shell.succeed(&format!("compare {SURFACE} --layers 2 --only -o ."));
    let report = shell.report("report.json");
    let told = (report.rules.name, report.compositing.as_str());
    assert_eq!(told, ("surf", "2 layers"));
    assert!(report.error.unwrap().rgb.psnr_db > 60.0);
}

/// Up, angle and orbit without an eye turn the automatic view, which still shows the whole scene.
#[test]
fn view_options_alone_keep_the_whole_scene_in_view() {
    let shell = Shell::new();
    let random = Path::new("random:200");
    let scene = splatline_sim::scene::load(random, &Default::default()).unwrap();
    let mut cameras = Vec::new();
    for options in [
        "",
        "--up 0,0,1",
        "--fov 30",
        "--orbit 40,20",
        "--up 1,0,0 --fov 70",
    ] {
        let line = format!("render random:200 --size 64x48 {options}");
        shell.succeed(&format!("{line} -o x.png --json r.json"));
        let (camera, _) = Camera::corrected_from_json_file(&shell.path("r.json")).unwrap();
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
    let shell = Shell::new();
    shell.succeed("render random:200 --orbit 40,20 --size 40x30 -o a.npy --json r.json");
    shell.succeed("render random:200 --camera r.json -o b.npy");
    assert!(shell.bytes("a.npy") == shell.bytes("b.npy"));
    shell.succeed("render random:200 --camera r.json --zoom 2 -o b.npy");
    assert!(shell.bytes("a.npy") != shell.bytes("b.npy"));
}

/// `convert` is whatever the total has beyond the other stages; of one run they add up but for the rounding of a sum, a
/// nanosecond.
#[test]
fn every_phase_of_the_total_has_a_name() {
    let shell = Shell::new();
    for engine in ["fixed", "float"] {
        let line = format!("render random:300 --size 80x60 --engine {engine}");
        let printed = shell.succeed(&format!("{line} -o x.png --json r.json"));
        let host = shell.report("r.json").host;
        let named = host.setup_s + host.sort_s + host.raster_s + host.convert_s;
        assert!((host.total_s - named).abs() < 1e-9, "{host:?}");
        assert!(host.prepare_s > 0.0, "{host:?}");
        holds(&printed, &["of loading and preparing"]);
        if engine == "fixed" {
            holds(&printed, &["setup ", "sort ", "raster ", "convert "]);
        }
    }
}
