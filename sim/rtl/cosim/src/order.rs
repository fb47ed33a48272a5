//! Sorter and binning (`sim/rtl/splat_order.sv`) against the kernel's order and the model's lists: captured scenes, and
//! keys that a sorter finds hard, through a memory; every place of the order and of every list.

use crate::bench::Bench;
use crate::memory::{Memory, MemoryTiming, noise, timing};
use crate::package::TILE;
use crate::scenes::{SCENES, Seen, scenes};
use crate::simulation::Simulation;
use crate::unit::{Circuit, Extent, Findings, Load, Loads, Missing};
use anyhow::{Result, bail, ensure};
use splatline::footprint::Footprint;
use splatline::footprint::depth::KEY_BITS;
use splatline::setup::Cull;
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{self, Options};
use splatline_sim::machine::workload::{Workload, extract_from};
use splatline_sim::rules::Rules;
use splatline_sim::scene::synthetic::Random;

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
        let places = self.tiles.as_flattened().iter().rev();
        let places = places.fold(0u128, |word, place| word << 12 | u128::from(*place & 0xfff));
        let word = places << 80 | u128::from(self.number) << 48 | u128::from(self.key);
        [0, 32, 64, 96].map(|bit| (word >> bit) as u32)
    }
}

impl OrderLoad {
    /// A load whose lists follow from boxes and keys, splat by splat: slow and plain.
    fn plain(size: [u16; 2], splats: Vec<SortedSplat>) -> OrderLoad {
        let [columns, rows] = size.map(usize::from);
        let mut load = OrderLoad {
            size,
            splats,
            lists: vec![Vec::new(); columns * rows],
        };
        for splat in load.sorted() {
            let [first, last] = splat.tiles.map(|place| place.map(usize::from));
            for row in first[1]..=last[1] {
                let lists = &mut load.lists[row * columns..][first[0]..=last[0]];
                lists.iter_mut().for_each(|list| list.push(splat.number));
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

/// What becomes of each splat under these rules, the picture's work in tiles of the circuit's size, and its splats with
/// the model's lists.
pub fn ordered(
    seen: &Seen,
    design: &DesignChoice,
    rules: &Rules,
) -> (Vec<Result<Footprint, Cull>>, Workload, OrderLoad) {
    let options = Options::front_to_back(rules, design);
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

/// The last key.
const LAST: u64 = (1 << KEY_BITS) - 1;

/// A key by its place among those of a load.
type Key = fn(u64, &mut Random) -> u64;

/// No splat, one, all keys equal, all keys but one, upside down, in order already, single bits, and random ones with
/// many equals: how many keys there are, and each of them.
const HARD: [(&str, u64, Key); 10] = [
    ("none", 0, |_, _| 0),
    ("one", 1, |_, _| LAST),
    ("equal keys", 300, |_, _| 0x1234_5678_9abc),
    ("all keys but one", 300, |i, _| u64::from(i != 299) << 20),
    ("reversed", 600, |i, _| LAST - i * 7),
    ("sorted", 600, |i, _| i << 30),
    ("single bits", 48, |i, _| 1 << (47 - i)),
    ("first digit alone", 99, |i, _| i % 3),
    ("few keys", 900, |_, random| (random.next() % 5) << 37),
    ("random keys", 900, |_, random| random.next() & LAST),
];

/// Splats with the keys of `HARD`.
pub fn hard() -> Loads<OrderLoad> {
    let mut random = Random(3);
    let mut keys_of = |count, key: Key| (0..count).map(|i| key(i, &mut random)).collect::<Vec<_>>();
    let all = HARD.map(|(name, count, key)| (name, keys_of(count, key)));
    let mut loads = Vec::new();
    for (name, keys) in all {
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

/// A memory, and cycles from a splat to the next one at least: at full speed; with pauses; with words that arrive after
/// all that a digit's sums take; and lists without room.
const TIMINGS: [(MemoryTiming, u64); 4] = [
    (timing([20, 0], 16, false), 8),
    (timing([7, 3], 16, false), 1),
    (timing([400, 0], 16, false), 1),
    (timing([20, 0], 16, true), 8),
];

/// Cycles without an access to the memory after which the circuit hangs.
const PATIENCE: u64 = 1 << 17;

impl Load for OrderLoad {
    const WAYS: usize = TIMINGS.len();

    fn all(circuit: &Circuit, extent: Extent, missing: &mut Missing) -> Result<Loads<OrderLoad>> {
        let (names, size) = extent.of((&["playbot"][..], 128), (&SCENES, 512));
        let mut loads = hard();
        for seen in scenes(names, size, missing)? {
            let (.., load) = ordered(&seen, &circuit.design, &seen.scene.natural_rules);
            loads.push((seen.name.to_owned(), load));
        }
        Ok(loads)
    }

    fn compare(&self, _: &Circuit, mut bench: Bench, pressure: usize) -> Result<Findings> {
        let (timing, interval) = TIMINGS[pressure];
        if timing.full && self.entries() == 0 {
            return Ok(Findings::default());
        }
        let room = self.entries() - usize::from(timing.full);
        let count = self.splats.len();
        let lists = 7 + 2 * count;
        bench.set(&[
            ("base_a", 3),
            ("base_b", 5 + count as u64),
            ("base_lists", lists as u64),
            ("tile_columns", self.size[0].into()),
            ("tiles", self.lists.len() as u64),
            ("most", room as u64),
        ]);
        // Bits of nothing in all places of the memory, a word or more between any two regions.
        let (mut words, mut random) = (Vec::new(), Random(1));
        words.resize_with(lists + room.div_ceil(4), || noise(&mut random));
        let mut memory = Memory::new(&bench.circuit, words, timing);
        let mut findings = Findings::default();
        // Twice or once: neither what a picture leaves behind nor what registers hold before the first must reach the
        // one that is judged.
        for _ in 0..2 - pressure % 2 {
            findings.cycles = order(&mut bench.circuit, &mut memory, self, interval)?;
        }
        findings.compared = count as u64;
        findings.counts = vec![
            ("entries", bench.circuit.read("entries")),
            ("words read", memory.read),
            ("words written", memory.written),
        ];
        let mut ends = Vec::new();
        for tile in 0..self.lists.len() {
            bench.set(&[("end_tile", tile as u64)]);
            memory.cycle(&mut bench.circuit);
            memory.cycle(&mut bench.circuit);
            ends.push(bench.circuit.read("end_place") as usize);
        }
        let full = bench.circuit.read("full") == 1;
        findings.first_difference = memory.astray(full);
        if findings.first_difference.is_none() && !full {
            let splats = bench.circuit.read("splats");
            let sorted = memory.words.get(bench.circuit.read("sorted") as usize..);
            let lists = memory.words[lists..].as_flattened();
            let order = order_difference(self, splats, sorted.unwrap_or_default());
            findings.first_difference = order.or_else(|| list_difference(self, lists, &ends));
        }
        Ok(findings)
    }
}

/// Orders a picture; gives the cycles until its lists are written.
fn order(
    circuit: &mut Simulation,
    memory: &mut Memory,
    load: &OrderLoad,
    interval: u64,
) -> Result<u64> {
    let [begins, ends, done] = circuit.ports(["begins", "ends", "done"]);
    let [valid, ready, word] = circuit.ports(["in_valid", "in_ready", "in"]);
    circuit.set(ends, 0);
    circuit.set(begins, 1);
    memory.cycle(circuit);
    circuit.set(begins, 0);
    let splats = &load.splats;
    // A circuit that goes on reading and writing hangs as well.
    let limit = PATIENCE + 200 * splats.len() as u64 + 16 * load.entries() as u64;
    let (mut sent, mut next) = (0, 0);
    for cycle in 0..limit {
        let offered = splats.get(sent).filter(|_| cycle >= next);
        circuit.set(valid, offered.is_some().into());
        circuit.set(ends, (sent == splats.len()).into());
        if let Some(splat) = offered {
            circuit.set_words(word, &splat.word());
        }
        memory.settle(circuit);
        if offered.is_some() && circuit.is(ready) {
            (sent, next) = (sent + 1, cycle + interval);
        }
        let ended = circuit.is(done);
        memory.edge(circuit);
        if ended {
            return Ok(cycle + 1);
        }
        ensure!(memory.idle < PATIENCE, "the sorter hangs");
    }
    bail!("the sorter hangs")
}

fn order_difference(load: &OrderLoad, splats: u64, sorted: &[[u32; 4]]) -> Option<String> {
    let wanted = load.sorted();
    if splats != wanted.len() as u64 {
        return Some(format!("{splats} splats, not {}", wanted.len()));
    }
    let mut wanted = wanted.iter().enumerate();
    let (place, _) = wanted.find(|(place, splat)| sorted.get(*place) != Some(&splat.word()))?;
    Some(format!("another splat at place {place} of the order"))
}

fn list_difference(load: &OrderLoad, listed: &[u32], ends: &[usize]) -> Option<String> {
    let mut begin = 0;
    for (tile, (list, end)) in load.lists.iter().zip(ends).enumerate() {
        if listed.get(begin..*end) != Some(list) {
            return Some(format!("another list of tile {tile}"));
        }
        begin = *end;
    }
    None
}
