//! FLIP against the authors' package.

use super::*;

/// Made by `assets/flip.py`, which the authors' package computes.
const EXPECTED: &str = include_str!("../assets/flip.tsv");
const SIZE: [usize; 2] = [40, 28];

/// The pictures of `assets/flip.py`.
fn picture(shift: usize) -> Picture {
    let [width, height] = SIZE;
    let channel = |x: usize, y: usize, c: usize| {
        let smooth = (5 * x + 3 * y * (c + 1)) % 256;
        let blocks = 90 * ((x / 7 + y / 5 + c) % 2);
        let noise = (shift * (37 * x + 101 * y + 53 * c + x * y)) % 41;
        (smooth / 2 + blocks + noise) as f64 / 255.0
    };
    let pixel = |at: usize| {
        let (x, y) = (at % width, at / width);
        [channel(x, y, 0), channel(x, y, 1), channel(x, y, 2), 1.0]
    };
    Picture {
        width,
        height,
        pixels: (0..width * height).map(pixel).collect(),
    }
}

#[test]
fn every_pixel_is_the_authors() {
    let (test, reference) = (picture(1), picture(0));
    let mut lines = 0;
    for line in EXPECTED.lines().filter(|line| !line.starts_with('#')) {
        let numbers: Vec<f64> = line.split('\t').map(|n| n.parse().unwrap()).collect();
        let [pixels_per_degree, mean, ref expected @ ..] = numbers[..] else {
            panic!("a line without numbers")
        };
        let map = map(&test, &reference, pixels_per_degree);
        assert_eq!(map.len(), expected.len());
        for (at, (computed, expected)) in map.iter().zip(expected).enumerate() {
            let difference = (computed - expected).abs();
            assert!(difference < 1e-4, "pixel {at}: {computed} {expected}");
        }
        let computed = super::mean(&test, &reference, pixels_per_degree);
        assert!((computed - mean).abs() < 1e-5, "{computed} {mean}");
        lines += 1;
    }
    assert_eq!(lines, 2);
}

#[test]
fn equal_pictures_look_equal_and_black_and_white_do_not() {
    let same = picture(1);
    assert_eq!(mean(&same, &same, PIXELS_PER_DEGREE), 0.0);
    let plain = |value: f64| Picture {
        width: 3,
        height: 2,
        pixels: vec![[value, value, value, 1.0]; 6],
    };
    let most = mean(&plain(1.0), &plain(0.0), PIXELS_PER_DEGREE);
    assert!(most > 0.9 && most <= 1.0, "{most}");
    assert!((PIXELS_PER_DEGREE - 67.020_643_276_582_3).abs() < 1e-12);
}
