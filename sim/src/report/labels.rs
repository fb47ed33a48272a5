//! Places labels beside markers so that no label covers another one, a marker or the frame.
//!
//! Every label tries a fixed list of places, nearest first, and takes the first free one; where none is free it takes
//! the one that overlaps least. Labels that end up away from their marker ask for a leader line.

/// An axis-parallel rectangle in pixels, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelPlacement {
    pub area: Rectangle,
    /// The label stands away from its marker and needs a line to it.
    pub leader: bool,
}

impl Rectangle {
    /// From its upper left corner on, so wide and high.
    pub const fn new([left, top]: [f64; 2], [width, height]: [f64; 2]) -> Rectangle {
        Rectangle {
            left,
            top,
            width,
            height,
        }
    }

    /// Both ends of an axis along it.
    pub fn across(&self) -> [f64; 2] {
        [self.left, self.left + self.width]
    }

    /// Of one upwards.
    pub fn upwards(&self) -> [f64; 2] {
        [self.top + self.height, self.top]
    }

    /// A square around a point.
    pub fn around((x, y): (f64, f64), half: f64) -> Rectangle {
        Rectangle::new([x - half, y - half], [2.0 * half, 2.0 * half])
    }

    /// Area common to both.
    pub fn overlap(&self, other: &Rectangle) -> f64 {
        let across =
            (self.left + self.width).min(other.left + other.width) - self.left.max(other.left);
        let down = (self.top + self.height).min(other.top + other.height) - self.top.max(other.top);
        across.max(0.0) * down.max(0.0)
    }

    /// Area outside `frame`.
    fn outside(&self, frame: &Rectangle) -> f64 {
        self.width * self.height - self.overlap(frame)
    }
}

/// Places one label per anchor. What is `drawn` already is kept free, `frame` is not left.
pub fn place(
    anchors: &[(f64, f64)],
    sizes: &[(f64, f64)],
    drawn: &[Rectangle],
    frame: &Rectangle,
) -> Vec<LabelPlacement> {
    let mut taken: Vec<Rectangle> = drawn.to_vec();
    let mut placements = Vec::with_capacity(anchors.len());
    for (&anchor, &size) in anchors.iter().zip(sizes) {
        let placement = best_place(anchor, size, &taken, frame);
        taken.push(placement.area);
        placements.push(placement);
    }
    placements
}

/// The first free place, or the one with the least overlap.
fn best_place(
    anchor: (f64, f64),
    size: (f64, f64),
    taken: &[Rectangle],
    frame: &Rectangle,
) -> LabelPlacement {
    let cost = |placement: &LabelPlacement| {
        let covered: f64 = taken
            .iter()
            .map(|other| placement.area.overlap(other))
            .sum();
        covered + placement.area.outside(frame)
    };
    let mut best = beside(anchor, size, (1.0, 0.0), 0);
    let mut least = f64::INFINITY;
    for ring in 0..6 {
        for side in SIDES {
            let placement = beside(anchor, size, side, ring);
            let cost = cost(&placement);
            if cost < least - 1e-9 {
                (best, least) = (placement, cost);
            }
        }
        // A free place on a nearer ring is better than any on a farther one.
        if least < 1e-9 {
            break;
        }
    }
    best
}

/// Directions from the marker to the label, in order of preference.
const SIDES: [(f64, f64); 8] = [
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 1.0),
    (1.0, -1.0),
    (1.0, 1.0),
    (-1.0, -1.0),
    (-1.0, 1.0),
];

/// Distance between a marker's centre and the nearest edge of its label.
const GAP: f64 = 10.0;
/// Distance between two rings of places.
const RING: f64 = 16.0;

/// The label's box on one side of its anchor.
fn beside(anchor: (f64, f64), size: (f64, f64), side: (f64, f64), ring: usize) -> LabelPlacement {
    let distance = GAP + RING * ring as f64;
    let left = anchor.0 + side.0 * (distance + size.0 / 2.0) - size.0 / 2.0;
    let top = anchor.1 + side.1 * (distance + size.1 / 2.0) - size.1 / 2.0;
    let area = Rectangle::new([left, top], [size.0, size.1]);
    LabelPlacement {
        area,
        leader: ring > 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FRAME: Rectangle = Rectangle::new([0.0, 0.0], [600.0, 400.0]);

    #[test]
    fn a_lone_label_stands_to_the_right_without_a_leader() {
        let placed = place(&[(100.0, 100.0)], &[(60.0, 14.0)], &[], &FRAME);
        assert_eq!(placed[0].area, Rectangle::new([110.0, 93.0], [60.0, 14.0]));
        assert!(!placed[0].leader);
    }

    #[test]
    fn a_label_at_the_right_edge_turns_to_the_left() {
        let placed = place(&[(590.0, 100.0)], &[(60.0, 14.0)], &[], &FRAME);
        assert_eq!(placed[0].area.left + placed[0].area.width, 580.0);
    }

    proptest! {
        #[test]
        fn labels_of_crowded_markers_never_overlap(
            points in proptest::collection::vec((250.0..350.0f64, 150.0..250.0f64), 1..7),
        ) {
            let sizes = vec![(60.0, 14.0); points.len()];
            let markers: Vec<Rectangle> = points.iter().map(|&p| Rectangle::around(p, 5.0)).collect();
            let placed = place(&points, &sizes, &markers, &FRAME);
            for (i, a) in placed.iter().enumerate() {
                prop_assert!(a.area.outside(&FRAME) < 1e-6);
                for b in &placed[i + 1..] {
                    prop_assert!(a.area.overlap(&b.area) < 1e-6, "{:?}", placed);
                }
                for marker in &markers {
                    prop_assert!(a.area.overlap(marker) < 1e-6);
                }
            }
        }
    }
}
