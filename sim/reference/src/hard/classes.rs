//! Scenes of the kinds that people have, made from a seed: domes, strays, close detail, far objects, world coordinates,
//! bright colours, faint stacks, and all hard shapes in one scene.
//!
//! Every number of a splat is one that single precision holds, in world coordinates, as a file would have it; cameras
//! are double precision.

use super::cases::rounded;
use super::splats;
use crate::camera::Camera;
use crate::rules::Rules;
use crate::scene::synthetic::{self, Random};
use crate::scene::{Scene, Splat};
use crate::vector;

/// How large a class is made.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Columns and rows of the picture.
    pub pixels: usize,
    /// One in how many splats is made.
    pub thinned: usize,
}

impl Size {
    /// What the page shows.
    pub const FULL: Size = Size {
        pixels: 512,
        thinned: 1,
    };
    /// What a test can wait for.
    pub const QUICK: Size = Size {
        pixels: 96,
        thinned: 20,
    };

    fn of(self, count: usize) -> usize {
        count.div_ceil(self.thinned)
    }
}

/// One class: a scene and from where it is seen.
#[derive(Clone, Debug)]
pub struct Class {
    /// What is hard about it.
    pub name: String,
    /// The splats.
    pub scene: Scene,
    /// From where.
    pub camera: Camera,
    /// Where the scene lies in the world, if far from its origin: single precision is measured with this subtracted as
    /// well.
    pub offset: Option<[f64; 3]>,
}

/// Every class; another `seed` makes other scenes of the same kinds.
pub fn all(size: Size, seed: u64) -> Vec<Class> {
    let mut classes = Vec::new();
    for radius in [1e3, 3e3, 1e4] {
        classes.push(dome(size, seed, radius));
    }
    for (far, name) in [(4_000, "world"), (20, "strays")] {
        for extent in [1e3, 1e5] {
            classes.push(detail(size, seed, extent, far, name));
        }
    }
    classes.push(telephoto(size, seed));
    classes.push(offset(size, seed, "1e5", 2.0, [1e5, 0.7e5, -0.4e5]));
    classes.push(offset(size, seed, "1e6", 20.0, [1e6, -0.6e6, 0.3e6]));
    classes.push(offset(size, seed, "UTM", 60.0, [4.5e5, 5.8e6, 3e2]));
    classes.push(bright(size, seed));
    classes.push(faint_stack(size, seed));
    classes.push(at_threshold(size, seed, "opacities at 1/255", 0));
    classes.push(at_threshold(
        size,
        seed,
        "opacities at 1/255, a quarter centred",
        4,
    ));
    classes.push(deep_stack(size, seed));
    classes.push(splats::mixed(size, seed));
    classes
}

/// An object of extent 2 under a sky of large discs.
fn dome(size: Size, seed: u64, radius: f64) -> Class {
    let mut random = Random(seed);
    let mut splats = object(&mut random, size.of(4_000), [0.0; 3], 2.0);
    splats.extend((0..size.of(1_500)).map(|_| {
        let up = direction(&mut random);
        let (across, along) = tangents(up);
        let wide = radius * random.between(0.03, 0.08);
        Splat {
            centre: vector::scale(radius, up),
            axes: [
                vector::scale(wide, across),
                vector::scale(wide, along),
                vector::scale(0.01 * wide, up),
            ],
            weight: random.between(0.3, 0.99),
            colour: random.triple(Random::uniform),
        }
    }));
    let camera = looking(size, [0.9, -0.8, -3.3], [0.0; 3], 50.0);
    class(&format!("dome at {radius:.0e}"), splats, camera)
}

/// Detail a twentieth of a unit before the eye, in front of a world, or of a few strays as far away.
fn detail(size: Size, seed: u64, extent: f64, far: usize, name: &str) -> Class {
    let mut random = Random(seed);
    let eye = [0.31, -0.17, 0.23];
    let camera = looking(size, eye, [1.0, 0.3, 2.0], 60.0);
    let [right, down, forward] = camera.rotation;
    let mut splats: Vec<Splat> = (0..size.of(3_000))
        .map(|_| {
            let z = random.between(0.04, 0.08);
            let [x, y] = [0, 1].map(|_| z * random.between(-0.55, 0.55));
            let local = vector::add(vector::scale(x, right), vector::scale(y, down));
            let centre = vector::add(eye, vector::add(local, vector::scale(z, forward)));
            gaussian(&mut random, centre, 0.000_7)
        })
        .collect();
    while splats.len() < size.of(3_000) + far.div_ceil(size.thinned.min(far / 20)) {
        let centre = random.triple(|random| random.between(-extent, extent));
        if vector::length(centre) > 0.1 * extent {
            splats.push(gaussian(&mut random, centre, 0.015 * extent));
        }
    }
    class(
        &format!("detail at 0.05, {name} of {extent:.0e}"),
        splats,
        camera,
    )
}

/// An object of extent 2 that fills the picture from 100,000 units away.
fn telephoto(size: Size, seed: u64) -> Class {
    let mut random = Random(seed);
    let splats = object(&mut random, size.of(4_000), [0.0; 3], 2.0);
    let direction = [0.48, -0.36, -0.8];
    let degrees = 2.0 * (1.3e-5f64).atan().to_degrees();
    let camera = looking(size, vector::scale(1e5, direction), [0.0; 3], degrees);
    class("telephoto, 1e5 away", splats, camera)
}

/// An object in world coordinates. What single precision holds out there is coarse: that is part of the scene.
fn offset(size: Size, seed: u64, name: &str, extent: f64, origin: [f64; 3]) -> Class {
    let mut random = Random(seed);
    let splats = object(&mut random, size.of(4_000), origin, extent);
    let eye = vector::add(origin, vector::scale(extent, [0.5531, -0.4127, -1.3913]));
    let mut made = class(
        &format!("world offset {name}"),
        splats,
        looking(size, eye, origin, 50.0),
    );
    made.offset = Some(origin);
    made
}

/// Colours up to 60.
fn bright(size: Size, seed: u64) -> Class {
    let mut random = Random(seed);
    let mut splats = object(&mut random, size.of(4_000), [0.0; 3], 2.0);
    for splat in &mut splats {
        splat.colour = random.triple(|random| 60.0 * 300f64.powf(-random.uniform()));
    }
    class("colours up to 60", splats, front(size))
}

/// 100,000 splats of opacities from 1 to 1.6 times the smallest that is drawn.
fn faint_stack(size: Size, seed: u64) -> Class {
    let mut random = Random(seed);
    let splats = (0..size.of(100_000))
        .map(|_| {
            let centre = random.triple(|random| random.between(-0.9, 0.9));
            Splat {
                weight: random.between(1.0, 1.6) / 255.0,
                ..gaussian(&mut random, centre, 0.15)
            }
        })
        .collect();
    class("stack at 1 to 1.6/255", splats, front(size))
}

/// Opacities of exactly 1/255 in single precision: what is drawn is decided by the last bit. One splat in `centred`, if
/// not 0, lies on a pixel's centre.
fn at_threshold(size: Size, seed: u64, name: &str, centred: usize) -> Class {
    let mut random = Random(seed);
    let depth = 4.0;
    let half = size.pixels as f64 / 2.0;
    let splats = (0..size.of(20_000))
        .map(|index| {
            let place = random.triple(|random| random.between(0.0, 2.0 * half));
            let is_centred = centred > 0 && index % centred == 0;
            let pixel = |at: f64| if is_centred { at.floor() + 0.5 } else { at };
            let [x, y] = [place[0], place[1]].map(|at| (pixel(at) - half) / 512.0 * depth);
            Splat {
                weight: 1.0 / 255.0,
                ..gaussian(&mut random, [x, y, depth], 0.3)
            }
        })
        .collect();
    // A power of two, and no rotation: the pixels' centres are met exactly.
    let camera = Camera::centred(size.pixels, size.pixels, 512.0);
    class(name, splats, camera)
}

/// 20,000 splats of opacities times 0.02.
fn deep_stack(size: Size, seed: u64) -> Class {
    let mut scene = synthetic::deep_stack(seed);
    scene.splats.truncate(size.of(scene.splats.len()));
    let camera = synthetic::camera(size.pixels, size.pixels);
    class("20,000 x 0.02", scene.splats, camera)
}

/// Ordinary Gaussians in a cube of side `extent`.
fn object(random: &mut Random, count: usize, middle: [f64; 3], extent: f64) -> Vec<Splat> {
    (0..count)
        .map(|_| {
            let within = random.triple(|random| 0.5 * extent * random.between(-1.0, 1.0));
            gaussian(random, vector::add(middle, within), 0.012 * extent)
        })
        .collect()
}

/// A Gaussian of median scale `scale`, any orientation, opacity and colour.
pub(super) fn gaussian(random: &mut Random, centre: [f64; 3], scale: f64) -> Splat {
    let scales = random.triple(|random| scale * (0.6 * random.normal()).exp());
    Splat {
        centre,
        axes: vector::scaled_columns(&random.rotation(), scales),
        weight: random.between(0.05, 0.95),
        colour: random.triple(Random::uniform),
    }
}

fn direction(random: &mut Random) -> [f64; 3] {
    let v = random.triple(Random::normal);
    vector::scale(1.0 / vector::length(v).max(1e-9), v)
}

/// Two unit vectors across `up` and across each other.
fn tangents(up: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let helper = if up[0].abs() < 0.7 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    let across = vector::cross(up, helper);
    let across = vector::scale(1.0 / vector::length(across), across);
    (across, vector::cross(up, across))
}

fn front(size: Size) -> Camera {
    looking(size, [0.7, -0.6, -3.0], [0.0; 3], 50.0)
}

fn looking(size: Size, eye: [f64; 3], target: [f64; 3], degrees: f64) -> Camera {
    let up = [0.0, -1.0, 0.0];
    match Camera::look_at(eye, target, up, degrees, size.pixels, size.pixels) {
        Ok(camera) => camera,
        Err(error) => unreachable!("the classes' own views are sound: {error}"),
    }
}

pub(super) fn class(name: &str, splats: Vec<Splat>, camera: Camera) -> Class {
    let splats = splats.into_iter().map(rounded).collect();
    Class {
        name: name.to_owned(),
        scene: Scene::of_splats(name, Rules::GAUSSIAN_3D, splats),
        camera,
        offset: None,
    }
}
