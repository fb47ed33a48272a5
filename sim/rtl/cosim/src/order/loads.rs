//! What is ordered: captured scenes with the model's lists, and keys that a sorter finds hard.

use super::bench::{OrderLoad, SortedSplat};
use crate::setup::loads::{lion, playbot};
use crate::workload::{GuitarView, TILE, guitar_scene, shared, split_mix};
use anyhow::Result;
use splatline::footprint::depth::KEY_BITS;
use splatline::format::Traversal;
use splatline_sim::camera::Camera;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{self, Options};
use splatline_sim::machine::workload::{Workload, extract_from};
use splatline_sim::rules::Compositing;
use splatline_sim::scene::{self, Scene, synthetic};

/// A scene, seen.
pub struct Seen {
    /// Its name.
    pub name: &'static str,
    /// The scene.
    pub scene: Scene,
    /// The camera.
    pub camera: Camera,
}

/// The scenes that ways of sorting and whole frames are measured on.
pub const SCENES: [&str; 5] = ["guitar", "playbot", "lion", "aneurism", "deep stack"];

/// The named of [`SCENES`] in square pictures of so many pixels a side, and the names of those whose data is not at hand.
pub fn scenes(names: &[&'static str], size: usize) -> Result<(Vec<Seen>, Vec<&'static str>)> {
    let mut seen = Vec::new();
    let mut missing = Vec::new();
    for name in names {
        let found = match *name {
            "guitar" => guitar_scene(GuitarView::Close, size)?,
            "playbot" => playbot()?,
            "lion" => lion()?,
            "aneurism" => aneurism(size)?,
            _ => Some(deep_stack(size)),
        };
        match found {
            Some((scene, camera)) => seen.push(Seen {
                name,
                scene,
                camera: resized(camera, size),
            }),
            None => missing.push(*name),
        }
    }
    Ok((seen, missing))
}

/// The same view in a square picture of another size.
fn resized(camera: Camera, size: usize) -> Camera {
    let scale = size as f64 / camera.height as f64;
    let shift = (camera.width as f64 * scale - size as f64) / 2.0;
    Camera {
        fx: camera.fx * scale,
        fy: camera.fy * scale,
        cx: camera.cx * scale - shift,
        cy: camera.cy * scale,
        width: size,
        height: size,
        ..camera
    }
}

fn aneurism(size: usize) -> Result<Option<(Scene, Camera)>> {
    let Some(file) = shared("volumes/aneurism.nhdr") else {
        return Ok(None);
    };
    let scene = scene::load(&file, &Default::default())?;
    let camera = scene.default_camera(size, size);
    Ok(Some((scene, camera)))
}

fn deep_stack(size: usize) -> (Scene, Camera) {
    let scene = synthetic::deep_stack(1);
    let camera = scene.default_camera(size, size);
    (scene, camera)
}

/// The work of a scene's picture in tiles of the circuit's size, and its splats with the model's lists.
pub fn ordered(seen: &Seen, design: &DesignChoice) -> (Workload, OrderLoad) {
    let options = Options {
        rules: &seen.scene.natural_rules,
        compositing: Compositing::FrontToBack,
        design,
        traversal: Traversal::Spans,
    };
    let footprints = fixed::footprints(&seen.scene, &seen.camera, &options);
    let workload = extract_from(&footprints, &seen.camera, &options, TILE);
    let size = [seen.camera.width, seen.camera.height];
    let size = [0, 1].map(|axis| (size[axis] as u16).div_ceil(TILE[axis]));
    let numbered = (0..).zip(&footprints);
    let splat = |(number, footprint): (u32, &Result<_, _>)| {
        let footprint: &splatline::footprint::Footprint = footprint.as_ref().ok()?;
        let tiles = [0, 1].map(|axis| footprint.first[axis] / TILE[axis]);
        let last = [0, 1].map(|axis| (footprint.end[axis] - 1) / TILE[axis]);
        Some(SortedSplat {
            number,
            key: footprint.depth,
            tiles: [tiles, last],
        })
    };
    let list = |tile| workload.pairs_of(tile).iter().map(|pair| pair.splat);
    let load = OrderLoad {
        name: seen.name.to_owned(),
        size,
        splats: numbered.filter_map(splat).collect(),
        lists: (0..workload.tiles.len())
            .map(|tile| list(tile).collect())
            .collect(),
    };
    (workload, load)
}

/// No splat, one, all keys equal, all keys but one, upside down, in order already, single bits, and random ones with many equals.
pub fn hard() -> Vec<OrderLoad> {
    let last = (1u64 << KEY_BITS) - 1;
    let mut state = 3;
    let mut loads = Vec::new();
    let keys: [(&str, Vec<u64>); 10] = [
        ("none", vec![]),
        ("one", vec![last]),
        ("equal keys", vec![0x1234_5678_9abc; 300]),
        (
            "all keys but one",
            (0..300).map(|i| u64::from(i != 299) << 20).collect(),
        ),
        ("reversed", (0..600u64).map(|i| last - i * 7).collect()),
        ("sorted", (0..600u64).map(|i| i << 30).collect()),
        ("single bits", (0..48u64).rev().map(|i| 1 << i).collect()),
        ("first digit alone", (0..99u64).map(|i| i % 3).collect()),
        (
            "few keys",
            (0..900)
                .map(|_| (split_mix(&mut state) % 5) << 37)
                .collect(),
        ),
        (
            "random keys",
            (0..900).map(|_| split_mix(&mut state) & last).collect(),
        ),
    ];
    for (name, keys) in keys {
        let size = [
            1 + (split_mix(&mut state) % 9) as u16,
            1 + (split_mix(&mut state) % 7) as u16,
        ];
        let splats = (0..).zip(keys).map(|(index, key)| SortedSplat {
            // Numbers have gaps where splats were culled.
            number: 3 * index,
            key,
            tiles: tiles(&mut state, size),
        });
        loads.push(OrderLoad::plain(name, size, splats.collect()));
    }
    loads
}

/// A box of tiles, in some cases all.
fn tiles(state: &mut u64, size: [u16; 2]) -> [[u16; 2]; 2] {
    let mut below = |end: u16| (split_mix(state) % u64::from(end)) as u16;
    if below(16) == 0 {
        return [[0, 0], [size[0] - 1, size[1] - 1]];
    }
    let first = [below(size[0]), below(size[1])];
    let last = [0, 1].map(|axis| first[axis] + below(size[axis] - first[axis]).min(2));
    [first, last]
}
