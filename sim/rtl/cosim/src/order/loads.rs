//! What is ordered: captured scenes with the model's lists, and keys that a sorter finds hard.

use crate::package::TILE;
use crate::random::Random;
use crate::scenes::Seen;
use crate::unit::Loads;
use splatline::footprint::Footprint;
use splatline::footprint::depth::KEY_BITS;
use splatline::format::Traversal;
use splatline::setup::Cull;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{self, Options};
use splatline_sim::machine::workload::{Workload, extract_from};
use splatline_sim::rules::{Compositing, Rules};

/// A visible splat as the sorter takes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SortedSplat {
    /// Its number in the scene.
    pub number: u32,
    /// The key of its depth.
    pub key: u64,
    /// First and last tile of its box, each a column and a row.
    pub tiles: [[u16; 2]; 2],
}

/// A picture's splats in the order of the scene, and what is to come of them.
#[derive(Clone, Debug)]
pub struct OrderLoad {
    /// Columns and rows of tiles.
    pub size: [u16; 2],
    /// The splats.
    pub splats: Vec<SortedSplat>,
    /// The list of every tile, row by row.
    pub lists: Vec<Vec<u32>>,
}

impl SortedSplat {
    /// The word of the memory.
    pub fn word(&self) -> [u32; 4] {
        let [first, last] = self.tiles;
        let places = [first[0], first[1], last[0], last[1]];
        let places = places.iter().rev();
        let places = places.fold(0u128, |word, place| word << 12 | u128::from(*place & 0xfff));
        let word = places << 80 | u128::from(self.number) << 48 | u128::from(self.key);
        [0, 32, 64, 96].map(|bit| (word >> bit) as u32)
    }
}

impl OrderLoad {
    /// A load whose lists follow from boxes and keys, tile by tile: slow and plain.
    fn plain(size: [u16; 2], splats: Vec<SortedSplat>) -> OrderLoad {
        let mut load = OrderLoad {
            size,
            splats,
            lists: Vec::new(),
        };
        let sorted = load.sorted();
        for row in 0..size[1] {
            for column in 0..size[0] {
                let meets = |splat: &&SortedSplat| {
                    let [first, last] = splat.tiles;
                    (first[0]..=last[0]).contains(&column) && (first[1]..=last[1]).contains(&row)
                };
                let list = sorted.iter().filter(meets).map(|splat| splat.number);
                load.lists.push(list.collect());
            }
        }
        load
    }

    /// Nearest first; equal keys by number.
    pub fn sorted(&self) -> Vec<SortedSplat> {
        let mut sorted = self.splats.clone();
        sorted.sort_by_key(|splat| (splat.key, splat.number));
        sorted
    }

    /// Entries of all lists.
    pub fn entries(&self) -> usize {
        self.lists.iter().map(Vec::len).sum()
    }
}

/// What becomes of each splat under these rules, the picture's work in tiles of the circuit's size, and its splats with the model's lists.
pub fn ordered(
    seen: &Seen,
    design: &DesignChoice,
    rules: &Rules,
) -> (Vec<Result<Footprint, Cull>>, Workload, OrderLoad) {
    let options = Options {
        rules,
        compositing: Compositing::FrontToBack,
        design,
        traversal: Traversal::Spans,
    };
    let footprints = fixed::footprints(&seen.scene, &seen.camera, &options);
    let workload = extract_from(&footprints, &seen.camera, &options, TILE);
    let size = [seen.camera.width, seen.camera.height];
    let size = [0, 1].map(|axis| (size[axis] as u16).div_ceil(TILE[axis]));
    let splat = |(number, footprint): (u32, &Result<Footprint, Cull>)| {
        let footprint = footprint.as_ref().ok()?;
        let first = [0, 1].map(|axis| footprint.first[axis] / TILE[axis]);
        let last = [0, 1].map(|axis| (footprint.end[axis] - 1) / TILE[axis]);
        Some(SortedSplat {
            number,
            key: footprint.depth,
            tiles: [first, last],
        })
    };
    let list = |tile| workload.pairs_of(tile).iter().map(|pair| pair.splat);
    let lists = (0..workload.tiles.len()).map(|tile| list(tile).collect());
    let load = OrderLoad {
        size,
        splats: (0..).zip(&footprints).filter_map(splat).collect(),
        lists: lists.collect(),
    };
    (footprints, workload, load)
}

/// No splat, one, all keys equal, all keys but one, upside down, in order already, single bits, and random ones with many equals.
pub fn hard() -> Loads<OrderLoad> {
    let last = (1u64 << KEY_BITS) - 1;
    let mut random = Random(3);
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
            (0..900).map(|_| (random.next() % 5) << 37).collect(),
        ),
        (
            "random keys",
            (0..900).map(|_| random.next() & last).collect(),
        ),
    ];
    for (name, keys) in keys {
        let size = [9, 7].map(|end| 1 + (random.next() % end) as u16);
        let splats = (0..).zip(keys).map(|(index, key)| SortedSplat {
            // Numbers have gaps where splats were culled.
            number: 3 * index,
            key,
            tiles: tiles(&mut random, size),
        });
        loads.push((name.to_owned(), OrderLoad::plain(size, splats.collect())));
    }
    loads
}

/// A box of tiles, in some cases all.
fn tiles(random: &mut Random, size: [u16; 2]) -> [[u16; 2]; 2] {
    let mut below = |end: u16| (random.next() % u64::from(end)) as u16;
    if below(16) == 0 {
        return [[0, 0], [size[0] - 1, size[1] - 1]];
    }
    let first = [below(size[0]), below(size[1])];
    let last = [0, 1].map(|axis| first[axis] + below(size[axis] - first[axis]).min(2));
    [first, last]
}
