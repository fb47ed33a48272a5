//! Setup of many splats at once, bit for bit the kernel's [`setup`].
//!
//! ```text
//! splats, eight at a time -> words -> stages (in the kernel's order and with its names) -> footprints
//! ```
//!
//! Setup is 60 normalisations a splat, each a count of leading zeros and two shifts by amounts that no two splats share. In double
//! precision they are an addition and a mask (`real.rs`), for four or eight splats without a branch. What vectors do not cover is left to the
//! kernel: parallel projection, splats far from unit size, and those of which the last bit is in doubt.

mod doubt;
pub mod number;
mod position;
pub(super) mod real;
mod stages;
mod surface;

pub use surface::SurfaceOutcome;

use super::lanes::{Doubles, VectorLevel, VectorTask, dispatch_vectors};
use number::{Arithmetic, Number};
use real::{Real, Reals};
use splatline::footprint::{Conic, Footprint, Ldl};
use splatline::format::{Design, RuntimeWidths, Widths};
use splatline::math::SoftFloat;
use splatline::rules::{Cutoff, Rules};
use splatline::setup::{Cull, axis_bits, colour, setup};
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Projection, View, round_entry};
use stages::{Footprints, SplatLanes, Stages};
use std::cell::Cell;

/// What setup makes of a splat.
pub type Outcome = Result<Footprint, Cull>;

/// A kind of splat that vectors set up: how the kernel sets up one, and what differs between kinds when vectors set up many.
pub trait Batched: Sized {
    /// What setup makes of one.
    type Outcome;
    /// What setup makes of a vector's splats, as lists.
    type Lists;

    /// By the kernel.
    fn set_up_alone<D: Design>(&self, design: D, view: &View, rules: &Rules) -> Self::Outcome;

    /// What vectors read.
    fn parts(&self) -> SplatFields;

    /// By vectors.
    fn set_up_together<L: Doubles>(stages: &Stages<L>, words: &SplatLanes<L>) -> Self::Lists;

    /// Is the `k`th of its vector in doubt, so that the kernel sets it up?
    fn is_in_doubt(lists: &Self::Lists, k: usize) -> bool;

    /// The outcome of this splat, the `k`th of its vector.
    fn outcome(&self, lists: &Self::Lists, k: usize, widths: &Widths) -> Self::Outcome;
}

/// Setup of `splats` into as many places of `outcomes`.
pub fn set_up<D: Design, S: Batched>(
    design: D,
    view: &View,
    rules: &Rules,
    splats: &[S],
    outcomes: &mut [S::Outcome],
    choice: VectorLevel,
) {
    // Widths as values: constants would gain little here, and one compiled copy serves all designs.
    let left = match RuntimeWidths::new(design.widths()) {
        Ok(widths) if covers(view, rules) => {
            let batch = SetupBatch {
                design: widths,
                view,
                rules,
                splats,
                outcomes,
            };
            let done = dispatch_vectors(choice, batch);
            done.err().map(|batch| batch.outcomes)
        }
        _ => Some(outcomes),
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
    fn run<L: Doubles>(self, lanes: L) {
        let widths = self.design.widths();
        let math = Arithmetic { lanes };
        let doubt = Cell::new(math.splat(0));
        let reals = Reals {
            words: math,
            doubt: &doubt,
        };
        let stages = Stages {
            math,
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
            doubt.set(math.splat(0));
            let lists = S::set_up_together(&stages, &read(lanes, splats.iter().map(S::parts)));
            for ((splat, outcome), k) in splats.iter().zip(outcomes).zip(0..8) {
                *outcome = if S::is_in_doubt(&lists, k) {
                    splat.set_up_alone(self.design, self.view, self.rules)
                } else {
                    splat.outcome(&lists, k, &widths)
                };
            }
        }
    }
}

impl Batched for VolumeSplat {
    type Outcome = Outcome;
    type Lists = Lists;

    fn set_up_alone<D: Design>(&self, design: D, view: &View, rules: &Rules) -> Outcome {
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
    fn set_up_together<L: Doubles>(stages: &Stages<L>, words: &SplatLanes<L>) -> Lists {
        Lists::new(stages.math.lanes, &stages.setup(words))
    }

    #[inline(always)]
    fn is_in_doubt(lists: &Lists, k: usize) -> bool {
        lists.doubt[k] != 0
    }

    #[inline(always)]
    fn outcome(&self, lists: &Lists, k: usize, widths: &Widths) -> Outcome {
        lists.reason(k)?;
        Ok(lists.footprint(k, colour(widths, self.colour)))
    }
}

/// A weight as a double; no number if it is not 0 and outside the range of doubles that setup takes.
#[inline(always)]
fn weight(number: SoftFloat) -> f64 {
    let power = (1023 + i64::from(number.exponent)) << 52;
    match (number.mantissa, number.exponent) {
        (0, _) => 0.0,
        (mantissa, -100..=100) => f64::from(mantissa) * f64::from_bits(power as u64),
        _ => f64::NAN,
    }
}

/// Splats to words.
#[inline(always)]
fn read<L: Doubles>(lanes: L, splats: impl Iterator<Item = SplatFields>) -> SplatLanes<L> {
    let mut lists = [[0; 8]; 19];
    for (k, splat) in splats.take(L::WIDE).enumerate() {
        let [a, b, c] = splat.axes;
        let parts = [a.mantissa, b.mantissa, c.mantissa];
        for i in 0..3 {
            lists[i][k] = splat.centre[i].mantissa.into();
            lists[16 + i][k] = splat.centre[i].exponent.into();
            for axis in 0..3 {
                lists[3 + 3 * axis + i][k] = parts[axis][i].into();
            }
            lists[12 + i][k] = splat.axes[i].exponent.into();
        }
        lists[15][k] = weight(splat.weight).to_bits() as i64;
    }
    let mut words = [lanes.wide_splat(0); 19];
    for (word, list) in words.iter_mut().zip(&lists) {
        *word = lanes.wide_load(list);
    }
    let [
        x,
        y,
        z,
        ax,
        ay,
        az,
        bx,
        by,
        bz,
        cx,
        cy,
        cz,
        a,
        b,
        c,
        weight,
        x_power,
        y_power,
        z_power,
    ] = words;
    let number = |mantissa, exponent| Number { mantissa, exponent };
    SplatLanes {
        centre: [number(x, x_power), number(y, y_power), number(z, z_power)],
        axes: [[ax, ay, az], [bx, by, bz], [cx, cy, cz]],
        exponents: [a, b, c],
        weight: Real(weight),
    }
}

/// A word's splats.
#[inline(always)]
fn list<L: Doubles>(lanes: L, word: L::Word) -> [i64; 8] {
    let mut list = [0; 8];
    lanes.wide_store(&mut list, word);
    list
}

/// Mantissas and exponents of a number's splats.
#[inline(always)]
fn lists<L: Doubles>(lanes: L, number: Number<L>) -> [[i64; 8]; 2] {
    [list(lanes, number.mantissa), list(lanes, number.exponent)]
}

/// Words to footprints.
pub struct Lists {
    culled: [i64; 8],
    doubt: [i64; 8],
    depth: [i64; 8],
    centre: [[i64; 8]; 2],
    first: [[i64; 8]; 2],
    last: [[i64; 8]; 2],
    /// Mantissas and exponents of the LDL form's factors, in the order of [`Ldl`].
    ldl: [[[i64; 8]; 2]; 4],
    conic: [[i64; 8]; 3],
    conic_exponent: [i64; 8],
    cutoff: [i64; 8],
    peak: [i64; 8],
}

impl Lists {
    #[inline(always)]
    fn new<L: Doubles>(lanes: L, footprints: &Footprints<L>) -> Self {
        let Footprints {
            centre: [u, v],
            first: [left, top],
            last: [right, bottom],
            ldl: [horizontal, squared_width, shear, vertical],
            conic: [a, b, c],
            ..
        } = *footprints;
        Lists {
            culled: list(lanes, footprints.culled),
            doubt: list(lanes, footprints.doubt),
            depth: list(lanes, footprints.depth),
            centre: [list(lanes, u), list(lanes, v)],
            first: [list(lanes, left), list(lanes, top)],
            last: [list(lanes, right), list(lanes, bottom)],
            ldl: [
                lists(lanes, horizontal),
                lists(lanes, squared_width),
                lists(lanes, shear),
                lists(lanes, vertical),
            ],
            conic: [list(lanes, a), list(lanes, b), list(lanes, c)],
            conic_exponent: list(lanes, footprints.conic_exponent),
            cutoff: list(lanes, footprints.cutoff),
            peak: list(lanes, footprints.peak),
        }
    }

    /// Why splat `k` is culled, if it is.
    #[inline(always)]
    fn reason(&self, k: usize) -> Result<(), Cull> {
        match (self.culled[k] as usize).checked_sub(1) {
            Some(reason) => Err(Cull::ALL.get(reason).copied().unwrap_or(Cull::Degenerate)),
            None => Ok(()),
        }
    }

    /// The footprint of splat `k`.
    #[inline(always)]
    fn footprint(&self, k: usize, colour: [u32; 3]) -> Footprint {
        let scaled = |[mantissa, exponent]: &[[i64; 8]; 2]| SoftFloat {
            mantissa: mantissa[k] as i32,
            exponent: exponent[k] as i32,
        };
        let [horizontal, squared_width, shear, vertical] = &self.ldl;
        Footprint {
            depth: self.depth[k] as u64,
            centre: [self.centre[0][k], self.centre[1][k]],
            first: [self.first[0][k] as u16, self.first[1][k] as u16],
            end: [self.last[0][k] as u16, self.last[1][k] as u16],
            ldl: Ldl {
                horizontal: scaled(horizontal),
                squared_width: scaled(squared_width),
                shear: scaled(shear),
                vertical: scaled(vertical),
            },
            conic: Conic {
                mantissa: [0, 1, 2].map(|i| self.conic[i][k] as i32),
                exponent: self.conic_exponent[k] as i32,
            },
            cutoff: self.cutoff[k] as u32,
            opacity: self.peak[k] as u32,
            colour,
        }
    }
}

#[cfg(test)]
mod tests;
