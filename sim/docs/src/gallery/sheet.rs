//! A contact sheet: an exhibit's pictures side by side, each under its name, on white.
//!
//! Small pictures are magnified by a whole factor until they fill their place, pixels as squares, and the label says by how much: what is
//! compared then has the same size, and no pixel is invented between two others.

use super::Exhibit;
use embedded_graphics::Drawable;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::iso_8859_1::FONT_7X13;
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::text::{Baseline, Text};
use splatline_sim::picture::Picture;
use std::convert::Infallible;

/// Pixels between pictures.
const GAP: usize = 6;
/// Height of a label, and width of one of its letters.
const LABEL: usize = 16;
const LETTER: usize = 7;

/// Pictures in a row of a contact sheet of so many: few in one row, the others so that the last row is full if it can be.
fn columns(pictures: usize) -> usize {
    match pictures {
        0..=5 => pictures.max(1),
        _ if pictures.is_multiple_of(3) => 3,
        _ => 4,
    }
}

/// An exhibit's pictures on one sheet, row by row; none if there are none.
pub fn sheet(exhibit: &Exhibit) -> Option<Picture> {
    let sizes = exhibit
        .pictures
        .iter()
        .map(|(_, picture)| (picture.width, picture.height));
    let cell = sizes.reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))?;
    let factor = |picture: &Picture| (cell.0 / picture.width).min(cell.1 / picture.height).max(1);
    let labels: Vec<String> = exhibit
        .pictures
        .iter()
        .map(|(name, picture)| label(name, factor(picture)))
        .collect();
    // No label is cut: a place is as wide as the longest.
    let longest = labels.iter().map(|label| label.chars().count()).max()?;
    let (width, height) = (cell.0.max(longest * LETTER) + GAP, cell.1 + LABEL + GAP);
    let columns = columns(exhibit.pictures.len());
    let rows = exhibit.pictures.len().div_ceil(columns);
    let mut sheet = Picture::new(columns * width - GAP, rows * height - GAP);
    sheet.pixels.fill([1.0; 4]);
    for (index, ((_, picture), label)) in exhibit.pictures.iter().zip(&labels).enumerate() {
        let (x, y) = (index % columns * width, index / columns * height);
        write_label(&mut sheet, [x, y], label);
        place(&mut sheet, [x, y + LABEL], picture, factor(picture));
    }
    Some(sheet)
}

/// A picture's name in words, and its magnification if it has any.
pub fn label(name: &str, factor: usize) -> String {
    let words = name.replace('_', " ");
    match factor {
        1 => words,
        _ => format!("{words} (x{factor})"),
    }
}

/// A part of a picture.
pub fn part(picture: &Picture, [left, top]: [usize; 2], [width, height]: [usize; 2]) -> Picture {
    let mut part = Picture::new(width, height);
    let rows = picture.pixels.chunks_exact(picture.width).skip(top);
    for (out, row) in part.pixels.chunks_exact_mut(width).zip(rows) {
        out.copy_from_slice(&row[left..left + width]);
    }
    part
}

/// Copies a picture, every pixel a square of side `factor`.
fn place(sheet: &mut Picture, [left, top]: [usize; 2], picture: &Picture, factor: usize) {
    for y in 0..picture.height * factor {
        let row = &picture.pixels[y / factor * picture.width..][..picture.width];
        let start = (top + y) * sheet.width + left;
        let wide = row
            .iter()
            .flat_map(|pixel| std::iter::repeat_n(pixel, factor));
        for (out, [r, g, b, _]) in sheet.pixels[start..].iter_mut().zip(wide) {
            *out = [*r, *g, *b, 1.0];
        }
    }
}

fn write_label(sheet: &mut Picture, [left, top]: [usize; 2], text: &str) {
    let style = MonoTextStyle::new(&FONT_7X13, BinaryColor::On);
    let at = Point::new(left as i32, top as i32);
    let mut ink = Ink(sheet);
    let Ok(_) = Text::with_baseline(text, at, style, Baseline::Top).draw(&mut ink);
}

/// Draws black on a picture.
struct Ink<'a>(&'a mut Picture);

impl OriginDimensions for Ink<'_> {
    fn size(&self) -> Size {
        Size::new(self.0.width as u32, self.0.height as u32)
    }
}

impl DrawTarget for Ink<'_> {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> Result<(), Infallible>
    where
        I: IntoIterator<Item = embedded_graphics::Pixel<BinaryColor>>,
    {
        for embedded_graphics::Pixel(at, colour) in pixels {
            let (Ok(x), Ok(y)) = (usize::try_from(at.x), usize::try_from(at.y)) else {
                continue;
            };
            if colour.is_on() && x < self.0.width && y < self.0.height {
                self.0.pixels[y * self.0.width + x] = [0.0, 0.0, 0.0, 1.0];
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exhibit(pictures: &[(&str, [usize; 2])]) -> Exhibit {
        let pictures = pictures.iter().map(|(name, [width, height])| {
            let mut picture = Picture::new(*width, *height);
            picture.pixels.fill([0.5, 0.5, 0.5, 1.0]);
            (name.to_string(), picture)
        });
        Exhibit {
            name: "sizes".to_owned(),
            equation: "",
            caption: String::new(),
            pictures: pictures.collect(),
            numbers: Vec::new(),
        }
    }

    #[test]
    fn small_pictures_fill_their_place_and_say_so() {
        let sheet = sheet(&exhibit(&[("large", [80, 30]), ("small", [26, 10])])).unwrap();
        assert_eq!((sheet.width, sheet.height), (80 + GAP + 80, LABEL + 30));
        let grey = sheet.pixels.iter().filter(|pixel| pixel[0] == 0.5).count();
        assert_eq!(grey, 80 * 30 + 78 * 30);
        assert_eq!(label("a_b", 3), "a b (x3)");
    }

    #[test]
    fn no_label_is_cut() {
        let sheet = sheet(&exhibit(&[("wide name", [10, 4]), ("b", [10, 4])])).unwrap();
        assert_eq!(sheet.width, 2 * 9 * LETTER + GAP);
    }

    #[test]
    fn a_label_stands_above_its_picture() {
        let sheet = sheet(&exhibit(&[("ab", [20, 4])])).unwrap();
        let art: Vec<String> = sheet
            .pixels
            .chunks(sheet.width)
            .take(LABEL)
            .map(|row| {
                row.iter()
                    .map(|p| if p[0] == 0.0 { '#' } else { '.' })
                    .collect()
            })
            .collect();
        let ink: usize = art.join("").matches('#').count();
        assert!((20..60).contains(&ink), "{}", art.join("\n"));
        assert!(
            sheet.pixels[LABEL * sheet.width..]
                .iter()
                .all(|p| p[0] == 0.5)
        );
    }
}
