//! Depth order per tile: splats are binned by counting, then each tile's list is sorted by itself.
//!
//! Sorting the tiles apart costs a little more work than one sort of all splats, because a splat on a tile's edge is
//! sorted twice; but every list fits the cache and all of it runs on all cores. A list's entry is (depth, index), so no
//! two are equal, and order is by depth, ties by index, whatever sorts it.
//!
//! A footprint's sort key has 48 bits. An entry holds its difference to the nearest splat's key above the index, in as
//! many bits as the indices leave, which is all of it but for scenes of extreme depth and count. The radix sort looks
//! at the 16 leading ones; the few entries that are equal there and out of order are sorted once more.

use rayon::prelude::*;
use splatline::raster::Window;

/// What ordering needs to know of a splat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    /// Smaller is nearer: the footprint's sort key.
    pub depth: u64,
    /// Its number in the scene.
    pub index: u32,
    /// Pixels that it may touch; not empty.
    pub bounds: Window,
}

/// Splats set up at once: their footprints fit the second-level cache.
const BATCH: usize = 1024;

/// Parts of the scene per thread: enough that none waits long for the last one.
const PARTS: usize = 4;

/// Splats of each part of a scene of so many.
pub fn part_length(splats: usize) -> usize {
    let parts = PARTS * rayon::current_num_threads();
    splats.div_ceil(parts).max(BATCH)
}

/// Sets up some splats into their outcomes, lists the keys of those that are drawn, numbered from the index, and counts
/// the others.
pub type SetUpBatch<'a, S, O, F> = dyn Fn(&[S], &mut [O], usize, &mut Vec<Key>) -> F + Sync + 'a;

/// How the screen is divided into tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    viewport: [u16; 2],
    tile: [u16; 2],
    /// 2^32 over the tile's columns and rows, and a bit more: a product in the place of a division, exact for 16 bits.
    inverse: [u64; 2],
    columns: usize,
    rows: usize,
}

impl Grid {
    /// Tiles of at most `tile` pixels over a viewport.
    pub fn new(viewport: [u16; 2], tile: [u16; 2]) -> Self {
        let count = |axis: usize| usize::from(viewport[axis].div_ceil(tile[axis]));
        Grid {
            viewport,
            tile,
            inverse: tile.map(|size| (1 << 32) / u64::from(size) + 1),
            columns: count(0),
            rows: count(1),
        }
    }

    /// Number of tiles.
    pub fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Columns and rows of the screen.
    pub fn viewport(&self) -> [u16; 2] {
        self.viewport
    }

    /// Each tile's part of every row of a frame, so that tiles can be written side by side.
    pub fn split<'a, T>(&self, frame: &'a mut [T]) -> Vec<Vec<&'a mut [T]>> {
        let mut tiles: Vec<Vec<&mut [T]>> = Vec::new();
        tiles.resize_with(self.len(), || Vec::with_capacity(self.tile[1].into()));
        let width = usize::from(self.viewport[0]).max(1);
        for (y, row) in frame.chunks_mut(width).enumerate() {
            let first = y / usize::from(self.tile[1]) * self.columns;
            let parts = row.chunks_mut(self.tile[0].into());
            for (tile, part) in tiles[first..].iter_mut().zip(parts) {
                tile.push(part);
            }
        }
        tiles
    }

    /// The pixels of a tile; tiles are numbered row by row.
    pub fn window(&self, tile: usize) -> Window {
        let first = [tile % self.columns, tile / self.columns];
        let first = [0, 1].map(|axis| first[axis] as u16 * self.tile[axis]);
        let last = [0, 1].map(|axis| first[axis].saturating_add(self.tile[axis]));
        Window { first, end: last }.intersect(&Window {
            first: [0; 2],
            end: self.viewport,
        })
    }

    /// Calls `each` with every tile that the bounds touch.
    #[inline(always)]
    pub fn touched(&self, bounds: &Window, mut each: impl FnMut(usize)) {
        let tile =
            |pixel: u16, axis: usize| ((u64::from(pixel) * self.inverse[axis]) >> 32) as usize;
        let (left, right) = (tile(bounds.first[0], 0), tile(bounds.end[0] - 1, 0));
        for y in tile(bounds.first[1], 1)..=tile(bounds.end[1] - 1, 1) {
            for x in left..=right {
                each(y * self.columns + x);
            }
        }
    }
}

/// How a picture's sort keys and indices share the bits of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Packing {
    nearest: u64,
    /// Bits of an index.
    index: u32,
    /// Bits of a difference to the nearest key for which an entry has no room.
    dropped: u32,
    /// First of the bits that the radix sort looks at.
    first: u32,
    /// Are all splats equally near? Then lists are in order as they are.
    flat: bool,
}

impl Packing {
    fn new(parts: &[ScenePart]) -> Self {
        let bits = |largest: u64| u64::BITS - largest.leading_zeros();
        let ranges = parts
            .par_iter()
            .with_max_len(1)
            .flat_map_iter(ScenePart::depths);
        let both = |[a, b]: [u64; 2], [c, d]: [u64; 2]| [a.min(c), b.max(d)];
        let [nearest, farthest] = ranges.reduce_with(both).unwrap_or_default();
        let last = parts.iter().filter_map(|part| part.keys.last());
        let index = bits(last.map(|key| key.index).max().unwrap_or(0).into());
        let depth = bits(farthest - nearest);
        let dropped = depth.saturating_sub(u64::BITS - index);
        Packing {
            nearest,
            index,
            dropped,
            first: index + (depth - dropped).saturating_sub(8 * DIGITS as u32),
            flat: nearest == farthest,
        }
    }

    #[inline(always)]
    fn entry(&self, key: &Key) -> u64 {
        (key.depth - self.nearest) >> self.dropped << self.index | u64::from(key.index)
    }

    #[inline(always)]
    fn index(&self, entry: u64) -> u32 {
        (entry & ((1 << self.index) - 1)) as u32
    }

    /// Puts entries that are equal to the radix sort in their order.
    fn settle(&self, entries: &mut [u64], parts: &[ScenePart]) {
        let by_whole_key = |a: &u64, b: &u64| {
            let key = |entry: u64| (whole_key(parts, self.index(entry)), entry);
            key(*a).cmp(&key(*b))
        };
        for equal in entries.chunk_by_mut(|a, b| a >> self.first == b >> self.first) {
            if !equal.is_sorted() {
                equal.sort_unstable();
            }
            if self.dropped > 0 && equal.len() > 1 {
                equal.sort_unstable_by(by_whole_key);
            }
        }
    }
}

/// The sort key of a splat; the indices of the parts ascend.
fn whole_key(parts: &[ScenePart], index: u32) -> u64 {
    let mut keys = parts.iter().map(|part| &part.keys[..]);
    let keys = keys.find(|keys| keys.last().is_some_and(|key| key.index >= index));
    let keys = keys.unwrap_or_default();
    let place = keys.binary_search_by_key(&index, |key| key.index);
    place.map_or(0, |place| keys[place].depth)
}

/// Splats of one part of the scene: what orders them, and their entries by tile.
#[derive(Clone, Debug, Default)]
pub struct ScenePart {
    /// Of the part's splats that are seen, indices ascending.
    pub keys: Vec<Key>,
    /// Where each tile's entries end.
    ends: Vec<u32>,
    entries: Vec<u64>,
}

impl ScenePart {
    /// The depths of the nearest and the farthest splat, if there is one.
    fn depths(&self) -> Option<[u64; 2]> {
        let first = self.keys.first()?.depth;
        let both = |[a, b]: [u64; 2], key: &Key| [a.min(key.depth), b.max(key.depth)];
        Some(self.keys.iter().fold([first; 2], both))
    }

    /// Bins the keys in two passes: counting, then placing.
    fn bin(&mut self, grid: &Grid, packing: Packing) {
        let ScenePart {
            keys,
            ends,
            entries,
        } = self;
        ends.clear();
        ends.resize(grid.len(), 0);
        for key in &*keys {
            grid.touched(&key.bounds, |tile| ends[tile] += 1);
        }
        let mut next = 0;
        for end in &mut *ends {
            next += std::mem::replace(end, next);
        }
        entries.clear();
        entries.resize(next as usize, 0);
        for key in &*keys {
            let entry = packing.entry(key);
            grid.touched(&key.bounds, |tile| {
                entries[ends[tile] as usize] = entry;
                ends[tile] += 1;
            });
        }
    }

    fn of(&self, tile: usize) -> &[u64] {
        let start = if tile == 0 { 0 } else { self.ends[tile - 1] };
        &self.entries[start as usize..self.ends[tile] as usize]
    }
}

/// A tile's splats, nearest first, and what sorting them needs.
#[derive(Clone, Debug, Default)]
struct List {
    entries: Vec<u64>,
    spare: Vec<u64>,
    indices: Vec<u32>,
}

/// Lists of all tiles. Its memory is used again for the next picture.
#[derive(Clone, Debug, Default)]
pub struct TileOrder {
    /// The scene's splats in parts, indices ascending: to be filled, then [sorted](TileOrder::sort).
    pub parts: Vec<ScenePart>,
    lists: Vec<List>,
}

impl TileOrder {
    /// Sets up all splats, a part of [`part_length`] after the other on every core, each in one `step` and batch by
    /// batch; `add` sums the counts.
    pub fn fill<S: Sync, O: Send, F: Default + Send>(
        &mut self,
        splats: &[S],
        outcomes: &mut [O],
        step: &(dyn Fn(&mut dyn FnMut()) + Sync),
        set_up: &SetUpBatch<S, O, F>,
        add: fn(F, F) -> F,
    ) -> F {
        let length = part_length(splats.len());
        let parts = &mut self.parts;
        parts.resize_with(splats.len().div_ceil(length), Default::default);
        let of_splats = outcomes
            .par_chunks_mut(length)
            .zip(splats.par_chunks(length));
        let work = parts.par_iter_mut().zip(of_splats).enumerate();
        let counted = work.with_max_len(1).map(|(number, (part, of_splats))| {
            part.keys.clear();
            let (outcomes, splats) = of_splats;
            let mut counts = F::default();
            step(&mut || {
                let mut first = number * length;
                for (outcomes, splats) in outcomes.chunks_mut(BATCH).zip(splats.chunks(BATCH)) {
                    let batch = set_up(splats, outcomes, first, &mut part.keys);
                    counts = add(std::mem::take(&mut counts), batch);
                    first += splats.len();
                }
            });
            counts
        });
        counted.reduce(F::default, add)
    }

    /// Puts the splats of all parts into their tiles' lists, nearest first. Parts are binned side by side, and tiles
    /// sorted.
    pub fn sort(&mut self, grid: &Grid) {
        let TileOrder { parts, lists } = self;
        let packing = Packing::new(parts);
        let each = parts.par_iter_mut().with_max_len(1);
        each.for_each(|part| part.bin(grid, packing));
        lists.resize_with(grid.len(), List::default);
        let parts = &*parts;
        let each = lists.par_iter_mut().enumerate().with_max_len(1);
        each.for_each(|(tile, list)| {
            let List {
                entries,
                spare,
                indices,
            } = list;
            entries.clear();
            entries.reserve(parts.iter().map(|part| part.of(tile).len()).sum());
            for part in parts {
                entries.extend_from_slice(part.of(tile));
            }
            if !packing.flat {
                sort_by_depth(entries, spare, packing.first);
                packing.settle(entries, parts);
            }
            indices.clear();
            indices.extend(entries.iter().map(|entry| packing.index(*entry)));
        });
    }

    /// Turns every list around: farthest first.
    pub fn reverse(&mut self) {
        let lists = self.lists.iter_mut();
        lists.for_each(|list| list.indices.reverse());
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let part = |part: &ScenePart| {
            part.keys.capacity() * size_of::<Key>()
                + part.ends.capacity() * size_of::<u32>()
                + part.entries.capacity() * size_of::<u64>()
        };
        let list = |list: &List| {
            (list.entries.capacity() + list.spare.capacity()) * size_of::<u64>()
                + list.indices.capacity() * size_of::<u32>()
        };
        self.parts.iter().map(part).sum::<usize>() + self.lists.iter().map(list).sum::<usize>()
    }

    /// The splats of a tile.
    pub fn list(&self, tile: usize) -> &[u32] {
        self.lists.get(tile).map_or(&[], |list| &list.indices)
    }
}

/// For every tile the splats that touch it, nearest first. The parts of `keys` are binned side by side.
pub fn tile_lists(grid: &Grid, keys: Vec<Vec<Key>>) -> Vec<Vec<u32>> {
    let part = |keys| ScenePart {
        keys,
        ..ScenePart::default()
    };
    let mut order = TileOrder {
        parts: keys.into_iter().map(part).collect(),
        lists: Vec::new(),
    };
    order.sort(grid);
    order.lists.into_iter().map(|list| list.indices).collect()
}

/// Lists shorter than this are sorted by comparison.
const SHORT: usize = 96;

/// Bytes that the radix sort looks at: of a tile's thousands of splats, few are as near as others in more.
const DIGITS: usize = 2;

/// Sorts entries whose indices ascend by the leading bits, from `first` on: radix sort on bytes, which keeps equal ones
/// in order.
fn sort_by_depth(entries: &mut Vec<u64>, spare: &mut Vec<u64>, first: u32) {
    if entries.len() < SHORT {
        entries.sort_unstable();
        return;
    }
    let byte = |entry: u64, number: usize| usize::from((entry >> first >> (8 * number)) as u8);
    let mut counts = [[0u32; 256]; DIGITS];
    for entry in entries.iter() {
        for (number, counts) in counts.iter_mut().enumerate() {
            counts[byte(*entry, number)] += 1;
        }
    }
    spare.clear();
    spare.resize(entries.len(), 0);
    for (number, starts) in counts.iter_mut().enumerate() {
        if starts.contains(&(entries.len() as u32)) {
            continue;
        }
        let mut next = 0;
        for start in starts.iter_mut() {
            next += std::mem::replace(start, next);
        }
        for entry in entries.iter() {
            let start = &mut starts[byte(*entry, number)];
            spare[*start as usize] = *entry;
            *start += 1;
        }
        std::mem::swap(entries, spare);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const VIEWPORT: [u16; 2] = [100, 50];

    /// Keys of 48 bits: anywhere, near each other, alike but for their last bits, alike but for their first.
    fn key() -> impl Strategy<Value = (u64, [u16; 4])> {
        let depth = prop_oneof![
            0u64..1 << 48,
            0u64..4,
            (0u64..4).prop_map(|d| d << 40),
            (1u64 << 47) - 4..1 << 47
        ];
        let corner = (0..VIEWPORT[0], 0..VIEWPORT[1]);
        (depth, corner.clone(), corner).prop_map(|(depth, a, b)| {
            let [left, right] = [a.0.min(b.0), a.0.max(b.0) + 1];
            let [top, bottom] = [a.1.min(b.1), a.1.max(b.1) + 1];
            (depth, [left, top, right, bottom])
        })
    }

    proptest! {
        #[test]
        fn a_pixel_touches_the_tile_that_it_lies_in(x in 0..u16::MAX, y in 0..u16::MAX, columns in 1..=u16::MAX, rows in 1..=u16::MAX, multiple: bool) {
            // Anywhere, or at a tile's first pixel.
            let [x, y] = if multiple { [x - x % columns, y - y % rows] } else { [x, y] };
            let grid = Grid::new([u16::MAX; 2], [columns, rows]);
            let expected = usize::from(y / rows) * grid.columns + usize::from(x / columns);
            let bounds = Window { first: [x, y], end: [x + 1, y + 1] };
            grid.touched(&bounds, |tile| assert_eq!(tile, expected));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The oracle filters and sorts by comparison, tile by tile.
        #[test]
        fn lists_are_sorted_by_depth_then_index(splats in prop::collection::vec(key(), 0..400), cut in 0usize..400) {
            let keys: Vec<Key> = splats.iter().zip(0..).map(|((depth, [left, top, right, bottom]), index)| Key {
                depth: *depth, index, bounds: Window { first: [*left, *top], end: [*right, *bottom] },
            }).collect();
            let grid = Grid::new(VIEWPORT, [32, 16]);
            let (head, tail) = keys.split_at(cut.min(keys.len()));
            let lists = tile_lists(&grid, vec![head.to_vec(), tail.to_vec()]);
            prop_assert_eq!(lists.len(), 4 * 4);
            for (tile, list) in lists.iter().enumerate() {
                let window = grid.window(tile);
                let mut expected: Vec<&Key> = keys.iter().filter(|key| !key.bounds.intersect(&window).is_empty()).collect();
                expected.sort_by_key(|key| (key.depth, key.index));
                prop_assert!(expected.iter().map(|key| key.index).eq(list.iter().copied()), "tile {tile}");
            }
        }
    }
}
