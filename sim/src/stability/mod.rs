//! The hard-case suite: every stage of every named design against exact arithmetic, beside the same in single precision.
//!
//! [`cases`] makes the scenes, [`exact`] the truth in rationals, [`single`] the yardstick in f32, [`table`] the text,
//! [`repairs`] the width to blame where a design falls short of the yardstick.
//!
//! | stage | error, the worst of a case |
//! |---|---|
//! | centre | pixels |
//! | depth | relative |
//! | peak | relative, before any clamping |
//! | form | relative change of r = x^T Q x in its worst direction, whatever the ellipse's shape and size |
//! | r | absolute, over all pixels with r < c, as the traversal's lanes hold it |
//! | picture | absolute, per channel, in units of 1.0; with its mean (bias) and PSNR |

pub mod cases;
pub mod exact;
pub mod repairs;
pub mod single;
pub mod table;

use crate::design::{DesignChoice, DesignJob};
use crate::fixed;
use crate::metrics;
use crate::picture::Picture;
use crate::rules::Compositing;
use cases::Case;
use exact::ExactFootprint;
use single::SingleFootprint;
use splatline::footprint::Footprint;
use splatline::format::{Design, Traversal};
use splatline::math::Scaled;
use splatline::raster::{ConicRows, Rows, SpanRows, Window};

/// Worst errors of one engine in one case.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct StageErrors {
    /// Centre, pixels.
    pub centre: f64,
    /// Depth, relative.
    pub depth: f64,
    /// Opacity at r = 0, relative.
    pub peak: f64,
    /// Quadratic form, relative, in its worst direction.
    pub form: f64,
    /// Quadratic form in units of its bound's shape: form / (u (1 + G)), see `docs/error-analysis.md`.
    pub form_units: f64,
    /// Radial index, absolute.
    pub radial: f64,
    /// Picture, largest absolute difference.
    pub picture: f64,
    /// Picture, mean of the differences of colours.
    pub bias: f64,
    /// Picture, decibels; none if no sample differs.
    pub psnr_db: Option<f64>,
    /// Splats that this engine culls although they are visible, or draws although they are not.
    pub culled_wrongly: usize,
}

/// One line of the table: an engine in a case.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Line {
    /// The case.
    pub case: String,
    /// A design's name, or `f32`.
    pub engine: String,
    /// Is the case one of the needles?
    pub needle: bool,
    /// Its errors.
    pub errors: StageErrors,
}

/// Measures all cases: `f32`, then the named designs, each by its own traversal.
pub fn measure(quick: bool) -> Vec<Line> {
    cases::all(quick).iter().flat_map(measure_case).collect()
}

fn measure_case(case: &Case) -> Vec<Line> {
    let weights = case.scene.weights_for(&case.rules);
    let truth = project_all(case, &weights, exact::project);
    let picture = exact_picture(case, &truth);
    let line = |engine: &str, errors| Line {
        case: case.name.clone(),
        engine: engine.to_owned(),
        needle: case.needle,
        errors,
    };
    let mut lines = vec![line("f32", single_errors(case, &weights, &truth, &picture))];
    for design in DesignChoice::all() {
        lines.push(line(
            &design.name,
            fixed_errors(case, &design, &truth, &picture),
        ));
    }
    lines
}

/// Projects every splat; a splat equal to the one before it is not computed again.
fn project_all<F: Copy>(
    case: &Case,
    weights: &[f64],
    project: impl Fn(
        &crate::scene::Splat,
        f64,
        &crate::camera::Camera,
        &crate::rules::Rules,
    ) -> Option<F>,
) -> Vec<Option<F>> {
    let mut projected: Vec<Option<F>> = Vec::with_capacity(weights.len());
    for (index, splat) in case.scene.splats.iter().enumerate() {
        let repeated = index > 0 && case.scene.splats[index - 1] == *splat;
        projected.push(match repeated {
            true => projected[index - 1],
            false => project(splat, weights[index], &case.camera, &case.rules),
        });
    }
    projected
}

fn single_errors(
    case: &Case,
    weights: &[f64],
    truth: &[Option<ExactFootprint>],
    exact: &Picture,
) -> StageErrors {
    let projected = project_all(case, weights, single::project);
    let mut errors = picture_errors(&single_picture(case, &projected), exact);
    for (single, truth) in projected.iter().zip(truth) {
        let (Some(single), Some(truth)) = (single, truth) else {
            errors.culled_wrongly +=
                usize::from(single.is_some() != (truth.is_some_and(|t| on_screen(case, &t))));
            continue;
        };
        errors.worsen_centre(single.centre.map(f64::from), truth);
        errors.worsen_depth_and_peak(single.depth.into(), single.peak.into(), truth);
        errors.worsen_form(
            form_error_of_conic(single.conic.map(f64::from), truth),
            24,
            truth,
        );
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
    truth: &[Option<ExactFootprint>],
    exact: &Picture,
) -> StageErrors {
    let options = fixed::Options {
        rules: &case.rules,
        compositing: Compositing::FrontToBack,
        design,
        traversal: design.traversal,
    };
    let drawing = fixed::draw(&case.scene, &case.camera, &options);
    let mut errors = picture_errors(&drawing.picture, exact);
    let quantised = fixed::QuantisedScene::new(&case.scene, &case.camera, &case.rules);
    let depth_unit = value(1, -23 - quantised.scale_log2);
    let mut last = None;
    for (fixed, truth) in fixed::footprints(&case.scene, &case.camera, &options)
        .iter()
        .zip(truth)
    {
        let (Ok(fixed), Some(truth)) = (fixed, truth) else {
            errors.culled_wrongly +=
                usize::from(fixed.is_ok() != truth.is_some_and(|t| on_screen(case, &t)));
            continue;
        };
        if last == Some(*fixed) {
            continue;
        }
        last = Some(*fixed);
        let unit = f64::from(design.widths.subpixel).exp2();
        errors.worsen_centre(fixed.centre.map(|c| c as f64 / unit), truth);
        let peak = f64::from(fixed.peak) / f64::from(design.widths.peak).exp2();
        errors.worsen_depth_and_peak(f64::from(fixed.depth) * depth_unit, peak, truth);
        let form = match design.traversal {
            Traversal::Spans => form_error_of_scan(fixed, truth),
            Traversal::Box => form_error_of_conic(
                fixed.conic.mantissa.map(|m| value(m, fixed.conic.exponent)),
                truth,
            ),
        };
        errors.worsen_form(form, design.widths.mantissa, truth);
        let window = Window {
            first: [0, 0],
            last: [case.camera.width as u16, case.camera.height as u16],
        };
        let lanes = design.dispatch(Lanes {
            footprint: fixed,
            window,
            traversal: design.traversal,
        });
        for ((x, y), lane) in pixels(case).zip(lanes) {
            let r = truth.radial(x, y);
            if r < truth.cutoff {
                // A pixel that was not visited counts as one at the end of the footprint.
                errors.radial = errors.radial.max((lane.unwrap_or(truth.cutoff) - r).abs());
            }
        }
    }
    errors
}

/// The radial index in the lanes, for every pixel of the window; none where the traversal does not go.
struct Lanes<'a> {
    footprint: &'a Footprint,
    window: Window,
    traversal: Traversal,
}

impl DesignJob for Lanes<'_> {
    type Output = Vec<Option<f64>>;

    fn run<D: Design + Send + Sync>(self, design: D) -> Self::Output {
        match self.traversal {
            Traversal::Spans => self.collect(SpanRows::new(design, self.footprint, &self.window)),
            Traversal::Box => self.collect(ConicRows::new(design, self.footprint, &self.window)),
        }
    }
}

impl Lanes<'_> {
    fn collect(&self, mut rows: impl Rows) -> Vec<Option<f64>> {
        use splatline::format::Lane;
        let [columns, lines] = self.window.last.map(usize::from);
        let mut lanes = vec![None; columns * lines];
        let unit = f64::from(rows.fraction()).exp2();
        while let Some(run) = rows.next_run() {
            let start = usize::from(run.y) * columns + usize::from(run.x);
            for (lane, radial) in lanes[start..].iter_mut().zip(run.radials()) {
                *lane = Some(radial.to_wide() as f64 / unit);
            }
        }
        lanes
    }
}

fn value(mantissa: i32, exponent: i32) -> f64 {
    f64::from(mantissa) * f64::from(exponent).exp2()
}

impl StageErrors {
    fn worsen_centre(&mut self, centre: [f64; 2], truth: &ExactFootprint) {
        for (got, expected) in centre.iter().zip(truth.centre) {
            self.centre = worse(self.centre, (got - expected).abs());
        }
    }

    fn worsen_depth_and_peak(&mut self, depth: f64, peak: f64, truth: &ExactFootprint) {
        self.depth = worse(self.depth, (depth / truth.depth - 1.0).abs());
        self.peak = worse(self.peak, (peak / truth.peak - 1.0).abs());
    }

    /// u = 2^-mantissa; G = 1 / sqrt(1 - rho^2) with the correlation rho of x and y.
    fn worsen_form(&mut self, form: f64, mantissa: u8, truth: &ExactFootprint) {
        let gain = (1.0 + truth.slope * truth.slope * truth.curvature / truth.stretch).sqrt();
        let units = form * f64::from(mantissa).exp2() / (1.0 + gain);
        (self.form, self.form_units) = (worse(self.form, form), worse(self.form_units, units));
    }
}

/// The larger one, where NaN is larger than anything.
fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// Largest |eigenvalue| of a symmetric 2x2 matrix.
fn spectral([a, b, c]: [f64; 3]) -> f64 {
    worse(0.0, (0.5 * (a + c)).abs() + (0.5 * (a - c)).hypot(b))
}

/// Q' - Q in the coordinates in which Q is the identity, from a conic.
fn form_error_of_conic([a, b, c]: [f64; 3], truth: &ExactFootprint) -> f64 {
    let ExactFootprint {
        curvature,
        slope,
        stretch,
        ..
    } = *truth;
    let mixed = (a * slope + b) / (curvature * stretch).sqrt();
    let down = (a * slope * slope + 2.0 * b * slope + c) / stretch;
    spectral([a / curvature - 1.0, mixed, down - 1.0])
}

/// The same from LDL coefficients.
fn form_error_of_scan(footprint: &Footprint, truth: &ExactFootprint) -> f64 {
    let number = |x: Scaled| value(x.mantissa, x.exponent);
    let [a, s, c] = [
        footprint.scan.curvature,
        footprint.scan.slope,
        footprint.scan.stretch,
    ]
    .map(number);
    let lean = truth.slope - s;
    let mixed = a * lean / (truth.curvature * truth.stretch).sqrt();
    spectral([
        a / truth.curvature - 1.0,
        mixed,
        (a * lean * lean + c) / truth.stretch - 1.0,
    ])
}

fn pixels(case: &Case) -> impl Iterator<Item = (f64, f64)> {
    let (width, height) = (case.camera.width, case.camera.height);
    (0..width * height).map(move |i| ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5))
}

fn on_screen(case: &Case, footprint: &ExactFootprint) -> bool {
    pixels(case).any(|(x, y)| footprint.radial(x, y) < footprint.cutoff)
}

fn picture_errors(picture: &Picture, exact: &Picture) -> StageErrors {
    let Ok(errors) = metrics::compare(picture, exact) else {
        unreachable!("both pictures have the camera's size")
    };
    let psnr = errors.colour.psnr_db;
    StageErrors {
        picture: errors.colour.max_abs.max(errors.alpha.max_abs),
        bias: errors.colour.bias,
        psnr_db: psnr.is_finite().then_some(psnr),
        ..StageErrors::default()
    }
}

/// Nearest first, ties by index.
fn by_depth<F>(projected: &[Option<F>], depth: impl Fn(&F) -> f64) -> Vec<(usize, &F)> {
    let mut order: Vec<(usize, &F)> = projected
        .iter()
        .enumerate()
        .filter_map(|(i, f)| Some((i, f.as_ref()?)))
        .collect();
    order.sort_by(|a, b| depth(a.1).total_cmp(&depth(b.1)));
    order
}

/// The truth's picture, composited in double precision.
fn exact_picture(case: &Case, projected: &[Option<ExactFootprint>]) -> Picture {
    let order = by_depth(projected, |f| f.depth);
    let rules = &case.rules;
    let mut picture = Picture::new(case.camera.width, case.camera.height);
    for (pixel, (x, y)) in picture.pixels.iter_mut().zip(pixels(case)) {
        let (mut sum, mut clear) = ([0.0; 3], 1.0f64);
        for (index, footprint) in &order {
            let r = footprint.radial(x, y);
            let alpha = (footprint.peak * (-0.5 * r).exp()).min(rules.alpha_max);
            if r >= rules.cutoff || alpha <= 0.0 || alpha < rules.alpha_min {
                continue;
            }
            let rest = clear * (1.0 - alpha);
            if rules.stop_before && rest <= rules.stop {
                break;
            }
            for (sum, colour) in sum.iter_mut().zip(case.scene.splats[*index].colour) {
                *sum += clear * alpha * colour;
            }
            clear = rest;
            if clear <= rules.stop {
                break;
            }
        }
        *pixel = [sum[0], sum[1], sum[2], 1.0 - clear];
    }
    picture
}

/// The picture of single precision, composited in single precision.
fn single_picture(case: &Case, projected: &[Option<SingleFootprint>]) -> Picture {
    let order = by_depth(projected, |f| f.depth.into());
    let stop = case.rules.stop as f32;
    let mut picture = Picture::new(case.camera.width, case.camera.height);
    for (pixel, (x, y)) in picture.pixels.iter_mut().zip(pixels(case)) {
        let (mut sum, mut clear) = ([0.0f32; 3], 1.0f32);
        for (index, footprint) in &order {
            let alpha = footprint.opacity(x as f32, y as f32, &case.rules);
            if alpha <= 0.0 {
                continue;
            }
            let rest = clear * (1.0 - alpha);
            if case.rules.stop_before && rest <= stop {
                break;
            }
            for (sum, colour) in sum.iter_mut().zip(case.scene.splats[*index].colour) {
                *sum += clear * alpha * colour as f32;
            }
            clear = rest;
            if clear <= stop {
                break;
            }
        }
        *pixel = [sum[0], sum[1], sum[2], 1.0 - clear].map(f64::from);
    }
    picture
}
