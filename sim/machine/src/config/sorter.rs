//! Which machines can sort splats before they are binned.

use super::fields::field;
use super::{Binning, Config, Sorter};

impl Config {
    /// What can be sorted before it is binned.
    pub(super) fn check_sorter(&self) -> Result<(), (&'static str, String, String)> {
        if self.sorter == Sorter::Passes {
            return Ok(());
        }
        let wrong = if self.sorted_bytes() < 10 {
            Some("allowed with a sort_bytes of 10 or more: a key has 48 bits, a splat's number 32")
        } else if self.binning == Binning::Exact {
            Some("allowed with binning = \"box\": tiles are counted before anything is traversed")
        } else if self.sort_every > 1 {
            Some("allowed with a sort_every of 1: kept lists are sorted by their entries")
        } else if self.memory_part > 0 {
            Some("allowed with memory_part = \"channels\": their writes on a part are not modelled")
        } else {
            None
        };
        let sorter = || field("sorter").map_or_else(String::new, |field| field.show(self));
        wrong.map_or(Ok(()), |allowed| {
            Err(("sorter", format!("\"{}\"", sorter()), allowed.to_owned()))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_sorted_before_it_is_binned_is_refused_by_name() {
        for (words, printed) in [
            ("sort_bytes=8", "sort_bytes of 10 or more"),
            ("binning=exact", "binning = \"box\""),
            ("memory_part=ddr3-1600-x16", "memory_part = \"channels\""),
        ] {
            for sorter in ["radix", "merge"] {
                let mut config = Config {
                    clock_mhz: 100,
                    ..Config::machine(4)
                };
                let words = [format!("sorter={sorter}"), words.to_owned()];
                let error = config.set_words(&words).unwrap_err().to_string();
                let sorter = format!("sorter = \"{sorter}\"");
                assert!(
                    error.contains(&sorter) && error.contains(printed),
                    "{error}"
                );
            }
        }
        assert_eq!(Config::named("machine-4"), Some(Config::machine(4)));
        assert_eq!(Config::named("machine-3"), None);
    }
}
