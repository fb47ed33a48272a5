extern crate std;
use super::super::seeds::{Balance, GUARD, in_q32, rounded_to_word};
use super::*;
use crate::footprint::Ldl;
use crate::format::{Lane, Lean18, Micro16, RuntimeWidths, Standard24};
use crate::math::shift_round;
use proptest::prelude::*;

/// Short words give the half-widths that long ones give, to the last bit of what is left of the cut-off.
#[test]
fn half_widths_of_short_mantissas() {
    let short = Micro16::WIDTHS;
    let with_mantissa = |mantissa| Widths { mantissa, ..short };
    let long = with_mantissa(19);
    let unit = vertical_fraction(&short) - REST;
    let variances = [0.7, 1.0, 3.3, 900.0];
    for (variance, bits) in variances
        .iter()
        .flat_map(|v| [15, 18].map(|bits| (*v, bits)))
    {
        let short = with_mantissa(bits);
        let half = HalfWidth::new(soft(variance, bits.into()));
        let longer = (18..29).flat_map(|bit| [(1 << bit) + 0x2a53, (3 << bit >> 1) + 0x15ad]);
        for rest in (1..64).chain([0x3fff, 0x4001, 0xffffff]).chain(longer) {
            assert_eq!(half.of(rest << unit, &short), half.of(rest << unit, &long));
        }
    }
    let fraction = |radial| vertical_fraction(&Widths { radial, ..short });
    assert_eq!([10, 21, 22, 23, 27].map(fraction), [26, 26, 26, 27, 31]);
}

/// What is shifted in one word is what is shifted in two, where it fits.
#[test]
fn distances_are_rounded_in_a_word() {
    for shift in 1..64 {
        for value in [1, -1, 0x1234_5678_9abc_def0, -0x0fed_cba9_8765_4321i64] {
            let value = if shift < 34 {
                value >> (34 - shift)
            } else {
                value
            };
            let expected = shift_round(value, shift);
            assert_eq!(
                i64::from(rounded_to_word(value, shift)),
                expected,
                "{value} {shift}"
            );
        }
    }
}

/// A number rounded to a mantissa.
fn soft(value: f64, bits: u32) -> SoftFloat {
    let exponent = value.abs().log2().floor() as i32 + 1 - bits as i32;
    SoftFloat::from_wide(
        (value * f64::from(-exponent).exp2()).round() as i64,
        exponent,
        bits,
    )
}

/// The footprint of an ellipse with these semi-axes, the first of which points along `direction`, up to r = 11.
fn ellipse(
    widths: &Widths,
    centre: [f64; 2],
    [length, thickness]: [f64; 2],
    [cos, sin]: [f64; 2],
) -> Footprint {
    let [long, thin] = [length * length, thickness * thickness];
    let xx = long * cos * cos + thin * sin * sin;
    let xy = (long - thin) * sin * cos;
    let yy = long * sin * sin + thin * cos * cos;
    let bits = widths.mantissa.into();
    let side = |axis: usize, variance: f64, limit: f64| {
        let reach = (11.0 * variance).sqrt() * (1.0 + 1e-3);
        let [low, high] = [centre[axis] - reach, centre[axis] + reach];
        [
            (low - 0.5).ceil().clamp(0.0, limit) as u16,
            (high + 0.5).floor().clamp(0.0, limit) as u16,
        ]
    };
    let [columns, rows] = [side(0, xx, 8192.0), side(1, yy, 4096.0)];
    Footprint {
        centre: centre.map(|c| (c * f64::from(widths.subpixel).exp2()).round() as i64),
        first: [columns[0], rows[0]],
        end: [columns[1], rows[1]],
        ldl: Ldl {
            horizontal: soft(yy / (long * thin), bits),
            squared_width: soft(long * thin / yy, bits),
            shear: if xy == 0.0 {
                SoftFloat::ZERO
            } else {
                soft(xy / yy, bits)
            },
            vertical: soft(1.0 / yy, bits),
        },
        cutoff: 11 << 28,
        ..Footprint::EMPTY
    }
}

fn runs<D: Design>(mut rows: EllipseSpans<D>) -> std::vec::Vec<Span<D::Lane>> {
    core::iter::from_fn(|| rows.next_span()).collect()
}

/// A window without rows shows none, and one that begins where a row's span ends has no empty run.
#[test]
fn what_is_seen_has_pixels() {
    let footprint = ellipse(&Lean18::WIDTHS, [9.5, 3.5], [5.0, 2.0], [1.0, 0.0]);
    let seen = |first, end| {
        runs(EllipseSpans::new(
            Lean18,
            &footprint,
            &Window { first, end },
        ))
    };
    assert!(!seen([0; 2], [40, 40]).is_empty());
    for (first, end) in [([0, 0], [40, 0]), ([0, 3], [40, 3]), ([9, 0], [9, 40])] {
        assert_eq!(seen(first, end).len(), 0, "{first:?} to {end:?}");
    }
    for column in 0..40 {
        let runs = seen([column, 0], [40, 40]);
        assert!(
            runs.iter().all(|run| run.length > 0),
            "from column {column}"
        );
    }
}

/// Blocks of rows begin as rows that are stepped through do, and end with what is there.
#[test]
fn constants_are_those_of_the_rows() {
    let footprint = ellipse(&Lean18::WIDTHS, [70.3, 90.2], [20.0, 60.0], [0.8, 0.6]);
    for (first, end) in [(5, 49), (37, 64), (40, 200), (64, 65), (70, 70)] {
        let window = Window {
            first: [0, first],
            end: [200, end],
        };
        let mut rows = EllipseSpans::new(Lean18, &footprint, &window);
        let constants = rows.constants();
        assert_eq!(constants.bounds, [footprint.first[0], footprint.end[0]]);
        let last = end
            .min(first / BLOCK * BLOCK + 3 * BLOCK)
            .min(footprint.end[1]);
        assert_eq!(constants.rows, [first, last.max(first)]);
        let mut begun = first;
        for block in constants.blocks {
            assert_eq!(
                block.end,
                (begun / BLOCK * BLOCK + BLOCK).min(last).max(first)
            );
            if begun == block.end {
                continue;
            }
            let Quadratic { value, first, .. } = rows.vertical;
            assert_eq!(
                (block.centre, block.vertical),
                (rows.centre, [value, first])
            );
            (begun..block.end).for_each(|_| {
                rows.next_row();
            });
            begun = block.end;
        }
    }
}

/// A row's part of the box is drawn, wherever its span begins.
#[test]
fn nothing_is_seen_beside_the_box() {
    let mut footprint = ellipse(&Lean18::WIDTHS, [9.5, 3.5], [5.0, 2.0], [1.0, 0.0]);
    footprint.first[0] = 8;
    let window = Window {
        first: [0; 2],
        end: [40, 40],
    };
    let mut rows = EllipseSpans::new(Lean18, &footprint, &window);
    assert_eq!(rows.constants().bounds, [8, footprint.end[0]]);
    while rows.y < rows.end_row {
        let row = rows.next_row();
        assert!(row.x >= 8 || row.end == 0, "{} from {}", row.y, row.x);
    }
}

/// Mantissas are handed on as they are, whether their root needs twice as much or not; the narrowest half-widths are in
/// place.
#[test]
fn half_widths_of_both_parities() {
    let window = Window {
        first: [0; 2],
        end: [40, 40],
    };
    let mut parities = [false; 2];
    for length in [3.0, 4.0, 5.0, 6.0, 8.0] {
        let footprint = ellipse(&Lean18::WIDTHS, [9.5, 3.5], [length, 2.0], [1.0, 0.0]);
        let (mantissa, odd, _) = EllipseSpans::new(Lean18, &footprint, &window)
            .constants()
            .squared_width;
        assert_eq!(mantissa, footprint.ldl.squared_width.mantissa as u64);
        parities[odd as usize] = true;
    }
    assert_eq!(parities, [true; 2]);
    let widths = Lean18::WIDTHS;
    let thin = HalfWidth::new(SoftFloat {
        mantissa: 1 << 17,
        exponent: -47,
    });
    let half = thin.of(1 << vertical_fraction(&widths), &widths);
    assert!(half.abs_diff(1 << 17) <= 1, "{half}");
}

/// Ends beyond the word are its ends, where widths allow them; designs of short mantissas and short lanes take short
/// words.
#[test]
fn short_words_are_taken_where_they_suffice() {
    assert_eq!(ends(i64::MAX, i64::MAX, false), (0, i32::MAX));
    assert_eq!(ends(i64::MAX, i64::MAX, true), (0, 0));
    let micro = Seed::new(Micro16, &Footprint::EMPTY.ldl, 0, 0);
    assert!(micro.is_narrow());
    let wide = RuntimeWidths::<i64>::new(Micro16::WIDTHS).unwrap();
    assert!(!Seed::new(wide, &Footprint::EMPTY.ldl, 0, 0).is_narrow());
    let long = Widths {
        mantissa: 19,
        ..Lean18::WIDTHS
    };
    for (widths, narrow) in [(Lean18::WIDTHS, true), (long, false)] {
        let design = RuntimeWidths::<i32>::for_lanes(widths).unwrap();
        let seed = Seed::new(design, &Footprint::EMPTY.ldl, 0, 0);
        assert_eq!(seed.is_narrow(), narrow);
    }
    let far = Ldl {
        squared_width: SoftFloat {
            mantissa: 1 << 14,
            exponent: 200,
        },
        ..Footprint::EMPTY.ldl
    };
    assert_eq!(
        Seed::new(Micro16, &far, reach_of_rows(far.squared_width), 0).drop_dx,
        63
    );
    assert_eq!(in_q32(1, 31), 2);
}

proptest! {
    /// The oracle is the parabola itself, in units of the lanes' last place.
    #[test]
    fn balanced_differences_stay_close_to_the_parabola(fine in 0i64..1 << 40, dx in -64.0f64..64.0) {
        let Balance { second, unit, start } = Balance::new(fine);
        let horizontal = fine as f64 / f64::from(1 << GUARD);
        // The part of the first difference that depends on dx, rounded as the seed rounds it.
        let along = (2.0 * horizontal * dx).round();
        let (mut radial, mut first) = (start as f64, along + unit as f64);
        for n in 0..=i32::from(BLOCK) {
            let exact = horizontal * f64::from(n * n) + 2.0 * horizontal * dx * f64::from(n);
            // A quarter of BLOCK^2/8, and the roundings of both parts of the first difference.
            let bound = f64::from(BLOCK).powi(2) / 32.0 + f64::from(n) + 1.0;
            prop_assert!((radial - exact).abs() <= bound, "{n}: {}", radial - exact);
            radial += first;
            first += second as f64;
        }
    }

    /// What hardware holds of xc (28 + subpixel bits, a seed saturated) and of C dy^2 (g + 6 bits) gives the same
    /// spans, for low-passed splats of any size that meet the screen or not. Variances and box come from double
    /// precision.
    #[test]
    fn short_row_words_give_the_same_spans(
        [length, thickness] in [-1.0f64..25.0, -0.85..20.0], angle in prop_oneof![-1.6..1.6f64, -1e-3..1e-3f64, -1e-6..1e-6f64],
        [x, y] in [-100.0..8300.0, -100.0..4200.0f64], along in -4.0..4.0f64, wide: bool,
    ) {
        let widths = if wide { Standard24::WIDTHS } else { Lean18::WIDTHS };
        let (length, thickness) = (length.max(thickness).exp2(), thickness.exp2());
        let (sin, cos) = f64::sin_cos(angle);
        let centre = [x - along * length * cos, y - along * length * sin];
        prop_assume!(centre.iter().all(|c: &f64| c.abs() < 26f64.exp2()));
        let footprint = ellipse(&widths, centre, [length, thickness], [cos, sin]);
        let window = Window { first: [0; 2], end: [8192, 4096] };
        let mut rows = EllipseSpans::new(RuntimeWidths::new(widths).unwrap(), &footprint, &window);
        let bits = 28 + u32::from(widths.subpixel);
        let drop = 32 - rows.seeds.centre_fraction;
        let mut word = rows.centre >> drop;
        while rows.y < rows.end_row {
            if rows.y.is_multiple_of(BLOCK) || rows.y == footprint.first[1] {
                word = (rows.centre >> drop).clamp(-1 << (bits - 1), (1 << (bits - 1)) - 1);
            }
            prop_assert!(rows.vertical.value.unsigned_abs() >> (vertical_fraction(&widths) + 5) == 0);
            let rest = rows.reach - rows.vertical.value;
            if rest > 0 {
                let half = rows.half_width.of(rest, &widths);
                let span = |centre| {
                    let (low, high) = ends(centre, half, false);
                    (low.clamp(0, 8192), high.clamp(0, 8192))
                };
                let (narrow, full) = (span(word << drop), span(rows.centre));
                prop_assert!(narrow == full || narrow.0 >= narrow.1 && full.0 >= full.1, "{narrow:?} {full:?}");
            }
            word = word.wrapping_add(rows.seeds.shear_per_row >> drop) << (64 - bits) >> (64 - bits);
            rows.next_row();
        }
    }

    /// The oracle is the same by words of 64 bits, for low-passed splats of any size that meet the window.
    #[test]
    fn words_give_the_same_runs(
        [length, thickness] in [-1.0f64..25.0, -0.85..20.0], angle in prop_oneof![-1.6..1.6f64, -1e-3..1e-3f64],
        [x, y] in [-10.0..150.0, -10.0..130.0f64], along in -4.0..4.0f64,
    ) {
        let (length, thickness) = (length.max(thickness).exp2(), thickness.exp2());
        let (sin, cos) = f64::sin_cos(angle);
        let centre = [x - along * length * cos, y - along * length * sin];
        prop_assume!(centre.iter().all(|c: &f64| c.abs() < 26f64.exp2()));
        let window = Window { first: [7, 3], end: [135, 120] };
        for widths in [Lean18::WIDTHS, Widths { mantissa: 16, ..Lean18::WIDTHS }, Micro16::WIDTHS] {
            let footprint = ellipse(&widths, centre, [length, thickness], [cos, sin]);
            let short = RuntimeWidths::<i32>::for_lanes(widths).unwrap();
            let mut short = EllipseSpans::new(short, &footprint, &window);
            let mut wide = EllipseSpans::new(RuntimeWidths::new(widths).unwrap(), &footprint, &window);
            prop_assert!(short.seed.is_narrow() && !wide.seed.is_narrow());
            while let Some(run) = wide.next_span() {
                let expected = Span {
                    y: run.y,
                    x: run.x,
                    length: run.length,
                    radial: run.radial as i32,
                    first: run.first as i32,
                    second: run.second as i32,
                };
                prop_assert_eq!(short.next_span(), Some(expected));
            }
            prop_assert_eq!(short.next_span(), None);
        }
    }

    #[test]
    fn every_curvature_is_defined(fine: i64) {
        let _ = Balance::new(fine);
    }
}

#[test]
fn centres_of_wide_or_sheared_rows_have_fewer_bits() {
    let shear = |leading: i32| SoftFloat {
        mantissa: 1 << 17,
        exponent: leading - 17,
    };
    let bits = |half, leading| centre_fraction(16, half, shear(leading));
    assert_eq!([bits(13, 12), bits(14, 12), bits(13, 13)], [24, 14, 14]);
}

/// A row that the cut-off leaves nothing has no run, and one that it leaves the least has the pixel at its centre.
#[test]
fn the_least_rest_has_a_pixel() {
    let footprint = ellipse(&Lean18::WIDTHS, [9.5, 3.5], [5.0, 2.0], [1.0, 0.0]);
    let window = Window {
        first: [0; 2],
        end: [40, 40],
    };
    for (rest, length) in [(-1, 0), (0, 0), (1, 1), (1 << 10, 1)] {
        let mut rows = EllipseSpans::new(Lean18, &footprint, &window);
        rows.reach = rows.vertical.value + rest;
        let row = rows.next_row();
        assert_eq!(row.end - row.end.min(row.x), length, "{rest}");
    }
}

#[test]
fn runs_are_these() {
    fn words<D: Design>(design: D, next: &mut impl FnMut() -> u64) -> u64 {
        let widths = design.widths();
        let mut part = |most: f64| (next() >> 11) as f64 / 2f64.powi(53) * most;
        let ellipses = (0..60).flat_map(|_| {
            // No function that another platform rounds otherwise.
            let t = part(2.0) - 1.0;
            let (sin, cos) = (2.0 * t / (1.0 + t * t), (1.0 - t * t) / (1.0 + t * t));
            let size = [0.6 + part(40.0), 0.6 + part(9.0)];
            let footprint = ellipse(&widths, [part(99.0), part(99.0)], size, [cos, sin]);
            let window = Window {
                first: [part(60.0) as u16, part(60.0) as u16],
                end: [100; 2],
            };
            let runs = runs(EllipseSpans::new(design, &footprint, &window));
            runs.into_iter().flat_map(|run| {
                let place = u64::from(run.y) << 32 | u64::from(run.x) << 16 | u64::from(run.length);
                [
                    place,
                    run.radial.to_wide() as u64,
                    run.first.to_wide() as u64,
                    run.second.to_wide() as u64,
                ]
            })
        });
        crate::digest(ellipses)
    }
    let mut next = crate::random();
    let found = [
        words(Micro16, &mut next),
        words(Lean18, &mut next),
        words(Standard24, &mut next),
    ];
    assert_eq!(
        found,
        [
            4_375_629_308_115_381_701,
            15_048_125_114_524_728_255,
            6_404_172_405_956_369_961
        ]
    );
}

/// Seeds of words are those of 64 bits whatever their shifts, also those that no footprint of setup has.
#[test]
fn seeds_by_words_are_defined_for_all_shifts() {
    let short = RuntimeWidths::<i32>::for_lanes(Lean18::WIDTHS).unwrap();
    let wide = RuntimeWidths::new(Lean18::WIDTHS).unwrap();
    let mut next = crate::random();
    for half in -3..26 {
        for exponent in -90..20 {
            let ldl = Ldl {
                horizontal: SoftFloat {
                    mantissa: 1 << 17 | (next() as i32 & 0x1ffff),
                    exponent,
                },
                ..Footprint::EMPTY.ldl
            };
            let short = Seed::new(short, &ldl, half, 0);
            let wide = Seed::new(wide, &ldl, half, 0);
            for _ in 0..8 {
                let column = next() as u16;
                let dx = next() as i64 >> (31 - half);
                let centre = (i64::from(column) << 32) - dx;
                let (radial, first, second) = wide.at(column, centre, 1 << 20);
                let expected = (radial as i32, first as i32, second as i32);
                assert_eq!(
                    short.at(column, centre, 1 << 20),
                    expected,
                    "{half} {exponent}"
                );
            }
        }
    }
}
