//! Footprint shapes: Gaussian, cubic spline, quadratic and disc, all on the same radial index (\[SWAN\] 6).
//!
//! The radial index r = x^T (V' + V^h)^-1 x measures squared distance in standard deviations, so every shape here is
//! scaled to *unit variance per axis*: V keeps its meaning, whatever the shape, and an elliptical footprint is the
//! circular one under an affine map. A shape then is a profile f(r) with f(0) = 1, an end, and an integral:
//!
//! | shape | f(r) | end | integral of f over r |
//! |---|---|---|---|
//! | Gaussian | exp(-r/2) | the rules' cut-off | 2 |
//! | cubic spline | line integral of Crawfis and Max's kernel | 12.136 | 2.2806 |
//! | quadratic (Epanechnikov) | 1 - r/6 | 6 | 3 |
//! | disc | 1 | 4 | 4 |
//!
//! A normalised footprint has the peak 1 / (pi I sqrt(det)) with I the integral, because dA = pi sqrt(det) dr.
//!
//! **The cubic spline.** Crawfis and Max (Texture Splats, IEEE Visualization 1993) fit a piecewise cubic in the
//! distance d from the sample, in sample spacings, that reconstructs a constant field with the least ripple:
//!
//! ```text
//! h(d) = 0.557526 - 1.157743 d^2 + 0.671033 d^3             d < 0.88175584
//! h(d) = a + b t + c t^2 + e t^3, t = d - 0.88175584        up to 1.5556228
//! ```
//!
//! The second piece follows from the first: value and slope are continuous and vanish at the end. Checks that the
//! constants are right: the volume integral is 1.00004 and the second derivative is continuous to 4 %. Its footprint is
//! the integral along the ray, its variance 0.19941 square spacings.

use super::{fill_gaussian, shape_entries};
use crate::format::Widths;
use crate::math::SoftFloat;

/// Which footprint a splat has. Constant for a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Kernel {
    /// exp(-r/2) (\[EWA\] eq. 16).
    Gaussian,
    /// Line integral of the cubic spline of Crawfis and Max.
    Cubic,
    /// 1 - r/6 (Epanechnikov).
    Quadratic,
    /// 1 up to r = 4.
    Disc,
}

impl Kernel {
    /// All shapes.
    pub const ALL: [Kernel; 4] = [
        Kernel::Gaussian,
        Kernel::Cubic,
        Kernel::Quadratic,
        Kernel::Disc,
    ];

    /// Radial index at which the shape itself ends, UQ4.28; 15 for the Gaussian, which only rules end.
    pub const fn end(self) -> u32 {
        match self {
            Kernel::Gaussian => 15 << 28,
            Kernel::Cubic => 3_257_624_000, // 12.135595
            Kernel::Quadratic => 6 << 28,
            Kernel::Disc => 4 << 28,
        }
    }

    /// Base-2 logarithm of the end of the table that holds the whole shape; the Gaussian's depends on the rules.
    pub const fn table_range(self) -> u8 {
        match self {
            Kernel::Gaussian | Kernel::Cubic => 4,
            Kernel::Quadratic => 3,
            Kernel::Disc => 2,
        }
    }

    /// 1 / (pi I) with 31 bits: the peak of a footprint of unit volume and unit determinant.
    pub const fn inverse_integral(self) -> SoftFloat {
        let (mantissa, exponent) = match self {
            Kernel::Gaussian => (1_367_130_551, -33),
            Kernel::Cubic => (1_198_912_494, -33),
            Kernel::Quadratic => (1_822_840_735, -34),
            Kernel::Disc => (1_367_130_551, -34),
        };
        SoftFloat { mantissa, exponent }
    }
}

/// Fills a table with `kernel` on 0 ..= `2^range`; entries beyond the shape's end are 0.
///
/// Entries are UQ1.weight, rounded to nearest. The cubic spline costs 32 square roots per entry; on a small processor
/// its table is best filled once and kept.
pub fn fill(table: &mut [u32], widths: &Widths, range: u8, kernel: Kernel) {
    match kernel {
        Kernel::Gaussian => fill_gaussian(table, widths, range),
        Kernel::Cubic => shape_entries(table, widths, range, cubic),
        Kernel::Quadratic => shape_entries(table, widths, range, quadratic),
        Kernel::Disc => shape_entries(table, widths, range, |_| ONE),
    }
}

/// Fraction bits of profiles and radial indices in this file.
const FRACTION: u32 = 40;
const ONE: i64 = 1 << FRACTION;

/// 1 - r/6, both Q.40.
fn quadratic(radial: i64) -> i64 {
    (ONE - (radial + 3) / 6).max(0)
}

/// Crawfis and Max in Q.40, distances in sample spacings.
const BREAK: i64 = 969_500_798_939; // 0.88175584
const END_SQUARED: i64 = 2_660_776_683_099; // 1.5556228^2
const VARIANCE: i64 = 219_253_910_877; // 0.19941027
const INVERSE_PEAK: i64 = 1_570_844_142_817; // 1 / 0.69994954, the line integral through the centre
const FIRST_PIECE: [i64; 4] = [613_006_319_787, 0, -1_272_951_890_476, 737_808_586_121];
const SECOND_PIECE: [i64; 4] = [
    129_106_222_248,
    -523_941_693_910,
    702_086_891_268,
    -309_981_437_172,
];

/// The spline's line integral at radial index r (Q.40), relative to the integral through its centre.
///
/// 2 int_0^L h(sqrt(rho^2 + t^2)) dt with rho^2 = r VARIANCE and L^2 = END^2 - rho^2, by the midpoint rule: the
/// integrand is even at 0 and vanishes with its slope at L, so 32 points are exact to 2.1e-7.
fn cubic(radial: i64) -> i64 {
    const POINTS: i64 = 32;
    let squared = multiply(radial, VARIANCE);
    if squared >= END_SQUARED {
        return 0;
    }
    let length = root(END_SQUARED - squared);
    let mut sum = 0;
    let mut point = 0;
    while point < POINTS {
        let along = length * (2 * point + 1) / (2 * POINTS);
        sum += spline(root(squared + multiply(along, along)));
        point += 1;
    }
    multiply(multiply(2 * sum / POINTS, length), INVERSE_PEAK).clamp(0, ONE)
}

/// h(d), Horner's rule on the piece that d lies in.
fn spline(distance: i64) -> i64 {
    let (pieces, t) = if distance < BREAK {
        (FIRST_PIECE, distance)
    } else {
        (SECOND_PIECE, distance - BREAK)
    };
    let [a, b, c, d] = pieces;
    a + multiply(b + multiply(c + multiply(d, t), t), t)
}

/// Product of two Q.40 numbers, rounded to nearest.
fn multiply(a: i64, b: i64) -> i64 {
    ((i128::from(a) * i128::from(b) + (1 << (FRACTION - 1))) >> FRACTION) as i64
}

/// Square root of a Q.40 number below 16, Q.40: the integer root of a Q.58 number in Q.29, with 11 zero bits.
fn root(value: i64) -> i64 {
    let wide = (value.max(0) as u64) << 18;
    (wide.isqrt() << 11) as i64
}

#[cfg(test)]
mod tests {
    use super::super::{FootprintTable, entries};
    use super::*;
    use crate::format::Standard24;
    extern crate std;
    use std::vec;

    /// Crawfis and Max in double precision, the second piece from its end conditions.
    fn spline_in_double(distance: f64) -> f64 {
        let (knot, end) = (0.881_755_84_f64, 1.555_622_8_f64);
        let first = |d: f64| 0.557526 - 1.157743 * d * d + 0.671033 * d * d * d;
        let (a, b) = (
            first(knot),
            -2.0 * 1.157743 * knot + 3.0 * 0.671033 * knot * knot,
        );
        let span = end - knot;
        let c = (-3.0 * a - 2.0 * b * span) / (span * span);
        let e = (2.0 * a + b * span) / span.powi(3);
        let t = distance - knot;
        match distance {
            d if d < knot => first(d),
            d if d < end => a + b * t + c * t * t + e * t * t * t,
            _ => 0.0,
        }
    }

    fn profile(kernel: Kernel, radial: f64) -> f64 {
        match kernel {
            Kernel::Gaussian => (-0.5 * radial).exp(),
            Kernel::Quadratic => (1.0 - radial / 6.0).max(0.0),
            Kernel::Disc => 1.0,
            Kernel::Cubic => {
                let squared = 0.19941027 * radial;
                let length = (1.5556228f64.powi(2) - squared).max(0.0).sqrt();
                let points = 4000;
                let at = |i: i32| (f64::from(i) + 0.5) / f64::from(points) * length;
                let sum: f64 = (0..points)
                    .map(|i| spline_in_double((squared + at(i) * at(i)).sqrt()))
                    .sum();
                2.0 * sum * length / f64::from(points) / 0.69994954
            }
        }
    }

    /// One row a shape: largest error of the table against the formula, below the end.
    #[test]
    fn tables_hold_their_formulas() {
        let widths = Standard24::WIDTHS;
        let rows = [
            (Kernel::Gaussian, 3.4e-7),
            (Kernel::Cubic, 1.4e-6),
            (Kernel::Quadratic, 5e-8),
            (Kernel::Disc, 0.0),
        ];
        for (kernel, allowed) in rows {
            let range = kernel.table_range();
            let mut memory = vec![0; entries(&widths)];
            fill(&mut memory, &widths, range, kernel);
            let table = FootprintTable::new(&memory, &widths, range).unwrap();
            let end = f64::from(kernel.end()) / 2f64.powi(28);
            let worst = (0..1000)
                .map(|i| (f64::from(i) + 0.37) / 1000.0 * end)
                .map(|r| {
                    let got = table.weight((r * 2f64.powi(27)) as u64);
                    (f64::from(got) / 2f64.powi(widths.weight.into()) - profile(kernel, r)).abs()
                })
                .fold(0.0, f64::max);
            assert!(worst <= allowed, "{kernel:?}: {worst:.2e}");
        }
    }

    /// The arithmetic of profiles at the ends of its ranges, and digests of whole profiles and of the numbers beside
    /// them.
    #[test]
    fn profiles_are_these_words() {
        assert_eq!([quadratic(2), quadratic(3)], [ONE, ONE - 1]);
        assert_eq!([quadratic(6 * ONE), quadratic(7 * ONE)], [0; 2]);
        assert_eq!([multiply(1, ONE / 2), multiply(1, ONE / 2 - 1)], [1, 0]);
        assert_eq!([multiply(0, 0), multiply(-1, ONE / 2)], [0; 2]);
        assert_eq!([root(0), root(-1), root(4 * ONE)], [0, 0, 2 * ONE]);
        assert_eq!(
            [spline(BREAK), spline(0)],
            [SECOND_PIECE[0], FIRST_PIECE[0]]
        );
        // The radial index of the end, and the last one before it.
        let end = (0..64).fold(0, |low, bit| {
            let next = low + (1i64 << 44 >> bit);
            if multiply(next, VARIANCE) < END_SQUARED {
                next
            } else {
                low
            }
        });
        assert_eq!([cubic(end), cubic(end + 1), cubic(16 * ONE)], [0; 3]);
        let profile = (0..4096).map(|index| cubic(index * 3_257_624_001) as u64);
        assert_eq!(crate::digest(profile), 6_780_693_171_960_558_802);
        let numbers = Kernel::ALL.map(|kernel| (kernel.end(), kernel.inverse_integral().mantissa));
        let expected = [
            (15 << 28, 1_367_130_551),
            (3_257_624_000, 1_198_912_494),
            (6 << 28, 1_822_840_735),
            (4 << 28, 1_367_130_551),
        ];
        assert_eq!(numbers, expected);
    }

    /// Unit variance and the integral that normalises: int f r dr / int f dr = 2 (per axis 1), and 1 / (pi I).
    #[test]
    fn shapes_have_unit_variance_and_their_integral() {
        for kernel in Kernel::ALL {
            let end = match kernel {
                Kernel::Gaussian => 60.0,
                _ => f64::from(kernel.end()) / 2f64.powi(28),
            };
            let step = end / 2000.0;
            let at = |i: i32| (f64::from(i) + 0.5) * step;
            let mass: f64 = (0..2000).map(|i| profile(kernel, at(i))).sum::<f64>() * step;
            let second: f64 = (0..2000)
                .map(|i| at(i) * profile(kernel, at(i)))
                .sum::<f64>()
                * step;
            let unit = kernel.inverse_integral();
            let inverse = f64::from(unit.mantissa) * f64::from(unit.exponent).exp2();
            assert!(
                (second / mass - 2.0).abs() < 2e-4,
                "{kernel:?}: {}",
                second / mass
            );
            assert!(
                (inverse * core::f64::consts::PI * mass - 1.0).abs() < 1e-4,
                "{kernel:?}"
            );
        }
    }
}
