//! Every format that is read, and what is done with what was read, for the mutation suite and for the fuzz targets.
//!
//! Whoever adds a reader adds a line here, and both try it. A scene goes the whole way: it is loaded, framed by its
//! default camera, drawn at 16 x 16 by both engines and compared. A text is read, and what it describes is used as far
//! as that is quick.

use splatline_sim::camera::Camera;
use splatline_sim::cameras;
use splatline_sim::design::DesignChoice;
use splatline_sim::explore::identity::Identity;
use splatline_sim::explore::space::Space;
use splatline_sim::explore::table::ResultTable;
use splatline_sim::fixed::{self, Options};
use splatline_sim::framing::{FramingInput, USUAL_FOV};
use splatline_sim::machine::area::{Calibration, estimate};
use splatline_sim::machine::config::{self, Config};
use splatline_sim::machine::energy::EnergyTable;
use splatline_sim::machine::lanes::{LaneShape, LaneWork};
use splatline_sim::machine::parts::Parts;
use splatline_sim::machine::simulate;
use splatline_sim::machine::workload::{TableOptions, read_table};
use splatline_sim::metrics::compare;
use splatline_sim::reference;
use splatline_sim::scene::points::{self, SurfaceScene, height_field};
use splatline_sim::scene::{self, LoadOptions, Scene, Transfer, synthetic};
use splatline_sim::surface::Style;
use splatline_sim::{input, plan, vectors};
use std::path::Path;

/// Reads a file and uses it; the error is what the user would be told.
pub type Reader = fn(&Path) -> Result<(), String>;

/// Name of the file, for its extension, and its reader.
pub const FORMATS: &[(&str, Reader)] = &[
    ("gaussian.ply", scene_file),
    ("binary.ply", scene_file),
    ("scene.splat", scene_file),
    ("scene.spz", scene_file),
    ("streams.spz", scene_file),
    ("compressed.ply", scene_file),
    ("first.sog", scene_file),
    ("second.sog", scene_file),
    ("level0.ksplat", scene_file),
    ("level1.ksplat", scene_file),
    ("level2.ksplat", scene_file),
    ("tiny.glb", scene_file),
    ("tiny.gltf", gltf_file),
    ("raw.nrrd", scene_file),
    ("gzip.nrrd", scene_file),
    ("detached.nhdr", detached_file),
    ("volume.nii", scene_file),
    ("volume.nii.gz", scene_file),
    ("volume.mha", scene_file),
    ("packed.mha", scene_file),
    #[cfg(feature = "vti")]
    ("ascii.vti", scene_file),
    #[cfg(feature = "vti")]
    ("raw.vti", scene_file),
    ("cloud.ply", cloud_file),
    ("cloud.xyz", cloud_file),
    ("sphere.obj", cloud_file),
    ("old.las", cloud_file),
    ("new.las", cloud_file),
    #[cfg(feature = "laz")]
    ("old.laz", cloud_file),
    #[cfg(feature = "laz")]
    ("new.laz", cloud_file),
    ("grid.csv", height_field_file),
    ("camera.json", camera_file),
    ("images.txt", cameras_file),
    ("images.bin", cameras_file),
    ("cameras.txt", cameras_file),
    ("cameras.bin", cameras_file),
    ("transforms.json", cameras_file),
    ("cameras.json", cameras_file),
    ("path.toml", path_file),
    ("transfer.toml", transfer_file),
    ("design.toml", design_file),
    ("machine.toml", machine_file),
    ("prices.toml", prices_file),
    ("45nm.toml", energy_file),
    ("parts.toml", parts_file),
    ("space.toml", space_file),
    ("footprints.csv", footprints_file),
    ("sweep.json", sweep_file),
    ("manifest.json", manifest_file),
];

const SIDE: usize = 16;

fn printed(error: impl std::fmt::Display) -> String {
    format!("{error:#}")
}

fn text(path: &Path) -> Result<String, String> {
    input::text(path, input::SETTINGS).map_err(printed)
}

fn design() -> DesignChoice {
    DesignChoice::named("standard24").expect("a named design")
}

fn scene_file(path: &Path) -> Result<(), String> {
    let scene = scene::load(path, &LoadOptions::default()).map_err(printed)?;
    let camera = scene.default_camera(SIDE, SIDE);
    if camera.is_sound() {
        draw(&scene, &camera, &design())
    } else {
        Err("no camera can be placed".to_owned())
    }
}

/// With its buffer in a file beside it.
fn gltf_file(path: &Path) -> Result<(), String> {
    let buffer = path.with_file_name("tiny.bin");
    if !buffer.exists() {
        std::fs::write(&buffer, &super::seeds::apart()[1]).map_err(printed)?;
    }
    scene_file(path)
}

/// A header with its data in a file beside it.
fn detached_file(path: &Path) -> Result<(), String> {
    let data = path.with_file_name("data");
    if !data.exists() {
        let values: Vec<u8> = (0..60).map(|value| value * 4).collect();
        std::fs::write(&data, values).map_err(printed)?;
    }
    scene_file(path)
}

/// By both engines, whose pictures must be finite. Where one differs from the other is no question here.
fn draw(scene: &Scene, camera: &Camera, design: &DesignChoice) -> Result<(), String> {
    let options = Options::front_to_back(&scene.natural_rules, design);
    let fixed = fixed::draw(scene, camera, &options).picture;
    let float = reference::float::draw(scene, camera, options.rules, options.compositing).picture;
    compare(&fixed, &float).map(|_| ()).map_err(printed)
}

fn cloud_file(path: &Path) -> Result<(), String> {
    let scene = points::load(path).map_err(printed)?;
    draw_surface(&scene, false)
}

fn height_field_file(path: &Path) -> Result<(), String> {
    let field = height_field::HeightField::load(path, height_field::USUAL_SPACING);
    let scene = field.map_err(printed)?.scene("grid");
    draw_surface(&scene, true)
}

fn draw_surface(scene: &SurfaceScene, is_height_field: bool) -> Result<(), String> {
    let frame = FramingInput::of_surface(scene, is_height_field, None);
    let camera = &frame.camera(None, USUAL_FOV, SIDE, SIDE).map_err(printed)?;
    if !camera.is_sound() {
        return Err("no camera can be placed".to_owned());
    }
    let style = Style::opaque(scene.usual_threshold());
    let design = design();
    let fixed = fixed::surface::draw(scene, camera, &style, &design, design.traversal).picture;
    let float = reference::surface::draw(scene, camera, &style).picture;
    compare(&fixed, &float).map(|_| ()).map_err(printed)
}

/// As large as the file says; only setup runs, which takes no pixels.
fn camera_file(path: &Path) -> Result<(), String> {
    let (camera, _) = Camera::corrected_from_json_file(path).map_err(printed)?;
    let (scene, design) = (synthetic::random_gaussians(9, 1, 2.0), design());
    let options = Options::front_to_back(&scene.natural_rules, &design);
    fixed::footprints(&scene, &camera, &options);
    reference::float::footprints(&scene, &camera, options.rules);
    let small = camera.resized(SIDE, SIDE).map_err(printed)?;
    draw(&scene, &small, &design)
}

/// Cameras of other tools; a model of COLMAP is two files, of which the other one is sound.
fn cameras_file(path: &Path) -> Result<(), String> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if let Some(other) = super::seeds::beside(&name) {
        let file = path.with_file_name(other);
        if !file.exists() {
            std::fs::write(&file, super::seeds::seed(other)).map_err(printed)?;
        }
    }
    let poses = cameras::load(path, Some([SIDE, SIDE])).map_err(printed)?;
    let found = poses.into_iter().map(|pose| pose.camera);
    draw_frames(found)
}

fn path_file(path: &Path) -> Result<(), String> {
    let (path, _) = plan::path::load(path, Some([SIDE, SIDE])).map_err(printed)?;
    let frames = path.cameras([0.0, -1.0, 0.0], [SIDE, SIDE]);
    let frames = frames.map_err(printed)?;
    draw_frames(frames.into_iter().map(|(_, camera)| camera))
}

/// The first few: what is wrong with a file is seen in them.
fn draw_frames(cameras: impl Iterator<Item = Camera>) -> Result<(), String> {
    let (scene, design) = (synthetic::random_gaussians(9, 1, 2.0), design());
    for camera in cameras.take(3) {
        let small = camera.resized(SIDE, SIDE).map_err(printed)?;
        draw(&scene, &small, &design)?;
    }
    Ok(())
}

fn transfer_file(path: &Path) -> Result<(), String> {
    Transfer::from_toml(&text(path)?).map_err(printed)?;
    let options = LoadOptions {
        transfer: Some(path.to_owned()),
        light: None,
    };
    let volume = path.with_file_name("volume.nrrd");
    if !volume.exists() {
        std::fs::write(&volume, super::seeds::volume("raw")).map_err(printed)?;
    }
    let scene = scene::load(&volume, &options).map_err(printed)?;
    let camera = scene.default_camera(SIDE, SIDE);
    draw(&scene, &camera, &design())
}

fn design_file(path: &Path) -> Result<(), String> {
    let design = DesignChoice::load(&path.display().to_string()).map_err(printed)?;
    let scene = synthetic::random_gaussians(9, 1, 2.0);
    draw(&scene, &synthetic::camera(SIDE, SIDE), &design)
}

/// A workload small enough for any machine, and large enough that every unit has something to do.
fn footprints() -> String {
    let heading = "u,v,depth,conic_a,conic_b,conic_c,x0,y0,x1,y1\n";
    let line = |n: u32| format!("{n},4,{n},1,0,1,0,0,16,16\n");
    heading.to_owned() + &(0..6).map(line).collect::<String>()
}

fn time(config: &Config, table: &str) -> Result<(), String> {
    let options = TableOptions {
        viewport: [0, 0],
        tile: [config.tile_width, config.tile_height],
        traversal: splatline::format::Traversal::Spans,
        cutoff: Some(4.0),
        packet_bytes: 40,
    };
    let workload = read_table(table, &options).map_err(printed)?;
    let work = LaneWork::new(&workload, LaneShape::from(config));
    simulate(&workload, &work, config);
    Ok(())
}

fn machine_file(path: &Path) -> Result<(), String> {
    let config = config::from_file(path).map_err(printed)?;
    let again = config::from_toml("again", &config::to_toml(&config)).map_err(printed)?;
    assert_eq!(config, again, "what is written is read back");
    time(&config, &footprints())
}

fn prices_file(path: &Path) -> Result<(), String> {
    let prices = Calibration::from_toml("prices.toml", &text(path)?)?;
    let design = design();
    let area = estimate(
        &design.widths,
        design.traversal,
        &Config::default(),
        &prices,
    );
    assert!(area.weight.is_finite(), "an area of {}", area.weight);
    Ok(())
}

fn energy_file(path: &Path) -> Result<(), String> {
    EnergyTable::from_toml("45nm.toml", &text(path)?).map(|_| ())
}

fn parts_file(path: &Path) -> Result<(), String> {
    let parts = Parts::default().and("parts.toml", &text(path)?)?;
    let part = parts.find("xc7a35t")?;
    part.fabric();
    Ok(())
}

fn space_file(path: &Path) -> Result<(), String> {
    let space = Space::from_toml("space.toml", &text(path)?).map_err(printed)?;
    assert!(!space.points.is_empty(), "a space without points");
    for point in space.points.iter().take(99) {
        space.texts(point).for_each(drop);
    }
    Ok(())
}

fn footprints_file(path: &Path) -> Result<(), String> {
    time(&Config::default(), &text(path)?)
}

/// The identity and, behind its end, the table.
fn sweep_file(path: &Path) -> Result<(), String> {
    let text = text(path)?;
    let (identity, table) = text.split_once("\n}\n").unwrap_or((&text, ""));
    Identity::parse(&format!("{identity}\n}}\n")).map_err(printed)?;
    let space = Space::from_toml("space.toml", super::seeds::SWEPT).map_err(printed)?;
    ResultTable::from_csv(table)?.check(&space)
}

/// The manifest of vectors whose other files lie beside it.
fn manifest_file(path: &Path) -> Result<(), String> {
    let folder = path.parent().unwrap_or(Path::new("."));
    if !folder.join("splats.hex").exists() {
        let manifest = std::fs::read(path).map_err(printed)?;
        vectors::export(folder, &super::seeds::few_vectors([4, 4])).map_err(printed)?;
        std::fs::write(path, manifest).map_err(printed)?;
    }
    vectors::verify(folder).map(|_| ()).map_err(printed)
}
