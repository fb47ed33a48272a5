//! Setup against double precision, at every stage boundary, for every design.

use crate::common::{Oracle, dot, double, oracle, relative, rotation_of, splats, view};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use splatline::footprint::Footprint;
use splatline::format::{Classic8, Deep32, Design, Lean18, Standard24, Widths};
use splatline::rules::Rules;
use splatline::setup::{Cull, covariance, project, project_axes, setup, sharp_determinant};
use splatline::splat::VolumeSplat;
use splatline::view::{Pose, Projection, View};
use std::cell::Cell;

/// The bounds of docs/error-analysis.md for one splat and one design, in its letters: u, w, e, G and K.
struct InputBounds {
    u: f64,
    w: f64,
    /// The difference to the eye and its rotation, relative to the depth.
    near: f64,
    e: f64,
    g: f64,
    /// What each component of M may lose.
    columns: [[f64; 2]; 3],
}

fn unit(bits: u8) -> f64 {
    f64::from(-i32::from(bits)).exp2()
}

impl InputBounds {
    fn new(widths: &Widths, view: &View, splat: &VolumeSplat, exact: &Oracle) -> InputBounds {
        let u = unit(widths.mantissa);
        let w = if widths.mantissa > 16 {
            unit(29)
        } else {
            1.1 * unit(18)
        };
        let perspective = view.projection == Projection::Perspective;
        let depth = if perspective { exact.camera[2] } else { 1.0 };
        let length = |v: &[f64]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
        let near = 4.0 * unit(widths.position) * length(&exact.camera) / depth;
        let rotation = rotation_of(view);
        let columns = splat.axes.map(|axis| {
            let axis = axis
                .mantissa
                .map(|m| f64::from(m) * f64::from(axis.exponent).exp2());
            let [x, y, z] = rotation.map(|row| dot(row, axis).abs());
            [(x, 0), (y, 1)].map(|(across, i)| {
                let slant = if perspective {
                    1.0 + (exact.camera[i] / depth).abs()
                } else {
                    0.0
                };
                let terms = (6.0 * u + 2.0 * w + 2.0 * near) * (across + slant * z);
                // Axis, rotation and their products are cut to 6 bits more than the mantissa, the rotation at 30 bits:
                // an error of the axis' length, however little of it lies across.
                let turned = 6.0 * unit(widths.mantissa + 6) + unit(30);
                let turned = turned * (1.0 + slant) * length(&axis);
                double(view.focal[i]) / depth * (terms + turned)
            })
        });
        let lost =
            [0, 1].map(|i| length(&columns.map(|column| column[i])) / exact.variance[2 * i].sqrt());
        InputBounds {
            u,
            w,
            near,
            e: lost[0].max(lost[1]),
            g: (exact.variance[0] * exact.variance[2] / exact.determinant).sqrt(),
            columns,
        }
    }

    fn covariance(&self) -> f64 {
        2.0 * self.e + self.u
    }

    fn determinant(&self) -> f64 {
        4.0 * self.e * self.g + 2.0 * self.e + 5.0 * self.u
    }

    fn form(&self) -> f64 {
        8.0 * (self.e + self.u + self.w) * (1.0 + self.g)
    }
}

/// Every stage against its bound; `true` if the splat got past the depth range.
fn check<D: Design>(
    name: &'static str,
    design: D,
    view: &View,
    rules: &Rules,
    splat: &VolumeSplat,
) -> Result<bool, TestCaseError> {
    let widths = design.widths();
    let exact = oracle(view, rules, splat);
    let point = view.pose.to_camera(&view.rotation, &splat.centre, &widths);
    let distance = exact.camera.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    for (value, expected) in point.value.iter().zip(exact.camera) {
        let got = *value as f64 * f64::from(point.exponent).exp2();
        let allowed = 4.0 * unit(widths.position) * distance + 1e-15;
        prop_assert!(
            (got - expected).abs() <= allowed,
            "{name} camera: {point:?} {:?}",
            exact.camera
        );
    }
    let Ok(projected) = project(&widths, view, rules, &splat.centre) else {
        return Ok(false);
    };
    let bounds = InputBounds::new(&widths, view, splat, &exact);
    let pixel = f64::from(widths.subpixel).exp2();
    for i in 0..2 {
        let got = projected.centre[i] as f64 / pixel;
        let offset = (exact.centre[i] - view.principal[i].to_num::<f64>()).abs();
        let allowed = 0.5 * unit(widths.subpixel)
            + unit(32)
            + 4.0 * unit(widths.view) * offset
            + bounds.near * (double(view.focal[i]) + offset);
        prop_assert!(
            (got - exact.centre[i]).abs() <= allowed,
            "{name} centre: {got} {exact:?}"
        );
    }
    let m = project_axes(&widths, &view.rotation, &projected, &splat.axes);
    for ((got, expected), allowed) in m.iter().zip(exact.columns).zip(bounds.columns) {
        for (i, component) in [got.x, got.y].into_iter().enumerate() {
            let error = (double(component) - expected[i]).abs();
            let allowed = allowed[i];
            prop_assert!(error <= allowed, "{name} columns: {error:e} > {allowed:e}");
        }
    }
    let v = covariance(&widths, rules.low_pass, &m);
    let [xx, _, yy] = exact.variance;
    let scales = [xx, (xx * yy).sqrt(), yy];
    for ((got, expected), scale) in [v.xx, v.xy, v.yy]
        .into_iter()
        .zip(exact.variance)
        .zip(scales)
    {
        let error = (double(got) - expected).abs() / scale;
        prop_assert!(
            error <= bounds.covariance(),
            "{name} variance: {error:e} > {:e}",
            bounds.covariance()
        );
    }
    let error = (double(v.determinant) / exact.determinant - 1.0).abs();
    prop_assert!(
        error <= bounds.determinant(),
        "{name} determinant: {error:e} > {:e}",
        bounds.determinant()
    );
    // What the low-pass filter leaves of an opacity, squared: the minors' errors are to be seen against the whole
    // determinant.
    let kept = double(sharp_determinant(&widths, &m)) / double(v.determinant);
    let error = (kept - exact.kept * exact.kept).abs();
    prop_assert!(
        error <= 2.0 * bounds.determinant(),
        "{name} compensation: {error:e} > {:e}",
        2.0 * bounds.determinant()
    );
    Ok(true)
}

/// The whole of setup: the form and the peak; `true` if the splat was drawn.
fn check_shape<D: Design>(
    name: &'static str,
    design: D,
    view: &View,
    rules: &Rules,
    splat: &VolumeSplat,
) -> Result<bool, TestCaseError> {
    let widths = design.widths();
    let exact = oracle(view, rules, splat);
    let Ok(footprint) = setup(design, view, rules, splat) else {
        return Ok(false);
    };
    let bounds = InputBounds::new(&widths, view, splat, &exact);
    let exponent = f64::from(footprint.conic.exponent).exp2();
    let conic = footprint.conic.mantissa.map(|m| f64::from(m) * exponent);
    let error = relative(&conic, &exact.conic);
    prop_assert!(
        error <= bounds.form(),
        "{name} conic: {error:e} > {:e}",
        bounds.form()
    );
    let scan = footprint.ldl;
    let pairs = [
        ("curvature", double(scan.horizontal), exact.conic[0]),
        ("spread", double(scan.squared_width), 1.0 / exact.conic[0]),
        ("stretch", double(scan.vertical), 1.0 / exact.variance[2]),
    ];
    for (part, got, expected) in pairs {
        let error = (got / expected - 1.0).abs();
        prop_assert!(
            error <= bounds.form(),
            "{name} {part}: {error:e} > {:e}",
            bounds.form()
        );
    }
    // In the coordinates in which the form is a circle.
    let slope = exact.variance[1] / exact.variance[2];
    let stretched = (exact.conic[0] * exact.variance[2]).sqrt();
    let error = (double(scan.shear) - slope).abs() * stretched;
    prop_assert!(
        error <= bounds.form(),
        "{name} slope: {error:e} > {:e}",
        bounds.form()
    );
    let peak = f64::from(footprint.opacity) / f64::from(widths.peak).exp2();
    let lost = if rules.normalised {
        0.5 * bounds.determinant() + 10.0 * bounds.u + 3.0 * bounds.w + 2.0 * bounds.near
    } else {
        unit(31)
    };
    let mut allowed = exact.peak * lost + 0.5 * unit(widths.peak);
    if rules.compensated {
        // The root of what is kept, which may be small: d sqrt(x) <= dx / sqrt(x), and sqrt(dx) at most.
        let kept = 2.0 * bounds.determinant();
        let root = (kept / exact.kept).min(kept.sqrt());
        allowed += double(splat.weight) * (root + 4.0 * (bounds.u + bounds.w));
    }
    let largest = 16.0 - unit(widths.peak);
    prop_assert!(
        (peak - exact.peak.min(largest)).abs() <= allowed,
        "{name} peak: {peak} {}",
        exact.peak
    );
    Ok(true)
}

/// Most splats of the generator are seen and drawn; without this the properties would hold of nothing.
fn assert_most(name: &str, counts: [u32; 2], least: f64) {
    let share = f64::from(counts[0]) / f64::from(counts[1]);
    assert!(share >= least, "{name}: {} of {}", counts[0], counts[1]);
}

#[test]
fn every_stage_is_close() {
    let mut runner = TestRunner::new(ProptestConfig {
        cases: 2000,
        failure_persistence: None,
        ..ProptestConfig::default()
    });
    let (seen, drawn) = (Cell::new([0; 2]), Cell::new([0; 2]));
    let count = |cell: &Cell<[u32; 2]>, hit: bool| {
        let [hits, all] = cell.get();
        cell.set([hits + u32::from(hit), all + 1]);
    };
    let inputs = (
        splats(),
        -0.6f64..0.6,
        -0.6f64..0.6,
        any::<bool>(),
        0usize..3,
    );
    let compensated = Rules {
        compensated: true,
        ..Rules::GAUSSIAN_3D
    };
    let all = [Rules::EWA, Rules::GAUSSIAN_3D, compensated];
    let outcome = runner.run(&inputs, |(splat, yaw, pitch, parallel, which)| {
        let projection = if parallel {
            Projection::Orthographic
        } else {
            Projection::Perspective
        };
        let view = view(yaw, pitch, projection);
        let rules = all[which];
        count(&seen, check("classic8", Classic8, &view, &rules, &splat)?);
        count(&seen, check("lean18", Lean18, &view, &rules, &splat)?);
        count(
            &seen,
            check("standard24", Standard24, &view, &rules, &splat)?,
        );
        count(&seen, check("deep32", Deep32, &view, &rules, &splat)?);
        count(
            &drawn,
            check_shape("lean18", Lean18, &view, &rules, &splat)?,
        );
        count(
            &drawn,
            check_shape("standard24", Standard24, &view, &rules, &splat)?,
        );
        count(
            &drawn,
            check_shape("deep32", Deep32, &view, &rules, &splat)?,
        );
        Ok(())
    });
    outcome.unwrap_or_else(|failure| panic!("{failure}"));
    assert_most("past the depth range", seen.get(), 0.95);
    assert_most("drawn", drawn.get(), 0.5);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// No pixel that the double-precision ellipse contains is outside the box, and a culled splat has none.
    #[test]
    fn the_box_holds_the_ellipse(splat in splats(), yaw in -0.6f64..0.6, ewa: bool) {
        let view = view(yaw, 0.1, Projection::Perspective);
        let rules = if ewa { Rules::EWA } else { Rules::GAUSSIAN_3D };
        let exact = oracle(&view, &rules, &splat);
        let cutoff = if ewa { 4.0 } else { 2.0 * (255.0 * exact.peak).ln() };
        let result = setup(Standard24, &view, &rules, &splat);
        for y in 0..crate::common::SIZE {
            for x in 0..crate::common::SIZE {
                let (dx, dy) = (f64::from(x) + 0.5 - exact.centre[0], f64::from(y) + 0.5 - exact.centre[1]);
                let [a, b, c] = exact.conic;
                if a * dx * dx + 2.0 * b * dx * dy + c * dy * dy < cutoff * 0.9999 - 1e-4 {
                    match &result {
                        Ok(Footprint { first, end: last, .. }) => prop_assert!(
                            (first[0]..last[0]).contains(&x) && (first[1]..last[1]).contains(&y), "{x} {y} {first:?} {last:?}"),
                        Err(reason) => prop_assert!(matches!(reason, Cull::Near | Cull::Far | Cull::Range), "{reason:?} at {x} {y}"),
                    }
                }
            }
        }
    }
}

#[test]
fn each_reason_culls() {
    use splatline::math::SoftFloat;
    let camera = view(0.0, 0.0, Projection::Perspective);
    let axis = |i: usize, length: f64| {
        let mut v = [0.0; 3];
        v[i] = length;
        splatline::splat::Axis::from_components(v.map(crate::common::scaled))
    };
    let good = VolumeSplat {
        centre: [SoftFloat::ZERO; 3],
        axes: [axis(0, 0.1), axis(1, 0.1), axis(2, 0.1)],
        weight: crate::common::scaled(0.5),
        colour: [fixed::types::U4F28::ONE; 3],
    };
    let at = |x: f64, y: f64, z: f64| VolumeSplat {
        centre: [x, y, z].map(crate::common::scaled),
        ..good
    };
    let sharp = Rules {
        low_pass: SoftFloat::ZERO,
        ..Rules::GAUSSIAN_3D
    };
    let flat = VolumeSplat {
        axes: [axis(0, 0.0); 3],
        ..good
    };
    let faint = VolumeSplat {
        weight: crate::common::scaled(0.0039),
        ..good
    };
    let distant = View {
        far: crate::common::extended(100.0),
        ..camera
    };
    let cases: [(&str, Result<Footprint, Cull>, Option<Cull>); 8] = [
        (
            "drawn",
            setup(Standard24, &camera, &Rules::GAUSSIAN_3D, &good),
            None,
        ),
        (
            "near",
            setup(
                Standard24,
                &camera,
                &Rules::GAUSSIAN_3D,
                &at(0.0, 0.0, -4.0),
            ),
            Some(Cull::Near),
        ),
        (
            "behind",
            setup(
                Standard24,
                &camera,
                &Rules::GAUSSIAN_3D,
                &at(0.0, 0.0, -100.0),
            ),
            Some(Cull::Near),
        ),
        (
            "far",
            setup(
                Standard24,
                &distant,
                &Rules::GAUSSIAN_3D,
                &at(0.0, 0.0, 100.0),
            ),
            Some(Cull::Far),
        ),
        (
            "range",
            setup(
                Standard24,
                &View {
                    focal: [crate::common::scaled(1e9); 2],
                    ..camera
                },
                &Rules::EWA,
                &at(60.0, 0.0, 0.0),
            ),
            Some(Cull::Range),
        ),
        (
            "degenerate",
            setup(Standard24, &camera, &sharp, &flat),
            Some(Cull::Degenerate),
        ),
        (
            "transparent",
            setup(Standard24, &camera, &Rules::GAUSSIAN_3D, &faint),
            Some(Cull::Transparent),
        ),
        (
            "outside",
            setup(
                Standard24,
                &camera,
                &Rules::GAUSSIAN_3D,
                &at(50.0, 0.0, 0.0),
            ),
            Some(Cull::Outside),
        ),
    ];
    for (name, got, expected) in cases {
        assert_eq!(got.err(), expected, "{name}");
    }
}
