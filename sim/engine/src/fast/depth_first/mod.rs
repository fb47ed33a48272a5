//! Depth first: splats behind finished pixels are not even set up.
//!
//! ```text
//! bounding spheres -> depths -> cuts -> for each slice, nearest first:
//!     splats in reach of a pixel in work -> setup, order, tiles
//! ```
//!
//! In a deep scene most splats meet finished pixels alone: nine in ten of a million on 1920 x 1080. What they cost is
//! setup, memory for footprints, and places in lists. So the scene is cut into slices by depth, and a splat is set up
//! only if the box around its sphere touches a block of pixels that the slices before it left in work. The picture is
//! the same, because a finished pixel ignores what follows.
//!
//! Two things must be certain. Slices must not mix, since a pixel sees its splats in the order of their keys: where the
//! bound on a depth's error reaches across a cut, the kernel's own key decides. And a box must hold the footprint's:
//! `spheres.rs` says why it does.

mod blocks;
mod cuts;
mod spheres;

pub use blocks::{LiveBlocks, live_blocks};
pub use spheres::{BoundingSpheres, SphereProjection};

use super::frame::SetUpPart;
use super::lanes::{Lanes, Portable, VectorLevel, VectorTask, dispatch_vectors};
use super::order::part_length;
use cuts::Cut;
use rayon::prelude::*;
use spheres::{Spheres, TOGETHER};
use splatline::setup::Cull;
use splatline::splat::VolumeSplat;

/// A scene's spheres as a view sees them.
#[derive(Clone, Copy, Debug)]
pub struct DepthFirst<'a> {
    /// One for each splat.
    pub spheres: &'a BoundingSpheres,
    /// How they are seen.
    pub projection: SphereProjection,
    /// What projects them.
    pub vectors: VectorLevel,
}

/// The slices of a frame, in memory that the next frame uses again.
#[derive(Clone, Debug, Default)]
pub struct Slices {
    cuts: Vec<Cut>,
    /// Depths and areas of some spheres, from which the cuts are chosen.
    sample: Vec<[f32; 2]>,
    parts: Vec<SlicedPart>,
    seen: Vec<u32>,
}

/// Some of a scene's splats.
#[derive(Clone, Debug, Default)]
struct SlicedPart {
    /// Those of each slice that are on the screen, in the scene's order.
    slices: Vec<Vec<Boxed>>,
    /// The numbers of one slice's that are to be set up.
    seen: Vec<u32>,
}

/// A splat's number and the blocks under its box: left, top, right, bottom.
type Boxed = (u32, [u16; 4]);

impl Slices {
    /// Number of slices; at least 1.
    pub fn count(&self) -> usize {
        self.cuts.len() + 1
    }

    /// Cuts a frame; `false` if it is not deep enough for two slices.
    pub fn cut(
        &mut self,
        front: &DepthFirst,
        splats: &[VolumeSplat],
        set_up: &SetUpPart,
        live: &LiveBlocks,
    ) -> bool {
        cuts::cuts(front, &mut self.sample, &mut self.cuts);
        if self.cuts.is_empty() {
            return false;
        }
        let Slices { cuts, parts, .. } = self;
        let length = part_length(splats.len()).next_multiple_of(TOGETHER);
        parts.resize_with(splats.len().div_ceil(length), Default::default);
        let groups = front.spheres.groups.par_chunks(length / TOGETHER);
        let work = parts.par_iter_mut().zip(groups).enumerate().with_max_len(1);
        work.for_each(|(number, (part, groups))| {
            let count = length.min(splats.len() - number * length);
            part.slices.resize_with(cuts::MOST + 1, Vec::new);
            part.slices.iter_mut().for_each(Vec::clear);
            let dealing = Dealing {
                projection: &front.projection,
                cuts,
                live,
                first: number * length,
                count,
                groups,
                slices: &mut part.slices,
                decide: &|index| cuts::slice_of_key(cuts, key(splats, index, set_up)),
            };
            if let Err(dealing) = dispatch_vectors(front.vectors, dealing) {
                dealing.run(Portable);
            }
        });
        true
    }

    /// The numbers of a slice's splats that may reach a pixel in work, ascending.
    pub fn seen(&mut self, slice: usize, live: &LiveBlocks) -> &[u32] {
        let each = self.parts.par_iter_mut().with_max_len(1);
        each.for_each(|part| {
            let listed = part.slices[slice].iter();
            let seen = listed.filter(|(_, blocks)| live.any(blocks));
            part.seen.clear();
            part.seen.extend(seen.map(|(index, _)| *index));
        });
        self.seen.clear();
        for part in &self.parts {
            self.seen.extend_from_slice(&part.seen);
        }
        &self.seen
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let part = |part: &SlicedPart| {
            let slices = part.slices.iter().map(Vec::capacity).sum::<usize>();
            slices * size_of::<Boxed>() + part.seen.capacity() * size_of::<u32>()
        };
        let parts = self.parts.iter().map(part).sum::<usize>();
        let sample = self.sample.capacity() * size_of::<[f32; 2]>();
        parts + sample + self.seen.capacity() * size_of::<u32>()
    }
}

/// Deals out spheres to slices.
struct Dealing<'a> {
    projection: &'a SphereProjection,
    cuts: &'a [Cut],
    live: &'a LiveBlocks,
    first: usize,
    count: usize,
    groups: &'a [Spheres],
    slices: &'a mut [Vec<Boxed>],
    /// Says the slice where a depth is too near a cut.
    decide: &'a dyn Fn(u32) -> usize,
}

impl VectorTask for Dealing<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let indices = self.first as u32..(self.first + self.count) as u32;
        let starts = indices.clone().step_by(TOGETHER);
        for (group, start) in self.groups.iter().zip(starts) {
            let seen = self.projection.project(group);
            let blocks = self.live.of_boxes(&seen.bounds);
            let [low, high] = cuts::slices_of_depths(self.cuts, &seen);
            for (k, index) in (start..indices.end).take(TOGETHER).enumerate() {
                // Not by `map`: a closure is not compiled for the vectors' instructions.
                let [left, top] = [blocks[0][k], blocks[1][k]];
                let [right, bottom] = [blocks[2][k], blocks[3][k]];
                // Whatever is certainly behind the eye is culled, as is what lies outside.
                if seen.most[k] < 0.0 || left >= right || top >= bottom {
                    continue;
                }
                let slice = if low[k] == high[k] {
                    low[k] as usize
                } else {
                    (self.decide)(index)
                };
                self.slices[slice].push((index, [left, top, right, bottom]));
            }
        }
    }
}

/// The kernel's sort key of a splat; 0 if it is culled, so that its slice does not matter.
fn key(splats: &[VolumeSplat], index: u32, set_up: &SetUpPart) -> u64 {
    let index = index as usize;
    let mut outcome = [Err(Cull::Near)];
    set_up(index, &splats[index..=index], &mut outcome);
    outcome[0].as_ref().map_or(0, |footprint| footprint.depth)
}

#[cfg(test)]
mod tests;
