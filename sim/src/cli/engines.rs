//! The one place where the commands meet the scene loaders and the engines.
//!
//! Every function here states the call it stands for. Until the engines are joined, each returns an error that says
//! so; the commands' tests run against `synthetic_engines.rs`, which has the same functions.

use super::args::{DesignChoice, Engine, Size, TraversalChoice};
use super::drawing::{Design, Drawing, FootprintLine};
use anyhow::{Result, bail};
use splatline_sim::camera::Camera;
use splatline_sim::picture::Picture;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::Scene;
use std::path::Path;

/// `scene::load(path, &LoadOptions { transfer, light, .. })`
pub fn load_scene(path: &Path, _transfer: Option<&Path>, _light: Option<[f64; 3]>) -> Result<Scene> {
    bail!("cannot load '{}': the scene loaders are not part of this build", path.display())
}

/// `scene::demo()`
pub fn demo_scene() -> Result<Scene> {
    bail!("cannot load the demo: the scene loaders are not part of this build")
}

/// `scene.default_camera(width, height)`
pub fn default_camera(_scene: &Scene, _size: Size) -> Result<Camera> {
    bail!("cannot place a camera: the camera functions are not part of this build")
}

/// `Camera::from_json_file(path)`
pub fn camera_from_file(path: &Path) -> Result<Camera> {
    bail!("cannot read the camera '{}': the camera functions are not part of this build", path.display())
}

/// `Camera::look_at(eye, target, up, vertical_fov_degrees, width, height)`; an error is one of usage.
pub fn camera_looking_at(
    _eye: [f64; 3],
    _target: [f64; 3],
    _up: [f64; 3],
    _vertical_fov_degrees: f64,
    _size: Size,
) -> Result<Camera> {
    bail!("cannot place a camera: the camera functions are not part of this build")
}

/// `camera.resized(width, height)`
pub fn resized_camera(_camera: &Camera, _size: Size) -> Result<Camera> {
    bail!("cannot resize a camera: the camera functions are not part of this build")
}

/// A named design of the kernel or `Design::from_toml(path)`, with its resolved fields as JSON.
pub fn design(choice: &DesignChoice) -> Result<Design> {
    match choice {
        DesignChoice::Named(name) => bail!("cannot use design '{name}': the kernel is not part of this build"),
        DesignChoice::File(path) => bail!("cannot read design '{}': the kernel is not part of this build", path.display()),
    }
}

/// `reference::float::draw` or `reference::exact::draw`, with its counts as `culled`.
pub fn draw_reference(
    engine: Engine,
    _scene: &Scene,
    _camera: &Camera,
    _rules: &Rules,
    _compositing: Compositing,
    _threads: usize,
) -> Result<Drawing> {
    bail!("cannot draw with engine '{}': it is not part of this build", engine.name())
}

/// `fixed::draw(scene, camera, rules, compositing, design, traversal, threads)`
#[allow(clippy::too_many_arguments, reason = "the contract of the kernel's host side")]
pub fn draw_fixed(
    _scene: &Scene,
    _camera: &Camera,
    _rules: &Rules,
    _compositing: Compositing,
    design: &Design,
    _traversal: TraversalChoice,
    _threads: usize,
) -> Result<Drawing> {
    bail!("cannot draw with design '{}': the kernel is not part of this build", design.name)
}

/// Footprints in splat order, nothing for culled splats, by the kernel's set-up.
pub fn fixed_footprints(
    _scene: &Scene,
    _camera: &Camera,
    _rules: &Rules,
    design: &Design,
) -> Result<Vec<Option<FootprintLine>>> {
    bail!("cannot compute footprints with design '{}': the kernel is not part of this build", design.name)
}

/// `reference::float::footprints(scene, camera, rules)`
pub fn float_footprints(_scene: &Scene, _camera: &Camera, _rules: &Rules) -> Result<Vec<Option<FootprintLine>>> {
    bail!("cannot compute footprints: the float engine is not part of this build")
}

/// `picture.write_png(path, depth)`; the error names the file.
pub fn write_picture(_picture: &Picture, path: &Path, _depth: u8) -> Result<()> {
    bail!("cannot write '{}': picture files are not part of this build", path.display())
}
