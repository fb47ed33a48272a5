//! The gallery: every splat of the papers in a scene that shows it, with its error in numbers.

pub mod kernels;
pub mod page;

use crate::picture::Picture;

/// One system of the papers at work.
#[derive(Clone, Debug, PartialEq)]
pub struct Exhibit {
    /// Short name, fit for a file name.
    pub name: String,
    /// Where its equation stands.
    pub equation: &'static str,
    /// What is seen, and how it was made.
    pub caption: String,
    /// Pictures with their names.
    pub pictures: Vec<(String, Picture)>,
    /// Measurements: what, how much, and the unit.
    pub numbers: Vec<(String, f64, String)>,
}
