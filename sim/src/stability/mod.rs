//! The hard-case suite: every stage of every named design against exact arithmetic, beside the same in single
//! precision.
//!
//! [`cases`] makes the scenes, [`exact`] the truth in rationals, [`single`] the yardstick in f32, [`table`] the text,
//! [`steps`] what each width of `standard24` buys. [`scenes`] are whole scenes of the kinds that people have.
//!
//! | stage | error, the worst of a case |
//! |---|---|
//! | centre | pixels |
//! | depth | relative |
//! | peak | relative, before it is clamped to 1; peaks of 15 and more count as 15 |
//! | variance | Vxx and Vyy relative, Vxy against sqrt(Vxx Vyy) |
//! | determinant | relative |
//! | form | relative change of r = x^T Q x in its worst direction, whatever the ellipse's shape and size |
//! | r | absolute, over all pixels with r < c, as the traversal's lanes hold it |
//! | picture | absolute, per channel, in units of 1.0, with its mean (bias) and PSNR; pixels on a threshold of the rules apart, see `pictures` |
//! | decisions | pixels on a threshold that were decided otherwise, of all on a threshold |

mod bounds;
mod errors;
mod pictures;
pub mod scenes;
pub mod steps;
pub mod table;

use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::fixed;
pub use crate::reference::{rational as exact, single};
use crate::rules::Rules;
use crate::scene::Splat;
use bounds::ErrorBounds;
pub use splatline_reference::hard::cases;

use cases::Case;
pub use errors::StageErrors;
use errors::{form_error_of_conic, form_error_of_ldl, value, worse};
use exact::RationalFootprint;
use pictures::TruePictures;
use rayon::prelude::*;
use splatline::footprint::{Footprint, depth};
use splatline::format::Traversal;
use splatline::math::Extended;
use splatline::raster::{BoxSpans, EllipseSpans, Spans, Window};

/// One line of the table: an engine in a case.
#[derive(Clone, Debug, serde::Serialize)]
pub struct StabilityLine {
    /// The case.
    pub case: String,
    /// A design's name, or `f32`.
    pub engine: String,
    /// Is the case one of the needles?
    pub needle: bool,
    /// Its errors.
    pub errors: StageErrors,
}

/// Samples of sixteen splats that a case is measured on. Single precision is exact on some splats by luck, since their
/// numbers are its own; over many the luck averages out, and no comparison needs a tolerance.
const SAMPLES: u64 = 16;
/// As many as a test can wait for.
const QUICK_SAMPLES: u64 = 2;

/// Measures all cases: `f32`, then the designs, each by its own traversal; the worst of all samples. The
/// first sample has a stack of 100,000 splats unless it is to be `quick`, all others have a short one.
pub fn measure(designs: &[DesignChoice], quick: bool) -> Vec<StabilityLine> {
    let sampled = |sample| -> Vec<StabilityLine> {
        let cases = cases::all(quick || sample > 0, sample);
        let lines = cases
            .par_iter()
            .flat_map(|case| measure_case(case, designs));
        lines.collect()
    };
    let samples = if quick { QUICK_SAMPLES } else { SAMPLES };
    let samples: Vec<_> = (0..samples).into_par_iter().map(sampled).collect();
    let mut samples = samples.into_iter();
    let mut lines = samples.next().unwrap_or_default();
    for other in samples {
        for (line, other) in lines.iter_mut().zip(other) {
            line.errors.worsen(&other.errors);
        }
    }
    lines
}

fn measure_case(case: &Case, designs: &[DesignChoice]) -> Vec<StabilityLine> {
    let weights = case.scene.weights_for(&case.rules);
    let truth = project_all(case, &weights, exact::project);
    let picture = pictures::exact(case, &truth);
    let line = |engine: &str, errors| StabilityLine {
        case: case.name.clone(),
        engine: engine.to_owned(),
        needle: case.needle,
        errors,
    };
    let mut lines = vec![line("f32", single_errors(case, &weights, &truth, &picture))];
    for design in designs {
        let errors = fixed_errors(case, design, &truth, &picture);
        lines.push(line(&design.name, errors));
    }
    lines
}

/// Projects a splat.
type Project<F> = fn(&Splat, &Camera, &Rules) -> Option<F>;

/// Projects every splat; a splat equal to the one before it is not computed again.
fn project_all<F: Copy>(case: &Case, weights: &[f64], project: Project<F>) -> Vec<Option<F>> {
    let mut projected: Vec<Option<F>> = Vec::with_capacity(weights.len());
    for (index, splat) in case.scene.splats.iter().enumerate() {
        let repeated = index > 0 && case.scene.splats[index - 1] == *splat;
        projected.push(if repeated {
            projected[index - 1]
        } else {
            let weight = weights[index];
            project(&Splat { weight, ..*splat }, &case.camera, &case.rules)
        });
    }
    projected
}

fn single_errors(
    case: &Case,
    weights: &[f64],
    truth: &[Option<RationalFootprint>],
    exact: &TruePictures,
) -> StageErrors {
    let projected = project_all(case, weights, single::project);
    let mut errors = pictures::errors(pictures::single(case, &projected), exact);
    for (single, truth) in projected.iter().zip(truth) {
        let (Some(single), Some(truth)) = (single, truth) else {
            errors.culled_wrongly +=
                usize::from(single.is_some() != (truth.is_some_and(|t| on_screen(case, &t))));
            continue;
        };
        let (centre, variance) = (single.centre.map(f64::from), single.variance.map(f64::from));
        let depth_and_peak = [single.position[2], single.peak].map(f64::from);
        let form = form_error_of_conic(single.conic.map(f64::from), truth);
        errors.worsen_setup(centre, depth_and_peak, variance, form, truth);
        for (x, y) in pixels(case) {
            let r = truth.radial(x, y);
            if r < truth.cutoff {
                let error = (f64::from(single.radial(x as f32, y as f32)) - r).abs();
                errors.radial = worse(errors.radial, error);
            }
        }
    }
    errors
}

fn fixed_errors(
    case: &Case,
    design: &DesignChoice,
    truth: &[Option<RationalFootprint>],
    exact: &TruePictures,
) -> StageErrors {
    let options = fixed::Options::front_to_back(&case.rules, design);
    let drawing = fixed::draw(&case.scene, &case.camera, &options);
    let bounded = design.traversal == Traversal::Spans;
    let normalised = case.rules.normalised;
    let bound = |truth| ErrorBounds::new(&design.widths, truth, &case.camera, normalised);
    let bounded = truth.iter().map(|truth| truth.as_ref().filter(|_| bounded));
    let bounds: Vec<Option<ErrorBounds>> = bounded.map(|truth| truth.map(bound)).collect();
    let share = pictures::share_of_bound(case, &drawing.picture, exact, truth, &bounds);
    let mut errors = pictures::errors(drawing.picture, exact);
    errors.shares[7] = share;
    let variances = fixed::variances(&case.scene, &case.camera, &options);
    let footprints = fixed::footprints(&case.scene, &case.camera, &options);
    let mut last = None;
    let of_design = footprints.iter().zip(variances);
    for ((fixed, variance), (truth, bounds)) in of_design.zip(truth.iter().zip(&bounds)) {
        let (Ok(fixed), Some(truth)) = (fixed, truth) else {
            errors.culled_wrongly +=
                usize::from(fixed.is_ok() != truth.is_some_and(|t| on_screen(case, &t)));
            continue;
        };
        if last == Some(*fixed) {
            continue;
        }
        last = Some(*fixed);
        let variance = variance.unwrap_or_default();
        let Extended { value, exponent } = depth::number(fixed.depth);
        let depth = value as f64 * f64::from(exponent).exp2();
        let mut own = setup_errors(fixed, variance, depth, design, truth);
        if let Some(bounds) = bounds {
            own.compare(bounds);
        }
        errors.worsen(&own);
        worsen_radial(&mut errors, case, design, fixed, truth, bounds.as_ref());
    }
    errors
}

/// The errors of one splat's setup.
fn setup_errors(
    fixed: &Footprint,
    variance: [f64; 4],
    depth: f64,
    design: &DesignChoice,
    truth: &RationalFootprint,
) -> StageErrors {
    let mut errors = StageErrors::default();
    let unit = f64::from(design.widths.subpixel).exp2();
    let centre = fixed.centre.map(|c| c as f64 / unit);
    let peak = f64::from(fixed.opacity) / f64::from(design.widths.peak).exp2();
    let form = match design.traversal {
        Traversal::Spans => form_error_of_ldl(fixed, truth),
        Traversal::Box => {
            let conic = fixed.conic;
            form_error_of_conic(conic.mantissa.map(|m| value(m, conic.exponent)), truth)
        }
    };
    errors.worsen_setup(centre, [depth, peak], variance, form, truth);
    errors
}

/// The radial index in the lanes, at every pixel inside the footprint.
fn worsen_radial(
    errors: &mut StageErrors,
    case: &Case,
    design: &DesignChoice,
    footprint: &Footprint,
    truth: &RationalFootprint,
    bounds: Option<&ErrorBounds>,
) {
    let window = Window {
        first: [0, 0],
        end: [case.camera.width as u16, case.camera.height as u16],
    };
    let widths = design.in_fields();
    let lanes = match design.traversal {
        Traversal::Spans => collect_lanes(EllipseSpans::new(widths, footprint, &window), &window),
        Traversal::Box => collect_lanes(BoxSpans::new(widths, footprint, &window), &window),
    };
    for ((x, y), lane) in pixels(case).zip(lanes) {
        let r = truth.radial(x, y);
        if r >= truth.cutoff {
            continue;
        }
        // A pixel that was not visited counts as one at the end of the footprint.
        let error = (lane.unwrap_or(truth.cutoff) - r).abs();
        errors.radial = errors.radial.max(error);
        if let Some(bounds) = bounds {
            errors.shares[6] = errors.shares[6].max(error / bounds.radial(r));
        }
    }
}

/// The radial index in the lanes, for every pixel of the window; none where the traversal does not go.
fn collect_lanes(mut rows: impl Spans, window: &Window) -> Vec<Option<f64>> {
    use splatline::format::Lane;
    let [columns, lines] = window.end.map(usize::from);
    let mut lanes = vec![None; columns * lines];
    let unit = f64::from(rows.fraction()).exp2();
    while let Some(run) = rows.next_span() {
        let start = usize::from(run.y) * columns + usize::from(run.x);
        for (lane, radial) in lanes[start..].iter_mut().zip(run.radials()) {
            *lane = Some(radial.to_wide() as f64 / unit);
        }
    }
    lanes
}

fn pixels(case: &Case) -> impl Iterator<Item = (f64, f64)> {
    let (width, height) = (case.camera.width, case.camera.height);
    (0..width * height).map(move |i| ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5))
}

fn on_screen(case: &Case, footprint: &RationalFootprint) -> bool {
    pixels(case).any(|(x, y)| footprint.radial(x, y) < footprint.cutoff)
}
