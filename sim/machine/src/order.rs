//! What brings splats into the order of their depths: which passes over how many of them, and what each pass costs
//! before its first splat.
//!
//! Entries of tile lists may be sorted (`passes`), which sorts a splat once for every tile that it meets; or splats
//! before they are binned (`radix`, `merge`), so that every list is filled in order. Then the geometry phase writes one
//! word of key, number and tiles for a splat instead of its list entries, and after the sort a pass over those words
//! fills the lists (`tile_binning.sv`).

use super::config::{Config, Sorter};
use super::workload::{OrderChanges, Workload};
use splatline::footprint::depth::KEY_BITS;

/// Passes of the sort over so many entries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct SortStep {
    pub entries: u64,
    pub passes: u64,
    /// Places into which a pass writes: as many as a digit has values, or one for a merge.
    pub places: u64,
    /// Cycles of a pass before its first entry: the sums of the counts of a digit's values.
    pub begins: u64,
    /// Cycles of a pass in which nothing moves: the first entry is on its way from memory, and then the last one to it,
    /// where the next pass reads it.
    pub waits: u64,
}

/// Places into which a pass over list entries writes: a digit of eight bits.
const BUCKETS: u64 = 256;

impl SortStep {
    /// The steps for a picture with so many visible splats and list entries.
    pub fn all(config: &Config, workload: &Workload, visible: u64, entries: u64) -> Vec<SortStep> {
        match config.sorter {
            Sorter::Passes => over_entries(config, entries, workload.order_changes),
            Sorter::Radix => by_digits(config, workload.key_bits, visible),
            Sorter::Merge => vec![SortStep {
                entries: visible,
                passes: merges(config, visible).saturating_sub(1),
                places: 1,
                waits: waits(config),
                ..SortStep::default()
            }],
        }
    }

    /// Entries that all steps move.
    pub fn moves(steps: &[SortStep]) -> u64 {
        steps.iter().map(|step| step.entries * step.passes).sum()
    }

    /// Cycles of all steps with so many for an entry.
    pub fn cycles(steps: &[SortStep], each: u64) -> u64 {
        steps.iter().map(|step| step.work(each)).sum()
    }

    /// Cycles of this step with so many for an entry, without what it waits for.
    pub fn work(&self, each: u64) -> u64 {
        self.passes * (self.begins + self.entries * each)
    }
}

/// From the end of a pass to the first entry of the next one: words that are written take as long as words that are
/// read.
pub(super) fn waits(config: &Config) -> u64 {
    2 * u64::from(config.latency)
}

/// All entries anew; or what came by itself, and a pass over what stayed, came and left, which drops and merges.
fn over_entries(config: &Config, entries: u64, changes: Option<OrderChanges>) -> Vec<SortStep> {
    let anew = |entries| SortStep {
        entries,
        passes: config.sort_passes.into(),
        places: BUCKETS,
        ..SortStep::default()
    };
    let Some(changes) = changes else {
        return vec![anew(entries)];
    };
    let merge = SortStep {
        entries: entries + changes.left,
        passes: 1,
        places: 1,
        ..SortStep::default()
    };
    vec![anew(changes.came), merge]
}

/// A pass for every digit of `bits` bits. Its counts are summed first; where that shows that all keys share the digit,
/// nothing is moved.
fn by_digits(config: &Config, varying: u64, visible: u64) -> Vec<SortStep> {
    let bits = config.sort_digit;
    let all = u64::from(KEY_BITS.div_ceil(bits));
    let moving = digits(bits, varying);
    let step = |entries, passes, waits| SortStep {
        entries,
        passes,
        places: 1 << bits,
        begins: 1 << bits,
        waits,
    };
    let moved = step(visible, moving, waits(config));
    match visible {
        0 => Vec::new(),
        _ => vec![moved, step(0, all - moving, 0)],
    }
}

/// Digits of `bits` bits that are not the same in all keys.
fn digits(bits: u32, varying: u64) -> u64 {
    let all = (0..KEY_BITS).step_by(bits as usize);
    let digit = |first: u32| varying >> first & ((1 << bits) - 1);
    all.filter(|first| digit(*first) != 0).count() as u64
}

/// Merges until one run is left; the last of them hands its splats on to the lists instead of writing them.
fn merges(config: &Config, visible: u64) -> u64 {
    let mut runs = visible.div_ceil(config.sort_run.into());
    let mut merges = 0;
    while runs > 1 {
        runs = runs.div_ceil(config.sort_ways.into());
        merges += 1;
    }
    merges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_digit_that_all_keys_share_needs_no_pass() {
        assert_eq!(digits(8, (1 << 48) - 1), 6);
        assert_eq!(digits(12, (1 << 48) - 1), 4);
        assert_eq!(digits(11, (1 << 48) - 1), 5);
        assert_eq!(digits(8, 1 << 47 | 0xff00), 2);
        assert_eq!(digits(8, 0), 0);
    }

    #[test]
    fn runs_are_merged_until_one_is_left() {
        let config = Config {
            sort_run: 100,
            sort_ways: 4,
            ..Config::machine(4)
        };
        let counts = [0, 1, 100, 101, 400, 401, 1600, 1601];
        let merges = counts.map(|visible| merges(&config, visible));
        assert_eq!(merges, [0, 0, 0, 1, 1, 2, 2, 3]);
    }
}
