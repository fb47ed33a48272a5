//! The scenes that pages measure, each seen by its camera (DESIGN.md 7): one name for each, on all pages.

use anyhow::{Context, Result};
use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::Options;
use splatline_sim::picture::Picture;
use splatline_sim::reference::float;
use splatline_sim::rules::{Compositing, Rules};
use splatline_sim::scene::points::{self, spheres};
use splatline_sim::scene::{LoadOptions, Scene, load};
use std::path::Path;

/// The volume that the demo draws.
pub const BRAIN: &str = "brainsmall";
/// The captured scene that pages show where one is enough.
pub const GUITAR: &str = "guitar";
/// The stack of 20,000 faint splats.
pub const DEEP_STACK: &str = "deep stack";
/// The scan that is drawn as spheres.
pub const LION: &str = "lion";

/// A scene, its camera and its rules.
#[derive(Clone, Debug)]
pub struct View {
    /// Name in tables.
    pub name: &'static str,
    pub scene: Scene,
    pub camera: Camera,
    pub rules: Rules,
}

/// Eye, target, direction up, vertical field of view in degrees.
type Pose = ([f64; 3], [f64; 3], [f64; 3], f64);

/// Name, file, and pose where it is not the scene's own.
type Place = (&'static str, &'static str, Option<Pose>);

const Y_DOWN: [f64; 3] = [0.0, -1.0, 0.0];
const FAR: Pose = ([5.5, -2.1, 0.2], [0.1, -2.1, 0.1], Y_DOWN, 50.0);
const CLOSE: Pose = ([2.2, -1.2, 0.5], [0.1, -1.2, 0.1], Y_DOWN, 50.0);
const ROBOT: Pose = ([2.2, -1.4, 2.2], [0.0, -0.45, 0.0], Y_DOWN, 45.0);
const STATUE: Pose = (
    [4.11, 3.88, -0.16],
    [-2.89, 3.88, -1.16],
    [0.0, 0.0, 1.0],
    45.0,
);

const PLACES: [Place; 7] = [
    (BRAIN, "demo", None),
    (GUITAR, "gaussians/guitar.ply", Some(FAR)),
    ("guitar close-up", "gaussians/guitar.ply", Some(CLOSE)),
    ("playbot", "gaussians/playbot_lod4.ply", Some(ROBOT)),
    (LION, "points/lion_takanawa.ply", Some(STATUE)),
    ("aneurism", "volumes/aneurism.nhdr", None),
    (DEEP_STACK, "deep-stack", None),
];

impl View {
    pub fn new(name: &'static str, scene: Scene, camera: Camera) -> View {
        let rules = scene.natural_rules;
        View {
            name,
            scene,
            camera,
            rules,
        }
    }

    /// The view of a name, its files below `data`, in pictures of `size` pixels a side.
    pub fn load(name: &str, data: &Path, size: usize) -> Result<View> {
        let (name, file, pose) = PLACES
            .into_iter()
            .find(|place| place.0 == name)
            .with_context(|| format!("no view is called '{name}'"))?;
        let path = if file.contains('/') {
            data.join(file)
        } else {
            file.into()
        };
        let scene = if name == LION {
            spheres::as_spheres(&points::load(&path)?, spheres::LION_DEVIATION)
        } else {
            load(&path, &LoadOptions::default())?
        };
        let camera = match pose {
            None => scene.default_camera(size, size),
            Some((eye, target, up, degrees)) => {
                Camera::look_at(eye, target, up, degrees, size, size)
                    .with_context(|| format!("the camera of {name}"))?
            }
        };
        let mut view = View::new(name, scene, camera);
        if name == LION {
            view.rules = spheres::RULES;
        }
        Ok(view)
    }

    /// How a design draws it.
    pub fn options<'a>(&'a self, design: &'a DesignChoice) -> Options<'a> {
        Options::front_to_back(&self.rules, design)
    }

    /// Its picture in double precision.
    pub fn reference(&self) -> Picture {
        float::draw(
            &self.scene,
            &self.camera,
            &self.rules,
            Compositing::FrontToBack,
        )
        .picture
    }
}
