//! The oracle is the same conversions by the standard library's functions, each number by itself, as the host had them
//! before.

extern crate std;

use super::*;
use crate::view::{Projection, View};
use proptest::prelude::*;
use std::vec::Vec;

/// Any double: all bit patterns, and more often numbers that occur.
fn numbers() -> impl Strategy<Value = f64> {
    prop_oneof![
        2 => any::<u64>().prop_map(f64::from_bits),
        4 => -20.0f64..20.0,
        2 => (-1.0f64..1.0, -60i32..60).prop_map(|(m, e)| m * f64::from(e).exp2()),
        1 => any::<f32>().prop_map(f64::from),
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(1.0), Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(f64::MIN_POSITIVE / 8.0)],
    ]
}

fn oracle_rotation(rows: [[f64; 3]; 3]) -> (Rotation, [[i32; 3]; 3]) {
    let fine =
        rows.map(|row| row.map(|entry| (entry.clamp(-1.0, 1.0) * 60f64.exp2()).round() as i64));
    let coarse = fine.map(|row| row.map(|entry| (entry + (1 << 29)) >> 30));
    let rest = [0, 1, 2].map(|i| [0, 1, 2].map(|j| (fine[i][j] - (coarse[i][j] << 30)) as i32));
    let entry = |bits: i64| I2F30::from_bits(bits as i32);
    (coarse.map(|row| row.map(entry)), rest)
}

fn oracle_view(camera: &Camera, scale_log2: i32) -> View {
    let (rotation, rotation_rest) = oracle_rotation(camera.rotation);
    let ([fx, fy], [cx, cy]) = (camera.focal, camera.principal);
    let [width, height] = camera.size.map(f64::from);
    let half = [width / (2.0 * fx), height / (2.0 * fy)];
    let low = [-(cx / fx + 0.3 * half[0]), -(cy / fy + 0.3 * half[1])];
    let high = [
        (width - cx) / fx + 0.3 * half[0],
        (height - cy) / fy + 0.3 * half[1],
    ];
    let position = camera.eye();
    let largest = position.iter().fold(0.0f64, |m, value| m.max(value.abs()));
    let leading = extended(largest).leading();
    let depth = |value: f64| {
        let number = extended(value);
        Extended {
            exponent: number.exponent + scale_log2,
            ..number
        }
    };
    let orthographic = camera.projection == Projection::Orthographic;
    let focal_unit = if orthographic { -scale_log2 } else { 0 };
    View {
        rotation,
        pose: if largest == 0.0 {
            Eye {
                rotation_rest,
                ..Eye::ORIGIN
            }
        } else {
            let unit = f64::from(58 - leading).exp2();
            Eye {
                position: position.map(|value| (value * unit).round() as i64),
                exponent: leading - 58 + scale_log2,
                rotation_rest,
            }
        },
        focal: [
            scaled(fx).scaled_by(focal_unit),
            scaled(fy).scaled_by(focal_unit),
        ],
        principal: [cx, cy].map(I32F32::saturating_from_num),
        near: depth(camera.near),
        far: if camera.far.is_finite() {
            depth(camera.far)
        } else {
            Extended::MAX
        },
        viewport: camera.size,
        projection: camera.projection,
        limits: crate::view::RatioLimits {
            low: low.map(I32F32::saturating_from_num),
            high: high.map(I32F32::saturating_from_num),
        },
    }
}

proptest! {
    #[test]
    fn doubles_arrive_as_they_are(value in numbers()) {
        let got = extended(value);
        let expected = if value.is_finite() { value } else { 0.0 };
        // Two factors, because a power of two below the smallest double is 0.
        let back = got.value as f64 * f64::from(got.exponent / 2).exp2() * f64::from(got.exponent - got.exponent / 2).exp2();
        prop_assert_eq!(back, expected);
        let short = scaled(value);
        prop_assert_eq!(short, SoftFloat::from_wide(got.value, got.exponent, 31));
        if value.is_normal() {
            let back = f64::from(short.mantissa) * f64::from(short.exponent / 2).exp2() * f64::from(short.exponent - short.exponent / 2).exp2();
            prop_assert!((back / value - 1.0).abs() <= 31f64.exp2().recip() || value.abs() > 1e308, "{} {}", value, back);
        }
    }

    #[test]
    fn singles_are_exact(value in any::<f32>().prop_filter("finite", |value| value.is_finite())) {
        let got = scaled(value.into());
        let back = f64::from(got.mantissa) * f64::from(got.exponent).exp2();
        prop_assert_eq!(back, f64::from(value));
    }

    #[test]
    fn fixed_points_are_those_of_the_standard_library(value in numbers()) {
        let whole = (value * 28f64.exp2()).clamp(0.0, u32::MAX.into()).floor();
        let odd = u32::from(whole < value * 28f64.exp2());
        prop_assert_eq!(colour(value).to_bits(), whole as u32 | odd);
        let in_pixels = if value.is_nan() { I32F32::ZERO } else { I32F32::saturating_from_num(value) };
        prop_assert_eq!(pixels(value), in_pixels);
        prop_assert_eq!(threshold(value), (value.clamp(0.0, 1.0) * 60f64.exp2()).round() as u64);
        prop_assert_eq!(opacity_limit(value), (value * 31f64.exp2()).round().clamp(0.0, 31f64.exp2()) as u32);
        prop_assert_eq!(radial_cutoff(value), (value * 28f64.exp2()).round().clamp(0.0, 15.0 * 28f64.exp2()) as u32);
        prop_assert_eq!(depth(value), (value * 23f64.exp2()).round() as u32);
        prop_assert_eq!(coefficient(value).to_bits(), (value * 28f64.exp2()).round_ties_even() as i32);
    }

    /// The oracle turns unit vectors by products of quaternions, `q e q*`.
    #[test]
    fn gaussians_are_turned_by_their_quaternion(q in prop::array::uniform4(-9.0f32..9.0), scales in prop::array::uniform3(0.5f32..2.0)) {
        let length = q.iter().map(|part| f64::from(*part).powi(2)).sum::<f64>().sqrt();
        prop_assume!(length > 0.1);
        let q = q.map(|part| part / length as f32 * 3.0);
        let splat = Gaussian { rotation: q, scales, ..Gaussian::UNIT }.splat().unwrap();
        let q = q.map(|part| f64::from(part) / 3.0);
        for k in 0..3 {
            let mut e = [0.0; 4];
            e[k + 1] = f64::from(scales[k]);
            let turned = hamilton(hamilton(q, e), [q[0], -q[1], -q[2], -q[3]]);
            prop_assert!(is_near(numbers_of(splat.axes[k]), [turned[1], turned[2], turned[3]], 1e-6));
        }
    }

    #[test]
    fn a_point_is_a_gaussian_of_one_scale(deviation in 0.01f32..100.0) {
        let point = Point { position: [1.0, 2.0, 3.0], deviation, opacity: 0.5, colour: [0.1, 0.2, 0.3] };
        let gaussian = Gaussian {
            mean: point.position, rotation: [1.0, 0.0, 0.0, 0.0], scales: [deviation; 3], opacity: 0.5, colour: point.colour,
        };
        prop_assert_eq!(point.splat(), gaussian.splat());
    }

    #[test]
    fn a_normal_is_a_unit_vector_across_its_tangents(tangents in prop::array::uniform2(prop::array::uniform3(-9.0f32..9.0))) {
        let [a, b] = tangents.map(|tangent| tangent.map(f64::from));
        let across = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let length = across.iter().map(|part| part * part).sum::<f64>().sqrt();
        prop_assume!(length > 1e-3);
        let surfel = Surfel { position: [0.0; 3], tangents, weight: 1.0, colour: [0.0; 3], opacity: 1.0, material: 0 };
        let normal = numbers_of(surfel.splat().unwrap().normal);
        prop_assert!(is_near(normal, across.map(|part| part / length), 1e-8));
    }

    #[test]
    fn rotations_are_those_of_the_standard_library(rows in prop::array::uniform3(prop::array::uniform3(numbers()))) {
        prop_assert_eq!(rotation(rows), oracle_rotation(rows));
    }

    #[test]
    fn views_are_those_of_the_standard_library(
        eye in prop::array::uniform3(-1e3f64..1e3), target in prop::array::uniform3(-10.0f64..10.0), fov in 1.0f64..170.0,
        size in prop::array::uniform2(1u16..=32768), near in 1e-6f64..1.0, far in prop_oneof![Just(f64::INFINITY), 2.0f64..1e12],
        orthographic: bool, scale_log2 in -40i32..40, origin: bool,
    ) {
        let eye = if origin { [0.0; 3] } else { eye };
        let Ok(mut camera) = Camera::look_at(eye, target, [0.1, -1.0, 0.2], fov, size) else {
            return Err(TestCaseError::reject("parallel to up"));
        };
        camera = camera.with_range(near, far);
        if orthographic {
            camera = camera.orthographic(fov);
        }
        prop_assert_eq!(camera.quantised(scale_log2), oracle_view(&camera, scale_log2));
        prop_assert_eq!(camera.view(), Ok(oracle_view(&camera, 0)));
    }

    #[test]
    fn every_camera_and_primitive_is_defined(parts in prop::collection::vec(numbers(), 24), size: [u16; 2], orthographic: bool, scale: i32) {
        let three = |i: usize| [parts[i], parts[i + 1], parts[i + 2]];
        let camera = Camera {
            size,
            focal: [parts[0], parts[1]],
            principal: [parts[2], parts[3]],
            rotation: [three(4), three(7), three(10)],
            translation: three(13),
            near: parts[16],
            far: parts[17],
            projection: if orthographic { Projection::Orthographic } else { Projection::Perspective },
        };
        let _ = (camera.view(), camera.quantised(scale), camera.eye());
        let _ = Camera::look_at(three(0), three(3), three(6), parts[9], size);
        let row = |i: usize| [parts[i], parts[i + 1], parts[i + 2], parts[i + 3]];
        let matrix = [row(0), row(4), row(8), [0.0, 0.0, 0.0, 1.0]];
        let _ = Camera::from_matrix(matrix, [parts[12], parts[13]], [parts[14], parts[15]], size);
        let single: Vec<f32> = parts.iter().map(|part| *part as f32).collect();
        let three = |i: usize| [single[i], single[i + 1], single[i + 2]];
        let four = [single[0], single[1], single[2], single[3]];
        let gaussian = Gaussian { mean: three(4), rotation: four, scales: three(7), opacity: single[10], colour: three(11) };
        let all_finite = single[..14].iter().all(|value| value.is_finite());
        prop_assert_eq!(gaussian.splat().is_some(), all_finite && four != [0.0; 4]);
        let _ = Gaussian::from_trained(three(4), four, three(7), single[10], three(11)).splat();
        let point = Point { position: three(0), deviation: single[3], opacity: single[4], colour: three(5) };
        prop_assert_eq!(point.splat().is_some(), single[..8].iter().all(|value| value.is_finite()));
        let surfel = Surfel { position: three(0), tangents: [three(3), three(6)], weight: single[9], colour: three(10), opacity: single[13], material: 0 };
        let _ = surfel.splat();
    }
}

fn hamilton([a, b, c, d]: [f64; 4], [e, f, g, h]: [f64; 4]) -> [f64; 4] {
    [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]
}

fn numbers_of(axis: Axis) -> [f64; 3] {
    axis.mantissa
        .map(|m| f64::from(m) * f64::from(axis.exponent).exp2())
}

fn is_near(got: [f64; 3], expected: [f64; 3], tolerance: f64) -> bool {
    (0..3).all(|i| (got[i] - expected[i]).abs() <= tolerance)
}

#[test]
fn cameras_that_are_none_are_refused() {
    let good = Camera::look_at([0.0, 0.0, -4.0], [0.0; 3], [0.0, -1.0, 0.0], 45.0, [64; 2]);
    let good = good.unwrap();
    let look = |eye, up, fov, size| Camera::look_at(eye, [0.0; 3], up, fov, size).map(|_| ());
    let (eye, up) = ([0.0, 0.0, -4.0], [0.0, -1.0, 0.0]);
    assert_eq!(look(eye, up, 45.0, [64; 2]), Ok(()));
    assert_eq!(look(eye, up, 45.0, [64, 0]), Err(CameraError::Size));
    assert_eq!(look(eye, up, 45.0, [32769, 1]), Err(CameraError::Size));
    assert_eq!(look(eye, up, 45.0, [32768, 1]), Ok(()));
    assert_eq!(look(eye, up, 0.5, [64; 2]), Ok(()));
    assert_eq!(look(eye, up, 0.0, [64; 2]), Err(CameraError::FieldOfView));
    assert_eq!(look(eye, up, 180.0, [64; 2]), Err(CameraError::FieldOfView));
    assert_eq!(
        look(eye, up, f64::NAN, [64; 2]),
        Err(CameraError::FieldOfView)
    );
    assert_eq!(
        look([0.0; 3], up, 45.0, [64; 2]),
        Err(CameraError::Direction)
    );
    assert_eq!(look(eye, eye, 45.0, [64; 2]), Err(CameraError::Up));
    // Up at the smallest angle to the direction, and above it.
    let leaning = |sine| look(eye, [sine, 0.0, 1.0], 45.0, [64; 2]);
    assert_eq!(leaning(1e-6), Err(CameraError::Up));
    assert_eq!(leaning(2e-6), Ok(()));
    assert_eq!(look(eye, [0.0; 3], 45.0, [64; 2]), Err(CameraError::Up));
    let wrong = [
        (
            Camera {
                focal: [0.0, 1.0],
                ..good
            },
            CameraError::Focal,
        ),
        (
            Camera {
                principal: [f64::NAN; 2],
                ..good
            },
            CameraError::Principal,
        ),
        (
            Camera {
                rotation: [[1.0, 0.0, 0.0]; 3],
                ..good
            },
            CameraError::Rotation,
        ),
        (
            Camera {
                rotation: good.rotation.map(|row| row.map(|x| -x)),
                ..good
            },
            CameraError::Rotation,
        ),
        (
            Camera {
                translation: [f64::INFINITY; 3],
                ..good
            },
            CameraError::Translation,
        ),
        (Camera { near: 0.0, ..good }, CameraError::Near),
        (Camera { far: 0.01, ..good }, CameraError::Far),
        (
            Camera {
                far: f64::NAN,
                ..good
            },
            CameraError::Far,
        ),
    ];
    for (camera, error) in wrong {
        assert_eq!(camera.view(), Err(error));
    }
    let turned = |rotation| Camera { rotation, ..good }.view().map(|_| ());
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let leaning = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i: usize| 0.6 * a[i] + 0.8 * b[i]);
    // A row of another length, and two rows that are not at right angles: in each of the six ways alone.
    for rotation in [
        [x.map(|c| 2.0 * c), y, z],
        [x, y.map(|c| 2.0 * c), z],
        [x, y, z.map(|c| 2.0 * c)],
        [x, leaning(x, y), z],
        [x, y, leaning(x, z)],
        [x, y, leaning(y, z)],
    ] {
        assert_eq!(turned(rotation), Err(CameraError::Rotation), "{rotation:?}");
    }
    assert_eq!(turned([x, [1e-4, 1.0, 0.0], z]), Ok(()));
    let small = Camera {
        focal: [0.5; 2],
        ..good
    };
    assert!(small.view().is_ok());
}

#[test]
fn a_camera_has_what_its_methods_say() {
    let eye = [0.0, 0.0, -4.0];
    let camera = Camera::look_at(eye, [0.0; 3], [0.0, -1.0, 0.0], 45.0, [64; 2]).unwrap();
    assert_eq!((camera.near, camera.far), (0.01, f64::INFINITY));
    let other = camera.orthographic(8.0).with_range(0.5, 9.0);
    let expected = Camera {
        focal: [8.0; 2],
        projection: Projection::Orthographic,
        near: 0.5,
        far: 9.0,
        ..camera
    };
    assert_eq!(other, expected);
    // The eye of a matrix that is no rotation: W e = -d.
    let stretched = Camera {
        rotation: [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [-4.0, 3.0, 5.0],
        ..camera
    };
    assert_eq!(stretched.eye(), [2.0, -3.0, -5.0]);
    // Squares of such coordinates overflow or vanish.
    for far in [1e200, 1e-200] {
        let camera = Camera::look_at([far, 0.0, 0.0], [0.0; 3], [0.0, -1.0, 0.0], 45.0, [64; 2]);
        assert_eq!(camera.unwrap().rotation[2], [-1.0, 0.0, 0.0]);
    }
}

/// A camera and the matrix it has are the same camera; a matrix of few digits gives a rotation, seen from the same eye.
#[test]
fn matrices_are_cameras() {
    let camera = Camera::look_at(
        [3.0, -2.0, 1.0],
        [0.5, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        45.0,
        [64; 2],
    );
    let camera = camera.unwrap();
    let matrix = |round: f64| {
        let mut rows = [[0.0, 0.0, 0.0, 1.0]; 4];
        for (row, (entries, offset)) in rows
            .iter_mut()
            .zip(camera.rotation.iter().zip(camera.translation))
        {
            let [x, y, z] = entries.map(|entry| (entry * round).round() / round);
            *row = [x, y, z, offset];
        }
        Camera::from_matrix(rows, camera.focal, camera.principal, camera.size).unwrap()
    };
    for (round, tolerance) in [(2f64.powi(52), 1e-15), (1e5, 2e-5)] {
        let got = matrix(round);
        assert_eq!(got.near, 0.01);
        assert!(is_near(got.eye(), camera.eye(), 4.0 * tolerance));
        for (row, other) in got
            .rotation
            .iter()
            .zip(got.rotation.iter().skip(1).chain(&got.rotation[..1]))
        {
            let product =
                |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            assert!((product(row, row) - 1.0).abs() < 1e-15 && product(row, other).abs() < 1e-15);
        }
        for (entry, expected) in got
            .rotation
            .iter()
            .flatten()
            .zip(camera.rotation.iter().flatten())
        {
            assert!((entry - expected).abs() <= tolerance, "{entry} {expected}");
        }
    }
    let [x, y, z] = camera.eye();
    assert!((x - 3.0).abs() < 1e-14 && (y + 2.0).abs() < 1e-14 && (z - 1.0).abs() < 1e-14);
}

/// The target is in the middle of the picture, a point `fov / 2` above it on the upper edge.
#[test]
fn a_camera_looks_at_its_target() {
    let camera = Camera::look_at(
        [3.0, -2.0, 1.0],
        [0.5, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        60.0,
        [80, 60],
    )
    .unwrap();
    let place = |point: [f64; 3]| {
        let t = [0, 1, 2].map(|i: usize| {
            (0..3)
                .map(|k| camera.rotation[i][k] * point[k])
                .sum::<f64>()
                + camera.translation[i]
        });
        [0, 1].map(|i: usize| camera.focal[i] * t[i] / t[2] + camera.principal[i])
    };
    let near = |got: [f64; 2], expected: [f64; 2]| {
        got.iter().zip(expected).all(|(g, e)| (g - e).abs() < 1e-12)
    };
    assert!(near(place([0.5, 0.0, 0.0]), [40.0, 30.0]));
    let distance = (2.5f64.powi(2) + 4.0 + 1.0).sqrt();
    let up = camera.rotation[1].map(|c| -c * distance * 30f64.to_radians().tan());
    assert!(near(place([0.5 + up[0], up[1], up[2]]), [40.0, 0.0]));
}

#[test]
fn a_turned_gaussian_has_the_covariance_of_its_matrix() {
    // A quarter turn about z takes x to y.
    let half = 0.5f32.sqrt();
    let gaussian = Gaussian {
        rotation: [half, 0.0, 0.0, half],
        scales: [1.0, 2.0, 4.0],
        ..Gaussian::UNIT
    };
    let splat = gaussian.splat().unwrap();
    let axes = splat.axes.map(|a| {
        a.mantissa
            .map(|m| f64::from(m) * f64::from(a.exponent).exp2())
    });
    let expected = [[0.0, 1.0, 0.0], [-2.0, 0.0, 0.0], [0.0, 0.0, 4.0]];
    for (got, expected) in axes.iter().flatten().zip(expected.iter().flatten()) {
        assert!((got - expected).abs() < 1e-7, "{axes:?}");
    }
    // The length of a quaternion does not count.
    let longer = Gaussian {
        rotation: [1e20, 0.0, 0.0, 1e20],
        ..gaussian
    };
    assert_eq!(longer.splat().map(|s| s.centre), Some(splat.centre));
}

#[test]
fn trained_numbers_become_ordinary_ones() {
    let logit = |value| {
        Gaussian::from_trained(
            [0.0; 3],
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, -2.0],
            value,
            [0.0, 1.0, -9.0],
        )
    };
    let got = logit(0.0);
    assert_eq!(got.scales, [1.0, 1f32.exp(), (-2f32).exp()]);
    assert_eq!((got.opacity, got.colour), (0.5, [0.5, 0.782_094_8, 0.0]));
    assert_eq!(
        (
            logit(f32::INFINITY).opacity,
            logit(f32::NEG_INFINITY).opacity
        ),
        (1.0, 0.0)
    );
    let unscaled =
        Gaussian::from_trained([0.0; 3], [1.0; 4], [f32::NEG_INFINITY; 3], 0.0, [0.0; 3]);
    assert_eq!(unscaled.splat(), None);
}

#[test]
fn a_surfel_has_the_normal_of_its_plane() {
    let surfel = Surfel {
        position: [0.0; 3],
        tangents: [[1e-30, 0.0, 0.0], [0.0, 1e-30, 0.0]],
        weight: 1.0,
        colour: [2.0, 0.5, -1.0],
        opacity: 1.0,
        material: 3,
    };
    let splat = surfel.splat().unwrap();
    assert_eq!(splat.normal, axis([0.0, 0.0, 1.0]));
    let longest = Surfel {
        tangents: [[f32::MAX, 0.0, 0.0], [0.0, f32::MAX, f32::MAX]],
        ..surfel
    };
    let part = 1.0 / 2f64.sqrt();
    assert_eq!(longest.splat().unwrap().normal, axis([0.0, -part, part]));
    assert_eq!(splat.colour, [1.0, 0.5, 0.0].map(U4F28::from_num));
    let flat = Surfel {
        tangents: [[1.0, 2.0, 3.0]; 2],
        ..surfel
    };
    assert_eq!(flat.splat(), None);
    let infinite = f32::INFINITY;
    for none in [
        Surfel {
            position: [infinite; 3],
            ..surfel
        },
        Surfel {
            colour: [infinite; 3],
            ..surfel
        },
        Surfel {
            weight: infinite,
            ..surfel
        },
        Surfel {
            opacity: infinite,
            ..surfel
        },
    ] {
        assert_eq!(none.splat(), None);
    }
}
