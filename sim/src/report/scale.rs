//! The colours of signed errors: cool where fixed point is darker than the reference, warm where it is brighter. The
//! live page compiles this file as well, so that a colour means the same in both.
//!
//! The scale ends at a percentile of the errors that are not zero, and what lies beyond is counted: one stray pixel at
//! a footprint's edge may err a thousand times as much as all others and must not decide alone what is seen of them.
//! Between its end and zero the scale follows `asinh(error / knee)`: linear for errors below the knee, logarithmic
//! above. The knee is a quarter of the median error. Where all errors are alike the scale is nearly linear.

/// Percentile of the errors at which the scale ends unless a reader chooses another.
pub const PERCENTILE: f64 = 99.9;

/// The dark middle, then towards full error, in sRGB.
const MIDDLE: [f64; 3] = [17.0, 19.0, 24.0];
/// Fixed is brighter.
const WARM: [[f64; 3]; 3] = [
    [150.0, 45.0, 25.0],
    [240.0, 120.0, 45.0],
    [255.0, 226.0, 170.0],
];
/// Fixed is darker.
const COOL: [[f64; 3]; 3] = [
    [22.0, 70.0, 150.0],
    [50.0, 145.0, 230.0],
    [190.0, 232.0, 255.0],
];

/// The knee over the median error.
const KNEE: f64 = 0.25;
/// The median is taken to be at least this part of the scale's end: nobody looks for more than eight decades.
const SMALLEST_KNEE: f64 = 1e-8;

/// Where the colour scale ends and bends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorScale {
    /// The absolute difference of full colour; 0 for identical pictures.
    pub limit: f64,
    /// The absolute difference at which the scale turns from linear to logarithmic; 0 for identical pictures.
    pub knee: f64,
    /// The largest absolute difference.
    pub largest: f64,
    /// Differences beyond the limit, drawn in full colour.
    pub outliers: usize,
}

impl ErrorScale {
    /// A scale that ends at a percentile of the differences that are not zero.
    pub fn of(differences: &[f64], percentile: f64) -> ErrorScale {
        let mut sizes: Vec<f64> = differences
            .iter()
            .map(|difference| difference.abs())
            .filter(|&size| size > 0.0)
            .collect();
        let count = sizes.len();
        if count == 0 {
            return ErrorScale::default();
        }
        let rank = (percentile / 100.0 * count as f64).ceil() as usize;
        let rank = rank.clamp(1, count) - 1;
        let limit = *sizes.select_nth_unstable_by(rank, f64::total_cmp).1;
        // Ranks are now on their side of the limit.
        let outliers = sizes[rank..].iter().filter(|&&size| size > limit).count();
        let largest = sizes[rank..].iter().fold(0.0f64, |m, &size| m.max(size));
        let median = *sizes.select_nth_unstable_by(count / 2, f64::total_cmp).1;
        ErrorScale {
            limit,
            knee: KNEE * median.max(limit * SMALLEST_KNEE),
            largest,
            outliers,
        }
    }

    /// Where a difference stands on the scale: -1 to 1, and beyond for outliers.
    pub fn position(&self, difference: f64) -> f64 {
        if self.limit > 0.0 {
            (difference / self.knee).asinh() / self.range()
        } else {
            0.0
        }
    }

    /// The difference that stands at a position of the scale: the inverse of [`ErrorScale::position`].
    pub fn difference_at(&self, position: f64) -> f64 {
        if self.limit > 0.0 {
            self.knee * (position * self.range()).sinh()
        } else {
            0.0
        }
    }

    fn range(&self) -> f64 {
        (self.limit / self.knee).asinh()
    }
}

/// Colour at a position of the scale; beyond -1 and 1 those of the ends.
pub fn colour(position: f64) -> [u8; 3] {
    let stops = if position < 0.0 { &COOL } else { &WARM };
    let along = position.abs().min(1.0) * stops.len() as f64;
    let index = (along as usize).min(stops.len() - 1);
    let start = if index == 0 {
        &MIDDLE
    } else {
        &stops[index - 1]
    };
    let part = along - index as f64;
    std::array::from_fn(|c| (start[c] + (stops[index][c] - start[c]) * part).round() as u8)
}
