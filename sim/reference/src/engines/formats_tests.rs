use super::*;
use crate::metrics::compare;
use crate::rules::Compositing;
use crate::scene::{Splat, synthetic};
use proptest::prelude::*;
use std::sync::LazyLock;

static HALVES: LazyLock<Vec<f64>> = LazyLock::new(|| values(FP16));
static BRAINS: LazyLock<Vec<f64>> = LazyLock::new(|| values(BFLOAT16));

/// All finite values of a format of 16 bits, increasing, by its definition: fraction times a power of two.
fn values(format: FloatFormat) -> Vec<f64> {
    let steps = 1i64 << format.fraction_bits;
    let mut values: Vec<f64> = (0..steps)
        .map(|fraction| fraction as f64 * 2f64.powi(format.min_exponent - format.fraction_bits))
        .collect();
    for exponent in format.min_exponent..=format.max_exponent {
        let of =
            |fraction: i64| (steps + fraction) as f64 * 2f64.powi(exponent - format.fraction_bits);
        values.extend((0..steps).map(of));
    }
    values
}

/// The nearest value by searching all of them; between two the even one; infinity from half a step beyond the largest
/// on.
fn nearest(values: &[f64], x: f64) -> f64 {
    let size = x.abs();
    let largest = values[values.len() - 1];
    let step = largest - values[values.len() - 2];
    if size >= largest + step / 2.0 {
        return f64::INFINITY.copysign(x);
    }
    let after = values
        .partition_point(|value| *value < size)
        .min(values.len() - 1);
    let before = after.saturating_sub(1);
    let (low, high) = (size - values[before], values[after] - size);
    let even = |index: usize| index.is_multiple_of(2);
    let index = match low.total_cmp(&high) {
        std::cmp::Ordering::Less => before,
        std::cmp::Ordering::Greater => after,
        std::cmp::Ordering::Equal if even(before) => before,
        std::cmp::Ordering::Equal => after,
    };
    // Beyond the last value there is none after it.
    let index = if size > largest {
        values.len() - 1
    } else {
        index
    };
    values[index].copysign(x)
}

#[test]
fn formats_have_their_bits_and_limits() {
    assert_eq!([FP32.bits(), FP16.bits(), BFLOAT16.bits()], [32, 16, 16]);
    assert_eq!(FP16.largest(), 65_504.0);
    assert_eq!(FP32.largest(), f64::from(f32::MAX));
    assert_eq!(FP16.round(65_519.9), 65_504.0);
    assert_eq!(FP16.round(65_520.0), f64::INFINITY);
    assert_eq!(FP16.round(2f64.powi(-25)), 0.0);
    assert_eq!(FP16.round(-1.0 - 2f64.powi(-11)), -1.0);
    assert_eq!(
        BFLOAT16.round(1.0 + 3.0 * 2f64.powi(-8)),
        1.0 + 2f64.powi(-6)
    );
    assert!(FP16.round(f64::NAN).is_nan());
}

#[test]
fn every_value_stays_and_every_midpoint_goes_to_the_even_one() {
    for format in [FP16, BFLOAT16] {
        let values = values(format);
        // All codes but those of infinity and NaN.
        assert_eq!(values.len(), (1 << 15) - (1 << format.fraction_bits));
        for (index, pair) in values.windows(2).enumerate() {
            assert_eq!(format.round(pair[0]), pair[0]);
            let even = pair[index % 2];
            assert_eq!(format.round((pair[0] + pair[1]) / 2.0), even);
            assert_eq!(format.round(-(pair[0] + pair[1]) / 2.0), -even);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Sums, products, quotients and roots of two values are the nearest to the exact result. The exact result is taken
    /// in integers or told by comparison, not by the rounding under test.
    #[test]
    fn operations_are_correctly_rounded(a in any::<u16>(), b in any::<u16>()) {
        let half = |bits: u16| {
            let value = f64::from(bits & 0x3ff) / 1024.0;
            let size = match (bits >> 10) & 31 {
                0 => value * 2f64.powi(-14),
                exponent => (1.0 + value) * 2f64.powi(i32::from(exponent).min(30) - 15),
            };
            if bits & 0x8000 == 0 { size } else { -size }
        };
        let all = &*HALVES;
        let (x, y) = (FP16.number(half(a)), FP16.number(half(b)));
        prop_assert_eq!(x.value, half(a));
        // Both are exact in a double: 11 bits each over 40 binades at most.
        prop_assert_eq!((x + y).value, nearest(all, x.value + y.value));
        prop_assert_eq!((x * y).value, nearest(all, x.value * y.value));
        if y.value != 0.0 {
            let found = (x / y).value;
            if found.is_finite() {
                // Nearest: no neighbour q has a smaller |q y - x|, both of which a double holds exactly.
                let off = |q: f64| (q * y.value - x.value).abs();
                let place = all.partition_point(|value| *value < found.abs());
                for other in [place.saturating_sub(1), (place + 1).min(all.len() - 1)] {
                    prop_assert!(off(found) <= off(all[other].copysign(found)), "{} / {}", x.value, y.value);
                }
            }
        }
        if x.value > 0.0 {
            // Between the squares of the midpoints around it.
            let root = x.sqrt().value;
            let place = all.partition_point(|value| *value < root);
            let middle = |p: usize, q: usize| (all[p] + all[q]) / 2.0;
            if place > 0 && place + 1 < all.len() {
                let (low, high) = (middle(place - 1, place), middle(place, place + 1));
                prop_assert!(low * low <= x.value && x.value <= high * high);
            }
        }
    }

    #[test]
    fn single_precision_is_the_processors(a in any::<u32>(), b in any::<u32>()) {
        let (a, b) = (f32::from_bits(a), f32::from_bits(b));
        prop_assume!(a.is_finite() && b.is_finite());
        let (x, y) = (FP32.number(a.into()), FP32.number(b.into()));
        let same = |found: Rounded, wanted: f32| found.value == f64::from(wanted) || (found.value.is_nan() && wanted.is_nan());
        prop_assert!(same(x + y, a + b) && same(x - y, a - b) && same(x * y, a * b) && same(x / y, a / b));
        prop_assert!(same(x.sqrt(), a.sqrt()));
        prop_assert_eq!(FP32.round(f64::from(a) * 1.000_000_1), f64::from((f64::from(a) * 1.000_000_1) as f32));
    }

    #[test]
    fn numbers_are_rounded_as_by_search(fraction in -1f64..1.0, exponent in -45i32..20) {
        let x = fraction * 2f64.powi(exponent);
        prop_assert_eq!(FP16.round(x), nearest(&HALVES, x));
        prop_assert_eq!(BFLOAT16.round(x), nearest(&BRAINS, x));
    }
}

/// In the format of single precision every footprint is that of the engine written in it, to the last bit.
#[test]
fn in_single_precision_it_is_the_engine_written_in_it() {
    let scene = synthetic::random_gaussians(400, 3, 2.0);
    let camera = synthetic::camera(96, 64);
    let rules = scene.natural_rules;
    let weights = scene.weights_for(&rules);
    let mut drawn = 0;
    for (splat, weight) in scene.splats.iter().zip(weights) {
        let splat = Splat { weight, ..*splat };
        let ours = plain::project(&splat, &camera, &rules, |x| FP32.number(x)).ok();
        let theirs = super::super::single::project(&splat, &camera, &rules);
        assert_eq!(ours.is_some(), theirs.is_some());
        let (Some(ours), Some(theirs)) = (ours, theirs) else {
            continue;
        };
        drawn += 1;
        let wide = |v: [f32; 3]| v.map(f64::from);
        assert_eq!(ours.conic.map(|q| q.value), wide(theirs.conic));
        assert_eq!(ours.centre.map(|q| q.value), theirs.centre.map(f64::from));
        assert_eq!(ours.peak.value, f64::from(theirs.peak));
    }
    assert!(drawn > 200);
}

/// The pictures of narrower formats are worse, in the order of their bits; that of single precision is the reference's.
#[test]
fn fewer_bits_give_larger_errors() {
    let scene = synthetic::random_gaussians(2000, 5, 2.0);
    let camera = synthetic::camera(96, 64);
    let rules = scene.natural_rules;
    let truth = super::super::float::draw(&scene, &camera, &rules, Compositing::FrontToBack);
    let psnr = |stages: RoundedStages| {
        let drawing = draw(&scene, &camera, &rules, &stages);
        assert!(drawing.counts.covered_pixels > 1000);
        compare(&drawing.picture, &truth.picture)
            .unwrap()
            .colour
            .psnr_db
    };
    let [single, half, brain] =
        [FP32, FP16, BFLOAT16].map(|format| psnr(RoundedStages::pixels(format)));
    assert!(
        single > 90.0 && half < single - 20.0 && brain < half - 8.0,
        "{single} {half} {brain}"
    );
    assert!(psnr(RoundedStages::all(FP16)) < half);
    // A stage alone is never worse than all of them together, give or take luck.
    for stages in [
        RoundedStages {
            raster: FP16,
            ..RoundedStages::pixels(FP32)
        },
        RoundedStages {
            kernel: FP16,
            ..RoundedStages::pixels(FP32)
        },
        RoundedStages {
            blend: FP16,
            ..RoundedStages::pixels(FP32)
        },
    ] {
        assert!(psnr(stages) > half - 1.0);
    }
}
