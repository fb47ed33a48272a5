//! The bars of accuracy as tests: on the embedded volume, the deep stack and golden_a, at a size that keeps them quick.
//!
//! `splatline-docs results --only accuracy` prints the same figures at full size on all scenes.

use super::{BARS, TINY_DB};
use crate::pages::accuracy::measure;
use crate::pages::golden::{fixed_conics, tiny};
use crate::views::{BRAIN, DEEP_STACK, View};
use splatline_sim::reference::golden::{GoldenA, archive};
use std::path::Path;

const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/golden");

/// The scenes are no files: nothing is looked for in the folder.
fn check(name: &str) {
    let view = View::load(name, Path::new(""), 160).unwrap();
    let mut judged = 0;
    for measurement in measure(&view).unwrap() {
        let (psnr_db, max_abs, bias) = measurement.worst();
        let got = format!(
            "{name}, {}: {psnr_db:.1} dB, {max_abs:.1e}, {bias:+.1e}",
            measurement.design
        );
        // classic8 has no bar.
        let met = measurement.meets_bars();
        assert_ne!(met, Some(false), "{got}");
        judged += usize::from(met.is_some());
    }
    assert!(judged >= BARS.len(), "{name}: {judged} designs were judged");
}

#[test]
fn the_embedded_volume_meets_them() {
    check(BRAIN);
}

#[test]
fn the_deep_stack_meets_them() {
    check(DEEP_STACK);
}

#[test]
fn conics_of_independent_origin_meet_them() {
    let found = fixed_conics(&GoldenA::load(&archive()).unwrap());
    let met = found
        .iter()
        .filter(|conics| conics.meets_bar() == Some(true));
    assert_eq!(met.count(), 22);
    assert!(
        found.iter().all(|conics| conics.meets_bar() != Some(false)),
        "{found:?}"
    );
}

#[test]
#[cfg_attr(
    not(has_data),
    ignore = "the shared data were not beside the project when this was built"
)]
fn the_picture_of_independent_origin_meets_them() {
    let found = tiny(Path::new(GOLDEN)).unwrap();
    assert!(found.iter().all(|(_, db)| *db >= TINY_DB), "{found:?}");
}
