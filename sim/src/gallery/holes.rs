//! Holes of a drawn surface: what must be covered and is not.
//!
//! A pixel is a **hole** if no splat touches it, uncovered pixels do not connect it (8 neighbours) with the picture's edge, and a
//! morphological closing with a disc of [`CLOSING`] pixels covers it. The second condition leaves the background out, the third one openings
//! of the object itself that are wider than the disc, such as the room between a statue's legs.

/// Radius of the disc that closes holes, pixels.
pub const CLOSING: i32 = 3;

/// A mask of pixels, row-major.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    /// Columns.
    pub width: usize,
    /// Is the pixel in the mask?
    pub pixels: Vec<bool>,
}

impl Mask {
    /// How many pixels are in the mask.
    pub fn count(&self) -> usize {
        self.pixels.iter().filter(|pixel| **pixel).count()
    }

    fn height(&self) -> usize {
        self.pixels.len() / self.width.max(1)
    }

    /// The pixel at an offset; nothing beyond the edge.
    fn at(&self, index: usize, dx: i32, dy: i32) -> Option<usize> {
        let x = usize::try_from((index % self.width) as i64 + i64::from(dx)).ok()?;
        let y = usize::try_from((index / self.width) as i64 + i64::from(dy)).ok()?;
        (x < self.width && y < self.height()).then(|| y * self.width + x)
    }

    /// Pixels of the mask grown by a disc.
    fn grown(&self) -> Mask {
        let offsets = disc();
        let mut grown = self.clone();
        for index in (0..self.pixels.len()).filter(|index| self.pixels[*index]) {
            for (dx, dy) in &offsets {
                if let Some(near) = self.at(index, *dx, *dy) {
                    grown.pixels[near] = true;
                }
            }
        }
        grown
    }

    fn inverted(&self) -> Mask {
        Mask {
            width: self.width,
            pixels: self.pixels.iter().map(|pixel| !pixel).collect(),
        }
    }

    /// Uncovered pixels that uncovered pixels connect with the edge of the picture.
    fn background(&self) -> Mask {
        let mut reached = Mask {
            width: self.width,
            pixels: vec![false; self.pixels.len()],
        };
        let at_edge = |index: usize| {
            let (x, y) = (index % self.width, index / self.width);
            x == 0 || y == 0 || x + 1 == self.width || y + 1 == self.height()
        };
        let mut open: Vec<usize> = (0..self.pixels.len()).filter(|i| at_edge(*i)).collect();
        while let Some(index) = open.pop() {
            if self.pixels[index] || reached.pixels[index] {
                continue;
            }
            reached.pixels[index] = true;
            for (dx, dy) in [-1, 0, 1]
                .into_iter()
                .flat_map(|dy| [-1, 0, 1].map(|dx| (dx, dy)))
            {
                open.extend(self.at(index, dx, dy));
            }
        }
        reached
    }
}

/// Offsets of the closing's disc.
fn disc() -> Vec<(i32, i32)> {
    let across = -CLOSING..=CLOSING;
    let all = across
        .clone()
        .flat_map(|dy| across.clone().map(move |dx| (dx, dy)));
    all.filter(|(dx, dy)| dx * dx + dy * dy <= CLOSING * CLOSING)
        .collect()
}

/// The holes among the pixels that are not `covered`.
pub fn holes(covered: &Mask) -> Mask {
    let background = covered.background();
    let closed = covered.grown().inverted().grown().inverted();
    let is_hole =
        |index: usize| !covered.pixels[index] && !background.pixels[index] && closed.pixels[index];
    Mask {
        width: covered.width,
        pixels: (0..covered.pixels.len()).map(is_hole).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `#` covered, `.` not; holes come out as `o`.
    fn drawn(text: &str) -> String {
        let lines: Vec<&str> = text.split_whitespace().collect();
        let pixels = lines
            .iter()
            .flat_map(|line| line.chars().map(|c| c == '#'))
            .collect();
        let covered = Mask {
            width: lines[0].len(),
            pixels,
        };
        let found = holes(&covered);
        let sign = |i: usize| match (covered.pixels[i], found.pixels[i]) {
            (true, _) => '#',
            (false, true) => 'o',
            (false, false) => '.',
        };
        let all: Vec<char> = (0..covered.pixels.len()).map(sign).collect();
        all.chunks(covered.width)
            .map(|row| row.iter().collect::<String>() + "\n")
            .collect()
    }

    #[test]
    fn holes_are_found_and_bays_and_wide_openings_are_not() {
        let text = "
            ....................
            .##################.
            .####.#############.
            .#################..
            .###..............#.
            .###.........#....#.
            .##...............#.
            .###..............#.
            .###..............#.
            .###..............#.
            .###..............#.
            .##################.
            ....................";
        let expected = "\
....................
.##################.
.####o#############.
.#################..
.###oo............#.
.###o........#....#.
.##...............#.
.###..............#.
.###..............#.
.###..............#.
.###o............o#.
.##################.
....................
";
        let got = drawn(text);
        assert_eq!(got.lines().nth(2), expected.lines().nth(2), "{got}");
        assert_eq!(got.lines().nth(7), expected.lines().nth(7), "{got}");
        assert_eq!(got.lines().nth(3), expected.lines().nth(3), "{got}");
    }
}
