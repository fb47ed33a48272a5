//! Setup against double precision, at every stage boundary, for every design.

mod common;

use common::{Oracle, double, oracle, relative, splats, tolerances, view};
use proptest::prelude::*;
use splatline::footprint::Footprint;
use splatline::format::{Classic8, Deep32, Design, Lean18, Standard24};
use splatline::rules::Rules;
use splatline::setup::{Cull, columns, project, setup, variance};
use splatline::splat::VolumeSplat;
use splatline::view::{Pose, Projection, View};

/// By how much the viewing ray's direction cancels in the columns: the longest axis in space over the longest on the screen.
fn foreshortening(view: &View, splat: &VolumeSplat, exact: &Oracle) -> f64 {
    let length = |v: &[f64]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let depth = if view.projection == Projection::Perspective {
        exact.camera[2]
    } else {
        1.0
    };
    let gain = double(view.focal[0]).max(double(view.focal[1])) / depth;
    let ratio = 1.0 + (exact.camera[0].abs() + exact.camera[1].abs()) / depth;
    let worst = splat.axes.iter().zip(&exact.columns).map(|(axis, column)| {
        let in_space = length(
            &axis
                .mantissa
                .map(|m| f64::from(m) * f64::from(axis.exponent).exp2()),
        );
        if in_space == 0.0 {
            1.0
        } else {
            gain * ratio * in_space / length(column).max(1e-300)
        }
    });
    worst.fold(1.0, f64::max)
}

fn check<D: Design>(
    name: &'static str,
    design: D,
    view: &View,
    rules: &Rules,
    splat: &VolumeSplat,
) -> Result<(), TestCaseError> {
    let widths = design.widths();
    let bounds = tolerances::of(name, &widths);
    let exact = oracle(view, rules, splat);
    let point = view.pose.to_camera(&view.rotation, &splat.centre, &widths);
    let t = point
        .value
        .map(|c| c as f64 * f64::from(point.exponent).exp2());
    for (got, expected) in t.iter().zip(exact.camera) {
        prop_assert!(
            (got - expected).abs() <= bounds.camera,
            "{name} camera: {t:?} {:?}",
            exact.camera
        );
    }
    let Ok(projected) = project(&widths, view, rules, &splat.centre) else {
        return Ok(());
    };
    let pixel = f64::from(widths.subpixel).exp2();
    let centre = projected.centre.map(|c| c as f64 / pixel);
    let reach = exact.centre.iter().fold(1000.0f64, |m, c| m.max(c.abs())) / 1000.0;
    let close = (1.0 / exact.camera[2]).max(1.0);
    for (got, expected) in centre.iter().zip(exact.centre) {
        prop_assert!(
            (got - expected).abs() <= bounds.centre * reach * close * 2.0,
            "{name} centre: {centre:?} {exact:?}"
        );
    }
    let m = columns(&widths, &view.rotation, &projected, &splat.axes);
    let cancel = foreshortening(view, splat, &exact) * close;
    for (got, expected) in m.iter().zip(exact.columns) {
        let error = relative(&[double(got.x), double(got.y)], &expected);
        prop_assert!(
            error <= bounds.columns * cancel,
            "{name} columns: {error:e} > {:e}",
            bounds.columns * cancel
        );
    }
    let v = variance(&widths, rules.low_pass, &m);
    let error = relative(&[double(v.xx), double(v.xy), double(v.yy)], &exact.variance);
    prop_assert!(error <= bounds.shape * cancel, "{name} variance: {error:e}");
    Ok(())
}

/// The whole of setup where nothing is foreshortened: the shape is good to the mantissa, whatever the axis ratio.
fn check_shape<D: Design>(
    name: &'static str,
    design: D,
    view: &View,
    rules: &Rules,
    splat: &VolumeSplat,
) -> Result<(), TestCaseError> {
    let widths = design.widths();
    let bounds = tolerances::of(name, &widths);
    let exact = oracle(view, rules, splat);
    let Ok(footprint) = setup(design, view, rules, splat) else {
        return Ok(());
    };
    let cancel = foreshortening(view, splat, &exact) * (1.0 / exact.camera[2]).max(1.0);
    let allowed = bounds.shape * cancel * 4.0;
    let exponent = f64::from(footprint.conic.exponent).exp2();
    let conic = footprint.conic.mantissa.map(|m| f64::from(m) * exponent);
    // Sines of the angles between the columns' directions enter the determinant.
    let sine = exact.determinant / (exact.variance[0] * exact.variance[2]);
    if sine > 1e-2 {
        let error = relative(&conic, &exact.conic);
        prop_assert!(
            error <= allowed * 100.0,
            "{name} conic: {error:e} > {:e}",
            allowed * 100.0
        );
        let scan = footprint.scan;
        let error = relative(&[double(scan.curvature)], &[exact.conic[0]]);
        prop_assert!(error <= allowed * 100.0, "{name} curvature: {error:e}");
        let error = relative(&[double(scan.stretch)], &[1.0 / exact.variance[2]]);
        prop_assert!(error <= allowed * 100.0, "{name} stretch: {error:e}");
        let peak = f64::from(footprint.peak) / f64::from(widths.peak).exp2();
        let unit = f64::from(-i32::from(widths.peak)).exp2();
        prop_assert!(
            (peak - exact.peak.min(16.0)).abs() <= exact.peak * allowed * 100.0 + unit,
            "{name} peak: {peak} {}",
            exact.peak
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn every_stage_is_close(splat in splats(), yaw in -0.6f64..0.6, pitch in -0.6f64..0.6, parallel: bool, ewa: bool) {
        let projection = if parallel { Projection::Orthographic } else { Projection::Perspective };
        let view = view(yaw, pitch, projection);
        let rules = if ewa { Rules::EWA } else { Rules::GAUSSIAN_3D };
        check("classic8", Classic8, &view, &rules, &splat)?;
        check("lean18", Lean18, &view, &rules, &splat)?;
        check("standard24", Standard24, &view, &rules, &splat)?;
        check("deep32", Deep32, &view, &rules, &splat)?;
        check_shape("lean18", Lean18, &view, &rules, &splat)?;
        check_shape("standard24", Standard24, &view, &rules, &splat)?;
        check_shape("deep32", Deep32, &view, &rules, &splat)?;
    }

    /// No pixel that the double-precision ellipse contains is outside the box, and a culled splat has none.
    #[test]
    fn the_box_holds_the_ellipse(splat in splats(), yaw in -0.6f64..0.6, ewa: bool) {
        let view = view(yaw, 0.1, Projection::Perspective);
        let rules = if ewa { Rules::EWA } else { Rules::GAUSSIAN_3D };
        let exact = oracle(&view, &rules, &splat);
        let cutoff = if ewa { 4.0 } else { 2.0 * (255.0 * exact.peak).ln() };
        let result = setup(Standard24, &view, &rules, &splat);
        for y in 0..common::SIZE {
            for x in 0..common::SIZE {
                let (dx, dy) = (f64::from(x) + 0.5 - exact.centre[0], f64::from(y) + 0.5 - exact.centre[1]);
                let [a, b, c] = exact.conic;
                if a * dx * dx + 2.0 * b * dx * dy + c * dy * dy < cutoff * 0.9999 - 1e-4 {
                    match &result {
                        Ok(Footprint { first, last, .. }) => prop_assert!(
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
    use splatline::math::Scaled;
    let camera = view(0.0, 0.0, Projection::Perspective);
    let axis = |i: usize, length: f64| {
        let mut v = [0.0; 3];
        v[i] = length;
        splatline::splat::Axis::from_components(v.map(common::scaled))
    };
    let good = VolumeSplat {
        centre: [Scaled::ZERO; 3],
        axes: [axis(0, 0.1), axis(1, 0.1), axis(2, 0.1)],
        weight: common::scaled(0.5),
        colour: [fixed::types::U4F28::ONE; 3],
    };
    let at = |x: f64, y: f64, z: f64| VolumeSplat {
        centre: [x, y, z].map(common::scaled),
        ..good
    };
    let sharp = Rules {
        low_pass: Scaled::ZERO,
        ..Rules::GAUSSIAN_3D
    };
    let flat = VolumeSplat {
        axes: [axis(0, 0.0); 3],
        ..good
    };
    let faint = VolumeSplat {
        weight: common::scaled(0.0039),
        ..good
    };
    let distant = View {
        far: common::extended(100.0),
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
                    focal: [common::scaled(1e9); 2],
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
