//! Holes of a drawn surface: what must be covered and is not.
//!
//! A **hole** is a region of uncovered pixels, connected through 8 neighbours, that does not touch the picture's edge and that a
//! morphological closing with a disc covers entirely. The first condition leaves the background out, the second one
//! openings of the object itself that are wider than the disc, such as the room between a statue's legs.

/// A mask of pixels, row-major.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HoleMask {
    /// Columns.
    pub width: usize,
    /// Is the pixel in the mask?
    pub pixels: Vec<bool>,
}

impl HoleMask {
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
    fn grown(&self, radius: f64) -> HoleMask {
        let offsets = disc(radius);
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

    fn inverted(&self) -> HoleMask {
        HoleMask {
            width: self.width,
            pixels: self.pixels.iter().map(|pixel| !pixel).collect(),
        }
    }

    /// Regions of uncovered pixels, each connected through 8 neighbours.
    fn gaps(&self) -> Vec<Vec<usize>> {
        let mut seen = self.pixels.clone();
        let mut gaps = Vec::new();
        for start in 0..seen.len() {
            let mut gap = Vec::new();
            let mut open = vec![start];
            while let Some(index) = open.pop() {
                if std::mem::replace(&mut seen[index], true) {
                    continue;
                }
                gap.push(index);
                for (dx, dy) in [-1, 0, 1]
                    .into_iter()
                    .flat_map(|dy| [-1, 0, 1].map(|dx| (dx, dy)))
                {
                    open.extend(self.at(index, dx, dy));
                }
            }
            if !gap.is_empty() {
                gaps.push(gap);
            }
        }
        gaps
    }

    fn is_at_edge(&self, index: usize) -> bool {
        let (x, y) = (index % self.width, index / self.width);
        x == 0 || y == 0 || x + 1 == self.width || y + 1 == self.height()
    }
}

/// Offsets of a disc.
fn disc(radius: f64) -> Vec<(i32, i32)> {
    let across = -(radius as i32)..=radius as i32;
    let all = across
        .clone()
        .flat_map(|dy| across.clone().map(move |dx| (dx, dy)));
    all.filter(|(dx, dy)| f64::from(dx * dx + dy * dy) <= radius * radius)
        .collect()
}

/// The holes among the pixels that are not `covered`, closed with a disc of `radius` pixels.
pub fn holes(covered: &HoleMask, radius: f64) -> HoleMask {
    let closed = covered.grown(radius).inverted().grown(radius).inverted();
    let mut holes = HoleMask {
        width: covered.width,
        pixels: vec![false; covered.pixels.len()],
    };
    let is_hole = |gap: &&Vec<usize>| {
        gap.iter()
            .all(|index| closed.pixels[*index] && !covered.is_at_edge(*index))
    };
    for index in covered.gaps().iter().filter(is_hole).flatten() {
        holes.pixels[*index] = true;
    }
    holes
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
        let covered = HoleMask {
            width: lines[0].len(),
            pixels,
        };
        let found = holes(&covered, 3.0);
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
    fn holes_are_found_and_bays_and_openings_are_not() {
        let text = "
            .......................
            .##################....
            .####.#############....
            .#################.....
            .###..........#########
            .###..........########.
            .##...........########.
            .###..........##.######
            .###..........#..######
            .###..........#########
            .###..........#########
            .######################
            .......................";
        let expected = text.replacen("####.####", "####o####", 1);
        let expected = expected.replacen("##.######\n", "##o######\n", 1);
        let expected = expected.replacen("#..######\n", "#oo######\n", 1);
        let expected: Vec<&str> = expected.split_whitespace().collect();
        let got = drawn(text);
        assert_eq!(got.lines().collect::<Vec<_>>(), expected, "{got}");
    }
}
