//! Metrics against naive oracles and known values.

use super::*;
use proptest::prelude::*;

fn picture(width: usize, height: usize, value: impl Fn(usize, usize, usize) -> f64) -> Picture {
    let mut picture = Picture::new(width, height);
    for (index, pixel) in picture.pixels.iter_mut().enumerate() {
        *pixel = std::array::from_fn(|c| value(index % width, index / width, c));
    }
    picture
}

/// SSIM straight from its definition: one two-dimensional window per position, moments about the mean.
fn naive_ssim(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let (rows, columns) = (a.len(), a[0].len());
    let (high, wide) = (rows.min(11), columns.min(11));
    let gaussian = |i: usize, n: usize| (-(i as f64 - (n as f64 - 1.0) / 2.0).powi(2) / 4.5).exp();
    let (mut sum, mut count) = (0.0, 0.0);
    for top in 0..=rows - high {
        for left in 0..=columns - wide {
            let cells: Vec<(f64, f64, f64)> = (0..high * wide)
                .map(|k| (k / wide, k % wide))
                .map(|(j, i)| {
                    let weight = gaussian(i, wide) * gaussian(j, high);
                    (weight, a[top + j][left + i], b[top + j][left + i])
                })
                .collect();
            let total: f64 = cells.iter().map(|c| c.0).sum();
            let mean = |f: &dyn Fn(f64, f64) -> f64| {
                cells.iter().map(|c| c.0 * f(c.1, c.2)).sum::<f64>() / total
            };
            let (ma, mb) = (mean(&|x, _| x), mean(&|_, y| y));
            let va = mean(&|x, _| (x - ma).powi(2));
            let vb = mean(&|_, y| (y - mb).powi(2));
            let cov = mean(&|x, y| (x - ma) * (y - mb));
            sum += (2.0 * ma * mb + 1e-4) * (2.0 * cov + 9e-4)
                / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
            count += 1.0;
        }
    }
    sum / count
}

fn plane(picture: &Picture, value: impl Fn(&[f64; 4]) -> f64) -> Vec<Vec<f64>> {
    picture
        .pixels
        .chunks(picture.width)
        .map(|row| row.iter().map(&value).collect())
        .collect()
}

/// How far the colours of two pictures are apart.
fn colour_error(fixed: &Picture, float: &Picture) -> ChannelError {
    compare(fixed, float).unwrap().colour
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

#[test]
fn empty_background_does_not_dilute_the_covered_figures() {
    // A covered square of 24 x 18 in pictures of growing size: the same figures over covered pixels, growing ones over
    // the whole.
    let drawn = |size: usize, lift: f64| {
        picture(size, size, |x, y, c| {
            let inside = (4..28).contains(&x) && (6..24).contains(&y);
            let value = 0.5 + 0.2 * ((x + 2 * y) as f64).sin();
            match (inside, c) {
                (false, _) => 0.0,
                (true, 3) => 0.9,
                (true, _) => value + lift,
            }
        })
    };
    let mut last = 0.0;
    for size in [40, 80, 160] {
        let errors = colour_error(&drawn(size, 0.01), &drawn(size, 0.0));
        let covered = errors.covered;
        assert_eq!(covered.pixels, 24 * 18);
        assert!(close(covered.psnr_db, 40.0, 1e-9), "{covered:?}");
        assert!(close(covered.bias, 0.01, 1e-12), "{covered:?}");
        assert!(covered.ssim < errors.ssim, "{errors:?}");
        assert!(errors.psnr_db > last + 1.0 && errors.bias < covered.bias);
        last = errors.psnr_db;
    }
    let nothing = compare(&Picture::new(20, 20), &Picture::new(20, 20)).unwrap();
    let covered = nothing.alpha.covered;
    assert_eq!((covered.pixels, covered.bias, covered.ssim), (0, 0.0, 1.0));
    assert_eq!(covered.psnr_db, f64::INFINITY);
}

#[test]
fn covered_everywhere_both_figures_agree() {
    let float = picture(31, 23, |x, y, c| {
        if c == 3 {
            1.0
        } else {
            ((x * y) as f64).cos().abs()
        }
    });
    let fixed = picture(31, 23, |x, y, c| float.pixels[y * 31 + x][c] * 0.99);
    let errors = compare(&fixed, &float).unwrap();
    for error in [errors.colour, errors.alpha] {
        assert_eq!(error.covered.pixels, 31 * 23);
        assert!(close(error.covered.psnr_db, error.psnr_db, 1e-12));
        assert_eq!(
            (error.covered.bias, error.covered.ssim),
            (error.bias, error.ssim)
        );
    }
}

#[test]
fn bias_is_signed_and_the_largest_difference_is_located() {
    let float = picture(9, 7, |_, _, _| 0.5);
    let mut fixed = float.clone();
    fixed.pixels[3 * 9 + 4][2] = 0.25;
    fixed.pixels[5 * 9 + 8][3] = 0.75;
    let errors = compare(&fixed, &float).unwrap();
    let at = |SampleAt { x, y, channel }| (x, y, channel);
    assert_eq!(at(errors.colour.max_at), (4, 3, 2));
    assert_eq!(at(errors.alpha.max_at), (8, 5, 3));
    assert!(close(errors.colour.bias, -0.25 / (3.0 * 63.0), 1e-15));
    assert!(close(errors.alpha.bias, 0.25 / 63.0, 1e-15));
    let back = compare(&float, &fixed).unwrap();
    assert_eq!(back.alpha.bias, -errors.alpha.bias);
}

#[test]
fn values_are_clamped_as_stored_but_not_quantised() {
    let float = picture(3, 3, |_, _, _| 1.0);
    let psnr = |value: f64| colour_error(&picture(3, 3, |_, _, _| value), &float).psnr_db;
    assert_eq!(psnr(7.0), f64::INFINITY);
    assert!(close(psnr(1.0 - 1e-7), 140.0, 1e-6));
}

#[test]
fn a_difference_whose_square_vanishes_is_not_called_identical() {
    let mut fixed = Picture::new(2, 2);
    fixed.pixels[0][0] = 1e-200;
    let found = colour_error(&fixed, &Picture::new(2, 2));
    assert!(found.psnr_db.is_finite());
}

#[test]
fn pictures_that_cannot_be_compared_are_refused_by_name() {
    let good = Picture::new(4, 3);
    let (mut bad, mut short) = (good.clone(), good.clone());
    bad.pixels[6][1] = f64::NAN;
    short.pixels.pop();
    let [turned, empty] = [[3, 4], [0, 5]].map(|[width, height]| Picture::new(width, height));
    for (fixed, float, expected) in [
        (
            &turned,
            &good,
            "the pictures differ in size: fixed is 3x4, float is 4x3",
        ),
        (&empty, &empty, "the pictures have no pixels"),
        (
            &good,
            &bad,
            "the float picture holds NaN in channel 1 of pixel (2, 1)",
        ),
        (
            &short,
            &good,
            "the fixed picture holds 11 pixels where its size asks for 12",
        ),
    ] {
        assert_eq!(compare(fixed, float).unwrap_err().to_string(), expected);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn figures_equal_the_naive_ones(
        width in 1usize..16, height in 1usize..16, seed in any::<u64>(), noise in 0.0..0.5f64,
    ) {
        let random = |x: usize, y: usize, c: usize, salt: u64| {
            let mut state = seed ^ salt ^ ((x * 7919 + y * 104_729 + c * 31) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            state = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            ((state ^ (state >> 27)) >> 11) as f64 / (1u64 << 53) as f64
        };
        let float = picture(width, height, |x, y, c| random(x, y, c, 0));
        let fixed = picture(width, height, |x, y, c| random(x, y, c, 0) + noise * (random(x, y, c, 77) - 0.5));
        let errors = compare(&fixed, &float).unwrap();

        let clamp = |v: f64| v.clamp(0.0, 1.0);
        let luminance = |p: &[f64; 4]| 0.2126 * clamp(p[0]) + 0.7152 * clamp(p[1]) + 0.0722 * clamp(p[2]);
        let expected = naive_ssim(&plane(&fixed, luminance), &plane(&float, luminance));
        prop_assert!(close(errors.colour.ssim, expected, 1e-10), "{} {}", errors.colour.ssim, expected);
        let expected = naive_ssim(&plane(&fixed, |p| clamp(p[3])), &plane(&float, |p| clamp(p[3])));
        prop_assert!(close(errors.alpha.ssim, expected, 1e-10));

        let differences: Vec<f64> = fixed.pixels.iter().zip(&float.pixels)
            .flat_map(|(a, b)| (0..3).map(move |c| clamp(a[c]) - clamp(b[c]))).collect();
        let count = differences.len() as f64;
        let mean_square = differences.iter().map(|d| d * d).sum::<f64>() / count;
        let largest = differences.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        prop_assert!(close(errors.colour.bias, differences.iter().sum::<f64>() / count, 1e-12));
        prop_assert_eq!(errors.colour.max_abs, largest);
        let SampleAt { x, y, channel: c } = errors.colour.max_at;
        let at = clamp(fixed.pixels[y * width + x][c]) - clamp(float.pixels[y * width + x][c]);
        prop_assert_eq!(at.abs(), largest);
        if mean_square > 0.0 {
            prop_assert!(close(errors.colour.psnr_db, 10.0 * (1.0 / mean_square).log10(), 1e-9));
        }
    }
}

#[test]
fn percentiles_are_those_of_the_sorted_samples() {
    // 100 samples 1..=100 in disorder: 95 and 99 of them do not exceed the 95th and the 99th.
    let mut values: Vec<f64> = (0..100).map(|k| f64::from(k * 37 % 100 + 1)).collect();
    let Percentiles { p95, p99 } = Percentiles::of(&mut values);
    assert_eq!((p95, p99), (95.0, 99.0));
    assert_eq!(
        Percentiles::of(&mut [3.0]),
        Percentiles { p95: 3.0, p99: 3.0 }
    );
    assert_eq!(Percentiles::of(&mut []), Percentiles::default());
    // A tenth of the pixels differs, but half of the covered ones.
    let float = picture(20, 10, |x, _, c| if c == 3 && x < 4 { 1.0 } else { 0.0 });
    let fixed = picture(20, 10, |x, _, c| {
        if c == 3 {
            f64::from(u8::from(x < 4))
        } else if x < 2 {
            0.25
        } else {
            0.0
        }
    });
    let colour = colour_error(&fixed, &float);
    assert_eq!(colour.percentiles.p95, 0.25);
    assert_eq!(colour.covered.percentiles.p95, 0.25);
    let two_thirds = picture(100, 1, |x, _, c| if c == 0 && x < 4 { 0.5 } else { 0.0 });
    let nothing = picture(100, 1, |_, _, _| 0.0);
    let colour = colour_error(&two_thirds, &nothing);
    assert_eq!((colour.percentiles.p95, colour.percentiles.p99), (0.0, 0.5));
}

/// By numpy and scipy (`scipy.ndimage.gaussian_filter(mode="constant", sigma=1.5, truncate=3.5)` of each channel),
/// whose window of 11 and zeros beyond the edge are the trainers'.
#[test]
fn similarity_to_a_photograph_is_the_trainers() {
    let photograph = picture(24, 17, |x, y, c| {
        ((7 * x + 5 * y * (c + 1) + x * y) % 97) as f64 / 96.0
    });
    let drawn = picture(24, 17, |x, y, c| {
        ((7 * x + 5 * y * (c + 1) + x * y + 3 * (x % 4)) % 97) as f64 / 96.0
    });
    let found = photo_error(&drawn, &photograph).unwrap();
    assert!(close(found.ssim, 0.8004024429140816, 1e-9), "{found:?}");
    assert!(close(found.psnr_db, 13.858985751896785, 1e-9), "{found:?}");
    // Without zeros around and of one channel alone: what scikit-image calls structural similarity with Gaussian
    // weights.
    let grey = |p: &Picture| picture(24, 17, |x, y, _| p.pixels[24 * y + x][0]);
    let inside = colour_error(&grey(&drawn), &grey(&photograph)).ssim;
    assert!(close(inside, 0.6048744374957827, 1e-9), "{inside}");
}

#[test]
fn a_constant_offset_gives_its_textbook_figures() {
    let float = picture(20, 15, |_, _, _| 0.5);
    let fixed = picture(20, 15, |_, _, c| if c == 3 { 0.5 } else { 0.51 });
    let errors = compare(&fixed, &float).unwrap();
    assert!(close(errors.colour.psnr_db, 40.0, 1e-9), "{errors:?}");
    assert!(close(errors.colour.max_abs, 0.01, 1e-12));
    assert!(close(errors.colour.bias, 0.01, 1e-12));
    assert_eq!(errors.alpha.psnr_db, f64::INFINITY);
    assert_eq!((errors.alpha.max_abs, errors.alpha.bias), (0.0, 0.0));
    assert!(close(errors.alpha.ssim, 1.0, 1e-12));
}
