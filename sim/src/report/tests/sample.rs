//! Synthetic pictures and a synthetic report with plausible figures, for tests and for looking at the page.

use super::*;
use crate::design::DesignChoice;
use crate::metrics::{CoveredError, Percentiles, SampleAt};
use crate::picture::Picture;
use crate::rules::{Compositing, Rules};
use crate::scene::{SortOrder, synthetic};

/// A soft ball and the same ball with rounding and truncation errors.
pub fn pictures(width: usize, height: usize) -> (Picture, Picture) {
    let mut float = Picture::new(width, height);
    for (index, pixel) in float.pixels.iter_mut().enumerate() {
        let x = (index % width) as f64 / width as f64 - 0.5;
        let y = (index / width) as f64 / height as f64 - 0.5;
        let alpha = (-(x * x + y * y) * 9.0).exp() * 0.9;
        let light = 0.5 + 0.5 * (9.0 * x).sin() * (7.0 * y).cos();
        *pixel = [alpha * light, alpha * 0.6, alpha * (1.0 - light), alpha];
    }
    let mut fixed = float.clone();
    for (index, pixel) in fixed.pixels.iter_mut().enumerate() {
        let noise =
            ((index as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / 16_777_216.0 - 0.5;
        let ripple = (pixel[3] * 40.0).sin() * 0.5;
        for (channel, value) in pixel.iter_mut().enumerate() {
            *value += (noise + ripple - 0.15 * channel as f64) * 2e-4 * *value;
        }
    }
    (fixed, float)
}

/// Times in seconds as the sweep states them.
pub fn times(total_s: f64) -> HostTimes {
    HostTimes {
        setup_s: total_s * 0.2,
        sort_s: total_s * 0.05,
        raster_s: total_s * 0.75,
        total_s,
        repeat: 5,
        threads: 2,
        ..HostTimes::default()
    }
}

/// Eight rows like those of the demo.
pub fn rows() -> Vec<ReportRow> {
    let covered = 18_204_331;
    let row = |design: &str, traversal: &str, psnr: f64, bias: f64, visited, total_s| {
        let rms = 10f64.powf(-psnr / 20.0);
        let error = ChannelError {
            psnr_db: psnr,
            identical: false,
            max_abs: rms * 7.5,
            percentiles: Percentiles {
                p95: rms * 1.9,
                p99: rms * 3.1,
            },
            max_at: SampleAt {
                x: 211,
                y: 87,
                channel: 1,
            },
            bias,
            ssim: 1.0 - rms * 3.0,
            covered: CoveredError {
                pixels: 118_233,
                psnr_db: psnr - 3.5,
                percentiles: Percentiles {
                    p95: rms * 2.4,
                    p99: rms * 3.9,
                },
                bias: 2.2 * bias,
                ssim: 1.0 - rms * 6.0,
            },
        };
        ReportRow {
            design: design.to_owned(),
            traversal: traversal.to_owned(),
            error,
            flip: 0.4 * rms,
            visited,
            covered,
            visited_per_covered: Some(visited as f64 / covered as f64),
            cycles: Some(visited + 5_000_000),
            host: times(total_s),
        }
    };
    vec![
        row("classic8", "box", 32.41, -1.9e-2, 46_677_771, 0.412),
        row("classic8", "spans", 32.52, -1.9e-2, 18_931_002, 0.305),
        row("lean18", "box", 55.13, -4.1e-5, 46_677_771, 0.431),
        row("lean18", "spans", 61.87, -3.2e-5, 18_931_002, 0.311),
        row("standard24", "box", 78.02, 2.4e-6, 46_677_771, 0.438),
        row("standard24", "spans", 86.38, 1.1e-6, 18_931_002, 0.319),
        row("deep32", "box", 108.77, 3.3e-8, 46_677_771, 0.497),
        row("deep32", "spans", 112.05, -1.2e-8, 18_931_002, 0.352),
    ]
}

/// A report about [`pictures`].
pub fn report(fixed: &Picture, float: &Picture) -> Report {
    let camera = synthetic::camera(float.width, float.height);
    Report {
        format: FORMAT.to_owned(),
        engine: "fixed".to_owned(),
        reference: Some("float".to_owned()),
        design: DesignChoice::named("standard24").map(|design| design.resolved()),
        traversal: Some("spans".to_owned()),
        scene: SceneFacts {
            name: "brainsmall".to_owned(),
            splats: 312_954,
            skipped: [
                ("non_finite".to_owned(), 2),
                ("zero_rotation".to_owned(), 0),
            ]
            .into(),
            culled: [("outside".to_owned(), 1204), ("transparent".to_owned(), 87)].into(),
            clamped: 3,
            colour_log2: 0,
            order: SortOrder::Depth,
        },
        warnings: vec!["brainsmall: 3 splats clamped".to_owned()],
        camera: camera.clone(),
        rules: Rules::GAUSSIAN_3D,
        compositing: Compositing::FrontToBack.name().to_owned(),
        error: ErrorFacts::between(fixed, float).ok(),
        error_map: Some(ScaleFacts::from(&ErrorMap::new(fixed, float))),
        cycles: None,
        pace: None,
        pixels: Some(PixelCounts {
            covered: 18_204_331,
            visited: 18_931_002,
        }),
        host: times(0.319),
        systems: Vec::new(),
        table: rows(),
        formats: Vec::new(),
        plan: serde_json::Value::Null,
    }
}
