//! Footprint shapes and distance scaling in double precision, from the papers' formulas.
//!
//! Shapes are functions of the radial index with peak 1 and unit variance per axis, see [`Kernel`].

use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

use super::jacobian::Jacobian;
use crate::rules::{Kernel, Rules};

/// Crawfis and Max, Texture Splats (1993): the knot, the end and the first piece of the cubic spline.
const KNOT: f64 = 0.88175584;
const END: f64 = 1.5556228;

/// Steps of the numerical integrals over the spline.
const STEPS: usize = 400;

/// Points of the sampled footprint of the spline, over its radius.
const SAMPLES: usize = 2048;

/// The spline's footprint: what follows from integrating it.
struct Spline {
    /// Variance per axis, square sample spacings.
    variance: f64,
    /// Radial index at which it ends.
    end: f64,
    /// Integral of the profile over the radial index.
    integral: f64,
    /// The profile at distances i / SAMPLES of the radius.
    profile: Vec<f64>,
}

static SPLINE: LazyLock<Spline> = LazyLock::new(Spline::new);

impl Spline {
    fn new() -> Spline {
        let midpoint = |i: usize| (i as f64 + 0.5) / STEPS as f64;
        let moment = |power: i32| -> f64 {
            let sum: f64 = (0..STEPS)
                .map(|i| END * midpoint(i))
                .map(|d| d.powi(power) * spline(d))
                .sum();
            4.0 * PI * sum * END / STEPS as f64
        };
        let mass = moment(2);
        let variance = moment(4) / 3.0 / mass;
        let line_integral = |distance: f64| -> f64 {
            let length = (END * END - distance * distance).max(0.0).sqrt();
            let along = |i| (distance * distance + (length * midpoint(i)).powi(2)).sqrt();
            2.0 * (0..STEPS).map(|i| spline(along(i))).sum::<f64>() * length / STEPS as f64
        };
        let peak = line_integral(0.0);
        let profile = (0..=SAMPLES + 1)
            .map(|i| line_integral(END * i as f64 / SAMPLES as f64) / peak)
            .collect();
        Spline {
            variance,
            end: END * END / variance,
            integral: mass / (PI * variance * peak),
            profile,
        }
    }

    /// Linear between samples over the distance: 2048 of them are exact to 2e-7.
    fn at(&self, radial_index: f64) -> f64 {
        let place = (radial_index * self.variance).sqrt() / END * SAMPLES as f64;
        let index = (place as usize).min(SAMPLES);
        let [low, high] = [self.profile[index], self.profile[index + 1]];
        low + (high - low) * (place - index as f64)
    }
}

/// The cubic spline; its second piece continues value and slope and ends with both 0.
fn spline(distance: f64) -> f64 {
    let first = |d: f64| 0.557526 - 1.157743 * d * d + 0.671033 * d * d * d;
    if distance < KNOT {
        return first(distance);
    }
    if distance >= END {
        return 0.0;
    }
    let (value, slope) = (
        first(KNOT),
        -2.0 * 1.157743 * KNOT + 3.0 * 0.671033 * KNOT * KNOT,
    );
    let span = END - KNOT;
    let quadratic = -(3.0 * value + 2.0 * slope * span) / (span * span);
    let cubic = (2.0 * value + slope * span) / span.powi(3);
    let t = distance - KNOT;
    value + t * (slope + t * (quadratic + t * cubic))
}

impl Kernel {
    /// The radial index at which the shape itself ends; none for the Gaussian.
    pub fn end(self) -> Option<f64> {
        match self {
            Kernel::Gaussian => None,
            Kernel::Cubic => Some(SPLINE.end),
            Kernel::Quadratic => Some(6.0),
            Kernel::Disc => Some(4.0),
        }
    }

    /// The shape at a radial index before its end.
    pub fn at(self, radial_index: f64) -> f64 {
        match self {
            Kernel::Gaussian => (-0.5 * radial_index).exp(),
            Kernel::Cubic => SPLINE.at(radial_index),
            Kernel::Quadratic => 1.0 - radial_index / 6.0,
            Kernel::Disc => 1.0,
        }
    }

    /// Peak of the footprint of unit volume, relative to the Gaussian's 1 / (2 pi sqrt(det)).
    pub fn relative_peak(self) -> f64 {
        match self {
            Kernel::Gaussian => 1.0,
            Kernel::Cubic => 2.0 / SPLINE.integral,
            Kernel::Quadratic => 2.0 / 3.0,
            Kernel::Disc => 0.5,
        }
    }

    /// Peak of a footprint of unit volume and variance `variance` on both axes.
    pub fn circular_peak(self, variance: f64) -> f64 {
        self.relative_peak() / (TAU * variance)
    }
}

/// d/k (\[SWAN\] 4.3): how much larger a splat beyond the distance k is drawn; 1 nearer.
///
/// k = s D / p is the distance at which samples s apart lie a pixel apart; d/k = 1 / (s g) for g pixels per scene unit.
pub fn enlargement(rules: &Rules, jacobian: &Jacobian) -> f64 {
    let [across, down] = jacobian.scale;
    let pixels_apart = rules.spacing * across.min(down);
    if rules.spacing > 0.0 && pixels_apart < 1.0 {
        1.0 / pixels_apart
    } else {
        1.0
    }
}
