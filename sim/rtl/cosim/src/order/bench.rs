//! Splats through sorter and binning, every place of the order and of every list compared.

use super::model::{OrderModel, OrderOutcome, OrderPicture};
use crate::workload::split_mix;
use anyhow::Result;

/// How memory and feeder behave.
#[derive(Clone, Copy, Debug)]
pub struct BenchTiming {
    /// Cycles from a request to its word, and from a word to its place.
    pub latency: u32,
    /// How many of 8 cycles the memory holds a request back.
    pub pauses: u32,
    /// Cycles from a splat to the next one at least.
    pub interval: u32,
}

/// At full speed, with pauses, and with words that arrive after all that a digit's sums take.
pub const MEMORIES: [BenchTiming; 3] = [
    BenchTiming {
        latency: 20,
        pauses: 0,
        interval: 8,
    },
    BenchTiming {
        latency: 7,
        pauses: 3,
        interval: 1,
    },
    BenchTiming {
        latency: 400,
        pauses: 0,
        interval: 1,
    },
];

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
    /// What it is.
    pub name: String,
    /// Columns and rows of tiles.
    pub size: [u16; 2],
    /// The splats.
    pub splats: Vec<SortedSplat>,
    /// The list of every tile, row by row.
    pub lists: Vec<Vec<u32>>,
}

/// What the circuit made of it.
#[derive(Clone, Copy, Debug)]
pub struct OrderFindings {
    /// Splats at another place of the order than the kernel's.
    pub out_of_order: usize,
    /// Entries that differ from the model's lists, or are missing, or too many.
    pub listed_wrong: usize,
    /// Cycles and words.
    pub outcome: OrderOutcome,
}

impl OrderFindings {
    /// Is everything as it should be?
    pub fn agree(&self) -> bool {
        self.out_of_order == 0
            && self.listed_wrong == 0
            && self.outcome.full == 0
            && self.outcome.beyond == 0
    }
}

impl SortedSplat {
    /// The word of the memory.
    pub fn word(&self) -> [u32; 4] {
        let [first, last] = self.tiles;
        let places = [first[0], first[1], last[0], last[1]];
        let places = places
            .iter()
            .rev()
            .fold(0u128, |word, place| word << 12 | u128::from(*place & 0xfff));
        let word = places << 80 | u128::from(self.number) << 48 | u128::from(self.key);
        [0, 32, 64, 96].map(|bit| (word >> bit) as u32)
    }
}

impl OrderLoad {
    /// A load whose lists follow from boxes and keys, tile by tile: slow and plain.
    pub fn plain(name: &str, size: [u16; 2], splats: Vec<SortedSplat>) -> OrderLoad {
        let mut load = OrderLoad {
            name: name.to_owned(),
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
}

/// Orders `load` by the circuit.
pub fn run(
    model: &OrderModel,
    load: &OrderLoad,
    timing: BenchTiming,
    seed: u32,
) -> Result<OrderFindings> {
    let entries: usize = load.lists.iter().map(Vec::len).sum();
    run_with_room(model, load, timing, seed, entries)
}

/// The same with room for so many entries.
pub fn run_with_room(
    model: &OrderModel,
    load: &OrderLoad,
    timing: BenchTiming,
    seed: u32,
    room: usize,
) -> Result<OrderFindings> {
    let count = load.splats.len();
    let picture = OrderPicture {
        bases: [3, 5 + count as u32],
        lists: 7 + 2 * count as u32,
        tile_columns: load.size[0].into(),
        tiles: u32::from(load.size[0]) * u32::from(load.size[1]),
        most: room as u32,
        latency: timing.latency,
        pauses: timing.pauses,
        interval: timing.interval,
        // Twice: what a picture leaves behind must not reach the next one.
        rounds: 2,
    };
    let size = picture.lists as usize + room.div_ceil(4);
    let mut state = seed.into();
    let mut memory: Vec<[u32; 4]> = (0..size)
        .map(|_| [(); 4].map(|()| split_mix(&mut state) as u32))
        .collect();
    let words: Vec<[u32; 4]> = load.splats.iter().map(SortedSplat::word).collect();
    let (outcome, ends) = model.run(seed, &picture, &words, &mut memory)?;
    let sorted = load.sorted();
    let order = memory.iter().skip(outcome.sorted as usize);
    let same = order
        .zip(&sorted)
        .filter(|(word, splat)| **word == splat.word());
    let listed: &[u32] = memory[picture.lists as usize..].as_flattened();
    let mut listed_wrong = 0;
    let mut begin = 0;
    for (list, end) in load.lists.iter().zip(&ends) {
        let end = *end as usize;
        match listed.get(begin..end) {
            Some(got) => {
                let different = got.iter().zip(list).filter(|(a, b)| a != b).count();
                listed_wrong += different + got.len().abs_diff(list.len());
            }
            None => listed_wrong += list.len().max(1),
        }
        begin = end;
    }
    Ok(OrderFindings {
        out_of_order: count - same.count() + (outcome.splats as usize).abs_diff(count),
        listed_wrong,
        outcome,
    })
}
