//! The 32-bit path of small processors against the kernel's own: every pixel word, bit for bit.

use crate::arbitrary::Source;
use crate::common::{SIZE, splats, view};
use proptest::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::{NarrowError, Painter, Painter32};
use splatline::footprint::Footprint;
use splatline::format::{
    Design, Lean18, Micro16, Rounding, RuntimeWidths, Standard24, Traversal, Widths,
};
use splatline::front::DisplayList;
use splatline::kernel::{
    FootprintTable, PackedError, PackedTable, Tabled, entries, fill_gaussian, pack,
};
use splatline::raster::Window;
use splatline::rules::{Compositing, Rules};
use splatline::setup::setup;
use splatline::splat::VolumeSplat;
use splatline::target::Target;
use splatline::view::Projection;
use splatline::{BoundedList, Renderer};

const RANGE: u8 = 4;

/// Three short products, a shift of 0 in the sums.
const FIRMWARE: Widths = Micro16::WIDTHS;

/// A coarse table without interpolation, truncated products, rounded sums.
const PLAIN: Widths = Widths {
    radial: 27,
    table: 9,
    interpolation: 0,
    weight: 13,
    peak: 15,
    mantissa: 13,
    accumulator: 16,
    rounding: Rounding::Truncate,
    ..FIRMWARE
};

/// Mantissas too long for 32-bit rows; short positions in a short table.
const LONG: Widths = Widths {
    mantissa: 18,
    subpixel: 18,
    radial: 27,
    table: 5,
    interpolation: 12,
    weight: 12,
    accumulator: 20,
    ..FIRMWARE
};

/// A design that exists for this test.
fn narrow(widths: Widths) -> RuntimeWidths<i32> {
    RuntimeWidths::for_lanes(widths).unwrap()
}

fn table<const N: usize>(widths: &Widths) -> (Vec<u32>, [u32; N]) {
    let mut memory = vec![0; entries(widths)];
    fill_gaussian(&mut memory, widths, RANGE);
    let packed = pack(&memory, widths, RANGE).unwrap();
    (memory, packed)
}

/// Draws into strips of eight rows, each with its own target.
fn in_strips(widths: &Widths, mut draw: impl FnMut(&mut Target)) -> Vec<Pixel> {
    const ROWS: u16 = 8;
    let mut pixels = vec![Pixel::clear(widths); usize::from(SIZE) * usize::from(SIZE)];
    let strips = pixels.chunks_mut(usize::from(ROWS * SIZE));
    for (strip, first) in strips.zip((0..SIZE).step_by(ROWS.into())) {
        let window = Window {
            first: [0, first],
            end: [SIZE, first + ROWS],
        };
        draw(&mut Target::new(strip, window, SIZE.into()).unwrap());
    }
    pixels
}

fn by_painter<D: Design>(
    design: D,
    rules: &Rules,
    memory: &[u32],
    list: &[Footprint],
) -> Vec<Pixel> {
    let widths = design.widths();
    let table = FootprintTable::new(memory, &widths, RANGE).unwrap();
    let order = Compositing::FrontToBack;
    let painter = Painter::new(design, rules, table, order, Traversal::Spans);
    in_strips(&widths, |target| {
        for footprint in list {
            painter.draw(footprint, target);
        }
    })
}

fn check<const N: usize>(
    widths: Widths,
    rules: &Rules,
    splats: &[VolumeSplat],
) -> Result<(), TestCaseError> {
    let camera = view(0.2, -0.1, Projection::Perspective);
    let design = narrow(widths);
    let list: Vec<_> = splats
        .iter()
        .filter_map(|splat| setup(design, &camera, rules, splat).ok())
        .collect();
    let (memory, words) = table::<N>(&widths);
    let packed = PackedTable::new(&words, &widths, RANGE).unwrap();
    let narrow = Painter32::new(design, rules, packed).unwrap();
    let got = in_strips(&widths, |target| {
        for footprint in &list {
            narrow.draw(footprint, target);
        }
    });
    let expected = by_painter(design, rules, &memory, &list);
    prop_assert!(got == expected, "another picture: {widths:?}");
    // 64-bit lanes take the 64-bit rows.
    let custom = RuntimeWidths::new(widths).unwrap();
    let wide = by_painter(custom, rules, &memory, &list);
    prop_assert!(expected == wide, "other rows: {widths:?}");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn the_narrow_painter_draws_the_same_picture(list in prop::collection::vec(splats(), 1..8), ewa: bool) {
        let rules = if ewa { Rules { table_range: RANGE, ..Rules::EWA } } else { Rules::GAUSSIAN_3D };
        check::<128>(FIRMWARE, &rules, &list)?;
        check::<512>(PLAIN, &rules, &list)?;
        check::<32>(LONG, &rules, &list)?;
        check::<1024>(Lean18::WIDTHS, &rules, &list)?;
    }

    /// What is written for a display is what its iterator gives, of colours up to 1 and beyond, and of designs that round their sums.
    #[test]
    fn display_words_are_written_as_they_are_read(
        list in prop::collection::vec(splats(), 1..16), beyond in prop_oneof![Just(0u32), Just(1), Just(1 << 12)], background: u16,
    ) {
        written_as_read(Micro16, &list, beyond, background)?;
        written_as_read(Lean18, &list, beyond, background)?;
        written_as_read(Standard24, &list, beyond, background)?;
    }
}

proptest! {
    /// Footprints that no setup made: nothing panics, loops or writes beside the target.
    #[test]
    fn any_footprint_is_drawn(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        let mut source = Source::new(&bytes);
        let (_, words) = table::<128>(&FIRMWARE);
        let packed = PackedTable::new(&words, &FIRMWARE, RANGE).unwrap();
        let design = narrow(FIRMWARE);
        let painter = Painter32::new(design, &Rules::GAUSSIAN_3D, packed).unwrap();
        in_strips(&FIRMWARE, |target| painter.draw(&source.footprint(), target));
    }
}

fn written_as_read<D: Tabled>(
    design: D,
    list: &[VolumeSplat],
    beyond: u32,
    background: u16,
) -> Result<(), TestCaseError> {
    let view = view(0.3, -0.2, Projection::Perspective);
    let most = (1 << design.widths().colour) + beyond;
    let mut footprints = BoundedList::<16>::new();
    for splat in list {
        if let Ok(mut footprint) = setup(design, &view, &Rules::GAUSSIAN_3D, splat) {
            footprint.colour = footprint.colour.map(|c| c.min(most));
            footprints.push(&footprint).unwrap();
        }
    }
    footprints.sort();
    let mut pixels = vec![Pixel::EMPTY; view.window().pixels()];
    let renderer = Renderer::new(design);
    let frame = renderer.draw(&footprints, view.window(), &mut pixels);
    let frame = frame.unwrap();
    let mut sent = vec![0; frame.pixels.len()];
    frame.write_rgb565(background, &mut sent);
    prop_assert_eq!(sent, frame.rgb565(background).collect::<Vec<u16>>());
    Ok(())
}

/// Every position of every interval, and the level before 0.
#[test]
fn packed_look_ups_equal_plain_ones() {
    fn check<const N: usize>(widths: Widths) {
        let (memory, words) = table::<N>(&widths);
        let packed = PackedTable::new(&words, &widths, RANGE).unwrap();
        let plain = FootprintTable::new(&memory, &widths, RANGE).unwrap();
        let lead = PackedTable::lead(&widths, RANGE);
        let at = |ahead| packed.weight(ahead, &widths, RANGE);
        // Cut-offs end at 15, one interval below the table's end.
        let end = 15u32 << widths.radial;
        for radial in (0..end).step_by(251).chain(end - 1000..end) {
            assert_eq!(at(radial + lead), plain.weight(radial.into()), "{radial}");
        }
        for ahead in (0..=lead).step_by(61).chain(lead - 1000..=lead) {
            assert_eq!(at(ahead), plain.weight(0), "{ahead}");
        }
    }
    check::<128>(FIRMWARE);
    check::<512>(PLAIN);
    check::<32>(LONG);
    check::<1024>(Lean18::WIDTHS);
}

#[test]
fn what_is_not_narrow_is_refused() {
    let (memory, words) = table::<128>(&FIRMWARE);
    let packed = PackedTable::new(&words, &FIRMWARE, RANGE).unwrap();
    let refused = |widths, range| pack::<128>(&memory, &widths, range).unwrap_err();
    let short = PackedTable::new(&words[1..], &FIRMWARE, RANGE);
    assert_eq!(short.unwrap_err(), PackedError::Intervals);
    assert_eq!(
        refused(
            Widths {
                table: 8,
                ..FIRMWARE
            },
            RANGE
        ),
        PackedError::Intervals
    );
    assert_eq!(refused(FIRMWARE, 2), PackedError::Alignment);
    let wide = Widths {
        radial: 28,
        ..FIRMWARE
    };
    assert_eq!(refused(wide, RANGE), PackedError::Alignment);
    let coarse = Widths {
        radial: 9,
        interpolation: 6,
        ..FIRMWARE
    };
    assert_eq!(refused(coarse, RANGE), PackedError::Noise);
    let noisy = Widths {
        mantissa: 10,
        ..FIRMWARE
    };
    assert_eq!(refused(noisy, RANGE), PackedError::Noise);
    let short = Widths {
        interpolation: 8,
        ..FIRMWARE
    };
    assert_eq!(refused(short, RANGE), PackedError::Room);
    let wide = narrow(Widths {
        peak: 24,
        ..FIRMWARE
    });
    let error = Painter32::new(wide, &Rules::GAUSSIAN_3D, packed).unwrap_err();
    assert_eq!(error, NarrowError::Products);
    let other = narrow(Widths {
        interpolation: 16,
        ..FIRMWARE
    });
    let error = Painter32::new(other, &Rules::GAUSSIAN_3D, packed).unwrap_err();
    assert_eq!(error, NarrowError::Table);
}
