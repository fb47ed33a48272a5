//! View-dependent colour: real spherical harmonics of degree 0 to 4, an optional unit before
//! [`colour`](super::colour()).
//!
//! A splat's colour in the direction d from the eye is
//!
//! ```text
//! max(0, base + sum over k of Y_k(d) c_k)
//! k = 1 .. 24 in the trainers' order: degree 1, -1 0 1; degree 2, -2 .. 2; ...
//! ```
//!
//! with Y_k the orthonormal real harmonics under the sign (-1)^m, as polynomials in d. The direction is the
//! camera-space centre that [`project`](super::project()) computes, normalised (mantissas of the design's width) and
//! turned back into the scene; parallel projection has one direction for all. From there on all is fixed point with
//! places that no input can leave: directions Q1.30, polynomials Q3.30, harmonics Q2.28, coefficients Q3.28, their
//! products rounded to 40 fraction bits, and the sum to odd at 28. In hardware the 24 harmonics are 40 products and 24
//! by constants once per splat, and 72 products with coefficients.

use crate::format::Widths;
use crate::math::{SoftFloat, reciprocal, shift_round, square_root, sum_of_products};
use crate::view::{Pose, Projection, View};
use fixed::types::{I2F30, I4F28, U4F28};

/// Coefficients beyond the constant one of degree 4, the highest.
pub const COEFFICIENTS: usize = 24;

/// 1.0 of directions and monomials.
const ONE: i64 = 1 << 30;

/// Fraction bits of the constants below, and of harmonics, coefficients and the sum.
const CONSTANT: u32 = 29;
const FRACTION: u32 = 28;
const SUM: u32 = 40;

// sqrt(n / (d pi)) in Q2.29, named by degree and order; a test computes them again.
const D1: i64 = 262_316_476;
const D2_PRODUCT: i64 = 586_557_472;
const D2_ZERO: i64 = 169_324_557;
const D2_SQUARES: i64 = 293_278_736;
const D3_THREE: i64 = 316_777_240;
const D3_PRODUCT: i64 = 1_551_885_201;
const D3_ONE: i64 = 245_374_595;
const D3_ZERO: i64 = 200_347_518;
const D3_SQUARES: i64 = 775_942_601;
const D4_PRODUCT: i64 = 1_343_972_008;
const D4_THREE: i64 = 950_331_721;
const D4_TWO: i64 = 507_973_672;
const D4_ONE: i64 = 359_191_628;
const D4_ZERO: i64 = 113_586_366;
const D4_SQUARES: i64 = 253_986_836;
const D4_FOUR: i64 = 335_993_002;

/// The colour of one splat before its direction is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Harmonics<'a> {
    /// Colour of degree 0, Q3.28: 1/2 + c_0 / (2 sqrt(pi)) of the trainers, not clamped.
    pub base: [I4F28; 3],
    /// c_1 ..., Q3.28: 3 for degree 1, 8, 15 or 24 for degree 4. Fewer leave a sum short; what is beyond 24 is not
    /// looked at.
    pub coefficients: &'a [[I4F28; 3]],
}

impl Harmonics<'_> {
    /// The colour in a direction, UQ4.28: clamped at 0, saturated below 16. Each product is rounded to 2^-40 and the
    /// sum to odd, so that the design's own rounding has no ties to favour.
    ///
    /// Total: every direction and coefficient has a colour. A direction of 0 leaves the base alone.
    pub fn colour(&self, direction: [I2F30; 3]) -> [U4F28; 3] {
        let basis = basis(direction);
        let mut colour = [U4F28::ZERO; 3];
        for (channel, colour) in colour.iter_mut().enumerate() {
            let mut sum = i64::from(self.base[channel].to_bits()) << (SUM - FRACTION);
            for (harmonic, coefficient) in basis.iter().zip(self.coefficients) {
                let product = i64::from(*harmonic) * i64::from(coefficient[channel].to_bits());
                sum = sum.wrapping_add(shift_round(product, 2 * FRACTION - SUM));
            }
            let lost = sum & ((1 << (SUM - FRACTION)) - 1) != 0;
            let rounded = sum >> (SUM - FRACTION) | i64::from(lost);
            *colour = U4F28::from_bits(rounded.clamp(0, u32::MAX.into()) as u32);
        }
        colour
    }
}

/// The unit vector from the eye to a centre in the scene's axes, Q1.30; 0 at the eye itself. In parallel projection the
/// direction of view.
///
/// Mantissas of [`mantissa`](Widths::mantissa) bits: the error is a few `2^-mantissa`. Total.
pub fn direction<P: Pose>(widths: &Widths, view: &View<P>, centre: &P::Centre) -> [I2F30; 3] {
    let [_, _, forward] = view.rotation;
    if view.projection == Projection::Orthographic {
        return forward;
    }
    let bits = u32::from(widths.mantissa);
    let point = view.pose.to_camera(&view.rotation, centre, widths);
    let place = [0, 1, 2].map(|axis| {
        let coordinate = point.coordinate(axis);
        SoftFloat::from_wide(coordinate.value, coordinate.exponent, bits)
    });
    let length = square_root(sum_of_products(place.map(|x| x.times(x)), bits), bits);
    let Some(inverse) = reciprocal(length, bits) else {
        return [I2F30::ZERO; 3];
    };
    let unit = place.map(|x| x.times(inverse).to_fixed(30).clamp(-ONE, ONE));
    [0, 1, 2].map(|axis| {
        let mut sum = 0i64;
        for (row, part) in view.rotation.iter().zip(unit) {
            sum = sum.wrapping_add(i64::from(row[axis].to_bits()).wrapping_mul(part));
        }
        I2F30::from_bits(shift_round(sum, 30).clamp(-ONE, ONE) as i32)
    })
}

/// Product of two numbers in Q.30.
#[inline(always)]
const fn times(a: i64, b: i64) -> i64 {
    shift_round(a.wrapping_mul(b), 30)
}

/// The harmonics of degree 1 to 4, Q2.28, of a unit vector, whose polynomials stay within 4. Those of any other vector
/// are defined, and no more.
fn basis(direction: [I2F30; 3]) -> [i32; COEFFICIENTS] {
    let [x, y, z] = direction.map(|part| i64::from(part.to_bits()).clamp(-ONE, ONE));
    let (xx, yy, zz) = (times(x, x), times(y, y), times(z, z));
    let (xy, yz, xz) = (times(x, y), times(y, z), times(x, z));
    let rr = xx + yy + zz;
    let squares = xx - yy;
    let (three_x, three_y) = (xx - 3 * yy, 3 * xx - yy);
    let five = 5 * zz - rr;
    let seven = 7 * zz - rr;
    let odd = 7 * zz - 3 * rr;
    // Half of it, so that it stays within 4 as the others do; its constant is doubled.
    let zero = shift_round(times(35 * zz - 30 * rr, zz) + times(3 * rr, rr), 1);
    let polynomials = [
        (-D1, y),
        (D1, z),
        (-D1, x),
        (D2_PRODUCT, xy),
        (-D2_PRODUCT, yz),
        (D2_ZERO, 3 * zz - rr),
        (-D2_PRODUCT, xz),
        (D2_SQUARES, squares),
        (-D3_THREE, times(y, three_y)),
        (D3_PRODUCT, times(xy, z)),
        (-D3_ONE, times(y, five)),
        (D3_ZERO, times(z, 5 * zz - 3 * rr)),
        (-D3_ONE, times(x, five)),
        (D3_SQUARES, times(z, squares)),
        (-D3_THREE, times(x, three_x)),
        (D4_PRODUCT, times(xy, squares)),
        (-D4_THREE, times(yz, three_y)),
        (D4_TWO, times(xy, seven)),
        (-D4_ONE, times(yz, odd)),
        (D4_ZERO, zero),
        (-D4_ONE, times(xz, odd)),
        (D4_SQUARES, times(squares, seven)),
        (-D4_THREE, times(xz, three_x)),
        (D4_FOUR, times(xx, three_x) - times(yy, three_y)),
    ];
    polynomials.map(|(constant, polynomial)| {
        let value = constant.wrapping_mul(polynomial.clamp(-4 * ONE, 4 * ONE - 1));
        let value = shift_round(value, CONSTANT + 30 - FRACTION);
        value.clamp(i32::MIN.into(), i32::MAX.into()) as i32
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn constants_are_roots() {
        let root = |n: f64, d: f64| {
            ((n / (d * core::f64::consts::PI)).sqrt() * 2f64.powi(29)).round() as i64
        };
        let expected = [
            (D1, 3.0, 4.0),
            (D2_PRODUCT, 15.0, 4.0),
            (D2_ZERO, 5.0, 16.0),
            (D2_SQUARES, 15.0, 16.0),
            (D3_THREE, 35.0, 32.0),
            (D3_PRODUCT, 105.0, 4.0),
            (D3_ONE, 21.0, 32.0),
            (D3_ZERO, 7.0, 16.0),
            (D3_SQUARES, 105.0, 16.0),
            (D4_PRODUCT, 315.0, 16.0),
            (D4_THREE, 315.0, 32.0),
            (D4_TWO, 45.0, 16.0),
            (D4_ONE, 45.0, 32.0),
            (D4_ZERO, 9.0, 64.0),
            (D4_SQUARES, 45.0, 64.0),
            (D4_FOUR, 315.0, 256.0),
        ];
        for (constant, n, d) in expected {
            assert_eq!(constant, root(n, d), "sqrt({n} / {d} pi)");
        }
    }

    fn unit(x: f64, y: f64, z: f64) -> [f64; 3] {
        let length = (x * x + y * y + z * z).sqrt();
        [x / length, y / length, z / length]
    }

    fn fixed(direction: [f64; 3]) -> [I2F30; 3] {
        direction.map(|x| I2F30::from_bits((x * 2f64.powi(30)).round() as i32))
    }

    fn values(direction: [f64; 3]) -> [f64; COEFFICIENTS] {
        basis(fixed(direction)).map(|y| f64::from(y) / 2f64.powi(28))
    }

    /// The addition theorem: the squares of a degree's harmonics sum to (2 l + 1) / 4 pi in every direction. No formula
    /// of the unit is in it.
    #[test]
    fn squares_of_a_degree_sum_to_its_share_of_the_sphere() {
        for step in 0..400 {
            let angle = f64::from(step) * 2.399_963;
            let z = f64::from(step) / 200.0 - 0.9975;
            let ring = (1.0 - z * z).sqrt();
            let y = values([ring * angle.cos(), ring * angle.sin(), z]);
            let mut start = 0;
            for degree in 1..=4 {
                let count = 2 * degree + 1;
                let sum: f64 = y[start..start + count].iter().map(|y| y * y).sum();
                let share = count as f64 / (4.0 * core::f64::consts::PI);
                assert!((sum - share).abs() < 4e-8, "degree {degree}: {sum} {share}");
                start += count;
            }
        }
    }

    /// A share of a component that rounds down does, and what leaves a polynomial's word for no unit vector ends with
    /// the word.
    #[test]
    fn ends_of_the_words() {
        use crate::format::{RuntimeWidths, Standard24};
        use crate::math::{Extended, SoftFloat};
        use crate::view::{Eye, RatioLimits};
        let mut rotation = [[I2F30::ZERO; 3]; 3];
        // x is 2^-30 of z, and has a half but for a bit of the first axis.
        rotation[0] = [(1 << 29) - 1, 0, 1].map(I2F30::from_bits);
        rotation[2][2] = I2F30::ONE;
        let view = View {
            rotation,
            pose: Eye::ORIGIN,
            focal: [SoftFloat::ZERO; 2],
            principal: [fixed::types::I32F32::ZERO; 2],
            near: Extended::ZERO,
            far: Extended::MAX,
            viewport: [1; 2],
            projection: Projection::Perspective,
            limits: RatioLimits {
                low: [fixed::types::I32F32::ZERO; 2],
                high: [fixed::types::I32F32::ZERO; 2],
            },
        };
        let widths = Widths {
            position: 60,
            ..Standard24::WIDTHS
        };
        assert!(RuntimeWidths::<i64>::new(widths).is_ok());
        let one = SoftFloat {
            mantissa: 1 << 30,
            exponent: -30,
        };
        let ahead = [SoftFloat::ZERO, SoftFloat::ZERO, one];
        let even = Harmonics {
            base: [I4F28::from_bits(2); 3],
            coefficients: &[],
        };
        assert_eq!(even.colour([I2F30::ZERO; 3]), [U4F28::from_bits(2); 3]);
        assert_eq!(direction(&widths, &view, &ahead)[0], I2F30::ZERO);

        let corners = (0..27i64).flat_map(|corner| {
            let parts = [corner % 3, corner / 3 % 3, corner / 9].map(|part| part - 1);
            basis(parts.map(|part| I2F30::from_bits((part * ONE) as i32))).map(|word| word as u64)
        });
        assert_eq!(crate::digest(corners), 6_320_934_940_884_299_953);
    }

    proptest! {
        #[test]
        fn everything_is_defined(direction: [i32; 3], base: [i32; 3], coefficients in prop::collection::vec(any::<[i32; 3]>(), 0..30)) {
            let mut list = [[I4F28::ZERO; 3]; 30];
            for (place, coefficient) in list.iter_mut().zip(&coefficients) {
                *place = coefficient.map(I4F28::from_bits);
            }
            let harmonics = Harmonics { base: base.map(I4F28::from_bits), coefficients: &list[..coefficients.len()] };
            harmonics.colour(direction.map(I2F30::from_bits));
        }

        /// Turning a direction by half a turn about z leaves even orders and negates odd ones.
        #[test]
        fn half_a_turn_negates_odd_orders(x in -1.0f64..1.0, y in -1.0f64..1.0, z in -1.0f64..1.0) {
            prop_assume!(x * x + y * y + z * z > 1e-3);
            let [x, y, z] = unit(x, y, z);
            let (here, turned) = (values([x, y, z]), values([-x, -y, z]));
            let mut place = 0;
            for degree in 1..=4i32 {
                for order in -degree..=degree {
                    let sign = if order % 2 == 0 { 1.0 } else { -1.0 };
                    prop_assert!((here[place] - sign * turned[place]).abs() < 3e-8);
                    place += 1;
                }
            }
        }
    }

    #[test]
    fn a_direction_of_zero_leaves_the_base() {
        let harmonics = Harmonics {
            base: [
                I4F28::from_num(0.25),
                I4F28::from_num(-1),
                I4F28::from_num(7.5),
            ],
            coefficients: &[[I4F28::MAX; 3]; 3],
        };
        let colour = harmonics.colour([I2F30::ZERO; 3]);
        assert_eq!(colour.map(|c| c.to_num::<f32>()), [0.25, 0.0, 7.5]);
    }

    #[test]
    fn directions_and_colours_are_these() {
        let mut next = crate::random();
        let words = (0..1000).flat_map(|step| {
            let widths = if step % 2 == 0 {
                crate::format::Standard24::WIDTHS
            } else {
                crate::format::Lean18::WIDTHS
            };
            let mut view = crate::setup::tests::view(crate::view::Eye::ORIGIN, [1; 2]);
            view.rotation = view
                .rotation
                .map(|row| row.map(|_| I2F30::from_bits(next() as i32 >> 2)));
            if step % 3 == 0 {
                view.projection = Projection::Orthographic;
            }
            let centre = [0; 3].map(|_| SoftFloat::from_wide(next() as i64, -60, 24));
            let coefficients =
                [[0; 3]; 24].map(|row| row.map(|_| I4F28::from_bits(next() as i32 >> 3)));
            let direction = direction(&widths, &view, &centre);
            let base = [0; 3].map(|_| I4F28::from_bits(next() as i32));
            let harmonics = Harmonics {
                base,
                coefficients: &coefficients,
            };
            let colour = harmonics
                .colour(direction)
                .map(|channel| channel.to_bits().into());
            let [x, y, z] = direction.map(|part| part.to_bits() as u64);
            let [red, green, blue] = colour;
            [x, y, z, red, green, blue]
        });
        assert_eq!(crate::digest(words), 11_825_482_746_618_282_618);
    }
}
