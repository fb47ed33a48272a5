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
    let names =
        "x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3";
    let properties: String = names
        .split(' ')
        .map(|name| format!("property float {name}\n"))
        .collect();
    for (iteration, colour) in [(7000, -1.0), (30000, 1.0)] {
        let place = folder.join(format!("model/point_cloud/iteration_{iteration}"));
        fs::create_dir_all(&place).unwrap();
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 1\n{properties}end_header\n0 0 4 {colour} 0 0 4 -1 -1 -1 1 0 0 0\n"
        );
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
