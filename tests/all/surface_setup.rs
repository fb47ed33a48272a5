//! Surface setup against double precision: the ellipse by the inverse Jacobian, the plane's depth by the tangent plane,
//! and every bit pattern.

use fixed::types::{I2F30, I32F32, U4F28};
use proptest::prelude::*;
use splatline::format::{Classic8, Deep32, Standard24};
use splatline::math::{Extended, SoftFloat};
use splatline::rules::Rules;
use splatline::setup::{setup, setup_surface};
use splatline::splat::surface::SurfaceSplat;
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Eye, Projection, RatioLimits, View};

/// Largest error of the conic relative to its trace, and of the depth lane relative to the splat's radius, in
/// `standard24`.
const CONIC_TOLERANCE: f64 = 3e-5;
const DEPTH_TOLERANCE: f64 = 1e-5;

const FOCAL: f64 = 400.0;
const CENTRE: f64 = 256.0;

fn scaled(value: f64) -> SoftFloat {
    SoftFloat::from_wide((value * 2f64.powi(40)) as i64, -40, 31)
}

/// A number of setup as the depth range has it.
fn number(value: SoftFloat) -> Extended {
    Extended {
        value: value.mantissa.into(),
        exponent: value.exponent,
    }
}

/// The eye at the origin, looking along z.
fn view() -> View {
    let one = I2F30::from_bits(1 << 30);
    let zero = I2F30::ZERO;
    View {
        rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        pose: Eye::ORIGIN,
        focal: [scaled(FOCAL); 2],
        principal: [I32F32::from_num(CENTRE); 2],
        near: number(scaled(0.01)),
        far: number(scaled(500.0)),
        viewport: [512, 512],
        projection: Projection::Perspective,
        limits: RatioLimits {
            low: [I32F32::MIN; 2],
            high: [I32F32::MAX; 2],
        },
    }
}

fn rules(low_pass: f64) -> Rules {
    Rules {
        low_pass: scaled(low_pass),
        ..Rules::SURFACE
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn splat(centre: [f64; 3], frame: [[f64; 3]; 2]) -> SurfaceSplat {
    SurfaceSplat {
        centre: centre.map(scaled),
        frame: frame.map(|axis| Axis::from_components(axis.map(scaled))),
        normal: Axis::from_components(cross(frame[0], frame[1]).map(scaled)),
        weight: scaled(1.0),
        colour: [U4F28::from_num(0.5); 3],
        opacity: U4F28::from_num(1),
        material: 3,
    }
}

/// Conic of r = |coordinates in the plane|^2 from d(coordinates)/d(pixel): rays through pixels cut with the tangent
/// plane.
fn conic_by_rays(centre: [f64; 3], [s1, s2]: [[f64; 3]; 2]) -> [f64; 3] {
    let normal = cross(s1, s2);
    let gram = [dot(s1, s1), dot(s1, s2), dot(s2, s2)];
    let determinant = gram[0] * gram[2] - gram[1] * gram[1];
    let coordinates = |u: f64, v: f64| {
        let ray = [(u - CENTRE) / FOCAL, (v - CENTRE) / FOCAL, 1.0];
        let distance = dot(normal, centre) / dot(normal, ray);
        let offset = [0, 1, 2].map(|k: usize| distance * ray[k] - centre[k]);
        let (a, b) = (dot(offset, s1), dot(offset, s2));
        [
            (gram[2] * a - gram[1] * b) / determinant,
            (gram[0] * b - gram[1] * a) / determinant,
        ]
    };
    let foot = [0, 1].map(|k: usize| FOCAL * centre[k] / centre[2] + CENTRE);
    let step = 1e-3;
    let difference = |du: f64, dv: f64| {
        let (ahead, behind) = (
            coordinates(foot[0] + du, foot[1] + dv),
            coordinates(foot[0] - du, foot[1] - dv),
        );
        [0, 1].map(|k: usize| (ahead[k] - behind[k]) / (2.0 * step))
    };
    let (x, y) = (difference(step, 0.0), difference(0.0, step));
    [
        x[0] * x[0] + x[1] * x[1],
        x[0] * y[0] + x[1] * y[1],
        y[0] * y[0] + y[1] * y[1],
    ]
}

proptest! {
    // Culled splats are replaced by others; the test fails if fewer than half are drawn.
    #![proptest_config(ProptestConfig { max_global_rejects: 256, ..ProptestConfig::default() })]

    /// SURF 4: with a vanishing low-pass the ellipse is that of the rays cut with the tangent plane.
    #[test]
    fn the_ellipse_is_that_of_the_inverse_jacobian(
        x in -1.5f64..1.5, y in -1.5f64..1.5, z in 4.0f64..40.0,
        first in proptest::array::uniform3(-0.3f64..0.3), second in proptest::array::uniform3(-0.3f64..0.3),
    ) {
        let normal = cross(first, second);
        let centre = [x, y, z];
        let sine = dot(normal, normal).sqrt() / (dot(first, first) * dot(second, second)).sqrt();
        let cosine = dot(normal, centre).abs() / (dot(normal, normal) * dot(centre, centre)).sqrt();
        prop_assume!(sine > 0.2 && cosine > 0.2 && dot(first, first) > 0.003 && dot(second, second) > 0.003);
        let expected = conic_by_rays(centre, [first, second]);
        let Ok(got) = setup_surface(Standard24, &view(), &rules(1e-9), &splat(centre, [first, second])) else {
            return Err(TestCaseError::reject("culled"));
        };
        let unit = f64::from(got.footprint.conic.exponent).exp2();
        let conic = got.footprint.conic.mantissa.map(|m| f64::from(m) * unit);
        let trace = expected[0] + expected[2];
        for (c, e) in conic.iter().zip(expected) {
            prop_assert!((c - e).abs() <= CONIC_TOLERANCE * trace, "{conic:?} {expected:?}");
        }
        // Without the filter the weight does not depend on the view.
        let peak = f64::from(got.footprint.opacity) / 2f64.powi(28);
        prop_assert!((peak - 1.0).abs() < 1e-4, "{peak}");
    }

    /// A 2D Gaussian is a volume splat whose third axis is 0. Its footprint is the surface splat's, bit for bit; its
    /// peak is the opacity, and compensated for the filter it is SURF's weight.
    #[test]
    fn a_flat_volume_splat_has_the_footprint_of_a_surface_splat(
        x in -1.5f64..1.5, y in -1.5f64..1.5, z in 1.0f64..40.0,
        frame in proptest::array::uniform2(proptest::array::uniform3(-0.3f64..0.3)), compensated: bool,
    ) {
        let surface = splat([x, y, z], frame);
        let flat = VolumeSplat {
            centre: surface.centre,
            axes: [surface.frame[0], surface.frame[1], Axis::default()],
            weight: surface.weight,
            colour: surface.colour,
        };
        let rules = Rules { compensated, ..Rules::GAUSSIAN_3D };
        let (Ok(flat), Ok(surface)) = (
            setup(Standard24, &view(), &rules, &flat),
            setup_surface(Standard24, &view(), &rules, &surface),
        ) else {
            return Err(TestCaseError::reject("culled"));
        };
        let surface = surface.footprint;
        prop_assert_eq!(
            (flat.depth, flat.centre, flat.ldl, flat.conic),
            (surface.depth, surface.centre, surface.ldl, surface.conic)
        );
        let [peak, weight] = [flat.opacity, surface.opacity].map(f64::from);
        let expected = if compensated { weight } else { 2f64.powi(28) };
        prop_assert!((peak / expected - 1.0).abs() < 1e-6, "{peak} {expected}");
    }

    /// The lane's slope is the regression of depth on the filtered position, in double precision by the textbook
    /// formula.
    #[test]
    fn the_depth_lane_is_the_filtered_plane(
        x in -1.5f64..1.5, y in -1.5f64..1.5, z in 4.0f64..40.0, h in 0.1f64..2.0,
        [first, second] in proptest::array::uniform2(proptest::array::uniform3(-0.3f64..0.3)),
    ) {
        let surface = splat([x, y, z], [first, second]);
        let Ok(got) = setup_surface(Standard24, &view(), &rules(h), &surface) else {
            return Err(TestCaseError::reject("culled"));
        };
        let column = |s: [f64; 3]| [FOCAL * (s[0] - x / z * s[2]) / z, FOCAL * (s[1] - y / z * s[2]) / z];
        let (m1, m2) = (column(first), column(second));
        let [xx, yy] = [0, 1].map(|k: usize| m1[k] * m1[k] + m2[k] * m2[k] + h);
        let xy = m1[0] * m1[1] + m2[0] * m2[1];
        let [cx, cy] = [0, 1].map(|k: usize| m1[k] * first[2] + m2[k] * second[2]);
        let determinant = xx * yy - xy * xy;
        let slope = [(yy * cx - xy * cy) / determinant, (xx * cy - xy * cx) / determinant];
        let foot = [FOCAL * x / z + CENTRE, FOCAL * y / z + CENTRE];
        let radius = (dot(first, first) + dot(second, second)).sqrt();
        let [[first_x, first_y], [last_x, last_y]] = [got.footprint.first, got.footprint.end];
        for (column, row) in [(first_x, first_y), (last_x - 1, first_y), (last_x - 1, last_y - 1)] {
            let [du, dv] = [f64::from(column) + 0.5 - foot[0], f64::from(row) + 0.5 - foot[1]];
            let expected = z + slope[0] * du + slope[1] * dv;
            let lane = got.depth_at(column, row) as f64 / 2f64.powi(32);
            let steepness = slope[0].abs() * du.abs() + slope[1].abs() * dv.abs();
            prop_assert!((lane - expected).abs() <= DEPTH_TOLERANCE * (radius + steepness) + 3e-7, "{lane} {expected}");
        }
    }

    #[test]
    fn the_normal_faces_the_eye(
        x in -3f64..3.0, y in -3f64..3.0, z in 1.0f64..40.0,
        [first, second] in proptest::array::uniform2(proptest::array::uniform3(-0.3f64..0.3)),
    ) {
        let Ok(got) = setup_surface(Standard24, &view(), &rules(1.0), &splat([x, y, z], [first, second])) else {
            return Err(TestCaseError::reject("culled"));
        };
        let normal = got.attributes.normal.map(f64::from);
        let length = dot(normal, normal).sqrt();
        prop_assert!(dot(normal, [x, y, z]) <= 1e-5 * length * z, "{normal:?}");
        // The normal of the splat is the frame's cross product; what was turned says so.
        let given = dot(cross(first, second), [x, y, z]);
        let clear = given.abs() > 1e-4 * z * dot(cross(first, second), cross(first, second)).sqrt();
        prop_assert!(!clear || got.back == (given > 0.0), "{given} {}", got.back);
    }

    #[test]
    fn every_bit_pattern_is_defined(
        centre: [(i32, i32); 3], mantissas: [[i32; 3]; 3], exponents: [i32; 4], weight: (i32, i32), colour: [u32; 4],
        position: [i64; 3], focal: [(i32, i32); 2], low_pass: (i32, i32), orthographic: bool,
    ) {
        let axis = |k: usize| Axis { mantissa: mantissas[k], exponent: exponents[k] };
        let surface = SurfaceSplat {
            centre: centre.map(|(mantissa, exponent)| SoftFloat { mantissa, exponent }),
            frame: [axis(0), axis(1)],
            normal: axis(2),
            weight: SoftFloat { mantissa: weight.0, exponent: weight.1 },
            colour: [0, 1, 2].map(|c: usize| U4F28::from_bits(colour[c])),
            opacity: U4F28::from_bits(colour[3]),
            material: 255,
        };
        let view = View {
            pose: Eye { position, exponent: exponents[3], ..Eye::ORIGIN },
            focal: focal.map(|(mantissa, exponent)| SoftFloat { mantissa, exponent }),
            projection: if orthographic { Projection::Orthographic } else { Projection::Perspective },
            ..view()
        };
        let rules = Rules { low_pass: SoftFloat { mantissa: low_pass.0, exponent: low_pass.1 }, ..Rules::SURFACE };
        let _ = setup_surface(Standard24, &view, &rules, &surface).map(|f| f.depth_at(u16::MAX, 0));
        let _ = setup_surface(Classic8, &view, &rules, &surface);
        let _ = setup_surface(Deep32, &view, &rules, &surface);
    }
}
