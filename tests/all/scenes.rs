//! Scenes that are converted once, packed lists, and parts of a picture, from the front door.

use super::front::camera;
use crate::arbitrary::Source;
use crate::common::SIZE;
use fixed::types::{I2F30, U4F28};
use proptest::prelude::*;
use splatline::Gaussian;
use splatline::blend::Pixel;
use splatline::footprint::{Footprint, Ldl};
use splatline::format::{Deep32, Lean18, Micro16, RuntimeWidths, Standard24, Traversal};
use splatline::front::{
    COMPACT_HEADER, COMPACT_MAGIC, CompactScene, PackedList, Renderer, Scene, SceneFull, Splats,
    packed_words,
};
use splatline::kernel::{Tabled, entries};
use splatline::math::{Extended, SoftFloat};
use splatline::raster::Window;
use splatline::rules::{Compositing, Rules};
use splatline::setup::{Cull, setup_for_spans};
use splatline::splat::Position;
use splatline::splat::VolumeSplat;
use splatline::view::{Eye, Projection, View};
use splatline::{BoundedList, DisplayList};
use std::cell::Cell;
use std::collections::HashSet;

const PIXELS: usize = SIZE as usize * SIZE as usize;

/// Splats in a row from the eye: all visible but those out of sight.
fn row_of(visible: usize, hidden: usize) -> Vec<VolumeSplat> {
    let at = |mean| Gaussian {
        mean,
        scales: [0.1; 3],
        ..Gaussian::UNIT
    };
    let seen = (0..visible).map(|i| at([0.0, 0.0, i as f32]));
    let unseen = (0..hidden).map(|i| at([90.0, 0.0, 10.0 + i as f32]));
    seen.chain(unseen)
        .map(|gaussian| gaussian.splat().unwrap())
        .collect()
}

/// A scene's list, for which the words have room, and its renderer.
fn set_up<'w, D: Tabled>(
    design: D,
    view: &View,
    scene: &[VolumeSplat],
    words: &'w mut [u32],
) -> (Renderer<'static, D>, PackedList<'w, D>) {
    let mut list = PackedList::new(design, words);
    let renderer = Renderer::new(design);
    renderer.set_up_scene(view, scene, &mut list).unwrap();
    (renderer, list)
}

/// The memory that the error asks for suffices, and one footprint less does not, however many splats need a key and no
/// place.
#[test]
fn a_packed_list_that_is_full_says_how_much_it_lacks() {
    let view = camera().view().unwrap();
    let renderer = Renderer::new(Micro16);
    let entry = packed_words(&Micro16::WIDTHS);
    for (visible, hidden) in [(5, 0), (5, 3), (5, 40), (0, 40), (40, 5)] {
        let scene = row_of(visible, hidden);
        let set_up = |capacity: usize| {
            let mut words = vec![0; capacity * entry];
            let mut list = PackedList::new(Micro16, &mut words);
            assert_eq!(list.capacity(), capacity);
            let counts = renderer.set_up_scene(&view, scene.as_slice(), &mut list);
            assert_eq!(list.is_empty(), counts.is_err() || visible == 0);
            counts
        };
        let mut capacity = 0;
        while let Err(full) = set_up(capacity) {
            assert_eq!(full.capacity, capacity);
            assert!(full.needed > capacity, "{full}");
            capacity = full.needed;
        }
        assert!(capacity >= visible);
        assert!(set_up(capacity.saturating_sub(1)).is_err());
        assert_eq!(
            set_up(capacity).map(|counts| counts.drawn),
            Ok(visible as u32)
        );
    }
}

#[test]
fn a_scene_is_converted_once() {
    let gaussians = [
        Gaussian::UNIT,
        Gaussian {
            opacity: f32::NAN,
            ..Gaussian::UNIT
        },
        Gaussian {
            mean: [1.0, 0.0, 0.0],
            ..Gaussian::UNIT
        },
    ];
    let mut memory = [VolumeSplat::EMPTY; 2];
    let scene = Scene::collect(&mut memory, gaussians.iter().map(Gaussian::splat)).unwrap();
    assert_eq!(
        (scene.len(), scene.invalid(), scene.is_empty()),
        (2, 1, false)
    );
    assert_eq!(scene.splat(1), gaussians[2].splat());
    assert_eq!(scene.centre(1), scene.splat(1).map(|splat| splat.centre));
    assert_eq!((scene.splat(2), scene.centre(2)), (None, None));
    let none = Scene::collect(&mut [], [None]).unwrap();
    assert_eq!((none.is_empty(), none.len(), none.invalid()), (true, 0, 1));
    let one = Scene::collect(&mut memory, gaussians[..1].iter().map(Gaussian::splat)).unwrap();
    assert_eq!((one.is_empty(), one.invalid()), (false, 0));
    let short = Scene::collect(&mut memory[..1], gaussians.iter().map(Gaussian::splat));
    assert_eq!(
        short.unwrap_err(),
        SceneFull {
            capacity: 1,
            needed: 2
        }
    );
}

/// Splats next to each other in depth, and far apart, come in the order of a list that is sorted by footprints.
#[test]
fn keys_sort_as_footprints_do() {
    let at = |number: usize| Gaussian {
        mean: [
            number as f32 * 0.01 - 0.2,
            0.0,
            ((number * 29) % 41) as f32 * (2.0f32).powi(number as i32 % 3 * 10 - 26),
        ],
        scales: [0.01; 3],
        ..Gaussian::UNIT
    };
    let scene: Vec<VolumeSplat> = (0..41).map(|number| at(number).splat().unwrap()).collect();
    let (view, renderer) = (camera().view().unwrap(), Renderer::new(Deep32));
    let mut words = vec![0; 60 * packed_words(&Deep32::WIDTHS)];
    let mut packed = PackedList::new(Deep32, &mut words);
    let mut list = BoundedList::<41>::new();
    renderer
        .set_up_scene(&view, scene.as_slice(), &mut packed)
        .unwrap();
    renderer
        .set_up(&view, scene.iter().copied(), &mut list)
        .unwrap();
    let keys: HashSet<u64> = list.footprints().iter().map(|f| f.depth & 0xffff).collect();
    assert!(keys.len() > 10, "low bits of depths differ");
    for (place, footprint) in list.in_order(Compositing::FrontToBack).enumerate() {
        assert_eq!(packed.footprint(place).unwrap().centre, footprint.centre);
    }
}

/// Keys that differ in their last bit alone, the nearest splat last in the scene; and a splat behind the eye of a
/// parallel projection.
#[test]
fn keys_keep_their_first_and_last_bits() {
    let mut view = camera().view().unwrap();
    view.rotation[2][0] = I2F30::from_bits(1);
    let at = |x: f32, z: f32| Gaussian {
        mean: [x, 0.0, z],
        scales: [0.01; 3],
        ..Gaussian::UNIT
    };
    let renderer = Renderer::new(Deep32);
    let drawn = |view: &View, scene: &[VolumeSplat]| -> Vec<i64> {
        let mut words = vec![0; 60 * packed_words(&Deep32::WIDTHS)];
        let mut packed = PackedList::new(Deep32, &mut words);
        renderer.set_up_scene(view, scene, &mut packed).unwrap();
        (0..packed.len())
            .map(|place| packed.footprint(place).unwrap().centre[0])
            .collect()
    };
    let beside: Vec<VolumeSplat> = (0..40)
        .rev()
        .map(|k| at(k as f32 / 64.0, 0.0).splat().unwrap())
        .collect();
    let columns = drawn(&view, &beside);
    assert_eq!(columns.len(), 40);
    assert!(columns.is_sorted(), "{columns:?}");
    view.projection = Projection::Orthographic;
    view.near = Extended {
        value: -64,
        exponent: 0,
    };
    let around = [at(0.1, 1.0), at(-0.1, -9.0)].map(|gaussian| gaussian.splat().unwrap());
    let columns = drawn(&view, &around);
    assert!(columns.len() == 2 && columns.is_sorted(), "{columns:?}");
}

/// Memory for a key and no footprint.
#[test]
fn a_list_without_a_place_asks_for_one() {
    let (view, renderer) = (camera().view().unwrap(), Renderer::new(Micro16));
    let mut words = [0; 4];
    let mut list = PackedList::new(Micro16, &mut words);
    let full = renderer.set_up_scene(&view, row_of(1, 0).as_slice(), &mut list);
    assert_eq!((full.unwrap_err().needed, list.len()), (1, 0));
}

/// Colours above 1 saturate in words of 16 bits, by every pixel loop.
#[test]
fn bright_colours_saturate() {
    let view = camera().view().unwrap();
    let mut scene = row_of(3, 0);
    for (splat, brightness) in scene.iter_mut().zip([3, 9, 15]) {
        splat.colour = [fixed::types::U4F28::from_num(brightness); 3];
    }
    fn check<D: Tabled>(design: D, view: &View, scene: &[VolumeSplat]) {
        let mut words = vec![0; 4 * packed_words(&D::WIDTHS)];
        let mut list = PackedList::new(design, &mut words);
        let renderer = Renderer::new(design);
        renderer.set_up_scene(view, scene, &mut list).unwrap();
        let (mut pixels, mut sent) = ([Pixel::EMPTY; PIXELS], [0; PIXELS]);
        let frame = renderer.draw(&list, view.window(), &mut pixels).unwrap();
        frame.write_rgb565(0x1234, &mut sent);
        assert!(frame.rgb565(0x1234).eq(sent));
        assert!(sent.contains(&0xffff));
    }
    check(Micro16, &view, &scene);
    check(Standard24, &view, &scene);
}

/// A scene of whose two splats one has no centre and one no numbers: both count, neither is drawn; a list that is full
/// is empty afterwards.
#[test]
fn splats_that_are_none_are_counted() {
    struct Without(Vec<VolumeSplat>);
    impl Splats<Eye> for Without {
        fn len(&self) -> usize {
            self.0.len() + 2
        }
        fn centre(&self, number: usize) -> Option<Position> {
            (number > 0).then_some(self.0[0].centre)
        }
        fn splat(&self, number: usize) -> Option<VolumeSplat> {
            self.0.get(number.checked_sub(2)?).copied()
        }
    }
    let (view, renderer) = (camera().view().unwrap(), Renderer::new(Micro16));
    let mut words = vec![0; 4 * packed_words(&Micro16::WIDTHS)];
    let mut list = PackedList::new(Micro16, &mut words);
    let scene = Without(row_of(1, 0));
    for _ in 0..2 {
        let counts = renderer.set_up_scene(&view, &scene, &mut list).unwrap();
        assert_eq!((counts.drawn, counts.invalid, list.len()), (1, 2, 1));
    }
    let many = row_of(9, 0);
    let full = renderer.set_up_scene(&view, many.as_slice(), &mut list);
    assert_eq!(full.unwrap_err().capacity, 4);
    assert!(list.is_empty() && list.footprint(0).is_none());
}

/// Numbers of a compact splat, read by hand from the table of its bytes.
#[test]
fn a_compact_splat_is_what_its_bytes_say() {
    let mut bytes = Vec::from(COMPACT_MAGIC);
    for word in [1000, -2000, 0, -10, -20, 1 << 20, 1] {
        bytes.extend_from_slice(&i32::to_le_bytes(word));
    }
    assert_eq!(bytes.len(), COMPACT_HEADER);
    for number in [24i16, -48, 32_767, 16_384, -8_192, 5, 20_000, 1, 32_767] {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
    bytes.extend_from_slice(&(3u16 | 31 << 5 | 7 << 10).to_le_bytes());
    bytes.extend_from_slice(&[0, 1, 255, 51]);
    let scene = CompactScene::read(&bytes).unwrap();
    let splat = scene.splat(0).unwrap();
    let value = |mantissa: i32, exponent: i32| f64::from(mantissa) * f64::from(exponent).exp2();
    let centre = splat.centre.map(|c| value(c.mantissa, c.exponent) * 1024.0);
    assert_eq!(centre, [1024.0, -2048.0, 32_767.0]);
    let axes = splat
        .axes
        .map(|axis| axis.mantissa.map(|m| value(m, axis.exponent + 20)));
    let [first, second, third] = [3, 31, 7].map(|e: i32| f64::from(e).exp2());
    assert_eq!(axes[0], [16_384.0 * first, -8_192.0 * first, 5.0 * first]);
    assert_eq!(axes[1], [0.0, 20_000.0 * second, second]);
    assert_eq!(axes[2], [0.0, 0.0, 32_767.0 * third]);
    let opacity = value(splat.weight.mantissa, splat.weight.exponent);
    assert!((opacity - 0.2).abs() < 1e-7, "{opacity}");
    assert_eq!(splat.colour.map(|c| c.to_bits()), [0, 1 << 20, 255 << 20]);
    assert_eq!(
        splat.weight,
        SoftFloat::from_wide(51 * 0x0080_8080, -31, 31)
    );
    assert_eq!((scene.len(), scene.is_empty()), (1, false));
    assert_eq!((scene.splat(1), scene.centre(1)), (None, None));
    let mut whole = [bytes.as_slice(), &bytes[COMPACT_HEADER..]].concat();
    whole[COMPACT_HEADER - 4] = 2;
    assert_eq!(CompactScene::read(&whole).map(|scene| scene.len()), Some(2));
    let trailing = [bytes.as_slice(), &[0]].concat();
    let two = [bytes.as_slice(), &bytes[COMPACT_HEADER..]].concat();
    for damaged in [
        &bytes[1..],
        &bytes[..bytes.len() - 1],
        &bytes[..20],
        &[],
        &trailing,
        &two,
    ] {
        assert_eq!(CompactScene::read(damaged), None);
    }
}

/// A pixel loop of the caller's gets every run, and what it does is what is drawn; a design of wider words has none.
#[test]
fn a_callers_pixel_loop_draws_the_picture() {
    let (view, scene) = (camera().view().unwrap(), row_of(4, 0));
    let runs = Cell::new(0);
    let mut words = vec![0; 4 * packed_words(&Micro16::WIDTHS)];
    let (renderer, list) = set_up(Micro16, &view, &scene, &mut words);
    let [mut own, mut theirs, mut none] = [[Pixel::EMPTY; PIXELS]; 3];
    let own = renderer.draw(&list, view.window(), &mut own).unwrap();
    let theirs = renderer.draw_with(&list, view.window(), &mut theirs, |painter, run| {
        runs.set(runs.get() + 1);
        painter.paint(run);
    });
    assert_eq!(own.pixels, theirs.unwrap().pixels);
    let rows = list.footprint(0).unwrap();
    assert!(
        runs.get() >= Window::of(&rows).rows(),
        "{} runs",
        runs.get()
    );
    let none = renderer.draw_with(&list, view.window(), &mut none, |_, _| ());
    assert!(
        none.unwrap()
            .pixels
            .iter()
            .all(|pixel| pixel.colour == [0; 3])
    );

    let mut words = vec![0; 4 * packed_words(&Standard24::WIDTHS)];
    let (renderer, list) = set_up(Standard24, &view, &scene, &mut words);
    let mut wide = [Pixel::EMPTY; PIXELS];
    let wide = renderer.draw_with(&list, view.window(), &mut wide, |_, _| panic!("no run"));
    assert!(
        wide.unwrap()
            .coverage
            .is_some_and(|coverage| coverage.covered > 0)
    );
}

/// A rectangle drawn anew has the pixels of the whole picture.
#[test]
fn a_part_of_the_picture_can_be_drawn_alone() {
    let view = camera().view().unwrap();
    let renderer = Renderer::new(Micro16);
    let scene = row_of(4, 0);
    let mut words = vec![0; 4 * packed_words(&Micro16::WIDTHS)];
    let mut list = PackedList::new(Micro16, &mut words);
    renderer
        .set_up_scene(&view, scene.as_slice(), &mut list)
        .unwrap();
    let (mut whole, mut part) = ([Pixel::EMPTY; PIXELS], [Pixel::EMPTY; PIXELS]);
    let whole = renderer.draw(&list, view.window(), &mut whole).unwrap();
    let changed = list
        .footprint(0)
        .map(|footprint| Window::of(&footprint))
        .unwrap();
    let part = renderer.draw(&list, changed, &mut part).unwrap();
    for (x, y) in (0..SIZE).flat_map(|x| (0..SIZE).map(move |y| (x, y))) {
        let pixel = part.pixel(x, y);
        assert!(pixel.is_none() || pixel == whole.pixel(x, y), "{x} {y}");
    }
    assert_eq!(part.pixels.len(), changed.pixels());
}

/// A display gets white where light of a design with wide words exceeds it.
#[test]
fn wide_words_saturate() {
    let (view, mut scene) = (camera().view().unwrap(), row_of(4, 0));
    for splat in &mut scene {
        splat.colour = [U4F28::from_num(7), U4F28::from_num(3), U4F28::ONE];
    }
    let renderer = Renderer::new(Lean18).with_traversal(Traversal::Box);
    let mut list = BoundedList::<4>::new();
    renderer.set_up(&view, &scene, &mut list).unwrap();
    let mut pixels = [Pixel::EMPTY; PIXELS];
    let frame = renderer.draw(&list, view.window(), &mut pixels).unwrap();
    let mut sent = [0; PIXELS];
    frame.write_rgb565(0, &mut sent);
    assert!(sent.iter().copied().eq(frame.rgb565(0)));
    assert!(sent.iter().any(|word| word >> 5 == 0x7ff));
}

/// Depths before and behind the eye of a parallel view are sorted as numbers.
#[test]
fn negative_depths_come_first() {
    let mut view = camera().view().unwrap();
    view.projection = Projection::Orthographic;
    view.near = Extended {
        value: -1000,
        exponent: 0,
    };
    let splat = |(z, red)| {
        let gaussian = Gaussian {
            mean: [0.0, 0.0, z],
            ..Gaussian::UNIT
        };
        VolumeSplat {
            colour: [U4F28::from_num(red), U4F28::ZERO, U4F28::ZERO],
            ..gaussian.splat().unwrap()
        }
    };
    let scene = [(2.0, 4), (-5.0, 1), (0.25, 3), (-3.5, 2)].map(splat);
    let mut words = vec![0; 4 * packed_words(&Standard24::WIDTHS)];
    let (_, list) = set_up(Standard24, &view, &scene, &mut words);
    let reds = [0, 1, 2, 3].map(|place| list.footprint(place).unwrap().colour[0]);
    assert_eq!(
        reds,
        [1, 2, 3, 4].map(|red| red << Standard24::WIDTHS.colour)
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]
    /// What setup makes of any splat for any design comes back from a packed list field by field, but for a shear that
    /// moves no pixel. Only what no low-pass filter has widened can be too thin for it.
    #[test]
    fn packed_footprints_are_those_of_setup(bytes in prop::collection::vec(any::<u8>(), 500), seen: bool, thin in 0i32..700) {
        let mut source = Source::new(&bytes);
        let widths = if seen { Micro16::WIDTHS } else { source.widths() };
        let design = RuntimeWidths::new(widths).unwrap();
        let mut view = source.sound_view();
        view.viewport = [1 + source.u16() / 2, 1 + source.u16() / 2];
        let mut rules = source.rules();
        rules.low_pass.mantissa = rules.low_pass.mantissa.saturating_abs();
        let mut splat = source.visible_splat();
        let filtered = rules == Rules::EWA || rules == Rules::GAUSSIAN_3D;
        if !filtered {
            splat.axes.iter_mut().for_each(|axis| axis.exponent -= thin);
        }
        let table = vec![0; entries(&widths)];
        let renderer = Renderer::with_table(design, rules, &table).unwrap();
        let mut words = vec![u32::MAX; packed_words(&widths)];
        let mut list = PackedList::new(design, &mut words);
        let counts = renderer.set_up_scene(&view, [splat].as_slice(), &mut list).unwrap();
        let expected = setup_for_spans(design, &view, &rules, &splat).map(|mut footprint| {
            let leading = footprint.ldl.shear.exponent + i32::from(widths.mantissa) - 1;
            if leading < -128 {
                (footprint.ldl.shear.mantissa, footprint.ldl.shear.exponent) = (0, 0);
            }
            Footprint { depth: 0, ..footprint }
        });
        match (expected, list.footprint(0)) {
            (Ok(expected), Some(packed)) => prop_assert_eq!(packed, expected),
            (Ok(expected), None) => {
                let thinnest = 129 - i32::from(widths.mantissa);
                let far = expected.centre.iter().any(|centre| *centre == 1 << (26 + widths.subpixel));
                let Ldl { horizontal, vertical, .. } = expected.ldl;
                prop_assert!(far || !filtered && horizontal.exponent.max(vertical.exponent) >= thinnest);
                prop_assert_eq!(counts.culled_for(Cull::Range), 1);
            }
            (Err(reason), packed) => {
                prop_assert_eq!(packed, None);
                prop_assert_eq!(counts.culled_for(reason), 1);
            }
        }
    }
}

/// A splat thinner than an entry has bits for is counted as out of range.
#[test]
fn what_no_entry_holds_is_culled() {
    let view = camera().view().unwrap();
    let rules = Rules {
        low_pass: SoftFloat::ZERO,
        ..Rules::GAUSSIAN_3D
    };
    let thin = Gaussian {
        scales: [1e-24, 0.5, 1e-24],
        rotation: [0.9, 0.0, 0.0, 0.4],
        ..Gaussian::UNIT
    };
    let scene = [thin.splat().unwrap()];
    let mut words = vec![0; 4 * packed_words(&Micro16::WIDTHS)];
    let mut list = PackedList::new(Micro16, &mut words);
    let renderer = Renderer::with_rules(Micro16, rules).unwrap();
    let counts = renderer
        .set_up_scene(&view, scene.as_slice(), &mut list)
        .unwrap();
    assert_eq!((counts.drawn, counts.culled_for(Cull::Range)), (0, 1));
}
