//! Ten kinds of hard Gaussians in one scene, after the independent data that the reference is held to
//! (`engines::golden`): there each kind has a picture of its own, here they share one, at depths from 0.01 to 67.

use super::classes::{Class, Size, class, gaussian};
use crate::camera::Camera;
use crate::engines::golden::rotated_axes;
use crate::scene::Splat;
use crate::scene::synthetic::Random;

/// Splats of each kind.
const OF_A_KIND: usize = 60;

/// All kinds, seen along z as the data has them.
pub(super) fn mixed(size: Size, seed: u64) -> Class {
    let mut random = Random(seed);
    let kinds: [fn(&mut Random, usize) -> Splat; 10] = [
        ordinary,
        tiny,
        huge,
        needle,
        near_plane,
        off_axis,
        edge_on,
        extreme_opacity,
        equal_depth,
        on_pixels,
    ];
    let count = OF_A_KIND.div_ceil(size.thinned.min(6));
    let splats = (0..count)
        .flat_map(|index| kinds.map(|kind| (kind, index)))
        .map(|(kind, index)| kind(&mut random, index))
        .collect();
    let camera = Camera::centred(size.pixels, size.pixels, size.pixels as f64 * 0.9375);
    class("ten hard kinds mixed", splats, camera)
}

/// A place inside the picture at a depth.
fn inside(random: &mut Random, z: f64) -> [f64; 3] {
    [
        z * random.between(-0.5, 0.5),
        z * random.between(-0.5, 0.5),
        z,
    ]
}

/// A number between two, uniform in its logarithm.
fn spread(random: &mut Random, low: f64, high: f64) -> f64 {
    low * (high / low).powf(random.uniform())
}

fn scaled(random: &mut Random, centre: [f64; 3], scales: [f64; 3]) -> Splat {
    let quaternion = [0; 4].map(|_| random.normal());
    Splat {
        axes: rotated_axes(quaternion, scales),
        ..gaussian(random, centre, 1.0)
    }
}

fn ordinary(random: &mut Random, _: usize) -> Splat {
    let z = random.between(1.0, 10.0);
    let centre = inside(random, z);
    gaussian(random, centre, 0.02 * z)
}

fn tiny(random: &mut Random, _: usize) -> Splat {
    let z = random.between(5.0, 67.0);
    let centre = inside(random, z);
    let scales = random.triple(|random| spread(random, 1e-4, 0.05));
    scaled(random, centre, scales)
}

fn huge(random: &mut Random, _: usize) -> Splat {
    let z = random.between(2.0, 12.0);
    let centre = inside(random, z).map(|x| 1.5 * x);
    let scales = random.triple(|random| spread(random, 3.0, 500.0));
    scaled(random, [centre[0], centre[1], z], scales)
}

fn needle(random: &mut Random, _: usize) -> Splat {
    let z = random.between(2.0, 12.0);
    let centre = inside(random, z);
    let long = spread(random, 0.3, 30.0);
    let thin = long / spread(random, 30.0, 1e4);
    scaled(random, centre, [long, thin, thin])
}

fn near_plane(random: &mut Random, index: usize) -> Splat {
    let z = 0.01 + [1e-6, 1e-4, 1e-3, 1e-2][index % 4];
    let centre = inside(random, z);
    let scales = random.triple(|random| spread(random, 1e-3, 0.04));
    scaled(random, centre, scales)
}

fn off_axis(random: &mut Random, _: usize) -> Splat {
    let z = random.between(0.5, 3.0);
    let [x, y, _] = random.triple(|random| random.between(-15.0, 15.0));
    let scales = random.triple(|random| spread(random, 0.03, 3.0));
    scaled(random, [z * x, z * y, z], scales)
}

fn edge_on(random: &mut Random, _: usize) -> Splat {
    let z = random.between(2.0, 8.0);
    let centre = inside(random, z);
    let quaternion = [0.5f64.sqrt(), random.normal(), random.normal(), 0.0];
    let scales = [
        spread(random, 0.1, 1.0),
        spread(random, 0.3, 2.0),
        spread(random, 1e-5, 1e-4),
    ];
    Splat {
        axes: rotated_axes(quaternion, scales),
        ..gaussian(random, centre, 1.0)
    }
}

fn extreme_opacity(random: &mut Random, index: usize) -> Splat {
    let centre = inside(random, 2.0);
    let weight = [1.0 / 255.0, 1.01 / 255.0, 0.999, 1.0][index % 4];
    Splat {
        weight,
        ..scaled(random, centre, [0.083; 3])
    }
}

fn equal_depth(random: &mut Random, _: usize) -> Splat {
    let centre = inside(random, 3.0);
    gaussian(random, centre, 0.15)
}

fn on_pixels(random: &mut Random, _: usize) -> Splat {
    let [x, y, z] = inside(random, 4.0);
    let centre = [(x * 16.0).round() / 16.0, (y * 16.0).round() / 16.0, z];
    scaled(random, centre, [0.08; 3])
}
