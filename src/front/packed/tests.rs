use super::*;
use crate::format::{Classic8, Deep32, Lean18, Micro16, RuntimeWidths, Standard24};
extern crate std;
use std::vec;
use std::vec::Vec;

fn lists(widths: Widths, words: &mut [u32], limit: u16) -> PackedList<'_, RuntimeWidths> {
    let mut list = PackedList::new(RuntimeWidths::new(widths).unwrap(), words);
    list.begin([limit; 2]);
    list
}

/// A footprint of setup with all bits of every field, or with as few as there can be.
fn extreme(widths: &Widths, ones: bool) -> Footprint {
    let bits = u32::from(widths.mantissa);
    let most = |bits: u32| if ones { u32::MAX >> (32 - bits) } else { 0 };
    let mantissa = (most(bits) | 1 << (bits - 1)) as i32;
    let number = |power: i32| SoftFloat {
        mantissa,
        exponent: power + 1 - bits as i32,
    };
    let centre = 1i64 << (26 + widths.subpixel);
    Footprint {
        centre: [-centre, if ones { centre - 1 } else { -1 }],
        end: [u16::MAX, 1],
        ldl: Ldl {
            horizontal: number(127),
            // The product of the mantissas is nearly 2^(2 bits), or 2^(2 bits - 2).
            squared_width: number(if ones { -128 } else { -127 }),
            shear: SoftFloat {
                mantissa: if ones { -mantissa } else { 0 },
                exponent: if ones { -127 - bits as i32 } else { 0 },
            },
            vertical: number(-128),
        },
        cutoff: most(32),
        opacity: most(4 + u32::from(widths.peak)),
        colour: [most(u32::from(widths.colour_range() + widths.colour)); 3],
        ..Footprint::EMPTY
    }
}

#[test]
fn entries_have_room_for_their_fields_and_no_more() {
    let named = [
        Classic8::WIDTHS,
        Micro16::WIDTHS,
        Lean18::WIDTHS,
        Standard24::WIDTHS,
        Deep32::WIDTHS,
    ];
    assert_eq!(
        named.map(|widths| packed_words(&widths)),
        [9, 9, 10, 14, 14]
    );
    let shapes = (8..=31u8).flat_map(|mantissa| (4..=28u8).map(move |bits| (mantissa, bits)));
    let drawn = shapes.map(|(mantissa, bits)| Widths {
        mantissa,
        peak: bits,
        colour: 28 - bits + 4,
        subpixel: 2 + (bits * 7 + mantissa) % 23,
        ..Standard24::WIDTHS
    });
    for widths in named.into_iter().chain(drawn) {
        let mut sum = 0;
        Entry::default().fields(&widths, |value, bits| {
            sum += bits as usize;
            value
        });
        assert_eq!(packed_words(&widths), sum.div_ceil(32), "{widths:?}");
    }
}

#[test]
fn every_bit_of_a_field_is_kept() {
    for widths in [
        Micro16::WIDTHS,
        Lean18::WIDTHS,
        Standard24::WIDTHS,
        Deep32::WIDTHS,
    ] {
        let mut words = vec![u32::MAX; 3 * packed_words(&widths)];
        let mut list = lists(widths, &mut words, u16::MAX);
        assert!(list.is_empty() && list.footprint(0).is_none());
        let entries = [true, false, true].map(|ones| extreme(&widths, ones));
        for (place, entry) in entries.iter().enumerate() {
            assert!(fits(&widths, entry));
            assert_eq!(list.push(entry, 3 * packed_words(&widths)), Some(()));
            assert_eq!(list.footprint(place + 1), None);
        }
        assert!(list.push(&entries[0], usize::MAX).is_none());
        for (place, entry) in entries.iter().enumerate() {
            assert_eq!(list.footprint(place), Some(*entry), "{place}");
        }
        let used = list.len();
        let (design, words) = (list.design, list.into_words());
        let full = [u16::MAX; 2];
        let taken_up = PackedList::filled(design, words, used, full).unwrap();
        assert_eq!(taken_up.footprint(2), Some(entries[2]));
        assert!(PackedList::filled(design, words, used + 1, full).is_none());
    }
}

/// What is thinner or farther away than an entry's fields does not fit it; a shear that moves no pixel is 0.
#[test]
fn entries_end_where_their_fields_do() {
    for widths in [Micro16::WIDTHS, Deep32::WIDTHS] {
        let footprint = extreme(&widths, false);
        let changed = |change: fn(&mut Footprint)| {
            let mut footprint = footprint;
            change(&mut footprint);
            fits(&widths, &footprint)
        };
        assert!(!changed(|f| f.ldl.horizontal.exponent += 1));
        assert!(!changed(|f| f.ldl.vertical.exponent -= 1));
        assert!(changed(|f| f.ldl.vertical.exponent += 255));
        assert!(!changed(|f| f.ldl.vertical.exponent += 256));
        for axis in 0..2 {
            let mut far = footprint;
            far.centre[axis] = 1 << (26 + widths.subpixel);
            assert!(!fits(&widths, &far));
        }
        let mut small = extreme(&widths, true);
        small.ldl.shear.exponent -= 1;
        let mut words = vec![0; packed_words(&widths)];
        let mut list = lists(widths, &mut words, u16::MAX);
        list.push(&small, usize::MAX).unwrap();
        let none = SoftFloat {
            mantissa: 0,
            exponent: 0,
        };
        assert_eq!(list.footprint(0).unwrap().ldl.shear, none);
    }
}

/// Boxes of every size around centres on and beside pixels and edges, cut at the screen's ends as setup cuts them.
#[test]
fn boxes_follow_from_their_centres() {
    const LIMIT: i64 = 9;
    // In sixteenths of a pixel.
    let sides = (-60..220i64).flat_map(|centre| (0..300i64).map(move |reach| (centre, reach)));
    let mut boxes = sides.filter_map(|(centre, reach)| {
        let [low, high] = [centre - 8 - reach + 15, centre - 8 + reach].map(|end| end >> 4);
        let [first, end] = [low, high + 1].map(|end| end.clamp(0, LIMIT) as u16);
        (first < end).then_some((centre, first, end))
    });
    let widths = Widths {
        subpixel: 4,
        ..Micro16::WIDTHS
    };
    let mut words = vec![0; packed_words(&widths)];
    while let (Some(x), Some(y)) = (boxes.next(), boxes.next()) {
        let footprint = Footprint {
            centre: [x.0, y.0],
            first: [x.1, y.1],
            end: [x.2, y.2],
            ..extreme(&widths, false)
        };
        let mut list = lists(widths, &mut words, LIMIT as u16);
        list.push(&footprint, usize::MAX).unwrap();
        assert_eq!(list.footprint(0), Some(footprint));
    }
}

/// Every list shows a strip exactly those footprints that have rows in it.
#[test]
fn strips_visit_their_own_footprints() {
    let with_rows = |[first, end]: [u16; 2]| Footprint {
        // Odd ones in the half of a pixel before the middle.
        centre: [
            0,
            ((i64::from(first) + i64::from(end)) << 11) - i64::from(first & 1),
        ],
        first: [0, first],
        end: [1, end],
        ..Footprint::EMPTY
    };
    let mut cut = with_rows([39_990, 40_000]);
    cut.centre[1] = 39_999 << 12;
    let rows = [[0, 3], [2, 5], [4, 5], [3, 40_000], [5, 8]];
    let footprints = rows.map(with_rows).into_iter().chain([cut]);
    let rows: Vec<[u16; 2]> = footprints
        .clone()
        .map(|footprint| [footprint.first[1], footprint.end[1]])
        .collect();
    let mut words = vec![0; rows.len() * packed_words(&Micro16::WIDTHS)];
    let mut packed = PackedList::new(Micro16, &mut words);
    packed.begin([40_000; 2]);
    let mut list = crate::BoundedList::<6>::new();
    for footprint in footprints {
        packed.push(&footprint, usize::MAX).unwrap();
        crate::front::DisplayList::push(&mut list, &footprint).unwrap();
    }
    let small = (0..9).flat_map(|first| (first + 1..10).map(move |end| (first, end)));
    for (first, end) in small.chain([(39_999, 40_000), (40_000, 40_001)]) {
        let window = Window {
            first: [0, first],
            end: [1, end],
        };
        let meets = |rows: &&[u16; 2]| (first..end).any(|y| (rows[0]..rows[1]).contains(&y));
        let expected: Vec<[u16; 2]> = rows.iter().filter(meets).copied().collect();
        let mut seen = [Vec::new(), Vec::new()];
        let [a, b] = &mut seen;
        let order = Compositing::FrontToBack;
        packed.visit(&window, order, |footprint| {
            a.push([footprint.first[1], footprint.end[1]])
        });
        list.visit(&window, order, |footprint| {
            b.push([footprint.first[1], footprint.end[1]])
        });
        assert_eq!(seen, [expected.clone(), expected], "{first} {end}");
    }
}

/// Windows below the picture see none of its footprints, whose rows end with it, however wide it is.
#[test]
fn nothing_is_visited_below_the_picture() {
    let widths = Micro16::WIDTHS;
    let mut words = vec![0; packed_words(&widths)];
    let mut list = PackedList::new(RuntimeWidths::<i64>::new(widths).unwrap(), &mut words);
    assert!(list.is_empty());
    list.begin([100, 10]);
    let footprint = Footprint {
        centre: [10 << widths.subpixel; 2],
        first: [5; 2],
        end: [15, 10],
        ..extreme(&widths, false)
    };
    list.push(&footprint, packed_words(&widths)).unwrap();
    let visited = |first, end| {
        let (mut count, window) = (
            0,
            Window {
                first: [0, first],
                end: [100, end],
            },
        );
        list.visit(&window, Compositing::FrontToBack, |_| count += 1);
        count
    };
    assert_eq!([visited(9, 12), visited(12, 14)], [1, 0]);
}
