extern crate std;
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
use std::vec::Vec;

const WIDTHS: Widths = Standard24::WIDTHS;

/// Centres as fine as they come.
const BOXES: Widths = Widths {
    subpixel: 24,
    ..WIDTHS
};

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
    let bounds = |centre| {
        bounding_box(
            &BOXES,
            &view(Eye::ORIGIN, [1; 2]),
            centre,
            &nothing,
            1 << 28,
        )
    };
    assert_eq!(bounds([19 << 23, 11 << 23]), Ok(([9, 5], [10, 6])));
    assert_eq!(bounds([(19 << 23) + 1, 11 << 23]), Err(Cull::Outside));
}

#[test]
fn boxes_are_these() {
    let mut next = crate::random();
    let mut view = view(Eye::ORIGIN, [1; 2]);
    view.viewport = [32768; 2];
    let words = (0..2000).flat_map(|_| {
        let mut variance = || part((next() >> 1) as i64, -35);
        let covariance = Covariance2d {
            xx: variance(),
            xy: SoftFloat::ZERO,
            yy: variance(),
            determinant: SoftFloat::ZERO,
        };
        let centre = [0; 2].map(|_| (next() >> 25) as i64);
        let bounds = bounding_box(&BOXES, &view, centre, &covariance, next() as u32);
        let (first, end) = bounds.unwrap_or_default();
        [first[0], first[1], end[0], end[1]].map(u64::from)
    });
    assert_eq!(digest(words), 17_678_529_370_885_420_965);
}

/// A mantissa of 16 bits times the cut-off's 16 does not fit a signed word. Axes have six bits more than mantissas.
#[test]
fn long_products_of_short_mantissas() {
    let spread = SoftFloat::from_wide(65_535, -12, 16);
    let covariance = Covariance2d {
        xx: spread,
        xy: SoftFloat::ZERO,
        yy: spread,
        determinant: SoftFloat::ZERO,
    };
    let bounds = |mantissa| {
        let widths = Widths { mantissa, ..BOXES };
        let centre = [19 << 23, 11 << 23];
        bounding_box(
            &widths,
            &view(Eye::ORIGIN, [1; 2]),
            centre,
            &covariance,
            65_535 << 12,
        )
    };
    assert!(bounds(16).is_ok() && bounds(16) == bounds(24));
    assert_eq!(axis_bits(&Lean18::WIDTHS), 24);
}

/// Focal lengths of the two directions are not mixed up: samples are spaced by the smaller, a point's area has both, a
/// ball's radii one each.
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
    let least = Rules {
        spacing: SoftFloat {
            mantissa: 1,
            exponent: -5,
        },
        ..rules
    };
    let unequal = view(Eye::ORIGIN, [16, 32]);
    let projected = project(&WIDTHS, &unequal, &rules, &ahead(16)).unwrap();
    assert!(enlargement(&WIDTHS, &least, &projected).is_some());
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

/// A ball that ends where it begins ends at 0, one without a size has no spread, and one that reaches the eye's plane
/// is too near.
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
    let small = setup_sphere(Standard24, &view, &Rules::EWA, &ball(part(1, -20)), kind);
    assert_eq!(small.unwrap().spread, 0);
    let near = (Ellipse::Approximate, Index::Affine);
    let beside = SphereSplat {
        centre: [whole(16), SoftFloat::ZERO, whole(16)],
        ..ball(whole(8))
    };
    let reaching = setup_sphere(Standard24, &view, &Rules::EWA, &beside, near);
    assert_eq!(reaching, Err(Cull::Near));
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
    // Seen edge-on, a normal points neither way and is not turned.
    let edge_on = SurfaceSplat {
        normal: axis(0),
        ..splat
    };
    let surface = setup_surface(Standard24, &view, &Rules::SURFACE, &edge_on).unwrap();
    assert!(!surface.back && surface.attributes.normal[0] > 0);
}

fn words(footprint: &Footprint) -> impl Iterator<Item = u64> {
    let Footprint {
        depth,
        centre,
        first,
        end,
        ldl,
        conic,
        cutoff,
        opacity,
        colour,
    } = *footprint;
    let Ldl {
        horizontal,
        squared_width,
        shear,
        vertical,
    } = ldl;
    let numbers = [horizontal, squared_width, shear, vertical];
    let numbers =
        numbers.map(|number| (number.mantissa as u64) << 32 | u64::from(number.exponent as u32));
    let bounds = [first, end].concat().into_iter().map(u64::from);
    let conic = conic
        .mantissa
        .map(|mantissa| mantissa as u64)
        .into_iter()
        .chain([conic.exponent as u64]);
    [depth, cutoff.into(), opacity.into()]
        .into_iter()
        .chain(centre.map(|place| place as u64))
        .chain(bounds)
        .chain(numbers)
        .chain(conic)
        .chain(colour.map(u64::from))
}

/// What setup makes of a splat, or the place of the reason why it makes nothing.
fn outcome(result: Result<Footprint, Cull>) -> Vec<u64> {
    match result {
        Ok(footprint) => words(&footprint).collect(),
        Err(reason) => std::vec![reason.place() as u64],
    }
}

/// Splats of all kinds before views of all kinds.
#[test]
fn footprints_are_these() {
    let mut next = crate::random();
    let rules = [
        Rules::EWA,
        Rules::GAUSSIAN_3D,
        Rules {
            compensated: true,
            ..Rules::GAUSSIAN_3D
        },
        Rules {
            spacing: part(1, -3),
            ..Rules::EWA
        },
        Rules {
            spacing: part(1, -3),
            cutoff: Cutoff::Radial(4 << 28),
            ..Rules::GAUSSIAN_3D
        },
    ];
    let found = [WIDTHS, Lean18::WIDTHS].map(|widths| {
        let design = RuntimeWidths::<i64>::new(widths).unwrap();
        let words = (0..1500usize).flat_map(|step| {
            let rules = &rules[step % 5];
            let mut view = view(Eye::ORIGIN, [0; 2].map(|_| (next() % 60 + 4) as i64));
            if step % 7 == 0 {
                view.projection = Projection::Orthographic;
            }
            let centre = [6, 6, 3].map(|drop| part(next() as i64 >> drop, -57));
            let mut axis = || Axis {
                mantissa: [0; 3].map(|_| next() as i32),
                exponent: -33 + (step % 4) as i32,
            };
            let axes = [axis(), axis(), axis()];
            let weight = part(next() as i64 >> 4, -60);
            let colour = [0; 3].map(|_| U4F28::from_bits(next() as u32));
            let splat = VolumeSplat {
                centre,
                axes,
                weight,
                colour,
            };
            let surface = SurfaceSplat {
                centre,
                frame: [axes[0], axes[1]],
                normal: axes[2],
                weight,
                colour,
                opacity: colour[0],
                material: 1,
            };
            let ball = SphereSplat {
                centre,
                deviation: part((next() >> 3) as i64, -62),
                weight,
                colour,
            };
            let ellipse = [Ellipse::Exact, Ellipse::Approximate][step % 2];
            let index = [Index::Affine, Index::Perspective, Index::Ray][step % 3];
            let mut words = outcome(setup(design, &view, rules, &splat));
            words.push(is_minified(&widths, &view, rules, &splat).into());
            if let Some(filter) = PointFilter::new(&widths, rules, part(1, -3)) {
                words.extend(outcome(setup_point(design, &view, rules, &splat, &filter)));
            }
            match setup_sphere(design, &view, rules, &ball, (ellipse, index)) {
                Err(reason) => words.push(reason.place() as u64),
                Ok(sphere) => {
                    words.extend(outcome(Ok(sphere.footprint)));
                    let slant = sphere.slant.map_or(0, |slant| slant.mantissa as u64);
                    words.extend([sphere.spread.into(), sphere.end.into(), slant]);
                }
            }
            match setup_surface(design, &view, &Rules::SURFACE, &surface) {
                Err(reason) => words.push(reason.place() as u64),
                Ok(surface) => {
                    words.extend(outcome(Ok(surface.footprint)));
                    words.push(surface.plane.origin as u64);
                    words.extend(surface.plane.step.map(|step| step as u64));
                    words.extend(surface.attributes.normal.map(|part| part as u64));
                    words.push(surface.back.into());
                }
            }
            words
        });
        digest(words)
    });
    assert_eq!(found, [266_743_667_471_029_039, 14_144_085_967_316_788_719]);
}

/// Footprints reach 2^28 pixels, centres 2^26, exponents as far as the packet's.
#[test]
fn numbers_end_where_their_words_do() {
    let wide = |extent| {
        let covariance = Covariance2d {
            xx: extent,
            xy: SoftFloat::ZERO,
            yy: SoftFloat::ZERO,
            determinant: SoftFloat::ZERO,
        };
        bounding_box(
            &BOXES,
            &view(Eye::ORIGIN, [1; 2]),
            [19 << 23, 11 << 23],
            &covariance,
            1 << 28,
        )
    };
    assert_eq!(wide(part(255, 47)), Ok(([0, 5], [20, 6])));
    assert_eq!(wide(part(1, 56)), Err(Cull::Range));
    let centre = |across| {
        let centre = [part(across, 0), SoftFloat::ZERO, whole(1)];
        project(
            &WIDTHS,
            &view(Eye::ORIGIN, [1 << 10, 1]),
            &Rules::EWA,
            &centre,
        )
        .map(|projected| projected.centre[0] >> 24)
    };
    assert_eq!(centre((1 << 16) - 1), Ok((1 << 26) - 1024 + 9));
    assert_eq!(centre(1 << 16), Err(Cull::Range));
    let number = |exponent| SoftFloat {
        mantissa: 1 << (WIDTHS.mantissa - 1),
        exponent,
    };
    let ends = [-513, -512, 511, 512];
    assert_eq!(
        ends.map(|end| shape::packable(number(end))),
        [false, true, true, false]
    );
    assert_eq!(
        ends.map(|end| shape::packable_shear(number(end)).exponent),
        [0, -512, 511, 512]
    );
    let unit = number(1 - i32::from(WIDTHS.mantissa));
    let conics = ends.map(|end| {
        let covariance = Covariance2d {
            xx: number(end),
            xy: SoftFloat::ZERO,
            yy: unit,
            determinant: unit,
        };
        conic(&WIDTHS, &covariance, number(end)).map(|conic| conic.exponent)
    });
    assert_eq!(conics, [None, Some(-512), Some(511), None]);
    let turned = [-513, -512, -511, 510, 511, 512].map(|exponent| {
        let axis = Axis {
            mantissa: [i32::MIN, 12_345_679, -7_654_321],
            exponent,
        };
        let rotation = view(Eye::ORIGIN, [1; 2]).rotation;
        jacobian::rotate_axis(&WIDTHS, &rotation, axis).map(|part| (part.mantissa, part.exponent))
    });
    assert_eq!((turned[0], turned[4]), (turned[1], turned[5]));
    assert_eq!(turned[1][0].1 + 1, turned[2][0].1);
    assert_eq!(turned[3][0].1 + 1, turned[4][0].1);
}

/// A weight of 0 or less shows nothing, the least one shows what it is.
#[test]
fn weights_end_at_zero() {
    let view = view(Eye::ORIGIN, [16; 2]);
    let rules = Rules {
        spacing: part(1, -5),
        cutoff: Cutoff::Radial(4 << 28),
        ..Rules::GAUSSIAN_3D
    };
    let projected = project(&WIDTHS, &view, &rules, &ahead(16)).unwrap();
    let unit = Covariance2d {
        xx: whole(1),
        xy: SoftFloat::ZERO,
        yy: whole(1),
        determinant: whole(1),
    };
    let filter = PointFilter::new(&WIDTHS, &rules, part(1, -5)).unwrap();
    for (mantissa, seen) in [(-1, false), (0, false), (1, true)] {
        let weight = SoftFloat {
            mantissa,
            exponent: 8,
        };
        let peak = centre_opacity(&WIDTHS, &rules, weight, &projected, &unit);
        assert_eq!(peak.mantissa > 0, seen);
        assert_eq!(
            surface_opacity(&WIDTHS, weight, whole(1), &unit).mantissa > 0,
            seen
        );
        let splat = VolumeSplat {
            centre: ahead(16),
            weight,
            ..VolumeSplat::EMPTY
        };
        assert_eq!(
            setup_point(Standard24, &view, &rules, &splat, &filter).is_ok(),
            seen
        );
        let aside = VolumeSplat {
            centre: [whole(1 << 10), SoftFloat::ZERO, whole(16)],
            ..splat
        };
        let reason = if seen {
            Cull::Outside
        } else {
            Cull::Transparent
        };
        let found = setup_point(Standard24, &view, &rules, &aside, &filter);
        assert_eq!(found, Err(reason));
        let ball = SphereSplat {
            weight,
            ..ball(part(1, -1))
        };
        let kind = (Ellipse::Exact, Index::Affine);
        assert_eq!(
            setup_sphere(Standard24, &view, &rules, &ball, kind).is_ok(),
            seen
        );
    }
}

/// A peak at the threshold ends at once, one a little above it a little later.
#[test]
fn cutoffs_begin_with_one_unit() {
    let rules = Rules {
        alpha_min: 1 << 59,
        ..Rules::GAUSSIAN_3D
    };
    let peak = |above| SoftFloat {
        mantissa: (1 << 30) + above,
        exponent: -31,
    };
    let ends = [0, 1, 2, 3, 4, 5, 6].map(|above| cutoff(&rules, peak(above)));
    assert_eq!(ends[0], None);
    assert!(
        ends.contains(&Some(1)) && !ends.contains(&Some(0)),
        "{ends:?}"
    );
}

#[test]
fn peaks_are_these() {
    let mut next = crate::random();
    let words = (0..4000).map(|_| {
        let peak = part(next() as i64 >> (next() % 50), -62);
        let fraction = (next() % 33) as u32;
        opacity_fixed(peak, fraction).map_or(0, u64::from)
    });
    assert_eq!(digest(words), 14_198_792_175_795_188_118);
}
