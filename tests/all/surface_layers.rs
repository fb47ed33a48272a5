//! The layered buffer against an oracle that sees all samples at once, and its order independence.

use proptest::prelude::*;
use splatline::blend::layers::Layers;
use splatline::blend::surface::{Accumulation, Cell, Sample, WeightedSum, sum_fraction};
use splatline::footprint::surface::{Attributes, attribute_fraction};
use splatline::format::{Design, RuntimeWidths, Standard24};

const THRESHOLD: u32 = 100;

/// Fraction bits of attributes.
const FRACTION: u8 = attribute_fraction(&Standard24::WIDTHS);
/// 1.0 as an attribute.
const ONE: u32 = 1 << FRACTION;
/// Fraction bits of a result below those of the sums.
const BELOW: u8 = Standard24::WIDTHS.accumulator - sum_fraction(&Standard24::WIDTHS);

fn attributes(number: u32) -> Attributes {
    let number = number % 1_000_003;
    Attributes {
        colour: [
            number.wrapping_mul(997) % ONE,
            number.wrapping_mul(331) % ONE,
            ONE / 2,
        ],
        opacity: ONE / 2,
        normal: [0, (number.wrapping_mul(771) % ONE) as i32, -(ONE as i32)],
        material: (number % 5) as u8,
    }
}

fn gather() -> WeightedSum {
    WeightedSum::new(&Standard24::WIDTHS, THRESHOLD)
}

fn drawn<C: Cell>(samples: &[(u32, u32)]) -> C {
    let mut cell = C::EMPTY;
    for (depth, weight) in samples {
        let attributes = attributes(depth.wrapping_mul(31) ^ weight);
        let sample = Sample {
            weight: *weight,
            depth: *depth,
            attributes: &attributes,
        };
        cell.add(&gather(), &sample);
    }
    cell
}

/// Depths in order, cut wherever the gap exceeds the threshold: (nearest, farthest, weight sum) of each cluster.
fn clusters(samples: &[(u32, u32)]) -> Vec<(u32, u32, u32)> {
    let mut sorted = samples.to_vec();
    sorted.sort_unstable();
    let mut found: Vec<(u32, u32, u32)> = Vec::new();
    for (depth, weight) in sorted {
        match found.last_mut() {
            Some((_, far, sum)) if depth - *far <= THRESHOLD => {
                *far = depth;
                *sum += weight;
            }
            _ => found.push((depth, depth, weight)),
        }
    }
    found
}

/// The largest number of samples that are pairwise farther apart than the threshold.
fn overlapping(samples: &[(u32, u32)]) -> usize {
    let mut depths: Vec<u32> = samples.iter().map(|sample| sample.0).collect();
    depths.sort_unstable();
    let mut last = None;
    depths.retain(|depth| {
        let apart = last.is_none_or(|last| depth - last > THRESHOLD);
        last = if apart { Some(*depth) } else { last };
        apart
    });
    depths.len()
}

fn some_samples() -> impl Strategy<Value = Vec<(u32, u32)>> {
    let near = (0u32..900, 1u32..1 << 24);
    let far = (
        prop_oneof![Just(5_000u32), Just(7_000), Just(7_090), Just(7_250)],
        1u32..1 << 24,
    );
    proptest::collection::vec(prop_oneof![near, far], 1..24)
}

proptest! {
    #[test]
    fn fragments_are_the_clusters_of_the_depths(samples in some_samples()) {
        let cell: Layers<16> = drawn(&samples);
        let found: Vec<_> = cell.fragments().iter().map(|f| (f.near, f.far, f.weight)).collect();
        prop_assert_eq!(found, clusters(&samples));
        prop_assert_eq!(cell.merges(), 0);
    }

    #[test]
    fn any_order_gives_the_same_bits(samples in some_samples(), shuffle in any::<u64>()) {
        let mut shuffled = samples.clone();
        shuffled.sort_by_key(|(depth, weight)| {
            (u64::from(*depth) << 32 | u64::from(*weight)).wrapping_mul(shuffle | 1)
        });
        prop_assert_eq!(drawn::<Layers<16>>(&samples), drawn::<Layers<16>>(&shuffled));
        if overlapping(&samples) <= 4 {
            let (a, b): (Layers<4>, Layers<4>) = (drawn(&samples), drawn(&shuffled));
            prop_assert_eq!(&a, &b);
            let unlimited: Layers<16> = drawn(&samples);
            prop_assert_eq!(a.fragments(), unlimited.fragments());
        }
    }

    #[test]
    fn too_many_layers_stay_sorted_and_within_bounds(samples in proptest::collection::vec((any::<u32>(), 1u32..1 << 24), 1..40)) {
        let cell: Layers<3> = drawn(&samples);
        let fragments = cell.fragments();
        prop_assert!(fragments.len() <= 3 && !fragments.is_empty());
        prop_assert!(fragments.windows(2).all(|pair| pair[0].far < pair[1].near));
        for fragment in fragments {
            let filtered = gather().normalise(fragment);
            prop_assert!(filtered.opacity <= 4 * ONE && filtered.colour.iter().all(|c| *c <= 4 * ONE));
        }
    }

    #[test]
    fn every_bit_pattern_is_defined(
        samples in proptest::collection::vec((any::<u32>(), any::<u32>(), any::<[u32; 4]>(), any::<[i32; 3]>()), 1..12),
        threshold: u32,
        wide: bool,
    ) {
        let widths = if wide { splatline::format::Deep32.widths() } else { splatline::format::Classic8.widths() };
        let gather = WeightedSum::new(&RuntimeWidths::new(widths).unwrap().widths(), threshold);
        let mut layers = Layers::<2>::EMPTY;
        let mut single = Accumulation::EMPTY;
        for (weight, depth, [r, g, b, opacity], normal) in samples {
            let attributes = Attributes { colour: [r, g, b], opacity, normal, material: 0 };
            let sample = Sample { weight, depth, attributes: &attributes };
            layers.add(&gather, &sample);
            single.add(&gather, &sample);
        }
        for fragment in layers.fragments().iter().chain(single.fragments()) {
            let _ = gather.normalise(fragment);
        }
    }
}

#[test]
fn a_constant_attribute_survives_the_division() {
    let attributes = attributes(12_345);
    let mut cell = Accumulation::EMPTY;
    for weight in [1, 77, 1 << 20, 12_345_678, 3 << 22] {
        cell.add(
            &gather(),
            &Sample {
                weight,
                depth: 5,
                attributes: &attributes,
            },
        );
    }
    let filtered = gather().normalise(&cell.fragments()[0]);
    for (got, stored) in filtered.colour.iter().zip(attributes.colour) {
        let drop = FRACTION - Standard24::WIDTHS.accumulator;
        let expected = (stored + (1 << (drop - 1))) >> drop;
        assert!(got.abs_diff(expected) <= 2 << BELOW, "{got} {expected}");
    }
}

/// Accumulate, replace, discard, by depth.
#[test]
fn the_accumulation_buffer_keeps_the_nearest_surface() {
    let one = 1 << 24;
    let weight_after = |depths: &[u32]| {
        let samples: Vec<(u32, u32)> = depths.iter().map(|depth| (*depth, one)).collect();
        let cell: Accumulation = drawn(&samples);
        let fragment = cell.fragments()[0];
        (fragment.weight / one, fragment.near)
    };
    assert_eq!(weight_after(&[500, 550, 600]), (3, 500));
    assert_eq!(weight_after(&[500, 601]), (1, 500));
    assert_eq!(weight_after(&[500, 399]), (1, 399));
    assert_eq!(weight_after(&[500, 400]), (2, 400));
    assert!(Accumulation::EMPTY.fragments().is_empty());
}

/// A fragment whose weight sum is full keeps its average.
#[test]
fn a_full_fragment_takes_no_more() {
    let samples = vec![(7, (1 << 24) + 3); 300];
    let cell: Accumulation = drawn(&samples);
    let fragment = cell.fragments()[0];
    assert!(fragment.weight < 1 << 31 && fragment.weight > (1 << 31) - (1 << 25));
    let few: Accumulation = drawn(&samples[..3]);
    let (many, few) = (
        gather().normalise(&fragment),
        gather().normalise(&few.fragments()[0]),
    );
    for (a, b) in many.colour.iter().zip(few.colour) {
        assert!(a.abs_diff(b) <= 2 << BELOW, "{a} {b}");
    }
}
