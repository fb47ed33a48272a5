//! View-dependent colours by the kernel's unit against the reference's in double precision.

use splatline_engine::camera::Camera;
use splatline_engine::design::DesignChoice;
use splatline_engine::fixed::harmonic_colours;
use splatline_engine::scene::{Scene, synthetic};

/// The largest difference of a channel.
fn largest(scene: &Scene, camera: &Camera, design: &str) -> f64 {
    let widths = DesignChoice::named(design).unwrap().widths;
    let fixed = harmonic_colours(scene, camera, &widths).unwrap();
    let exact = scene.colours(camera);
    let channels = fixed.iter().flatten().zip(exact.iter().flatten());
    channels
        .map(|(fixed, exact)| (fixed.to_num::<f64>() - exact).abs())
        .fold(0.0, f64::max)
}

/// A direction is good to a few units of its mantissa, a harmonic of degree l changes by at most about l^2 of that, and
/// a colour is a sum of three to 24 of them with coefficients of 0.15.
#[test]
fn colours_are_as_exact_as_the_direction() {
    let camera = synthetic::camera(64, 64);
    for degree in 1..=4u8 {
        let scene = synthetic::random_harmonics(2000, u64::from(degree), degree);
        for (design, mantissa) in [
            ("classic8", 16),
            ("lean18", 18),
            ("standard24", 24),
            ("deep32", 31),
        ] {
            let unit = f64::from(-mantissa).exp2() + f64::from(-27).exp2();
            let error = largest(&scene, &camera, design);
            let bound = 3.0 * f64::from(degree) * unit;
            assert!(
                error < bound,
                "degree {degree}, {design}: {error:e}, {bound:e}"
            );
            assert!(error > 0.0);
        }
    }
}

#[test]
fn parallel_projection_has_one_direction() {
    let scene = synthetic::random_harmonics(500, 7, 4);
    let camera = Camera {
        orthographic: true,
        ..synthetic::camera(64, 64)
    };
    assert!(largest(&scene, &camera, "standard24") < 1e-7);
}

/// The eye in the middle of a splat sees its constant colour.
#[test]
fn no_direction_leaves_the_constant_colour() {
    let mut scene = synthetic::random_harmonics(1, 3, 3);
    let camera = synthetic::camera(64, 64);
    let eye = [0, 1, 2].map(|axis| -> f64 {
        -(0..3)
            .map(|row| camera.rotation[row][axis] * camera.translation[row])
            .sum::<f64>()
    });
    scene.splats[0].centre = eye;
    assert!(largest(&scene, &camera, "standard24") < 1e-8);
}
