//! How far the kernel's picture is from the reference: figures, colours and the histogram of the signed error.
//!
//! The figures are sums of the host's `metrics` without SSIM, which takes longer than drawing.

use crate::draw::{FixedPicture, FloatPicture};
use crate::metrics::SampleSums;
use crate::scale::{ErrorScale, colour};

/// What [`Compared::figures`] holds, in this order; the page's script reads them by place.
pub const NAMES: [&str; 16] = [
    "psnr",
    "largest",
    "bias",
    "x",
    "y",
    "psnr_covered",
    "bias_covered",
    "visited",
    "covered",
    "drawn",
    "culled",
    "checksum_high",
    "checksum_low",
    "limit",
    "knee",
    "outliers",
];
/// Bins of the histogram between the ends of the colour scale.
pub const BINS: usize = 64;
/// Entries of the table of colours over the scale.
const SHADES: usize = 511;

/// What a comparison gives.
#[derive(Default)]
pub struct Compared {
    pub figures: [f64; NAMES.len()],
    pub histogram: Vec<f64>,
    pub rgba: Vec<u8>,
}

impl Compared {
    pub fn new(
        fixed: &FixedPicture,
        float: &FloatPicture,
        percentile: f64,
        limit: f64,
    ) -> Compared {
        let (differences, errors) = errors(fixed, float);
        let mut scale = ErrorScale::of(&differences, percentile);
        if limit > 0.0 && scale.limit > 0.0 {
            scale.limit = limit;
            scale.knee = scale.knee.min(limit);
            scale.outliers = differences.iter().filter(|d| d.abs() > limit).count();
        }
        let shades: Vec<[u8; 3]> = (0..SHADES)
            .map(|shade| colour(shade as f64 / (SHADES / 2) as f64 - 1.0))
            .collect();
        let mut histogram = vec![0.0; BINS + 2];
        let mut rgba = Vec::with_capacity(differences.len() * 4);
        for difference in &differences {
            if *difference == 0.0 {
                let [r, g, b] = shades[SHADES / 2];
                rgba.extend([r, g, b, 255]);
                continue;
            }
            let position = scale.position(*difference);
            let bin = ((position + 1.0) / 2.0 * BINS as f64).floor() + 1.0;
            histogram[bin.clamp(0.0, (BINS + 1) as f64) as usize] += 1.0;
            let shade = (position.clamp(-1.0, 1.0) + 1.0) * (SHADES / 2) as f64;
            let [r, g, b] = shades[(shade + 0.5) as usize];
            rgba.extend([r, g, b, 255]);
        }
        let mut figures = [0.0; NAMES.len()];
        figures[..7].copy_from_slice(&errors);
        figures[13..].copy_from_slice(&[scale.limit, scale.knee, scale.outliers as f64]);
        Compared {
            figures,
            histogram,
            rgba,
        }
    }

    /// Brings the figures up to date with the kernel's last picture.
    pub fn tell(&mut self, fixed: Option<&FixedPicture>) {
        let Some(fixed) = fixed else { return };
        let (painted, culled) = (&fixed.painted, fixed.culled);
        let drawn = painted.footprints.len() - culled;
        self.figures[7..13].copy_from_slice(&[
            painted.coverage.visited as f64,
            painted.coverage.covered as f64,
            drawn as f64,
            culled as f64,
            (fixed.checksum >> 32) as f64,
            (fixed.checksum & u64::from(u32::MAX)) as f64,
        ]);
    }
}

/// Per pixel the difference of the colour channel that differs most; then PSNR, largest, bias, its place, PSNR and bias
/// over covered pixels.
fn errors(fixed: &FixedPicture, float: &FloatPicture) -> (Vec<f64>, [f64; 7]) {
    let (mut whole, mut covered) = (SampleSums::default(), SampleSums::default());
    let mut at = 0;
    let mut differences = Vec::with_capacity(fixed.picture.pixels.len());
    let pairs = fixed.picture.pixels.iter().zip(&float.picture.pixels);
    for (index, (a, b)) in pairs.enumerate() {
        let is_covered = a[3] > 0.0 || b[3] > 0.0;
        let mut worst = 0.0f64;
        for channel in 0..3 {
            let difference = a[channel].clamp(0.0, 1.0) - b[channel].clamp(0.0, 1.0);
            if difference.abs() > whole.most {
                at = index;
            }
            whole.add(difference);
            if is_covered {
                covered.add(difference);
            }
            if difference.abs() > worst.abs() {
                worst = difference;
            }
        }
        differences.push(worst);
    }
    let width = fixed.picture.width.max(1);
    let figures = [
        whole.psnr_db(),
        whole.most,
        whole.mean(),
        (at % width) as f64,
        (at / width) as f64,
        covered.psnr_db(),
        covered.mean(),
    ];
    (differences, figures)
}
