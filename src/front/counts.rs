//! What became of a scene's splats.

use super::Rejected;
use crate::setup::Cull;

/// Splats by what became of them; every splat counts once. Counts saturate at `u32::MAX`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// On the display list.
    pub drawn: u32,
    /// Left out, by reason, in the order of [`Cull::ALL`].
    pub culled: [u32; Cull::ALL.len()],
    /// Left out because a number is not finite, or a rotation has no direction ([`Rejected::Invalid`]).
    pub invalid: u32,
}

impl Counts {
    /// Splats left out for one reason.
    pub fn culled_for(&self, reason: Cull) -> u32 {
        self.culled.get(reason as usize).copied().unwrap_or(0)
    }

    /// All splats that were looked at.
    pub fn total(&self) -> u32 {
        self.culled
            .iter()
            .fold(self.drawn.saturating_add(self.invalid), |sum, count| {
                sum.saturating_add(*count)
            })
    }

    /// One splat more that is left out.
    #[inline]
    pub(super) fn reject(&mut self, reason: Rejected) {
        let count = match reason {
            Rejected::Culled(cull) => self.culled.get_mut(cull as usize),
            Rejected::Invalid => Some(&mut self.invalid),
        };
        if let Some(count) = count {
            *count = count.saturating_add(1);
        }
    }
}

impl core::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.drawn = self.drawn.saturating_add(other.drawn);
        self.invalid = self.invalid.saturating_add(other.invalid);
        for (sum, count) in self.culled.iter_mut().zip(other.culled) {
            *sum = sum.saturating_add(count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The array's order is that of the variants.
    #[test]
    fn every_reason_has_its_place() {
        for (place, reason) in Cull::ALL.into_iter().enumerate() {
            let mut counts = Counts::default();
            counts.reject(Rejected::Culled(reason));
            assert_eq!(counts.culled[place], 1);
            assert_eq!((counts.culled_for(reason), counts.total()), (1, 1));
            let others = Cull::ALL.into_iter().filter(|other| *other != reason);
            assert!(others.map(|other| counts.culled_for(other)).all(|n| n == 0));
            counts.drawn = 3;
            counts += counts;
            assert_eq!((counts.drawn, counts.culled[place]), (6, 2));
        }
        let mut counts = Counts::default();
        counts.reject(Rejected::Invalid);
        counts += counts;
        assert_eq!((counts.invalid, counts.total()), (2, 2));
    }
}
