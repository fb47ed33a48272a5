//! The gallery: scenes that show each system, with its error in numbers beside the pictures.

pub mod command;
pub mod deep;
pub mod holes;
pub mod kernels;
pub mod page;
pub mod sheet;
pub mod surface;
pub mod texture;

use splatline_sim::metrics::ChannelError;
use splatline_sim::picture::Picture;

/// One system on show.
#[derive(Clone, Debug, PartialEq)]
pub struct Exhibit {
    /// What is shown.
    pub name: String,
    /// Where it comes from.
    pub equation: &'static str,
    /// What to see.
    pub caption: String,
    /// Pictures with the stems of their files.
    pub pictures: Vec<(String, Picture)>,
    /// Name, value and unit.
    pub numbers: Vec<(String, f64, String)>,
}

impl Exhibit {
    /// Adds the same part of every picture so far, where whole pictures look alike: the sheet magnifies what is small.
    pub fn insets(&mut self, first: [usize; 2], size: [usize; 2]) {
        let inset = |(name, picture): &(String, Picture)| {
            (format!("{name}, part"), sheet::part(picture, first, size))
        };
        let insets: Vec<_> = self.pictures.iter().map(inset).collect();
        self.pictures.extend(insets);
    }

    /// Adds a number.
    pub fn number(&mut self, name: impl Into<String>, value: f64, unit: &str) {
        self.numbers.push((name.into(), value, unit.to_owned()));
    }

    /// Adds PSNR, largest error and bias of one comparison.
    pub fn errors(&mut self, what: &str, error: &ChannelError) {
        self.number(format!("{what}: PSNR"), error.psnr_db, "dB");
        self.number(format!("{what}: largest error"), error.max_abs, "");
        self.number(format!("{what}: bias"), error.bias, "");
    }
}
