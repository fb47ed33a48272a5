//! What becomes of a splat that has no footprint, and of one that vectors leave to the kernel.
//!
//! A vector goes on whatever happens to one of its splats. So the first reason to cull is noted per word, and beside it
//! a doubt: doubles hold the kernel's numbers only within the ranges below, and whatever comes near their ends, or near
//! the half of a last bit, is set up by the kernel itself.

use super::number::Word;
use super::position::COORDINATE;
use super::real::Real;
use super::stages::{SplatLanes, Stages};
use crate::fast::lanes::Lanes;
use splatline::setup::Cull;

/// Depths, in kernel units, that doubles take.
const DEPTHS: [f64; 2] = [1.0 / (1u64 << 30) as f64, (1u64 << 30) as f64];

/// Largest x/z and y/z that doubles take, and smallest but 0.
const RATIOS: [f64; 2] = [(1u64 << 18) as f64, 1.0 / (1u64 << 60) as f64];

/// Variances and determinants below this may have lost terms below the range of doubles: 2^-900.
const LEAST_VARIANCE: f64 = f64::from_bits((1023 - 900) << 52);

/// Splats that distance enlarges by more than 2^20 are in doubt: their determinants might leave the range of doubles.
const LEAST_DISTANCE: f64 = 1.0 / (1u64 << 20) as f64;

/// Exponents of axes, of which products of eight come near the ends of doubles (trained scenes have axes of 2^-40), and
/// of coordinates.
const AXES: [i64; 2] = [-100, 40];
const COORDINATES: [i64; 2] = [-200, 200];

/// Exponents of weights.
const WEIGHTS: [i64; 2] = [-100, 100];

impl<W: Lanes> Stages<'_, W> {
    /// Notes the reason where it holds and no other was noted before.
    #[inline(always)]
    pub fn cull(&self, culled: &mut Word<W>, reason: Cull, truth: W::Truth) {
        let now = self
            .lanes
            .select(*culled, self.lanes.splat(code(reason)), truth);
        self.note(culled, now);
    }

    /// Notes these reasons where no other was noted before.
    #[inline(always)]
    fn note(&self, culled: &mut Word<W>, now: Word<W>) {
        let noted = self.lanes.greater(*culled, self.lanes.splat(0));
        *culled = self.lanes.select(now, *culled, noted);
    }

    /// Leaves only the doubt of before where a reason has been noted since that needed nothing of what is in doubt now.
    #[inline(always)]
    pub fn trust(&self, culled: Word<W>, before: Word<W>) {
        let (lanes, doubt) = (self.lanes, self.reals.doubt);
        let settled = lanes.greater(culled, lanes.splat(0));
        doubt.set(lanes.select(doubt.get(), before, settled));
    }

    /// Notes the reason where it does not hold.
    #[inline(always)]
    pub fn cull_unless(&self, culled: &mut Word<W>, reason: Cull, truth: W::Truth) {
        let now = self
            .lanes
            .select(self.lanes.splat(code(reason)), *culled, truth);
        self.note(culled, now);
    }

    /// Culls where one of some exponents has no place in the packet: where it is not from -512 to 511.
    #[inline(always)]
    pub fn unpackable<const N: usize>(&self, exponents: [Word<W>; N], culled: &mut Word<W>) {
        let lanes = self.lanes;
        let mut outside = lanes.splat(0);
        for exponent in exponents {
            let beyond = lanes.shr_by(lanes.plus(exponent, 512), 10);
            outside = lanes.or(outside, beyond);
        }
        let outside = lanes.greater(outside, lanes.splat(0));
        self.cull(culled, Cull::Degenerate, outside);
    }

    /// All bits where an integer lies outside a range.
    #[inline(always)]
    fn outside(&self, word: Word<W>, [least, most]: [i64; 2]) -> Word<W> {
        let lanes = self.lanes;
        // From the least word on in a circle, so that one comparison sees both ends.
        let from_least = lanes.plus(word, i64::MIN.wrapping_sub(least));
        let outside = lanes.greater(from_least, lanes.splat(i64::MIN + (most - least)));
        lanes.select(lanes.splat(0), lanes.splat(-1), outside)
    }

    /// Puts splats in doubt that vectors do not take: products of their numbers must stay within the range of doubles,
    /// and coordinates be normalised. What is computed of them has no meaning, so that this doubt must stay whatever
    /// culls them: see [`Self::trust`].
    #[inline(always)]
    pub fn doubt_inputs(&self, splats: &SplatLanes<W>) {
        let (lanes, reals) = (self.lanes, self.reals);
        let zero = lanes.splat(0);
        for coordinate in splats.centre {
            let leading = lanes.shr_by(
                lanes.magnitude(coordinate.mantissa),
                i64::from(COORDINATE) - 1,
            );
            let whole = lanes.xor(leading, lanes.splat(1));
            let doubt = lanes.or(whole, self.outside(coordinate.exponent, COORDINATES));
            let nothing = lanes.equal(coordinate.mantissa, zero);
            reals.doubt_where(lanes.select(doubt, zero, nothing));
        }
        for (axis, exponent) in splats.axes.iter().zip(splats.exponents) {
            reals.doubt_where(self.outside(exponent, AXES));
            for part in axis {
                let least = lanes.equal(*part, lanes.splat(i32::MIN.into()));
                reals.doubt_where(lanes.select(zero, lanes.splat(-1), least));
            }
        }
        let doubt = self.outside(splats.weight.exponent, WEIGHTS);
        let nothing = lanes.equal(splats.weight.mantissa, zero);
        reals.doubt_where(lanes.select(doubt, zero, nothing));
    }

    /// Puts splats in doubt that lie so far out that products of what follows might leave the range of doubles.
    #[inline(always)]
    pub fn doubt_ranges(&self, z: Real<W>, on_plane: &[Real<W>; 2]) {
        let (lanes, reals) = (self.lanes, self.reals);
        reals.doubt_unless_greater(z.0, DEPTHS[0]);
        reals.doubt_unless_less(z.0, DEPTHS[1]);
        for ratio in on_plane {
            let magnitude = reals.magnitude(*ratio).0;
            reals.doubt_unless_less(magnitude, RATIOS[0]);
            let nothing = reals.is_zero(*ratio);
            let magnitude = lanes.select(magnitude, reals.constant(1.0), nothing);
            reals.doubt_unless_greater(magnitude, RATIOS[1]);
        }
    }

    /// Puts splats in doubt whose variances come near the end of the range of doubles, 0 included.
    #[inline(always)]
    pub fn doubt_unless_large<const N: usize>(&self, variances: [Real<W>; N]) {
        for variance in variances {
            self.reals.doubt_unless_greater(variance.0, LEAST_VARIANCE);
        }
    }

    /// Puts splats in doubt that distance enlarges so much that their determinants might leave the range of doubles.
    #[inline(always)]
    pub fn doubt_unless_near(&self, distance: Real<W>) {
        self.reals.doubt_unless_greater(distance.0, LEAST_DISTANCE);
    }
}

/// One more than the reason's place in [`Cull::ALL`].
pub const fn code(reason: Cull) -> i64 {
    reason.place() as i64 + 1
}
