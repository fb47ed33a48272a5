//! FLIP: how different two pictures look to someone who flips between them, 0 to 1 per pixel.
//!
//! Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020, for pictures of low dynamic
//! range:
//!
//! ```text
//! colour = sRGB -> opponent space -> filtered by the eye's contrast sensitivity -> L*a*b*, chroma times L*
//!     -> HyAB distance^0.7, remapped
//! feature = lightness -> first and second derivatives of a Gaussian
//!     -> largest difference of edges and points, (difference / sqrt 2)^0.5
//! FLIP = colour^(1 - feature)
//! ```
//!
//! What a [`Picture`] holds is what its file shows, so its values count as sRGB. Both filters reach as far as the eye
//! resolves, which is stated in pixels per degree of the visual field. All filters are products of one along the rows
//! and one along the columns. The tests hold it to the values of the authors' package.

use crate::metrics::stored;
use crate::picture::Picture;
use crate::vector::transform;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// The authors' setting: a picture of 3840 pixels, 0.7 m wide, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * PI / 180.0;

/// Contrast sensitivity of a channel of the opponent space: Gaussians `a sqrt(pi / b) exp(-(pi x)^2 / b)`, x in
/// degrees, as (a, b).
const ACHROMATIC: [(f64, f64); 1] = [(1.0, 0.0047)];
const RED_GREEN: [(f64, f64); 1] = [(1.0, 0.0053)];
const BLUE_YELLOW: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];
/// The widest of them, which decides how far all reach.
const WIDEST: f64 = 0.04;
/// Width of the feature detector, degrees.
const FEATURE_WIDTH: f64 = 0.082;
/// Exponents of the colour distance and of the feature distance.
const COLOUR_EXPONENT: f64 = 0.7;
const FEATURE_EXPONENT: f64 = 0.5;
/// Colour distances up to the first part of the largest one take this part of the range.
const KNEE: (f64, f64) = (0.4, 0.95);

/// Linear RGB to XYZ, as the authors round it.
const XYZ: [[f64; 3]; 3] = [
    [
        10_135_552.0 / 24_577_794.0,
        8_788_810.0 / 24_577_794.0,
        4_435_075.0 / 24_577_794.0,
    ],
    [
        2_613_072.0 / 12_288_897.0,
        8_788_810.0 / 12_288_897.0,
        887_015.0 / 12_288_897.0,
    ],
    [
        1_425_312.0 / 73_733_382.0,
        8_788_810.0 / 73_733_382.0,
        70_074_185.0 / 73_733_382.0,
    ],
];
/// And back.
const RGB: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

/// Mean FLIP of two pictures of one size.
pub fn mean(test: &Picture, reference: &Picture, pixels_per_degree: f64) -> f64 {
    let map = map(test, reference, pixels_per_degree);
    map.iter().sum::<f64>() / map.len().max(1) as f64
}

/// FLIP of every pixel of two pictures of one size.
pub fn map(test: &Picture, reference: &Picture, pixels_per_degree: f64) -> Vec<f64> {
    let [test, reference] = [test, reference].map(|picture| Seen::new(picture, pixels_per_degree));
    let largest = largest_distance();
    let flip = |at: usize| {
        let [a, b] = [&test, &reference].map(|picture| &picture.colours[at]);
        let colour = remapped(distance(a, b).powf(COLOUR_EXPONENT), largest);
        let [[edge_a, point_a], [edge_b, point_b]] =
            [&test, &reference].map(|picture| picture.features[at]);
        let feature = (edge_a - edge_b).abs().max((point_a - point_b).abs());
        let feature = (FRAC_1_SQRT_2 * feature).powf(FEATURE_EXPONENT);
        colour.powf(1.0 - feature)
    };
    let pixels = test.colours.len().min(reference.colours.len());
    (0..pixels).into_par_iter().map(flip).collect()
}

/// A picture as the eye takes it in.
struct Seen {
    /// L*, and a* and b* times L* / 100, after the filter of contrast sensitivity.
    colours: Vec<[f64; 3]>,
    /// How much of an edge and of a point there is.
    features: Vec<[f64; 2]>,
}

impl Seen {
    fn new(picture: &Picture, pixels_per_degree: f64) -> Seen {
        let white = transform(&XYZ, [1.0; 3]);
        let opponents: Vec<[f64; 3]> = picture
            .pixels
            .par_iter()
            .map(|&[r, g, b, _]| opponent([r, g, b].map(|v| linear(stored(v))), white))
            .collect();
        let size = [picture.width, picture.height];
        let plane = |channel: usize| -> Vec<f64> { opponents.iter().map(|o| o[channel]).collect() };
        let lightness: Vec<f64> = opponents.iter().map(|o| (o[0] + 16.0) / 116.0).collect();
        let filtered = [
            seen_channel(&plane(0), size, &ACHROMATIC, pixels_per_degree),
            seen_channel(&plane(1), size, &RED_GREEN, pixels_per_degree),
            seen_channel(&plane(2), size, &BLUE_YELLOW, pixels_per_degree),
        ];
        let colours = (0..opponents.len()).into_par_iter().map(|at| {
            let rgb = from_opponent([0, 1, 2].map(|channel| filtered[channel][at]), white);
            perceived(rgb.map(stored), white)
        });
        Seen {
            colours: colours.collect(),
            features: features(&lightness, size, pixels_per_degree),
        }
    }
}

/// sRGB to linear light.
fn linear(value: f64) -> f64 {
    if value > 0.04045 {
        ((value + 0.055) / 1.055).powf(2.4)
    } else {
        value / 12.92
    }
}

/// The opponent space Y Cx Cz, which is linear in light.
fn opponent(rgb: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let xyz = transform(&XYZ, rgb);
    let [x, y, z] = [0, 1, 2].map(|i| xyz[i] / white[i]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn from_opponent([luminance, red_green, blue_yellow]: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let y = (luminance + 16.0) / 116.0;
    let [x, z] = [y + red_green / 500.0, y - blue_yellow / 200.0];
    let xyz = [x * white[0], y * white[1], z * white[2]];
    transform(&RGB, xyz)
}

/// L*a*b* with chroma times L* / 100: colours of dim light look less saturated (Hunt).
fn perceived(rgb: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let xyz = transform(&XYZ, rgb);
    let [x, y, z] = [0, 1, 2].map(|i| {
        let part = xyz[i] / white[i];
        if part > DELTA.powi(3) {
            part.cbrt()
        } else {
            part / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    });
    let lightness = 116.0 * y - 16.0;
    let chroma = 0.01 * lightness;
    [
        lightness,
        chroma * 500.0 * (x - y),
        chroma * 200.0 * (y - z),
    ]
}

/// HyAB: city blocks between lightness and chroma.
fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// The largest colour distance, between full green and full blue, as exponentiated as all are.
fn largest_distance() -> f64 {
    let white = transform(&XYZ, [1.0; 3]);
    let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| perceived(rgb, white));
    distance(&green, &blue).powf(COLOUR_EXPONENT)
}

/// Colour distances in 0..1, the small ones spread.
fn remapped(distance: f64, largest: f64) -> f64 {
    let (part, share) = KNEE;
    let knee = part * largest;
    if distance < knee {
        share / knee * distance
    } else {
        share + (distance - knee) / (largest - knee) * (1.0 - share)
    }
}

/// A channel as the eye's contrast sensitivity lets it through.
fn seen_channel(
    plane: &[f64],
    size: [usize; 2],
    gaussians: &[(f64, f64)],
    pixels_per_degree: f64,
) -> Vec<f64> {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    // Of each Gaussian: its values along a line, and its volume in the plane.
    let lines = gaussians.iter().map(|(a, b)| {
        let value = |x: i32| (-(PI * f64::from(x) / pixels_per_degree).powi(2) / b).exp();
        let line: Vec<f64> = (-radius..=radius).map(value).collect();
        let sum: f64 = line.iter().sum();
        (line, sum, a * (PI / b).sqrt() * sum * sum)
    });
    let lines: Vec<(Vec<f64>, f64, f64)> = lines.collect();
    let volume: f64 = lines.iter().map(|(.., volume)| volume).sum();
    let mut all = vec![0.0; plane.len()];
    for (line, sum, share) in lines {
        let line: Vec<f64> = line.iter().map(|value| value / sum).collect();
        let part = filtered(plane, size, &line, &line);
        for (total, value) in all.iter_mut().zip(part) {
            *total += share / volume * value;
        }
    }
    all
}

/// Sizes of the first derivative of lightness (edges) and of the second (points), after a Gaussian.
fn features(lightness: &[f64], size: [usize; 2], pixels_per_degree: f64) -> Vec<[f64; 2]> {
    let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    let radius = (3.0 * deviation).ceil() as i32;
    let line = |weight: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let value = |x: i32| {
            let x = f64::from(x);
            weight(x) * (-x * x / (2.0 * deviation * deviation)).exp()
        };
        let line: Vec<f64> = (-radius..=radius).map(value).collect();
        // Positive weights sum to 1 and negative ones to -1.
        let sum = |sign: f64| line.iter().map(|v| (sign * v).max(0.0)).sum::<f64>();
        let [up, down] = [sum(1.0), sum(-1.0)];
        let normalised = line.iter().map(|&v| {
            if v > 0.0 {
                v / up
            } else {
                v / down.max(f64::MIN_POSITIVE)
            }
        });
        normalised.collect()
    };
    let smooth = line(&|_| 1.0);
    let edge = line(&|x| -x);
    let point = line(&|x| x * x / (deviation * deviation) - 1.0);
    let along = |derivative: &[f64]| {
        let across = filtered(lightness, size, derivative, &smooth);
        let down = filtered(lightness, size, &smooth, derivative);
        across.into_iter().zip(down).map(|(x, y)| x.hypot(y))
    };
    let (edges, points) = (along(&edge), along(&point));
    edges
        .zip(points)
        .map(|(edge, point)| [edge, point])
        .collect()
}

/// Filters along the rows by one line and along the columns by the other; pixels beyond the edge are those at it.
fn filtered(plane: &[f64], [width, height]: [usize; 2], across: &[f64], down: &[f64]) -> Vec<f64> {
    let reached = |at: usize, step: usize, line: &[f64], size: usize| {
        (at + step).saturating_sub(line.len() / 2).min(size - 1)
    };
    let mut rows = vec![0.0; plane.len()];
    let lines = rows.par_chunks_mut(width).zip(plane.par_chunks(width));
    lines.for_each(|(to, from)| {
        for (x, value) in to.iter_mut().enumerate() {
            let taps = across.iter().enumerate();
            *value = taps
                .map(|(step, weight)| weight * from[reached(x, step, across, width)])
                .sum();
        }
    });
    let mut all = vec![0.0; plane.len()];
    all.par_chunks_mut(width).enumerate().for_each(|(y, to)| {
        for (step, weight) in down.iter().enumerate() {
            let from = reached(y, step, down, height) * width;
            for (value, above) in to.iter_mut().zip(&rows[from..from + width]) {
                *value += weight * above;
            }
        }
    });
    all
}

#[cfg(test)]
#[path = "flip_tests.rs"]
mod tests;
