//! The smallest design within an error budget, and which width was the binding one.
//!
//! Widths interact weakly: each one's rounding adds its own part to the error. So every width is lowered by bisection while the
//! others stand still, in the order of what a bit of it costs; rounds repeat until none can be lowered any more. The result is
//! minimal in the sense that no single width can lose a bit; that is checked, and what each lost bit would cost is reported.
//!
//! Tried and dropped: all widths lowered in step (ends at the one that needs most), and coordinate search by area per error (twice the
//! drawings for designs of the same area).

use crate::design::{DesignChoice, traversal_name};
use crate::metrics::stored;
use crate::picture::Picture;
use anyhow::{Result, bail};
use rayon::prelude::*;
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
    /// The errors of a design over all that it is fitted to, whatever kind of scenes these are.
    pub measure: &'a dyn Fn(&DesignChoice) -> Result<Fitness>,
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

impl Fitness {
    /// How far the colours of a picture are from the reference's: what [`crate::metrics::compare`] says of them, without structural similarity,
    /// which takes thirty times as long as drawing the picture.
    pub fn of(picture: &Picture, reference: &Picture) -> Result<Fitness> {
        let size = |picture: &Picture| (picture.width, picture.height, picture.pixels.len());
        if size(picture) != size(reference) || picture.pixels.is_empty() {
            bail!("the pictures cannot be compared: their sizes differ or are 0");
        }
        let width = picture.width;
        let rows = picture.pixels.par_chunks(width);
        let sums: Vec<[f64; 3]> = rows
            .zip(reference.pixels.par_chunks(width))
            .map(|(fixed, float)| differences(fixed, float))
            .collect();
        // Row by row in their order, so that the sums do not depend on the threads.
        let [max_abs, squares, signed] = sums.iter().fold([0.0; 3], |all, row| {
            [f64::max(all[0], row[0]), all[1] + row[1], all[2] + row[2]]
        });
        let samples = 3.0 * picture.pixels.len() as f64;
        Ok(Fitness {
            max_abs,
            rms: (squares / samples).sqrt(),
            bias: signed / samples,
        })
    }

    /// Over several pictures: the largest error of any, the root of the mean square and the mean bias.
    pub fn over(all: &[Fitness]) -> Fitness {
        let count = all.len().max(1) as f64;
        let mean = |of: fn(&Fitness) -> f64| all.iter().map(of).sum::<f64>() / count;
        Fitness {
            max_abs: all.iter().map(|one| one.max_abs).fold(0.0, f64::max),
            rms: mean(|one| one.rms * one.rms).sqrt(),
            bias: mean(|one| one.bias),
        }
    }

    /// Peak signal-to-noise ratio, decibels; infinite for equal pictures.
    pub fn psnr_db(&self) -> f64 {
        -20.0 * self.rms.log10()
    }
}

/// Largest, sum of squares and signed sum of the differences of red, green and blue; not a number counts as an infinite error.
fn differences(fixed: &[[f64; 4]], float: &[[f64; 4]]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (fixed, float) in fixed.iter().zip(float) {
        for channel in 0..3 {
            let difference = stored(fixed[channel]) - stored(float[channel]);
            let size = if difference.is_nan() {
                f64::INFINITY
            } else {
                difference.abs()
            };
            sums[0] = f64::max(sums[0], size);
            sums[1] += size * size;
            sums[2] += difference;
        }
    }
    sums
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
pub(super) const LOWERING_ORDER: [&str; 13] = [
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
        for name in LOWERING_ORDER {
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
        self.drawings += 1;
        (task.measure)(&design)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{DesignVariant, Engine, Prepared};
    use crate::scene::synthetic;

    /// Beside the whole comparison, on a picture with large and with tiny errors and one beyond 0 to 1.
    #[test]
    fn quick_errors_are_those_of_the_whole_comparison() {
        let mut float = Picture::new(40, 30);
        let mut fixed = Picture::new(40, 30);
        for (place, (a, b)) in float.pixels.iter_mut().zip(&mut fixed.pixels).enumerate() {
            let value = (place * 37 % 101) as f64 / 90.0;
            *a = [value, value / 2.0, 1.0 - value, 1.0];
            *b = a.map(|value| value + (place % 7) as f64 * 1e-4 - 2e-4);
        }
        fixed.pixels[77] = [0.9; 4];
        let quick = Fitness::of(&fixed, &float).unwrap();
        let whole = crate::metrics::compare(&fixed, &float).unwrap().colour;
        assert_eq!(quick.max_abs, whole.max_abs);
        assert!((quick.rms / whole.rms() - 1.0).abs() < 1e-12);
        assert!((quick.bias - whole.bias).abs() < 1e-15);
        assert!((quick.psnr_db() - whole.psnr_db).abs() < 1e-9);
        assert_eq!(Fitness::of(&float, &float).unwrap(), Fitness::default());
        assert!(Fitness::of(&float, &Picture::new(30, 40)).is_err());
        fixed.pixels[3][0] = f64::NAN;
        assert_eq!(Fitness::of(&fixed, &float).unwrap().max_abs, f64::INFINITY);
    }

    #[test]
    fn errors_over_pictures_are_the_largest_and_the_mean() {
        let one = |max_abs, rms, bias| Fitness { max_abs, rms, bias };
        let over = Fitness::over(&[one(0.1, 3.0, 0.5), one(0.4, 4.0, -0.1)]);
        assert_eq!(over.max_abs, 0.4);
        assert!((over.rms - 12.5f64.sqrt()).abs() < 1e-12 && (over.bias - 0.2).abs() < 1e-12);
    }

    #[test]
    fn a_fitted_design_is_within_the_budget_and_minimal() {
        let scene = synthetic::random_gaussians(150, 1, 2.0);
        let (camera, rules) = (synthetic::camera(40, 30), scene.natural_rules);
        let start = DesignChoice::named("standard24").unwrap();
        let prepared = Prepared::of_splats(scene, camera, rules, start.clone());
        let reference = prepared.draw_reference(Engine::Float, &|_, _| ()).unwrap();
        let measure = |design: &DesignChoice| {
            let entry = DesignVariant::new(design.clone(), Some(Traversal::Spans));
            Fitness::of(&prepared.draw_fixed(&entry)?.picture, &reference.picture)
        };
        let task = Task {
            measure: &measure,
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
