//! The row unit's roots against the kernel's, one by one.
//!
//! The spans' slack hides the last bits of a root from every pixel, so that the words of the tile buffer cannot show a wrong rounding.

use crate::model::Outputs;
use splatline::math::root_seed;
use std::collections::VecDeque;

/// Arguments on their way through the unit, and the first root that is not the kernel's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Roots {
    under_way: VecDeque<u64>,
    /// Roots compared.
    pub compared: u64,
    /// The first difference, in words.
    pub first_difference: Option<String>,
}

impl Roots {
    /// Notes what the circuit's outputs of a cycle say.
    pub fn note(&mut self, out: &Outputs) {
        if out.root_valid == 1
            && let Some(squared) = self.under_way.pop_front()
        {
            self.compared += 1;
            let expected = root_seed(squared).0;
            if expected != out.root && self.first_difference.is_none() {
                self.first_difference = Some(format!(
                    "root of {squared:#x}: the kernel has {expected:#x}, the row unit {:#x}",
                    out.root
                ));
            }
        }
        if out.squared_valid == 1 {
            self.under_way.push_back(out.squared);
        }
    }
}
