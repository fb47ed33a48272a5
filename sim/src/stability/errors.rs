//! The errors of one engine in one case, stage by stage, and how each is measured.

use super::bounds::ErrorBounds;
use super::exact::RationalFootprint;
use super::table::STAGES;
use splatline::footprint::Footprint;
use splatline::math::SoftFloat;

/// Peaks from here on count as this one: the opacity is 1 within any cut-off of normalised kernels (at most 4), and the
/// packet saturates.
const LARGEST_PEAK: f64 = 15.0;

/// Worst errors of one engine in one case.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct StageErrors {
    /// Centre, pixels.
    pub centre: f64,
    /// Depth, relative.
    pub depth: f64,
    /// Opacity at r = 0, relative.
    pub peak: f64,
    /// Variances, relative.
    pub variance: f64,
    /// Determinant, relative.
    pub determinant: f64,
    /// Quadratic form, relative, in its worst direction.
    pub form: f64,
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
    /// Pixels on an edge of the rules, where the picture is discontinuous; they are left out of the three numbers
    /// above.
    pub edges: usize,
    /// Pixels on an edge that this engine decides otherwise.
    pub decided_wrongly: usize,
    /// The largest share of each step's derived bound that is used, in the order of [`STAGES`]; 0 for engines without
    /// bounds.
    pub shares: [f64; STAGES.len()],
}

pub(super) fn value(mantissa: i32, exponent: i32) -> f64 {
    f64::from(mantissa) * f64::from(exponent).exp2()
}

impl StageErrors {
    /// The worse of two, number by number.
    pub(super) fn worsen(&mut self, other: &StageErrors) {
        let bias = if other.bias.abs() > self.bias.abs() {
            other.bias
        } else {
            self.bias
        };
        *self = StageErrors {
            centre: worse(self.centre, other.centre),
            depth: worse(self.depth, other.depth),
            peak: worse(self.peak, other.peak),
            variance: worse(self.variance, other.variance),
            determinant: worse(self.determinant, other.determinant),
            form: worse(self.form, other.form),
            radial: worse(self.radial, other.radial),
            picture: worse(self.picture, other.picture),
            bias,
            psnr_db: match (self.psnr_db, other.psnr_db) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            },
            culled_wrongly: self.culled_wrongly + other.culled_wrongly,
            edges: self.edges + other.edges,
            decided_wrongly: self.decided_wrongly + other.decided_wrongly,
            shares: std::array::from_fn(|step| worse(self.shares[step], other.shares[step])),
        };
    }

    /// By what setup made of one splat: centre, depth and peak, xx, xy, yy and determinant of its variance, and the
    /// error of its form.
    pub(super) fn worsen_setup(
        &mut self,
        centre: [f64; 2],
        [depth, peak]: [f64; 2],
        [xx, xy, yy, determinant]: [f64; 4],
        form: f64,
        truth: &RationalFootprint,
    ) {
        for (got, expected) in centre.iter().zip(truth.centre) {
            self.centre = worse(self.centre, (got - expected).abs());
        }
        self.depth = worse(self.depth, (depth / truth.depth - 1.0).abs());
        let [peak, expected] = [peak, truth.peak].map(|peak| peak.min(LARGEST_PEAK));
        self.peak = worse(self.peak, (peak / expected - 1.0).abs());
        let [true_xx, true_xy, true_yy, true_determinant] = truth.variance;
        let [along, down] = [xx / true_xx, yy / true_yy].map(|part| (part - 1.0).abs());
        let cross = (xy - true_xy).abs() / (true_xx * true_yy).sqrt();
        for error in [along, down, cross] {
            self.variance = worse(self.variance, error);
        }
        let relative = (determinant / true_determinant - 1.0).abs();
        self.determinant = worse(self.determinant, relative);
        self.form = worse(self.form, form);
    }

    /// Takes the errors of one splat as shares of its bounds; r and the picture have their own, pixel by pixel.
    pub(super) fn compare(&mut self, bounds: &ErrorBounds) {
        let shares = [
            self.centre / bounds.centre,
            self.depth / bounds.depth,
            self.peak / bounds.peak,
            self.variance / bounds.variance,
            self.determinant / bounds.determinant,
            self.form / bounds.form,
        ];
        for (step, share) in shares.into_iter().enumerate() {
            self.shares[step] = worse(self.shares[step], share);
        }
    }
}

/// The larger one, where NaN is larger than anything.
pub(super) fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// Largest |eigenvalue| of a symmetric 2x2 matrix.
fn spectral([a, b, c]: [f64; 3]) -> f64 {
    worse(0.0, (0.5 * (a + c)).abs() + (0.5 * (a - c)).hypot(b))
}

/// Q' - Q in the coordinates in which Q is the identity, from a conic.
pub(super) fn form_error_of_conic([a, b, c]: [f64; 3], truth: &RationalFootprint) -> f64 {
    let (horizontal, shear, vertical) = (truth.horizontal, truth.shear, truth.vertical);
    let mixed = (a * shear + b) / (horizontal * vertical).sqrt();
    let down = (a * shear * shear + 2.0 * b * shear + c) / vertical;
    spectral([a / horizontal - 1.0, mixed, down - 1.0])
}

/// The same from LDL coefficients.
pub(super) fn form_error_of_ldl(footprint: &Footprint, truth: &RationalFootprint) -> f64 {
    let number = |x: SoftFloat| value(x.mantissa, x.exponent);
    let [a, s, c] = [
        footprint.ldl.horizontal,
        footprint.ldl.shear,
        footprint.ldl.vertical,
    ]
    .map(number);
    let lean = truth.shear - s;
    let mixed = a * lean / (truth.horizontal * truth.vertical).sqrt();
    spectral([
        a / truth.horizontal - 1.0,
        mixed,
        (a * lean * lean + c) / truth.vertical - 1.0,
    ])
}
