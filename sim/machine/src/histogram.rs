//! How work is spread over tiles and splats, in classes that double.

use super::config::Config;
use super::lanes::{LaneWork, PairWork};
use serde::Serialize;

/// Class 0 counts zeros, class k > 0 counts values from `2^(k-1)` to `2^k - 1`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Histogram {
    /// Members of each class; the last is not 0.
    pub classes: Vec<u64>,
    /// Sum of all values.
    pub sum: u64,
    /// Largest value.
    pub largest: u64,
}

impl Histogram {
    /// The histogram of some values.
    pub fn of(values: impl IntoIterator<Item = u64>) -> Histogram {
        let mut histogram = Histogram::default();
        for value in values {
            let class = (64 - value.leading_zeros()) as usize;
            if histogram.classes.len() <= class {
                histogram.classes.resize(class + 1, 0);
            }
            histogram.classes[class] += 1;
            histogram.sum += value;
            histogram.largest = histogram.largest.max(value);
        }
        histogram
    }
}

/// Histograms of a picture on a machine. All pairs count, also those that early termination leaves out.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Histograms {
    /// Splat-tile pairs per tile.
    pub pairs_per_tile: Histogram,
    /// Lane cycles per tile.
    pub lane_cycles_per_tile: Histogram,
    /// Tiles per visible splat.
    pub tiles_per_splat: Histogram,
    /// Lane cycles per visible splat.
    pub lane_cycles_per_splat: Histogram,
    /// Covered pixels per visible splat.
    pub covered_per_splat: Histogram,
}

impl Histograms {
    /// Counts over all pairs; `splats` is the number of splats of the scene.
    pub fn new(work: &LaneWork, config: &Config, splats: usize) -> Histograms {
        let stretch = u64::from(config.stretch());
        let mut per_splat = vec![(0u64, 0u64, 0u64); splats];
        let cycles_of = |pair: &PairWork| u64::from(pair.groups) * stretch;
        for pair in &work.pairs {
            if let Some((count, cycles, covered)) = per_splat.get_mut(pair.splat as usize) {
                *count += 1;
                *cycles += cycles_of(pair);
                *covered += u64::from(pair.covered);
            }
        }
        per_splat.retain(|(count, ..)| *count > 0);
        let visible = per_splat;
        let tiles = || (0..work.tiles.len()).map(|tile| &work.pairs[work.pairs_in(tile)]);
        let cycles = tiles().map(|pairs| pairs.iter().map(cycles_of).sum());
        Histograms {
            pairs_per_tile: Histogram::of(tiles().map(|pairs| pairs.len() as u64)),
            lane_cycles_per_tile: Histogram::of(cycles),
            tiles_per_splat: Histogram::of(visible.iter().map(|(count, ..)| *count)),
            lane_cycles_per_splat: Histogram::of(visible.iter().map(|(_, cycles, _)| *cycles)),
            covered_per_splat: Histogram::of(visible.iter().map(|(.., covered)| *covered)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_double() {
        let histogram = Histogram::of([0, 1, 2, 3, 4, 7, 8]);
        assert_eq!(histogram.classes, [1, 1, 2, 2, 1]);
        assert_eq!((histogram.sum, histogram.largest), (25, 8));
    }
}
