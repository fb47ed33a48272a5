//! Setup of many splats at once, bit for bit the kernel's [`setup`].
//!
//! ```text
//! splats, eight at a time -> words -> stages (in the kernel's order and with its names) -> footprints
//! ```
//!
//! Setup is 60 normalisations a splat, each a count of leading zeros and two shifts by amounts that no two splats
//! share. In double precision they are an addition and a mask (`real.rs`), for four or eight splats without a branch.
//! What vectors do not cover is left to the kernel: parallel projection, splats far from unit size, and those of which
//! the last bit is in doubt.

mod doubt;
pub mod number;
mod position;
pub(super) mod real;
mod stages;
mod surface;

pub use surface::SurfaceOutcome;

use super::lanes::{Lanes, VectorLevel, VectorTask, dispatch_vectors};
use number::{Number, Word};
use real::Real;
use real::Reals;
use splatline::footprint::{Conic, Footprint, Ldl};
use splatline::format::{Design, RuntimeWidths, Widths};
use splatline::math::SoftFloat;
use splatline::rules::{Cutoff, Rules};
use splatline::setup::{Cull, axis_bits, colour, setup};
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Projection, View, round_entry};
use stages::{ProjectedWords, SplatLanes, Stages};
use std::cell::Cell;

/// What setup makes of a splat.
pub type Outcome = Result<Footprint, Cull>;

/// A kind of splat that vectors set up: how the kernel sets up one, and what differs between kinds when vectors set up
/// many.
pub trait Batched: Sized {
    /// What setup makes of one.
    type Outcome;
    /// What setup makes of a vector's splats, as lists.
    type Lists;

    /// By the kernel.
    fn set_up_alone(&self, design: RuntimeWidths, view: &View, rules: &Rules) -> Self::Outcome;

    /// What vectors read.
    fn parts(&self) -> SplatFields;

    /// By vectors.
    fn set_up_together<L: Lanes>(stages: &Stages<L>, words: &SplatLanes<L>) -> Self::Lists;

    /// Writes the outcome of this splat, the `k`th of its vector, in place: what is returned is made elsewhere and
    /// copied. `false` if it is in doubt, so that the kernel sets it up.
    fn write(&self, lists: &Self::Lists, k: usize, widths: &Widths, to: &mut Self::Outcome)
    -> bool;
}

/// Setup of `splats` into as many places of `outcomes`, by such vectors or the kernel.
pub fn set_up<S: Batched>(
    design: RuntimeWidths,
    view: &View,
    rules: &Rules,
    splats: &[S],
    outcomes: &mut [S::Outcome],
    choice: Option<VectorLevel>,
) {
    let left = if let Some(choice) = choice
        && covers(view, rules)
    {
        let batch = SetupBatch {
            design,
            view,
            rules,
            splats,
            outcomes,
        };
        let done = dispatch_vectors(choice, batch);
        done.err().map(|batch| batch.outcomes)
    } else {
        Some(outcomes)
    };
    for (splat, outcome) in splats.iter().zip(left.into_iter().flatten()) {
        *outcome = splat.set_up_alone(design, view, rules);
    }
}

/// Can vectors set up under this view and these rules?
fn covers(view: &View, rules: &Rules) -> bool {
    // Focal lengths of 2^-20 to 2^30 pixels, a filter of 2^-100 to 2^30, samples 2^-30 to 2^30 apart.
    let between = |number: SoftFloat, least: i32, most: i32| {
        number.mantissa > 0 && (least..most).contains(&number.leading())
    };
    let by_opacity = rules.cutoff == Cutoff::Opacity;
    let gaussian = rules.kernel == splatline::kernel::Kernel::Gaussian;
    view.projection == Projection::Perspective
        && view.focal.into_iter().all(|focal| between(focal, -20, 30))
        && view
            .principal
            .iter()
            .all(|p| p.to_bits().unsigned_abs() < 1 << 57)
        && position::covers(view)
        && (rules.low_pass.mantissa == 0 || between(rules.low_pass, -100, 30))
        && (rules.spacing.mantissa <= 0 || between(rules.spacing, -30, 30))
        && (gaussian || !by_opacity)
        && (rules.alpha_min > 1 || !by_opacity)
}

/// What vectors read of a splat.
#[derive(Clone, Copy)]
pub struct SplatFields {
    centre: [SoftFloat; 3],
    axes: [Axis; 3],
    weight: SoftFloat,
}

struct SetupBatch<'a, S: Batched> {
    design: RuntimeWidths,
    view: &'a View,
    rules: &'a Rules,
    splats: &'a [S],
    outcomes: &'a mut [S::Outcome],
}

impl<S: Batched> VectorTask for SetupBatch<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let widths = self.design.widths();
        let doubt = Cell::new(lanes.splat(0));
        let reals = Reals {
            lanes,
            doubt: &doubt,
        };
        let stages = Stages {
            lanes,
            reals,
            widths,
            rotation: self.view.rotation.map(|row| {
                row.map(|entry| {
                    let entry = round_entry(entry, axis_bits(&widths));
                    reals.constant(entry as f64)
                })
            }),
            view: self.view,
            rules: self.rules,
        };
        let groups = self.splats.chunks(L::WIDE);
        for (splats, outcomes) in groups.zip(self.outcomes.chunks_mut(L::WIDE)) {
            if splats.len() < L::WIDE {
                for (splat, outcome) in splats.iter().zip(outcomes) {
                    *outcome = splat.set_up_alone(self.design, self.view, self.rules);
                }
                continue;
            }
            doubt.set(lanes.splat(0));
            let lists = S::set_up_together(&stages, &read(lanes, splats));
            for ((splat, outcome), k) in splats.iter().zip(outcomes).zip(0..8) {
                if !splat.write(&lists, k, &widths, outcome) {
                    *outcome = splat.set_up_alone(self.design, self.view, self.rules);
                }
            }
        }
    }
}

impl Batched for VolumeSplat {
    type Outcome = Outcome;
    type Lists = Lists;

    fn set_up_alone(&self, design: RuntimeWidths, view: &View, rules: &Rules) -> Outcome {
        setup(design, view, rules, self)
    }

    #[inline(always)]
    fn parts(&self) -> SplatFields {
        SplatFields {
            centre: self.centre,
            axes: self.axes,
            weight: self.weight,
        }
    }

    #[inline(always)]
    fn set_up_together<L: Lanes>(stages: &Stages<L>, words: &SplatLanes<L>) -> Lists {
        stages.setup(words)
    }

    #[inline(always)]
    fn write(&self, lists: &Lists, k: usize, widths: &Widths, to: &mut Outcome) -> bool {
        match lists.reason(k) {
            _ if lists.is_in_doubt(k) => return false,
            Ok(()) => *to = Ok(lists.footprint(k, colour(widths, self.colour))),
            Err(reason) => *to = Err(reason),
        }
        true
    }
}

/// Splats, as many as a vector has words, to words.
#[inline(always)]
fn read<L: Lanes, S: Batched>(lanes: L, splats: &[S]) -> SplatLanes<L> {
    let [ax, ay, az, a] = read_axis(lanes, splats, 0);
    let [bx, by, bz, b] = read_axis(lanes, splats, 1);
    let [cx, cy, cz, c] = read_axis(lanes, splats, 2);
    let [x, x_power, y, y_power] = lanes.columns(|k| {
        let [x, y, _] = splats[k].parts().centre;
        [x.mantissa, x.exponent, y.mantissa, y.exponent]
    });
    let [z, z_power, weight, weight_power] = lanes.columns(|k| {
        let SplatFields { centre, weight, .. } = splats[k].parts();
        let z = centre[2];
        [z.mantissa, z.exponent, weight.mantissa, weight.exponent]
    });
    let number = |mantissa, exponent| Number { mantissa, exponent };
    SplatLanes {
        centre: [number(x, x_power), number(y, y_power), number(z, z_power)],
        axes: [[ax, ay, az], [bx, by, bz], [cx, cy, cz]],
        exponents: [a, b, c],
        weight: number(weight, weight_power),
    }
}

/// Mantissas and exponents of one of the axes.
#[inline(always)]
fn read_axis<L: Lanes, S: Batched>(lanes: L, splats: &[S], which: usize) -> [L::Word; 4] {
    lanes.columns(|k| {
        let Axis { mantissa, exponent } = splats[k].parts().axes[which];
        let [x, y, z] = mantissa;
        [x, y, z, exponent]
    })
}

/// A vector's footprints, without their colours, as lists.
pub struct Lists {
    depth: [i64; 8],
    centre: [[i64; 8]; 2],
    /// First column and row, and one past the last ones.
    box_of_pixels: [[i32; 4]; 8],
    /// Mantissas and exponents of the LDL form's factors, two and two, in the order of [`Ldl`].
    ldl: [[[i32; 4]; 8]; 2],
    /// Mantissas and exponent.
    conic: [[i32; 4]; 8],
    /// Cut-off, opacity, reason of a cull, and 1 for doubt.
    rest: [[i32; 4]; 8],
}

impl<W: Lanes> Stages<'_, W> {
    /// Lists of what setup computed: bounds (left, top, right, bottom), the factors of the LDL form in the order of
    /// [`Ldl`], mantissas and exponent of the conic; cut-off, peak and reason of a cull. Nothing must come in doubt
    /// later.
    #[inline(always)]
    fn lists(
        &self,
        projected: &ProjectedWords<W>,
        bounds: [Word<W>; 4],
        ldl: [Real<W>; 4],
        conic: [Word<W>; 4],
        [cutoff, peak, culled]: [Word<W>; 3],
    ) -> Lists {
        let lanes = self.lanes;
        let certain = lanes.equal(self.reals.doubt.get(), lanes.splat(0));
        let doubt = lanes.select(lanes.splat(1), lanes.splat(0), certain);
        let pair = |a: Number<W>, b: Number<W>| [a.mantissa, a.exponent, b.mantissa, b.exponent];
        let [horizontal, squared_width, shear, vertical] = self.packed(ldl);
        let [u, v] = projected.centre;
        Lists {
            depth: lanes.list(projected.key),
            centre: [lanes.list(u), lanes.list(v)],
            box_of_pixels: lanes.rows(bounds),
            ldl: [
                lanes.rows(pair(horizontal, squared_width)),
                lanes.rows(pair(shear, vertical)),
            ],
            conic: lanes.rows(conic),
            rest: lanes.rows([cutoff, peak, culled, doubt]),
        }
    }
}

impl Lists {
    /// Is splat `k` in doubt?
    #[inline(always)]
    fn is_in_doubt(&self, k: usize) -> bool {
        self.rest[k][3] != 0
    }

    /// Why splat `k` is culled, if it is.
    #[inline(always)]
    fn reason(&self, k: usize) -> Result<(), Cull> {
        match (self.rest[k][2] as usize).checked_sub(1) {
            Some(reason) => Err(Cull::ALL.get(reason).copied().unwrap_or(Cull::Degenerate)),
            None => Ok(()),
        }
    }

    /// The footprint of splat `k`.
    #[inline(always)]
    fn footprint(&self, k: usize, colour: [u32; 3]) -> Footprint {
        let number = |mantissa, exponent| SoftFloat { mantissa, exponent };
        let [left, top, right, bottom] = self.box_of_pixels[k];
        let [horizontal, below_horizontal, width, below_width] = self.ldl[0][k];
        let [shear, below_shear, vertical, below_vertical] = self.ldl[1][k];
        let [a, b, c, exponent] = self.conic[k];
        let [cutoff, opacity, ..] = self.rest[k];
        Footprint {
            depth: self.depth[k] as u64,
            centre: [self.centre[0][k], self.centre[1][k]],
            first: [left as u16, top as u16],
            end: [right as u16, bottom as u16],
            ldl: Ldl {
                horizontal: number(horizontal, below_horizontal),
                squared_width: number(width, below_width),
                shear: number(shear, below_shear),
                vertical: number(vertical, below_vertical),
            },
            conic: Conic {
                mantissa: [a, b, c],
                exponent,
            },
            cutoff: cutoff as u32,
            opacity: opacity as u32,
            colour,
        }
    }
}

#[cfg(test)]
mod tests;
