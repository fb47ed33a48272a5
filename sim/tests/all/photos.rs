//! Photographs: a COLMAP model of which `exact` takes the pictures, compared with what is drawn; and a trainer's
//! folder.

use super::hostile::seeds::{GAUSSIAN, ply_header};
use super::shell::{Shell, holds};
use std::fs;

/// Views of the model: two of them are the test split.
const VIEWS: usize = 9;

/// A model of views from a line in front of the scene, in COLMAP's text.
fn write_model(shell: &Shell) {
    let cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS\n1 PINHOLE 96 64 90 90 48 32\n";
    shell.write("sparse/0/cameras.txt", cameras);
    let image = |view: usize| {
        let x = 0.1 * view as f64 - 0.4;
        format!("{view} 1 0 0 0 {x} 0 4 1 view_{view}.png\n\n")
    };
    shell.write(
        "sparse/0/images.txt",
        (0..VIEWS).map(image).collect::<String>(),
    );
}

/// A PLY of Gaussians as trainers write it; without the third scale they are flat.
pub fn gaussians(scales: usize, records: &[String]) -> String {
    let wanted = |name: &&str| !name.starts_with('n') && (scales == 3 || *name != "scale_2");
    let names: Vec<&str> = GAUSSIAN.into_iter().filter(wanted).collect();
    let header = ply_header("ascii", &names, records.len());
    format!("{header}{}\n", records.join("\n"))
}

/// What `exact` sees, as photographs.
fn photograph(shell: &Shell, size: &str) {
    fs::create_dir_all(shell.path("images")).unwrap();
    for view in 0..VIEWS {
        let name = format!("view_{view}.png");
        let camera = format!("--camera sparse/0 --image {name} {size}");
        shell.succeed(&format!(
            "render random:400:3 {camera} --engine exact -o images/{name}"
        ));
    }
}

/// A picture's pixels from a file of double precision.
fn pixels(shell: &Shell, name: &str, count: usize) -> Vec<[f64; 4]> {
    let bytes = shell.bytes(name);
    let numbers = bytes[bytes.len() - 32 * count..].as_chunks().0;
    let numbers: Vec<f64> = numbers.iter().map(|n| f64::from_le_bytes(*n)).collect();
    numbers.as_chunks().0.to_vec()
}

/// A camera of one view, in COLMAP's text.
fn write_view(shell: &Shell, camera: &str) {
    shell.write("sparse/0/cameras.txt", format!("1 {camera}\n"));
    let image = "1 1 0 0 0 0 0 0 1 one.png\n\n";
    shell.write("sparse/0/images.txt", image);
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
    let shell = Shell::new();
    write_model(&shell);
    photograph(&shell, "");
    let printed =
        shell.succeed("compare random:400:3 --camera sparse/0 --photos images --formats -o out");
    assert!(
        printed.starts_with("2 views against photographs"),
        "{printed}"
    );
    let found = shell.json("out/photos.json");
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
        assert!(shell.has(&format!("out/view-0002/{file}")), "{file}");
    }
    let page = shell.read("out/photos.html");
    assert!(page.matches("data:image/png").count() == 10 && page.contains("view_8.png"));
}

#[test]
fn photographs_of_half_the_size_decide_and_missing_ones_are_named() {
    let shell = Shell::new();
    write_model(&shell);
    photograph(&shell, "--size 48x32");
    let command =
        "compare random:400:3 --camera sparse/0 --photos images --only --split all -o out";
    let said = shell.run(command);
    assert_eq!(said.code, Some(0), "{}", said.stderr);
    holds(&said.stderr, &["photographs of 48x32 decide"]);
    let found = shell.json("out/photos.json");
    assert_eq!(found["views"].as_array().unwrap().len(), VIEWS);
    assert_eq!(found["views"][0]["size"][0], 48);
    assert!(mean(&found, "float", "psnr_db") > 30.0);
    // A mask of nothing leaves nothing to differ.
    fs::create_dir_all(shell.path("masks")).unwrap();
    for view in 0..VIEWS {
        let black = image::GrayImage::new(48, 32);
        let mask = shell.path(&format!("masks/view_{view}.png"));
        black.save(mask).unwrap();
    }
    shell.succeed(&format!("{command} --masks masks"));
    assert_eq!(
        mean(&shell.json("out/photos.json"), "standard24", "flip"),
        0.0
    );
    fs::remove_file(shell.path("images/view_3.png")).unwrap();
    let expected = "'images' holds no picture of the view 'view_3.png'";
    shell.refused(1, command, expected);
}

/// Maps have the picture's size and say which splats it is made of; no other image library reads our numbers, so bytes
/// are looked at.
#[test]
fn maps_lie_beside_the_picture() {
    let shell = Shell::new();
    let all = "depth,alpha,normal,count,first,id";
    let printed = shell.succeed(&format!(
        "render random:50:2 --size 40x30 --maps {all} -o x.png"
    ));
    for name in all.split(',') {
        let map = image::open(shell.path(&format!("x.{name}.png"))).unwrap();
        assert_eq!((map.width(), map.height()), (40, 30), "{name}");
        assert!(map.to_rgb8().pixels().any(|p| p.0 != [0; 3]), "{name}");
        assert!(printed.contains(&format!("x.{name}.png: ")), "{printed}");
    }
    shell.succeed("render random:50:2 --size 40x30 --maps id -o x.npy");
    let numbers = pixels(&shell, "x.id.npy", 40 * 30);
    let numbers = numbers.iter().map(|pixel| pixel[0]);
    assert!(
        numbers
            .clone()
            .all(|n| n.fract() == 0.0 && (-1.0..50.0).contains(&n))
    );
    assert!(numbers.clone().any(|n| n > 0.0));
    shell.refused(2, "render random:50:2 --maps depht -o x.png", "depht");
}

/// Two iterations and a list of cameras, as the trainer leaves them.
#[test]
fn a_trainers_folder_is_a_scene_with_its_camera() {
    let shell = Shell::new();
    for (iteration, colour) in [(7000, -1.0), (30000, 1.0)] {
        let text = gaussians(3, &[format!("0 0 4 {colour} 0 0 4 -1 -1 -1 1 0 0 0")]);
        let place = format!("model/point_cloud/iteration_{iteration}");
        shell.write(&format!("{place}/point_cloud.ply"), text);
    }
    let camera = r#"[{"id": 0, "img_name": "first", "width": 40, "height": 30, "position": [0, 0, 0],
        "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "fy": 40, "fx": 40}]"#;
    shell.write("model/cameras.json", camera);
    let said = shell.run("render model -o x.png");
    assert_eq!(said.code, Some(0), "{}", said.stderr);
    holds(&said.stderr, &["iteration 30000"]);
    let printed = String::from_utf8(said.stdout).unwrap();
    holds(&printed, &["camera: first, the first of 1"]);
    let picture = image::open(shell.path("x.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (40, 30));
    let [red, green, _] = picture.get_pixel(20, 15).0;
    assert!(red > green, "the later iteration is red");
    let stretched = shell.run("render model --camera model --size 80x30 -o x.png");
    holds(&stretched.stderr, &["stretched by 2.000"]);
}

/// A small splat that is drawn through a lens lies where COLMAP's own code sees it (the second row of OPENCV in
/// `reference/assets/lenses.tsv`).
#[test]
fn a_lens_bends_the_picture_as_colmap_does() {
    let shell = Shell::new();
    let table = include_str!("../../reference/assets/lenses.tsv");
    // Logarithms of scales: a spot much narrower than a pixel of the picture is sampled beside its middle (the
    // fisheye's at -5 by 0.047 pixels), and a wide one is bent (that of OPENCV at -4 by 0.018).
    for (model, scale) in [("OPENCV", -5.0), ("OPENCV_FISHEYE", -4.25)] {
        let line = table
            .lines()
            .filter(|line| line.split('\t').next() == Some(model))
            .nth(1);
        let fields: Vec<&str> = line.unwrap().split('\t').collect();
        let number = |field: usize| fields[field].parse::<f64>().unwrap();
        write_view(&shell, &format!("{model} 1280 720 {}", fields[1]));
        let place = [2, 3].map(|field| 4.0 * number(field));
        let [x, y] = place;
        let record = format!("{x} {y} 4 1 1 1 4 {scale} {scale} {scale} 1 0 0 0");
        shell.write("one.ply", gaussians(3, &[record]));
        let said = shell.succeed("render one.ply --camera sparse/0 --distort -o x.npy");
        assert!(said.contains("1 splats"), "{said}");
        let pixels = pixels(&shell, "x.npy", 1280 * 720);
        let mut sums = [0.0; 3];
        for (at, [.., alpha]) in pixels.iter().enumerate() {
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
    let shell = Shell::new();
    write_model(&shell);
    let printed = shell.succeed("render random:40:3 --camera-path sparse/0 -o x.png");
    holds(&printed, &["x-view_0.png to x-view_8.png"]);
    assert!(shell.has("x-view_4.png"));
    let turned = "render random:40:3 --turntable 4 --size 32x24 --animation turning.png -o y.png";
    shell.succeed(turned);
    assert!(shell.has("turning.png") && shell.has("y-0004.png"));
    let first = shell.bytes("y-0001.png");
    shell.succeed("render random:40:3 --size 32x24 -o whole.png");
    assert_eq!(first, shell.bytes("whole.png"));
    assert_ne!(first, shell.bytes("y-0002.png"));
}

/// What a command always refuses is not in its help, and is refused before the scene is looked for.
#[test]
fn what_is_always_refused_is_refused_first() {
    let shell = Shell::new();
    shell.refuses(
        "2 simulate none.ply --sheets image-aligned => leave out --points
         2 trace none.ply --deep-alpha opacity --format vcd -o t.vcd => leave out --points
         2 page none.ply --as surface -o p.html => the live page draws volume splats
         2 bake none.ply --as surface -o b.bin => only scenes of 3D Gaussians are baked",
    );
    for (command, has_surfaces) in [
        ("simulate", true),
        ("trace", true),
        ("page", false),
        ("bake", false),
    ] {
        let help = shell.succeed(&format!("{command} --help"));
        assert!(!help.contains("--sheets"), "{help}");
        assert_eq!(help.contains("--layers"), has_surfaces, "{help}");
    }
    let maps = shell.run("render sphere --as surface --maps depth -o x.png");
    holds(&maps.stderr, &["--maps are of volume splats"]);
    assert!(!shell.has("x.png"));
}

/// What antialiased models, and 2D Gaussians, are drawn with, by the bars of accuracy.
#[test]
fn antialiased_and_flat_scenes_meet_the_bars() {
    let shell = Shell::new();
    let records = |third: &'static str| {
        (0..300).map(move |k| {
            let wave = |frequency: f64| (frequency * f64::from(k)).sin();
            let waves = |frequencies: &[f64]| {
                let waves = frequencies.iter().map(|f| wave(*f).to_string());
                waves.collect::<Vec<_>>().join(" ")
            };
            let place_and_colour = waves(&[1.1, 2.3, 3.7, 0.3, 0.5, 0.7]);
            let (opacity, scale) = (2.0 * wave(6.1), -3.0 + wave(7.1));
            let turn = waves(&[1.9, 2.9, 4.1, 5.3]);
            format!("{place_and_colour} {opacity} -2 {scale}{third} {turn}")
        })
    };
    // 2D Gaussians are what ellipsoids become that are flattened more and more.
    let drawn = [("flat.ply", 2, ""), ("flattened.ply", 3, " -15")].map(|(file, scales, third)| {
        let text = gaussians(scales, &records(third).collect::<Vec<_>>());
        shell.write(file, text);
        shell.succeed(&format!("render {file} --size 64x64 -o x.npy"));
        pixels(&shell, "x.npy", 64 * 64).concat()
    });
    let apart = drawn[0].iter().zip(&drawn[1]).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-6 && drawn[0].iter().any(|value| *value > 0.5));
    for scene in ["random:1500:1", "random:1500:2", "flat.ply"] {
        for (design, bar) in [("lean18", 85.0), ("standard24", 110.0), ("deep32", 120.0)] {
            let command = format!(
                "compare {scene} --antialias mip --size 256x256 --design {design} --only --json r.json -o out"
            );
            shell.succeed(&command);
            let psnr = shell.json("r.json")["error"]["rgb"]["psnr_db"]
                .as_f64()
                .unwrap();
            assert!(psnr >= bar, "{scene}, {design}: {psnr}");
        }
    }
}

/// Rules as numbers: what each option changes, against a splat in the middle of a pixel by hand.
#[test]
fn opacities_are_the_rules() {
    let shell = Shell::new();
    // Opacity 1 - 5e-5; a ball of 0.02 four away, at 100 pixels of focal length: variance 0.25 square pixels.
    let text = gaussians(
        3,
        &[format!("0 0 4 1 1 1 10 {0} {0} {0} 1 0 0 0", 0.02f64.ln())],
    );
    shell.write("one.ply", text);
    write_view(&shell, "PINHOLE 9 9 100 100 4.5 4.5");
    let opacity = 1.0 / (1.0 + (-10.0f64).exp());
    for (options, expected) in [
        ("--rules 3dgs", 0.999),
        ("--rules inria", 0.99),
        ("--antialias mip", opacity * 0.25 / 0.55),
        ("--antialias mip --low-pass 0.1", opacity * 0.25 / 0.35),
        ("--rules inria --antialias none", 0.99),
    ] {
        for engine in ["fixed", "float"] {
            shell.succeed(&format!(
                "render one.ply --camera sparse/0 {options} --engine {engine} -o x.npy"
            ));
            let alpha = pixels(&shell, "x.npy", 81)[40][3];
            assert!(
                (alpha - expected).abs() < 2e-6,
                "{options} by {engine}: {alpha} {expected}"
            );
        }
    }
    for refused in ["--low-pass -1", "--sh-degree 5", "--fov -1", "--zoom 0"] {
        let line = format!("render one.ply {refused} -o x.npy");
        let said = shell.refused(2, &line, "invalid value");
        assert!(!said.contains("unexpected"), "{said}");
    }
}
