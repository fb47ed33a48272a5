//! Bit-exact snapshots that a reviewer can read: a packet field by field, small pictures as characters.
//!
//! They pin the arithmetic: a change of any bit shows here, and must be meant.

use crate::common::{scaled, view};
use fixed::types::U4F28;
use proptest::prelude::*;
use splatline::blend::Pixel;
use splatline::draw::Painter;
use splatline::footprint::packet::{Layout, VersionError};
use splatline::footprint::{Footprint, Ldl};
use splatline::format::{Classic8, Deep32, Design, Lean18, Micro16, Standard24, Traversal};
use splatline::kernel::{
    FootprintTable, Kernel, PERSPECTIVE_ENTRIES, entries, fill, fill_gaussian, fill_perspective,
};
use splatline::math::SoftFloat;
use splatline::raster::{Stamp, StampShape, Window, fill_stamps};
use splatline::rules::{Compositing, Rules};
use splatline::setup::setup;
use splatline::splat::{Axis, VolumeSplat};
use splatline::target::Target;
use splatline::view::{Projection, View};
use std::fmt::Write;

/// A tilted ellipse a little right of the middle.
fn leaf() -> VolumeSplat {
    let axis = |v: [f64; 3]| Axis::from_components(v.map(scaled));
    VolumeSplat {
        centre: [0.0625, 0.125, 0.0].map(scaled),
        axes: [
            axis([0.125, 0.0625, 0.0]),
            axis([-0.015625, 0.03125, 0.0]),
            axis([0.0, 0.0, 0.0625]),
        ],
        weight: scaled(0.75),
        colour: [1.0, 0.5, 0.25].map(U4F28::from_num),
    }
}

fn small_view() -> View {
    View {
        principal: [12, 9].map(fixed::types::I32F32::from_num),
        viewport: [28, 20],
        ..view(0.0, 0.0, Projection::Perspective)
    }
}

fn field_table<D: Design>(design: D, traversal: Traversal) -> String {
    let footprint = setup(design, &small_view(), &Rules::GAUSSIAN_3D, &leaf()).unwrap();
    let layout = Layout::with_depth(&design.widths(), traversal);
    let packet = layout.encode(&footprint);
    assert_eq!(layout.words(), layout.bits().div_ceil(32));
    let mut text = String::new();
    for field in layout.fields().iter().filter(|field| field.width > 0) {
        let value: u64 = (0..field.width)
            .map(|bit| {
                let at = usize::from(field.offset) + usize::from(bit);
                u64::from(packet[at / 32] >> (at % 32) & 1) << bit
            })
            .sum();
        writeln!(
            text,
            "{:22} bit {:3}, {:2} wide, {}.{}: {value:x}",
            field.name,
            field.offset,
            field.width,
            if field.signed { "s" } else { "u" },
            field.fraction
        )
        .unwrap();
    }
    text
}

/// Transmittance of each pixel in eighths: '.' is untouched, '1' to '8' the share of light taken away.
fn picture<D: Design>(design: D, traversal: Traversal, compositing: Compositing) -> String {
    let widths = design.widths();
    let rules = Rules::GAUSSIAN_3D;
    let footprint = setup(design, &small_view(), &rules, &leaf()).unwrap();
    let mut memory = vec![0; entries(&widths)];
    fill_gaussian(&mut memory, &widths, rules.table_range);
    let table = FootprintTable::new(&memory, &widths, rules.table_range).unwrap();
    let mut pixels = [Pixel::clear(&widths); 28 * 20];
    let window = Window {
        first: [0; 2],
        end: [28, 20],
    };
    let mut target = Target::new(&mut pixels, window, 28).unwrap();
    Painter::new(design, &rules, table, compositing, traversal).draw(&footprint, &mut target);
    let shade = |pixel: &Pixel| {
        let opaque = 1u64 << widths.transmittance;
        let taken = opaque - u64::from(pixel.transmittance());
        if taken == 0 {
            '.'
        } else {
            char::from(b'1' + (taken * 8 / opaque) as u8)
        }
    };
    pixels
        .chunks(28)
        .map(|row| row.iter().map(shade).collect::<String>() + "\n")
        .collect()
}

const PICTURE: &str = "\
............................
............................
......1111111...............
......111111111.............
.......1112222111...........
........11134442111.........
.........112356642111.......
..........111356653111......
............11235543111.....
.............11123332111....
...............1111211111...
.................11111111...
....................11111...
............................
............................
............................
............................
............................
............................
............................
";

#[test]
fn the_leaf_looks_like_this() {
    for traversal in [Traversal::Spans, Traversal::Box] {
        for compositing in [
            Compositing::FrontToBack,
            Compositing::BackToFront,
            Compositing::XRay,
        ] {
            let got = picture(Standard24, traversal, compositing);
            assert!(got == PICTURE, "{traversal:?} {compositing:?}\n{got}");
        }
    }
    assert_eq!(
        picture(Lean18, Traversal::Spans, Compositing::FrontToBack),
        PICTURE
    );
    assert_eq!(
        picture(Deep32, Traversal::Spans, Compositing::FrontToBack),
        PICTURE
    );
}

const STANDARD24: &str = "\
version                bit   0,  4 wide, u.0: 3
depth                  bit   4, 48 wide, u.0: c08000000000
centre_u               bit  52, 52 wide, s.24: fa80000
centre_v               bit 104, 52 wide, s.24: 7380000
first_column           bit 156, 16 wide, u.0: 6
first_row              bit 172, 16 wide, u.0: 2
end_column             bit 188, 16 wide, u.0: 19
end_row                bit 204, 16 wide, u.0: d
horizontal_mantissa    bit 220, 28 wide, u.0: 99e64f2
horizontal_exponent    bit 248, 10 wide, s.0: 3e3
squared_width_mantissa bit 258, 28 wide, u.0: d4eb002
squared_width_exponent bit 286, 10 wide, s.0: 3e6
shear_mantissa         bit 296, 29 wide, s.0: a3eb7f4
shear_exponent         bit 325, 10 wide, s.0: 3e5
vertical_mantissa      bit 335, 28 wide, u.0: a79849a
vertical_exponent      bit 363, 10 wide, s.0: 3e3
cutoff                 bit 373, 32 wide, u.28: a81d56e5
peak                   bit 405, 32 wide, u.28: c000000
red                    bit 437, 28 wide, u.24: 1000000
green                  bit 465, 28 wide, u.24: 800000
blue                   bit 493, 28 wide, u.24: 400000
";

const LEAN18: &str = "\
version                bit   0,  4 wide, u.0: 3
depth                  bit   4, 48 wide, u.0: c08000000000
centre_u               bit  52, 40 wide, s.12: fa80
centre_v               bit  92, 40 wide, s.12: 7380
first_column           bit 132, 16 wide, u.0: 6
first_row              bit 148, 16 wide, u.0: 2
end_column             bit 164, 16 wide, u.0: 19
end_row                bit 180, 16 wide, u.0: d
horizontal_mantissa    bit 196, 18 wide, u.0: 26799
horizontal_exponent    bit 214, 10 wide, s.0: 3ed
squared_width_mantissa bit 224, 18 wide, u.0: 353ac
squared_width_exponent bit 242, 10 wide, s.0: 3f0
shear_mantissa         bit 252, 19 wide, s.0: 28fae
shear_exponent         bit 271, 10 wide, s.0: 3ef
vertical_mantissa      bit 281, 18 wide, u.0: 29e61
vertical_exponent      bit 299, 10 wide, s.0: 3ed
cutoff                 bit 309, 32 wide, u.28: a81d56e5
peak                   bit 341, 22 wide, u.18: 30000
red                    bit 363, 18 wide, u.15: 8000
green                  bit 381, 18 wide, u.15: 4000
blue                   bit 399, 18 wide, u.15: 2000
";

/// What a packet of box drawing has otherwise.
const LEAN18_BOX: &str = "\
conic_a                bit 196, 18 wide, u.0: 133cd
conic_b                bit 214, 19 wide, s.0: 675d3
conic_c                bit 233, 18 wide, u.0: 347fb
conic_exponent         bit 251, 10 wide, s.0: 3ee
cutoff                 bit 261, 32 wide, u.28: a81d56e5
peak                   bit 293, 22 wide, u.18: 30000
red                    bit 315, 18 wide, u.15: 8000
green                  bit 333, 18 wide, u.15: 4000
blue                   bit 351, 18 wide, u.15: 2000
";

#[test]
fn the_packet_holds_these_bits() {
    let spans = Traversal::Spans;
    let (standard, lean) = (field_table(Standard24, spans), field_table(Lean18, spans));
    assert!(standard == STANDARD24, "standard24\n{standard}");
    assert!(lean == LEAN18, "lean18\n{lean}");
    let by_box = field_table(Lean18, Traversal::Box);
    let other = by_box.lines().filter(|line| !LEAN18.contains(line));
    let other: String = other.map(|line| format!("{line}\n")).collect();
    assert!(other == LEAN18_BOX, "lean18 by boxes\n{other}");
}

fn round_trip<D: Design>(design: D, splat: &VolumeSplat) -> Result<(), TestCaseError> {
    let Ok(footprint) = setup(
        design,
        &view(0.1, 0.2, Projection::Perspective),
        &Rules::EWA,
        splat,
    ) else {
        return Err(TestCaseError::reject("culled"));
    };
    let (widths, nothing) = (design.widths(), Footprint::EMPTY);
    let zero = SoftFloat::default();
    let of_spans = Footprint {
        conic: nothing.conic,
        ..footprint
    };
    let of_box = Footprint {
        ldl: Ldl {
            horizontal: zero,
            squared_width: zero,
            shear: zero,
            vertical: zero,
        },
        ..footprint
    };
    for (traversal, kept) in [(Traversal::Spans, of_spans), (Traversal::Box, of_box)] {
        let layout = Layout::with_depth(&widths, traversal);
        prop_assert_eq!(layout.decode(&layout.encode(&footprint)), Ok(kept));
        let layout = Layout::new(&widths, traversal);
        let kept = Footprint { depth: 0, ..kept };
        prop_assert_eq!(layout.decode(&layout.encode(&footprint)), Ok(kept));
    }
    Ok(())
}

proptest! {
    // Culled splats are replaced by others; the test fails if fewer than a quarter are drawn.
    #![proptest_config(ProptestConfig { cases: 1000, max_global_rejects: 3000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn packets_lose_nothing(splat in crate::common::splats()) {
        round_trip(Classic8, &splat)?;
        round_trip(Lean18, &splat)?;
        round_trip(Standard24, &splat)?;
        round_trip(Deep32, &splat)?;
    }
}

#[test]
fn another_version_is_refused() {
    let layout = Layout::new(&Standard24::WIDTHS, Traversal::Spans);
    let footprint: Footprint = setup(Standard24, &small_view(), &Rules::EWA, &leaf()).unwrap();
    let mut packet = layout.encode(&footprint);
    packet[0] ^= 3;
    assert_eq!(layout.decode(&packet), Err(VersionError { found: 0 }));
}

/// FNV-1a of the words' bytes.
fn digest(words: &[u32]) -> u64 {
    let bytes = words.iter().flat_map(|word| word.to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Every table of the kernels: first, middle and last word, and a digest of all.
fn table_words() -> String {
    let mut text = String::new();
    let designs = [
        Classic8::WIDTHS,
        Micro16::WIDTHS,
        Lean18::WIDTHS,
        Standard24::WIDTHS,
        Deep32::WIDTHS,
    ];
    for kernel in Kernel::ALL {
        for widths in designs {
            let mut table = vec![0; entries(&widths)];
            fill(&mut table, &widths, kernel.table_range(), kernel);
            let digest = digest(&table);
            let [first, middle, last] = [0, table.len() / 2, table.len() - 1].map(|at| table[at]);
            let length = table.len();
            writeln!(
                text,
                "{kernel:?} {length}: {first:x} {middle:x} {last:x} {digest:016x}"
            )
            .unwrap();
        }
    }
    let mut rays = [0; PERSPECTIVE_ENTRIES];
    fill_perspective(&mut rays);
    let [first, middle, last] = [0, rays.len() / 2, rays.len() - 1].map(|at| rays[at]);
    let (length, digest) = (rays.len(), digest(&rays));
    writeln!(
        text,
        "Perspective {length}: {first:x} {middle:x} {last:x} {digest:016x}"
    )
    .unwrap();
    text
}

const TABLES: &str = "\
Gaussian 257: fc 5 0 b593813574767082
Gaussian 129: 3ffb 12c 5 d31419ddb26e340f
Gaussian 1025: 3ffff 12c1 58 4091422275a4f53c
Gaussian 4097: 3ffffe9 12c155 57f1 7c7f4758e1c138ae
Gaussian 4097: fffffaa 4b0555 15fc2 4b6f5ec001457988
Cubic 257: fd 4 0 da5907c216440341
Cubic 129: 4000 106 0 88f38e501d7f32b7
Cubic 1025: 40000 1058 0 191cf7ca191d82ab
Cubic 4097: 3fffff9 105840 0 e44ade73bf5b90fc
Cubic 4097: fffffe3 4160ff 0 210356c5ae688f08
Quadratic 257: ff 55 0 a7d3734a733267f5
Quadratic 129: 4000 1555 0 e298c4257b5dbd75
Quadratic 1025: 40000 15555 0 96ae073157da1251
Quadratic 4097: 4000000 1555555 0 82091512a8a67029
Quadratic 4097: 10000000 5555555 0 eb9a54425de6e0c5
Disc 257: 100 100 100 a70ed5ae83934d4a
Disc 129: 4000 4000 4000 07c7c422efd81135
Disc 1025: 40000 40000 40000 45f2350438b74751
Disc 4097: 4000000 4000000 4000000 1945a656b6ed0d29
Disc 4097: 10000000 10000000 10000000 da366c0f2177f8c5
Perspective 2145: 0 1e1e1e1e 33333333 90a81e35f0b700ad
";

#[test]
fn the_tables_hold_these_words() {
    let tables = table_words();
    assert!(tables == TABLES, "\n{tables}");
}

/// Stamps of the leaf at some phases: sides, where copies begin and end, and a digest of all kernel values.
fn stamp_words<D: Design>(design: D, phase_bits: u8) -> String {
    let (widths, rules) = (design.widths(), Rules::GAUSSIAN_3D);
    let footprint = setup(design, &small_view(), &rules, &leaf()).unwrap();
    let mut memory = vec![0; entries(&widths)];
    fill_gaussian(&mut memory, &widths, rules.table_range);
    let table = FootprintTable::new(&memory, &widths, rules.table_range).unwrap();
    let shape = StampShape::new(&footprint, phase_bits).unwrap();
    let mut words = vec![u32::MAX; shape.words()];
    assert!(fill_stamps(&mut words, design, &table, &shape, &footprint));
    assert!(!fill_stamps(
        &mut words[1..],
        design,
        &table,
        &shape,
        &footprint
    ));
    let mut text = format!(
        "{:?}, {phase_bits} bits, {:016x}:",
        shape.side(),
        digest(&words)
    );
    for [x, y] in [[0.0, 0.0], [5.49, 7.51], [-3.26, 19.9], [27.7, -9.3]] {
        let centre = [x, y].map(|c: f64| (c * f64::from(widths.subpixel).exp2()) as i64);
        let placement = shape.place(centre, widths.subpixel);
        let Window { first, end } = shape.bounds(&placement, [28, 20]);
        let stamp = Stamp::new(&words, shape).unwrap();
        let window = Window {
            first: [2, 3],
            end: [26, 17],
        };
        let rows = stamp
            .rows(placement, &window)
            .map(|row| digest(row.weights) ^ u64::from(row.y) << 32 ^ u64::from(row.x));
        let rows = rows.fold(0, |sum: u64, row| sum.rotate_left(7) ^ row);
        write!(text, " {first:?} {end:?} {rows:x}").unwrap();
    }
    text + "\n"
}

const STAMPS: &str = "\
[19, 12], 0 bits, 12257bed277d9ee4: [0, 0] [10, 6] 8d77f99d1398df6d [0, 2] [15, 14] 4783fe7a587bfb90 [0, 14] [7, 20] d2c44ea552826961 [19, 0] [28, 0] 0
[19, 12], 2 bits, 26e21676ca7caa47: [0, 0] [10, 6] 94566d8f26acec57 [0, 2] [15, 14] fb8b5673b35ea4a7 [0, 14] [6, 20] 9fc21ca6c654b5ab [18, 0] [28, 0] 0
[19, 12], 1 bits, 2536b4f8453b52f8: [0, 0] [10, 6] 9f8bee75ce1673ef [0, 2] [15, 14] 48ade4ec2deaa7ea [0, 14] [6, 20] 9fc21ca6c654b5ab [18, 0] [28, 0] 0
[19, 12], 3 bits, 52f50e01cc6c7ae6: [0, 0] [10, 6] 4ba80caa61aedf33 [0, 2] [15, 14] d513d6fdee00c065 [0, 14] [6, 20] 9fc21ca6c654b5ab [18, 0] [28, 0] 0
";

#[test]
fn stamps_hold_these_words() {
    let stamps = [
        stamp_words(Classic8, 0),
        stamp_words(Lean18, 2),
        stamp_words(Standard24, 1),
        stamp_words(Deep32, 3),
    ]
    .concat();
    assert!(stamps == STAMPS, "\n{stamps}");
}
