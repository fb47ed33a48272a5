//! Errors of a design's pictures against the references: whole, and in the tiles where designs err most.

use crate::fast::TILE;
use crate::metrics::{self, Percentiles, stored};
use crate::picture::Picture;
use anyhow::{Context, Result, ensure};
use rayon::prelude::*;
use serde::Serialize;
use splatline::raster::Window;

/// Errors of one design over all frames. Colours only, units of 1.0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct DesignError {
    /// Largest absolute error.
    pub max_abs: f64,
    /// Root mean square error.
    pub rms: f64,
    /// Mean of fixed minus float.
    pub bias: f64,
    /// What takes thirty times as long as drawing, where it is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detail: Option<ErrorDetail>,
}

/// What [`metrics::compare_and_look`] finds beside that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorDetail {
    /// Mean structural similarity.
    pub ssim: f64,
    /// 95 % and 99 % of the samples differ by no more.
    #[serde(flatten)]
    pub percentiles: Percentiles,
    /// Mean FLIP.
    pub flip: f64,
}

impl DesignError {
    /// That of the reference itself, by every measure.
    pub fn none() -> DesignError {
        DesignError {
            detail: Some(ErrorDetail {
                ssim: 1.0,
                ..ErrorDetail::default()
            }),
            ..DesignError::default()
        }
    }

    /// How far the colours of a picture are from the reference's: what [`metrics::compare`] says of them, without
    /// detail.
    pub fn of(picture: &Picture, reference: &Picture) -> Result<DesignError> {
        let size = |picture: &Picture| (picture.width, picture.height, picture.pixels.len());
        ensure!(
            size(picture) == size(reference) && !picture.pixels.is_empty(),
            "the pictures cannot be compared: their sizes differ or are 0"
        );
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
        Ok(DesignError {
            max_abs,
            rms: (squares / samples).sqrt(),
            bias: signed / samples,
            detail: None,
        })
    }

    /// The same with [its detail](ErrorDetail).
    pub fn with_detail(picture: &Picture, reference: &Picture) -> Result<DesignError> {
        let found = metrics::compare_and_look(picture, reference);
        let (errors, flip) = found.context("the pictures cannot be compared")?;
        let colour = errors.colour;
        Ok(DesignError {
            max_abs: colour.max_abs,
            rms: colour.rms(),
            bias: colour.bias,
            detail: Some(ErrorDetail {
                ssim: colour.ssim,
                percentiles: colour.percentiles,
                flip,
            }),
        })
    }

    /// Over several pictures: the largest error, percentile and FLIP of any, the root of the mean square, and the means
    /// of bias and similarity.
    pub fn over(all: &[DesignError]) -> DesignError {
        if let [one] = all {
            return *one;
        }
        let count = all.len().max(1) as f64;
        let mean = |of: fn(&DesignError) -> f64| all.iter().map(of).sum::<f64>() / count;
        let details: Option<Vec<ErrorDetail>> = all.iter().map(|one| one.detail).collect();
        let over = |details: Vec<ErrorDetail>| {
            let most = |of: fn(&ErrorDetail) -> f64| details.iter().map(of).fold(0.0, f64::max);
            ErrorDetail {
                ssim: details.iter().map(|one| one.ssim).sum::<f64>() / count,
                percentiles: Percentiles {
                    p95: most(|one| one.percentiles.p95),
                    p99: most(|one| one.percentiles.p99),
                },
                flip: most(|one| one.flip),
            }
        };
        DesignError {
            max_abs: all.iter().map(|one| one.max_abs).fold(0.0, f64::max),
            rms: mean(|one| one.rms * one.rms).sqrt(),
            bias: mean(|one| one.bias),
            detail: details.map(over),
        }
    }

    /// Peak signal-to-noise ratio, decibels; infinite for equal pictures.
    pub fn psnr_db(&self) -> f64 {
        -20.0 * self.rms.log10()
    }
}

/// The tile in which the largest difference of two pictures of one size lies.
pub fn worst(picture: &Picture, reference: &Picture) -> Window {
    let pixels = picture.pixels.iter().zip(&reference.pixels);
    let size = |(a, b): (&[f64; 4], &[f64; 4])| {
        let of = |channel: usize| (stored(a[channel]) - stored(b[channel])).abs();
        (0..3).map(of).fold(0.0, f64::max)
    };
    let sizes = pixels.map(size).enumerate();
    let most = sizes.max_by(|a, b| a.1.total_cmp(&b.1));
    let (place, width) = (most.map_or(0, |most| most.0), picture.width.max(1));
    let at = [place % width, place / width].map(|at| at as u16);
    let first = [0, 1].map(|axis| at[axis] - at[axis] % TILE[axis]);
    let size = [picture.width, picture.height].map(|size| size as u16);
    let end = [0, 1].map(|axis| first[axis].saturating_add(TILE[axis]).min(size[axis]));
    Window { first, end }
}

/// Errors of some pixels as if all others had none: those of the whole picture are no smaller, whatever the bias.
pub fn errors_inside(picture: &Picture, reference: &Picture, windows: &[Window]) -> DesignError {
    let (mut max_abs, mut squares) = (0.0, 0.0);
    for window in windows {
        for row in window.first[1]..window.end[1] {
            let columns = [window.first[0], window.end[0]];
            let [from, to] = columns.map(|x| usize::from(row) * picture.width + usize::from(x));
            let row = differences(&picture.pixels[from..to], &reference.pixels[from..to]);
            max_abs = f64::max(max_abs, row[0]);
            squares += row[1];
        }
    }
    DesignError {
        max_abs,
        rms: (squares / (3.0 * picture.pixels.len() as f64)).sqrt(),
        ..DesignError::default()
    }
}

/// Largest, sum of squares and signed sum of the differences of red, green and blue; not a number counts as an infinite
/// error.
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

#[cfg(test)]
mod tests {
    use super::*;

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
        let quick = DesignError::of(&fixed, &float).unwrap();
        let whole = metrics::compare(&fixed, &float).unwrap().colour;
        assert_eq!(quick.max_abs, whole.max_abs);
        assert!((quick.rms / whole.rms() - 1.0).abs() < 1e-12);
        assert!((quick.bias - whole.bias).abs() < 1e-15);
        assert!((quick.psnr_db() - whole.psnr_db).abs() < 1e-9);
        let none = DesignError::of(&float, &float).unwrap();
        assert_eq!(none, DesignError::default());
        assert!(DesignError::of(&float, &Picture::new(30, 40)).is_err());
        fixed.pixels[3][0] = f64::NAN;
        let endless = DesignError::of(&fixed, &float).unwrap();
        assert_eq!(endless.max_abs, f64::INFINITY);
    }

    /// Tile by tile they grow to those of the whole, and never beyond.
    #[test]
    fn errors_of_tiles_are_no_larger_than_the_pictures() {
        let (mut float, mut fixed) = (Picture::new(150, 70), Picture::new(150, 70));
        float.pixels.fill([0.5; 4]);
        for (place, pixel) in fixed.pixels.iter_mut().enumerate() {
            *pixel = [0.5 + (place * 37 % 101) as f64 * 1e-3; 4];
        }
        fixed.pixels[66 * 150 + 140] = [0.9; 4];
        let tile = worst(&fixed, &float);
        assert_eq!((tile.first, tile.end), ([128, 64], [150, 70]));
        let whole = DesignError::of(&fixed, &float).unwrap();
        let part = errors_inside(&fixed, &float, &[tile]);
        assert!(part.max_abs == whole.max_abs && part.rms < whole.rms);
        let (first, end) = ([0; 2], [150, 70]);
        let all = errors_inside(&fixed, &float, &[Window { first, end }]);
        assert!((all.rms / whole.rms - 1.0).abs() < 1e-12);
    }

    #[test]
    fn errors_over_pictures_are_the_largest_and_the_mean() {
        let all = [(0.1, 3.0, 0.5), (0.4, 4.0, -0.1)].map(|(max_abs, rms, bias)| DesignError {
            max_abs,
            rms,
            bias,
            detail: None,
        });
        let over = DesignError::over(&all);
        assert_eq!(over.max_abs, 0.4);
        assert!((over.rms - 12.5f64.sqrt()).abs() < 1e-12 && (over.bias - 0.2).abs() < 1e-12);
    }
}
