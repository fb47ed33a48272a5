//! The scene as report.json states it.

use crate::scene::{Scene, SortOrder};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Counts by reason, in alphabetical order so that reports can be compared line by line.
pub type ReasonCounts = BTreeMap<String, u64>;

/// Counts by these reasons.
pub fn counted<'a>(reasons: impl IntoIterator<Item = (&'a str, usize)>) -> ReasonCounts {
    let reasons = reasons.into_iter();
    let named = reasons.map(|(reason, count)| (reason.to_owned(), count as u64));
    named.collect()
}

/// What was drawn and what was left out.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneFacts {
    /// File name without folders.
    pub name: String,
    pub splats: u64,
    /// Records that the loader left out, by reason.
    pub skipped: ReasonCounts,
    /// Splats that this camera does not show, by reason.
    pub culled: ReasonCounts,
    /// Splats of which a coordinate or colour is not finite and counts as 0; they are drawn.
    pub clamped: u64,
    /// Unit of the kernel's colours as a power of two: colours beyond its format were divided by it, and the picture
    /// was multiplied by it.
    pub colour_log2: i32,
    /// What its splats were sorted by; not written if it is the usual, the depth.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub order: SortOrder,
}

fn is_usual(order: &SortOrder) -> bool {
    *order == SortOrder::default()
}

impl SceneFacts {
    /// The scene's own facts and the engine's counts.
    pub fn new(scene: &Scene, culled: ReasonCounts, clamped: u64, colour_log2: i32) -> Self {
        let skipped = serde_json::to_value(scene.skipped)
            .and_then(serde_json::from_value)
            .unwrap_or_default();
        SceneFacts {
            name: scene.name.clone(),
            splats: scene.splats.len() as u64,
            skipped,
            culled,
            clamped,
            colour_log2,
            order: scene.order,
        }
    }
}

/// `near 3, outside 4`.
pub fn named(counts: &ReasonCounts) -> String {
    let counts = counts.iter().filter(|(_, count)| **count > 0);
    let named: Vec<String> = counts
        .map(|(reason, count)| format!("{reason} {count}"))
        .collect();
    named.join(", ")
}

/// ` (near 3, outside 4)`.
pub fn reasons(counts: &ReasonCounts) -> String {
    format!(" ({})", named(counts))
}

/// Reasons for culling that are a matter of the kernel's ranges and not of the view.
const BEYOND_RANGE: [(&str, &str); 2] = [
    (
        "out_of_range",
        "culled because they lie or reach too far off the screen",
    ),
    (
        "degenerate",
        "culled because their footprint has no area in the kernel's formats",
    ),
];

impl SceneFacts {
    /// Splats that are left to draw.
    pub fn shown(&self) -> u64 {
        self.splats.saturating_sub(self.culled.values().sum())
    }

    /// Says that the picture is empty because nothing is left to draw; nothing if something is.
    pub fn if_nothing_is_left(&self) -> Option<String> {
        let all = self.splats;
        match self.shown() {
            _ if all == 0 => Some(self.empty("the scene has no splats")),
            0 => Some(self.empty(&format!(
                "all {all} splats are culled{}",
                reasons(&self.culled)
            ))),
            _ => None,
        }
    }

    /// Says why the picture is empty.
    pub fn empty(&self, why: &str) -> String {
        format!("{}: the picture is empty: {why}", self.name)
    }

    /// What was not drawn as it was given, in one line after those that are known already: what was clamped, rescaled,
    /// and culled for range.
    /// Splats that the view simply does not show are no matter for a warning.
    pub fn warnings(&self, known: &[String]) -> Vec<String> {
        let clamped = (
            self.clamped,
            "have a number that is not finite and count as 0 there",
        );
        let culled = BEYOND_RANGE.map(|(reason, words)| {
            let count = self.culled.get(reason).copied().unwrap_or(0);
            (count, words)
        });
        let parts: Vec<String> = std::iter::once(clamped)
            .chain(culled)
            .filter(|(count, _)| *count > 0)
            .map(|(count, words)| format!("{count} {words}"))
            .collect();
        let mut lines = known.to_vec();
        if self.colour_log2 != 0 {
            let (name, unit) = (&self.name, f64::from(self.colour_log2).exp2());
            lines.push(format!(
                "{name}: colours exceed the kernel's format; they were divided by {unit} and the picture multiplied by it"
            ));
        }
        if !parts.is_empty() {
            let (name, splats) = (&self.name, self.splats);
            lines.push(format!("{name}: of {splats} splats {}", parts.join(", ")));
        }
        lines
    }
}
