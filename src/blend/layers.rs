//! The layered A-buffer (SURF 6): L fragments per pixel, transparency in one pass and any order of drawing.
//!
//! A sample whose depth lies within the threshold of a fragment's depth range is accumulated into it, otherwise it opens a
//! fragment of its own; fragments whose ranges have grown together are added up. That is single-linkage
//! clustering of the depths: its clusters do not depend on the order of the samples, and neither do integer sums. As long as no more than L
//! clusters are open at a time the picture is therefore the same, bit for bit, for every order of drawing.
//!
//! The L+1st fragment makes the nearest pair merge (SURF eq. 12), in premultiplied form
//!
//! ```text
//! c = c_f + (1 - a_f) c_b,   a = a_f + (1 - a_f) a_b
//! ```
//!
//! on the divided attributes. The merged fragment keeps the larger of both weight sums and both depth ranges: later samples
//! of either surface are averaged with it, which is the approximation that L bounds.

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

    /// Accumulates into the first fragment within the threshold and joins it with the next if the sample closed the gap.
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

    /// Index of the front one of the two neighbours with the smallest gap, among all `L` fragments and the one behind them.
    fn nearest_pair(&self, last: &Fragment) -> usize {
        let behind = self.fragments.iter().skip(1).chain(core::iter::once(last));
        let gaps = (self.fragments.iter())
            .zip(behind)
            .map(|(front, back)| back.near.saturating_sub(front.far));
        gaps.enumerate()
            .min_by_key(|(_, gap)| *gap)
            .map_or(0, |(index, _)| index)
    }

    /// Takes fragment `index` out; those behind it move up and `last` fills the end. Behind all of them it takes `last` itself.
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

/// Sums of both; where the weight sum would exceed its format both are halved first. The material is that of the nearer.
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
    use crate::format::{Design, Standard24};

    /// Two half transparent surfaces in a buffer of one layer: three quarters opaque, half of the back's colour shows, and later samples
    /// of either or between them are averaged with both.
    #[test]
    fn a_merged_layer_is_the_front_over_the_back() {
        let widths = Standard24.widths();
        let one = 1 << attribute_fraction(&widths);
        let gather = WeightedSum::new(&widths, 100);
        let mut layers = Layers::<1>::EMPTY;
        for (depth, red) in [(1000, one / 4), (5000, one / 2)] {
            let attributes = Attributes {
                colour: [red, 0, 0],
                opacity: one / 2,
                normal: [0, 0, -(one as i32)],
                material: (depth / 1000) as u8,
            };
            let sample = Sample {
                weight: 1 << sum_fraction(&widths),
                depth,
                attributes: &attributes,
            };
            layers.add(&gather, &sample);
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
}
