//! What a drawing and a comparison tell on a terminal.

use crate::metrics::ChannelError;
use crate::picture::{Backdrop, Picture};
use crate::report::Report;
use crate::report::facts::{ReasonCounts, reasons};
use crate::report::formats::formats_text;
use crate::report::table::{psnr_text, scientific, signed, throughput_text};
use std::path::Path;

/// Why a picture shows nothing, for the standard error: an empty picture and exit code 0 look like success. Nothing if
/// it shows something.
///
/// `steps` are those of a channel in the file, none if it holds numbers, and `backdrop` is what the file has behind the
/// picture.
pub fn if_nothing_is_seen(
    picture: &Picture,
    report: &Report,
    steps: Option<f64>,
    backdrop: Backdrop,
) -> String {
    let scene = &report.scene;
    let largest = |of: fn(&[f64; 4]) -> f64| picture.pixels.iter().map(of).fold(0.0, f64::max);
    let colour = largest(|[r, g, b, _]| r.max(*g).max(*b));
    let largest_of_all = largest(|[.., a]| *a).max(colour);
    if largest_of_all > 0.0 {
        // On black only light is seen, on anything else what is covered as well.
        let seen = if backdrop == Backdrop::default() {
            colour
        } else {
            largest_of_all
        };
        return match steps {
            Some(steps) if seen * steps < 0.5 => format!(
                "{}: the picture shows nothing: its largest value, {seen:.1e}, rounds to 0 of {steps} steps; give --depth 16, or write .npy or .exr\n",
                scene.name
            ),
            _ => String::new(),
        };
    }
    let unseen = || {
        let (all, culled) = (scene.splats, scene.splats - scene.shown());
        scene.empty(&match culled {
            0 => "all splats are transparent or smaller than a pixel".to_owned(),
            _ => format!(
                "of {all} splats {culled} are culled{}; the rest is transparent or smaller than a pixel",
                reasons(&scene.culled)
            ),
        })
    };
    scene.if_nothing_is_left().unwrap_or_else(unseen) + "\n"
}

/// Says that surfaces were merged, which the layers asked for could not keep apart; nothing if none were.
pub fn if_layers_were_merged(pixels: usize) -> String {
    match pixels {
        0 => String::new(),
        _ => format!("{pixels} pixels had more layers than --layers keeps\n"),
    }
}

/// What was drawn, what was left out and how long it took.
pub fn of_drawing(report: &Report) -> String {
    let scene = &report.scene;
    let clamped = if scene.clamped > 0 {
        format!(", {} clamped", scene.clamped)
    } else {
        String::new()
    };
    format!(
        "{}: {} splats{}{}{clamped}\n{}\n",
        scene.name,
        scene.splats,
        left_out("skipped", &scene.skipped),
        left_out("culled", &scene.culled),
        times(report),
    )
}

/// Only the kernel's host side tells its stages apart.
fn times(report: &Report) -> String {
    let host = &report.host;
    let runs = if host.repeat > 1 {
        format!(", median of {} runs", host.repeat)
    } else {
        String::new()
    };
    let total = format!("{:.1} ms{runs}", host.total_s * 1e3);
    let before = if host.prepare_s > 0.0 {
        format!(
            ", after {:.1} ms of loading and preparing",
            host.prepare_s * 1e3
        )
    } else {
        String::new()
    };
    if report.traversal.is_none() {
        return total + &before;
    }
    let stages = [
        ("setup", host.setup_s),
        ("sort", host.sort_s),
        ("raster", host.raster_s),
        ("convert", host.convert_s),
    ];
    let stages = stages.map(|(name, seconds)| format!("{name} {:.1}", seconds * 1e3));
    format!("{total} ({}){before}", stages.join(", "))
}

/// `, 7 culled (near 3, outside 4)`; nothing where nothing was left out.
fn left_out(what: &str, counts: &ReasonCounts) -> String {
    match counts
        .values()
        .fold(0u64, |sum, count| sum.saturating_add(*count))
    {
        0 => String::new(),
        total => format!(", {total} {what}{}", reasons(counts)),
    }
}

/// The chosen design's errors.
pub fn of_comparison(report: &Report, folder: &Path) -> String {
    let line = |name: &str, error: &ChannelError| {
        let covered = &error.covered;
        format!(
            "{name:<6} PSNR {}, max error {}, p95 {}, p99 {}, bias {}, SSIM {:.6}; over the {} covered pixels PSNR {}, p99 {}, bias {}, SSIM {:.6}\n",
            psnr_text(error.psnr_db),
            scientific(error.max_abs),
            scientific(error.percentiles.p95),
            scientific(error.percentiles.p99),
            signed(error.bias),
            error.ssim,
            covered.pixels,
            psnr_text(covered.psnr_db),
            scientific(covered.percentiles.p99),
            signed(covered.bias),
            covered.ssim,
        )
    };
    let errors = report.error.iter().map(|error| {
        let flip = scientific(error.flip);
        let looks = format!(
            "FLIP   {flip} at {:.1} pixels per degree\n",
            error.flip_pixels_per_degree
        );
        line("RGB", &error.rgb) + &line("alpha", &error.alpha) + &looks
    });
    format!(
        "{}, design {} by {}, against {}\n{}{}{}{}\n",
        report.scene.name,
        report.design_name(),
        report.traversal.as_deref().unwrap_or("-"),
        report.reference.as_deref().unwrap_or("-"),
        errors.collect::<String>(),
        throughput_text(report),
        formats_text(report),
        folder.join("report.html").display(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::tests::sample;

    /// A report of two equal pictures of three splats, with so many of them culled.
    fn report(culled: u64) -> Report {
        let picture = Picture::new(2, 1);
        let mut report = sample::report(&picture, &picture);
        report.scene.splats = 3;
        report.scene.culled = [("near".to_owned(), culled)].into();
        report
    }

    fn note(pixel: [f64; 4], culled: u64, steps: Option<f64>, backdrop: Backdrop) -> String {
        let picture = Picture {
            width: 2,
            height: 1,
            pixels: vec![[0.0; 4], pixel],
        };
        if_nothing_is_seen(&picture, &report(culled), steps, backdrop)
    }

    #[test]
    fn an_empty_picture_says_why_and_no_more() {
        let empty = |culled| note([0.0; 4], culled, Some(255.0), Backdrop::default());
        assert!(
            empty(3).ends_with(": all 3 splats are culled (near 3)\n"),
            "{}",
            empty(3)
        );
        assert!(empty(2).contains("of 3 splats 2 are culled (near 2); the rest is transparent"));
        assert!(empty(0).contains("all splats are transparent"));
    }

    #[test]
    fn a_picture_that_rounds_to_black_is_told() {
        let faint = [0.0019, 0.0, 0.0, 0.4];
        let black = Backdrop::default();
        assert!(note(faint, 0, Some(255.0), black).contains("rounds to 0 of 255 steps"));
        assert_eq!(note(faint, 0, Some(65535.0), black), "");
        assert_eq!(note(faint, 0, None, black), "");
        assert_eq!(note([0.002, 0.0, 0.0, 0.4], 0, Some(255.0), black), "");
        // On white it darkens what is behind it.
        assert_eq!(note(faint, 0, Some(255.0), Backdrop::Colour([1.0; 3])), "");
        let fainter = [0.0, 0.0, 0.0, 0.0019];
        assert!(note(fainter, 0, Some(255.0), Backdrop::Transparent).contains("shows nothing"));
    }

    #[test]
    fn equal_pictures_have_no_decibels() {
        let text = of_comparison(&report(0), Path::new("."));
        assert!(
            text.contains("PSNR identical,") && !text.contains("identical dB"),
            "{text}"
        );
    }
}
