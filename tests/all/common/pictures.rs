//! Pictures that a reviewer opens: PNG files under tests/pictures, compared bit for bit.
//!
//! Where one differs, what was drawn and the difference (white where it is largest) are written into target/tmp, and
//! the message names them. `SPLATLINE_BLESS=1 cargo test -p splatline --test all front` writes the pictures anew, for a
//! change that is meant.

use image::{Rgb, RgbImage};
use splatline::{Frame, Window};
use std::path::Path;

/// Compares a frame over a background (255ths) with `tests/pictures/NAME.png`.
pub fn check(name: &str, frame: &Frame, background: [u8; 3]) {
    let Window { first, end: last } = frame.window;
    let [columns, rows] = [0, 1].map(|axis| u32::from(last[axis] - first[axis]));
    let bytes = frame.rgb8(background).flatten().collect();
    let got =
        RgbImage::from_raw(columns, rows, bytes).expect("a frame has the pixels of its window");
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/pictures/{name}.png"));
    if std::env::var_os("SPLATLINE_BLESS").is_some() {
        got.save(&file).expect("the picture is written");
    }
    let expected = image::open(&file).map(|picture| picture.into_rgb8());
    let expected = expected.unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    if let Some(report) = difference(&expected, &got) {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let [drawn, apart] =
            ["drawn", "difference"].map(|what| folder.join(format!("{name}.{what}.png")));
        got.save(&drawn).expect("the picture is written");
        report.picture.save(&apart).expect("the picture is written");
        panic!(
            "{}: {} pixels differ, by at most {} of 255: see {} and {}",
            file.display(),
            report.pixels,
            report.largest,
            drawn.display(),
            apart.display()
        );
    }
}

/// How two pictures differ.
struct PixelDifference {
    pixels: usize,
    largest: u8,
    picture: RgbImage,
}

/// `None` if they are equal; a picture of another size differs everywhere.
fn difference(expected: &RgbImage, got: &RgbImage) -> Option<PixelDifference> {
    if expected == got {
        return None;
    }
    let at = |x, y| {
        expected
            .get_pixel_checked(x, y)
            .copied()
            .unwrap_or(Rgb([0; 3]))
    };
    let apart = |x, y| {
        let (a, b) = (at(x, y).0, got.get_pixel(x, y).0);
        [0, 1, 2].map(|c: usize| a[c].abs_diff(b[c]))
    };
    let places = got.enumerate_pixels().map(|(x, y, _)| apart(x, y));
    let largest = places.clone().flatten().max().unwrap_or(0);
    let scale = |d: u8| (u32::from(d) * 255 / u32::from(largest.max(1))) as u8;
    Some(PixelDifference {
        pixels: places.filter(|d| *d != [0; 3]).count(),
        largest,
        picture: RgbImage::from_fn(
            got.width(),
            got.height(),
            |x, y| Rgb(apart(x, y).map(scale)),
        ),
    })
}

#[test]
fn a_difference_is_found_and_shown() {
    let black = RgbImage::new(3, 2);
    assert!(difference(&black, &black).is_none());
    let mut other = black.clone();
    other.put_pixel(2, 1, Rgb([0, 4, 2]));
    let found = difference(&black, &other).unwrap();
    assert_eq!((found.pixels, found.largest), (1, 4));
    assert_eq!(found.picture.get_pixel(2, 1).0, [0, 255, 127]);
    assert!(difference(&RgbImage::new(1, 1), &black).is_some());
}
