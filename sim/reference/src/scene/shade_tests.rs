//! Tests of classification and shading, and the measurement behind the kernel's width.

use super::*;
use crate::scene::Weight;

fn transfer(text: &str) -> Transfer {
    Transfer::from_toml(text).unwrap()
}

const STEP: &str = "[[value]]\nat = 1.0\ncolour = [0.5, 0.5, 0.5]\nextinction = 0.0\n\
                    [[value]]\nat = 2.0\ncolour = [0.5, 0.5, 0.5]\nextinction = 3.0\n";

fn volume(sizes: [usize; 3], spacings: [f64; 3], value: impl Fn([usize; 3]) -> f32) -> Volume {
    let mut values = Vec::new();
    for z in 0..sizes[2] {
        for y in 0..sizes[1] {
            values.extend((0..sizes[0]).map(|x| value([x, y, z])));
        }
    }
    Volume {
        sizes,
        spacings,
        values,
        notes: Vec::new(),
    }
}

#[test]
fn visible_voxels_become_splats_with_mass_and_place() {
    let grid = volume([3, 2, 2], [3.0, 2.0, 0.5], |place| {
        if place == [2, 1, 0] { 2.0 } else { 0.0 }
    });
    let scene = shade(&grid, &transfer(STEP), DEFAULT_LIGHT, "x").unwrap();
    assert_eq!(scene.splats.len(), 1);
    let splat = scene.splats[0];
    assert_eq!(splat.centre, [7.5, 3.0, 0.25]);
    assert_eq!(splat.weight, 3.0 * 3.0);
    let expected = [
        [3.0 * SIGMA, 0.0, 0.0],
        [0.0, 2.0 * SIGMA, 0.0],
        [0.0, 0.0, 0.5 * SIGMA],
    ];
    assert_eq!(splat.axes, expected);
    assert_eq!(
        (scene.weight, scene.natural_rules),
        (Weight::Mass, Rules::EWA)
    );
}

/// A linear ramp has the same gradient everywhere, at the border and beside a hole as well.
#[test]
fn gradients_honour_spacings_and_borders() {
    let mut grid = volume([4, 3, 5], [3.0, 2.0, 0.5], |[x, y, z]| {
        6.0 * x as f32 - 2.0 * y as f32 + z as f32
    });
    for index in 0..grid.values.len() {
        assert_eq!(
            grid.gradient(grid.place(index), index),
            [2.0, -1.0, 2.0],
            "voxel {index}"
        );
    }
    grid.values[0] = f32::NAN;
    assert_eq!(grid.gradient([1, 0, 0], 1), [2.0, -1.0, 2.0]);
    let single = volume([1, 1, 1], [1.0; 3], |_| 5.0);
    assert_eq!(single.gradient([0, 0, 0], 0), [0.0; 3]);
}

#[test]
fn values_that_are_not_finite_are_counted() {
    let grid = volume([2, 2, 1], [1.0; 3], |place| {
        if place == [0, 0, 0] {
            f32::INFINITY
        } else {
            2.0
        }
    });
    let scene = shade(&grid, &transfer(STEP), DEFAULT_LIGHT, "x").unwrap();
    assert_eq!((scene.splats.len(), scene.skipped.non_finite), (3, 1));
    assert_eq!(grid.range(), Some((2.0, 2.0)));
}

#[test]
fn a_gradient_multiplier_of_zero_hides_the_inside() {
    let text = format!(
        "{STEP}[[gradient]]\nat = 0.0\nmultiplier = 0.0\n[[gradient]]\nat = 1.0\nmultiplier = 1.0\n"
    );
    let cube = |[x, y, z]: [usize; 3]| {
        if [x, y, z].iter().all(|part| (1..6).contains(part)) {
            2.0
        } else {
            0.0
        }
    };
    let scene = shade(
        &volume([7, 7, 7], [1.0; 3], cube),
        &transfer(&text),
        DEFAULT_LIGHT,
        "x",
    )
    .unwrap();
    assert_eq!(scene.splats.len(), 125 - 27, "the shell of a cube of 5");
}

/// Phong's model by hand: a surface towards, across and away from the light.
#[test]
fn surfaces_are_shaded_by_their_normal() {
    let lamp = Lamp::new([0.0, 0.0, -2.0]).unwrap();
    let shading = Shading {
        ambient: 0.2,
        diffuse: 0.6,
        specular: 0.1,
        exponent: 10.0,
        surface: 0.0,
    };
    let shade = |gradient| lamp.phong([0.5; 3], gradient, &shading)[0];
    // The normal runs against the gradient: density rising along z faces the light and the viewer.
    assert!((shade([0.0, 0.0, 4.0]) - (0.5 * 0.8 + 0.1)).abs() < 1e-12);
    assert!((shade([4.0, 0.0, 0.0]) - 0.5 * 0.2).abs() < 1e-12);
    assert!((shade([0.0, 0.0, -4.0]) - 0.5 * 0.2).abs() < 1e-12);
    assert!(
        (shade([0.0; 3]) - 0.5 * 0.5).abs() < 1e-12,
        "no normal: the average"
    );
    let soft = Shading {
        surface: 8.0,
        ..shading
    };
    let half = lamp.phong([0.5; 3], [0.0, 0.0, 4.0], &soft)[0];
    assert!(
        (half - (0.5 * (0.2 + 0.6 * 0.75) + 0.05)).abs() < 1e-12,
        "half a surface: {half}"
    );
}

#[test]
fn the_messages_name_the_fix() {
    let grid = volume([2, 1, 1], [1.0; 3], |_| 2.0);
    for light in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
        let message = shade(&grid, &transfer(STEP), light, "x")
            .unwrap_err()
            .to_string();
        assert!(
            message.ends_with("is no direction; give three finite numbers, not all zero"),
            "{message}"
        );
    }
    let dark = volume([2, 1, 1], [1.0; 3], |_| 0.0);
    assert_eq!(
        shade(&dark, &transfer(STEP), DEFAULT_LIGHT, "x")
            .unwrap_err()
            .to_string(),
        "transfer function: it leaves no voxel visible (0 were not finite); \
         give a transfer function with extinction within the data's range"
    );
}

/// Mean and relative root-mean-square ripple of the summed footprints of one sheet of unit voxels, seen face on.
fn sheet(sigma: f64, cutoff: f64) -> (f64, f64) {
    let steps = 32;
    let peak = 1.0 / (std::f64::consts::TAU * sigma * sigma);
    let sum_at = |u: f64, v: f64| -> f64 {
        let footprint = |place: usize| {
            let (x, y) = ((place % 19) as f64 - 9.0 - u, (place / 19) as f64 - 9.0 - v);
            let radial_index = (x * x + y * y) / (sigma * sigma);
            if radial_index < cutoff {
                peak * (-radial_index / 2.0).exp()
            } else {
                0.0
            }
        };
        (0..19 * 19).map(footprint).sum()
    };
    let places = (0..steps * steps).map(|i| {
        (
            (i % steps) as f64 / steps as f64,
            (i / steps) as f64 / steps as f64,
        )
    });
    let sums: Vec<f64> = places.map(|(u, v)| sum_at(u, v)).collect();
    let mean = sums.iter().sum::<f64>() / sums.len() as f64;
    let variance = sums.iter().map(|sum| (sum - mean).powi(2)).sum::<f64>() / sums.len() as f64;
    (mean, variance.sqrt() / mean)
}

/// The figures in the documentation of [`SIGMA`].
#[test]
fn kernels_sum_to_nearly_a_constant() {
    let (mean, ripple) = sheet(SIGMA, 80.0);
    assert!(
        (mean - 1.0).abs() < 1e-6 && ripple < 1e-5,
        "whole kernels: {mean}, {ripple}"
    );
    let (mean, ripple) = sheet(SIGMA, Rules::EWA.cutoff);
    assert!(
        (mean - (1.0 - (-2.0f64).exp())).abs() < 1e-3,
        "the cut-off leaves {mean}"
    );
    assert!((0.0235..0.0255).contains(&ripple), "{ripple}");
    assert!((0.067..0.070).contains(&sheet(0.5, 4.0).1));
    assert!((0.046..0.049).contains(&sheet(0.7, 4.0).1));
}
