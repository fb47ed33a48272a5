use splatline_sim::design::DesignChoice;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::synthetic;
use splatline_sim::{fixed, reference::float};
fn main() {
    let scene = synthetic::deep_stack(1);
    let camera = synthetic::camera(512, 512);
    let rules = Rules::GAUSSIAN_3D;
    let exact = float::draw(&scene, &camera, &rules, Compositing::FrontToBack).picture;
    for text in [
        "base=\"deep32\"",
        "base=\"deep32\"\ncolour=28",
        "base=\"deep32\"\ntable=14",
        "base=\"deep32\"\ncolour=28\naccumulator=26",
        "base=\"deep32\"\ntransmittance=29",
        "base=\"standard24\"",
        "base=\"standard24\"\ninterpolation=20",
        "base=\"standard24\"\ncolour=28",
    ] {
        let design = DesignChoice::from_toml("x", text).unwrap();
        let options = fixed::Options {
            rules: &rules,
            compositing: Compositing::FrontToBack,
            design: &design,
            traversal: design.traversal,
        };
        let drawing = fixed::draw(&scene, &camera, &options);
        let mut bias = [0.0f64; 4];
        for (a, b) in drawing.picture.pixels.iter().zip(&exact.pixels) {
            for k in 0..4 {
                bias[k] += a[k] - b[k];
            }
        }
        println!(
            "{text:?} {:?} mean {:?}",
            bias.map(|b| b / exact.pixels.len() as f64),
            {
                let mut m = [0.0f64; 4];
                for p in &exact.pixels {
                    for k in 0..4 {
                        m[k] += p[k];
                    }
                }
                m.map(|x| x / exact.pixels.len() as f64)
            }
        );
    }
}
