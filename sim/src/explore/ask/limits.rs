//! What is asked for: lower and upper limits of what a machine with a design reaches.

use serde::Serialize;

/// What can be limited.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
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
    /// Bytes a second that the machine's channels could move: a channel wider than the memory behind it would be a promise of the model alone.
    BytesPerSecond,
    /// PSNR of the colours over all frames, decibels.
    PsnrDb,
    /// Largest error of a colour in any frame.
    LargestError,
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
            Quantity::MillijoulesPerFrame => "mJ a frame",
        }
    }

    /// Is more of it better?
    pub fn is_at_least(self) -> bool {
        matches!(self, Quantity::FramesPerSecond | Quantity::PsnrDb)
    }

    /// Does it follow from the design's pictures alone?
    pub fn is_error(self) -> bool {
        matches!(self, Quantity::PsnrDb | Quantity::LargestError)
    }

    /// The value as people read it.
    pub fn show(self, value: f64) -> String {
        match self {
            Quantity::BytesPerSecond => format!("{:.0}", value / 1e6),
            Quantity::Luts | Quantity::FlipFlops | Quantity::Dsps | Quantity::MemoryKbit => {
                format!("{value:.0}")
            }
            Quantity::LargestError => format!("{value:.3e}"),
            _ => format!("{value:.2}"),
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
        let over = if self.quantity.is_at_least() {
            self.bound - value
        } else {
            value - self.bound
        };
        if over <= 0.0 {
            0.0
        } else if over.is_nan() {
            f64::INFINITY
        } else {
            // A bound of 0 is missed by as much as there is.
            over / if self.bound > 0.0 { self.bound } else { 1.0 }
        }
    }

    /// Which part of the bound is left.
    pub fn slack(&self, value: f64) -> f64 {
        let left = if self.quantity.is_at_least() {
            value - self.bound
        } else {
            self.bound - value
        };
        left / if self.bound > 0.0 { self.bound } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
