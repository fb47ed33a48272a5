//! The smallest design within a limit on its error, and which width was the binding one: a search over widths alone.
//!
//! The result is minimal in the sense that no single width can lose a bit; that is checked, and what each lost bit
//! would cost is reported.
//!
//! Tried and dropped: all widths lowered in step (ends at the one that needs most), and coordinate search by area per
//! error (twice the drawings for designs of the same area).

use super::evaluator::{DesignError, Evaluator};
use super::formats::{FormatRow, beside_design};
use super::limits::Limit;
use super::search::Search;
use super::space::Space;
use crate::design::ResolvedDesign;
use anyhow::{Context, Result};
use serde::Serialize;
use splatline::format::WIDTH_RANGES;
use std::collections::BTreeMap;

/// The outcome.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// The design.
    #[serde(skip)]
    pub design: ResolvedDesign,
    /// Its widths by name.
    pub widths: BTreeMap<&'static str, u8>,
    /// Its errors.
    pub error: DesignError,
    /// Errors with one bit less in one width; a width at its lower limit is left out.
    pub one_bit_less: BTreeMap<String, DesignError>,
    /// The width whose last bit matters most for the limits.
    pub binding: Option<String>,
    /// Designs drawn.
    pub drawings: usize,
    /// Floating-point formats beside it, if they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub formats: Vec<FormatRow>,
}

/// Fits a design, starting from the subject's. Nothing if that itself misses a limit; then its error is the second
/// part.
pub fn fit(
    evaluator: &mut Evaluator,
    limits: &[Limit],
    progress: &(dyn Fn(&str) + Sync),
) -> Result<(Option<Fit>, DesignError)> {
    let mut text = "[design]\n".to_owned();
    let widths = evaluator.subject.design.widths;
    for (&(name, mut low, _), bits) in WIDTH_RANGES.iter().zip(widths.numbers()) {
        if name == "radial" {
            // Lower, the table that it begins with is refused.
            low = low.max(widths.table.saturating_sub(2));
        }
        text += &format!("{name} = {{ from = {low}, to = {bits} }}\n");
    }
    let space = Space::without_points("the design's widths", &text)?;
    let frames = (0..evaluator.subject.frames.len()).collect();
    let mut search = Search::new(evaluator, &space, limits, frames, progress);

    let last = space.axes.iter().map(|axis| axis.values.len() - 1);
    let start: Vec<usize> = last.collect();
    let errors = |search: &mut Search, point: &[usize]| {
        let error = search.error(point)?;
        error.context("the references are drawn")
    };
    let error = errors(&mut search, &start)?;
    let excess = |error: &DesignError| {
        let all = limits.iter();
        all.fold(0.0, |most, limit| {
            limit.excess_of_error(Some(*error)).max(most)
        })
    };
    if excess(&error) > 0.0 {
        return Ok((None, error));
    }
    let (axes, _) = search.split_axes();
    let point = search.lower_widths(start, &axes, false)?;
    let error = errors(&mut search, &point)?;
    let mut one_bit_less = BTreeMap::new();
    for (place, axis) in space.axes.iter().enumerate() {
        let mut less = point.clone();
        if less[place] > 0 {
            less[place] -= 1;
            one_bit_less.insert(axis.key.clone(), errors(&mut search, &less)?);
        }
    }
    let less = one_bit_less.iter();
    let binding = less.max_by(|a, b| excess(a.1).total_cmp(&excess(b.1)));
    let binding = binding.map(|(name, _)| name.clone());
    let fitted = search.choice(&point)?.variant;
    let drawings = search.designs();
    let formats = match evaluator.subject.formats[..] {
        [] => Vec::new(),
        _ => beside_design(evaluator, &fitted, limits)?,
    };
    let mut design = fitted.design;
    design.traversal = fitted.traversal;
    let names = WIDTH_RANGES.map(|(name, ..)| name);
    let fitted = Fit {
        design: design.resolved(),
        widths: names.into_iter().zip(design.widths.numbers()).collect(),
        error,
        one_bit_less,
        binding,
        drawings,
        formats,
    };
    Ok((Some(fitted), error))
}

/// Why a search does not begin: which limits its start misses itself.
pub fn refusal(design: &str, limits: &[Limit], error: &DesignError) -> String {
    let missed = limits
        .iter()
        .filter(|limit| limit.excess_of_error(Some(*error)) > 0.0)
        .map(|limit| {
            let found = limit.quantity.of_error(error).unwrap_or_default();
            let [found, bound] = [found, limit.bound].map(|value| limit.quantity.show(value));
            let missed = if limit.quantity.is_at_least() {
                "below"
            } else {
                "above"
            };
            format!(
                "{} {found}, {missed} {} {bound}",
                limit.quantity.name(),
                limit.of
            )
        });
    let missed = missed.collect::<Vec<_>>().join(" and ");
    format!("design {design} itself has {missed}: start from a wider design or allow more")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explore::answer::tests::subject;
    use crate::explore::limits::Quantity;

    #[test]
    fn a_fitted_design_is_within_the_budget_and_minimal() {
        let mut evaluator = Evaluator::new(subject(&[1.0]), false);
        let limit = |bound| [Limit::new(Quantity::RmsError, bound, "test")];
        let (fitted, _) = fit(&mut evaluator, &limit(1e-3), &|_| ()).unwrap();
        let fitted = fitted.unwrap();
        assert!(fitted.error.rms <= 1e-3);
        let mut less = fitted.one_bit_less.values();
        assert!(less.all(|error| error.rms > 1e-3), "{fitted:?}");
        assert!(fitted.widths["mantissa"] < 24 && fitted.binding.is_some());
        let refused = fit(&mut evaluator, &limit(0.0), &|_| ()).unwrap();
        assert_eq!(refused.0, None);
    }
}
