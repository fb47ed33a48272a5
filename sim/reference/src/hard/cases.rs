//! The hard cases: small scenes that each push one quantity to where arithmetic breaks.
//!
//! All inputs are single-precision numbers, so that no arithmetic under test starts with an input that it cannot hold.

use crate::camera::Camera;
use crate::engines::golden::rotated_axes;
use crate::rules::Rules;
use crate::scene::{Scene, Splat};
use crate::vector;

/// Columns and rows of the pictures.
const SIZE: usize = 64;
/// Focal length of the camera, pixels.
const FOCAL: f64 = 64.0;
/// Rules without a smallest opacity, for splats fainter than 1/255.
const FAINT: Rules = Rules {
    name: "faint",
    alpha_min: 0.0,
    cutoff: 9.0,
    ..Rules::GAUSSIAN_3D
};
/// Rules without a low-pass filter.
const SHARP: Rules = Rules {
    name: "sharp",
    low_pass: 0.0,
    ..Rules::GAUSSIAN_3D
};

/// One hard case.
#[derive(Clone, Debug)]
pub struct Case {
    /// What is hard about it.
    pub name: String,
    /// Is it a needle of the bar "at least ten times better than single precision"?
    pub needle: bool,
    /// The splats.
    pub scene: Scene,
    /// From where.
    pub camera: Camera,
    /// Under which rules.
    pub rules: Rules,
}

/// Every case with other random splats for every `sample`; `quick` shortens the deep stack for the test suite.
pub fn all(quick: bool, sample: u64) -> Vec<Case> {
    let mut cases = Vec::new();
    for (rules, suffix, powers) in [
        (Rules::GAUSSIAN_3D, "", &[1, 2, 3, 4, 5][..]),
        (SHARP, ", low-pass 0", &[2, 3, 5]),
        (Rules::EWA, ", ewa", &[2, 3, 5]),
    ] {
        for power in powers {
            let shown = match power {
                1 => "10".to_owned(),
                _ => format!("10^{power}"),
            };
            let name = format!("needle {shown}:1{suffix}");
            cases.push(needle(sample, &name, 10f64.powi(*power), rules));
        }
    }
    cases.extend(shapes(sample));
    cases.extend(places(sample));
    cases.extend(turned(sample));
    cases.extend(orders(sample));
    cases.push(deep_stack(sample, if quick { 2_000 } else { 100_000 }));
    cases
}

/// Sixteen needles in all directions; the long axis spans four screens.
fn needle(sample: u64, name: &str, ratio: f64, rules: Rules) -> Case {
    let long = 16.0;
    let mut case = many(sample, name, rules, |turn| {
        let axes = rotated_axes(turn, [long, long / ratio, long / ratio]);
        // A mass of 8 has a peak of about 0.6 at this size.
        let weight = if rules.normalised { 8.0 } else { 0.8 };
        splat(
            [0.1 + apart(sample), -0.05, 8.0 - apart(sample)],
            axes,
            weight,
        )
    });
    case.needle = true;
    case
}

fn ball(radius: f64) -> [[f64; 3]; 3] {
    vector::diagonal([radius; 3])
}

/// A round splat anywhere in the picture.
fn round(radius: f64, weight: f64) -> impl Fn([f64; 4]) -> Splat {
    move |[_, x, y, _]| splat([x, y, 6.0], ball(radius), weight)
}

/// A splat in the middle of the picture that extends along one axis only.
fn line([_, x, y, z]: [f64; 4]) -> Splat {
    splat([0.0, 0.0, 6.0], [[x, y, z], [0.0; 3], [0.0; 3]], 0.8)
}

fn shapes(sample: u64) -> Vec<Case> {
    let gaussian = Rules::GAUSSIAN_3D;
    let [ordinary, tiny] = ["round, ordinary", "smaller than a pixel by 1000"];
    let in_volume = |name: &str, make| many(sample, &format!("{name}, ewa"), Rules::EWA, make);
    vec![
        many(sample, ordinary, gaussian, round(0.5, 0.8)),
        in_volume(ordinary, round(0.5, 0.8)),
        many(sample, "discs edge-on", gaussian, |[x, y, ..]| {
            let axes = [[x, y, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
            splat([0.0, 0.0, 6.0], axes, 0.8)
        }),
        many(sample, "disc through the eye, low-pass 0", SHARP, |turn| {
            let centre = [turn[1], 2.0 + 0.7 * turn[2], 6.0];
            splat(centre, disc_through_the_eye(centre, turn[3], 1e-3), 0.8)
        }),
        many(sample, "larger than the screen by 1000", gaussian, |turn| {
            let axes = rotated_axes(turn, [6000.0, 5000.0, 4000.0]);
            splat([0.3 + apart(sample), 0.2, 6.0 - apart(sample)], axes, 0.6)
        }),
        many(sample, tiny, gaussian, round(1e-4, 0.9)),
        in_volume(tiny, round(1e-4, 0.02)),
        many(sample, "singular: one axis only", gaussian, line),
        many(sample, "singular: a point", gaussian, round(0.0, 0.8)),
        many(sample, "singular, low-pass 0", SHARP, line),
    ]
}

/// A disc of radius 1 that the ray to its centre lies in, level on the screen, its axes turned by `angle` against the
/// ray, and `thin` across: each axis' vertical component on the screen is a difference of equal numbers.
fn disc_through_the_eye(centre: [f64; 3], angle: f64, thin: f64) -> [[f64; 3]; 3] {
    let unit = |v| vector::unit(v).unwrap_or_default();
    let ray = unit(centre);
    let normal = unit([0.0, -ray[2], ray[1]]);
    let across = vector::cross(ray, normal);
    let (sin, cos) = (0.3 + angle).sin_cos();
    [
        [0, 1, 2].map(|i| cos * ray[i] + sin * across[i]),
        [0, 1, 2].map(|i| cos * across[i] - sin * ray[i]),
        normal.map(|x| x * thin),
    ]
}

fn places(sample: u64) -> Vec<Case> {
    let gaussian = Rules::GAUSSIAN_3D;
    let scattered = |name: &str, width: f64, depth: f64, radius: f64| {
        many(sample, name, gaussian, |[_, x, y, _]| {
            splat([x * width, y * width, depth], ball(radius), 0.8)
        })
    };
    let near = many(sample, "on and behind the near plane", gaussian, |turn| {
        let depth = 0.01 - turn[0].abs().floor() * 3.0;
        splat([0.0, 0.0, depth], ball(0.1), 0.8)
    });
    let edges = "centres on pixel edges and corners";
    let on_edges = many(sample, edges, gaussian, |[_, x, y, _]| {
        let [x, y] = [x, y].map(|place| (place * 8.0).round() / 8.0);
        splat([x, y, 8.0], ball(0.2), 0.8)
    });
    vec![
        scattered("just beyond the near plane", 0.004, 0.010_001, 0.001),
        near,
        scattered("far off axis", 50.0, 1.0, 20.0),
        scattered("at the far end of the positions", 1e6, 4e6, 1e6),
        scattered("at the near end of the positions", 0.01, 0.02, 0.002),
        on_edges,
    ]
}

/// A camera that is turned about a slant axis and moved, so that every entry of W takes part.
fn turned(sample: u64) -> Vec<Case> {
    let gaussian = Rules::GAUSSIAN_3D;
    let ordinary = many(sample, "turned camera, ordinary", gaussian, round(0.5, 0.8));
    let thin = needle(sample, "turned camera, needle 10^3:1", 1e3, gaussian);
    vec![seen_askew(ordinary), seen_askew(thin)]
}

/// The same view from elsewhere: splats and camera are turned and moved together, then rounded.
fn seen_askew(mut case: Case) -> Case {
    // The rotation's entries are multiples of 2^-23, which both engines hold; a deviation from a rotation of that size
    // is part of the case.
    let coarse = |x: f64| (x * f64::from(1 << 23)).round() / f64::from(1 << 23);
    let columns = rotated_axes([0.8, 0.3, -0.4, 0.33], [1.0; 3]);
    let rotation: [[f64; 3]; 3] =
        [0, 1, 2].map(|i| [0, 1, 2].map(|k: usize| coarse(columns[k][i])));
    let away = [1.25, -0.75, 2.5];
    let back = |v: [f64; 3]| [0, 1, 2].map(|k| (0..3).map(|i| rotation[i][k] * v[i]).sum::<f64>());
    for splat in &mut case.scene.splats {
        splat.centre = back([0, 1, 2].map(|i| splat.centre[i] - away[i]));
        splat.axes = splat.axes.map(back);
        *splat = rounded(*splat);
    }
    (case.camera.rotation, case.camera.translation) = (rotation, away);
    case
}

fn orders(sample: u64) -> Vec<Case> {
    let gaussian = Rules::GAUSSIAN_3D;
    let opacity = |name: &str, value: f64| many(sample, name, gaussian, round(0.5, value));
    vec![
        many(sample, "equal depths", gaussian, |[_, x, y, _]| {
            splat([x * 0.2, y * 0.2, 6.0], ball(0.5), 0.5)
        }),
        many(sample, "identical splats", gaussian, |_| {
            let centre = [0.1 + apart(sample), 0.2, 6.0 - apart(sample)];
            splat(centre, ball(0.5), 0.3)
        }),
        opacity("opacity 0", 0.0),
        opacity("opacity 1/255", f64::from(1.0f32 / 255.0 + 1e-9)),
        opacity("opacity 1", 1.0),
    ]
}

/// Identical splats of opacity 2^-16 on top of each other, as wide as the picture.
fn deep_stack(sample: u64, count: usize) -> Case {
    let one = splat(
        [0.01 + apart(sample), 0.02, 6.0 + apart(sample)],
        ball(2.0),
        2f64.powi(-16),
    );
    let mut case = case(
        &format!("stack of {count} of alpha 2^-16"),
        FAINT,
        vec![one; count],
    );
    case.camera = camera(8);
    case
}

/// Sixteen splats, each from one fixed unit quaternion.
fn many(sample: u64, name: &str, rules: Rules, make: impl Fn([f64; 4]) -> Splat) -> Case {
    let mut state = 7 + sample;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1u64 << 23) as f64 - 1.0
    };
    let splats = (0..16).map(|_| {
        let turn = [next(), next(), next(), next()];
        let length = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut splat = make(turn.map(|x| x / length));
        splat.colour = turn.map(f64::abs)[..3].try_into().unwrap_or_default();
        rounded(splat)
    });
    case(name, rules, splats.collect())
}

/// A small shift that differs from sample to sample, for splats that all lie at one place.
fn apart(sample: u64) -> f64 {
    sample as f64 * 0.013
}

fn camera(size: usize) -> Camera {
    Camera {
        near: f64::from(0.01f32),
        ..Camera::centred(size, size, FOCAL)
    }
}

fn case(name: &str, rules: Rules, splats: Vec<Splat>) -> Case {
    Case {
        name: name.to_owned(),
        needle: false,
        scene: Scene::of_splats(name, rules, splats),
        camera: camera(SIZE),
        rules,
    }
}

fn splat(centre: [f64; 3], axes: [[f64; 3]; 3], weight: f64) -> Splat {
    rounded(Splat {
        centre,
        axes,
        weight,
        colour: [0.75, 0.5, 0.25],
    })
}

/// The same splat in numbers that single precision holds.
pub(super) fn rounded(splat: Splat) -> Splat {
    let single = |x: f64| f64::from(x as f32);
    Splat {
        centre: splat.centre.map(single),
        axes: splat.axes.map(|axis| axis.map(single)),
        weight: single(splat.weight),
        colour: splat.colour.map(single),
    }
}
