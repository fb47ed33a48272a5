//! Null pointers, wrong sizes and impossible choices are errors; any bits in the structs are drawn without a panic.

use proptest::prelude::*;
use splatline_capi::*;
use std::ptr::{null, null_mut};

const PIXELS: usize = 16 * 16;
const SPANS: u32 = SPLATLINE_TRAVERSAL_SPANS;
/// Entries of the table of `standard24`.
const TABLE_COUNT: usize = (1 << 12) + 1;

fn widths() -> SplatlineWidths {
    let mut widths = std::mem::MaybeUninit::uninit();
    // SAFETY: the pointer leads to memory for widths, which a successful call has written.
    unsafe {
        assert_eq!(
            splatline_design(SPLATLINE_STANDARD24, widths.as_mut_ptr()),
            SPLATLINE_OK
        );
        widths.assume_init()
    }
}

fn rules(name: u32) -> SplatlineRules {
    let mut rules = std::mem::MaybeUninit::uninit();
    // SAFETY: as above.
    unsafe {
        assert_eq!(splatline_rules(name, rules.as_mut_ptr()), SPLATLINE_OK);
        rules.assume_init()
    }
}

fn painter(table: &[u32]) -> SplatlinePainter {
    SplatlinePainter {
        widths: widths(),
        rules: rules(SPLATLINE_RULES_EWA),
        compositing: SPLATLINE_FRONT_TO_BACK,
        traversal: SPLATLINE_TRAVERSAL_SPANS,
        table: table.as_ptr(),
        table_count: table.len(),
    }
}

fn table() -> Vec<u32> {
    let mut table = vec![0; TABLE_COUNT];
    // SAFETY: pointer and length of one vector.
    let status = unsafe { splatline_table_gaussian(&widths(), 2, table.as_mut_ptr(), table.len()) };
    assert_eq!(status, SPLATLINE_OK);
    table
}

const WINDOW: SplatlineWindow = SplatlineWindow {
    first: [0; 2],
    end: [16; 2],
};

#[test]
fn null_is_an_error_everywhere() {
    let (w, r, mut fp) = (
        widths(),
        rules(SPLATLINE_RULES_EWA),
        SplatlineFootprint::default(),
    );
    let mut words = [0u32; SPLATLINE_LONGEST_PACKET];
    let mut run = SplatlineSpan::default();
    let table = table();
    let painter = painter(&table);
    // SAFETY: every pointer is null or leads to what its type says.
    let codes = unsafe {
        [
            splatline_design(0, null_mut()),
            splatline_design_check(null()),
            splatline_rules(0, null_mut()),
            splatline_table_entries(&w, null_mut()),
            splatline_table_gaussian(&w, 2, null_mut(), TABLE_COUNT),
            splatline_table_weight(&w, 2, null(), TABLE_COUNT, 0, &mut 0),
            splatline_setup(&w, null(), &r, null(), &mut fp),
            splatline_setup_many(&w, null(), &r, null(), 200, &mut fp, 200, null_mut(), 1),
            splatline_packet_words(null(), SPANS, &mut 0),
            splatline_packet_encode(&w, SPANS, null(), words.as_mut_ptr(), 16),
            splatline_packet_field(null(), SPANS, 0, null_mut()),
            splatline_packet_decode(null(), SPANS, words.as_ptr(), 16, &mut fp),
            splatline_spans_begin(&w, &fp, 0, &WINDOW, null_mut()),
            splatline_spans_next(null_mut(), &mut run),
            splatline_span_step(null_mut()),
            splatline_pixel_opacity(null(), &fp, &run, &mut 0),
            splatline_pixel_composite(&painter, 1, null(), null_mut()),
            splatline_clear(&w, null_mut(), 1),
            splatline_draw(&painter, &fp, &WINDOW, null_mut(), PIXELS, 16, null_mut()),
        ]
    };
    assert_eq!(codes, [SPLATLINE_ERROR_NULL; 19]);
}

#[test]
fn sizes_strides_and_choices_are_checked() {
    let (w, fp, table) = (widths(), SplatlineFootprint::default(), table());
    let mut pixels = [SplatlinePixel::default(); PIXELS];
    let mut words = [0u32; SPLATLINE_LONGEST_PACKET];
    let mut out = SplatlineFootprint::default();
    let mut draw = |painter: &SplatlinePainter, count: usize, stride: usize| {
        let (at, coverage) = (pixels.as_mut_ptr(), null_mut());
        // SAFETY: `count` is at most the number of pixels.
        unsafe { splatline_draw(painter, &fp, &WINDOW, at, count, stride, coverage) }
    };
    let good = painter(&table);
    assert_eq!(draw(&good, PIXELS, 16), SPLATLINE_OK);
    assert_eq!(draw(&good, PIXELS - 1, 16), SPLATLINE_ERROR_SIZE);
    assert_eq!(draw(&good, PIXELS, 17), SPLATLINE_ERROR_SIZE);
    assert_eq!(draw(&good, PIXELS, 15), SPLATLINE_ERROR_STRIDE);
    let short = draw(&painter(&table[1..]), PIXELS, 16);
    assert_eq!(short, SPLATLINE_ERROR_SIZE);
    let mut with = |change: fn(&mut SplatlinePainter)| {
        let mut painter = good;
        change(&mut painter);
        draw(&painter, PIXELS, 16)
    };
    assert_eq!(with(|p| p.traversal = 2), SPLATLINE_ERROR_VALUE);
    assert_eq!(with(|p| p.compositing = 3), SPLATLINE_ERROR_VALUE);
    assert_eq!(with(|p| p.widths.radial = 45), SPLATLINE_ERROR_WIDTHS);
    assert_eq!(with(|p| p.rules.table_range = 5), SPLATLINE_ERROR_VALUE);
    let wide = SplatlineWidths { radial: 45, ..w };
    let (mut needed, mut run) = (0, SplatlineSpan::default());
    words[0] = 15;
    let at = words.as_mut_ptr();
    // SAFETY: every pointer leads to at least as much as is said; zeros are rows that never were begun.
    let codes = unsafe {
        let mut never_begun: SplatlineSpans = std::mem::zeroed();
        [
            splatline_packet_words(&w, SPANS, &mut needed),
            splatline_packet_words(&w, 2, &mut 0),
            splatline_packet_encode(&w, SPANS, &fp, at, 3),
            splatline_packet_decode(&w, SPANS, at, needed, &mut out),
            splatline_design(5, &mut widths()),
            splatline_design_check(&wide),
            splatline_spans_next(&mut never_begun, &mut run),
            splatline_table_gaussian(&w, 2, at.byte_add(1), TABLE_COUNT),
        ]
    };
    let expected = [
        SPLATLINE_OK,
        SPLATLINE_ERROR_VALUE,
        SPLATLINE_ERROR_SIZE,
        SPLATLINE_ERROR_PACKET_VERSION,
        SPLATLINE_ERROR_VALUE,
        SPLATLINE_ERROR_WIDTHS,
        SPLATLINE_ERROR_STATE,
        SPLATLINE_ERROR_ALIGNMENT,
    ];
    assert_eq!(codes, expected);
    let (splats, reasons) = (null(), null_mut());
    // SAFETY: there are no splats.
    let many = unsafe {
        let (widths, view, rules) = (null(), null(), null());
        splatline_setup_many(widths, view, rules, splats, 4, null_mut(), 4, reasons, 0)
    };
    assert_eq!(many, SPLATLINE_ERROR_STRIDE);
}

/// A list without a word for the viewport has no room, even for no splats: it cannot be drawn.
#[test]
fn an_empty_scene_needs_a_word_as_well() {
    let numbers = [[0.0, 0.0, -4.0], [0.0; 3], [0.0, -1.0, 0.0f32]];
    let [eye, target, up] = numbers.each_ref().map(|vector| vector.as_ptr());
    let (mut list, mut needed, mut view) = ([0u32], 0, std::mem::MaybeUninit::uninit());
    // SAFETY: pointers lead to as much as is said.
    let mut set_up = |count| unsafe {
        let seen = splatline_look_at(eye, target, up, 40.0, 8, 8, view.as_mut_ptr());
        assert_eq!(seen, SPLATLINE_OK);
        let (view, words) = (view.as_ptr(), list.as_mut_ptr());
        splatline_set_up_scene(view, null(), 0, words, count, &mut needed)
    };
    assert_eq!(set_up(0), SPLATLINE_ERROR_SIZE);
    assert_eq!(set_up(1), 0);
    assert_eq!(needed, 1);
    let window = SplatlineWindow {
        first: [0; 2],
        end: [8; 2],
    };
    let (mut pixels, mut sent) = ([SplatlinePixel::default(); 64], [0u16; 64]);
    // SAFETY: as above.
    let drawn = unsafe {
        let (words, to) = (list.as_mut_ptr(), sent.as_mut_ptr());
        splatline_draw_rgb565(words, 1, 0, &window, 7, pixels.as_mut_ptr(), to, 64)
    };
    assert_eq!((drawn, sent), (SPLATLINE_OK, [7; 64]));
}

#[test]
fn every_code_has_a_text() {
    for code in -9..=6 {
        // SAFETY: the text is static and ends with a zero.
        let text = unsafe { std::ffi::CStr::from_ptr(splatline_error_text(code)) };
        assert_eq!(text.to_str().unwrap() == "no error", code >= 0);
        assert_eq!(text.to_str().unwrap() == "unknown error", code == -9);
    }
}

/// Fields of the packet are found by name and lie side by side.
#[test]
fn the_layout_is_described() {
    let mut end = 0;
    for index in 0..SPLATLINE_PACKET_FIELDS {
        // SAFETY: all integers, so zeros are valid.
        let mut field: SplatlineField = unsafe { std::mem::zeroed() };
        // SAFETY: pointers lead to what their types say.
        let status = unsafe { splatline_packet_field(&widths(), SPANS, index, &mut field) };
        assert_eq!((status, field.offset), (SPLATLINE_OK, end));
        end += u16::from(field.width);
    }
}

fn number() -> impl Strategy<Value = SplatlineSoftFloat> {
    (any::<i32>(), prop_oneof![any::<i32>(), -60..60i32])
        .prop_map(|(mantissa, exponent)| SplatlineSoftFloat { mantissa, exponent })
}

prop_compose! {
    fn footprint()(
        centre in prop::array::uniform2(prop_oneof![any::<i64>(), -(1i64 << 26)..1 << 26]),
        depth: u64, first in prop::array::uniform2(0u16..20), last in prop::array::uniform2(prop_oneof![any::<u16>(), 0u16..20]),
        ldl in [number(), number(), number(), number()],
        conic_mantissa: [i32; 3], conic_exponent: i32, cutoff: u32, peak: u32, colour: [u32; 3],
    ) -> SplatlineFootprint {
        let [horizontal, squared_width, shear, vertical] = ldl;
        SplatlineFootprint {
            centre, depth, first, end: last, horizontal, squared_width, shear, vertical,
            conic_mantissa, conic_exponent, cutoff, opacity: peak, colour,
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn any_footprint_is_drawn_without_a_panic(
        footprint in footprint(), traversal in 0u32..2, compositing in 0u32..3, rules_name in 0u32..2,
    ) {
        let mut table = vec![0; TABLE_COUNT];
        let mut pixels = [SplatlinePixel { colour: [7; 3], transmittance: 1 << 30 }; PIXELS];
        // SAFETY: pointers and counts belong together.
        unsafe {
            splatline_table_gaussian(&widths(), rules(rules_name).table_range, table.as_mut_ptr(), table.len());
            let painter = SplatlinePainter { rules: rules(rules_name), traversal, compositing, ..painter(&table) };
            let status = splatline_draw(&painter, &footprint, &WINDOW, pixels.as_mut_ptr(), PIXELS, 16, null_mut());
            prop_assert_eq!(status, SPLATLINE_OK);
        }
    }
}
