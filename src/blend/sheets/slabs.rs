//! Which slab a splat belongs to: two ways to cut space into sheets.

use crate::math::{Product, SoftFloat, shift_round, square_root, sum_of_products};
use crate::splat::Axis;
use crate::view::View;
use fixed::types::{I2F30, I8F24};

/// The axis of the volume along which axis-aligned slabs are stacked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facing {
    /// 0, 1 or 2.
    pub axis: usize,
    /// Does the coordinate grow away from the eye?
    pub ascending: bool,
}

impl Facing {
    /// The axis most parallel to `direction` (from the eye into the volume, Q1.30, any length); the first of equals.
    ///
    /// For a parallel projection that is the third row of the view's rotation, otherwise the direction from the eye to
    /// the volume's centre.
    pub fn new(direction: [I2F30; 3]) -> Facing {
        let mut axis = 0;
        for other in 1..3 {
            let [a, b] = [axis, other].map(|i: usize| direction[i].to_bits().unsigned_abs());
            if b > a {
                axis = other;
            }
        }
        Facing {
            axis,
            ascending: direction[axis] >= I2F30::ZERO,
        }
    }

    /// The direction in which a parallel view looks.
    pub fn of_view<P>(view: &View<P>) -> Facing {
        Facing::new(view.rotation[2])
    }
}

/// Slabs perpendicular to an axis of the volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisSlabs {
    /// The axis and its sense.
    pub facing: Facing,
    /// The coordinate at which slab 0 begins, Q7.24.
    pub first: I8F24,
    /// Slabs per scene unit, UQ16.16.
    pub per_unit: u32,
}

impl AxisSlabs {
    /// Number of a centre's slab, growing away from the eye; saturates at the ends of `i32`.
    pub fn slab(&self, centre: [SoftFloat; 3]) -> i32 {
        let coordinate = centre[self.facing.axis % 3].to_fixed(24);
        let distance = coordinate.saturating_sub(self.first.to_bits().into());
        // Q.24 times UQ16.16 does not fit 64 bits.
        let slab = ((i128::from(distance) * i128::from(self.per_unit)) >> 40)
            .clamp(i32::MIN.into(), i32::MAX.into()) as i32;
        if self.facing.ascending {
            slab
        } else {
            slab.saturating_neg()
        }
    }
}

/// Slabs parallel to the image plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DepthSlabs {
    /// Depth at which slab 0 begins, scene units, UQ9.23 as [`depth::fixed`](crate::footprint::depth::fixed) gives it.
    pub nearest: u32,
    /// Slabs per scene unit, UQ16.16.
    pub per_unit: u32,
}

/// Standard deviations of depth beyond which a kernel is not cut any more: 3 leave 0.3 % in the outermost parts.
const REACH: i64 = 3;

impl DepthSlabs {
    /// Number of the slab that holds `depth` (UQ9.23); nearer depths count to slab 0.
    pub fn slab(&self, depth: u32) -> u32 {
        (self.place(depth) >> 16).min(u32::MAX.into()) as u32
    }

    /// First and last slab that a kernel at `depth` with a standard deviation of `spread` scene units along the view
    /// reaches.
    pub fn reach(&self, depth: u32, spread: SoftFloat) -> (u32, u32) {
        let half = REACH.saturating_mul(self.in_slabs(spread));
        let place = self.place(depth) as i64;
        let slab = |place: i64| (place >> 16).clamp(0, u32::MAX.into()) as u32;
        (
            slab(place.saturating_sub(half)),
            slab(place.saturating_add(half)),
        )
    }

    /// The share of such a kernel that lies in `slab`, UQ1.16: its Gaussian integrated over the slab's depth.
    ///
    /// The shares of the slabs of [`reach`](Self::reach) sum to exactly 1: the outermost ones take the tails.
    pub fn fraction_in(&self, slab: u32, depth: u32, spread: SoftFloat) -> u32 {
        let (first, last) = self.reach(depth, spread);
        let spread = self.in_slabs(spread).max(1);
        let place = self.place(depth) as i64;
        let below = |edge: u32| match edge {
            edge if edge <= first => 0,
            edge if edge > last => 1 << 16,
            edge => normal_integral(((i64::from(edge) << 16).saturating_sub(place) << 12) / spread),
        };
        (below(slab.saturating_add(1)) - below(slab)).clamp(0, 1 << 16) as u32
    }

    /// Distance behind the first slab's beginning in slabs, UQ.16.
    fn place(&self, depth: u32) -> u64 {
        u64::from(depth.saturating_sub(self.nearest)).wrapping_mul(self.per_unit.into()) >> 23
    }

    /// A length in slabs, Q.16, at most 2^40.
    fn in_slabs(&self, length: SoftFloat) -> i64 {
        let slabs = SoftFloat::from_wide(self.per_unit.into(), -16, 31);
        length.times(slabs).to_fixed(16).clamp(0, 1 << 40)
    }
}

/// Standard deviation of a splat along the view: sqrt(sum_k (w . a_k)^2) with the third row w of the view's rotation,
/// scene units, 24 bits rounded to nearest; sums are aligned to their largest term.
pub fn depth_spread<P>(view: &View<P>, axes: &[Axis; 3]) -> SoftFloat {
    let parts = axes.map(|axis| {
        let terms = [0, 1, 2].map(|i| Product {
            value: i64::from(view.rotation[2][i].to_bits())
                * i64::from(axis.mantissa[i].max(-i32::MAX)),
            exponent: axis.exponent.clamp(-512, 511) - 30,
            length: 61,
        });
        sum_of_products(terms, 31)
    });
    square_root(sum_of_products(parts.map(|part| part.times(part)), 31), 24)
}

/// Values of the normal distribution's integral on [-4, 4].
const STEPS: usize = 256;

/// The normal distribution's integral up to t (Q.12), UQ1.16; linear between the entries of a table. Error below 3
/// units of the last place: at most 1.94 of the chord, and half a unit each where entry and result are rounded.
fn normal_integral(t: i64) -> i64 {
    let place = t.saturating_add(4 << 12).clamp(0, 8 << 12);
    let index = (place >> 7) as usize;
    let rest = place & 127;
    let low = i64::from(NORMAL.get(index).copied().unwrap_or(1 << 16));
    let high = i64::from(NORMAL.get(index + 1).copied().unwrap_or(1 << 16));
    low + shift_round((high - low) * rest, 7)
}

/// UQ1.16 at t = -4 + i/32, by Simpson's rule on exp(-t^2/2) and normalised to end at 1.
static NORMAL: [u32; STEPS + 1] = {
    let mut sums = [0u64; STEPS + 1];
    let mut i = 0;
    while i < STEPS {
        let density = density_at(2 * i) + 4 * density_at(2 * i + 1) + density_at(2 * i + 2);
        sums[i + 1] = sums[i] + density;
        i += 1;
    }
    let mut table = [0; STEPS + 1];
    let mut i = 0;
    while i <= STEPS {
        table[i] = (((sums[i] << 16) + sums[STEPS] / 2) / sums[STEPS]) as u32;
        i += 1;
    }
    table
};

/// exp(-t^2/2) at t = -4 + i/64, UQ0.31: exp(-x) = exp(-x/16)^16 with the series of exp.
const fn density_at(i: usize) -> u64 {
    let t = i as i128 - 256;
    let x = (t * t) << (31 - 12 - 1 - 4); // t^2/2/16, Q0.31
    let mut term = 1i128 << 31;
    let mut sum = term;
    let mut n = 1;
    while n < 12 {
        term = -(term * x / n) >> 31;
        sum += term;
        n += 1;
    }
    let mut squared = 0;
    while squared < 4 {
        sum = (sum * sum) >> 31;
        squared += 1;
    }
    sum as u64
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use fixed::types::I2F30;

    /// The integral by the trapezoidal rule in double precision, normalised to [-4, 4] as the table is. Between entries
    /// as well.
    #[test]
    fn the_normal_integral_is_close_everywhere() {
        let density = |t: f64| (-t * t / 2.0).exp();
        let step = 1.0 / 4096.0;
        let mut sums = std::vec![0.0];
        for index in 0..8 << 12 {
            let t = -4.0 + f64::from(index) * step;
            let last = sums.last().copied().unwrap();
            sums.push(last + (density(t) + density(t + step)) / 2.0);
        }
        let whole = sums.last().copied().unwrap();
        for (index, sum) in sums.iter().enumerate() {
            let exact = sum / whole * 65536.0;
            let found = normal_integral(index as i64 - (4 << 12)) as f64;
            assert!((found - exact).abs() < 3.0, "{index}: {found}, {exact}");
        }
        for index in 0..=2 * STEPS {
            let exact = density(-4.0 + index as f64 / 64.0) * 2f64.powi(31);
            let found = density_at(index) as f64;
            assert!((found - exact).abs() < 64.0, "{index}: {found}, {exact}");
        }
        assert_eq!(normal_integral(-1 << 40), 0);
        assert_eq!(normal_integral(1 << 40), 1 << 16);
    }
    #[test]
    fn spreads_are_these() {
        let mut seed = 1u64;
        let mut next = || {
            seed = seed
                .wrapping_mul(0x5851_f42d_4c95_7f2d)
                .wrapping_add(0x1405_7b7e_f767_814f);
            (seed >> 32) as i32
        };
        let spreads = (0..1000).flat_map(|_| {
            let mut view = crate::setup::tests::view(crate::view::Eye::ORIGIN, [1; 2]);
            // Axes that lie almost across the view: what their sums' windows cut is seen.
            let [x, y] = [next() >> 1, next()];
            view.rotation[2] = [x, 9 - x, x & 31].map(I2F30::from_bits);
            let axes = [y, y / 2, y / 3].map(|y| Axis {
                mantissa: [y, y ^ 5, x & 7],
                exponent: 0,
            });
            let SoftFloat { mantissa, exponent } = depth_spread(&view, &axes);
            [mantissa as u64, exponent as u64]
        });
        assert_eq!(crate::digest(spreads), 811_813_902_195_668_363);
    }
}
