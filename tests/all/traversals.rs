//! Both traversals against a naive loop over all pixels, and tiles against the whole.

use crate::common::{SIZE, double, scaled, splats, tolerances, view};
use proptest::prelude::*;
use splatline::blend::{Blend, Pixel};
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{Deep32, Design, Lane, Lean18, Standard24, Traversal};
use splatline::kernel::{FootprintTable, entries, fill_gaussian};
use splatline::math::SoftFloat;
use splatline::raster::{BoxSpans, EllipseSpans, Spans, Window};
use splatline::rules::{Compositing, Rules};
use splatline::setup::setup;
use splatline::splat::{Axis, VolumeSplat};
use splatline::target::Target;
use splatline::view::Projection;
use std::collections::BTreeMap;

const SCREEN: Window = Window {
    first: [0; 2],
    end: [SIZE; 2],
};

/// The radial index of every visited pixel; a pixel must not be visited twice, nor a stray one.
fn visited<R: Spans>(mut rows: R, window: &Window) -> BTreeMap<(u16, u16), f64> {
    let unit = f64::from(rows.fraction()).exp2();
    let mut found = BTreeMap::new();
    let mut last = None;
    while let Some(run) = rows.next_span() {
        assert!(run.length > 0);
        assert!(Some((run.y, run.x)) > last, "runs come in reading order");
        last = Some((run.y, run.x));
        for (x, radial) in (run.x..).zip(run.radials()) {
            assert!(
                (window.first[0]..window.end[0]).contains(&x),
                "stray column {x}"
            );
            assert!(
                (window.first[1]..window.end[1]).contains(&run.y),
                "stray row {}",
                run.y
            );
            let earlier = found.insert((run.y, x), radial.to_wide() as f64 / unit);
            assert!(earlier.is_none(), "pixel {x} {} twice", run.y);
        }
    }
    found
}

/// r at a pixel from the packet's own LDL coefficients, in double precision.
fn naive(footprint: &Footprint, subpixel: u8, x: u16, y: u16) -> f64 {
    let unit = f64::from(subpixel).exp2();
    let [u, v] = footprint.centre.map(|c| c as f64 / unit);
    let dy = f64::from(y) + 0.5 - v;
    let dx = f64::from(x) + 0.5 - u - double(footprint.ldl.shear) * dy;
    double(footprint.ldl.horizontal) * dx * dx + double(footprint.ldl.vertical) * dy * dy
}

/// What a painter visits is what it draws, and a pixel that finished before is counted, not drawn.
fn check_visits<D: Design>(
    design: D,
    list: &[VolumeSplat],
    traversal: Traversal,
) -> Result<(), TestCaseError> {
    let (widths, rules) = (design.widths(), Rules::GAUSSIAN_3D);
    let mut memory = vec![0; entries(&widths)];
    fill_gaussian(&mut memory, &widths, rules.table_range);
    let table = FootprintTable::new(&memory, &widths, rules.table_range).unwrap();
    let painter = Painter::new(design, &rules, table, Compositing::FrontToBack, traversal);
    let blend = Blend::new(&widths, &rules);
    let view = view(0.3, 0.2, Projection::Perspective);
    let window = Window {
        first: [9, 5],
        end: [SIZE, SIZE - 3],
    };
    let columns = usize::from(window.columns());
    let [mut drawn, mut visited] = [(); 2].map(|()| vec![Pixel::clear(&widths); window.pixels()]);
    for splat in list {
        let Ok(footprint) = setup(design, &view, &rules, splat) else {
            continue;
        };
        let place = |x: u16, y: u16| usize::from(y - 5) * columns + usize::from(x - 9);
        let before = visited.clone();
        let mut inside = Vec::new();
        let visits = painter.visit(&footprint, &window, |x, y, alpha| {
            let pixel = &mut visited[place(x, y)];
            inside.push(place(x, y));
            if !pixel.is_finished() {
                blend.front_to_back(pixel, alpha, &footprint.colour);
            }
        });
        let mut target = Target::new(&mut drawn, window, columns).unwrap();
        let coverage = painter.draw(&footprint, &mut target);
        prop_assert_eq!(
            (coverage.visited, coverage.covered),
            (visits.visited, visits.covered)
        );
        let finished = inside
            .iter()
            .filter(|place| before[**place].is_finished())
            .count() as u64;
        let skipped = visits.covered - inside.len() as u64;
        prop_assert!((finished..=finished + skipped).contains(&coverage.finished));
        let mut sum = coverage;
        sum += coverage;
        prop_assert_eq!(sum.finished, 2 * coverage.finished);
        prop_assert_eq!(&drawn, &visited);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn what_is_visited_is_what_is_drawn(list in prop::collection::vec(splats(), 1..12)) {
        let opaque: Vec<VolumeSplat> = list.iter().map(|splat| VolumeSplat { weight: scaled(0.999), ..*splat }).collect();
        let both = [opaque, list].concat();
        check_visits(Standard24, &both, Traversal::Spans)?;
        check_visits(Lean18, &both, Traversal::Box)?;
    }
}

fn check<D: Design>(
    name: &'static str,
    design: D,
    splat: &VolumeSplat,
    rules: &Rules,
    yaw: f64,
) -> Result<(), TestCaseError> {
    let Ok(footprint) = setup(
        design,
        &view(yaw, 0.2, Projection::Perspective),
        rules,
        splat,
    ) else {
        return Err(TestCaseError::reject("culled"));
    };
    let widths = design.widths();
    // xc is off by the rounding of slope times rows; a thin row feels it as so many of its own half-widths.
    let rows = f64::from(footprint.end[1] - footprint.first[1]);
    let thinness =
        1.0 + (double(footprint.ldl.shear) * rows).abs() * double(footprint.ldl.horizontal).sqrt();
    let cutoff = f64::from(footprint.cutoff) / 28f64.exp2();
    // Down the rows of a block xc is a sum of steps, each of them half a unit off, as is its seed (2 sqrt(r A) of r for
    // a pixel of xc).
    let drift = (4.0 - f64::from(widths.subpixel + 8)).exp2();
    let drifted = 2.0 * (cutoff * double(footprint.ldl.horizontal)).sqrt() * drift;
    let bound = tolerances::of(&widths).radial * thinness + drifted;
    let found = visited(EllipseSpans::new(design, &footprint, &SCREEN), &SCREEN);
    let mut covered = 0;
    for y in footprint.first[1]..footprint.end[1] {
        for x in footprint.first[0]..footprint.end[0] {
            let exact = naive(&footprint, widths.subpixel, x, y);
            covered += usize::from(exact < cutoff);
            match found.get(&(y, x)) {
                Some(radial) => prop_assert!(
                    (radial - exact).abs() <= bound,
                    "{name} {x} {y}: {radial} {exact} bound {bound:e}"
                ),
                None => prop_assert!(
                    exact >= cutoff - bound,
                    "{name}: pixel {x} {y} with r = {exact} is missed"
                ),
            }
        }
    }
    prop_assert!(
        found.len() <= covered + covered / 50 + 8,
        "{name}: visits {} of {covered}",
        found.len()
    );
    let boxed = visited(BoxSpans::new(design, &footprint, &SCREEN), &SCREEN);
    let [columns, rows] =
        [0, 1].map(|axis| usize::from(footprint.end[axis] - footprint.first[axis]));
    prop_assert_eq!(boxed.len(), columns * rows);
    Ok(())
}

/// Draws the footprints into tiles of the given size and puts the tiles together.
fn draw<D: Design>(
    design: D,
    footprints: &[Footprint],
    rules: &Rules,
    traversal: Traversal,
    tile: [u16; 2],
) -> (Vec<Pixel>, Coverage) {
    let widths = design.widths();
    let mut memory = vec![0; entries(&widths)];
    fill_gaussian(&mut memory, &widths, rules.table_range);
    let table = FootprintTable::new(&memory, &widths, rules.table_range).unwrap();
    let painter = Painter::new(design, rules, table, Compositing::FrontToBack, traversal);
    let mut frame = vec![Pixel::clear(&widths); usize::from(SIZE) * usize::from(SIZE)];
    let mut coverage = Coverage::default();
    for y in (0..SIZE).step_by(tile[1].into()) {
        for x in (0..SIZE).step_by(tile[0].into()) {
            let window = Window {
                first: [x, y],
                end: [(x + tile[0]).min(SIZE), (y + tile[1]).min(SIZE)],
            };
            let start = usize::from(y) * usize::from(SIZE) + usize::from(x);
            let mut target = Target::new(&mut frame[start..], window, SIZE.into()).unwrap();
            for footprint in footprints {
                coverage += painter.draw(footprint, &mut target);
            }
        }
    }
    (frame, coverage)
}

proptest! {
    // Culled splats are replaced by others; the test fails if fewer than a quarter are drawn.
    #![proptest_config(ProptestConfig { cases: 300, max_global_rejects: 900, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn spans_are_the_naive_loop(splat in splats(), ewa: bool, yaw in -0.6f64..0.6) {
        let rules = if ewa { Rules::EWA } else { Rules::GAUSSIAN_3D };
        check("lean18", Lean18, &splat, &rules, yaw)?;
        check("standard24", Standard24, &splat, &rules, yaw)?;
        check("deep32", Deep32, &splat, &rules, yaw)?;
    }

    #[test]
    fn tiles_change_nothing(list in prop::collection::vec(splats(), 1..6), width in 1u16..100, height in 1u16..40, boxed: bool) {
        let rules = Rules::GAUSSIAN_3D;
        let camera = view(0.1, 0.2, Projection::Perspective);
        let footprints: Vec<Footprint> = list.iter().filter_map(|s| setup(Standard24, &camera, &rules, s).ok()).collect();
        let traversal = if boxed { Traversal::Box } else { Traversal::Spans };
        let [whole, tiled] = [[SIZE; 2], [width, height]].map(|tile| draw(Standard24, &footprints, &rules, traversal, tile));
        prop_assert!(whole == tiled);
        let [whole, tiled] = [[SIZE; 2], [width, height]].map(|tile| draw(Lean18, &footprints, &rules, traversal, tile));
        prop_assert!(whole == tiled);
    }
}

/// A needle of 90 rows that is two pixels thin, found by the property above: its radial index is off by 137 units of
/// the mantissa, nearly all of it from the rows' drift.
#[test]
fn rows_of_a_tall_needle_drift() {
    let axis = |mantissa, exponent| Axis { mantissa, exponent };
    let soft = |mantissa, exponent| SoftFloat { mantissa, exponent };
    let splat = VolumeSplat {
        centre: [
            soft(-1_188_314_651, -30),
            soft(-1_102_606_122, -31),
            soft(-1_765_938_592, -30),
        ],
        axes: [
            axis([79_254_228, 1_040_098_995, -254_625_906], -28),
            axis([888_578_152, 0, 0], -42),
            axis([0, -210_716_405, -860_736_932], -42),
        ],
        weight: soft(1_724_905_841, -31),
        colour: Default::default(),
    };
    let yaw = 0.1925234291878995;
    check("deep32", Deep32, &splat, &Rules::GAUSSIAN_3D, yaw).unwrap();
}

/// Ordinary splats: `box` agrees with the naive loop as well (needles are its known weakness, reported and not tested
/// away).
#[test]
fn box_agrees_on_round_splats() {
    use fixed::types::U4F28;
    let rules = Rules::EWA;
    for i in 0..200 {
        let offset = f64::from(i) * 0.01 - 1.0;
        let axis = |k: usize| {
            let mut v = [0.01 * f64::from(i % 7); 3];
            v[k] = 0.3 + 0.001 * f64::from(i);
            splatline::splat::Axis::from_components(v.map(crate::common::scaled))
        };
        let splat = VolumeSplat {
            centre: [offset, offset * 0.7, 0.3].map(crate::common::scaled),
            axes: [axis(0), axis(1), axis(2)],
            weight: crate::common::scaled(0.3),
            colour: [U4F28::ONE; 3],
        };
        let footprint = setup(
            Standard24,
            &view(0.1, 0.2, Projection::Perspective),
            &rules,
            &splat,
        )
        .unwrap();
        for ((y, x), radial) in visited(BoxSpans::new(Standard24, &footprint, &SCREEN), &SCREEN) {
            let exact = naive(&footprint, Standard24.widths().subpixel, x, y);
            assert!(
                (radial - exact).abs() < 1e-4 * (1.0 + exact),
                "{x} {y}: {radial} {exact}"
            );
        }
    }
}
