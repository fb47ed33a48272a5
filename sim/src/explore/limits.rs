//! What is asked for: lower and upper limits of what a machine with a design reaches.

use super::evaluator::{DesignError, Reached};
use serde::{Deserialize, Serialize};

/// What can be limited.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Pictures a second, of the slowest frame.
    FramesPerSecond,
    /// Look-up tables.
    Luts,
    /// Flip-flops.
    FlipFlops,
    /// Multipliers.
    Dsps,
    /// Kilobits of block memory.
    MemoryKbit,
    /// Bytes a second that the machine's channels could move: a channel wider than the memory behind it would be a
    /// promise of the model alone.
    BytesPerSecond,
    /// PSNR of the colours over all frames, decibels.
    PsnrDb,
    /// Largest error of a colour in any frame.
    LargestError,
    /// Root mean square error of the colours over all frames.
    RmsError,
    /// Error that 99 % of the samples of colours do not exceed, in the worst frame.
    Percentile99,
    /// Mean FLIP of the worst frame.
    Flip,
    /// Millijoules a frame.
    MillijoulesPerFrame,
}

/// A limit, and where it comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Limit {
    /// Of what.
    pub quantity: Quantity,
    /// Its value: at least this for rates and PSNR, at most this for all else.
    pub bound: f64,
    /// The option or the part that it comes from.
    pub of: String,
}

impl Quantity {
    /// In words, with the unit.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::FramesPerSecond => "frames a second",
            Quantity::Luts => "LUT",
            Quantity::FlipFlops => "FF",
            Quantity::Dsps => "DSP",
            Quantity::MemoryKbit => "block memory, kbit",
            Quantity::BytesPerSecond => "channels, MB a second",
            Quantity::PsnrDb => "PSNR, dB",
            Quantity::LargestError => "largest error",
            Quantity::RmsError => "rms error",
            Quantity::Percentile99 => "99th percentile of errors",
            Quantity::Flip => "FLIP",
            Quantity::MillijoulesPerFrame => "mJ a frame",
        }
    }

    /// Is more of it better?
    pub fn is_at_least(self) -> bool {
        matches!(self, Quantity::FramesPerSecond | Quantity::PsnrDb)
    }

    /// Does it follow from the design's pictures alone?
    pub fn is_error(self) -> bool {
        self.of_error(&DesignError::none()).is_some()
    }

    /// Is it an error that takes longer to measure than to draw?
    pub fn is_detail(self) -> bool {
        matches!(self, Quantity::Percentile99 | Quantity::Flip)
    }

    /// The value of an error.
    pub fn of_error(self, error: &DesignError) -> Option<f64> {
        match self {
            Quantity::PsnrDb => Some(error.psnr_db()),
            Quantity::LargestError => Some(error.max_abs),
            Quantity::RmsError => Some(error.rms),
            Quantity::Percentile99 => Some(error.detail?.percentiles.p99),
            Quantity::Flip => Some(error.detail?.flip),
            _ => None,
        }
    }

    /// The value that is reached; nothing if it was not measured.
    pub fn of(self, reached: &Reached) -> Option<f64> {
        let all = reached.area.raster + reached.area.around;
        Some(match self {
            Quantity::FramesPerSecond => reached.pace.frames_per_s,
            Quantity::Luts => all.luts as f64,
            Quantity::FlipFlops => all.flip_flops as f64,
            Quantity::Dsps => all.dsps as f64,
            Quantity::MemoryKbit => all.memory_kbit as f64,
            Quantity::BytesPerSecond => reached.pace.channel_bytes_per_s,
            Quantity::MillijoulesPerFrame => reached.millijoules,
            _ => self.of_error(reached.error.as_ref()?)?,
        })
    }

    /// The value as people read it.
    pub fn show(self, value: f64) -> String {
        let in_millions = self == Quantity::BytesPerSecond;
        let value = if in_millions { value / 1e6 } else { value };
        match self {
            _ if value.abs() >= 1e15 => format!("{value:.3e}"),
            Quantity::FramesPerSecond | Quantity::PsnrDb | Quantity::MillijoulesPerFrame => {
                format!("{value:.2}")
            }
            _ if self.is_error() => format!("{value:.3e}"),
            _ => format!("{value:.0}"),
        }
    }
}

impl Limit {
    /// A limit that an option or a part sets.
    pub fn new(quantity: Quantity, bound: f64, of: &str) -> Limit {
        Limit {
            quantity,
            bound,
            of: of.to_owned(),
        }
    }

    /// By which part of the bound it is missed; 0 if it is held. What is no number misses it without measure.
    pub fn excess(&self, value: f64) -> f64 {
        match -self.slack(value) {
            over if over.is_nan() => f64::INFINITY,
            over if over > 0.0 => over,
            _ => 0.0,
        }
    }

    /// By which part of the bound a point misses it; what was not measured misses it without measure.
    pub fn missed_by(&self, reached: &Reached) -> f64 {
        self.excess(self.quantity.of(reached).unwrap_or(f64::NAN))
    }

    /// The same of a design's errors.
    pub fn excess_of_error(&self, error: Option<DesignError>) -> f64 {
        let value = error.and_then(|error| self.quantity.of_error(&error));
        self.excess(value.unwrap_or(f64::NAN))
    }

    /// Which part of the bound is left.
    pub fn slack(&self, value: f64) -> f64 {
        let left = if self.quantity.is_at_least() {
            value - self.bound
        } else {
            self.bound - value
        };
        // A bound of 0 is missed by as much as there is.
        left / if self.bound > 0.0 { self.bound } else { 1.0 }
    }
}

/// Does a point hold all limits?
pub fn are_held(limits: &[Limit], reached: &Reached) -> bool {
    missed(limits, None, reached) <= 0.0
}

/// By how much all limits are missed, in sum, `but` one if it names one.
pub fn missed(limits: &[Limit], but: Option<usize>, reached: &Reached) -> f64 {
    let all = limits.iter().enumerate();
    let counted = all.filter(|(place, _)| Some(*place) != but);
    counted.map(|(_, limit)| limit.missed_by(reached)).sum()
}

/// Limits from a bandwidth, a part and so on are upper ones of the same quantity: the tighter holds.
pub fn tightest(limits: Vec<Limit>) -> Vec<Limit> {
    let mut all: Vec<Limit> = Vec::new();
    for limit in limits {
        let mut others = all.iter_mut();
        match others.find(|other| other.quantity == limit.quantity) {
            Some(other) if limit.excess(other.bound) > 0.0 => *other = limit,
            Some(_) => {}
            None => all.push(limit),
        }
    }
    all
}

/// The limits that a part sets.
pub fn limits_of_part(name: &str, part: &crate::machine::parts::Part) -> Vec<Limit> {
    let limit = |quantity, bound: u64| Limit::new(quantity, bound as f64, name);
    vec![
        limit(Quantity::Luts, part.luts),
        limit(Quantity::FlipFlops, part.flip_flops),
        limit(Quantity::Dsps, part.dsps),
        limit(Quantity::MemoryKbit, part.memory_kbit),
        limit(Quantity::BytesPerSecond, part.megabytes_per_s * 1_000_000),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_size_are_read_at_a_glance() {
        let fps = |value: f64| Quantity::FramesPerSecond.show(value);
        assert_eq!(fps(59.941), "59.94");
        assert_eq!(fps(1e308), "1.000e308");
    }

    #[test]
    fn rates_are_lower_limits_and_the_rest_upper_ones() {
        let fps = Limit::new(Quantity::FramesPerSecond, 60.0, "test");
        assert_eq!((fps.excess(60.0), fps.excess(90.0)), (0.0, 0.0));
        assert!((fps.excess(45.0) - 0.25).abs() < 1e-12 && (fps.slack(66.0) - 0.1).abs() < 1e-12);
        let luts = Limit::new(Quantity::Luts, 1000.0, "test");
        assert_eq!(luts.excess(1000.0), 0.0);
        assert!(
            (luts.excess(1100.0) - 0.1).abs() < 1e-12 && (luts.slack(900.0) - 0.1).abs() < 1e-12
        );
        assert_eq!(Limit::new(Quantity::Dsps, 0.0, "test").excess(3.0), 3.0);
        assert_eq!(luts.excess(f64::NAN), f64::INFINITY);
        let exact = Limit::new(Quantity::PsnrDb, 60.0, "test");
        assert_eq!(exact.excess(f64::INFINITY), 0.0);
    }
}
