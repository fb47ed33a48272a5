//! Where a scene is cut: at depths up to which splats have covered the screen so many times over.
//!
//! Hardly a pixel has finished before the boxes of footprints cover the screen two hundred times. A slice costs a way
//! of all pixels in work through memory, so there are few, each as deep as all before it; and a scene that ends before
//! the second has none.

use super::DepthFirst;
use super::spheres::{Projected, TOGETHER};
use splatline::float;
use splatline::footprint::depth;

/// A depth between two slices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    depth: f32,
    /// Its sort key: the nearer slice has the keys up to it.
    key: u64,
}

/// Times that the boxes of the first slice cover the screen: with fewer a million splats take longer, with more they
/// are set up in vain.
const LAYERS: f32 = 256.0;

/// Most cuts of a frame.
pub const MOST: usize = 6;

/// Spheres that are looked at.
const SAMPLE: usize = 4096;

/// The cuts of a frame, nearest first.
pub fn cuts(front: &DepthFirst, sample: &mut Vec<[f32; 2]>, cuts: &mut Vec<Cut>) {
    cuts.clear();
    sample.clear();
    let groups = &front.spheres.groups;
    let stride = groups.len().div_ceil(SAMPLE / TOGETHER).max(1);
    let unit = stride as f32 / front.projection.area();
    for group in groups.iter().step_by(stride) {
        let Projected {
            least,
            most,
            bounds,
        } = front.projection.project(group);
        let [left, top, right, bottom] = bounds;
        for k in 0..TOGETHER {
            let area = (right[k] - left[k]) * (bottom[k] - top[k]) * unit;
            if least[k] > 0.0 && most[k].is_finite() && area > 0.0 {
                sample.push([most[k], area]);
            }
        }
    }
    sample.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let all: f32 = sample.iter().map(|[_, area]| area).sum();
    let (mut layers, mut next) = (0.0, LAYERS);
    for [depth, area] in sample.iter() {
        layers += area;
        // What lies behind must be worth a slice.
        if layers >= next && all >= 2.0 * next && cuts.len() < MOST {
            cuts.push(Cut::at(*depth));
            next *= 2.0;
        }
    }
}

impl Cut {
    /// At a depth in front of the eye.
    pub fn at(depth: f32) -> Self {
        Cut {
            depth,
            key: depth::key(float::extended(depth.into())),
        }
    }
}

/// The slice of a sort key.
pub fn slice_of_key(cuts: &[Cut], key: u64) -> usize {
    cuts.iter().filter(|cut| key > cut.key).count()
}

/// The slices of the least and of the largest depth that splats can have.
#[inline(always)]
pub fn slices_of_depths(cuts: &[Cut], seen: &Projected) -> [[u32; TOGETHER]; 2] {
    let (mut low, mut high) = ([0; TOGETHER], [0; TOGETHER]);
    for cut in cuts {
        for k in 0..TOGETHER {
            low[k] += u32::from(seen.least[k] > cut.depth);
            // No number is not certain.
            let nearer = seen.most[k] <= cut.depth;
            high[k] += u32::from(!nearer);
        }
    }
    [low, high]
}
