//! The layered A-buffer (SURF 6): L fragments per pixel, transparency in one pass and any order of drawing.
//!
//! A sample whose depth lies within the threshold of a fragment's depth range is accumulated into it, otherwise it
//! opens a fragment of its own; fragments whose ranges have grown together are added up. That is single-linkage
//! clustering of the depths: its clusters do not depend on the order of the samples, and neither do integer sums. As
//! long as no more than L clusters are open at a time the picture is therefore the same, bit for bit, for every order
//! of drawing.
//!
//! The L+1st fragment makes the nearest pair merge (SURF eq. 12), in premultiplied form
//!
//! ```text
//! c = c_f + (1 - a_f) c_b,   a = a_f + (1 - a_f) a_b
//! ```
//!
//! on the divided attributes. The merged fragment keeps the larger of both weight sums and both depth ranges: later
//! samples of either surface are averaged with it, which is the approximation that L bounds.

use super::surface::{Cell, Filtered, Fragment, Sample, WeightedSum};

/// At most `L` fragments of a pixel, nearest first. `L` is at least 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layers<const L: usize> {
    fragments: heapless::Vec<Fragment, L>,
    merges: u32,
}

impl<const L: usize> Layers<L> {
    /// How many pairs had to be merged because more than `L` layers met here; saturating.
    pub fn merges(&self) -> u32 {
        self.merges
    }

    /// Accumulates into the first fragment within the threshold and joins it with the next if the sample closed the
    /// gap.
    #[inline(always)]
    fn accumulate(&mut self, gather: &WeightedSum, sample: &Sample) -> bool {
        let near_enough = |fragment: &Fragment| {
            let low = fragment.near.saturating_sub(gather.threshold);
            let high = fragment.far.saturating_add(gather.threshold);
            (low..=high).contains(&sample.depth)
        };
        let Some(index) = self.fragments.iter().position(near_enough) else {
            return false;
        };
        if let Some(fragment) = self.fragments.get_mut(index) {
            gather.accumulate(fragment, sample);
        }
        self.join(gather, index);
        true
    }

    /// Adds fragment `index + 1` to fragment `index` if the gap between them is within the threshold.
    fn join(&mut self, gather: &WeightedSum, index: usize) {
        let pair = (self.fragments.get(index)).zip(self.fragments.get(index + 1));
        let Some((front, back)) = pair else {
            return;
        };
        if back.near.saturating_sub(front.far) > gather.threshold {
            return;
        }
        let sum = add(front, back);
        self.remove(index + 1, Fragment::default());
        let rest = self.fragments.len().saturating_sub(1);
        self.fragments.truncate(rest);
        if let Some(fragment) = self.fragments.get_mut(index) {
            *fragment = sum;
        }
    }

    /// Puts a fragment in its place by depth; merges the nearest pair if there are now more than `L`.
    fn insert(&mut self, gather: &WeightedSum, mut incoming: Fragment) {
        for slot in &mut self.fragments {
            if incoming.near < slot.near {
                core::mem::swap(slot, &mut incoming);
            }
        }
        if !self.fragments.is_full() {
            // There is room, so that nothing comes back.
            let _ = self.fragments.push(incoming);
            return;
        }
        let last = incoming;
        let index = self.nearest_pair(&last);
        let back = self.remove(index + 1, last);
        if let Some(front) = self.fragments.get_mut(index) {
            *front = merge(gather, front, &back);
        }
        self.merges = self.merges.saturating_add(1);
    }

    /// Index of the front one of the two neighbours with the smallest gap, among all `L` fragments and the one behind
    /// them.
    fn nearest_pair(&self, last: &Fragment) -> usize {
        let behind = self.fragments.iter().skip(1).chain(core::iter::once(last));
        let gaps = (self.fragments.iter())
            .zip(behind)
            .map(|(front, back)| back.near.saturating_sub(front.far));
        gaps.enumerate()
            .min_by_key(|(_, gap)| *gap)
            .map_or(0, |(index, _)| index)
    }

    /// Takes fragment `index` out; those behind it move up and `last` fills the end. Behind all of them it takes `last`
    /// itself.
    fn remove(&mut self, index: usize, last: Fragment) -> Fragment {
        let mut carried = last;
        for slot in self.fragments.iter_mut().skip(index).rev() {
            core::mem::swap(slot, &mut carried);
        }
        carried
    }
}

impl<const L: usize> Cell for Layers<L> {
    const EMPTY: Self = Layers {
        fragments: heapless::Vec::new(),
        merges: 0,
    };

    /// Accumulate or separate, insert, merge.
    fn add(&mut self, gather: &WeightedSum, sample: &Sample) {
        const { assert!(L > 0) };
        if !self.accumulate(gather, sample) {
            let mut fragment = Fragment::default();
            gather.accumulate(&mut fragment, sample);
            self.insert(gather, fragment);
        }
    }

    fn fragments(&self) -> &[Fragment] {
        &self.fragments
    }
}

/// Sums of both; where the weight sum would exceed its format both are halved first. The material is that of the
/// nearer.
fn add(front: &Fragment, back: &Fragment) -> Fragment {
    let full = u64::from(front.weight) + u64::from(back.weight) >= 1 << 31;
    let half = u32::from(full);
    let sum = |a: u32, b: u32| (a >> half).saturating_add(b >> half);
    let [front_colour, back_colour] = [front.colour, back.colour];
    let [front_normal, back_normal] = [front.normal, back.normal];
    Fragment {
        weight: sum(front.weight, back.weight),
        colour: [0, 1, 2].map(|c: usize| sum(front_colour[c], back_colour[c])),
        opacity: sum(front.opacity, back.opacity),
        normal: [0, 1, 2]
            .map(|c: usize| (front_normal[c] >> half).saturating_add(back_normal[c] >> half)),
        near: front.near.min(back.near),
        far: front.far.max(back.far),
        material: front.material,
    }
}

/// SURF eq. 12 on the divided fragments; weight sum of the heavier, depth range of both, material of the front one.
fn merge(gather: &WeightedSum, front: &Fragment, back: &Fragment) -> Fragment {
    let merged = over(gather, &gather.normalise(front), &gather.normalise(back));
    Fragment {
        near: front.near.min(back.near),
        far: front.far.max(back.far),
        ..gather.weigh(&merged, front.weight.max(back.weight))
    }
}

/// The front's attributes over the back's. The normal is weighted like a colour; only its direction is used.
fn over(gather: &WeightedSum, front: &Filtered, back: &Filtered) -> Filtered {
    let rest = gather.one() - i64::from(front.opacity.min(gather.one() as u32));
    let behind = |value: i64| gather.times_unit(value, rest);
    let blend = |front: u32, back: u32| {
        let sum = i64::from(front).saturating_add(behind(back.into()));
        sum.clamp(0, gather.one()) as u32
    };
    let normal = |front_part: i32, back_part: i32| {
        let front_part = gather.times_unit(front_part.into(), front.opacity.into());
        let back_part = gather.times_unit(behind(back_part.into()), back.opacity.into());
        front_part
            .saturating_add(back_part)
            .clamp(-(1 << 30), 1 << 30) as i32
    };
    Filtered {
        colour: [0, 1, 2].map(|c: usize| blend(front.colour[c], back.colour[c])),
        opacity: blend(front.opacity, back.opacity),
        normal: [0, 1, 2].map(|c: usize| normal(front.normal[c], back.normal[c])),
        material: front.material,
    }
}

#[cfg(test)]
mod tests {
    use super::super::surface::sum_fraction;
    use super::*;
    use crate::footprint::surface::{Attributes, attribute_fraction};
    use crate::format::{Classic8, Design, Standard24, Widths};
    use proptest::prelude::*;

    const THRESHOLD: u32 = 100;

    /// Shares of 1: opacity, colour of that, normal; then the weight and the depth.
    type Surface = ([f64; 7], u32, u32);

    fn added<const L: usize>(
        gather: &WeightedSum,
        layers: &mut Layers<L>,
        surface: &Surface,
        fraction: u8,
    ) {
        let ([opacity, r, g, b, normal @ ..], weight, depth) = *surface;
        let fixed = |value: f64| (value * f64::from(1 << fraction)) as i32;
        let attributes = Attributes {
            colour: [r, g, b].map(|c| fixed(c * opacity) as u32),
            opacity: fixed(opacity) as u32,
            normal: normal.map(fixed),
            material: (depth / 1000) as u8,
        };
        layers.add(
            gather,
            &Sample {
                weight,
                depth,
                attributes: &attributes,
            },
        );
    }

    fn surfaces() -> impl Strategy<Value = ([f64; 7], u32)> {
        let share = || prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0];
        let side = || prop_oneof![Just(-1.0), Just(1.0), -1.0..=1.0];
        (
            [share(), share(), share(), share(), side(), side(), side()],
            1u32 << 20..=1 << 24,
        )
    }

    proptest! {
        /// Three surfaces in a buffer of two layers, in any order: of the pair with the smaller gap the front is over
        /// the back.
        #[test]
        fn the_nearest_pair_merges(all in [surfaces(), surfaces(), surfaces()], gaps in [1000u32..4000, 1000u32..4000], order in 0usize..6) {
            let widths = Standard24.widths();
            let gather = WeightedSum::new(&widths, THRESHOLD);
            let mut depth = 1000;
            let mut placed = [0, 1, 2].map(|i| {
                depth += if i > 0 { gaps[i - 1] } else { 0 };
                (all[i].0, all[i].1, depth)
            });
            let sorted = placed;
            placed.swap(0, order / 2);
            placed.swap(1, 1 + order % 2);
            let mut layers = Layers::<2>::EMPTY;
            for surface in &placed {
                added(&gather, &mut layers, surface, attribute_fraction(&widths));
            }
            prop_assert_eq!(layers.merges(), 1);
            let first = usize::from(gaps[1] < gaps[0]);
            let (front, back) = (&sorted[first], &sorted[first + 1]);
            let merged = &layers.fragments()[first];
            prop_assert_eq!((merged.near, merged.far, merged.weight), (front.2, back.2, front.1.max(back.1)));
            prop_assert_eq!(u32::from(merged.material), front.2 / 1000);
            let alone = &sorted[2 - 2 * first];
            let other = &layers.fragments()[1 - first];
            prop_assert_eq!((other.near, other.far, other.weight), (alone.2, alone.2, alone.1));
            let [front, back] = [front, back].map(|(values, ..)| values);
            let rest = 1.0 - front[0];
            let seen = gather.normalise(merged);
            let close = |found: f64, expected: f64| (found - expected).abs() < 3e-5;
            let share = |value: u32| f64::from(value) / gather.one() as f64;
            prop_assert!(close(share(seen.opacity), front[0] + rest * back[0]), "{:?}", seen);
            for i in 0..3 {
                let colour = front[0] * front[1 + i] + rest * back[0] * back[1 + i];
                let normal = front[0] * front[4 + i] + rest * back[0] * back[4 + i];
                prop_assert!(close(share(seen.colour[i]), colour), "{:?}", seen);
                prop_assert!(close(f64::from(seen.normal[i]) / 2f64.powi(30), normal), "{:?}", seen);
            }
        }
    }

    /// Two half transparent surfaces in a buffer of one layer: three quarters opaque, half of the back's colour shows.
    #[test]
    fn a_merged_layer_is_the_front_over_the_back() {
        let widths = Standard24.widths();
        let gather = WeightedSum::new(&widths, THRESHOLD);
        let mut layers = Layers::<1>::EMPTY;
        for (depth, red) in [(1000, 0.5), (5000, 1.0)] {
            let shares = [0.5, red, 0.0, 0.0, 0.0, 0.0, -1.0];
            let surface = (shares, 1 << sum_fraction(&widths), depth);
            added(&gather, &mut layers, &surface, attribute_fraction(&widths));
        }
        let [merged] = layers.fragments() else {
            panic!("one layer");
        };
        assert_eq!((merged.near, merged.far, merged.material), (1000, 5000, 1));
        assert_eq!(layers.merges(), 1);
        let seen = gather.normalise(merged);
        let share = |value: u32| f64::from(value) / gather.one() as f64;
        assert!((share(seen.opacity) - 0.75).abs() < 1e-4, "{seen:?}");
        assert!((share(seen.colour[0]) - 0.5).abs() < 1e-4, "{seen:?}");
        // (0.5 + 0.5 * 0.5 * 0.5) of the direction that both have.
        assert!(seen.normal[2] < -(1 << 28), "{seen:?}");
    }

    #[test]
    fn black_over_black_is_black() {
        let fraction = |accumulator| {
            sum_fraction(&Widths {
                accumulator,
                ..Standard24.widths()
            })
        };
        assert_eq!([23, 24, 26].map(fraction), [23, 24, 24]);
        let gather = WeightedSum::new(&Classic8.widths(), THRESHOLD);
        let mut layers = Layers::<1>::EMPTY;
        for depth in [1000, 5000] {
            let weight = 1 << sum_fraction(&Classic8.widths());
            added(
                &gather,
                &mut layers,
                &([0.0; 7], weight, depth),
                attribute_fraction(&Classic8.widths()),
            );
        }
        assert_eq!(
            layers.fragments().first().map(|f| (f.colour, f.opacity)),
            Some(([0; 3], 0))
        );
    }

    /// Two surfaces that a sample between them joins: sums as long as these fit, their halves otherwise, and always the
    /// average.
    #[test]
    fn joined_layers_are_averaged() {
        let widths = Standard24.widths();
        let gather = WeightedSum::new(&widths, THRESHOLD);
        let one = 1 << sum_fraction(&widths);
        for (front, back) in [(40, 39), (64, 62), (64, 63), (126, 127), (1, 127)] {
            let mut layers = Layers::<3>::EMPTY;
            let shares = [
                [1.0, 1.0, 0.0, 0.5, 1.0, 0.0, -1.0],
                [0.5, 0.0, 1.0, 1.0, 0.0, 1.0, -1.0],
            ];
            for (shares, count, depth) in [
                (shares[0], front, 1000),
                (shares[1], back, 1190),
                (shares[0], 1, 9000),
            ] {
                for _ in 0..count {
                    added(
                        &gather,
                        &mut layers,
                        &(shares, one, depth),
                        attribute_fraction(&widths),
                    );
                }
            }
            added(
                &gather,
                &mut layers,
                &(shares[0], one, 1090),
                attribute_fraction(&widths),
            );
            let [joined, behind] = layers.fragments() else {
                panic!("two layers");
            };
            assert_eq!((behind.near, layers.merges()), (9000, 0));
            let front = front + 1;
            let sum = front + back;
            let expected = if sum >= 128 {
                sum * (one / 2)
            } else {
                sum * one
            };
            assert_eq!(
                (joined.weight, joined.near, joined.far),
                (expected, 1000, 1190)
            );
            let seen = gather.normalise(joined);
            for i in 0..3 {
                let average =
                    |a: f64, b: f64| (a * f64::from(front) + b * f64::from(back)) / f64::from(sum);
                let colour = average(shares[0][1 + i], shares[1][1 + i] * 0.5);
                let normal = average(shares[0][4 + i], shares[1][4 + i]);
                assert!(
                    (f64::from(seen.colour[i]) / gather.one() as f64 - colour).abs() < 1e-5,
                    "{seen:?}"
                );
                assert!(
                    (f64::from(seen.normal[i]) / 2f64.powi(30) - normal).abs() < 1e-5,
                    "{seen:?}"
                );
            }
        }
    }
}
