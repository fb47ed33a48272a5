//! The reference against data that other people's code computed; passes with a message where the data is missing.

mod trainer_ply;

use std::path::{Path, PathBuf};

use splatline_sim::camera::Camera;
use splatline_sim::picture::{Depth, Picture};
use splatline_sim::reference::golden::{Deviation, GoldenA};
use splatline_sim::reference::{Culled, exact, float};
use splatline_sim::rules::{Compositing, Rules};

fn golden_folder() -> Option<PathBuf> {
    let folder = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../shared/data/golden"
    ));
    if folder.is_dir() {
        return Some(folder.to_path_buf());
    }
    println!("skipped: the golden data is not at {}", folder.display());
    None
}

fn print_table(deviations: &[Deviation]) {
    println!("{:<18} {:>6} {:>10} {:>10} {:>10}", "category", "splats", "conic", "centre", "picture");
    for d in deviations {
        println!(
            "{:<18} {:>6} {:>10.1e} {:>10.1e} {:>10.1e}",
            d.category, d.splats, d.conic, d.centre, d.picture
        );
    }
}

#[test]
fn float_agrees_with_sixty_digits_and_with_independent_pictures() {
    let Some(folder) = golden_folder() else { return };
    let golden = GoldenA::load(&folder).unwrap();
    assert_eq!(golden.splats.len(), 256);
    assert_eq!(golden.categories.len(), 11);
    let deviations = golden.measure(&folder).unwrap();
    print_table(&deviations);
    for d in &deviations {
        assert!(d.splats > 0, "{}: nothing compared", d.category);
        assert!(d.conic <= 1e-9, "{}: conic differs by {:e}", d.category, d.conic);
        assert!(d.centre <= 1e-12, "{}: centre differs by {:e}", d.category, d.centre);
        assert!(d.picture <= 2e-5, "{}: picture differs by {:e}", d.category, d.picture);
    }
}

#[test]
fn nothing_is_culled_that_the_golden_source_sees() {
    let Some(folder) = golden_folder() else { return };
    let golden = GoldenA::load(&folder).unwrap();
    println!("culled here only: {:?}", golden.culled_here_only());
    for (index, why) in golden.culled_here_only() {
        // The source has a footprint for any opacity; below 1/255 none of its pixels is ever blended.
        let opacity = golden.splats[index].splat.weight;
        let too_faint = why == Culled::Transparent && opacity < 1.0 / 255.0;
        assert!(too_faint, "splat {index} of opacity {opacity} is culled as {why:?}");
    }
}

/// Peak signal to noise ratio of the colours, in decibels.
fn psnr(a: &Picture, b: &Picture) -> f64 {
    let pixels = a.pixels.iter().zip(&b.pixels);
    let squares: f64 = pixels.flat_map(|(a, b)| (0..3).map(move |i| (a[i] - b[i]).powi(2))).sum();
    -10.0 * (squares / (3 * a.pixels.len()) as f64).log10()
}

#[test]
fn tiny_scene_agrees_with_an_independent_renderer() {
    let Some(folder) = golden_folder() else { return };
    let scene = trainer_ply::load(&folder.join("tiny.ply"));
    assert_eq!(scene.splats.len(), 400);
    let expected = Picture::read_png(&folder.join("tiny.png")).unwrap();
    let camera = Camera::look_at([0.0, -5.0, -8.0], [0.0; 3], [0.0, -1.0, 0.0], 60.0, 320, 240).unwrap();
    let draw = |rules: &Rules| float::draw(&scene, &camera, rules, Compositing::FrontToBack).picture;
    let picture = draw(&Rules::GAUSSIAN_3D);
    for (name, rules) in [
        ("3dgs", Rules::GAUSSIAN_3D),
        ("no low pass", Rules { low_pass: 1e-9, ..Rules::GAUSSIAN_3D }),
        ("cut at 2 sigma", Rules { cutoff: 4.0, ..Rules::GAUSSIAN_3D }),
        ("cut at sqrt 8 sigma", Rules { cutoff: 8.0, ..Rules::GAUSSIAN_3D }),
        ("cut at 3 sigma", Rules { cutoff: 9.0, ..Rules::GAUSSIAN_3D }),
        ("alpha max 0.99", Rules { alpha_max: 0.99, ..Rules::GAUSSIAN_3D }),
    ] {
        println!("{name}: {:.2} dB", psnr(&draw(&rules), &expected));
    }
    let ex = exact::draw(&scene, &camera, &Rules::GAUSSIAN_3D, Compositing::FrontToBack).picture;
    println!("exact: {:.2} dB", psnr(&ex, &expected));
    picture.write_png(Path::new("/tmp/tiny_mine.png"), Depth::Eight).unwrap();
    assert!(psnr(&picture, &expected) >= 40.0);
}
