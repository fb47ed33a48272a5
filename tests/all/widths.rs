//! Widths in constants and widths in fields are the same arithmetic: every packet and every pixel, bit for bit.

use crate::common::{SIZE, splats, view};
use proptest::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::{Coverage, Painter};
use splatline::footprint::Footprint;
use splatline::format::{
    Classic8, Deep32, Design, Lane, Lean18, Rounding, RuntimeWidths, Standard24, Traversal,
    WIDTH_RANGES, WidthError, Widths,
};
use splatline::kernel::{FootprintTable, entries, fill_gaussian};
use splatline::raster::Window;
use splatline::rules::{Compositing, Rules};
use splatline::setup::{Cull, setup};
use splatline::splat::VolumeSplat;
use splatline::target::Target;
use splatline::view::Projection;

type Outcome = (Vec<Result<Footprint, Cull>>, Vec<Pixel>, Coverage);

fn run<D: Design>(
    design: D,
    list: &[VolumeSplat],
    rules: &Rules,
    compositing: Compositing,
    traversal: Traversal,
) -> Outcome {
    let widths = design.widths();
    let camera = view(0.2, -0.1, Projection::Perspective);
    let footprints: Vec<_> = list
        .iter()
        .map(|splat| setup(design, &camera, rules, splat))
        .collect();
    let mut memory = vec![0; entries(&widths)];
    fill_gaussian(&mut memory, &widths, rules.table_range);
    let table = FootprintTable::new(&memory, &widths, rules.table_range).unwrap();
    let painter = Painter::new(design, rules, table, compositing, traversal);
    let mut pixels = vec![Pixel::clear(&widths); usize::from(SIZE) * usize::from(SIZE)];
    let window = Window {
        first: [0; 2],
        end: [SIZE; 2],
    };
    let mut target = Target::new(&mut pixels, window, SIZE.into()).unwrap();
    let mut coverage = Coverage::default();
    for footprint in footprints.iter().flatten() {
        coverage += painter.draw(footprint, &mut target);
    }
    (footprints, pixels, coverage)
}

fn check<D: Design>(
    design: D,
    list: &[VolumeSplat],
    rules: &Rules,
    compositing: Compositing,
) -> Result<(), TestCaseError> {
    let custom = RuntimeWidths::new(design.widths()).unwrap();
    for traversal in [Traversal::Box, Traversal::Spans] {
        let expected = run(design, list, rules, compositing, traversal);
        prop_assert!(
            expected == run(custom, list, rules, compositing, traversal),
            "{:?}",
            design.widths()
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn constants_and_fields_agree(list in prop::collection::vec(splats(), 1..8), ewa: bool, order in 0usize..3) {
        let rules = if ewa { Rules::EWA } else { Rules::GAUSSIAN_3D };
        let compositing = [Compositing::FrontToBack, Compositing::BackToFront, Compositing::XRay][order];
        check(Classic8, &list, &rules, compositing)?;
        check(Lean18, &list, &rules, compositing)?;
        check(Standard24, &list, &rules, compositing)?;
        check(Deep32, &list, &rules, compositing)?;
    }
}

fn refused<L: splatline::format::Lane>(widths: Widths) -> Option<(&'static str, u8, (u8, u8))> {
    let WidthError {
        field,
        value,
        range,
    } = RuntimeWidths::<L>::for_lanes(widths).err()?;
    Some((field, value, range))
}

/// Each by its name, with what is allowed beside the other widths.
#[test]
fn widths_that_the_arithmetic_cannot_have_are_refused() {
    for (place, (field, low, high)) in WIDTH_RANGES.into_iter().enumerate() {
        for value in [low - u8::from(low > 0), high + 1] {
            let mut numbers = Deep32::WIDTHS.numbers();
            numbers[place] = value;
            let beside = refused::<i64>(Widths::from_numbers(numbers, Rounding::Nearest));
            let expected = (value != low).then_some((field, value, (low, high)));
            assert_eq!(beside, expected);
        }
    }
    let short = |radial, table| Widths {
        radial,
        table,
        ..Standard24::WIDTHS
    };
    assert_eq!(refused::<i64>(short(9, 11)), None);
    assert_eq!(refused::<i64>(short(9, 12)), Some(("table", 12, (2, 11))));
    assert_eq!(refused::<i64>(short(12, 14)), None);
    let even = |accumulator| Widths {
        accumulator,
        ..Lean18::WIDTHS
    };
    assert_eq!(refused::<i64>(even(23)), None);
    assert_eq!(refused::<i64>(even(24)), Some(("accumulator", 24, (4, 23))));
    assert_eq!(refused::<i32>(short(28, 12)), Some(("radial", 28, (8, 27))));
    assert_eq!(refused::<i64>(short(28, 12)), None);
}

/// What other widths leave of a range is never more than the range itself, and exactly what the rules of the format
/// say.
#[test]
fn ranges_shrink_as_stated() {
    for (radial, accumulator) in (8..=44u8).flat_map(|r| (4..=27u8).map(move |a| (r, a))) {
        for rounding in [Rounding::Nearest, Rounding::NearestEven, Rounding::Truncate] {
            let widths = Widths {
                radial,
                accumulator,
                rounding,
                ..Standard24::WIDTHS
            };
            let single = rounding == Rounding::NearestEven;
            let left = if single {
                23u8.saturating_sub(accumulator)
            } else {
                4
            };
            assert_eq!(
                widths.colour_range(),
                left.min(4),
                "{accumulator} {rounding:?}"
            );
            for ((field, low, high), (_, first, most)) in
                widths.ranges().into_iter().zip(WIDTH_RANGES)
            {
                let expected = match field {
                    "table" => most.min(radial + 2),
                    "accumulator" if single => 23,
                    _ => most,
                };
                assert_eq!(
                    (low, high),
                    (first, expected),
                    "{field} beside {radial}, {rounding:?}"
                );
            }
        }
    }
    assert_eq!([-1, 0, 1].map(|lane: i32| lane.at_least_zero()), [0, 0, 1]);
    assert_eq!([-1, 0, 1].map(|lane: i64| lane.at_least_zero()), [0, 0, 1]);
}
