//! How far one picture is from another: PSNR, largest difference, percentiles, signed bias and SSIM; [`crate::flip`]
//! how far it looks.
//!
//! All figures are in units of 1.0, on pictures clamped to 0..1 as they would be stored but not quantised: what is
//! measured is the arithmetic, not the file format. Red, green and blue are one channel group, alpha is another.
//!
//! - PSNR is `-10 log10(mean squared difference)`, +infinity for identical pictures.
//! - Bias is the mean of fixed minus float. It is reported beside PSNR because truncating blends darken deep stacks
//!   by an amount that PSNR hides.
//! - The 95th and the 99th percentile are of the absolute differences of single samples: of `n` sorted ones the one
//!   numbered `ceil(n p / 100)`.
//! - All but the largest difference are given twice: over the whole picture, and over the covered pixels alone, those
//!   that are not transparent in both pictures. Empty background is drawn without an error and dilutes them all.
//! - SSIM follows Wang, Bovik, Sheikh and Simoncelli (IEEE TIP 2004): an 11x11 Gaussian window of sigma 1.5,
//!   K1 = 0.01, K2 = 0.03, averaged over the positions where the window lies inside the picture. A picture narrower or
//!   lower than the window shrinks the window to its size. Colour is compared by its luminance, alpha by itself.

use crate::flip;
use crate::input::Refused;
use crate::picture::Picture;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Rec. 709 luminance; exact for linear values, which is what a [`Picture`] holds.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];
/// Side of the SSIM window in pixels.
const WINDOW: usize = 11;
/// Standard deviation of the SSIM window in pixels.
const WINDOW_SIGMA: f64 = 1.5;
/// SSIM's stabilisers, (K1 L)^2 and (K2 L)^2 with L = 1.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Difference of two pictures, per channel group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Red, green and blue together.
    pub colour: ChannelError,
    /// Alpha.
    pub alpha: ChannelError,
}

/// Difference of two pictures in one channel group, in units of 1.0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelError {
    /// Peak signal-to-noise ratio in decibels; +infinity if no sample differs, which is null in JSON.
    #[serde(with = "finite_or_null")]
    pub psnr_db: f64,
    /// No sample differs.
    pub identical: bool,
    /// Largest absolute difference.
    pub max_abs: f64,
    /// 95 % and 99 % of the samples differ by no more.
    #[serde(default, flatten)]
    pub percentiles: Percentiles,
    /// Where the largest was first met in row order.
    pub max_at: SampleAt,
    /// Mean of fixed minus float.
    pub bias: f64,
    /// Mean structural similarity; 1 for identical pictures.
    pub ssim: f64,
    /// The same over the covered pixels.
    #[serde(default)]
    pub covered: CoveredError,
}

/// One sample of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SampleAt {
    /// Column.
    pub x: usize,
    /// Row.
    pub y: usize,
    /// 0 to 3: R, G, B, A.
    pub channel: usize,
}

/// JSON knows no infinity.
pub(crate) mod finite_or_null {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        Some(*value).filter(|value| value.is_finite()).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}

/// Difference of two pictures over the pixels that either of them covers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CoveredError {
    /// How many there are.
    pub pixels: usize,
    /// Peak signal-to-noise ratio in decibels; +infinity if no sample differs.
    #[serde(with = "finite_or_null")]
    pub psnr_db: f64,
    /// 95 % and 99 % of their samples differ by no more; 0 without any.
    #[serde(default, flatten)]
    pub percentiles: Percentiles,
    /// Mean of fixed minus float; 0 without a covered pixel.
    pub bias: f64,
    /// Mean structural similarity over the windows around covered pixels; 1 without any.
    pub ssim: f64,
}

/// Absolute differences that a part of the samples does not exceed, in units of 1.0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// 95 % of them.
    pub p95: f64,
    /// 99 % of them.
    pub p99: f64,
}

impl Percentiles {
    /// Of these differences, which are moved about; 0 of none.
    pub fn of(differences: &mut [f64]) -> Percentiles {
        let mut at = |percent: usize| {
            let place = (differences.len() * percent).div_ceil(100).checked_sub(1)?;
            Some(*differences.select_nth_unstable_by(place, f64::total_cmp).1)
        };
        Percentiles {
            p95: at(95).unwrap_or(0.0),
            p99: at(99).unwrap_or(0.0),
        }
    }
}

/// Compares two pictures of the same size; the first one's excess counts as positive.
pub fn compare(fixed: &Picture, float: &Picture) -> Result<Errors, Refused> {
    check(fixed, "fixed")?;
    check(float, "float")?;
    if (fixed.width, fixed.height) != (float.width, float.height) {
        return Err(Refused(format!(
            "the pictures differ in size: fixed is {}x{}, float is {}x{}",
            fixed.width, fixed.height, float.width, float.height
        )));
    }
    let luminance = |p: &[f64; 4]| (0..3).map(|c| LUMINANCE[c] * stored(p[c])).sum();
    let alpha = |p: &[f64; 4]| stored(p[3]);
    Ok(Errors {
        colour: channel_error(fixed, float, &[0, 1, 2], luminance),
        alpha: channel_error(fixed, float, &[3], alpha),
    })
}

/// The same, and how different the pictures look: mean FLIP at [`flip::PIXELS_PER_DEGREE`].
pub fn compare_and_look(fixed: &Picture, float: &Picture) -> Result<(Errors, f64), Refused> {
    let errors = compare(fixed, float)?;
    Ok((errors, flip::mean(fixed, float, flip::PIXELS_PER_DEGREE)))
}

/// How far a picture is from a photograph, as papers on trained scenes report it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhotoError {
    /// Peak signal-to-noise ratio of red, green and blue, decibels; +infinity if no sample differs.
    pub psnr_db: f64,
    /// Structural similarity as the trainers measure it: of each colour, in whole windows at every pixel, with zeros
    /// around the picture.
    pub ssim: f64,
    /// Mean FLIP at [`flip::PIXELS_PER_DEGREE`].
    pub flip: f64,
}

/// Compares a picture with a photograph of the same size.
pub fn photo_error(picture: &Picture, photograph: &Picture) -> Result<PhotoError, Refused> {
    let (errors, flip) = compare_and_look(picture, photograph)?;
    let [a, b] = [picture, photograph].map(surrounded);
    let of_channel = |channel: usize| ssim(&a, &b, |pixel| stored(pixel[channel])).0;
    Ok(PhotoError {
        psnr_db: errors.colour.psnr_db,
        ssim: (0..3).map(of_channel).sum::<f64>() / 3.0,
        flip,
    })
}

/// The picture with zeros around it, half a window wide.
fn surrounded(picture: &Picture) -> Picture {
    let border = WINDOW / 2;
    let [width, height] = [picture.width, picture.height].map(|side| side + 2 * border);
    let mut wide = Picture::new(width, height);
    let rows = wide.pixels.chunks_mut(width).skip(border);
    for (to, from) in rows.zip(picture.pixels.chunks(picture.width)) {
        to[border..border + picture.width].copy_from_slice(from);
    }
    wide
}

/// The value that a file can hold.
pub fn stored(value: f64) -> f64 {
    value.clamp(0.0, 1.0)
}

/// Rejects what no figure could be computed from.
fn check(picture: &Picture, which: &'static str) -> Result<(), Refused> {
    let expected = picture.width.saturating_mul(picture.height);
    let found = picture.pixels.len();
    if found != expected {
        return Err(Refused(format!(
            "the {which} picture holds {found} pixels where its size asks for {expected}"
        )));
    }
    if found == 0 {
        return Err(Refused("the pictures have no pixels".to_owned()));
    }
    for (index, pixel) in picture.pixels.iter().enumerate() {
        if let Some(channel) = pixel.iter().position(|v| !v.is_finite()) {
            let (x, y) = (index % picture.width, index / picture.width);
            let value = pixel[channel];
            return Err(Refused(format!(
                "the {which} picture holds {value} in channel {channel} of pixel ({x}, {y})"
            )));
        }
    }
    Ok(())
}

/// All figures of one channel group; `brightness` is what SSIM looks at.
fn channel_error(
    fixed: &Picture,
    float: &Picture,
    channels: &[usize],
    brightness: impl Fn(&[f64; 4]) -> f64,
) -> ChannelError {
    let mut whole = SampleSums::default();
    let mut covered = SampleSums::default();
    let samples = channels.len() * fixed.pixels.len();
    let (mut inside, mut outside) = (Vec::with_capacity(samples), Vec::new());
    let mut max_at = SampleAt {
        x: 0,
        y: 0,
        channel: channels[0],
    };
    for (index, (a, b)) in fixed.pixels.iter().zip(&float.pixels).enumerate() {
        let is_covered = is_covered(a, b);
        for &channel in channels {
            let difference = stored(a[channel]) - stored(b[channel]);
            if difference.abs() > whole.most {
                let (x, y) = (index % fixed.width, index / fixed.width);
                max_at = SampleAt { x, y, channel };
            }
            whole.add(difference);
            if is_covered {
                covered.add(difference);
                inside.push(difference.abs());
            } else {
                outside.push(difference.abs());
            }
        }
    }
    let of_covered = Percentiles::of(&mut inside);
    inside.append(&mut outside);
    let (ssim, ssim_covered) = ssim(fixed, float, brightness);
    ChannelError {
        psnr_db: whole.psnr_db(),
        identical: whole.most == 0.0,
        max_abs: whole.most,
        percentiles: Percentiles::of(&mut inside),
        max_at,
        bias: whole.mean(),
        ssim,
        covered: CoveredError {
            pixels: covered.samples / channels.len(),
            psnr_db: covered.psnr_db(),
            percentiles: of_covered,
            bias: covered.mean(),
            ssim: ssim_covered,
        },
    }
}

/// Whether a pixel is not transparent in both pictures.
fn is_covered(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a[3] != 0.0 || b[3] != 0.0
}

/// Sums over samples.
#[derive(Default)]
pub struct SampleSums {
    samples: usize,
    sum: f64,
    squares: f64,
    /// The largest size of a sample.
    pub most: f64,
}

impl SampleSums {
    /// One more sample.
    pub fn add(&mut self, difference: f64) {
        self.samples += 1;
        self.sum += difference;
        self.squares += difference * difference;
        self.most = self.most.max(difference.abs());
    }

    /// 0 of none.
    pub fn mean(&self) -> f64 {
        self.sum / self.samples.max(1) as f64
    }

    /// Differences so small that their squares vanish (below 1e-154) are not identical; they get the largest finite
    /// PSNR.
    pub fn psnr_db(&self) -> f64 {
        if self.most == 0.0 {
            return f64::INFINITY;
        }
        let mean_square = self.squares / self.samples.max(1) as f64;
        -10.0 * mean_square.max(f64::MIN_POSITIVE).log10()
    }
}

/// Window-weighted means of a, b, a^2, b^2 and ab.
type Moments = [f64; 5];

/// Mean SSIM over all positions of the window, and over those with a covered pixel in their middle. The Gaussian is
/// separable: rows are filtered first, and only as many filtered rows are kept as the window is high.
fn ssim(fixed: &Picture, float: &Picture, brightness: impl Fn(&[f64; 4]) -> f64) -> (f64, f64) {
    let across = window(fixed.width);
    let down = window(fixed.height);
    let mut rows: VecDeque<Vec<Moments>> = VecDeque::with_capacity(down.len());
    let (mut whole, mut covered) = (SampleSums::default(), SampleSums::default());
    let lines = fixed
        .pixels
        .chunks(fixed.width)
        .zip(float.pixels.chunks(fixed.width));
    for (y, (a, b)) in lines.enumerate() {
        if rows.len() == down.len() {
            rows.pop_front();
        }
        rows.push_back(filtered_row(a, b, &across, &brightness));
        if rows.len() < down.len() {
            continue;
        }
        for x in 0..rows[0].len() {
            let mut moments = [0.0; 5];
            for (row, weight) in rows.iter().zip(&down) {
                add_weighted(&mut moments, &row[x], *weight);
            }
            let similarity = similarity(&moments);
            whole.add(similarity);
            let middle = (y - down.len() / 2) * fixed.width + x + across.len() / 2;
            if is_covered(&fixed.pixels[middle], &float.pixels[middle]) {
                covered.add(similarity);
            }
        }
    }
    let of_covered = match covered.samples {
        0 => 1.0,
        _ => covered.mean(),
    };
    (whole.mean(), of_covered)
}

/// Moments along one row, one entry per position of the window.
fn filtered_row(
    a: &[[f64; 4]],
    b: &[[f64; 4]],
    weights: &[f64],
    brightness: &impl Fn(&[f64; 4]) -> f64,
) -> Vec<Moments> {
    let samples: Vec<Moments> = a
        .iter()
        .zip(b)
        .map(|(a, b)| {
            let (a, b) = (brightness(a), brightness(b));
            [a, b, a * a, b * b, a * b]
        })
        .collect();
    samples
        .windows(weights.len())
        .map(|run| {
            let mut moments = [0.0; 5];
            for (sample, weight) in run.iter().zip(weights) {
                add_weighted(&mut moments, sample, *weight);
            }
            moments
        })
        .collect()
}

fn add_weighted(sum: &mut Moments, sample: &Moments, weight: f64) {
    for (total, value) in sum.iter_mut().zip(sample) {
        *total += weight * value;
    }
}

/// SSIM at one position.
fn similarity(&[mean_a, mean_b, square_a, square_b, product]: &Moments) -> f64 {
    let variance_a = square_a - mean_a * mean_a;
    let variance_b = square_b - mean_b * mean_b;
    let covariance = product - mean_a * mean_b;
    let luminance = (2.0 * mean_a * mean_b + C1) / (mean_a * mean_a + mean_b * mean_b + C1);
    let structure = (2.0 * covariance + C2) / (variance_a + variance_b + C2);
    luminance * structure
}

/// Normalised Gaussian weights, at most as many as there are pixels.
fn window(pixels: usize) -> Vec<f64> {
    let length = pixels.min(WINDOW);
    let centre = (length as f64 - 1.0) / 2.0;
    let weight = |i: usize| (-((i as f64 - centre) / WINDOW_SIGMA).powi(2) / 2.0).exp();
    let total: f64 = (0..length).map(weight).sum();
    (0..length).map(|i| weight(i) / total).collect()
}

/// The middle one of the values, the greater of two; nothing of nothing. Moves them about.
pub fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

impl ChannelError {
    /// Root mean square, from the decibels that state it.
    pub fn rms(&self) -> f64 {
        if self.psnr_db.is_finite() {
            10f64.powf(-self.psnr_db / 20.0)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
#[path = "metrics_tests.rs"]
mod tests;
