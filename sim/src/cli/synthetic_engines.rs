//! Stand-ins for the engines, for the commands' tests: every scene is one soft disc. See `engines.rs`.

use super::args::{DesignChoice, Engine, Size, TraversalChoice};
use super::drawing::{Design, Drawing, FootprintLine};
use anyhow::{Result, bail};
use splatline_sim::atomic;
use splatline_sim::camera::Camera;
use splatline_sim::picture::Picture;
use splatline_sim::report::png::Rgb;
use splatline_sim::report::{HostTimes, Pixels};
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::{Scene, Skipped, Splat, Weight};
use std::path::Path;

pub fn load_scene(path: &Path, _transfer: Option<&Path>, _light: Option<[f64; 3]>) -> Result<Scene> {
    if path == Path::new("missing.ply") {
        bail!("cannot read 'missing.ply': no such file");
    }
    demo_scene()
}

pub fn demo_scene() -> Result<Scene> {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let splat = Splat { centre: [0.0; 3], axes, weight: 0.5, colour: [1.0, 0.5, 0.25] };
    Ok(Scene {
        name: "disc".to_owned(),
        natural_rules: Rules::GAUSSIAN_3D,
        weight: Weight::Opacity,
        splats: vec![splat; 2],
        harmonics: None,
        skipped: Skipped { non_finite: 1, zero_rotation: 0 },
        up: [0.0, -1.0, 0.0],
    })
}

pub fn default_camera(_scene: &Scene, size: Size) -> Result<Camera> {
    Ok(camera(size))
}

pub fn camera_from_file(_path: &Path) -> Result<Camera> {
    Ok(camera(Size { width: 40, height: 30 }))
}

pub fn camera_looking_at(
    eye: [f64; 3],
    target: [f64; 3],
    _up: [f64; 3],
    _vertical_fov_degrees: f64,
    size: Size,
) -> Result<Camera> {
    if eye == target {
        bail!("eye and target are the same point");
    }
    Ok(camera(size))
}

pub fn resized_camera(_camera: &Camera, size: Size) -> Result<Camera> {
    Ok(camera(size))
}

fn camera(size: Size) -> Camera {
    Camera {
        width: size.width,
        height: size.height,
        fx: 100.0,
        fy: 100.0,
        cx: size.width as f64 / 2.0,
        cy: size.height as f64 / 2.0,
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [0.0, 0.0, 5.0],
        near: 0.01,
        far: 1e10,
        orthographic: false,
    }
}

pub fn design(choice: &DesignChoice) -> Result<Design> {
    let name = match choice {
        DesignChoice::Named(name) => (*name).to_owned(),
        DesignChoice::File(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    let facts = serde_json::json!({ "name": name, "mantissa_bits": bits(&name) });
    Ok(Design { name, facts, own_traversal: TraversalChoice::Spans })
}

fn bits(name: &str) -> u32 {
    name.trim_start_matches(|letter: char| !letter.is_ascii_digit()).parse().unwrap_or(16)
}

pub fn draw_reference(
    _engine: Engine,
    _scene: &Scene,
    camera: &Camera,
    _rules: &Rules,
    _compositing: Compositing,
    _threads: usize,
) -> Result<Drawing> {
    Ok(drawing(camera, |value| value, None))
}

#[allow(clippy::too_many_arguments, reason = "the contract of the kernel's host side")]
pub fn draw_fixed(
    _scene: &Scene,
    camera: &Camera,
    _rules: &Rules,
    _compositing: Compositing,
    design: &Design,
    traversal: TraversalChoice,
    _threads: usize,
) -> Result<Drawing> {
    let steps = f64::from(bits(&design.name)).exp2();
    let visited = if traversal == TraversalChoice::Box { 2000 } else { 1000 };
    Ok(drawing(camera, |value| (value * steps).floor() / steps, Some(Pixels { covered: 900, visited })))
}

fn drawing(camera: &Camera, round: impl Fn(f64) -> f64, pixels: Option<Pixels>) -> Drawing {
    let mut picture = Picture::new(camera.width, camera.height);
    for (index, pixel) in picture.pixels.iter_mut().enumerate() {
        let x = (index % camera.width) as f64 - camera.cx;
        let y = (index / camera.width) as f64 - camera.cy;
        let alpha = 0.9 * (-(x * x + y * y) / 200.0).exp();
        *pixel = [alpha, alpha * 0.5, alpha * 0.25, alpha].map(&round);
    }
    let stages = HostTimes { setup_s: 0.001, sort_s: 0.0005, raster_s: 0.002, ..HostTimes::default() };
    Drawing { picture, culled: [("near".to_owned(), 1)].into(), pixels, stages }
}

pub fn fixed_footprints(
    scene: &Scene,
    camera: &Camera,
    rules: &Rules,
    _design: &Design,
) -> Result<Vec<Option<FootprintLine>>> {
    float_footprints(scene, camera, rules)
}

pub fn float_footprints(_scene: &Scene, camera: &Camera, _rules: &Rules) -> Result<Vec<Option<FootprintLine>>> {
    let line = FootprintLine {
        centre: [camera.cx, camera.cy],
        depth: 5.0,
        conic: [0.01, -0.0, 1e-20],
        bounds: [-3, 0, 17, 12],
    };
    Ok(vec![Some(line), None])
}

pub fn write_picture(picture: &Picture, path: &Path, _depth: u8) -> Result<()> {
    Ok(atomic::write(path, &Rgb::on_black(picture).to_png()?)?)
}
