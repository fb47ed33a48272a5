//! Stamps, points, spheres and distance scaling: against slower ways to the same result, and for any input bits.

use crate::common::{SIZE, double, scaled, splats, view};
use fixed::types::U4F28;
use proptest::prelude::*;
use splatline::blend::Pixel;
use splatline::blend::points::{Slab, Slabs};
use splatline::draw::{Painter, Perspective, PointSettings};
use splatline::footprint::Footprint;
use splatline::format::{Standard24, Traversal, Widths};
use splatline::kernel::{
    FootprintTable, Kernel, PERSPECTIVE_ENTRIES, PerspectiveTable, Rays, entries, fill,
    fill_perspective,
};
use splatline::math::SoftFloat;
use splatline::raster::{Stamp, StampShape, Window, fill_stamps};
use splatline::rules::{Compositing, Rules};
use splatline::setup::{Ellipse, Index, PointFilter, setup, setup_point, setup_sphere};
use splatline::splat::{Axis, SphereSplat, VolumeSplat};
use splatline::target::Target;
use splatline::view::Projection;

const WIDTHS: Widths = Standard24::WIDTHS;

const SCREEN: Window = Window {
    first: [0; 2],
    end: [SIZE; 2],
};

fn rules(spacing: f64) -> Rules {
    Rules {
        low_pass: SoftFloat::ZERO,
        spacing: scaled(spacing),
        ..Rules::EWA
    }
}

fn table_entries(rules: &Rules) -> Vec<u32> {
    let mut memory = vec![0; entries(&WIDTHS)];
    fill(&mut memory, &WIDTHS, rules.table_range, rules.kernel);
    memory
}

fn painter<'a>(memory: &'a [u32], rules: &Rules) -> Painter<'a, Standard24> {
    let table = FootprintTable::new(memory, &WIDTHS, rules.table_range).unwrap();
    Painter::new(
        Standard24,
        rules,
        table,
        Compositing::FrontToBack,
        Traversal::Spans,
    )
}

fn screen() -> Vec<Pixel> {
    vec![Pixel::clear(&WIDTHS); usize::from(SIZE) * usize::from(SIZE)]
}

/// A ball of deviation 0.05 at a place, seen by the camera of `common` about 4 before the origin.
fn ball(centre: [f64; 3]) -> VolumeSplat {
    let axis = |i: usize| {
        let mut components = [SoftFloat::ZERO; 3];
        components[i] = scaled(0.05);
        Axis::from_components(components)
    };
    VolumeSplat {
        centre: centre.map(scaled),
        axes: [axis(0), axis(1), axis(2)],
        weight: scaled(0.002),
        colour: [1.0, 0.5, 0.25].map(U4F28::from_num),
    }
}

fn point(centre: [f64; 3], rules: &Rules) -> Footprint {
    let view = view(0.0, 0.0, Projection::Perspective);
    let filter = PointFilter::new(&WIDTHS, rules, scaled(0.05)).unwrap();
    setup_point(Standard24, &view, rules, &ball(centre), &filter).unwrap()
}

/// Points with splats between them, drawn window by window: each has its part of the whole picture, by spans and by
/// stamps. The first point's counts are those of its pixels.
#[test]
fn points_are_the_same_in_every_window() {
    let rules = rules(0.03);
    let memory = table_entries(&rules);
    let painter = painter(&memory, &rules);
    let table = FootprintTable::new(&memory, &WIDTHS, rules.table_range).unwrap();
    let view = view(0.0, 0.0, Projection::Perspective);
    let place = |index: i32| [index * 5 % 7 - 3, index * 3 % 5 - 2, index].map(f64::from);
    let scene: Vec<(Footprint, Footprint)> = (0..24)
        .map(place)
        .map(|[x, y, z]| {
            let at = [0.2 * x, 0.2 * y, 0.01 * z];
            let splat = setup(Standard24, &view, &Rules::EWA, &ball(at)).unwrap();
            (point(at, &rules), splat)
        })
        .collect();
    let model = &scene[0].0;
    let shape = StampShape::new(model, 2).unwrap();
    let mut words = vec![0; shape.words()];
    assert!(fill_stamps(&mut words, Standard24, &table, &shape, model));
    for stamp in [None, Stamp::new(&words, shape)] {
        let settings = PointSettings { range: 100, stamp };
        let drawn = |window: Window, scene: &[(Footprint, Footprint)], splats: bool| {
            let size = window.pixels();
            let (mut pixels, mut slabs) = (
                vec![Pixel::clear(&WIDTHS); size],
                vec![Slab::default(); size],
            );
            let mut target = Target::new(&mut pixels, window, window.columns().into()).unwrap();
            let mut slabs = Slabs::new(&mut slabs, window).unwrap();
            let mut counts = [0; 2];
            for (point, splat) in scene {
                let coverage = painter.draw_point(point, &settings, &mut target, &mut slabs);
                counts = [counts[0] + coverage.visited, counts[1] + coverage.covered];
                if splats {
                    painter.draw_among_points(splat, &mut target, &mut slabs);
                }
            }
            painter.finish_points(&mut target, &mut slabs);
            (pixels, counts)
        };
        let (whole, _) = drawn(SCREEN, &scene, true);
        for (first, end) in [
            ([13, 7], [40, 64]),
            ([30, 50], [90, 60]),
            ([5, 40], [60, 47]),
        ] {
            let part = drawn(Window { first, end }, &scene, true).0;
            let places = (first[1]..end[1]).flat_map(|y| (first[0]..end[0]).map(move |x| (x, y)));
            let expected =
                places.map(|(x, y)| whole[usize::from(y) * usize::from(SIZE) + usize::from(x)]);
            assert!(expected.eq(part), "{first:?}");
        }
        let (pixels, [visited, covered]) = drawn(SCREEN, &scene[..1], false);
        let changed = pixels
            .iter()
            .filter(|pixel| **pixel != Pixel::clear(&WIDTHS))
            .count();
        assert_eq!(covered, changed as u64);
        let cells = shape.side().map(u64::from);
        assert!(visited >= covered && (stamp.is_none() || visited == cells[0] * cells[1]));
        assert!(drawn(SCREEN, &scene, false).0 != whole);
    }
}

/// At a phase, a stamp is its footprint to the last bit but one of the lanes.
#[test]
fn a_stamp_is_the_footprint_at_its_phase() {
    let rules = rules(0.03);
    let memory = table_entries(&rules);
    let (painter, table) = (
        painter(&memory, &rules),
        FootprintTable::new(&memory, &WIDTHS, rules.table_range).unwrap(),
    );
    let model = point([0.0, 0.1, 0.0], &rules);
    for bits in [0, 2, 4] {
        let shape = StampShape::new(&model, bits).unwrap();
        let mut words = vec![0; shape.words()];
        assert!(fill_stamps(&mut words, Standard24, &table, &shape, &model));
        let stamp = Stamp::new(&words, shape).unwrap();
        // Phases of both axes, at the screen's corners and across blocks of columns.
        for at in [[0i64, 0], [17, 5], [63, 40], [95, 95]] {
            for step in 0..1i64 << bits {
                let placed = at.map(|a| {
                    (a << WIDTHS.subpixel) + ((step * 5 % (1 << bits)) << (WIDTHS.subpixel - bits))
                });
                let bounds = shape.bounds(&shape.place(placed, WIDTHS.subpixel), [SIZE; 2]);
                let placed = Footprint {
                    centre: placed,
                    first: bounds.first,
                    end: bounds.end,
                    ..model
                };
                let (mut by_spans, mut by_stamp) = (screen(), screen());
                let mut target = Target::new(&mut by_spans, SCREEN, SIZE.into()).unwrap();
                painter.draw(&placed, &mut target);
                let mut target = Target::new(&mut by_stamp, SCREEN, SIZE.into()).unwrap();
                painter.draw_stamp(&stamp, &placed, &mut target);
                for (a, b) in by_spans.iter().zip(&by_stamp) {
                    let apart = a.transmittance.abs_diff(b.transmittance);
                    // Two units of the kernel value, UQ1.26, in a transmittance of 30 bits: the lanes differ in their
                    // last bits.
                    assert!(apart <= 128, "{bits} bits at {at:?}, step {step}: {apart}");
                }
            }
        }
    }
}

/// Beyond k a footprint keeps its size and its peak falls by the square of the distance (\[SWAN\] 4.3).
#[test]
fn distance_scaling_keeps_the_size_and_the_energy() {
    // Samples 0.05 apart with 90 pixels per unit and depth: k = 4.5 or less, for the smaller focal length.
    let (view, rules) = (view(0.0, 0.0, Projection::Perspective), rules(0.05));
    let at = |depth: f64| {
        let splat = ball([-0.1, 0.2, depth - 4.0]);
        setup(Standard24, &view, &rules, &splat).unwrap()
    };
    let spread = |depth: f64| double(at(depth).ldl.squared_width);
    assert!((spread(9.0) / spread(18.0) - 1.0).abs() < 1e-6);
    assert!((spread(2.0) / spread(4.0) - 4.0).abs() < 1e-6);
    let peak = |depth: f64| f64::from(at(depth).opacity);
    assert!((peak(9.0) / peak(18.0) - 4.0).abs() < 1e-4);
    assert!((peak(2.0) / peak(4.0) - 1.0).abs() < 1e-4);
    // Under peak opacity the weight itself is dimmed.
    let opacity = Rules {
        normalised: false,
        ..rules
    };
    let dimmed = setup(Standard24, &view, &opacity, &ball([-0.1, 0.2, 5.0])).unwrap();
    let expected = 0.002 * (4.5f64 / 9.0).powi(2) * f64::from(WIDTHS.peak).exp2();
    assert!((f64::from(dimmed.opacity) / expected - 1.0).abs() < 1e-5);
}

/// Where the choice between point and splat changes, both are the same footprint, in the middle of the picture.
#[test]
fn points_and_splats_meet_at_the_distance_k() {
    let (view, rules) = (view(0.0, 0.0, Projection::Perspective), rules(0.05));
    let filter = PointFilter::new(&WIDTHS, &rules, scaled(0.05)).unwrap();
    let splat = ball([-0.1, 0.2, 0.501]);
    let as_splat = setup(Standard24, &view, &rules, &splat).unwrap();
    let as_point = setup_point(Standard24, &view, &rules, &splat, &filter).unwrap();
    assert_eq!(as_splat.centre, as_point.centre);
    let ratio = |a: SoftFloat, b: SoftFloat| (double(a) / double(b) - 1.0).abs();
    assert!(ratio(as_splat.ldl.squared_width, as_point.ldl.squared_width) < 1e-3);
    assert!((f64::from(as_splat.opacity) / f64::from(as_point.opacity) - 1.0).abs() < 0.06);
}

/// Equal for every kernel: nothing is drawn beyond the shape's end, something just before it.
#[test]
fn every_kernel_ends_where_it_says() {
    for kernel in Kernel::ALL {
        let rules = Rules::EWA.with_kernel(kernel);
        let view = view(0.0, 0.0, Projection::Orthographic);
        let mut splat = ball([0.0; 3]);
        splat.weight = scaled(0.5);
        let footprint = setup(Standard24, &view, &rules, &splat).unwrap();
        let memory = table_entries(&rules);
        let mut pixels = screen();
        let mut target = Target::new(&mut pixels, SCREEN, SIZE.into()).unwrap();
        painter(&memory, &rules).draw(&footprint, &mut target);
        let end = f64::from(footprint.cutoff) / 2f64.powi(28);
        let unit = f64::from(WIDTHS.subpixel).exp2();
        let [u, v] = footprint.centre.map(|c| c as f64 / unit);
        let (curvature, stretch) = (footprint.ldl.horizontal, footprint.ldl.vertical);
        for (index, pixel) in pixels.iter().enumerate() {
            let x = (index % usize::from(SIZE)) as f64 + 0.5 - u;
            let y = (index / usize::from(SIZE)) as f64 + 0.5 - v;
            let radial = double(curvature) * x * x + double(stretch) * y * y;
            let drawn = pixel.transmittance != Pixel::clear(&WIDTHS).transmittance;
            if radial > end + 1e-3 || radial < 0.9 * end {
                assert_eq!(drawn, radial < end, "{kernel:?} at {radial}");
            }
        }
    }
}

proptest! {
    /// Any bits: no panic, nothing outside the target, no more steps than pixels.
    #[test]
    fn any_sphere_is_defined(
        centre in any::<[(i32, i32); 3]>(),
        (mantissa, exponent, weight, power) in any::<(i32, i32, i32, i32)>(),
        shape in 0usize..6,
    ) {
        let rules = Rules::EWA;
        let view = view(0.3, -0.2, Projection::Perspective);
        let sphere = SphereSplat {
            centre: centre.map(|(mantissa, exponent)| SoftFloat { mantissa, exponent }),
            deviation: SoftFloat { mantissa, exponent },
            weight: SoftFloat { mantissa: weight, exponent: power },
            colour: [U4F28::MAX; 3],
        };
        any_sphere(&view, &rules, &sphere, shape);
        // And with exponents in a range that reaches the screen.
        let near = SphereSplat {
            deviation: SoftFloat { mantissa, exponent: -32 - exponent % 8 },
            weight: SoftFloat { mantissa: weight, exponent: -30 },
            centre: centre.map(|(bits, _)| SoftFloat { mantissa: bits >> 5, exponent: -24 }),
            ..sphere
        };
        any_sphere(&view, &rules, &near, shape);
    }

    #[test]
    fn any_splat_as_a_point_is_defined(splat in splats(), spacing in 0.001f64..0.2, bits in 0u8..=7) {
        let (view, rules) = (view(0.1, 0.2, Projection::Perspective), rules(spacing));
        let filter = PointFilter::new(&WIDTHS, &rules, scaled(0.05)).unwrap();
        let Ok(point) = setup_point(Standard24, &view, &rules, &splat, &filter) else {
            return Err(TestCaseError::reject("culled"));
        };
        let memory = table_entries(&rules);
        let painter = painter(&memory, &rules);
        let table = FootprintTable::new(&memory, &WIDTHS, rules.table_range).unwrap();
        let mut words = Vec::new();
        let shape = StampShape::new(&point, bits).ok().filter(|shape| shape.words() < 1 << 16);
        let stamp = shape.and_then(|shape| {
            words.resize(shape.words(), 0);
            fill_stamps(&mut words, Standard24, &table, &shape, &point);
            Stamp::new(&words, shape)
        });
        let window = Window { first: [13, 7], end: [70, 64] };
        let mut pixels = vec![Pixel::clear(&WIDTHS); 57 * 57];
        let mut memory = vec![Slab::default(); 57 * 57];
        let mut target = Target::new(&mut pixels, window, 57).unwrap();
        let mut slabs = Slabs::new(&mut memory, window).unwrap();
        let gathering = PointSettings { range: 1000, stamp };
        let coverage = painter.draw_point(&point, &gathering, &mut target, &mut slabs);
        prop_assert!(coverage.visited <= 57 * 57);
        painter.draw_among_points(&point, &mut target, &mut slabs);
        painter.finish_points(&mut target, &mut slabs);
    }
}

fn any_sphere(view: &splatline::view::View, rules: &Rules, sphere: &SphereSplat, shape: usize) {
    let ellipse = [Ellipse::Exact, Ellipse::Approximate][shape % 2];
    let index = [Index::Affine, Index::Perspective, Index::Ray][shape / 2];
    let Ok(footprint) = setup_sphere(Standard24, view, rules, sphere, (ellipse, index)) else {
        return;
    };
    let memory = table_entries(rules);
    let mut table = [0; PERSPECTIVE_ENTRIES];
    fill_perspective(&mut table);
    let perspective = Perspective {
        table: PerspectiveTable::new(&table),
        rays: Rays::new(view),
    };
    let mut pixels = screen();
    let mut target = Target::new(&mut pixels, SCREEN, SIZE.into()).unwrap();
    let coverage = painter(&memory, rules).draw_sphere(&footprint, &perspective, &mut target);
    assert!(coverage.visited <= u64::from(SIZE) * u64::from(SIZE));
}
