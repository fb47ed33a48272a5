//! The smallest design within an error budget, and which width was the binding one.
//!
//! Widths interact weakly: each one's rounding adds its own part to the error. So every width is lowered by bisection while the
//! others stand still, in the order of what a bit of it costs; rounds repeat until none can be lowered any more. The result is
//! minimal in the sense that no single width can lose a bit; that is checked, and what each lost bit would cost is reported.
//!
//! Tried and dropped: all widths lowered in step (ends at the one that needs most), and coordinate search by area per error (twice the
//! drawings for designs of the same area).

use crate::design::{DesignChoice, traversal_name};
use crate::metrics::compare;
use crate::picture::Picture;
use anyhow::{Context, Result};
use serde::Serialize;
use splatline::format::{Traversal, WIDTH_RANGES};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Which error must stay within the budget. Colours only, units of 1.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// Largest absolute error.
    Largest,
    /// Root mean square error.
    Rms,
}

/// What is fitted.
pub struct Task<'a> {
    /// Draws by a design, whatever kind of scene it is.
    pub draw: &'a dyn Fn(&DesignChoice) -> Result<Picture>,
    /// The reference's picture.
    pub reference: &'a Picture,
    /// Which error.
    pub metric: Metric,
    /// The budget.
    pub budget: f64,
}

/// Errors of one design.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Fitness {
    /// Largest absolute error.
    pub max_abs: f64,
    /// Root mean square error.
    pub rms: f64,
    /// Mean of fixed minus float.
    pub bias: f64,
}

/// The outcome.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// The design's widths by name.
    pub widths: BTreeMap<&'static str, u8>,
    /// Its errors.
    pub error: Fitness,
    /// Errors with one bit less in one width; a width at its lower limit is left out.
    pub one_bit_less: BTreeMap<&'static str, Fitness>,
    /// The width whose last bit matters most for the budget.
    pub binding: Option<&'static str>,
    /// Pictures drawn.
    pub drawings: usize,
}

/// The order in which widths are lowered: dear bits first (multipliers of setup, rows and lanes, then storage).
const ORDER: [&str; 13] = [
    "mantissa",
    "view",
    "position",
    "peak",
    "weight",
    "transmittance",
    "alpha",
    "accumulator",
    "interpolation",
    "table",
    "radial",
    "colour",
    "subpixel",
];

/// Fits a design, starting from `start`. Nothing if `start` itself misses the budget; then its error is the second part.
pub fn fit(
    task: &Task,
    start: &DesignChoice,
    progress: &dyn Fn(&str),
) -> Result<(Option<Fit>, Fitness)> {
    let mut search = Search {
        task,
        widths: widths_of(start),
        rounding: start.resolved().rounding,
        drawings: 0,
    };
    let mut error = search.error()?;
    if task.metric.of(&error) > task.budget {
        return Ok((None, error));
    }
    loop {
        let before = search.widths.clone();
        for name in ORDER {
            progress(name);
            error = search.lower(name, error)?;
        }
        if search.widths == before {
            break;
        }
    }
    let mut one_bit_less = BTreeMap::new();
    for (name, low, _) in WIDTH_RANGES {
        let width = search.widths[name];
        if width > low {
            progress(name);
            search.widths.insert(name, width - 1);
            one_bit_less.insert(name, search.error()?);
            search.widths.insert(name, width);
        }
    }
    let binding = one_bit_less
        .iter()
        .max_by(|a, b| task.metric.of(a.1).total_cmp(&task.metric.of(b.1)))
        .map(|(name, _)| *name);
    let Search {
        widths, drawings, ..
    } = search;
    Ok((
        Some(Fit {
            widths,
            error,
            one_bit_less,
            binding,
            drawings,
        }),
        error,
    ))
}

impl Metric {
    /// The error that counts.
    pub fn of(self, error: &Fitness) -> f64 {
        match self {
            Metric::Largest => error.max_abs,
            Metric::Rms => error.rms,
        }
    }
}

fn widths_of(design: &DesignChoice) -> BTreeMap<&'static str, u8> {
    WIDTH_RANGES
        .iter()
        .map(|(name, ..)| *name)
        .zip(design.widths.numbers())
        .collect()
}

/// The text of a design file.
pub fn design_toml(
    widths: &BTreeMap<&'static str, u8>,
    rounding: &str,
    traversal: Traversal,
) -> String {
    let traversal = traversal_name(traversal);
    let lines: String = widths
        .iter()
        .map(|(name, bits)| format!("{name} = {bits}\n"))
        .collect();
    format!(
        "base = \"standard24\"\nrounding = \"{rounding}\"\ntraversal = \"{traversal}\"\n{lines}"
    )
}

struct Search<'a> {
    task: &'a Task<'a>,
    widths: BTreeMap<&'static str, u8>,
    rounding: Cow<'static, str>,
    drawings: usize,
}

impl Search<'_> {
    /// The lowest value of one width within the budget, by bisection; gives the error there.
    fn lower(&mut self, name: &'static str, error: Fitness) -> Result<Fitness> {
        let Some((_, lowest, _)) = WIDTH_RANGES.iter().find(|(field, ..)| *field == name) else {
            return Ok(error);
        };
        // Invariant: `good` is within the budget, everything below `bad` is not known to be.
        let (mut good, mut bad, mut at_good) = (self.widths[name], *lowest, error);
        while bad < good {
            let middle = bad + (good - bad) / 2;
            self.widths.insert(name, middle);
            let error = self.error()?;
            if self.task.metric.of(&error) <= self.task.budget {
                (good, at_good) = (middle, error);
            } else {
                bad = middle + 1;
            }
        }
        self.widths.insert(name, good);
        Ok(at_good)
    }

    fn error(&mut self) -> Result<Fitness> {
        let task = self.task;
        let design = DesignChoice::from_toml(
            "fit.toml",
            &design_toml(&self.widths, &self.rounding, Traversal::Spans),
        )?;
        let picture = (task.draw)(&design)?;
        self.drawings += 1;
        let error = compare(&picture, task.reference)
            .context("the pictures cannot be compared")?
            .colour;
        Ok(Fitness {
            max_abs: error.max_abs,
            rms: error.rms(),
            bias: error.bias,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Engine, Entry, Prepared};
    use crate::scene::synthetic;

    #[test]
    fn a_fitted_design_is_within_the_budget_and_minimal() {
        let scene = synthetic::random_gaussians(150, 1, 2.0);
        let (camera, rules) = (synthetic::camera(40, 30), scene.natural_rules);
        let start = DesignChoice::named("standard24").unwrap();
        let prepared = Prepared::of_splats(scene, camera, rules, start.clone());
        let reference = prepared.draw_reference(Engine::Float, &|_, _| ()).unwrap();
        let draw = |design: &DesignChoice| {
            let entry = Entry::new(design.clone(), Some(Traversal::Spans));
            Ok(prepared.draw_fixed(&entry)?.picture)
        };
        let task = Task {
            draw: &draw,
            reference: &reference.picture,
            metric: Metric::Rms,
            budget: 1e-3,
        };
        let (fitted, _) = fit(&task, &start, &|_| ()).unwrap();
        let fitted = fitted.unwrap();
        assert!(fitted.error.rms <= task.budget);
        assert!(
            fitted
                .one_bit_less
                .values()
                .all(|error| error.rms > task.budget),
            "{fitted:?}"
        );
        assert!(fitted.widths["mantissa"] < 24 && fitted.binding.is_some());
        let strict = Task {
            budget: 0.0,
            ..task
        };
        assert_eq!(fit(&strict, &start, &|_| ()).unwrap().0, None);
    }
}
