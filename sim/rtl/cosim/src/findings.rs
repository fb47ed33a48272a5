//! What a comparison found.

use std::ops::AddAssign;

/// What a comparison found.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// Answers compared: packets, colours, pixels, places of an order.
    pub compared: u64,
    /// The first difference, in words.
    pub first_difference: Option<String>,
    /// Cycles.
    pub cycles: u64,
    /// What else there was, by its name, in the order of the report's columns.
    pub counts: Vec<(&'static str, u64)>,
}

impl Findings {
    /// So many more of this name.
    pub fn count(&mut self, name: &'static str, more: u64) {
        match self.counts.iter_mut().find(|known| known.0 == name) {
            Some((_, count)) => *count += more,
            None => self.counts.push((name, more)),
        }
    }

    /// How many of this name.
    pub fn counted(&self, name: &str) -> u64 {
        let known = self.counts.iter().find(|known| known.0 == name);
        known.map_or(0, |(_, count)| *count)
    }
}

impl AddAssign for Findings {
    fn add_assign(&mut self, other: Findings) {
        self.compared += other.compared;
        self.cycles += other.cycles;
        for (name, more) in other.counts {
            self.count(name, more);
        }
        if self.first_difference.is_none() {
            self.first_difference = other.first_difference;
        }
    }
}
