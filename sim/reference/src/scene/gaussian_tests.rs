//! Tests of colour and of what is skipped.

use super::super::view::look_at;
use super::*;
use crate::camera::Camera;

/// A well-formed Gaussian to be spoilt in one field at a time.
fn sound() -> Gaussian {
    Gaussian {
        centre: [1.0, 2.0, 3.0],
        scales: [0.1, 0.2, 0.3],
        rotation: [2.0, 0.0, 0.0, 0.0],
        opacity: 0.5,
        base: [0.1, -0.2, 0.3],
    }
}

#[test]
fn logits_and_logarithms_have_exact_ends() {
    assert_eq!(opacity_from_logit(f64::INFINITY), 1.0);
    assert_eq!(opacity_from_logit(f64::NEG_INFINITY), 0.0);
    assert_eq!(opacity_from_logit(0.0), 0.5);
    assert!(opacity_from_logit(f64::NAN).is_nan());
    assert!(scale_from_log(f64::NEG_INFINITY).is_nan());
    assert_eq!(scale_from_log(0.0), 1.0);
}

#[test]
fn unusable_records_are_counted_by_reason() {
    let mut scene = GaussianScene::new(0, 2).unwrap();
    scene.push(&sound());
    let spoilers: [fn(&mut Gaussian); 7] = [
        |one| one.centre[0] = f64::NAN,
        |one| one.scales[0] = scale_from_log(1000.0),
        |one| one.scales[0] = scale_from_log(100.0),
        |one| one.opacity = f64::NAN,
        |one| one.base[0] = f64::INFINITY,
        |one| one.rotation[0] = f64::NAN,
        |one| one.rotation = [0.0; 4],
    ];
    for spoil in spoilers {
        let mut spoilt = sound();
        spoil(&mut spoilt);
        scene.push(&spoilt);
    }
    let scene = scene.finish("x").unwrap();
    assert_eq!(
        scene.skipped,
        Skipped {
            non_finite: 6,
            zero_rotation: 1
        }
    );
    let splat = scene.splats[0];
    assert_eq!(scene.splats.len(), 1);
    assert_eq!(splat.colour, [0.1, 0.0, 0.3]);
    assert_eq!(
        splat.axes,
        [[0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3]]
    );
}

#[test]
fn a_scene_of_nothing_but_skips_is_an_error() {
    let mut scene = GaussianScene::new(0, 2).unwrap();
    scene.push(&Gaussian {
        rotation: [0.0; 4],
        ..sound()
    });
    assert_eq!(
        scene.finish("x").unwrap_err().to_string(),
        "splats: none is left (0 with non-finite fields, 1 with a zero rotation); export the scene again"
    );
}

#[test]
fn quaternions_of_any_length_turn_the_axes() {
    // A quarter turn about z: x goes to y.
    let matrix = rotation_matrix([3.0, 0.0, 0.0, 3.0]).unwrap();
    let turned = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    for (value, expected) in matrix.as_flattened().iter().zip(turned.as_flattened()) {
        assert!((value - expected).abs() < 1e-15);
    }
}

/// The harmonics are orthonormal over the sphere; a wrong constant or a mixed-up term shows at once.
#[test]
fn harmonics_are_orthonormal() {
    let steps = 200;
    let mut products = [[0.0; HARMONICS]; HARMONICS];
    for i in 0..steps {
        let z = (i as f64 + 0.5) / steps as f64 * 2.0 - 1.0;
        for j in 0..steps {
            let angle = j as f64 / steps as f64 * std::f64::consts::TAU;
            let radius = (1.0 - z * z).sqrt();
            let basis = harmonic_basis([radius * angle.cos(), radius * angle.sin(), z]);
            for (row, a) in products.iter_mut().zip(basis) {
                for (sum, b) in row.iter_mut().zip(basis) {
                    *sum += a * b;
                }
            }
        }
    }
    let area = 4.0 * std::f64::consts::PI / (steps * steps) as f64;
    for (k, row) in products.iter().enumerate() {
        for (l, sum) in row.iter().enumerate() {
            let expected = f64::from(u8::from(k == l));
            assert!(
                (sum * area - expected).abs() < 1e-3,
                "harmonics {k} and {l}: {}",
                sum * area
            );
        }
    }
}

/// One splat with one degree-1 coefficient per axis, looked at along each axis.
#[test]
fn colour_follows_the_direction_from_the_eye_to_the_splat() {
    let mut scene = GaussianScene::new(1, 2).unwrap();
    scene.harmonics = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    scene.push(&Gaussian {
        base: [0.5; 3],
        ..sound()
    });
    let scene = scene.finish("x").unwrap();
    let seen_from = |offset: [f64; 3], up: [f64; 3]| {
        let eye = [1.0 + offset[0], 2.0 + offset[1], 3.0 + offset[2]];
        scene.colours(&look_at(eye, [1.0, 2.0, 3.0], up, 50.0, 64, 48))[0]
    };
    let near = |found: [f64; 3], expected: [f64; 3]| {
        let off = vector::length(vector::subtract(found, expected));
        assert!(off < 1e-9, "{found:?} {expected:?}");
    };
    let part = 0.488_602_511_902_919_9;
    let (up, level) = ([0.0, 0.0, 1.0], [0.0, -1.0, 0.0]);
    // Red is -y, green is z, blue is -x of the direction, which runs away from the eye; sums stop at 0.
    near(seen_from([0.0, -4.0, 0.0], up), [0.5 - part, 0.5, 0.5]);
    near(seen_from([0.0, 0.0, -4.0], level), [0.5, 0.5 + part, 0.5]);
    near(seen_from([4.0, 0.0, 0.0], level), [0.5, 0.5, 0.5 + part]);
    let (eye, target) = ([90.0, 50.0, -4.0], [90.0, 50.0, 0.0]);
    let parallel = Camera {
        orthographic: true,
        ..look_at(eye, target, level, 50.0, 64, 48)
    };
    near(scene.colours(&parallel)[0], [0.5, 0.5 + part, 0.5]);
}

#[test]
fn a_negative_sum_is_clamped() {
    assert_eq!(
        colour([0.1; 3], &[[1.0, 0.0, -1.0]], [0.0, 1.0, 0.0]),
        [0.0, 0.1f32.into(), 0.1f32 as f64 + 0.488_602_511_902_919_9]
    );
}
