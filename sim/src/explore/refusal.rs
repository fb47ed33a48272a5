//! Questions that no machine of a space can hold, refused before anything is drawn or simulated, with the limit that
//! rules them out.
//!
//! A search over what machines could reach at best (`bounds`) costs a second. If even so a limit is missed, no machine
//! of the space holds it: by its area, by its channels, or by the cycles that counts of splats and pixels alone take.

use super::answer::start;
use super::evaluator::Reached;
use super::limits::{Limit, Quantity, are_held, missed};
use super::search::Search;
use anyhow::Result;
use serde::Serialize;

/// By which part of their bounds limits must be missed together before a question is refused for it: what follows from
/// several fields at once is found by descent, which may end a step short of the best.
const MISSED_TOGETHER: f64 = 0.05;

/// A limit that no machine of the space holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RuledOut {
    /// The limit.
    pub limit: Limit,
    /// The best that any machine could reach.
    pub best: f64,
    /// Limits that it holds meanwhile; none if the limit is out of reach alone.
    pub with: Vec<Limit>,
}

/// What rules a question out; nothing if bounds do not.
pub fn ruled_out(search: &Search) -> Result<Vec<RuledOut>> {
    let by_machine = |limit: &&Limit| !limit.quantity.is_error();
    let limits: Vec<Limit> = search.limits.iter().filter(by_machine).cloned().collect();
    let together = best_of(search, &limits)?;
    if are_held(&limits, &together) {
        return Ok(Vec::new());
    }
    let mut found = Vec::new();
    for limit in &limits {
        let alone = best_of(search, std::slice::from_ref(limit))?;
        found.extend(failing(limit, limit.quantity.of(&alone), 0.0, &[]));
    }
    let is_rate = |limit: &&Limit| limit.quantity == Quantity::FramesPerSecond;
    let fps = limits.iter().find(is_rate);
    let others = limits.iter().filter(|limit| Some(*limit) != fps);
    if let (Some(fps), true) = (fps, found.is_empty()) {
        for limit in others {
            let pair = [fps.clone(), limit.clone()];
            // The rate is held first, so that what is missed is missed by the other.
            let mut by_rate = search.of_bounds(&pair);
            let reached = best_by(&mut by_rate, &|reached| {
                let [rate, other] = [fps, limit].map(|limit| limit.missed_by(reached));
                [rate, other, reached.cost()]
            })?;
            let best = limit.quantity.of(&reached);
            found.extend(failing(limit, best, MISSED_TOGETHER, &pair[..1]));
        }
    }
    if found.is_empty() && missed(&limits, None, &together) > MISSED_TOGETHER {
        for limit in &limits {
            let with: Vec<Limit> = limits.iter().filter(|l| *l != limit).cloned().collect();
            found.extend(failing(limit, limit.quantity.of(&together), 0.0, &with));
        }
    }
    Ok(found)
}

/// The limit, if the best value misses it by more than a part of its bound.
pub fn failing(
    limit: &Limit,
    best: Option<f64>,
    more_than: f64,
    with: &[Limit],
) -> Option<RuledOut> {
    let best = best?;
    (limit.excess(best) > more_than).then(|| RuledOut {
        limit: limit.clone(),
        best,
        with: with.to_vec(),
    })
}

/// What misses these limits least at best.
fn best_of(search: &Search, limits: &[Limit]) -> Result<Reached> {
    let mut bounds = search.of_bounds(limits);
    best_by(&mut bounds, &|reached| {
        [missed(limits, None, reached), reached.cost(), 0.0]
    })
}

fn best_by(bounds: &mut Search, judge: super::search::Judge) -> Result<Reached> {
    let mut at = start(&bounds.evaluator.subject, bounds.space);
    let (widths, _) = bounds.split_axes();
    // The narrowest design is the smallest; what it is worth is not asked here.
    for axis in widths {
        at[axis] = 0;
    }
    let point = bounds.search(at, judge)?;
    let choice = bounds.choice(&point)?;
    bounds.at_best(&choice)
}

/// For people: which limit, its bound, and the best of any machine.
pub fn text(all: &[RuledOut]) -> String {
    let mut text = "refused before any simulation: no machine of the space can hold\n".to_owned();
    for RuledOut { limit, best, with } in all {
        let quantity = limit.quantity;
        let (asked, reached) = if quantity.is_at_least() {
            ("at least", "at most")
        } else {
            ("at most", "at least")
        };
        let by = match quantity {
            Quantity::FramesPerSecond => "by counts of splats, pixels and bytes alone",
            Quantity::MillijoulesPerFrame => "by what must be read, set up and written once",
            Quantity::BytesPerSecond => "by its channels alone",
            quantity if quantity.is_error() => "with every width at its widest",
            _ => "by area alone",
        };
        let other = |l: &Limit| format!("{} {}", l.quantity.show(l.bound), l.quantity.name());
        let mut held = with.iter().map(other).collect::<Vec<_>>().join(", ");
        if !with.is_empty() {
            held = format!(" while it holds {held}");
        }
        text += &format!(
            "  {} ({}): asked for {asked} {}, {reached} {} is possible{held}, {by}\n",
            quantity.name(),
            limit.of,
            quantity.show(limit.bound),
            quantity.show(*best)
        );
    }
    text
}
