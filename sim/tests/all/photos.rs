//! Photographs: a COLMAP model of which `exact` takes the pictures, compared with what is drawn; and a trainer's folder.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Views of the model: two of them are the test split.
const VIEWS: usize = 9;

fn splatline(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_splatline"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap()
}

fn succeed(folder: &Path, arguments: &str) -> String {
    let output = splatline(folder, arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments}: {said}");
    String::from_utf8(output.stdout).unwrap()
}

/// A model of views from a line in front of the scene, in COLMAP's text.
fn write_model(folder: &Path) {
    let sparse = folder.join("sparse/0");
    fs::create_dir_all(&sparse).unwrap();
    let cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS\n1 PINHOLE 96 64 90 90 48 32\n";
    fs::write(sparse.join("cameras.txt"), cameras).unwrap();
    let image = |view: usize| {
        let x = 0.1 * view as f64 - 0.4;
        format!("{view} 1 0 0 0 {x} 0 4 1 view_{view}.png\n\n")
    };
    let images: String = (0..VIEWS).map(image).collect();
    fs::write(sparse.join("images.txt"), images).unwrap();
}

/// A PLY of Gaussians as trainers write it; without the third scale they are flat.
fn gaussians(scales: usize, records: &[String]) -> String {
    let scales = (0..scales).map(|axis| format!("scale_{axis}"));
    let names = "x y z f_dc_0 f_dc_1 f_dc_2 opacity"
        .split(' ')
        .map(str::to_owned);
    let turns = (0..4).map(|part| format!("rot_{part}"));
    let properties: String = names
        .chain(scales)
        .chain(turns)
        .map(|name| format!("property float {name}\n"))
        .collect();
    let (count, records) = (records.len(), records.join("\n"));
    format!("ply\nformat ascii 1.0\nelement vertex {count}\n{properties}end_header\n{records}\n")
}

/// What `exact` sees, as photographs.
fn photograph(folder: &Path, size: &str) {
    fs::create_dir_all(folder.join("images")).unwrap();
    for view in 0..VIEWS {
        let name = format!("view_{view}.png");
        succeed(
            folder,
            &format!(
                "render random:400:3 --camera sparse/0 --image {name} {size} --engine exact -o images/{name}"
            ),
        );
    }
}

fn report(folder: &Path) -> serde_json::Value {
    let text = fs::read_to_string(folder.join("out/photos.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn mean(report: &serde_json::Value, engine: &str, field: &str) -> f64 {
    let means = report["means"].as_array().unwrap();
    let line = means.iter().find(|mean| mean["engine"] == engine);
    line.unwrap_or_else(|| panic!("no {engine}"))[field]
        .as_f64()
        .unwrap()
}

#[test]
fn what_a_design_costs_against_photographs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_model(folder);
    photograph(folder, "");
    let told = succeed(
        folder,
        "compare random:400:3 --camera sparse/0 --photos images --formats -o out",
    );
    assert!(told.starts_with("2 views against photographs"), "{told}");
    let found = report(folder);
    assert_eq!(found["views"][0]["name"], "view_0.png");
    assert_eq!(found["views"][1]["name"], "view_8.png");
    // The affine approximation and the photographs' 8 bits.
    let float = mean(&found, "float", "psnr_db");
    assert!(float > 30.0 && float < 70.0, "{float}");
    let cost = |engine| mean(&found, engine, "psnr_change_db").abs();
    assert!(cost("standard24") < 1e-3 && cost("deep32") < 1e-3);
    assert!(cost("lean18") < 0.1, "{}", cost("lean18"));
    assert!(cost("classic8") > cost("lean18"));
    assert!(cost("fp8-fp16") > cost("fp16") && cost("bfloat16") > cost("fp16"));
    assert!(mean(&found, "float", "ssim") > 0.98 && mean(&found, "float", "flip") < 0.05);
    for file in [
        "photo.png",
        "float.png",
        "fixed.png",
        "float-error.png",
        "fixed-error.png",
    ] {
        assert!(folder.join("out/view-0002").join(file).is_file(), "{file}");
    }
    let page = fs::read_to_string(folder.join("out/photos.html")).unwrap();
    assert!(page.matches("data:image/png").count() == 10 && page.contains("view_8.png"));
}

#[test]
fn photographs_of_half_the_size_decide_and_missing_ones_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_model(folder);
    photograph(folder, "--size 48x32");
    let command =
        "compare random:400:3 --camera sparse/0 --photos images --only --split all -o out";
    let output = splatline(folder, command);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && said.contains("photographs of 48x32 decide"),
        "{said}"
    );
    let found = report(folder);
    assert_eq!(found["views"].as_array().unwrap().len(), VIEWS);
    assert_eq!(found["views"][0]["size"][0], 48);
    assert!(mean(&found, "float", "psnr_db") > 30.0);
    // A mask of nothing leaves nothing to differ.
    fs::create_dir_all(folder.join("masks")).unwrap();
    for view in 0..VIEWS {
        let black = image::GrayImage::new(48, 32);
        black
            .save(folder.join(format!("masks/view_{view}.png")))
            .unwrap();
    }
    succeed(folder, &format!("{command} --masks masks"));
    assert_eq!(mean(&report(folder), "standard24", "flip"), 0.0);
    fs::remove_file(folder.join("images/view_3.png")).unwrap();
    let output = splatline(folder, command);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said.contains("'images' holds no picture of the view 'view_3.png'"),
        "{said}"
    );
}

/// Maps have the picture's size and say which splats it is made of; no other image library reads our numbers, so bytes are looked at.
#[test]
fn maps_lie_beside_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let all = "depth,alpha,normal,count,first,id";
    let told = succeed(
        folder,
        &format!("render random:50:2 --size 40x30 --maps {all} -o x.png"),
    );
    for name in all.split(',') {
        let map = image::open(folder.join(format!("x.{name}.png"))).unwrap();
        assert_eq!((map.width(), map.height()), (40, 30), "{name}");
        assert!(map.to_rgb8().pixels().any(|p| p.0 != [0; 3]), "{name}");
        assert!(told.contains(&format!("x.{name}.png: ")), "{told}");
    }
    succeed(folder, "render random:50:2 --size 40x30 --maps id -o x.npy");
    let bytes = fs::read(folder.join("x.id.npy")).unwrap();
    let numbers: Vec<f64> = bytes[bytes.len() - 40 * 30 * 32..]
        .as_chunks::<32>()
        .0
        .iter()
        .map(|pixel| f64::from_le_bytes(*pixel.first_chunk().unwrap()))
        .collect();
    assert!(
        numbers
            .iter()
            .all(|n| n.fract() == 0.0 && (-1.0..50.0).contains(n))
    );
    assert!(numbers.iter().any(|n| *n > 0.0));
    let refused = splatline(folder, "render random:50:2 --maps depht -o x.png");
    assert_eq!(refused.status.code(), Some(2));
}

/// Two iterations and a list of cameras, as the trainer leaves them.
#[test]
fn a_trainers_folder_is_a_scene_with_its_camera() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (iteration, colour) in [(7000, -1.0), (30000, 1.0)] {
        let place = folder.join(format!("model/point_cloud/iteration_{iteration}"));
        fs::create_dir_all(&place).unwrap();
        let text = gaussians(3, &[format!("0 0 4 {colour} 0 0 4 -1 -1 -1 1 0 0 0")]);
        fs::write(place.join("point_cloud.ply"), text).unwrap();
    }
    let camera = r#"[{"id": 0, "img_name": "first", "width": 40, "height": 30, "position": [0, 0, 0],
        "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "fy": 40, "fx": 40}]"#;
    fs::write(folder.join("model/cameras.json"), camera).unwrap();
    let output = splatline(folder, "render model -o x.png");
    let told = String::from_utf8_lossy(&output.stdout);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && said.contains("iteration 30000"),
        "{said}"
    );
    assert!(told.contains("camera: first, the first of 1"), "{told}");
    let picture = image::open(folder.join("x.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (40, 30));
    let [red, green, _] = picture.get_pixel(20, 15).0;
    assert!(red > green, "the later iteration is red");
    let stretched = splatline(folder, "render model --camera model --size 80x30 -o x.png");
    let said = String::from_utf8_lossy(&stretched.stderr);
    assert!(said.contains("stretched by 2.000"), "{said}");
}

/// A small splat that is drawn through a lens lies where COLMAP's own code sees it (the second row of OPENCV in `reference/assets/lenses.tsv`).
#[test]
fn a_lens_bends_the_picture_as_colmap_does() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let table = include_str!("../../reference/assets/lenses.tsv");
    // Logarithms of scales: a spot much narrower than a pixel of the picture is sampled beside its middle (the fisheye's at -5 by 0.047 pixels), and
    // a wide one is bent (that of OPENCV at -4 by 0.018).
    for (model, scale) in [("OPENCV", -5.0), ("OPENCV_FISHEYE", -4.25)] {
        let line = table
            .lines()
            .filter(|line| line.split('\t').next() == Some(model))
            .nth(1);
        let fields: Vec<&str> = line.unwrap().split('\t').collect();
        let number = |field: usize| fields[field].parse::<f64>().unwrap();
        let sparse = folder.join("sparse/0");
        fs::create_dir_all(&sparse).unwrap();
        let cameras = format!("1 {model} 1280 720 {}\n", fields[1]);
        fs::write(sparse.join("cameras.txt"), cameras).unwrap();
        fs::write(sparse.join("images.txt"), "1 1 0 0 0 0 0 0 1 one.png\n\n").unwrap();
        let place = [2, 3].map(|field| 4.0 * number(field));
        let [x, y] = place;
        let record = format!("{x} {y} 4 1 1 1 4 {scale} {scale} {scale} 1 0 0 0");
        let text = gaussians(3, &[record]);
        fs::write(folder.join("one.ply"), text).unwrap();
        let said = succeed(
            folder,
            "render one.ply --camera sparse/0 --distort -o x.npy",
        );
        assert!(said.contains("1 splats"), "{said}");
        let bytes = fs::read(folder.join("x.npy")).unwrap();
        let pixels = bytes[bytes.len() - 1280 * 720 * 32..].as_chunks::<32>().0;
        let mut sums = [0.0; 3];
        for (at, pixel) in pixels.iter().enumerate() {
            let alpha = f64::from_le_bytes(pixel[24..].try_into().unwrap());
            let place = [(at % 1280) as f64 + 0.5, (at / 1280) as f64 + 0.5];
            sums[0] += alpha * place[0];
            sums[1] += alpha * place[1];
            sums[2] += alpha;
        }
        let apart = (sums[0] / sums[2] - number(4)).hypot(sums[1] / sums[2] - number(5));
        assert!(apart < 0.01, "{model}: {apart}");
    }
}

/// Frames are called after their cameras' pictures, or numbered; an animation holds them all.
#[test]
fn frames_are_called_after_their_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_model(folder);
    let told = succeed(folder, "render random:40:3 --camera-path sparse/0 -o x.png");
    assert!(told.contains("x-view_0.png to x-view_8.png"), "{told}");
    assert!(folder.join("x-view_4.png").is_file());
    let turned = "render random:40:3 --turntable 4 --size 32x24 --animation turning.png -o y.png";
    succeed(folder, turned);
    assert!(folder.join("turning.png").is_file() && folder.join("y-0004.png").is_file());
    let first = fs::read(folder.join("y-0001.png")).unwrap();
    succeed(folder, "render random:40:3 --size 32x24 -o whole.png");
    assert_eq!(first, fs::read(folder.join("whole.png")).unwrap());
    assert_ne!(first, fs::read(folder.join("y-0002.png")).unwrap());
}

/// What a command always refuses is not in its help, and is refused before the scene is looked for.
#[test]
fn what_is_always_refused_is_refused_first() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (command, expected) in [
        (
            "simulate none.ply --sheets image-aligned",
            "leave out --points",
        ),
        (
            "trace none.ply --deep-alpha opacity --format vcd -o t.vcd",
            "leave out --points",
        ),
        (
            "page none.ply --as surface -o p.html",
            "the live page draws volume splats",
        ),
        (
            "bake none.ply --as surface -o b.bin",
            "only scenes of 3D Gaussians are baked",
        ),
    ] {
        let output = splatline(folder, command);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command}");
        assert!(said.contains(expected), "{command}: {said}");
        let help = succeed(
            folder,
            &format!("{} --help", command.split(' ').next().unwrap()),
        );
        let has_surfaces = !command.starts_with("page") && !command.starts_with("bake");
        assert!(!help.contains("--sheets"), "{help}");
        assert_eq!(help.contains("--layers"), has_surfaces, "{help}");
    }
    let maps = splatline(folder, "render sphere --as surface --maps depth -o x.png");
    let said = String::from_utf8_lossy(&maps.stderr);
    assert!(said.contains("--maps are of volume splats"), "{said}");
    assert!(!folder.join("x.png").exists());
}

/// What antialiased models, and 2D Gaussians, are drawn with, by the bars of accuracy.
#[test]
fn antialiased_and_flat_scenes_meet_the_bars() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let records = |third: &'static str| {
        (0..300).map(move |k| {
            let wave = |frequency: f64| (frequency * f64::from(k)).sin();
            let place = [wave(1.1), wave(2.3), wave(3.7)]
                .map(|x| x.to_string())
                .join(" ");
            let colour = [wave(0.3), wave(0.5), wave(0.7)]
                .map(|x| x.to_string())
                .join(" ");
            let turn = [wave(1.9), wave(2.9), wave(4.1), wave(5.3)]
                .map(|x| x.to_string())
                .join(" ");
            format!(
                "{place} {colour} {} -2 {}{third} {turn}",
                2.0 * wave(6.1),
                -3.0 + wave(7.1)
            )
        })
    };
    // 2D Gaussians are what ellipsoids become that are flattened more and more.
    let drawn = [("flat.ply", 2, ""), ("flattened.ply", 3, " -15")].map(|(file, scales, third)| {
        let text = gaussians(scales, &records(third).collect::<Vec<_>>());
        fs::write(folder.join(file), text).unwrap();
        succeed(folder, &format!("render {file} --size 64x64 -o x.npy"));
        let bytes = fs::read(folder.join("x.npy")).unwrap();
        let numbers = bytes[bytes.len() - 64 * 64 * 32..].as_chunks().0;
        numbers
            .iter()
            .map(|number| f64::from_le_bytes(*number))
            .collect::<Vec<f64>>()
    });
    let apart = drawn[0].iter().zip(&drawn[1]).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-6 && drawn[0].iter().any(|value| *value > 0.5));
    for scene in ["random:1500:1", "random:1500:2", "flat.ply"] {
        for (design, bar) in [("lean18", 85.0), ("standard24", 110.0), ("deep32", 120.0)] {
            let command = format!(
                "compare {scene} --antialias mip --size 256x256 --design {design} --only --json r.json -o out"
            );
            succeed(folder, &command);
            let text = fs::read_to_string(folder.join("r.json")).unwrap();
            let report: serde_json::Value = serde_json::from_str(&text).unwrap();
            let psnr = report["error"]["rgb"]["psnr_db"].as_f64().unwrap();
            assert!(psnr >= bar, "{scene}, {design}: {psnr}");
        }
    }
}

/// Rules as numbers: what each option changes, against a splat in the middle of a pixel by hand.
#[test]
fn opacities_are_the_rules() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // Opacity 1 - 5e-5; a ball of 0.02 four away, at 100 pixels of focal length: variance 0.25 square pixels.
    let text = gaussians(
        3,
        &[format!("0 0 4 1 1 1 10 {0} {0} {0} 1 0 0 0", 0.02f64.ln())],
    );
    fs::write(folder.join("one.ply"), text).unwrap();
    let sparse = folder.join("sparse/0");
    fs::create_dir_all(&sparse).unwrap();
    fs::write(
        sparse.join("cameras.txt"),
        "1 PINHOLE 9 9 100 100 4.5 4.5\n",
    )
    .unwrap();
    fs::write(sparse.join("images.txt"), "1 1 0 0 0 0 0 0 1 one.png\n\n").unwrap();
    let opacity = 1.0 / (1.0 + (-10.0f64).exp());
    for (options, expected) in [
        ("--rules 3dgs", 0.999),
        ("--rules inria", 0.99),
        ("--antialias mip", opacity * 0.25 / 0.55),
        ("--antialias mip --low-pass 0.1", opacity * 0.25 / 0.35),
        ("--rules inria --antialias none", 0.99),
    ] {
        for engine in ["fixed", "float"] {
            succeed(
                folder,
                &format!("render one.ply --camera sparse/0 {options} --engine {engine} -o x.npy"),
            );
            let bytes = fs::read(folder.join("x.npy")).unwrap();
            let pixel = &bytes[bytes.len() - 81 * 32..].as_chunks::<32>().0[40];
            let alpha = f64::from_le_bytes(pixel[24..].try_into().unwrap());
            assert!(
                (alpha - expected).abs() < 2e-6,
                "{options} by {engine}: {alpha} {expected}"
            );
        }
    }
    for refused in ["--low-pass -1", "--sh-degree 5", "--fov -1", "--zoom 0"] {
        let output = splatline(folder, &format!("render one.ply {refused} -o x.npy"));
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            said.contains("invalid value") && !said.contains("unexpected"),
            "{said}"
        );
    }
}
