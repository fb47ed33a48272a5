//! The 32-bit path of small processors against the kernel's own: every pixel word, bit for bit.

use crate::arbitrary::Source;
use crate::common::{SIZE, splats, view};
use proptest::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::{NarrowError, Painter, Painter32};
use splatline::footprint::{Footprint, Ldl};
use splatline::format::{
    Design, Lean18, Micro16, Rounding, RuntimeWidths, Standard24, Traversal, Widths,
};
use splatline::front::DisplayList;
use splatline::kernel::{
    FootprintTable, PackedError, PackedTable, Tabled, entries, fill_gaussian, pack,
};
use splatline::math::{SoftFloat, reciprocal};
use splatline::raster::Window;
use splatline::rules::{Compositing, Cutoff, Rules};
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

/// A footprint of this sharpness around the sample of column 9 and row 9, up to `cutoff`.
fn round(widths: &Widths, sharpness: SoftFloat, cutoff: u32, opacity: u32) -> Footprint {
    Footprint {
        centre: [19 << (widths.subpixel - 1); 2],
        first: [7; 2],
        end: [12; 2],
        ldl: Ldl {
            horizontal: sharpness,
            squared_width: reciprocal(sharpness, widths.mantissa.into()).unwrap(),
            shear: SoftFloat::ZERO,
            vertical: sharpness,
        },
        cutoff,
        opacity,
        colour: [1 << widths.colour, 1 << (widths.colour - 1), 7],
        ..Footprint::EMPTY
    }
}

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

    /// What is written for a display is what its iterator gives, of colours up to 1 and beyond, and of designs that
    /// round their sums.
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
/// Footprints that end at a pixel's own index, under usual rules, with a shorter table, and of opacities down to the
/// smallest.
#[test]
fn ends_and_smallest_opacities_are_the_same() {
    const USUAL: &Rules = &Rules::GAUSSIAN_3D;
    let all = Rules {
        alpha_min: 0,
        ..*USUAL
    };
    let short = Rules {
        cutoff: Cutoff::Radial(6 << 28),
        table_range: 3,
        ..all
    };
    // Opacities of one unit within the footprint.
    let coarse = Widths {
        alpha: 8,
        ..FIRMWARE
    };
    for rules in [USUAL, &all, &short] {
        ends::<128>(FIRMWARE, rules);
        ends::<128>(coarse, rules);
        ends::<512>(PLAIN, rules);
        ends::<32>(LONG, rules);
        ends::<1024>(Lean18::WIDTHS, rules);
    }
}

fn ends<const N: usize>(widths: Widths, rules: &Rules) {
    let design = narrow(widths);
    let range = rules.table_range;
    let mut memory = vec![0; entries(&widths)];
    fill_gaussian(&mut memory, &widths, range);
    let table = FootprintTable::new(&memory, &widths, range).unwrap();
    let Ok(words) = pack::<N>(&memory, &widths, range) else {
        return assert!(range < RANGE);
    };
    let packed = PackedTable::new(&words, &widths, range).unwrap();
    let short = Painter32::new(design, rules, packed).unwrap();
    let order = Compositing::FrontToBack;
    let wide = Painter::new(design, rules, table, order, Traversal::Spans);
    let bits = u32::from(widths.mantissa);
    let lead = u64::from(PackedTable::lead(&widths, range));
    let window = Window {
        first: [0; 2],
        end: [SIZE; 2],
    };
    for step in 0..1000 {
        // r is the sharpness a column from the middle.
        let sharpness = SoftFloat {
            mantissa: (1 << bits) - 1 - (step << (bits - 11)),
            exponent: 2 - bits as i32,
        };
        let own = (sharpness.mantissa as u64) << (30 - bits);
        let opacity = [1 << widths.peak, 3, 2 << widths.peak][step as usize % 3];
        for cutoff in [own, own - 1, rules.end().into()].map(|end| end as u32) {
            let footprint = round(&widths, sharpness, cutoff, opacity);
            let got = in_strips(&widths, |target| short.draw(&footprint, target));
            let expected = in_strips(&widths, |target| {
                wide.draw(&footprint, target);
            });
            assert!(got == expected, "{step} up to {cutoff}: {widths:?}");
        }
        // What no setup makes ends before the table does.
        for (cutoff, last) in [
            (u32::MAX, (1u64 << (widths.radial + range)) - 1),
            (1 << 28, (1 << widths.radial) - 1 + lead),
            (1 << (28 - widths.radial), lead),
        ] {
            let footprint = round(&widths, sharpness, cutoff, opacity);
            let mut pixels = [Pixel::EMPTY; (SIZE as usize).pow(2)];
            let mut target = Target::new(&mut pixels, window, SIZE.into()).unwrap();
            let mut runs = short.runs(&footprint, &window).unwrap();
            let run = runs.next_span().unwrap();
            let found = runs.with_pixels(run, &mut target).lanes.last;
            assert_eq!(found as u64, last);
        }
    }
}

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
    // The first of 512 intervals up to 4 is the level one.
    let mut memory = vec![0; entries(&PLAIN)];
    fill_gaussian(&mut memory, &PLAIN, 2);
    let words: [u32; 512] = pack(&memory, &PLAIN, 2).unwrap();
    let packed = PackedTable::new(&words, &PLAIN, 2).unwrap();
    let up_to = |cutoff| {
        let rules = Rules {
            cutoff: Cutoff::Radial(cutoff),
            ..Rules::EWA
        };
        Painter32::new(narrow(PLAIN), &rules, packed).err()
    };
    let most = (4 << 28) - (1 << 21);
    assert_eq!(up_to(most), None);
    assert_eq!(up_to(most + 2), Some(NarrowError::Table));
    assert_eq!(up_to(4 << 28), Some(NarrowError::Table));
}
