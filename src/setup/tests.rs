use super::distance::enlargement;
use super::*;
use crate::digest;
use crate::format::{Lean18, RuntimeWidths, Standard24};
use crate::math::Extended;
use crate::rules::Cutoff;
use crate::splat::surface::SurfaceSplat;
use crate::splat::{Axis, SphereSplat};
use crate::view::{Eye, Projection, RatioLimits, Translation};
use fixed::types::{I2F30, I8F24, I10F54, I32F32, U4F28};

const WIDTHS: Widths = Standard24::WIDTHS;

fn whole(value: i64) -> SoftFloat {
    SoftFloat::from_wide(value, 0, 24)
}

fn part(value: i64, power: i32) -> SoftFloat {
    SoftFloat::from_wide(value, power, 24)
}

/// From the origin along z onto 20 by 12 pixels, whose middle is the sample of column 9 and row 5.
pub(crate) fn view<P>(pose: P, focal: [i64; 2]) -> View<P> {
    let mut rotation = [[I2F30::ZERO; 3]; 3];
    for (axis, row) in rotation.iter_mut().enumerate() {
        row[axis] = I2F30::ONE;
    }
    View {
        rotation,
        pose,
        focal: focal.map(whole),
        principal: [19, 11].map(|halves| I32F32::from_bits(halves << 31)),
        near: Extended::ZERO,
        far: Extended::MAX,
        viewport: [20, 12],
        projection: Projection::Perspective,
        limits: RatioLimits {
            low: [I32F32::MIN; 2],
            high: [I32F32::MAX; 2],
        },
    }
}

fn ahead(distance: i64) -> [SoftFloat; 3] {
    [SoftFloat::ZERO, SoftFloat::ZERO, whole(distance)]
}

fn ball(deviation: SoftFloat) -> SphereSplat {
    SphereSplat {
        centre: ahead(16),
        deviation,
        weight: whole(1),
        colour: [U4F28::ONE; 3],
    }
}

/// A footprint without extent on a sample has that pixel.
#[test]
fn a_box_holds_the_sample_at_its_edge() {
    let nothing = Covariance2d {
        xx: SoftFloat::ZERO,
        xy: SoftFloat::ZERO,
        yy: SoftFloat::ZERO,
        determinant: SoftFloat::ZERO,
    };
    let bounds = |centre| bounding_box(24, &view(Eye::ORIGIN, [1; 2]), centre, &nothing, 1 << 28);
    assert_eq!(bounds([19 << 23, 11 << 23]), Ok(([9, 5], [10, 6])));
    assert_eq!(bounds([(19 << 23) + 1, 11 << 23]), Err(Cull::Outside));
}

/// Focal lengths of the two directions are not mixed up: samples are spaced by the smaller, a point's area has both, a ball's radii one each.
#[test]
fn unequal_focal_lengths() {
    let rules = Rules {
        spacing: part(1, -5),
        cutoff: Cutoff::Radial(4 << 28),
        low_pass: SoftFloat::ZERO,
        ..Rules::GAUSSIAN_3D
    };
    let filter = PointFilter::new(&WIDTHS, &rules, part(1, -5)).unwrap();
    let point = |focal| {
        let splat = VolumeSplat {
            centre: ahead(16),
            weight: whole(1),
            ..VolumeSplat::EMPTY
        };
        let view = view(Eye::ORIGIN, focal);
        let enlarged = project(&WIDTHS, &view, &rules, &splat.centre)
            .map(|projected| enlargement(&WIDTHS, &rules, &projected));
        let footprint = setup_point(Standard24, &view, &rules, &splat, &filter).unwrap();
        (
            footprint.opacity,
            enlarged.unwrap().map(|factor| factor.to_fixed(20)),
        )
    };
    // 1 and 2 of 2^-5 scene units a pixel: 2^-9 of a pixel's area.
    let expected = (1 << (u32::from(WIDTHS.peak) - 9), Some(32 << 20));
    assert_eq!([[16, 32], [32, 16]].map(point), [expected; 2]);

    let sphere = |focal| {
        let view = view(Eye::ORIGIN, focal);
        let kind = (Ellipse::Approximate, Index::Affine);
        let footprint = setup_sphere(Standard24, &view, &rules, &ball(part(1, -1)), kind)
            .unwrap()
            .footprint;
        let inverses = [footprint.ldl.horizontal, footprint.ldl.vertical];
        (
            [0, 1].map(|axis| footprint.end[axis] - footprint.first[axis]),
            inverses.map(|inverse| inverse.to_fixed(2)),
        )
    };
    // Deviations of 1/2 and 2 pixels.
    let expected = [([3, 9], [16, 1]), ([9, 3], [1, 16])];
    assert_eq!([[16, 64], [64, 16]].map(sphere), expected);
    let spread = |focal| {
        let kind = (Ellipse::Exact, Index::Perspective);
        let view = view(Eye::ORIGIN, focal);
        let sphere = setup_sphere(Standard24, &view, &rules, &ball(part(1, -1)), kind);
        sphere.unwrap().spread
    };
    // (s/z)^2.
    assert_eq!([[16, 64], [64, 16]].map(spread), [1 << 22; 2]);
}

/// A ball that ends where it begins ends at 0.
#[test]
fn a_ball_may_have_no_extent() {
    let rules = Rules {
        cutoff: Cutoff::Radial(0),
        ..Rules::EWA
    };
    let kind = (Ellipse::Exact, Index::Perspective);
    let view = view(Eye::ORIGIN, [16; 2]);
    let sphere = setup_sphere(Standard24, &view, &rules, &ball(part(1, -1)), kind).unwrap();
    assert_eq!((sphere.footprint.cutoff, sphere.end), (0, 0));
}

/// What is not ahead of the eye is culled wherever the near plane is; the least depth is not.
#[test]
fn only_what_lies_ahead_is_projected() {
    let behind = Extended {
        value: -1,
        exponent: 0,
    };
    let at = |depth: i64, projection| {
        let mut view = view(Translation([0, 0, depth].map(I10F54::from_bits)), [1; 2]);
        (view.near, view.projection) = (behind, projection);
        depth_of(&WIDTHS, &view, &[I8F24::ZERO; 3]).map(|depth| depth.value)
    };
    assert_eq!(at(1, Projection::Perspective), Ok(1));
    assert_eq!(at(0, Projection::Perspective), Err(Cull::Near));
    assert_eq!(at(-1, Projection::Perspective), Err(Cull::Near));
    assert_eq!(at(-1, Projection::Orthographic), Ok(-1));
}

/// A ratio between a limit and its next number keeps its bits.
#[test]
fn ratios_within_the_limits_are_exact() {
    let tiny = [part(1, -36), part(-1, -36), whole(16)];
    for [low, high] in [[I32F32::ZERO, I32F32::ONE], [I32F32::NEG_ONE, I32F32::ZERO]] {
        let mut view = view(Eye::ORIGIN, [1; 2]);
        view.limits = RatioLimits {
            low: [low; 2],
            high: [high; 2],
        };
        let projected = project(&WIDTHS, &view, &Rules::GAUSSIAN_3D, &tiny).unwrap();
        assert_eq!(projected.ratio.map(SoftFloat::leading), [-40; 2]);
    }
}

#[test]
fn cutoffs_are_these() {
    let words = (1..500u64).map(|step| {
        let rules = Rules {
            alpha_min: (step << 50) | step.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 14,
            ..Rules::GAUSSIAN_3D
        };
        cutoff(&rules, whole(1)).map_or(0, u64::from)
    });
    assert_eq!(digest(words), 3_040_616_151_567_547_780);
}

/// A surface's colour, premultiplied in its attributes, has a colour's bits in its footprint.
#[test]
fn a_surface_has_its_colour() {
    let axis = |place: usize| {
        let mut mantissa = [0; 3];
        mantissa[place] = 1 << 30;
        Axis {
            mantissa,
            exponent: -30,
        }
    };
    let splat = SurfaceSplat {
        centre: ahead(16),
        frame: [axis(0), axis(1)],
        normal: axis(2),
        weight: whole(1),
        colour: [U4F28::ONE, U4F28::ONE >> 1, U4F28::ZERO],
        opacity: U4F28::ONE,
        material: 0,
    };
    let view = view(Eye::ORIGIN, [16; 2]);
    for widths in [WIDTHS, Lean18::WIDTHS] {
        let design = RuntimeWidths::<i64>::new(widths).unwrap();
        let surface = setup_surface(design, &view, &Rules::SURFACE, &splat).unwrap();
        let one = 1 << widths.colour;
        assert_eq!(surface.footprint.colour, [one, one / 2, 0]);
    }
}
